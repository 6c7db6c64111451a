"""Ladders (a method over its settings) as lines of a chart: points, names, and the reference's bound as a band."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ...studies.row import EXTRAPOLATED, Row
from ..pareto import Curve, error_of
from .drawing import BAND, FAINT
from .families import family_of
from .labels import Label, place

Style = dict[str, Any]
Horizontal = Callable[[Row], float | None]

CPU, ERROR = "CPU seconds", "largest error of position in m"
_FAINT = 0.35  # opacity of markers of extrapolated rows


def points(curve: Curve, x_of: Horizontal, bound_m: float) -> tuple[list[float], list[float]]:
    """Return x and y of a ladder's measured rows, loose to tight, without those that a logarithmic axis cannot show."""
    known = [(x, error_of(row, bound_m)) for row in curve.measured if (x := x_of(row)) and error_of(row, bound_m)]
    return [x for x, _ in known], [error for _, error in known]


def draw(axes: Any, ladders: Sequence[Curve], looks: Sequence[Style], x_of: Horizontal, bound_m: float) -> None:
    """Draw ladders as lines with markers, those of extrapolated rows faint."""
    for curve, look in zip(ladders, looks, strict=True):
        axes.plot(*points(curve, x_of, bound_m), **{**look, "marker": ""}, zorder=3)
        for part, alpha in ((False, 1.0), (True, _FAINT)):
            rows = tuple(row for row in curve.measured if (row.status == EXTRAPOLATED) == part)
            selection = Curve(curve.method, curve.formulation, curve.label, rows)
            if rows:
                axes.plot(*points(selection, x_of, bound_m), **{**look, "linestyle": "none"}, alpha=alpha, zorder=4)


def label(
    axes: Any,
    ladders: Sequence[Curve],
    x_of: Horizontal,
    bound_m: float,
    *,
    size: float = 8.0,
    colours: Sequence[str] | None = None,
    others: Sequence[Label] = (),
    lines: Sequence[Curve] = (),
) -> None:
    """Put names at the ladders that are inside the axes; call it last.

    Args:
        axes: matplotlib axes.
        ladders: the ladders to be named.
        x_of: horizontal coordinate of a row.
        bound_m: bound of the reference in m.
        size: font size in points.
        colours: colours of the names; those of the families by default.
        others: further labels.
        lines: further ladders that names should not cover.
    """
    low, high = axes.get_ylim()
    labels = []
    for curve, colour in zip(ladders, colours or [family_of(one.method).colour for one in ladders], strict=True):
        x, y = points(curve, x_of, bound_m)
        if x and any(low <= one <= high for one in y):
            labels.append(Label(curve.label, colour, x, y))
    more = [Label(curve.label, "", *points(curve, x_of, bound_m)) for curve in lines]
    place(axes, [*labels, *others], [*labels, *others, *more], size=size)


def band(axes: Any, bound_m: float) -> None:
    """Draw a band over errors below the bound of the reference, where the reference itself is not known."""
    low, high = axes.get_ylim()
    if low < bound_m < high:
        axes.axhspan(low, bound_m, color=BAND, linewidth=0, zorder=0)
        axes.text(
            0.005, bound_m, f"bound of the reference, {bound_m:.1e} m",
            transform=axes.get_yaxis_transform(), ha="left", va="top", color=FAINT, fontsize=8,
        )  # fmt: skip
