"""Chart of CPU seconds against digits achieved (the precision ladder), with the fitted power laws."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ...methods.method import Family
from ...studies.row import Row
from ..pareto import Curve, cost_of, costs_of_digits, curves, digits_of
from .drawing import BAND, FAINT, limits, logarithmic, sheet, svg_text
from .ladders import CPU, family_of, ladders
from .lines import draw, legend

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
