"""Chart of the errors of approximations over time or one varied quantity, labelled at the lines, legible in grey.

Lines that coincide are drawn once, with all their names. Dashes repeat the information of the colours. Needs the extra
`plot`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from reference import InputError

from ...approximations.approximation import Array
from ...studies.approximation_errors import TimeRow
from ...studies.approximation_limits import SweepRow
from ...studies.variation import UNITS
from ..plotting import COLOURS, SAME_BYTES, pyplot, svg_of

_COLOURS = (COLOURS[-1], *COLOURS[:-1])  # black first
_DASHES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (7, 1.5, 1.2, 1.5)))
_SAME = 0.15  # relative difference: lines that differ by less everywhere are drawn as one
_WRAP = 2  # names per line of a label
_ROW, _GAP = 0.022, 0.008  # height of a line of a label and space around it, as parts of the height of the axes
_NAMES = {
    "error_m": "largest error of position up to then, m",
    "plane_error_arcsec": "largest error of the swing plane, arcsec",
}
_MARKS = {"error_m": ((1e-3, "1 mm"), (1e-6, "1 µm")), "plane_error_arcsec": ((1.0, "1 arcsec"),)}


@dataclass(frozen=True)
class ChartLine:
    """A line of the chart: one or more approximations with the same errors."""

    names: list[str]
    x: Array
    y: Array

    @property
    def label(self) -> str:
        """The names, `_WRAP` to a line."""
        return "\n".join(", ".join(self.names[i : i + _WRAP]) for i in range(0, len(self.names), _WRAP))


def _lines(rows: Sequence[TimeRow | SweepRow], what: str) -> list[ChartLine]:
    """Return the lines of the rows, the one with the largest last error first."""
    lines: list[ChartLine] = []
    for name in dict.fromkeys(row.approximation for row in rows):
        mine = [row for row in rows if row.approximation == name and getattr(row, what)]
        if not mine:
            continue
        x = np.array([row.t if isinstance(row, TimeRow) else row.value for row in mine])
        y = np.array([getattr(row, what) for row in mine])
        for line in lines:
            if len(line.x) == len(x) and np.array_equal(line.x, x) and np.all(np.abs(y / line.y - 1) < _SAME):
                line.names.append(name)
                break
        else:
            lines.append(ChartLine([name], x, y))
    return sorted(lines, key=lambda line: -line.y[-1])


def plot(rows: Sequence[TimeRow | SweepRow], what: str = "error_m", title: str = "") -> str:
    """Return an SVG of the errors in `rows`: those of `error_table` at many times, or of one `sweep`.

    Args:
        rows: rows of one kind; those without an error are left out.
        what: error to draw, `error_m` or `plane_error_arcsec`.
        title: title above the picture.

    Raises:
        InputError: there is nothing to draw, `what` is unknown, or matplotlib is not installed.
    """
    if what not in _NAMES:
        raise InputError("what", what, f"one of {', '.join(_NAMES)}")
    lines = _lines(rows, what)
    if not lines:
        raise InputError("rows", f"{len(rows)} rows", f"some with {what}")
    plt = pyplot("plot")
    with plt.rc_context(SAME_BYTES | {"font.size": 9}):
        tall = max(4.8, 0.42 * sum(len(line.names) for line in lines) / _WRAP + 3)
        figure, axes = plt.subplots(figsize=(9.5, tall), layout="constrained")
        _draw(axes, rows[0], lines, what, title)
        text = svg_of(figure)
        plt.close(figure)
    return text


def _draw(axes: Any, row: TimeRow | SweepRow, lines: list[ChartLine], what: str, title: str) -> None:
    over = "time" if isinstance(row, TimeRow) else row.over
    axes.set_yscale("log")
    if over != "latitude":
        axes.set_xscale("log")
    for i, line in enumerate(lines):
        axes.plot(line.x, line.y, color=_COLOURS[i % 7], linestyle=_DASHES[i % 4], linewidth=1.4)
    low, high = min(line.x[0] for line in lines), max(line.x[-1] for line in lines)
    axes.set_xlim(low, high)
    for height, name in _MARKS[what]:
        if axes.get_ylim()[0] < height < axes.get_ylim()[1]:
            axes.axhline(height, color="0.6", linewidth=0.8, zorder=0)
            axes.annotate(name, (0.01, height), xycoords=("axes fraction", "data"), va="bottom", color="0.35", zorder=1)
    _label(axes, lines)
    axes.set_xlabel("time since release, s" if over == "time" else f"{over.replace('_', ' ')}, {UNITS[over]}")
    axes.set_ylabel(_NAMES[what])
    axes.set_title(title, loc="left")
    axes.grid(True, which="major", color="0.92", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)


def _label(axes: Any, lines: list[ChartLine]) -> None:
    """Put names beside the right ends, moved apart so that they do not touch, each joined to its end by a thin line."""
    low, high = (math.log(limit) for limit in axes.get_ylim())
    tall = [_ROW * (line.label.count("\n") + 1) + _GAP for line in lines]
    ends = [(math.log(line.y[-1]) - low) / (high - low) for line in lines]
    for i, (line, end, place) in enumerate(zip(lines, ends, _apart(ends, tall), strict=True)):
        reach = [1.0, 1.055], [end, place]
        axes.plot(*reach, transform=axes.transAxes, color=_COLOURS[i % 7], linewidth=0.6, clip_on=False)
        axes.text(
            1.06, place, line.label, transform=axes.transAxes, ha="left", va="center", color=_COLOURS[i % 7], fontsize=8
        )


def _apart(ends: list[float], tall: list[float]) -> list[float]:
    """Return decreasing heights nearest to the decreasing `ends` (least squares) at which labels do not touch.

    Args:
        ends: heights of the ends of the lines, largest first.
        tall: heights of the labels.
    """
    offsets = [0.0]
    for upper, lower in pairwise(tall):
        offsets.append(offsets[-1] + (upper + lower) / 2)
    blocks: list[list[float]] = []  # isotonic regression: blocks of labels that touch move as one
    for place, offset in zip(ends, offsets, strict=True):
        blocks.append([place + offset, 1])
        while len(blocks) > 1 and blocks[-2][0] < blocks[-1][0]:
            (one, few), (two, more) = blocks[-2:]
            blocks[-2:] = [[(one * few + two * more) / (few + more), few + more]]
    centres = [value for value, count in blocks for _ in range(int(count))]
    places = [value - offset for value, offset in zip(centres, offsets, strict=True)]
    shift = max(0.0, tall[-1] / 2 - places[-1]) - max(0.0, places[0] + tall[0] / 2 - 1)
    return [place + shift for place in places]
