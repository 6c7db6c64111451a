"""Charts of a study: error against CPU seconds, evaluations and tolerance; the cost of digits.

Each line is a ladder: one method over its settings, in the colour of its family.
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

CPU = "CPU seconds"
ERROR = "largest error of position in m"
_FINEST_M = 1e-20  # smallest error of the upper panel, which shows methods of fixed precision
_SPLIT = 4.0  # the panels meet at the smallest error of these methods divided by this
_BAND_WITHIN = 1e12  # the bound is shown if the smallest error is less than this many times larger
_COLUMNS = 3  # panels side by side
_STRIP = 0.95  # lower edge of the strip of failed rows over the height of the panel
_TICKS = (1, 2, 3, 5, 7, 10, 15, 20, 30, 40, 50, 70, 100, 150, 200, 300, 500)
_BLUE, _VERMILLION, _GREEN, _PURPLE, _ORANGE, _SKY, _INK = COLOURS
_MAGENTA = "#e0007f"  # beside the palette, for the user's own
_USERS_WIDTH = 2.4  # of a line of the user's own, in points
FAMILY_COLOURS = {
    Family.USERS: _MAGENTA,
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
    """Return a method's family; what is not among the methods is the user's program or file."""
    return METHODS[method].family if method in METHODS else Family.USERS


def ladders(
    curves: Iterable[Curve],
    x_of: Coordinate,
    y_of: Coordinate,
    name: Callable[[Curve], str] = attrgetter("label"),
) -> list[Ladder]:
    """Return a line for each curve that has points; within a family, markers and dashes differ.

    Args:
        curves: methods over their settings.
        x_of: horizontal coordinate of a measured row; a row without one, or with zero or infinity,
            is left out.
        y_of: vertical coordinate, likewise.
        name: name of a curve's line.
    """
    places: Counter[Family] = Counter()
    lines = []
    for curve in curves:
        points = [(x_of(row), y_of(row)) for row in curve.measured]
        drawable = [(x, y) for x, y in points if x and y and math.isfinite(x + y)]
        if not drawable:
            continue
        family = family_of(curve.method)
        style = line_style(FAMILY_COLOURS[family], places[family])
        if family == Family.USERS:
            style["linewidth"] = _USERS_WIDTH
        across, up = zip(*drawable, strict=True)
        lines.append(Ladder(name(curve), across, up, style, 1.0, family))
        places[family] += 1
    return lines


def overview(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds, a line per method, with the Pareto front; failed rows on top.

    Errors below those of the methods of fixed precision have a panel of their own. None if no row
    is measured.
    """
    best = front(rows, bound_m)
    shown = _usual_or_on_front(curves(rows), best)
    lines = ladders(shown, cost_of, partial(error_of, bound_m=bound_m))
    if not lines:
        return None
    panels = _panels(lines, bound_m)
    staircase = _staircase(best, bound_m)
    height_in = 8.6 if len(panels) > 1 else 6.6
    with sheet((9.5, height_in)) as figure:
        ratios = [panel.height for panel in panels]
        grid = figure.subplots(len(panels), sharex=True, height_ratios=ratios, squeeze=False)
        x_limits = limits([row.cpu_s for row in rows if row.cpu_s], 0.5, 3.0)
        for axes, panel in zip(grid[:, 0], panels, strict=True):
            logarithmic(axes, "x", *x_limits, 12)
            logarithmic(axes, "y", panel.lowest, panel.highest, panel.labels)
            band(axes, bound_m)
            axes.plot(staircase.x, staircase.y, **staircase.style, zorder=2)
            draw(axes, lines)
        _draw_failed(grid[0, 0], rows)
        grid[-1, 0].set_xlabel(CPU)
        figure.supylabel(ERROR, fontsize=9)
        legend(grid[0, 0], lines)
        names = ", ".join(line.name for line in lines)
        return svg_text(
            figure, "overview", f"Largest position error against CPU seconds, log-log, of {names}."
        )


@dataclass(frozen=True)
class _Panel:
    """A range of errors in m, the relative height of its panel, and how many labels fit beside it."""

    lowest: float
    highest: float
    height: float = 3.4
    labels: int = 18


def _panels(lines: Sequence[Ladder], bound_m: float) -> list[_Panel]:
    """Return one panel, or two if methods of many digits go far below the others."""
    errors = [error for line in lines for error in line.y]
    fixed = [error for line in lines if line.family != Family.MANY_DIGITS for error in line.y]
    finest = min(errors)
    highest = 30 * max(errors)
    split = max(min(fixed) / _SPLIT, _FINEST_M) if fixed else 0.0
    if finest >= split:
        return [_Panel(finest / _SPLIT, highest)]
    bound_is_near = finest / _BAND_WITHIN < bound_m < finest
    lowest = bound_m if bound_is_near else finest
    return [_Panel(split, highest), _Panel(lowest / 30, split, height=1.2, labels=8)]


def _usual_or_on_front(curves: Sequence[Curve], best: Sequence[Row]) -> list[Curve]:
    on_front = {row.key for row in best}

    def is_shown(curve: Curve) -> bool:
        return curve.usual or any(row.key in on_front for row in curve.rows)

    return [curve for curve in curves if is_shown(curve)]


def by_family(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds, a panel per family, with all other methods in grey.

    Methods of many digits are left to `precision_ladder` if there are others. None if no row is
    measured.
    """
    usual = filter(attrgetter("usual"), curves(rows))
    lines = ladders(usual, cost_of, partial(error_of, bound_m=bound_m))
    coarse = [line for line in lines if line.family != Family.MANY_DIGITS] or lines
    present = {line.family for line in coarse}
    families = [family for family in Family if family in present]
    if not families:
        return None
    x_limits = limits(_joined(line.x for line in coarse))
    y_limits = limits(_joined(line.y for line in coarse), 0.2, 6.0)
    down = math.ceil(len(families) / _COLUMNS)
    with sheet((9.5, 2.9 * down)) as figure:
        panels = _family_panels(figure, down, len(families))
        for i, panel in enumerate(panels):
            logarithmic(panel, "x", *x_limits, 6)
            logarithmic(panel, "y", *y_limits, 9)
            lowest_of_its_column = i + _COLUMNS >= len(families)
            panel.tick_params(labelbottom=lowest_of_its_column)
            _draw_family(panel, lines, families[i])
        figure.supxlabel(CPU, fontsize=9)
        figure.supylabel(ERROR, fontsize=9)
        description = f"Error against CPU seconds in small multiples: {', '.join(families)}."
        return svg_text(figure, "families", description)


def _joined(coordinates: Iterable[Sequence[float]]) -> list[float]:
    return [number for of_line in coordinates for number in of_line]


def _family_panels(figure: Any, down: int, count: int) -> Sequence[Any]:
    """Return a number of panels of a grid with so many rows; its other places stay empty."""
    across = min(_COLUMNS, count)
    grid = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False)
    for panel in grid.flat[count:]:
        panel.set_axis_off()
    panels: Sequence[Any] = grid.flat[:count]
    return panels


def _draw_family(panel: Any, lines: Sequence[Ladder], family: Family) -> None:
    """Draw the methods of a family in colour, with their names, and all others in grey."""
    panel.set_title(family)
    members = [line for line in lines if line.family == family]
    for line in lines:
        if line not in members:
            panel.plot(line.x, line.y, color=RULE, linewidth=1.0, zorder=1)
    draw(panel, members)
    legend(panel, members, size=7, inside=True)


def _staircase(best: Sequence[Row], bound_m: float) -> ChartLine:
    """Return the Pareto front as a broad staircase."""
    style = {"color": RULE, "linewidth": 7, "solid_joinstyle": "miter", "drawstyle": "steps-post"}
    costs = [cost_of(row) for row in best]
    errors = [error_of(row, bound_m) for row in best]
    return ChartLine("", costs, errors, style)


def _draw_failed(axes: Any, rows: Sequence[Row]) -> None:
    """Draw failed rows that have a cost as crosses in a strip along the top."""
    strip = {"transform": axes.transAxes, "zorder": 0}
    axes.fill([0, 1, 1, 0], [_STRIP, _STRIP, 1, 1], color=BAND, linewidth=0, **strip)
    middle = (1 + _STRIP) / 2
    axes.text(
        0.995, middle, "failed", ha="right", va="center_baseline", color=FAINT, fontsize=8, **strip
    )
    for row in rows:
        if row.failed and row.cpu_s:
            axes.plot(
                [row.cpu_s],
                [middle],
                marker="x",
                markersize=5,
                color=FAMILY_COLOURS[family_of(row.method)],
                transform=axes.get_xaxis_transform(),
                zorder=5,
            )


def precision_ladder(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw CPU seconds against digits achieved; None if no method's setting is the precision.

    The chart shows the methods that compute at several precisions. A fitted power law is drawn as a
    broad faint line, and its exponent is given beside the name.
    """
    laws = costs_of_digits(rows, bound_m)
    families = (Family.MANY_DIGITS, Family.HEYOKA)
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
        _scale_digits_and_costs(axes, lines)
        _draw_limit_of_reference(axes, bound_m)
        draw(axes, lines)
        for law in laws.values():
            ends = [law.low, law.high]
            fitted = [law(digits) for digits in ends]
            axes.plot(ends, fitted, color=FAINT, linewidth=6, alpha=0.3, zorder=1)
        axes.set(xlabel="digits achieved, −log₁₀ of the largest error in m", ylabel=CPU)
        legend(axes, lines, inside=True)
        description = "CPU seconds against digits achieved, log-log, with fitted power laws."
        return svg_text(figure, "precision", description)


def _scale_digits_and_costs(axes: Any, lines: Sequence[Ladder]) -> None:
    """Make both axes logarithmic, as long as the lines need them."""
    all_costs = [cpu_s for line in lines for cpu_s in line.y]
    all_digits = [digits for line in lines for digits in line.x]
    logarithmic(axes, "y", *limits(all_costs, 0.4, 3.0), 12)
    low, high = limits(all_digits, 0.8, 1.4)
    logarithmic(axes, "x", low, high)
    ticks = [tick for tick in _TICKS if low < tick < high]
    axes.set_xticks(ticks, list(map(str, ticks)))


def _draw_limit_of_reference(axes: Any, bound_m: float) -> None:
    """Draw a band over the digits that the reference itself does not have."""
    highest = axes.get_xlim()[1]
    digits = -math.log10(bound_m) if bound_m > 0 else math.inf
    if digits >= highest:
        return
    axes.axvspan(digits, highest, color=BAND, linewidth=0, zorder=0)
    text = f"beyond the reference ({digits:.0f} digits) "
    place = axes.get_xaxis_transform()
    axes.text(highest, 0.01, text, transform=place, color=FAINT, fontsize=8, ha="right")


def right_hand_sides(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against evaluations of the right-hand side; None if no method counts them."""
    shown = [curve for curve in curves(rows) if curve.usual]
    lines = ladders(shown, attrgetter("rhs_evaluations"), partial(error_of, bound_m=bound_m))
    evaluations = "evaluations of the right-hand side"
    words = _Words("evaluations", evaluations, f"Error against {evaluations}")
    return _single_panel(lines, bound_m, words)


def achieved_tolerance(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw the error achieved against the relative tolerance; None if no method takes one."""
    shown = [curve for curve in curves(rows) if curve.usual and curve.kind == "tolerance"]
    coarse = [curve for curve in shown if family_of(curve.method) != Family.MANY_DIGITS]
    lines = ladders(coarse, attrgetter("setting"), partial(error_of, bound_m=bound_m))
    words = _Words(
        "tolerance",
        "relative tolerance asked for",
        "Error achieved against the tolerance asked for",
    )
    return _single_panel(lines, bound_m, words, diagonal="error in m = tolerance")


def formulations(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds of one method in several formulations.

    None if there are none.
    """
    all_curves = curves(rows)
    compared = {curve.method for curve in all_curves if not curve.usual}
    shown = [curve for curve in all_curves if curve.method in compared]
    error = partial(error_of, bound_m=bound_m)
    lines = ladders(shown, cost_of, error, attrgetter("formulation"))
    lines = [replace(line, style=line_style(COLOURS[i % 6], i)) for i, line in enumerate(lines)]
    description = "Error against CPU seconds of formulations of the same equations"
    return _single_panel(lines, bound_m, _Words("formulations", CPU, description))


@dataclass(frozen=True)
class _Words:
    """A chart's name, the label of its horizontal axis, and what it shows."""

    name: str
    x_label: str
    description: str


def _single_panel(
    lines: Sequence[ChartLine], bound_m: float, words: _Words, diagonal: str = ""
) -> str | None:
    """Draw one panel; `diagonal` names a guide line on which both coordinates are equal."""
    if not lines:
        return None
    description = f"{words.description}, log-log: {', '.join(line.name for line in lines)}."
    all_x = [x for line in lines for x in line.x]
    all_y = [y for line in lines for y in line.y]
    with sheet((9.5, 5.6)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "x", *limits(all_x, 0.4, 3.0), 12)
        logarithmic(axes, "y", *limits(all_y, 0.2, 5.0), 16)
        axes.set(xlabel=words.x_label, ylabel=ERROR)
        band(axes, bound_m)
        if diagonal:
            ends = axes.get_xlim()
            lines = [*lines, ChartLine(diagonal, ends, ends, GUIDE)]
        draw(axes, lines)
        legend(axes, lines)
        return svg_text(figure, words.name, description)
