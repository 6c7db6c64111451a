"""TRUSTED. A step's polynomials, and their defects as they are computed (THEOREM.md, sections 2 and 6).

Time on a step is s = (t - centre)/h; h Ω, h² c, h γ, h H are written Ω, c, γ, H, and lengths are divided by that of
the rod, so that all of this has the unit 1. Norms are those on |s| <= 1.

| name               | symbol                                                 | unit |
|--------------------|--------------------------------------------------------|------|
| `p`, `v`           | p, p': components x, m, w, integers over `unit` = 2^B  | 1    |
| `tension`          | λ, likewise                                            | 1    |
| `DefectNorms`      | |d_x|, |d_m|, |d_w|, |τ|, |p'_x|, |p'_m|, |p'_w|, |τ'| | 1    |
| `P`, `K`, `T`      | P, K, T: bounds of |p|, |K|, |τ|                       | 1    |
| `V`, `V_rate`      | bounds of |V|, |V'|                                    | 1    |
| `p_rate`, `T_rate` | bounds of |p'|, |τ'|                                   | 1    |
| `D`, `D1`, `D2`    | D, D1, D2: bounds of |d|, |d1|, |d2|                   | 1    |
| `d1_rate`          | a bound of |d1'|                                       | 1    |
| `N`                | N, the largest degree of a component of p, or 1        |      |
"""

from collections.abc import Iterable
from fractions import Fraction
from functools import cached_property
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
from flint import arb, ctx, fmpz, fmpz_poly

from ...numbers.taylor_step import DIGIT_BITS, Digits, TaylorStep
from .balls import SHORT, Vector, demand, dot, size, total, upper
from .shapes import Sizes
from .system import SceneBalls, scaled


class DefectNorms(NamedTuple):
    """Bounds on |s| <= 1 of the components of d, of τ, of the components of p', of τ'."""

    d_x: arb
    d_m: arb
    d_w: arb
    tau: arb
    p_rate_x: arb
    p_rate_m: arb
    p_rate_w: arb
    tau_rate: arb

    @property
    def p_rate(self) -> arb:
        """A bound of |p'|."""
        return size([self.p_rate_x, self.p_rate_m, self.p_rate_w])


class Piece:
    """A step with its polynomials p, p' and λ, used from `begin` to `end` (in s).

    Its `step` is a copy: all that rests on this step rests on the same numbers, whatever its source does afterwards.
    """

    def __init__(self, balls: SceneBalls, step: TaylorStep) -> None:
        step = _frozen(step)
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
        self.balls = balls
        self.step = step
        self.constants = scaled(balls, step.h, step.bits)
        self.unit = fmpz(1) << step.bits
        self.rows = rows
        self.begin = step.centre + step.h * step.low
        self.end = step.centre + step.h * step.high

    @cached_property
    def p(self) -> list[fmpz_poly]:
        """The polynomials p."""
        return polynomials(self.rows, slice(3))

    @cached_property
    def v(self) -> list[fmpz_poly]:
        """The polynomials p'."""
        return [f.derivative() for f in self.p]

    def values(self, s: arb | fmpz, first: int = 0) -> tuple[Vector, Vector]:
        """Return balls of p(s) and p'(s), of this from a component on; where `s` is an integer, from integers."""
        p = [arb(f(s)) / self.unit for f in self.p]
        v = [arb(f(s)) / self.unit for f in self.v[first:]]
        return p, v

    @cached_property
    def sizes(self) -> Sizes:
        """The defects and norms, from integers but for the radii of the constants (section 6)."""
        constants = self.constants
        norms = self.norms
        with ctx.workprec(SHORT):
            gamma = constants.drag_size
            Omega = constants.omega_size
            T = norms.tau
            T_rate = norms.tau_rate
            p_rate = norms.p_rate
            N = max(2, *map(len, self.p)) - 1

            P = upper((1 + T).sqrt())  # (6.2)
            V = p_rate + Omega * P  # (6.3)
            V_rate = (N - 1 + Omega) * p_rate  # (6.4)
            D = size([norms.d_x, norms.d_m, norms.d_w]) + constants.theta * (
                2 * p_rate + P
            )  # (6.1)
            K = P * V  # (6.5)
            D1 = T * V + T_rate * P / 2  # (6.6)
            D2 = P * D + gamma * Omega * T  # (6.7)
            d1_rate = T_rate * V + T * V_rate + (2 * N - 1) * T_rate * P / 2  # (6.8)
            return Sizes(upper(D1), upper(D2), P, upper(K), upper(T), upper(d1_rate))

    @cached_property
    def norms(self) -> DefectNorms:
        """The norms of d, τ, p' and τ': by sums of digits, or of others by FLINT's polynomials."""
        if isinstance(self.rows, Digits):
            [norms] = _norms_of(self.rows.table[None], [self])
            return norms
        return DefectNorms(*(total(f, 2 * self.step.bits) for f in self._exact_polynomials()))

    def _exact_polynomials(self) -> list[fmpz_poly]:
        """Return d (three components), τ, p' (three components), τ' over 2^(2 bits), with the integers for constants.

        d = p'' + 2 Ω × p' + Ω × (Ω × p) + γ p' − c + λ p, where Ω × p = ω (−m, x, 0).
        """
        one = self.unit
        k = self.constants.integers
        x, m, w = self.p
        x1, m1, w1 = self.v
        x2, m2, w2 = (f.derivative() for f in self.v)
        (tension,) = polynomials(self.rows, slice(3, 4))

        # λ p + Ω × (Ω × p)
        lift = tension - k.omega_squared
        d_x = one * x2 - 2 * k.omega * m1 + lift * x + k.drag * x1
        d_m = one * m2 + 2 * k.omega * x1 + lift * m + k.drag * m1 - one * k.c_m
        d_w = one * w2 + tension * w + k.drag * w1 - one * k.c_w

        tau = dot(self.p, self.p) - one * one
        return [d_x, d_m, d_w, tau, one * x1, one * m1, one * w1, tau.derivative()]


def pieces(balls: SceneBalls, steps: Iterable[TaylorStep]) -> list[Piece]:
    """Return the pieces of steps; what follows from digits of one shape is computed in one pass."""
    result = [Piece(balls, step) for step in steps]
    for shape, group in groupby(result, key=_shape):
        if shape is None:
            continue
        alike = list(group)
        tables = np.stack([piece.rows.table for piece in alike])
        p = _polynomials_of(np.concatenate(tables[:, :3]))
        for k, norms in enumerate(_norms_of(tables, alike)):
            alike[k].p = p[3 * k : 3 * k + 3]
            alike[k].norms = norms
    return result


def _shape(piece: Piece) -> Any:
    """Return the shape of the table of digits; None for coefficients that come as integers."""
    return piece.rows.table.shape if isinstance(piece.rows, Digits) else None


def _norms_of(tables: Any, pieces: list[Piece]) -> list[DefectNorms]:
    """Return the norms of pieces from their tables of digits, shape (pieces, 4, L, orders)."""
    from .digits import norms

    integers = [piece.constants.integers for piece in pieces]
    audit = pieces[0].balls.audit
    return [DefectNorms(*bounds) for bounds in norms(tables, integers, audit=audit)]


def _frozen(step: TaylorStep) -> TaylorStep:
    """Return a copy of a step, whose coefficients are read once."""
    rows: Any = step.coefficients
    if isinstance(rows, Digits):
        rows = Digits(np.array(rows.table, np.int32))
        rows.table.setflags(write=False)
    else:
        rows = tuple(fmpz_poly(row) for row in rows)
    centre, h, low, high = (Fraction(x) for x in (step.centre, step.h, step.low, step.high))
    return TaylorStep(centre, h, low, high, int(step.bits), rows, step.columns)


def polynomials(rows: Any, part: slice) -> list[fmpz_poly]:
    """Return a part of the rows of coefficients as polynomials."""
    if not isinstance(rows, Digits):
        return [fmpz_poly(row) for row in rows[part]]

    return _polynomials_of(rows.table[part])


def _polynomials_of(tables: Any) -> list[fmpz_poly]:
    """Return polynomials from the digits of their coefficients, shape (polynomials, L, orders)."""
    # two digits are one number of 44 bits, which 64 hold: half as many polynomials to add
    tables = tables.astype(np.int64)
    odd = tables.shape[1] % 2
    highest = tables[:, :odd]
    joined = (tables[:, odd::2] << DIGIT_BITS) + tables[:, odd + 1 :: 2]
    words = np.concatenate([highest, joined], 1)

    # the high words of high orders are 0
    _, _, orders = words.shape
    lengths = (words.any(axis=0) * np.arange(1, orders + 1)).max(axis=1).tolist()
    rows = [words[:, k, :length].tolist() for k, length in enumerate(lengths)]
    return [_polynomial(of_words) for of_words in zip(*rows, strict=True)]


def _polynomial(words: Iterable[list[int]]) -> fmpz_poly:
    """Return a polynomial from the words of its coefficients, the highest first."""
    word_unit = fmpz(1) << 2 * DIGIT_BITS
    polynomial = fmpz_poly()
    for coefficients in words:
        polynomial = polynomial * word_unit + fmpz_poly(coefficients)
    return polynomial
