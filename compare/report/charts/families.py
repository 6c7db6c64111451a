"""How a method looks: methods of one family share a colour, within it markers and dashes differ."""

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
class Family:
    """Methods of one kind.

    Attributes:
        title: over its panel.
        colour: of its lines.
        prefixes: of the ids of its methods.
    """

    title: str
    colour: str
    prefixes: tuple[str, ...]


MANY_DIGITS = "many digits"
OTHERS = Family("others", FAINT, ())
FAMILIES = (
    Family("the paper's, fixed step", INK, ("rk4", "rkng")),
    Family("geometric, fixed step", _PURPLE, ("rkmk", "gauss_legendre")),
    Family(MANY_DIGITS, _SKY, ("heyoka_real", "limbs", "mpmath")),
    Family("heyoka, Taylor", _BLUE, ("heyoka",)),
    Family("SciPy", _ORANGE, ("scipy",)),
    Family("numbalsoda and CVODE", _VERMILLION, ("numbalsoda", "cvode")),
    Family("rebound", _GREEN, ("rebound",)),
    OTHERS,
)


def family_of(method: str) -> Family:
    """The family of a method's id."""
    return next((family for family in FAMILIES if method.startswith(family.prefixes)), OTHERS)


def styles(curves: Sequence[Curve]) -> list[dict[str, Any]]:
    """A line style per curve: colour of the family, and marker and dashes by its place in the family."""
    seen: dict[str, int] = {}
    made = []
    for curve in curves:
        family = family_of(curve.method)
        place = seen[family.title] = seen.get(family.title, -1) + 1
        made.append(line_style(family.colour, place))
    return made


def line_style(colour: str, place: int) -> dict[str, Any]:
    """The style of the n-th line of a colour: full and hollow markers take turns."""
    return {
        "color": colour,
        "linestyle": _DASHES[place % len(_DASHES)],
        "linewidth": 1.3,
        "marker": _MARKERS[place % len(_MARKERS)],
        "markersize": 4.5,
        "markerfacecolor": colour if place % 2 == 0 else "none",
        "markeredgewidth": 1.0,
    }
