"""Figures 1 to 9 of Mathar's paper from runs of the reference: stacked panels, lines and captions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from reference import InputError, load_scene
from reference.errors import Described
from reference.numbers.precision import Array
from reference.system.documents import texts_of

from ..approximations import motions
from ..approximations.frequency import anharmonic
from ..methods import METHODS
from ..methods.method import available
from ..methods.rhs.problem import Problem
from ..observed.swing_plane import rest_in_metres
from ..report.drawing import (
    COLOURS,
    FAINT,
    GUIDE,
    ChartLine,
    draw,
    legend,
    limits,
    logarithmic,
    name_ends,
    picture,
    sheet,
)
from .digits import degrees, mpf
from .points import frequencies, paris, paris_path, paris_swing_plane, window

BLUE, RED, GREEN, PINK, *_, BLACK = COLOURS
DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (6, 2, 1, 2)))
WINDOWS = (0, 7000, 12000)  # s
FIXED_STEP = {"rk4": "-R 4", "rkng56": "-R 5", "rkng67": "-R 6"}
DAY: dict[str, Any] = {"xlabel": "t in h", "xlim": (0, 24), "xticks": range(0, 25, 6)}
LATE: dict[str, Any] = {"xlim": (12000, 12020), "xticks": range(12000, 12021, 10)}
EAST_WEST: dict[str, Any] = {"xlabel": "geodetic latitude in °", "xticks": range(-90, 91, 45)}
# inches: as wide as a telephone's screen, where the letters then are as large as the text beside
# them
WIDE = 4.8
FAINT_DOTS = 0.35  # their opacity
EDGE = 0.5  # inches of a figure's height that no panel has


def _rest_by_latitude() -> list[Panel]:
    latitudes = np.linspace(-90, 90, 37)
    lines = []
    for length, colour, dashes in zip((1, 10, 100), (BLUE, RED, GREEN), DASHES, strict=False):
        p = paris().but(length=mpf(length))
        angles = [abs(degrees(p.but(latitude=mpf(float(d))).case.rest_angle)) for d in latitudes]
        lines.append(line(f"l = {length} m", latitudes, angles, colour, dashes))
    axes = EAST_WEST | {
        "ylabel": "deviation from the vertical in °",
        "xlim": (-90, 90),
        "ylim": (0, 0.105),
    }
    return [Panel(lines, axes, named=True)]


def _triangle() -> list[Panel]:
    # of gravity: on the Earth RΩ² is 0.23 % of it, which nobody would see
    phi, share = float(paris().phi), 0.4
    pivot, foot = np.zeros(2), np.array([0.0, -1.0])  # north and up
    end = foot + share * np.array([-np.sin(phi), np.cos(phi)])
    sides = (
        ("gravity g", pivot, foot, BLACK, "-"),
        ("centrifugal RΩ²", end, foot, RED, "-"),
        ("g'", pivot, end, GREEN, "-"),
        ("rod", pivot, -0.45 * end, BLUE, DASHES[1]),
    )
    lines, names = [], []  # each name stands beside the middle of its side, a little below
    for name, begin, stop, colour, dashes in sides:
        x, y = np.linspace(begin, stop, 9).T
        lines.append(line("", x, y, colour, dashes, 1.8))
        names.append(dots(name, x[4:5], y[4:5] - 0.05, colour, NAME_ONLY))
    angles = [
        dots("φ", [-0.003], [-0.32], FAINT, NAME_ONLY),
        dots("ϕ", [-0.03], [-0.8], FAINT, NAME_ONLY),
    ]
    ends = {"aspect": "equal", "xlim": (-0.8, 0.8), "ylim": (-1.05, 0.4)}
    return [Panel([*lines, *names, *angles], ends, bare=True)]


def _three_windows() -> list[Panel]:
    panels = []
    for begin in WINDOWS:
        times, states = window(begin, 20)
        lines = [
            line("x, east", times - begin, states[:, 0], BLUE),
            line("y, north", times - begin, states[:, 1], RED, DASHES[1]),
            _zero(0, 20),
        ]
        names = {
            "xlabel": "t in s, counted from there" if begin == WINDOWS[-1] else "",
            "ylabel": "m",
        }
        ends = {
            "xlim": (0, 20),
            "ylim": (-0.75, 0.65),
            "xticks": range(0, 21, 5),
            "yticks": (-0.5, 0, 0.5),
        }
        panels.append(
            Panel(lines, names | ends | {"title": f"from {begin} s"}, named=not begin, height=1.5)
        )
    return panels


def _from_above_and_south() -> list[Panel]:
    rest = rest_in_metres(load_scene("paris"))
    above, south = [], []
    for begin, colour, dashes in zip(WINDOWS, (BLUE, RED, GREEN), DASHES, strict=False):
        _, states = window(begin, 17)
        above.append(line(f"from {begin} s", states[:, 0], states[:, 1], colour, dashes))
        south.append(line("", states[:, 0], 1000 * (states[:, 2] + 67), colour, dashes))
    above.append(dots("rest", rest[:1], rest[1:2], BLACK, Marker("P", 6)))
    north = {
        "title": "From above",
        "ylabel": "y (north) in m",
        "xlim": (-0.6, 0.6),
        "ylim": (-0.72, 0.48),
    }
    up = {
        "title": "From the south, heights stretched",
        "ylabel": "z + 67 m, in mm",
        "xlim": (-0.6, 0.6),
    }
    return [
        Panel(above, north | {"aspect": "equal"}, named=True, height=3.4),
        Panel(south, up | {"xlabel": "x (east) in m"}, height=2.0),
    ]


def _heights() -> list[Panel]:
    times, states = paris_path()
    release = line("release", (0, 24), states[[0, 0], 2], RED, DASHES[1], 1)
    return [
        Panel(
            [dots("", times / 3600, states[:, 2], BLUE), release],
            DAY | {"ylabel": "z in m"},
            named=True,
        )
    ]


def _azimuths() -> list[Panel]:
    times, states = paris_path()
    hours, turned = times / 3600, np.degrees(paris_swing_plane())
    lines = [dots("λ", hours, np.degrees(np.arctan2(states[:, 1], states[:, 0])), BLUE)]
    for turn in (-1, 0, 1, 2):
        inside = np.abs(turned + 180 * turn) <= 180
        if inside.any():
            name = "plane" if turn == 1 else ""
            lines.append(line(name, hours[inside], (turned + 180 * turn)[inside], RED, width=1))
    axes = {
        "ylabel": "azimuth in ° (east to north)",
        "ylim": (-180, 180),
        "yticks": range(-180, 181, 60),
    }
    return [Panel(lines, DAY | axes, named=True)]


def _simplified() -> list[Panel]:
    (times, full), paris_scene = window(12000, 20), load_scene("paris")
    curves = (
        ("full", full, PINK, "-", 2.2),
        (
            "Ω = 0",
            window(12000, 20, load_scene("paris", ["site.rotation_rate=0"]))[1],
            GREEN,
            DASHES[3],
        ),
        ("item 2", motions()["mathar_item_2"].trajectory(paris_scene, times), BLUE, DASHES[1]),
        ("item 1", motions()["mathar_item_1"].trajectory(paris_scene, times), RED, DASHES[2]),
    )
    panels = []
    for i, names in enumerate(({"ylabel": "x in m"}, {"ylabel": "y in m", "xlabel": "t in s"})):
        lines = [line(name, times, states[:, i], *style) for name, states, *style in curves]
        panels.append(Panel([*lines, _zero(12000, 12020)], LATE | names, named=not i, height=2.0))
    return panels


def _frequency_by_latitude() -> list[Panel]:
    latitudes, measured = np.linspace(-90, 90, 61), frequencies()
    lines = [
        line("estimate", latitudes, [estimate_at(float(d)) for d in latitudes], RED, width=1),
        dots("runs", list(measured), list(measured.values()), BLUE, Marker("o", 4)),
    ]
    return [Panel(lines, EAST_WEST | {"ylabel": "frequency in Hz", "xlim": (-93, 93)}, named=True)]


def _three_orders() -> list[Panel]:
    (times, truth), (smooth, path) = window(12000, 20, step=0.5), window(12000, 20)
    above, below = [line("", smooth, path[:, 0], FAINT, width=1)], []
    for (name, states), colour, mark in zip(
        orders_at(12000, 20, 0.5).items(), (RED, BLUE, GREEN), "osX", strict=True
    ):
        above.append(dots("", times, states[:, 0], colour, Marker(mark, 5)))
        gap = np.linalg.norm(states.T[:3] - truth.T[:3], axis=0)
        below.append(dots(FIXED_STEP[name], times, gap, colour, Marker(mark, 5), "-"))
    return [
        Panel(above, LATE | {"ylabel": "x in m"}, height=1.9),
        Panel(
            below,
            LATE | {"xlabel": "t in s", "ylabel": "error in m"},
            named=True,
            log=True,
            height=2.2,
        ),
    ]


def _zero(begin: float, end: float) -> ChartLine:
    return ChartLine("", [begin, end], [0, 0], GUIDE)


def estimate_at(latitude: float) -> float:
    """Return the paper's second to last estimate of the frequency in Hz: (51)-(52) with g' of (48), divided by 2K/π."""
    return float(anharmonic(paris().but(latitude=mpf(latitude)).case))


def orders_at(begin: float, span: float, step: float) -> dict[str, Array]:
    """Return the states of the three fixed-step methods of the paper's program at every step of an interval."""
    times = np.arange(round((begin + span) / step) + 1) * step
    problem = Problem.of(load_scene("paris", ["inputs=binary64"]), "plane", times)
    first = round(begin / step)
    return {name: METHODS[name].prepare(problem, step)().states[first:] for name in FIXED_STEP}


def check_methods() -> None:
    """Raise InputError if the methods of figure 9 cannot run here."""
    for name in FIXED_STEP:
        missing = available(METHODS[name])
        if missing is not None:
            raise InputError(
                "--out",
                Described(f"{name}: {missing}"),
                "all methods of figure 9",
                "Install them with pip install 'foucault-reference[methods]'.",
            )


FIGURES: dict[int, Callable[[], list[Panel]]] = dict(enumerate((
    _rest_by_latitude, _triangle, _three_windows, _from_above_and_south, _heights, _azimuths, _simplified,
    _frequency_by_latitude, _three_orders,
), 1))  # fmt: skip
# the title that the paper prints, and a remark on the drawing, by number
CAPTIONS = texts_of(__file__)


@dataclass(frozen=True)
class Panel:
    """One panel.

    Attributes:
        lines: its lines, in data coordinates.
        axes: what matplotlib sets of the axes: labels, title, ends, ticks, and one scale for both
            ("aspect": "equal").
        named: the lines are named in a legend beside the panel, inside it where both axes have one
            scale.
        height: in inches.
        log: the y axis is logarithmic.
        bare: no axes; the lines are named beside their ends.
    """

    lines: Sequence[ChartLine]
    axes: Mapping[str, Any]
    named: bool = False
    height: float = 2.6
    log: bool = False
    bare: bool = False


def line(
    name: str, x: Any, y: Any, colour: str, dashes: Any = "-", width: float = 1.3
) -> ChartLine:
    """Return a line without markers."""
    style = {"color": colour, "linestyle": dashes, "linewidth": width}
    return ChartLine(name, list(map(float, x)), list(map(float, y)), style)


class Marker(NamedTuple):
    """A marker of matplotlib and its size in points; a size of 0 shows the name alone."""

    shape: str
    size: float


DOT = Marker(".", 2)
NAME_ONLY = Marker(".", 0)


def dots(
    name: str, x: Any, y: Any, colour: str, marker: Marker = DOT, dashes: Any = "none"
) -> ChartLine:
    """Return points, joined if `dashes` gives a line style; dots are faint, other markers hollow."""
    joined = line(name, x, y, colour, dashes, 0.7)
    style = {**joined.style, "marker": marker.shape, "markersize": marker.size}
    if marker.shape == DOT.shape:
        return replace(joined, style=style, markers=FAINT_DOTS)
    return replace(joined, style={**style, "markerfacecolor": "none"}, markers=1.0)


def svg(number: int) -> str:
    """Draw a figure as SVG, its first panel on top.

    Raises:
        InputError: matplotlib is not installed.
    """
    panels = FIGURES[number]()
    with sheet((WIDE, EDGE + sum(panel.height for panel in panels))) as figure:
        rows = figure.subplots(
            len(panels), 1, squeeze=False, height_ratios=[panel.height for panel in panels]
        )[:, 0]
        for axes, panel in zip(rows, panels, strict=True):
            _draw(axes, panel)
        return picture(figure).decode()


def _draw(axes: Any, panel: Panel) -> None:
    draw(axes, panel.lines)
    if panel.log:
        logarithmic(axes, "y", *limits([y for line in panel.lines for y in line.y]), 8)
    else:
        axes.ticklabel_format(axis="y", useOffset=False)
    axes.set(**panel.axes)
    names = [line for line in panel.lines if line.name]
    if panel.bare:
        axes.set_axis_off()
        name_ends(axes, names, size=9)
    elif panel.named:
        legend(axes, names, size=9, inside="aspect" in panel.axes)
