"""Charts with a single panel: error against evaluations and tolerance, of formulations, and cost against digits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter
from typing import Any

import numpy as np

from ...methods.method import Family
from ...studies.row import Row
from ..pareto import Curve, cost_of, costs_of_digits, curves, digits_of, whole_evaluations
from .drawing import BAND, COLOURS, FAINT, GUIDE, limits, line_style, logarithmic, sheet, svg_text
from .ladders import CPU, ERROR, band, error_above, family_of, ladders
from .lines import Line, draw, legend

_TICKS = (1, 2, 3, 5, 7, 10, 15, 20, 30, 40, 50, 70, 100, 150, 200, 300, 500)


def precision_ladder(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw CPU seconds against digits achieved; None if no method's setting is the precision.

    The chart shows methods that can compute at several precisions, each in its own formulation. Where the cost of one
    is fitted, the fit is a broad and faint line, and its exponent stands beside the name.
    """
    laws = costs_of_digits(rows, bound_m)
    own = [one for one in curves(rows) if one.own and family_of(one.method) in (Family.MANY_DIGITS, Family.HEYOKA)]
    if not any(one.kind == "precision" and one.measured for one in own):
        return None

    def digits(row: Row) -> float | None:
        return digits_of(row, bound_m) if row.error_m and row.error_m < 0.1 else None

    def name(curve: Curve) -> str:
        law = laws.get(curve.label)
        return curve.label if law is None else f"{curve.label}, ∝ digits^{law.exponent:.2f} ± {law.standard_error:.2f}"

    lines = ladders(own, digits, cost_of, name)
    with sheet((9.5, 5.2)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "y", *limits([cpu for line in lines for cpu in line.y], 0.4, 3.0), 12)
        _digits(axes, *limits([digits for line in lines for digits in line.x], 0.8, 1.4))
        _known(axes, bound_m)
        draw(axes, lines)
        for law in laws.values():
            ends = [law.low, law.high]
            axes.plot(ends, [law(digits) for digits in ends], color=FAINT, linewidth=6, alpha=0.3, zorder=1)
        axes.set(xlabel="digits achieved, −log₁₀ of the largest error in m", ylabel=CPU)
        legend(axes, lines, inside=True)
        return svg_text(figure, "precision", "CPU seconds against digits achieved, log-log, with fitted power laws.")


def _digits(axes: Any, low: float, high: float) -> None:
    from matplotlib.ticker import FixedLocator, FuncFormatter

    logarithmic(axes, "x", low, high)
    axes.xaxis.set_major_locator(FixedLocator([tick for tick in _TICKS if low < tick < high]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _known(axes: Any, bound_m: float) -> None:
    """Draw a band over the digits that the reference itself does not have."""
    high = axes.get_xlim()[1]
    most = -math.log10(bound_m) if bound_m > 0 else math.inf
    if most < high:
        axes.axvspan(most, high, color=BAND, linewidth=0, zorder=0)
        text = f"beyond the reference ({most:.0f} digits) "
        axes.text(high, 0.01, text, transform=axes.get_xaxis_transform(), color=FAINT, fontsize=8, ha="right")


def right_hand_sides(rows: Sequence[Row], bound_m: float, t_end: float) -> str | None:
    """Draw error against evaluations of the right-hand side, for methods that count them; None if there are none."""
    own = [one for one in curves(rows) if one.own]
    return _single(
        ladders(own, lambda row: whole_evaluations(row, t_end), error_above(bound_m)),
        bound_m,
        ("evaluations", "evaluations of the right-hand side", "Error against evaluations of the right-hand side"),
    )


def achieved_tolerance(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw the error achieved against the relative tolerance asked for; None if no method takes a tolerance."""
    own = [one for one in curves(rows) if one.own and one.kind == "tolerance"]
    coarse = [one for one in own if family_of(one.method) != Family.MANY_DIGITS]
    words = ("tolerance", "relative tolerance asked for", "Error achieved against the tolerance asked for")
    lines = ladders(coarse, attrgetter("setting"), error_above(bound_m))
    return _single(lines, bound_m, words, diagonal="error in m = tolerance")


def formulations(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds of formulations of the same equations with one method; None without such rows."""
    every = curves(rows)
    compared = {one.method for one in every if not one.own}
    ladders_of_all = ladders(
        [one for one in every if one.method in compared], cost_of, error_above(bound_m), attrgetter("formulation")
    )
    words = ("formulations", CPU, "Error against CPU seconds of formulations of the same equations")
    lines = [replace(one, style=line_style(COLOURS[i % 6], i)) for i, one in enumerate(ladders_of_all)]
    return _single(lines, bound_m, words)


def _single(lines: Sequence[Line], bound_m: float, words: tuple[str, str, str], diagonal: str = "") -> str | None:
    """Draw one panel; `words` are the picture's name, the label of the horizontal axis and the description."""
    if not lines:
        return None
    with sheet((9.5, 5.6)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "x", *limits([x for one in lines for x in one.x], 0.4, 3.0), 12)
        logarithmic(axes, "y", *limits([y for one in lines for y in one.y], 0.2, 5.0), 16)
        axes.set(xlabel=words[1], ylabel=ERROR)
        band(axes, bound_m)
        draw(axes, lines)
        others = []
        if diagonal:
            low, high = axes.get_xlim()
            ends = np.geomspace(low, high, 9).tolist()
            others.append(Line(diagonal, ends, ends, GUIDE))
            draw(axes, others)
        legend(axes, [*lines, *others])
        return svg_text(figure, words[0], f"{words[2]}, log-log: {', '.join(one.name for one in lines)}.")
