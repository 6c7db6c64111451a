"""Charts of error against CPU seconds: all methods with the Pareto front, and one panel for each family."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...methods.method import Family
from ...studies.row import Row
from ..pareto import cost_of, curves, error_of, front
from .drawing import BAND, FAINT, RULE, limits, logarithmic, sheet, svg_text
from .ladders import CPU, ERROR, FAMILY_COLOURS, Ladder, band, error_above, family_of, ladders
from .lines import Line, draw, legend

FINEST_M = 1e-20  # m: the upper panel shows the methods of fixed precision, but no errors below this
_SPLIT = 4.0  # the panels meet at the smallest error of these methods divided by this
_BAND_WITHIN = 1e12  # the bound is shown if the smallest error is less than this many times larger
_COLUMNS = 3  # panels side by side
_STRIP = 0.95  # lower edge of the strip of failed rows, as a part of the height of the panel


def overview(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds, one line for each method, with the Pareto front and failed rows along the top.

    Errors below those of the methods of fixed precision have a panel of their own. None if no row is measured.
    """
    best = front(rows, bound_m)
    on_front = {row.key for row in best}
    shown = [one for one in curves(rows) if one.own or any(row.key in on_front for row in one.rows)]
    lines = ladders(shown, cost_of, error_above(bound_m))
    if not lines:
        return None
    scales, staircase = _scales(lines, bound_m), _staircase(best, bound_m)
    with sheet((9.5, 8.6 if len(scales) > 1 else 6.6)) as figure:
        grid = figure.subplots(len(scales), sharex=True, height_ratios=(3.4, 1.2)[: len(scales)], squeeze=False)
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
        names = ", ".join(one.name for one in lines)
        return svg_text(figure, "overview", f"Largest position error against CPU seconds, log-log, of {names}.")


def _scales(lines: Sequence[Ladder], bound_m: float) -> list[tuple[float, float]]:
    """Return the lowest and the highest error of each panel."""
    errors = [error for one in lines for error in one.y]
    fixed = [error for one in lines if one.family != Family.MANY_DIGITS for error in one.y]
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
    lines = ladders([one for one in curves(rows) if one.own], cost_of, error_above(bound_m))
    coarse = [one for one in lines if one.family != Family.MANY_DIGITS] or lines
    families = [family for family in Family if any(one.family == family for one in coarse)]
    if not families:
        return None
    x_limits = limits([cpu_s for one in coarse for cpu_s in one.x])
    y_limits = limits([error for one in coarse for error in one.y], 0.2, 6.0)
    count = -(-len(families) // _COLUMNS)
    with sheet((9.5, 2.9 * count)) as figure:
        grid = figure.subplots(count, min(_COLUMNS, len(families)), sharex=True, sharey=True, squeeze=False)
        for panel in grid.flat[len(families) :]:
            panel.set_axis_off()
        for i, (panel, family) in enumerate(zip(grid.flat, families, strict=False)):
            logarithmic(panel, "x", *x_limits, 6)
            logarithmic(panel, "y", *y_limits, 9)
            panel.tick_params(labelbottom=i + _COLUMNS >= len(families))
            panel.set_title(family)
            for one in lines:
                if one.family != family:
                    panel.plot(one.x, one.y, color=RULE, linewidth=1.0, zorder=1)
            own = [one for one in lines if one.family == family]
            draw(panel, own)
            legend(panel, own, size=7, inside=True)
        figure.supxlabel(CPU, fontsize=9)
        figure.supylabel(ERROR, fontsize=9)
        return svg_text(figure, "families", f"Error against CPU seconds in small multiples: {', '.join(families)}.")


def _staircase(best: Sequence[Row], bound_m: float) -> Line:
    """Return the Pareto front as a broad line: across at the error of each row, then down to that of the next."""
    x, y = [cost_of(row) for row in best], [error_of(row, bound_m) for row in best]
    style = {"color": RULE, "linewidth": 7, "solid_joinstyle": "miter"}
    return Line("", np.repeat(x, 2)[1:].tolist(), np.repeat(y, 2)[:-1].tolist(), style)


def _failed(axes: Any, rows: Sequence[Row]) -> None:
    """Draw failed rows that have a cost as crosses in a strip along the top, in the colour of their family."""
    failed = [row for row in rows if not row.measured and row.cpu_s]
    strip = {"transform": axes.transAxes, "zorder": 0}
    axes.fill([0, 1, 1, 0], [_STRIP, _STRIP, 1, 1], color=BAND, linewidth=0, **strip)
    middle = (1 + _STRIP) / 2
    axes.text(0.995, middle, "failed", ha="right", va="center_baseline", color=FAINT, fontsize=8, **strip)
    for row in failed:
        axes.plot(
            [row.cpu_s], [middle], marker="x", markersize=5, color=FAMILY_COLOURS[family_of(row.method)],
            transform=axes.get_xaxis_transform(), zorder=5,
        )  # fmt: skip
