"""The approximant of a proof: an integrator's Taylor steps in the axes of the proof.

Untrusted: the bound measures whatever this module gets wrong. A Taylor expansion serves both sides of
its centre, so only every second one of a chain has to be proved: `pair` joins two time steps into one.
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
    """Turn Taylor steps with rows east, north, up to the axes of the proof, and add a row for λ."""
    balls: SceneBalls | None = None
    for step in chain:
        if step.columns == EARTH:
            yield step
            continue
        balls = balls or SceneBalls(inputs, step.bits + AXES_GUARD_BITS)
        yield step._replace(rows=partial(_turned_rows, step, balls), columns=EARTH)


def _turned_rows(step: TaylorStep, balls: SceneBalls) -> tuple[list[int], ...]:
    """Return four rows, x, m, w and h² λ."""
    bits = step.bits
    east, north, up = step.coefficients[:3]
    with ctx.workprec(balls.prec):
        tilt, _ = fixed(list(balls.tilt), bits)
    sin, cos = map(int, tilt)
    x_row = east
    m_row = [(y * sin - z * cos) >> bits for y, z in zip(north, up, strict=True)]
    w_row = [(y * cos + z * sin) >> bits for y, z in zip(north, up, strict=True)]

    # λ = v·v + r·force is V·V + r·c, with V = v + Ω × r
    unit = fmpz(1) << bits
    constants = scaled(balls, step.h, bits).integers
    x, m, w = (fmpz_poly(row) for row in (x_row, m_row, w_row))
    V = [
        x.derivative() + (-constants.omega * m) // unit,
        m.derivative() + (constants.omega * x) // unit,
        w.derivative(),
    ]
    tension = (dot(V, V) + constants.c_m * m + constants.c_w * w) // unit
    return x_row, m_row, w_row, [int(c) for c in tension.truncate(len(x_row)).coeffs()]


def rescaled(step: TaylorStep, ratio: Fraction) -> TaylorStep:
    """Return the same expansion as polynomials of s / ratio; the ratio is a multiple of 1/GRAIN."""
    return step._replace(h=ratio * step.h, rows=stretched(step.coefficients, (0, 0, 0, 2), ratio))


def stretched(
    rows: Sequence[list[int]], powers: Iterable[int], ratio: Fraction
) -> tuple[list[int], ...]:
    """Return coefficients of s / ratio, which is a multiple of 1/GRAIN.

    Each row is also multiplied by a power of the ratio.
    """
    factor = int(ratio * GRAIN)
    shift = GRAIN.bit_length() - 1
    factors = [factor**k for k in range(max(map(len, rows)) + 2)]
    stretched_rows = []
    for row, power in zip(rows, powers, strict=True):
        coefficients = zip(row, factors[power:], strict=False)
        stretched_rows.append([c * f >> shift * k for k, (c, f) in enumerate(coefficients, power)])
    return tuple(stretched_rows)


def pair(chain: Iterable[TaylorStep]) -> Iterator[TaylorStep]:
    """Yield steps that cover the chain, each from one expansion.

    An expansion is used on both sides of its centre where the step before is not much longer.
    """
    before: TaylorStep | None = None
    for step in chain:
        if before is None:
            before = step
            continue
        ratio = before.h / step.h
        if ratio > LOPSIDED:
            yield before._replace(rows=before.coefficients)
            before = step
            continue
        if ratio > 1:
            ceiling = Fraction(-(-ratio.numerator * GRAIN // ratio.denominator), GRAIN)
            wide = rescaled(step, ceiling)
            yield wide._replace(low=-before.h / wide.h, high=step.h / wide.h)
        else:
            yield step._replace(low=-ratio, rows=step.coefficients)
        before = None
    if before is not None:
        yield before._replace(rows=before.coefficients)
