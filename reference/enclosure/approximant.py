"""The approximant, the polynomials that a proof encloses: an integrator's Taylor steps in the axes of the proof.

Untrusted: the bound measures whatever this module gets wrong. A Taylor expansion serves both sides of its centre, so
only every second one of a chain has to be proved: `pair` joins two time steps into one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

from flint import ctx, fmpz, fmpz_poly

from ..numbers.taylor_step import EARTH, TaylorStep
from .trusted.balls import dot, fixed
from .trusted.system import SceneBalls, scaled

AXES_GUARD_BITS = 16  # precision of the scene's constants beyond the coefficients that they turn
GRAIN = 64  # step sizes are rescaled by multiples of 1/GRAIN
# largest ratio of the time step before to its own that an expansion is stretched to cover
LOPSIDED = Fraction(33, 32)


def turned(inputs: Any, chain: Iterable[TaylorStep]) -> Iterator[TaylorStep]:
    """Turn Taylor steps whose rows are n east, north and up to the axes of the proof, with the λ that fits them."""
    balls: SceneBalls | None = None
    for e in chain:
        if e.columns == EARTH:
            yield e
            continue
        balls = balls or SceneBalls(inputs, e.bits + AXES_GUARD_BITS)
        yield e._replace(rows=partial(_turned_rows, e, balls), columns=EARTH)


def _turned_rows(e: TaylorStep, balls: SceneBalls) -> tuple[list[int], ...]:
    """Return four rows, x, m, w and h² λ."""
    bits, (east, north, up) = e.bits, e.coefficients[:3]
    with ctx.workprec(balls.prec):
        sin, cos = map(int, fixed(list(balls.tilt), bits)[0])
    m = [(y * sin - z * cos) >> bits for y, z in zip(north, up, strict=True)]
    w = [(y * cos + z * sin) >> bits for y, z in zip(north, up, strict=True)]
    p, unit = [fmpz_poly(row) for row in (east, m, w)], fmpz(1) << bits
    turn, _, _, cm, cw = scaled(balls, e.h, bits).integers
    V = [
        f.derivative() + g // unit
        for f, g in zip(p, (-turn * p[1], turn * p[0], fmpz_poly()), strict=True)
    ]
    tension = ((dot(V, V) + cm * p[1] + cw * p[2]) // unit).truncate(len(east))
    return east, m, w, [int(c) for c in tension.coeffs()]


def rescaled(e: TaylorStep, ratio: Fraction) -> TaylorStep:
    """Return the same expansion as polynomials of s / ratio; the ratio is a multiple of 1/GRAIN."""
    return e._replace(h=ratio * e.h, rows=stretched(e.coefficients, (0, 0, 0, 2), ratio))


def stretched(
    rows: Sequence[list[int]], powers: Iterable[int], ratio: Fraction
) -> tuple[list[int], ...]:
    """Return coefficients of s / ratio, each row also times a power of the ratio, which is a multiple of 1/GRAIN."""
    factor, shift = int(ratio * GRAIN), GRAIN.bit_length() - 1
    most = [factor**k for k in range(max(map(len, rows)) + 2)]
    return tuple(
        [c * f >> shift * k for k, (c, f) in enumerate(zip(row, most[power:], strict=False), power)]
        for row, power in zip(rows, powers, strict=True)
    )


def pair(chain: Iterable[TaylorStep]) -> Iterator[TaylorStep]:
    """Yield steps that cover the chain, each from one expansion, used on both sides where its neighbours allow it."""
    before: TaylorStep | None = None
    for e in chain:
        if before is None:
            before = e
            continue
        ratio = before.h / e.h
        if ratio > LOPSIDED:
            yield before._replace(rows=before.coefficients)
            before = e
            continue
        if ratio > 1:
            ceiling = Fraction(-(-ratio.numerator * GRAIN // ratio.denominator), GRAIN)
            wide = rescaled(e, ceiling)
            yield wide._replace(low=-before.h / wide.h, high=e.h / wide.h)
        else:
            yield e._replace(low=-ratio, rows=e.coefficients)
        before = None
    if before is not None:
        yield before._replace(rows=before.coefficients)
