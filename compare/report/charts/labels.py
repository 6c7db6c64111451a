"""Lines of a chart and the placement of their names, which cover neither other names nor lines.

A name stands beside its line; where that is crowded farther away, joined to it by a thin rule; or in the margin.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

_WIDE, _TALL = 0.64, 1.25  # size of a character over the font size: slightly too large, to allow for other fonts
_GAP = 5.0  # between a marker and its name, in points
_MARGIN, _APART = 24.0, 3.0  # between the axes and names in the margin, and between these names, in points
_MOST = 0.45  # of the figure's width, for names in the margin
_MARKER = 2.5  # half the size of a marker, in points: names keep this distance from lines
_EVERY = 3.0  # spacing, in points, of the samples that represent a line
_OUTSIDE, _ON_NAME, _ON_LINE, _AWAY, _CROSSED = 1e6, 1e4, 40.0, 8.0, 1e3  # penalties of a place
_REACHES = (14.0, 24.0, 36.0, 50.0, 66.0, 84.0, 104.0, 130.0)  # of names farther away, in points
_FAR, _TURNS = 60.0, 16  # penalty of not standing beside the line; directions
_FAINT = 0.35  # opacity of faint markers
_SIDES = (
    (1.0, 0.0), (1.0, 0.8), (1.0, -0.8), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (-1.0, 0.8), (-1.0, -0.8),
    (1.0, 1.6), (1.0, -1.6), (-1.0, 1.6), (-1.0, -1.6),
)  # fmt: skip


@dataclass(frozen=True)
class Line:
    """A line of a chart.

    Attributes:
        name: its name, in one or more lines of text.
        x: x of its points, in data coordinates.
        y: y of its points, in data coordinates.
        style: matplotlib's keywords, with the colour; see `line_style`.
        faint: for each point whether its marker is drawn faint; empty for a line without markers.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    style: Mapping[str, Any]
    faint: Sequence[bool] = ()


@dataclass(frozen=True)
class _Place:
    """A place for a name.

    Attributes:
        box: x0, y0, x1, y1 in points.
        away: penalty for the distance from the line.
        side: of the line, -1 to 1.
        rule: both ends of what joins the name to its line, shape (2, 2) in points; None if it stands beside it.
    """

    box: Any
    away: float
    side: float = 1.0
    rule: Any = None


def draw(axes: Any, lines: Sequence[Line]) -> None:
    """Draw lines with their markers."""
    for line in lines:
        axes.plot(line.x, line.y, **{**line.style, "marker": ""}, zorder=3)
        for faint, alpha in ((False, 1.0), (True, _FAINT)):
            marked = [i for i, one in enumerate(line.faint) if one == faint]
            if marked:
                style = {**line.style, "linestyle": "none"}
                axes.plot(line.x, line.y, **style, markevery=marked, alpha=alpha, zorder=4)


def place(
    axes: Any, lines: Sequence[Line], others: Sequence[Line] = (), *, size: float = 8.0, margin: bool = False
) -> None:
    """Write names at their lines; call it last, when the limits of the axes are final.

    Args:
        axes: matplotlib axes.
        lines: lines to be named; one with no point inside the axes gets no name.
        others: further lines that the names should not cover.
        size: font size in points.
        margin: write the names into a column right of the axes, each joined to the end of its line by a thin rule.
    """
    if not lines:
        return
    figure = axes.figure
    if margin:
        room = (_MARGIN + max(_size(line, size)[0] for line in lines)) / 72 / figure.get_figwidth()
        figure.get_layout_engine().set(rect=(0, 0, 1 - min(room, _MOST), 1))
    figure.get_layout_engine().execute(figure)
    scale = 72 / figure.dpi  # points in a pixel
    frame = axes.get_window_extent().extents * scale
    named = [(line, _path(axes, line) * scale) for line in lines]
    if margin:
        named.sort(key=lambda one: -one[1][-1, 1])
    paths = [path for _, path in named] + [_path(axes, line) * scale for line in others]
    samples = np.vstack([_sampled(path) for path in paths])
    placed: list[tuple[float, Any]] = []  # height of the line's end, box of the name
    for line, path in named:
        options = list((_in_margin if margin else _beside)(path, _size(line, size), frame, placed))
        if options:
            boxes = np.array([box for _, box in placed]).reshape(-1, 4)
            penalty = partial(_penalty, boxes=boxes, samples=samples, frame=frame)
            best = min(options, key=penalty)
            if not margin and penalty(best) > _FAR:
                best = min([best, *_apart(path, _size(line, size), frame)], key=penalty)
            placed.append((path[-1, 1], best.box))
            _write(axes, line, best, scale, size)
            if best.rule is not None:
                samples = np.vstack([samples, _sampled(best.rule)])
                style = {"color": line.style["color"], "linewidth": 0.6, "clip_on": False}
                axes.plot(
                    *axes.transData.inverted().transform(best.rule / scale).T, **style, scalex=False, scaley=False
                )


def _write(axes: Any, line: Line, where: _Place, scale: float, size: float) -> None:
    """Write a line's name at its place."""
    x0, y0, x1, y1 = where.box / scale
    side, x = {1.0: ("left", x0), -1.0: ("right", x1), 0.0: ("center", (x0 + x1) / 2)}[where.side]
    axes.text(
        *axes.transData.inverted().transform((x, (y0 + y1) / 2)), line.name, color=line.style["color"], fontsize=size,
        ha=side, va="center" if "\n" in line.name else "center_baseline", in_layout=False,
    )  # fmt: skip


def _path(axes: Any, line: Line) -> Any:
    """Return a line's points in pixels, shape (points, 2)."""
    return axes.transData.transform(np.column_stack([line.x, line.y]))


def _size(line: Line, size: float) -> tuple[float, float]:
    """Return width and height of a name in points."""
    words = line.name.split("\n")
    return _WIDE * size * max(map(len, words)), _TALL * size * len(words)


def _sampled(path: Any) -> Any:
    """Return closely spaced points along a line."""
    parts = [path]
    for a, b in pairwise(path):
        count = int(np.hypot(*(b - a)) / _EVERY) + 1
        parts.append(a + np.linspace(0, 1, count, endpoint=False)[:, None] * (b - a))
    return np.vstack(parts)


def _beside(path: Any, size: tuple[float, float], frame: Any, _: Sequence[tuple[float, Any]]) -> Iterator[_Place]:
    """Yield places around the points of a line: at its end first, then at its start, then in between."""
    wide, tall = size
    for rank, index in enumerate([len(path) - 1, 0, *range(len(path) - 2, 0, -1)]):
        x, y = path[index]
        if not (frame[0] <= x <= frame[2] and frame[1] <= y <= frame[3]):
            continue
        for turn, (side, up) in enumerate(_SIDES):
            left = x + side * _GAP - (0.0 if side > 0 else wide if side < 0 else wide / 2)
            low = y - tall / 2 + up * (tall / 2 + _GAP * (0.9 if side == 0 else 0.2))
            box = np.array([left, low, left + wide, low + tall])
            outside = left < frame[0] or left + wide > frame[2]
            yield _Place(box, _AWAY * rank + turn + _OUTSIDE * outside, side)


def _apart(path: Any, size: tuple[float, float], frame: Any) -> Iterator[_Place]:
    """Yield places farther away from the end, the start and the middle of a line."""
    half = np.array(size) / 2
    for rank, index in enumerate(dict.fromkeys((len(path) - 1, 0, len(path) // 2))):
        point = path[index]
        if not ((frame[:2] <= point) & (point <= frame[2:])).all():
            continue
        for reach in _REACHES:
            for turn in range(_TURNS):
                angle = 2 * np.pi * turn / _TURNS
                middle = point + (reach + half) * (np.cos(angle), np.sin(angle))
                box = np.concatenate([middle - half, middle + half])
                outside = box[0] < frame[0] or box[2] > frame[2]
                rule = np.array([point, point.clip(box[:2], box[2:])])
                yield _Place(box, _FAR + reach + _AWAY * rank + _OUTSIDE * outside, 0.0, rule)


def _in_margin(
    path: Any, size: tuple[float, float], frame: Any, placed: Sequence[tuple[float, Any]]
) -> Iterator[_Place]:
    """Yield places in the margin: at the height of the line's end, and right above and below the names there."""
    wide, tall, left, end = size[0], size[1] + _APART, frame[2] + _MARGIN, path[-1, 1]
    for middle in (end, *(y for _, box in placed for y in (box[1] - tall / 2, box[3] + tall / 2))):
        crossed = sum((height - end) * ((box[1] + box[3]) / 2 - middle) < 0 for height, box in placed)
        box = np.array([left, middle - tall / 2, left + wide, middle + tall / 2])
        yield _Place(box, abs(middle - end) + _CROSSED * crossed, 1.0, np.array([path[-1], [left - _GAP, middle]]))


def _penalty(option: _Place, boxes: Any, samples: Any, frame: Any) -> float:
    """Return the penalty of a place: outside the axes, on other names, on lines, and far from the line's end."""
    box = option.box
    outside = box[1] < frame[1] or box[3] > frame[3]
    shared = (np.minimum(box[2:], boxes[:, 2:]) - np.maximum(box[:2], boxes[:, :2])).clip(0)
    covered = sum((shared[:, 0] * shared[:, 1]).tolist())
    inside = _inside(samples, box)
    struck = 0 if option.rule is None else _inside(_sampled(option.rule), boxes)
    return float(_OUTSIDE * outside + _ON_NAME * covered + _ON_LINE * (inside + struck) + option.away)


def _inside(points: Any, boxes: Any) -> int:
    """Count the points within a box or boxes, of shape (4,) or (boxes, 4), or nearer to them than half a marker."""
    x0, y0, x1, y1 = (boxes[..., i, None] for i in range(4))
    x, y = points[:, 0], points[:, 1]
    within = (x > x0 - _MARKER) & (x < x1 + _MARKER) & (y > y0 - _MARKER) & (y < y1 + _MARKER)
    return int(np.count_nonzero(within))
