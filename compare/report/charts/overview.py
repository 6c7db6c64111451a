"""Charts of error against CPU seconds: all methods with the Pareto front, and one panel for each family."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...studies.row import Row
from ..pareto import Curve, cost_of, curves, error_of, front
from .drawing import BAND, FAINT, RULE, limits, logarithmic, sheet, svg_text
from .families import FAMILIES, MANY_DIGITS, family_of, styles
from .ladders import CPU, ERROR, band, draw, label, points

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
    ladders = [one for one in curves(rows) if "(" not in one.label or any(row.key in on_front for row in one.rows)]
    ladders = [one for one in ladders if points(one, cost_of, bound_m)[0]]
    if not ladders:
        return None
    scales = _scales(ladders, bound_m)
    with sheet(
        (9.5, 8.6 if len(scales) > 1 else 6.6), len(scales), sharex=True, height_ratios=(3.4, 1.2)[: len(scales)]
    ) as (
        figure,
        axes,
    ):
        x_limits = limits([row.cpu_s for row in rows if row.cpu_s], 0.5, 3.0)
        for panel, scale in zip(axes[:, 0], scales, strict=True):
            logarithmic(panel, "x", *x_limits, 12)
            logarithmic(panel, "y", *scale, 18 if panel is axes[0, 0] else 8)
            band(panel, bound_m)
            _front_line(panel, best, bound_m)
            draw(panel, ladders, styles(ladders), cost_of, bound_m)
        _failed(axes[0, 0], rows)
        axes[-1, 0].set_xlabel(CPU)
        figure.supylabel(ERROR, fontsize=9)
        for panel, (low, high) in zip(axes[:, 0], scales, strict=True):
            ending = [one for one in ladders if low <= points(one, cost_of, bound_m)[1][-1] < high]
            label(panel, ending, cost_of, bound_m, lines=ladders)
        names = ", ".join(one.label for one in ladders)
        return svg_text(figure, "overview", f"Largest position error against CPU seconds, log-log, of {names}.")


def _scales(ladders: Sequence[Curve], bound_m: float) -> list[tuple[float, float]]:
    """Return the lowest and the highest error of each panel."""
    errors = [error for one in ladders for error in points(one, cost_of, bound_m)[1]]
    split = _split(ladders, bound_m)
    if split is None:
        return [(min(errors) / _SPLIT, max(errors) * 30)]
    finest = min(errors)
    lowest = bound_m if finest / _BAND_WITHIN < bound_m < finest else finest
    return [(split, max(errors) * 30), (lowest / 30, split)]


def _split(ladders: Sequence[Curve], bound_m: float) -> float | None:
    """Return the error at which the panels meet; None if one panel is enough."""
    ends = {True: [], False: []}  # type: dict[bool, list[float]]
    for one in ladders:
        ends[family_of(one.method).title == MANY_DIGITS] += points(one, cost_of, bound_m)[1]
    if not ends[False]:
        return None
    split = max(min(ends[False]) / _SPLIT, FINEST_M)
    return split if min([*ends[True], *ends[False]]) < split else None


def by_family(rows: Sequence[Row], bound_m: float) -> str | None:
    """Draw error against CPU seconds in one panel for each family, with all other methods in grey behind it.

    The family of many digits is left to `precision_ladder` if there are others. None if no row is measured.
    """
    own = [one for one in curves(rows) if "(" not in one.label and points(one, cost_of, bound_m)[0]]
    coarse = [one for one in own if family_of(one.method).title != MANY_DIGITS] or own
    families = [one for one in FAMILIES if any(family_of(curve.method) == one for curve in coarse)]
    if not families:
        return None
    x_limits = limits([cpu_s for one in coarse for cpu_s in points(one, cost_of, bound_m)[0]])
    y_limits = limits([error for one in coarse for error in points(one, cost_of, bound_m)[1]], 0.2, 6.0)
    count, looks = -(-len(families) // _COLUMNS), styles(own)
    with sheet((9.5, 2.9 * count), count, min(_COLUMNS, len(families)), sharex=True, sharey=True) as (figure, axes):
        for i, panel in enumerate(axes.flat):
            if i >= len(families):
                panel.set_axis_off()
                continue
            logarithmic(panel, "x", *x_limits, 6)
            logarithmic(panel, "y", *y_limits, 9)
            panel.tick_params(labelbottom=i + _COLUMNS >= len(families))
            panel.set_title(families[i].title)
            for curve, look in zip(own, looks, strict=True):
                if family_of(curve.method) == families[i]:
                    draw(panel, [curve], [look], cost_of, bound_m)
                else:
                    panel.plot(*points(curve, cost_of, bound_m), color=RULE, linewidth=1.0, zorder=1)
        figure.supxlabel(CPU, fontsize=9)
        figure.supylabel(ERROR, fontsize=9)
        for panel, family in zip(axes.flat, families, strict=False):
            label(panel, [curve for curve in own if family_of(curve.method) == family], cost_of, bound_m, size=7.5)
        names = ", ".join(family.title for family in families)
        return svg_text(figure, "families", f"Error against CPU seconds in small multiples: {names}.")


def _front_line(axes: Any, best: Sequence[Row], bound_m: float) -> None:
    x, y = [cost_of(row) for row in best], [error_of(row, bound_m) for row in best]
    axes.plot(x, y, drawstyle="steps-post", color=RULE, linewidth=7, solid_joinstyle="miter", zorder=2)


def _failed(axes: Any, rows: Sequence[Row]) -> None:
    """Draw failed rows that have a cost as crosses in a strip along the top, in the colour of their family."""
    failed = [row for row in rows if not row.measured and row.cpu_s]
    strip = {"transform": axes.transAxes, "zorder": 0}
    axes.fill([0, 1, 1, 0], [_STRIP, _STRIP, 1, 1], color=BAND, linewidth=0, **strip)
    middle = (1 + _STRIP) / 2
    axes.text(0.995, middle, "failed", ha="right", va="center_baseline", color=FAINT, fontsize=8, **strip)
    for row in failed:
        axes.plot(
            [row.cpu_s], [middle], marker="x", markersize=5, color=family_of(row.method).colour,
            transform=axes.get_xaxis_transform(), zorder=5,
        )  # fmt: skip
