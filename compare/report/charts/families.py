"""Line styles of methods: a family shares a colour; markers and dashes differ within it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..pareto import Curve
from ..plotting import COLOURS
from .drawing import FAINT, INK

_BLUE, _VERMILLION, _GREEN, _PURPLE, _ORANGE, _SKY, _ = COLOURS
_DASHES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (7, 1.5, 1.2, 1.5)), (0, (3, 3)))
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h")


@dataclass(frozen=True)
class MethodFamily:
    """A family of methods that share a colour.

    Attributes:
        title: title of its panel.
        colour: colour of its lines.
        prefixes: beginnings of the ids of its methods.
    """

    title: str
    colour: str
    prefixes: tuple[str, ...]


MANY_DIGITS = "many digits"
OTHERS = MethodFamily("others", FAINT, ())
FAMILIES = (
    MethodFamily("the paper's, fixed step", INK, ("rk4", "rkng")),
    MethodFamily("geometric, fixed step", _PURPLE, ("rkmk", "gauss_legendre")),
    MethodFamily(MANY_DIGITS, _SKY, ("heyoka_real", "limbs", "mpmath")),
    MethodFamily("heyoka, Taylor", _BLUE, ("heyoka",)),
    MethodFamily("SciPy", _ORANGE, ("scipy",)),
    MethodFamily("numbalsoda and CVODE", _VERMILLION, ("numbalsoda", "cvode")),
    MethodFamily("rebound", _GREEN, ("rebound",)),
    OTHERS,
)


def family_of(method: str) -> MethodFamily:
    """Return the family of a method, by its id."""
    return next((family for family in FAMILIES if method.startswith(family.prefixes)), OTHERS)


def styles(curves: Sequence[Curve]) -> list[dict[str, Any]]:
    """Return a line style for each curve: the colour of its family, marker and dashes by its place in the family."""
    places: dict[str, int] = {}
    looks = []
    for curve in curves:
        family = family_of(curve.method)
        place = places[family.title] = places.get(family.title, -1) + 1
        looks.append(line_style(family.colour, place))
    return looks


def line_style(colour: str, place: int) -> dict[str, Any]:
    """Return the style of the n-th line of a colour; full and hollow markers alternate."""
    return {
        "color": colour,
        "linestyle": _DASHES[place % len(_DASHES)],
        "linewidth": 1.3,
        "marker": _MARKERS[place % len(_MARKERS)],
        "markersize": 4.5,
        "markerfacecolor": colour if place % 2 == 0 else "none",
        "markeredgewidth": 1.0,
    }
