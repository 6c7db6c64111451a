"""The approximant, the polynomials that a proof encloses: an integrator's Taylor coefficients as steps to prove.

Untrusted: the bound measures whatever this module gets wrong. A Taylor expansion serves both sides of its centre, so
only every second one of a chain has to be proved: `pair` joins two time steps into one.
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

AXES_GUARD_BITS = 16  # precision of the scene's constants beyond the coefficients that they turn
GRAIN = 64  # step sizes are rescaled by multiples of 1/GRAIN
LOPSIDED = Fraction(33, 32)  # largest ratio of the time step before to its own that an expansion is stretched to cover


class TaylorStep(NamedTuple):
    """Taylor coefficients of n and h² λ about `t`, integers over 2^bits; of s = (time - t)/h, used from t to t + h."""

    t: Fraction
    h: Fraction
    bits: int
    coefficients: tuple[list[int], ...]


class TaylorCoefficients(Protocol):
    """Any engine's Taylor step; its coefficients are computed only when they are read."""

    @property
    def t(self) -> Fraction:
        """Centre, in s."""

    @property
    def h(self) -> Fraction:
        """Step size, in s."""

    @property
    def bits(self) -> int:
        """Coefficients are integers over 2^bits."""

    @property
    def coefficients(self) -> Sequence[list[int]]:
        """Four rows, x, m, w and h² λ, in the axes of `World`."""


def polynomials(step: Step) -> Step:
    """Return the step with FLINT's polynomials, which are built faster from words than from large integers."""
    packed, unit = step.coefficients, fmpz(1) << WORD_BITS
    if not isinstance(packed, Words):
        return step
    rows = []
    for words in packed.table.tolist():
        polynomial = fmpz_poly(words.pop())
        while words:
            polynomial = polynomial * unit + fmpz_poly(words.pop())
        rows.append(polynomial)
    return step._replace(coefficients=rows)


@dataclass(frozen=True)
class Turned:
    """A Taylor step whose rows are n east, north and up, turned to the axes of the proof, with the λ that fits it."""

    step: TaylorCoefficients
    world: World

    @property
    def t(self) -> Fraction:
        """Centre, in s."""
        return self.step.t

    @property
    def h(self) -> Fraction:
        """Step size, in s."""
        return self.step.h

    @property
    def bits(self) -> int:
        """Coefficients are integers over 2^bits."""
        return self.step.bits

    @property
    def coefficients(self) -> tuple[list[int], ...]:
        """Four rows, x, m, w and h² λ, computed when they are read."""
        bits, (east, north, up) = self.bits, self.step.coefficients[:3]
        with ctx.workprec(self.world.prec):
            sin, cos = (int(integer(x, bits)) for x in self.world.tilt)
        m = [(y * sin - z * cos) >> bits for y, z in zip(north, up, strict=True)]
        w = [(y * cos + z * sin) >> bits for y, z in zip(north, up, strict=True)]
        p, unit = [fmpz_poly(row) for row in (east, m, w)], fmpz(1) << bits
        turn, _, _, cm, cw = scaled(self.world, self.h, bits).whole
        V = [f.derivative() + g // unit for f, g in zip(p, (-turn * p[1], turn * p[0], fmpz_poly()), strict=True)]
        tension = ((dot(V, V) + cm * p[1] + cw * p[2]) // unit).truncate(len(east))
        return east, m, w, [int(c) for c in tension.coeffs()]


def turned(inputs: Any, chain: Iterable[TaylorCoefficients]) -> Iterator[Turned]:
    """Turn a run's Taylor steps (rows east, north, up) to the axes of the proof."""
    world: World | None = None
    for e in chain:
        world = world or World(inputs, e.bits + AXES_GUARD_BITS)
        yield Turned(e, world)


def rescaled(e: TaylorCoefficients, ratio: Fraction) -> TaylorStep:
    """Return the same expansion as polynomials of s / ratio; the ratio is a multiple of 1/GRAIN."""
    return TaylorStep(e.t, ratio * e.h, e.bits, stretched(e.coefficients, (0, 0, 0, 2), ratio))


def stretched(rows: Sequence[list[int]], powers: Iterable[int], ratio: Fraction) -> tuple[list[int], ...]:
    """Return coefficients of s / ratio, each row also times a power of the ratio, which is a multiple of 1/GRAIN."""
    factor, shift = int(ratio * GRAIN), GRAIN.bit_length() - 1
    most = [factor**k for k in range(max(map(len, rows)) + 2)]
    return tuple(
        [c * f >> shift * k for k, (c, f) in enumerate(zip(row, most[power:], strict=False), power)]
        for row, power in zip(rows, powers, strict=True)
    )


def pair(chain: Iterable[TaylorCoefficients]) -> Iterator[Step]:
    """Yield steps that cover the chain, each from one expansion, used on both sides where its neighbours allow it."""
    before: TaylorCoefficients | None = None
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


def _one_sided(e: TaylorCoefficients) -> Step:
    return Step(e.t, e.h, Fraction(0), Fraction(1), e.bits, e.coefficients)
