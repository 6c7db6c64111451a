"""TRUSTED. A step's polynomials, and their defects as they are computed (THEOREM.md, sections 2 and 6).

Time on a step is s = (t - centre)/h; h Ω, h² c, h γ, h H are written Ω, c, γ, H. A name of a size is an upper bound.
"""

from fractions import Fraction
from functools import cached_property, reduce
from typing import Any

import numpy as np
from flint import arb, ctx, fmpz, fmpz_poly

from ...numbers.taylor_step import DIGIT_BITS, Digits, TaylorStep
from .balls import SHORT, Vector, add, demand, dot, size, times, total, upper
from .shapes import Sizes
from .system import SceneBalls, scaled


def frozen(step: TaylorStep) -> TaylorStep:
    """Return a copy of a step, whose coefficients are read once."""
    rows: Any = step.coefficients
    if isinstance(rows, Digits):
        rows = Digits(np.array(rows.table, np.int32))
        rows.table.setflags(write=False)
    else:
        rows = tuple(fmpz_poly(row) for row in rows)
    centre, h, low, high = (Fraction(x) for x in (step.centre, step.h, step.low, step.high))
    return TaylorStep(centre, h, low, high, int(step.bits), rows, step.columns)


class Piece:
    """A step with its polynomials p, p' and λ, used from `begin` to `end` (in s).

    Its `step` is a copy: all that rests on this step rests on the same numbers, whatever its source does afterwards.
    """

    def __init__(self, balls: SceneBalls, step: TaylorStep) -> None:
        step = frozen(step)
        demand(
            -1 <= step.low < step.high <= 1 and step.h > 0,
            "a step must lie in -1 <= s <= 1, where its sizes hold",
        )
        rows: Any = step.rows
        if isinstance(rows, Digits):
            demand(
                step.bits == DIGIT_BITS * rows.table.shape[1] - 1,
                "coefficients have 22 bits a digit, but one",
            )
        self.balls, self.step, self.k = balls, step, scaled(balls, step.h, step.bits)
        self.unit, self.rows, self.p = fmpz(1) << step.bits, rows, polynomials(rows, slice(3))
        self.v = [f.derivative() for f in self.p]
        self.begin, self.end = step.centre + step.h * step.low, step.centre + step.h * step.high

    def values(self, s: arb, first: int = 0) -> tuple[Vector, Vector]:
        """Return balls of p(s) and p'(s), of this from a component on."""
        return [f(s) / self.unit for f in self.p], [f(s) / self.unit for f in self.v[first:]]

    @cached_property
    def sizes(self) -> Sizes:
        """The defects and norms, from integers but for the radii of the constants (section 6)."""
        k = self.k
        with ctx.workprec(SHORT):
            *d, t, x, m, w, t1 = self.norms = self.defects()
            v1, size_p, n = size([x, m, w]), upper((1 + t).sqrt()), max(2, *map(len, self.p)) - 1
            defect = size_p * (size(d) + k.off * (2 * v1 + size_p)) + k.drag_size * k.omega_size * t
            speed, rate = v1 + k.omega_size * size_p, (n - 1 + k.omega_size) * v1
            first, second = (
                t * speed + t1 * size_p / 2,
                t1 * speed + t * rate + (2 * n - 1) * t1 * size_p / 2,
            )
            return Sizes(*map(upper, (first, defect, size_p, size_p * speed, t, second)))

    def defects(self) -> list[arb]:
        """Return the norms of d (three components), τ, p' (three), τ': by sums of digits, or by FLINT's polynomials."""
        if isinstance(self.rows, Digits) and not self.balls.flint_only:
            from .digits import norms

            return norms(self.rows.table, self.k.whole)
        return [total(f, 2 * self.step.bits) for f in self.measured()]

    def measured(self) -> list[fmpz_poly]:
        """Return d (three components), τ, p' (three components), τ' over 2^(2 bits)."""
        k, p, v, unit = self.k, self.p, self.v, self.unit
        (tension,) = polynomials(self.rows, slice(3, 4))
        (turn, _, drag, cm, cw), a, lift = (
            k.whole,
            [f.derivative() for f in v],
            tension - k.whole[1],
        )
        d = [unit * x + f * y for x, f, y in zip(a, (lift, lift, tension), p, strict=True)]
        d = add(d, [-2 * turn * v[1], 2 * turn * v[0] - unit * cm, fmpz_poly([-unit * cw])])
        tau = dot(p, p) - unit * unit
        return [*add(d, times(drag, v)), tau, *times(unit, v), tau.derivative()]


def polynomials(rows: Any, part: slice) -> list[fmpz_poly]:
    """Return a part of the rows of coefficients as polynomials."""
    if not isinstance(rows, Digits):
        return [fmpz_poly(row) for row in rows[part]]
    table, odd, unit = (
        rows.table[part].astype(np.int64),
        rows.table.shape[1] % 2,
        fmpz(1) << 2 * DIGIT_BITS,
    )
    pairs = np.concatenate(
        [table[:, :odd], (table[:, odd::2] << DIGIT_BITS) + table[:, odd + 1 :: 2]], 1
    ).tolist()
    return [reduce(lambda f, pair: f * unit + fmpz_poly(pair), row, fmpz_poly()) for row in pairs]
