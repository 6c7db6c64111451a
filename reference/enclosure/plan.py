"""Method, order and precision of a proof, from the bound's own growth rate. Untrusted: the widths are measured."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from math import ceil, log2
from typing import Any, NamedTuple

from ..errors import UnreachableError
from .bound import World
from .candidate import coarse

MARGIN = 18  # bits lost to coefficient rounding and norms; measured on Paris
COLUMN_MARGIN = 14  # the same, more, with columns
ORDER_PER_BIT = 0.5  # measured optimum, flat
GROWTH_SHARE = 0.2  # bits of growth that one radius may cost before columns are cheaper
LEAST_BITS, MAX_BITS = 96, 2048


class Plan(NamedTuple):
    """What a proof is begun with; `first` is a step in s."""

    method: str  # "radius" or "columns"
    bits: int
    order: int
    first: Fraction


def order_for(bits: int) -> int:
    """Of the package's own series."""
    return max(24, round(ORDER_PER_BIT * bits))


def plan_for(inputs: Any, end: Fraction, radius: Fraction, method: str | None) -> Plan:
    """Method and precision from the bound's own growth rate."""
    world = World(inputs, 128)
    w, span = float(world.w0), float(end)
    growth = span * float(max(world.below, world.above + world.speed**2, key=float)) / (2 * w) / 0.693
    ratio = inputs.length / radius
    wanted = ratio.numerator.bit_length() - ratio.denominator.bit_length() + log2(2 + span * w)
    method = method or ("radius" if growth <= GROWTH_SHARE * wanted + MARGIN else "columns")
    extra = growth if method == "radius" else COLUMN_MARGIN + 2 * log2(2 + span * w) / 2
    bits = max(LEAST_BITS, 8 * ceil((wanted + MARGIN + extra) / 8))
    if bits > MAX_BITS:
        said = f"enclosure: {short(radius)} m would take more than {MAX_BITS} bits."
        raise UnreachableError(said, "Ask for fewer digits.")
    return Plan(method, bits, order_for(bits), coarse(Fraction(1 / (4 * w))))


def short(x: Fraction) -> str:
    """Two digits, also of what a float cannot hold."""
    return f"{Decimal(x.numerator) / Decimal(x.denominator):.1e}"
