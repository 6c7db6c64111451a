"""Method and precision of a proof, from the growth of its error bound. Untrusted: the proof measures its widths."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from math import ceil
from typing import Any, NamedTuple

from ..errors import UnreachableError
from ..numbers.precision import log2
from .bound import SceneBalls

MARGIN_BITS = 18  # lost to the rounding of coefficients and to norms; measured on Paris
COLUMN_MARGIN_BITS = 14  # lost besides where the error is carried in columns
RADIUS_BITS = 400  # up to which one radius is always cheaper than columns: a step by columns takes six times as long
RADIUS_SHARE = 0.2  # beyond that, share of the target bits that one radius may lose before columns are cheaper
LEAST_BITS, MAX_BITS = 96, 2048


class ProofPlan(NamedTuple):
    """The method and the precision that an attempt at a proof begins with."""

    method: str  # "radius" or "columns"
    bits: int


Lost = Callable[[int], int]  # bits that an approximant of so many loses, if one radius carries its error


def plan_for(inputs: Any, end: Fraction, radius: Fraction, method: str | None, lost: Lost | None = None) -> ProofPlan:
    """Choose method and precision for balls of `radius` at `end`.

    Raises:
        UnreachableError: it would take more than MAX_BITS.
    """
    balls = SceneBalls(inputs, 128)
    w, span = float(balls.w0), float(end)
    loss = span * float(max(balls.below, balls.above + balls.speed**2, key=float)) / (2 * w) / 0.693
    target = magnitude(inputs.length / radius) + log2(2 + span * w)
    cheap = target + MARGIN_BITS + loss <= RADIUS_BITS or loss <= RADIUS_SHARE * target + MARGIN_BITS
    method = method or ("radius" if cheap else "columns")
    extra = loss if method == "radius" else COLUMN_MARGIN_BITS + 2 * log2(2 + span * w) / 2
    bits = max(LEAST_BITS, 8 * ceil((target + MARGIN_BITS + extra) / 8))
    bits += lost(bits) if lost and method == "radius" else 0
    if bits > MAX_BITS:
        reason = f"enclosure: {short(radius)} m would take more than {MAX_BITS} bits."
        raise UnreachableError(reason, "Ask for fewer digits.")
    return ProofPlan(method, bits)


def magnitude(ratio: Fraction) -> int:
    """Return the logarithm to base 2, about."""
    return ratio.numerator.bit_length() - ratio.denominator.bit_length()


def short(x: Fraction) -> str:
    """Return a number with two digits, even one that a float cannot hold."""
    return f"{Decimal(x.numerator) / Decimal(x.denominator):.1e}"
