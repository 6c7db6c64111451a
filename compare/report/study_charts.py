"""Charts of a study, whose lines are ladders: a method over its settings, in the colour of its family.

They show error against CPU seconds, with the Pareto front, by family and by formulation; against evaluations of the
right-hand side and against the tolerance asked for; and the cost of digits.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter
from typing import Any

from ..methods import METHODS
from ..methods.method import Family
from ..studies.row import Row
from .drawing import (
    BAND,
    COLOURS,
    FAINT,
    GUIDE,
    RULE,
    ChartLine,
    band,
    draw,
    legend,
    limits,
    line_style,
    logarithmic,
    sheet,
    svg_text,
)
from .pareto import Curve, cost_of, costs_of_digits, curves, digits_of, error_of, front

Coordinate = Callable[[Row], float | None]

CPU, ERROR = "CPU seconds", "largest error of position in m"
# m: the upper panel shows the methods of fixed precision, but no errors below this
FINEST_M = 1e-20
_SPLIT = 4.0  # the panels meet at the smallest error of these methods divided by this
_BAND_WITHIN = 1e12  # the bound is shown if the smallest error is less than this many times larger
_COLUMNS = 3  # panels side by side
_STRIP = 0.95  # lower edge of the strip of failed rows, as a part of the height of the panel
_TICKS = (1, 2, 3, 5, 7, 10, 15, 20, 30, 40, 50, 70, 100, 150, 200, 300, 500)
_BLUE, _VERMILLION, _GREEN, _PURPLE, _ORANGE, _SKY, _INK = COLOURS
FAMILY_COLOURS = {
    Family.PAPER: _INK,
    Family.GEOMETRIC: _PURPLE,
    Family.MANY_DIGITS: _SKY,
    Family.HEYOKA: _BLUE,
    Family.SCIPY: _ORANGE,
    Family.COMPILED: _VERMILLION,
    Family.REBOUND: _GREEN,
    Family.OTHERS: FAINT,
}


@dataclass(frozen=True)
class Ladder(ChartLine):
    """A method over its settings as a line; `family` is the method's."""

    family: Family = Family.OTHERS


def family_of(method: str) -> Family:
    """Return a method's family; a program of the user's belongs to the others."""
    return METHODS[method].family if method in METHODS else Family.OTHERS


def ladders(
    curves: Iterable[Curve],
    x_of: Coordinate,
    y_of: Coordinate,
    name: Callable[[Curve], str] = attrgetter("label"),
) -> list[Ladder]:
    """Return a line for each curve that has points; within a family, markers and dashes differ.

    Args:
        curves: methods over their settings.
        x_of: horizontal coordinate of a measured row; a row without one, or with zero or infinity, is left out.
        y_of: vertical coordinate, likewise.
        name: name of a curve's line.
    """
    places: Counter[Family] = Counter()
    lines = []
    for curve in curves:
        points = [
            (x, y)
            for row in curve.measured
            if (x := x_of(row)) and (y := y_of(row)) and math.isfinite(x + y)
        ]
        if points:
            family = family_of(curve.method)
            style = line_style(FAMILY_COLOURS[family], places[family])
            across, up = zip(*points, strict=True)
            lines.append(Ladder(name(curve), across, up, style, 1.0, family))
            places[family] += 1
    return lines


def overview(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds, one line for each method, with the Pareto front and failed rows along the top.

    Errors below those of the methods of fixed precision have a panel of their own. None if no row is measured.
    """
    best = front(rows, bound_m)
    on_front = {row.key for row in best}
    shown = [
        curve
        for curve in curves(rows)
        if curve.usual or any(row.key in on_front for row in curve.rows)
    ]
    lines = ladders(shown, cost_of, partial(error_of, bound_m=bound_m))
    if not lines:
        return None
    scales, staircase = _scales(lines, bound_m), _staircase(best, bound_m)
    with sheet((9.5, 8.6 if len(scales) > 1 else 6.6)) as figure:
        grid = figure.subplots(
            len(scales), sharex=True, height_ratios=(3.4, 1.2)[: len(scales)], squeeze=False
        )
        x_limits = limits([row.cpu_s for row in rows if row.cpu_s], 0.5, 3.0)
        for axes, scale, labels in zip(grid[:, 0], scales, (18, 8), strict=False):
            logarithmic(axes, "x", *x_limits, 12)
            logarithmic(axes, "y", *scale, labels)
            band(axes, bound_m)
            axes.plot(staircase.x, staircase.y, **staircase.style, zorder=2)
            draw(axes, lines)
        _failed(grid[0, 0], rows)
        grid[-1, 0].set_xlabel(CPU)
        figure.supylabel(ERROR, fontsize=9)
        legend(grid[0, 0], lines)
        names = ", ".join(line.name for line in lines)
        return svg_text(
            figure, "overview", f"Largest position error against CPU seconds, log-log, of {names}."
        )


def _scales(lines: Sequence[Ladder], bound_m: float) -> list[tuple[float, float]]:
    """Return the lowest and the highest error of each panel."""
    errors = [error for line in lines for error in line.y]
    fixed = [error for line in lines if line.family != Family.MANY_DIGITS for error in line.y]
    finest, most = min(errors), max(errors) * 30
    split = max(min(fixed) / _SPLIT, FINEST_M) if fixed else 0.0
    if finest >= split:
        return [(finest / _SPLIT, most)]
    lowest = bound_m if finest / _BAND_WITHIN < bound_m < finest else finest
    return [(split, most), (lowest / 30, split)]


def by_family(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds in one panel for each family, with all other methods in grey behind it.

    The family of many digits is left to `precision_ladder` if there are others. None if no row is measured.
    """
    lines = ladders(
        [curve for curve in curves(rows) if curve.usual],
        cost_of,
        partial(error_of, bound_m=bound_m),
    )
    coarse = [line for line in lines if line.family != Family.MANY_DIGITS] or lines
    families = [family for family in Family if any(line.family == family for line in coarse)]
    if not families:
        return None
    x_limits = limits([cpu_s for line in coarse for cpu_s in line.x])
    y_limits = limits([error for line in coarse for error in line.y], 0.2, 6.0)
    count = -(-len(families) // _COLUMNS)
    with sheet((9.5, 2.9 * count)) as figure:
        grid = figure.subplots(
            count, min(_COLUMNS, len(families)), sharex=True, sharey=True, squeeze=False
        )
        for panel in grid.flat[len(families) :]:
            panel.set_axis_off()
        for i, (panel, family) in enumerate(zip(grid.flat, families, strict=False)):
            logarithmic(panel, "x", *x_limits, 6)
            logarithmic(panel, "y", *y_limits, 9)
            panel.tick_params(labelbottom=i + _COLUMNS >= len(families))
            panel.set_title(family)
            for line in lines:
                if line.family != family:
                    panel.plot(line.x, line.y, color=RULE, linewidth=1.0, zorder=1)
            members = [line for line in lines if line.family == family]
            draw(panel, members)
            legend(panel, members, size=7, inside=True)
        figure.supxlabel(CPU, fontsize=9)
        figure.supylabel(ERROR, fontsize=9)
        return svg_text(
            figure,
            "families",
            f"Error against CPU seconds in small multiples: {', '.join(families)}.",
        )


def _staircase(best: Sequence[Row], bound_m: float) -> ChartLine:
    """Return the Pareto front as a broad line: across at the error of each row, then down to that of the next."""
    style = {"color": RULE, "linewidth": 7, "solid_joinstyle": "miter", "drawstyle": "steps-post"}
    return ChartLine(
        "", [cost_of(row) for row in best], [error_of(row, bound_m) for row in best], style
    )


def _failed(axes: Any, rows: Sequence[Row]) -> None:
    """Draw failed rows that have a cost as crosses in a strip along the top, in the colour of their family."""
    strip = {"transform": axes.transAxes, "zorder": 0}
    axes.fill([0, 1, 1, 0], [_STRIP, _STRIP, 1, 1], color=BAND, linewidth=0, **strip)
    middle = (1 + _STRIP) / 2
    axes.text(
        0.995, middle, "failed", ha="right", va="center_baseline", color=FAINT, fontsize=8, **strip
    )
    for row in (row for row in rows if row.failed and row.cpu_s):
        axes.plot(
            [row.cpu_s], [middle], marker="x", markersize=5, color=FAMILY_COLOURS[family_of(row.method)],
            transform=axes.get_xaxis_transform(), zorder=5,
        )  # fmt: skip


def precision_ladder(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw CPU seconds against digits achieved; None if no method's setting is the precision.

    The chart shows methods that can compute at several precisions, each in its own formulation. Where the cost of one
    is fitted, the fit is a broad and faint line, and its exponent stands beside the name.
    """
    laws = costs_of_digits(rows, bound_m)
    families = Family.MANY_DIGITS, Family.HEYOKA
    shown = [curve for curve in curves(rows) if curve.usual and family_of(curve.method) in families]
    if not any(curve.kind == "precision" and curve.measured for curve in shown):
        return None

    def digits(row: Row) -> float | None:
        return digits_of(row, bound_m) if row.error_m and row.error_m < 0.1 else None

    def name(curve: Curve) -> str:
        law = laws.get(curve.label)
        return curve.label if law is None else f"{curve.label}, ∝ digits^{law.exponent:.1f}"

    lines = ladders(shown, digits, cost_of, name)
    with sheet((9.5, 5.2)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "y", *limits([cpu for line in lines for cpu in line.y], 0.4, 3.0), 12)
        low, high = limits([digits for line in lines for digits in line.x], 0.8, 1.4)
        logarithmic(axes, "x", low, high)
        ticks = [tick for tick in _TICKS if low < tick < high]
        axes.set_xticks(ticks, list(map(str, ticks)))
        _known(axes, bound_m)
        draw(axes, lines)
        for law in laws.values():
            ends = [law.low, law.high]
            axes.plot(
                ends,
                [law(digits) for digits in ends],
                color=FAINT,
                linewidth=6,
                alpha=0.3,
                zorder=1,
            )
        axes.set(xlabel="digits achieved, −log₁₀ of the largest error in m", ylabel=CPU)
        legend(axes, lines, inside=True)
        return svg_text(
            figure,
            "precision",
            "CPU seconds against digits achieved, log-log, with fitted power laws.",
        )


def _known(axes: Any, bound_m: float) -> None:
    """Draw a band over the digits that the reference itself does not have."""
    high = axes.get_xlim()[1]
    most = -math.log10(bound_m) if bound_m > 0 else math.inf
    if most < high:
        axes.axvspan(most, high, color=BAND, linewidth=0, zorder=0)
        text = f"beyond the reference ({most:.0f} digits) "
        axes.text(
            high,
            0.01,
            text,
            transform=axes.get_xaxis_transform(),
            color=FAINT,
            fontsize=8,
            ha="right",
        )


def right_hand_sides(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against evaluations of the right-hand side, for methods that count them; None if there are none."""
    shown = [curve for curve in curves(rows) if curve.usual]
    lines = ladders(shown, attrgetter("rhs_evaluations"), partial(error_of, bound_m=bound_m))
    evaluations = "evaluations of the right-hand side"
    return _single(lines, bound_m, ("evaluations", evaluations, f"Error against {evaluations}"))


def achieved_tolerance(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw the error achieved against the relative tolerance asked for; None if no method takes a tolerance."""
    shown = [curve for curve in curves(rows) if curve.usual and curve.kind == "tolerance"]
    coarse = [curve for curve in shown if family_of(curve.method) != Family.MANY_DIGITS]
    words = (
        "tolerance",
        "relative tolerance asked for",
        "Error achieved against the tolerance asked for",
    )
    lines = ladders(coarse, attrgetter("setting"), partial(error_of, bound_m=bound_m))
    return _single(lines, bound_m, words, diagonal="error in m = tolerance")


def formulations(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds of formulations of the same equations with one method; None without such rows."""
    every = curves(rows)
    compared = {curve.method for curve in every if not curve.usual}
    curves_compared = [curve for curve in every if curve.method in compared]
    lines = ladders(
        curves_compared, cost_of, partial(error_of, bound_m=bound_m), attrgetter("formulation")
    )
    words = ("formulations", CPU, "Error against CPU seconds of formulations of the same equations")
    lines = [replace(line, style=line_style(COLOURS[i % 6], i)) for i, line in enumerate(lines)]
    return _single(lines, bound_m, words)


def _single(
    lines: Sequence[ChartLine], bound_m: float, words: tuple[str, str, str], diagonal: str = ""
) -> str | None:
    """Draw one panel; `words` are the picture's name, the label of the horizontal axis and the description.

    A diagonal is a guide line with this name, on which both coordinates are equal.
    """
    if not lines:
        return None
    description = f"{words[2]}, log-log: {', '.join(line.name for line in lines)}."
    with sheet((9.5, 5.6)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "x", *limits([x for line in lines for x in line.x], 0.4, 3.0), 12)
        logarithmic(axes, "y", *limits([y for line in lines for y in line.y], 0.2, 5.0), 16)
        axes.set(xlabel=words[1], ylabel=ERROR)
        band(axes, bound_m)
        if diagonal:
            ends = axes.get_xlim()
            lines = [*lines, ChartLine(diagonal, ends, ends, GUIDE)]
        draw(axes, lines)
        legend(axes, lines)
        return svg_text(figure, words[0], description)
