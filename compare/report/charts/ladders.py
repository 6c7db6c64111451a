"""Ladders (a method over its settings) as lines of a chart, in their family's colours; the bound of the reference."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from reference.status import Status

from ...methods import METHODS
from ...methods.method import Family
from ...studies.row import Row
from ..pareto import Curve, error_of
from .drawing import BAND, COLOURS, FAINT, Line, line_style

Coordinate = Callable[[Row], float | None]

CPU, ERROR = "CPU seconds", "largest error of position in m"
_NARROW = 0.06  # a band below this part of the height of the axes has its text above it
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
class Ladder(Line):
    """A method over its settings as a line; `family` is the method's."""

    family: Family = Family.OTHERS


def family_of(method: str) -> Family:
    """Return a method's family; a program of the user's belongs to the others."""
    return METHODS[method].family if method in METHODS else Family.OTHERS


def ladders(
    curves: Iterable[Curve], x_of: Coordinate, y_of: Coordinate, name: Callable[[Curve], str] = attrgetter("label")
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
            (x, y, row.status == Status.EXTRAPOLATED)
            for row in curve.measured
            if (x := x_of(row)) and (y := y_of(row)) and math.isfinite(x + y)
        ]
        if points:
            family = family_of(curve.method)
            style = line_style(FAMILY_COLOURS[family], places[family])
            across, up, faint = zip(*points, strict=True)
            lines.append(Ladder(name(curve), across, up, style, faint, family))
            places[family] += 1
    return lines


def error_above(bound_m: float) -> Coordinate:
    """Return the coordinate of a row by its error, which counts as no smaller than the bound of the reference."""
    return lambda row: error_of(row, bound_m)


def band(axes: Any, bound_m: float) -> None:
    """Draw a band over errors below the bound of the reference, where the reference itself is not known."""
    low, high = axes.get_ylim()
    if low < bound_m < high:
        axes.axhspan(low, bound_m, color=BAND, linewidth=0, zorder=0)
        inside = math.log(bound_m / low) > _NARROW * math.log(high / low)
        axes.text(
            0.005, low if inside else bound_m, f"bound of the reference, {bound_m:.1e} m",
            transform=axes.get_yaxis_transform(), va="bottom", color=FAINT, fontsize=8,
        )  # fmt: skip
