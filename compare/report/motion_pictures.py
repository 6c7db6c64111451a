"""Pictures of a motion: path from above or on the sphere, swing plane, transits; files or SVG."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reference.errors import counted
from reference.numbers.precision import Array
from reference.plain_text import shortened

from .drawing import BLUE, COLOURS, FAINT, INK, picture, sheet, svg_text
from .motion import MOST, POINTS, PicturedMotion, thinned

_DOTS = 360  # most dots of one kind in a panel
_DOT = 3.0  # diameter of a dot in points
_PANEL = (3.5, 3.2)  # width and height in inches
_SEEN_FROM = np.radians(-60.0)  # azimuth of the eye that sees the sphere
_ABOVE = np.radians(20.0)  # and its elevation
_LENGTH_UNITS = (  # factor, symbol, and the smallest length in m that is shown in it
    (1e-3, "km", 1e3),
    (1.0, "m", 0.1),
    (1e3, "mm", 1e-3),
    (1e6, "µm", 1e-6),
    (1e9, "nm", 1e-9),
    (1e12, "pm", 1e-12),
)
_TIME_UNITS = (  # seconds, symbol, and the smallest number of them that is shown in it
    (86_400.0, "d", 3.0),
    (3600.0, "h", 2.0),
    (60.0, "min", 10.0),
    (1.0, "s", 1.0),
)
_SMALL = 0.01  # degrees: the least range of the azimuth's axis
_ROUNDED = re.compile(r"(\d+\.\d\d)\d+")
_ELEMENT = re.compile(r"<[^>]*>")  # the coordinates in it, not the text after it
_PATH = re.compile(r' d="([^"]*)"')
_FONTS = re.compile(r'font-family="[^"]+"')
_MARKERS = re.compile(r'(?:<use [^>]*fill="([^"]*)"[^>]*/>\s*){2,}')
_PLACE = re.compile(r'x="(\S+)" y="(\S+)"')
_THUMB = 200  # side of a thumbnail in its own units
_THUMB_POINTS = 400  # most points of a thumbnail
_LONGEST_NAME = 40  # characters of a file's name above its picture


def path(axes: Any, motion: PicturedMotion) -> None:
    """Draw the path from above: all of it, single swings spread over the span, or the rows."""
    points = np.concatenate([motion.rows, motion.line])[:, :2]
    size = float(np.nanmax(np.abs(points))) or 1.0
    scale, unit = length_unit(size)
    line = motion.line * scale
    rows = thinned(motion.rows, MOST) * scale
    first = POINTS + 1 if motion.swings else len(line)
    if motion.swings:
        axes.plot(*line[:first, :2].T, color=BLUE, linewidth=1.1, label="first swing", zorder=3)
        axes.plot(*line[first:, :2].T, color=COLOURS[1], linewidth=0.7, label="later swings")
    elif len(line):
        controls = motion.controls * scale
        everywhere = np.full(len(line), True)
        _curves(axes, line[:, :2], controls[:, :2], everywhere, _Stroke("path", 0.8))
    else:
        _dots(axes, rows[:, 0], rows[:, 1], BLUE, "rows")
    _mark_start(axes, motion, *rows[0, :2])
    edge = 1.08 * size * scale
    axes.set(
        xlim=(-edge, edge),
        ylim=(-edge, edge),
        aspect="equal",
        title=f"Path from above: {_shown(motion)}",
    )
    axes.set(xlabel=f"x in {unit}, east", ylabel=f"y in {unit}, north")
    axes.xaxis.set_major_locator(_value_ticks())
    axes.yaxis.set_major_locator(_value_ticks())
    axes.grid(True)
    _key(axes)


def sphere(axes: Any, motion: PicturedMotion) -> None:
    """Draw the path on its sphere, seen from above and from the south-east.

    The far side is faint.
    """
    points = motion.line
    controls = motion.controls
    if not len(points):
        points = motion.rows
        controls = np.full_like(points, np.nan)
    bob = _projected(points / motion.length)
    bends = _projected(controls / motion.length)
    behind = np.logical_not(bob.in_front)
    far_side = _Stroke("far side", 0.5, 0.5)
    near_side = _Stroke("near side", 0.9)
    turn = np.linspace(0, 2 * np.pi, 73)
    equator = _projected(np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]))
    axes.plot(np.cos(turn), np.sin(turn), color=FAINT, linewidth=0.8)

    axes.plot(*equator.half(front=False), color=FAINT, linewidth=0.6, linestyle=(0, (1, 3)))
    _curves(axes, bob.plane, bends.plane, behind, far_side)
    axes.plot(*equator.half(front=True), color=FAINT, linewidth=0.6)
    _curves(axes, bob.plane, bends.plane, bob.in_front, near_side)

    _mark_start(axes, motion, bob.right[0], bob.up[0])
    axes.plot([0], [0], marker="+", color=INK, markersize=6, linestyle="none", label="pivot")
    axes.set(
        xlim=(-1.08, 1.08),
        ylim=(-1.08, 1.08),
        aspect="equal",
        title=f"On the sphere: {_shown(motion)}",
    )
    axes.set_axis_off()
    _key(axes, below=0.0)


def plane(axes: Any, motion: PicturedMotion) -> None:
    """Draw the azimuth of the swing plane against time, unwrapped if it turns slowly."""
    steps = (np.diff(motion.plane) + 90) % 180 - 90
    smooth = np.abs(steps).max() < 60
    angle = np.unwrap(motion.plane, period=180) if smooth else motion.plane
    t = thinned(motion.plane_t, _DOTS)
    angle = thinned(angle, _DOTS)
    seconds, word = time_unit(float(motion.t[-1]))
    _dots(axes, t * seconds, angle, BLUE)
    axes.yaxis.set_major_locator(_value_ticks())
    if np.ptp(angle) < _SMALL:
        axes.set_ylim(float(np.mean(angle)) - _SMALL, float(np.mean(angle)) + _SMALL)
    if not smooth:
        axes.set(ylim=(-90, 90), yticks=(-90, -45, 0, 45, 90))
    axes.ticklabel_format(axis="y", useOffset=False)
    axes.set(
        xlim=(0, motion.t[-1] * seconds),
        xlabel=f"t in {word}",
        ylabel="degrees, from east to north",
    )
    axes.set(title="Azimuth of the swing plane")
    axes.xaxis.set_major_locator(time_ticks())
    axes.grid(True)


def transits(axes: Any, motion: PicturedMotion) -> None:
    """Draw x at each transit against its time: the eastern and the western turning points."""
    scale, unit = length_unit(float(np.abs(motion.transit_x).max(initial=0.0)) or 1.0)
    seconds, word = time_unit(float(motion.t[-1]))
    ends = ((-1, BLUE, "eastern end"), (1, COLOURS[1], "western end"))
    for direction, colour, name in ends:
        selected = motion.directions == direction
        t = thinned(motion.transit_t[selected], _DOTS // 2)
        x = thinned(motion.transit_x[selected], _DOTS // 2)
        if len(t):
            _dots(axes, t * seconds, x * scale, colour, name)
    axes.set(xlim=(0, motion.t[-1] * seconds), xlabel=f"t in {word}", ylabel=f"x in {unit}")
    axes.set(title=f"Where the bob turns in x: {counted(len(motion.transit_t), 'transit')}")
    axes.xaxis.set_major_locator(time_ticks())
    axes.yaxis.set_major_locator(_value_ticks())
    axes.grid(True)
    _key(axes)


def panels(motion: PicturedMotion) -> dict[str, Callable[[Any, PicturedMotion], None]]:
    """Return the available pictures of a motion, by name."""
    pictures = {
        "path": (path, True),
        "sphere": (sphere, motion.wide),
        "plane": (plane, len(motion.plane_t) > 1),
        "transits": (transits, len(motion.transit_t) > 0),
    }
    return {name: draw for name, (draw, shown) in pictures.items() if shown}


def motion_picture(motion: PicturedMotion, names: Sequence[str], target: Path) -> bytes:
    """Return the content of a picture file with panels side by side.

    The file's name says which form.
    """
    drawn = panels(motion)
    with sheet((_PANEL[0] * len(names), _PANEL[1] + 0.3)) as figure:
        for axes, name in zip(np.atleast_1d(figure.subplots(1, len(names))), names, strict=True):
            drawn[name](axes, motion)
        figure.suptitle(shortened(motion.name, _LONGEST_NAME), x=0.01, ha="left", fontsize=10)
        return picture(figure, target.suffix[1:].lower())


def motion_svgs(motion: PicturedMotion) -> list[str]:
    """Return each picture as an SVG element of its own, small and for a page."""
    elements = []
    for name, draw in panels(motion).items():
        with sheet(_PANEL) as figure:
            axes = figure.subplots()
            draw(axes, motion)
            text = svg_text(
                figure,
                f"{motion.name}-{name}",
                f"{motion.name}: {axes.get_title('left')}",
                "lines panel",
            )
        text = _FONTS.sub('font-family="sans-serif"', text)
        text = _ELEMENT.sub(lambda element: _ROUNDED.sub(r"\1", element[0]), text)
        text = _PATH.sub(_shortened_path, text)
        elements.append(_MARKERS.sub(_strokes, text))
    return elements


def thumbnail(motion: PicturedMotion) -> str:
    """Return the path, from above or on its sphere, as a small SVG element without words."""
    radius = 0.46 * _THUMB
    points = thinned(motion.line if len(motion.line) else motion.rows, _THUMB_POINTS)
    if motion.wide:
        bob = _projected(points / motion.length)
        right = bob.right
        up = bob.up
        size = 1.0
        ring = f'<circle cx="{_THUMB // 2}" cy="{_THUMB // 2}" r="{radius:.0f}"/>'
    else:
        right, up = points[:, :2].T
        size = float(np.nanmax(np.hypot(right, up))) or 1.0
        ring = ""

    places = np.column_stack([right, -up]) * (radius / size) + _THUMB / 2
    words = ["M" if np.isnan(x) else f"{x:.0f} {y:.0f}" for x, y in places]
    path = f"M{' '.join(words)}".removesuffix(" M")
    release = f'<path class="release" d="M{words[0]}h0"/>'
    box = f"0 0 {_THUMB} {_THUMB}"
    return f'<svg viewBox="{box}" aria-hidden="true">{ring}<path d="{path}"/>{release}</svg>'


def _shortened_path(path: re.Match[str]) -> str:
    """Return a path on one line, which names a command once where it is repeated."""
    parts = []
    before = ""
    for command in path[1].split("\n"):
        name, _, numbers = command.strip().partition(" ")
        parts.append(numbers if name == before else f"{name} {numbers}")
        before = name
    return f' d="{" ".join(parts).strip()}"'


def _strokes(markers: re.Match[str]) -> str:
    """Return markers, each an element of its own, as one path of zero-length strokes."""
    places = "".join(f"M{x} {y}h0" for x, y in _PLACE.findall(markers[0]))
    stroke = f'stroke="{markers[1]}" stroke-width="{_DOT}" stroke-linecap="round"'
    return f'<path d="{places}" fill="none" {stroke}/>\n'


def length_unit(size: float) -> tuple[float, str]:
    """Return the unit that gives a length in m a handy size: its factor and its symbol."""
    for factor, unit, smallest_m in _LENGTH_UNITS:
        if size >= smallest_m:
            return factor, unit
    return 1.0, "m"


def time_unit(span: float) -> tuple[float, str]:
    """Return the unit that gives a span in s a handy size: its factor and its symbol."""
    for seconds, unit, smallest in _TIME_UNITS:
        if span >= smallest * seconds:
            return 1 / seconds, unit
    return 1e3, "ms"


def _shown(motion: PicturedMotion) -> str:
    seconds, word = time_unit(float(motion.t[-1]))
    whole = f"{motion.t[-1] * seconds:.3g} {word}"
    if not len(motion.line):
        return f"rows in {whole}"
    if motion.swings:
        return f"{motion.swings} of the swings in {whole}"
    return whole


@dataclass(frozen=True)
class _Stroke:
    """How a line is drawn: its name in the key, its width in points, and its opacity."""

    name: str
    width: float
    opacity: float = 1.0


def _curves(axes: Any, points: Array, controls: Array, shown: Array, stroke: _Stroke) -> None:
    """Draw a line: a curve from point to point where there is a control point, else a straight line.

    Args:
        axes: of the picture.
        points: shape (points, 2); NaN is a gap.
        controls: of the curve from each point to the next; NaN where it is straight.
        shown: whether the part from each point to the next is drawn.
        stroke: how it is drawn.
    """
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    vertices = []
    codes = []
    pen = None  # the point that it is at
    for i in range(len(points) - 1):
        if not shown[i] or np.isnan(points[i : i + 2]).any():
            continue
        if pen != i:
            vertices.append(points[i])
            codes.append(Outline.MOVETO)
        if np.isnan(controls[i]).any():
            codes.append(Outline.LINETO)
        else:
            vertices.append(controls[i])
            codes += [Outline.CURVE3, Outline.CURVE3]
        vertices.append(points[i + 1])
        pen = i + 1
    style = {"linewidth": stroke.width, "alpha": stroke.opacity}
    axes.plot([], [], color=BLUE, label=stroke.name, **style)
    if vertices:
        outline = Outline(vertices, codes)
        axes.add_patch(PathPatch(outline, fill=False, edgecolor=BLUE, zorder=2, **style))


@dataclass(frozen=True)
class _Projected:
    """Points of the unit sphere as the eye sees them: to the right, up, and towards the eye."""

    right: Array
    up: Array
    near: Array

    @property
    def plane(self) -> Array:
        """The points as they are drawn, shape (points, 2)."""
        return np.column_stack([self.right, self.up])

    @property
    def in_front(self) -> Array:
        """Whether the middle between each point and the next is in front; of the last nothing is known."""
        return np.append(self.near[:-1] + self.near[1:] > 0, False)

    def half(self, front: bool) -> tuple[Array, Array]:
        """Return right and up of the points in front or behind, and NaN for the others."""
        mask = np.where((self.near > 0) == front, 1.0, np.nan)
        return self.right * mask, self.up * mask


def _projected(points: Array) -> _Projected:
    """Return points of the unit sphere, shape (points, 3), as the eye sees them."""
    x, y, z = points.T
    to_eye = x * np.cos(_SEEN_FROM) + y * np.sin(_SEEN_FROM)
    return _Projected(
        right=y * np.cos(_SEEN_FROM) - x * np.sin(_SEEN_FROM),
        up=z * np.cos(_ABOVE) - to_eye * np.sin(_ABOVE),
        near=z * np.sin(_ABOVE) + to_eye * np.cos(_ABOVE),
    )


def time_ticks() -> Any:
    """Return a locator of ticks at round times: every 6 h of 24, every 10 min of 60."""
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(6, steps=[1, 2, 3, 6, 10])


def _value_ticks() -> Any:
    """Return a locator of as many ticks for small axes as for large ones.

    Otherwise the axes, once they have their place, would get other and wider labels, which push the
    title of the axis out of the picture. And both axes of a path have the same ticks.
    """
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(4, steps=[1, 2, 5, 10])


def _key(axes: Any, below: float = 0.2) -> None:
    """Name what is drawn in a row under the axes, this part of their height below them."""
    where = {"loc": "upper center", "bbox_to_anchor": (0.5, -below)}
    axes.legend(ncols=4, fontsize=7.5, handlelength=1.2, columnspacing=1.2, **where)


def _dots(axes: Any, x: Array, y: Array, colour: str, name: str = "") -> None:
    style = {"linestyle": "none", "marker": "o", "markersize": _DOT, "markeredgewidth": 0}
    axes.plot(x, y, color=colour, label=name or None, **style)


def _mark_start(axes: Any, motion: PicturedMotion, x: float, y: float) -> None:
    """Mark the release, or the first row of a file that begins later."""
    name = "release" if motion.t[0] == 0 else "first row"
    style = {"marker": "o", "markersize": 4.5, "linestyle": "none"}
    axes.plot([x], [y], color=INK, label=name, zorder=4, **style)
