"""Proposals for the enclosure, from somebody's Taylor coefficients.

Untrusted: whatever this module gets wrong, the bound measures. An expansion serves both sides of its centre, so only
every second one of a chain has to be proved: `pair` joins them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple, Protocol

from flint import ctx, fmpz, fmpz_poly

from ..packing import WORD_BITS, Words
from .balls import dot, integer
from .bound import World, scaled
from .shapes import Step

GUARD = 16  # bits below those of the steps
GRAIN = 64  # step lengths change by multiples of 1/GRAIN
LOPSIDED = Fraction(33, 32)  # an expansion is stretched to its left by so much and not more


class Expansion(NamedTuple):
    """Taylor coefficients of n and h² λ at `t`, of s = time/h, as integers over 2^bits; to be used up to t + h."""

    t: Fraction
    h: Fraction
    bits: int
    coefficients: tuple[list[int], ...]


class Series(Protocol):
    """What is needed of an expansion; its coefficients are asked for only where they serve."""

    @property
    def t(self) -> Fraction:
        """Centre."""

    @property
    def h(self) -> Fraction:
        """Step."""

    @property
    def bits(self) -> int:
        """Coefficients are integers over 2^bits."""

    @property
    def coefficients(self) -> Sequence[list[int]]:
        """Four rows, x, m, w and h² λ, in the axes of `World`."""


def polynomials(step: Step) -> Step:
    """The step with FLINT's polynomials, which are sooner made of words than of large integers."""
    given, unit = step.coefficients, fmpz(1) << WORD_BITS
    if not isinstance(given, Words):
        return step
    rows = []
    for words in given.table.tolist():
        made = fmpz_poly(words.pop())
        while words:
            made = made * unit + fmpz_poly(words.pop())
        rows.append(made)
    return step._replace(coefficients=rows)


@dataclass(frozen=True)
class Turned:
    """Somebody's polynomials of n, east, north, up, in the axes of the proof, with the λ that goes with them."""

    given: Series
    world: World

    @property
    def t(self) -> Fraction:
        """Centre."""
        return self.given.t

    @property
    def h(self) -> Fraction:
        """Step."""
        return self.given.h

    @property
    def bits(self) -> int:
        """Coefficients are integers over 2^bits."""
        return self.given.bits

    @property
    def coefficients(self) -> tuple[list[int], ...]:
        """Four rows, made when asked for."""
        bits, (east, north, up) = self.bits, self.given.coefficients[:3]
        with ctx.workprec(self.world.prec):
            sin, cos = (int(integer(x, bits)) for x in self.world.tilt)
        m = [(y * sin - z * cos) >> bits for y, z in zip(north, up, strict=True)]
        w = [(y * cos + z * sin) >> bits for y, z in zip(north, up, strict=True)]
        p, unit = [fmpz_poly(row) for row in (east, m, w)], fmpz(1) << bits
        turn, _, _, cm, cw = scaled(self.world, self.h, bits).whole
        V = [f.derivative() + g // unit for f, g in zip(p, (-turn * p[1], turn * p[0], fmpz_poly()), strict=True)]
        pull = ((dot(V, V) + cm * p[1] + cw * p[2]) // unit).truncate(len(east))
        return east, m, w, [int(c) for c in pull.coeffs()]


def turned(inputs: Any, chain: Iterable[Series]) -> Iterator[Turned]:
    """A run's polynomials as a candidate."""
    world: World | None = None
    for e in chain:
        world = world or World(inputs, e.bits + GUARD)
        yield Turned(e, world)


def rescaled(e: Series, ratio: Fraction) -> Expansion:
    """The same expansion in s / ratio; the ratio is a multiple of 1/GRAIN."""
    return Expansion(e.t, ratio * e.h, e.bits, stretched(e.coefficients, (0, 0, 0, 2), ratio))


def stretched(rows: Sequence[list[int]], powers: Iterable[int], ratio: Fraction) -> tuple[list[int], ...]:
    """Coefficients of s / ratio, each row times a power of the ratio besides; the ratio is a multiple of 1/GRAIN."""
    factor, shift = int(ratio * GRAIN), GRAIN.bit_length() - 1
    most = [factor**k for k in range(max(map(len, rows)) + 2)]
    return tuple(
        [c * f >> shift * k for k, (c, f) in enumerate(zip(row, most[power:], strict=False), power)]
        for row, power in zip(rows, powers, strict=True)
    )


def pair(chain: Iterable[Series]) -> Iterator[Step]:
    """Steps that cover the chain, each from one expansion used on both sides where neighbours allow it."""
    before: Series | None = None
    for e in chain:
        if before is None:
            before = e
            continue
        ratio = before.h / e.h
        if ratio > LOPSIDED:
            yield _one_sided(before)
            before = e
            continue
        if ratio > 1:
            ceiling = Fraction(-(-ratio.numerator * GRAIN // ratio.denominator), GRAIN)
            wide = rescaled(e, ceiling)
            yield Step(e.t, wide.h, -before.h / wide.h, e.h / wide.h, e.bits, wide.coefficients)
        else:
            yield Step(e.t, e.h, -ratio, Fraction(1), e.bits, e.coefficients)
        before = None
    if before is not None:
        yield _one_sided(before)


def _one_sided(e: Series) -> Step:
    return Step(e.t, e.h, Fraction(0), Fraction(1), e.bits, e.coefficients)


def coarse(h: Fraction) -> Fraction:
    """About h, with a short binary denominator so that times stay short."""
    shift = 10 - (h.numerator.bit_length() - h.denominator.bit_length())
    scale = Fraction(2) ** shift
    return Fraction(int(h * scale)) / scale
