"""Ladders of methods as lines in a picture: their points, their names, and the bound of the reference as a band."""

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
_FAINT = 0.35  # opacity of what is extrapolated


def points(curve: Curve, x_of: Horizontal, bound_m: float) -> tuple[list[float], list[float]]:
    """Where a ladder's measured rows stand, from loose to tight, without what a logarithmic axis cannot show."""
    known = [(x, error_of(row, bound_m)) for row in curve.measured if (x := x_of(row)) and error_of(row, bound_m)]
    return [x for x, _ in known], [error for _, error in known]


def draw(axes: Any, drawn: Sequence[Curve], looks: Sequence[Style], x_of: Horizontal, bound_m: float) -> None:
    """Lines with marks, the marks of extrapolated rows faint."""
    for curve, look in zip(drawn, looks, strict=True):
        axes.plot(*points(curve, x_of, bound_m), **{**look, "marker": ""}, zorder=3)
        for part, alpha in ((False, 1.0), (True, _FAINT)):
            rows = tuple(row for row in curve.measured if (row.status == EXTRAPOLATED) == part)
            some = Curve(curve.method, curve.formulation, curve.label, rows)
            if rows:
                axes.plot(*points(some, x_of, bound_m), **{**look, "linestyle": "none"}, alpha=alpha, zorder=4)


def label(
    axes: Any,
    drawn: Sequence[Curve],
    x_of: Horizontal,
    bound_m: float,
    *,
    size: float = 8.0,
    colours: Sequence[str] | None = None,
    others: Sequence[Label] = (),
    lines: Sequence[Curve] = (),
) -> None:
    """Put names at lines that are in sight; call it last.

    Args:
        axes: of matplotlib.
        drawn: what is named.
        x_of: horizontal place of a row.
        bound_m: of the reference.
        size: of the font in points.
        colours: of the names, those of the families if not given.
        others: further labels.
        lines: more lines that names should not cover.
    """
    low, high = axes.get_ylim()
    made = []
    for curve, colour in zip(drawn, colours or [family_of(one.method).colour for one in drawn], strict=True):
        x, y = points(curve, x_of, bound_m)
        if x and any(low <= one <= high for one in y):
            made.append(Label(curve.label, colour, x, y))
    more = [Label(curve.label, "", *points(curve, x_of, bound_m)) for curve in lines]
    place(axes, [*made, *others], [*made, *others, *more], size=size)


def band(axes: Any, bound_m: float) -> None:
    """The band below which the reference itself is not known."""
    low, high = axes.get_ylim()
    if low < bound_m < high:
        axes.axhspan(low, bound_m, color=BAND, linewidth=0, zorder=0)
        axes.text(
            0.005, bound_m, f"bound of the reference, {bound_m:.1e} m",
            transform=axes.get_yaxis_transform(), ha="left", va="top", color=FAINT, fontsize=8,
        )  # fmt: skip
