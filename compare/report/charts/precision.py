"""Chart of CPU seconds against digits achieved (the precision ladder), with the fitted power law."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ...power_law import PowerLaw
from ...studies.row import Row
from ..pareto import PRECISION_METHOD, Curve, cost_of, cost_of_digits, curves, digits_of
from .drawing import BAND, FAINT, limits, logarithmic, sheet, svg_text
from .families import styles
from .labels import Label, place

_TICKS = (1, 2, 3, 5, 7, 10, 15, 20, 30, 40, 50, 70, 100, 150, 200, 300, 500)
_METHODS = ("heyoka", "limbs", "mpmath")


def precision_ladder(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw CPU seconds against digits achieved, with the fitted power law; None without rows of `heyoka_real`.

    The chart shows methods that can compute at several precisions, each in its own formulation.
    """
    ladders = [one for one in curves(rows) if "(" not in one.label and one.method.startswith(_METHODS)]
    ladders = [one for one in ladders if _points(one, bound_m)[0]]
    if not any(one.method == PRECISION_METHOD for one in ladders):
        return None
    looks = styles(ladders)
    lines = [Label(one.label, look["color"], *_points(one, bound_m)) for one, look in zip(ladders, looks, strict=True)]
    law = cost_of_digits(rows, bound_m)
    with sheet((9.5, 5.2)) as (figure, grid):
        axes = grid[0, 0]
        logarithmic(axes, "y", *limits([cpu for line in lines for cpu in line.y], 0.4, 3.0), 12)
        _digits(axes, *limits([digits for line in lines for digits in line.x], 0.8, 1.4))
        _known(axes, bound_m)
        for line, look in zip(lines, looks, strict=True):
            axes.plot(line.x, line.y, **look, zorder=3)
        axes.set(xlabel="digits achieved, −log₁₀ of the largest error in m", ylabel="CPU seconds")
        place(axes, lines if law is None else [*lines, _law(axes, law)])
        return svg_text(figure, "precision", "CPU seconds against digits achieved, log-log, with the fitted power law.")


def _points(curve: Curve, bound_m: float) -> tuple[list[float], list[float]]:
    known = [row for row in curve.measured if row.error_m and digits_of(row, bound_m) > 1]
    return [digits_of(row, bound_m) for row in known], [cost_of(row) for row in known]


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


def _law(axes: Any, law: PowerLaw) -> Label:
    """Draw the fitted line, wide and faint below the others, and return its label."""
    x, y = [law.low, law.high], [law(law.low), law(law.high)]
    axes.plot(x, y, color=FAINT, linewidth=6, alpha=0.3, zorder=1)
    return Label(f"∝ digits^{law.exponent:.2f} ± {law.standard_error:.2f}", FAINT, x, y)
