"""Charts of stability: the heat map of digits by scene and method, and the growth of errors over long runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference.plain_text import shortened
from reference.status import Status

from ..observed.least_squares import largest_so_far
from ..studies.long_runs import LongRun
from ..studies.stability import Cell
from ..studies.users_program import NUMBER
from .drawing import (
    BAND,
    COLOURS,
    FAINT,
    GUIDE,
    INK,
    PAPER,
    ChartLine,
    band,
    draw,
    legend,
    line_style,
    logarithmic,
    name_ends,
    sheet,
    svg_text,
)

LETTERS = {
    Status.SILENTLY_WRONG: "W",
    Status.ILL_CONDITIONED: "I",
    Status.NOT_FINITE: "N",
    Status.GAVE_UP: "G",
    Status.CRASHED: "C",
    Status.OUT_OF_TIME: "T",
    Status.MISSED_TRANSITS: "M",
    Status.REFUSED: "R",
    Status.UNREACHABLE: "U",
    Status.NOT_INSTALLED: "–",
}
_LOUD = Status.SILENTLY_WRONG  # the status that stands out by its colour
_LOUD_COLOUR = "#D55E00"
_QUIET_COLOUR = "#F2C9A8"
_STEPS = (3, 6, 9, 12, 15)  # digits at which the colour changes
# few to many digits, in grey as well
_BLUES = ("#dbe9f4", "#b3d1e8", "#7fb3d9", "#4292c6", "#1f6aa8", "#0b4477")
_DARK_FROM = 3  # index of the first blue with white text
_SQUARE = 0.27  # side of a square of the map in inches
_MARGINS = (2.3, 1.9)  # width and height for the names, in inches
LONGEST_NAME = 30  # characters of a scene's name, which may be the path of a file
_CHARACTER = 0.27  # width of a character in squares
_LEAST_COLUMNS = 15  # columns of squares that the key needs
_KEY_ROWS = 5.5  # rows of squares that it needs

_SLOPES = ((1.0, "t"), (1.5, "t^1.5"), (2.0, "t²"))
_POINTS = 240  # points of a line
_FAN = 50.0  # length of the guide lines as a factor of time
_BEFORE = 5.0  # they end this factor of time before the lines do
# distance of the fan from the lines, as a power of the span of errors: room for its names
_ABOVE = 0.045
_OVER = 20.0  # room above the lines, as a factor of error
_BELOW = 1e3  # room below the bound of the reference, for its name, as a factor of error


def heat_map(cells: Sequence[Cell]) -> str:
    """Draw a map of scenes by methods, in order of appearance: digits kept, rounded down, or a letter for a failure."""
    columns = list(dict.fromkeys(map(_column, cells)))
    scenes = list(dict.fromkeys(cell.scene for cell in cells))
    wide = max(len(columns), _LEAST_COLUMNS)
    high = len(scenes) + _KEY_ROWS
    with sheet((_MARGINS[0] + _SQUARE * wide, _MARGINS[1] + _SQUARE * high)) as figure:
        axes = figure.subplots()
        axes.set(xlim=(0, wide), ylim=(high, 0), aspect="equal")
        for cell in cells:
            x = columns.index(_column(cell))
            y = scenes.index(cell.scene)
            _square(axes, x, y, cell.status, cell.digits)
        _key(axes, len(scenes) + 0.7, wide, {cell.status for cell in cells})
        axes.set_xticks(
            [i + 0.5 for i in range(len(columns))],
            columns,
            rotation=55,
            rotation_mode="anchor",
            ha="left",
            fontsize=8,
        )
        names = [shortened(scene, LONGEST_NAME) for scene in scenes]
        axes.set_yticks([i + 0.5 for i in range(len(scenes))], names, fontsize=8)
        axes.tick_params(length=0, top=False, labeltop=True, labelbottom=False, bottom=False, pad=2)
        axes.spines[:].set_visible(False)
        wrong = sum(cell.status == _LOUD for cell in cells)
        description = f"{len(scenes)} scenes by {len(columns)} methods; silently wrong: {wrong}."
        return svg_text(figure, "map", description, "map")


def _column(cell: Cell) -> str:
    """Return a cell's method and formulation, with the number type unless that is double."""
    number, _, formulation = cell.precision.partition(", ")
    if number == NUMBER:  # a program of the user's
        return cell.method
    if number == "double":
        return f"{cell.method} {formulation}".strip()
    return f"{cell.method} {number} {formulation}".strip()


def _square(axes: Any, x: float, y: float, status: Status, digits: float | None = None) -> None:
    """Draw a square with its mark: digits kept, rounded down, or the letter of a status."""
    look = _look_of(status, digits)
    axes.fill(
        [x, x + 0.94, x + 0.94, x],
        [y, y, y + 0.94, y + 0.94],
        color=look.colour,
        linewidth=0,
    )
    axes.text(
        x + 0.47,
        y + 0.5,
        _mark_of(status, digits),
        ha="center",
        va="center_baseline",
        fontsize=7.5,
        color=look.ink,
        weight="bold" if status == _LOUD else "normal",
    )


@dataclass(frozen=True)
class _Look:
    """Colours of a square and of its mark."""

    colour: str
    ink: str


def _look_of(status: Status, digits: float | None) -> _Look:
    if status == Status.OK:
        shade = sum((digits or 0.0) >= step for step in _STEPS)
        return _Look(_BLUES[shade], PAPER if shade >= _DARK_FROM else "#10202c")
    if status == Status.NOT_INSTALLED:
        return _Look(BAND, FAINT)
    if status == _LOUD:
        return _Look(_LOUD_COLOUR, "#000000")
    return _Look(_QUIET_COLOUR, "#3a1c05")


def _mark_of(status: Status, digits: float | None) -> str:
    if status in LETTERS:
        return LETTERS[status]
    if digits is None:
        return "?"
    return f"{int(max(0.0, digits))}"


def _key(axes: Any, y: float, wide: float, present: set[Status]) -> None:
    """Draw the key below the map."""
    for i, digits in enumerate([0.0, *_STEPS]):
        _square(axes, i, y, Status.OK, digits)
    axes.text(
        len(_STEPS) + 1.3,
        y + 0.5,
        "digits kept, at least",
        fontsize=8,
        va="center_baseline",
        color=INK,
    )
    x = 0.0
    for status in [status for status in LETTERS if status in present]:
        needs = 1.7 + _CHARACTER * len(status.words)
        if x == 0.0 or x + needs > wide:
            x = 0.0
            y += 1.2
        _square(axes, x, y, status)
        axes.text(x + 1.2, y + 0.5, status.words, fontsize=8, va="center_baseline", color=INK)
        x += needs


def error_growth(runs: Sequence[LongRun]) -> str:
    """Draw the largest error so far of each run over time, log-log, with the exponent that was fitted to it.

    Guide lines have the slopes t, t^1.5 (Brouwer's law) and t², and a band is the bound of the
    reference.
    """
    lines = [_line(run, i) for i, run in enumerate(runs)]
    guides = _guides(lines)
    bound_m = max(run.bound_m for run in runs)
    with sheet((9.5, 6.0)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "x", min(line.x[0] for line in lines), max(line.x[-1] for line in lines))
        lowest = min(line.y[0] for line in lines) / 5
        lowest = min(lowest, bound_m / _BELOW) if bound_m > lowest else lowest
        logarithmic(axes, "y", lowest, _OVER * max(line.y[-1] for line in (*lines, *guides)), 16)
        band(axes, bound_m)
        draw(axes, [*lines, *guides])
        axes.set(xlabel="time in s", ylabel="largest error of position so far in m")
        legend(axes, sorted(lines, key=lambda line: -line.y[-1]))
        name_ends(axes, guides)
        names = ", ".join(f"{run.method}, {run.formulation}" for run in runs)
        return svg_text(figure, "growth", f"Error over time, log-log: {names}.")


def _line(run: LongRun, place: int) -> ChartLine:
    """Return the largest error so far of a run as a line, with the exponent in its name."""
    t = np.array(run.t)
    error = np.array(run.error_m)
    positive = (t > 0) & (np.maximum.accumulate(error) > 0)
    t, largest = largest_so_far(t[positive], error[positive], _POINTS)
    name = f"{run.method}, {run.formulation}, t^{run.exponent:.2f}"
    style = line_style(COLOURS[place % len(COLOURS)], place)
    return ChartLine(name, t.tolist(), largest.tolist(), style)


def _guides(lines: Sequence[ChartLine]) -> list[ChartLine]:
    """Return a fan of guide lines above all lines: slopes are the same everywhere."""
    end = max(line.x[-1] for line in lines) / _BEFORE
    start = end / _FAN
    highest = max(float(np.interp(start, line.x, line.y)) for line in lines)
    span = max(line.y[-1] for line in lines) / min(line.y[0] for line in lines)
    low = highest * max(4.0, span**_ABOVE)
    return [
        ChartLine(name, [start, end], [low, low * _FAN**slope], GUIDE) for slope, name in _SLOPES
    ]
