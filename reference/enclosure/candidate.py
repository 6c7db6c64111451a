"""Proposals for the enclosure, from an integer Taylor recurrence or from somebody else's Taylor coefficients.

Untrusted: whatever this module gets wrong, the bound measures. An expansion serves both sides of its centre, so only
every second one of a chain has to be proved: `pair` joins them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from operator import mul
from typing import Any, NamedTuple, Protocol

import numpy as np
from flint import ctx, fmpz_poly

from .balls import integer
from .bound import World
from .shapes import Step

GUARD = 16  # bits below those of the steps
SLACK = 12  # rounding of coefficient k enters the defect k times: the last terms need not be smaller than that
GRAIN = 64  # step lengths change by multiples of 1/GRAIN
LOPSIDED = Fraction(33, 32)  # an expansion is stretched to its left by so much and not more
BLOCK = 18  # orders summed term by term before the products are taken as polynomials
COLUMN_ORDER = 27
COLUMN_BITS = 50
ILL = 10  # condition number above which columns are made orthogonal


class Expansion(NamedTuple):
    """Taylor coefficients of n and h H at `t`, of s = time/h, as integers over 2^bits; to be used up to t + h."""

    t: Fraction
    h: Fraction
    bits: int
    coefficients: tuple[list[int], ...]


def from_rates(t: Fraction, h: Fraction, bits: int, coefficients: Iterable[list[int]]) -> Expansion:
    """An expansion from coefficients of n and of H (in 1/s) times h^k 2^bits, as an integrator gives them."""
    rows = list(coefficients)
    n, d = h.numerator, h.denominator
    return Expansion(t, h, bits, (*rows[:3], *([c * n // d for c in row] for row in rows[3:])))


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
        """Six rows."""


def rescaled(e: Series, ratio: Fraction) -> Expansion:
    """The same expansion in s / ratio; the ratio is a multiple of 1/GRAIN."""
    factor, shift = int(ratio * GRAIN), GRAIN.bit_length() - 1
    given = e.coefficients
    powers = [factor**k for k in range(max(map(len, given)) + 1)]
    lines = [[c * f >> shift * k for k, (c, f) in enumerate(zip(row, powers, strict=False))] for row in given]
    speed = [[c * factor >> shift for c in row] for row in lines[3:]]
    return Expansion(e.t, ratio * e.h, e.bits, (*lines[:3], *speed))


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


class Recurrence:
    """Own Taylor series in fixed point: V = n' + Ω × n and λ = V·V + n·c leave three convolutions, λ n."""

    def __init__(self, world: World, bits: int, order: int) -> None:
        """Take the constants as integers over 2^(bits + GUARD)."""
        self.world, self.bits, self.order = world, bits, order
        self.f = bits + GUARD
        self.one = 1 << self.f
        with ctx.workprec(world.prec + self.f):
            self.c = [int(integer(x, self.f)) for x in world.c]
            self.w = [int(integer(x, self.f)) for x in world.omega]
            self.g = int(integer(world.drag, self.f))
            self.n = [int(integer(x, self.f)) for x in world.r]
            v = [int(integer(x, self.f)) for x in world.v]
        self.V = [a + b for a, b in zip(v, self._cross(self.w, self.n), strict=True)]

    def _cross(self, a: list[int], b: list[int]) -> list[int]:
        f = self.f
        return [(a[i] * b[j] - a[j] * b[i]) >> f for i, j in ((1, 2), (2, 0), (0, 1))]

    def _dot(self, a: list[int], b: list[int]) -> int:
        return int(sum(map(mul, a, b))) >> self.f

    def chain(self, first: Fraction) -> Iterator[Expansion]:
        """Expansions without end, each to where its last terms reach 2^-bits; `first` guesses the step in s."""
        t, h, before = Fraction(0), first, first
        while True:
            e, ratio = self._expand(t, h)
            reach = h * ratio
            # where reaches shrink the next one must still reach back to here
            wanted = reach * min(reach / before, Fraction(1))
            if wanted < h:
                e = rescaled(e, Fraction(max(int(wanted / h * GRAIN), 1), GRAIN))
            yield self._rounded(e)
            self._move(e)
            t, before = t + e.h, reach
            h = h if h <= wanted < h * Fraction(17, 16) else coarse(min(wanted, 2 * h))

    def _rounded(self, e: Expansion) -> Expansion:
        rows = tuple([c >> GUARD for c in row] for row in e.coefficients)
        return Expansion(e.t, e.h, self.bits, rows)

    def _move(self, e: Expansion) -> None:
        """To s = 1, and back on the sphere."""
        n, H = [sum(row) for row in e.coefficients[:3]], [sum(row) for row in e.coefficients[3:]]
        lift = 3 * self.one - self._dot(n, n)
        self.n = n = [x * lift >> (self.f + 1) for x in n]
        H = [x * e.h.denominator // e.h.numerator for x in H]
        V = self._cross(H, n)
        radial = self._dot(V, n)
        self.V = [v - (radial * x >> self.f) for v, x in zip(V, n, strict=True)]

    def _expand(self, t: Fraction, h: Fraction) -> tuple[Expansion, Fraction]:
        f, a, b = self.f, h.numerator, h.denominator
        _, cy, cz = (x * a * a // (b * b) for x in self.c)
        _, wy, wz = (x * a // b for x in self.w)
        g = self.g * a // b
        V = [x * a // b for x in self.V]
        H = self._cross(self.n, V)
        X, Y, Z = ([x] for x in self.n)
        hx, hy, hz = ([x] for x in H)
        vx, vy, vz = V
        x, y, z = self.n
        jx, jy, jz = H
        lam = self._dot(V, V) + ((y * cy + z * cz) >> f)
        L, Q = [lam], [(wy * y + wz * z) >> f]
        twist = (cy * wz - cz * wy) >> f
        known: list[list[int]] = []
        base = 0
        for k in range(self.order):
            if k == base + BLOCK:
                known, base = self._products(L, (X, Y, Z), k), k
            fx, fy, fz = ((u >> f) for u in self._terms(L, (X, Y, Z), known, base, k))
            if k == 0:
                fy, fz = fy - cy, fz - cz
            nx, ny, nz = vx - ((wy * z - wz * y) >> f), vy - (wz * x >> f), vz + (wy * x >> f)
            lam_next = (3 * (cy * vy + cz * vz) - twist * x) >> f
            kx = (y * cz - z * cy + jy * wz - jz * wy) >> f
            ky = (-x * cz - jx * wz) >> f
            kz = (x * cy + jx * wy) >> f
            ux, uy, uz = -fx - ((wy * vz - wz * vy) >> f), -fy - (wz * vx >> f), -fz + (wy * vx >> f)
            if g:
                ux, uy, uz = ux - (g * nx >> f), uy - (g * ny >> f), uz - (g * nz >> f)
                lam_next -= 2 * g * (lam - ((y * cy + z * cz + wy * jy + wz * jz) >> f)) >> f
                ends = [sum(map(mul, Q, u[::-1])) >> f for u in (X, Y, Z)]
                if k == 0:
                    jy, jz = jy - wy, jz - wz
                kx, ky, kz = (u - (g * (j + q) >> f) for u, j, q in zip((kx, ky, kz), (jx, jy, jz), ends, strict=True))
            n = k + 1
            x, y, z = nx // n, ny // n, nz // n
            vx, vy, vz = ux // n, uy // n, uz // n
            jx, jy, jz, lam = kx // n, ky // n, kz // n, lam_next // n
            for row, value in zip((X, Y, Z, hx, hy, hz, L), (x, y, z, jx, jy, jz, lam), strict=True):
                row.append(value)
            Q.append((wy * y + wz * z) >> f)
        e = Expansion(t, h, f, (X, Y, Z, hx, hy, hz))
        return e, self._reach(e)

    def _products(self, lam: list[int], n: tuple[list[int], ...], k: int) -> list[list[int]]:
        """Coefficients k … k + BLOCK - 1 of λ n from the terms known so far."""
        left = fmpz_poly(lam[:k])
        out = []
        for row in n:
            product = left.mul_low(fmpz_poly(row[:k]), k + BLOCK)
            out.append([int(product[i]) for i in range(k, k + BLOCK)])
        return out

    @staticmethod
    def _terms(lam: list[int], n: tuple[list[int], ...], known: list[list[int]], base: int, k: int) -> Iterator[int]:
        if not base:
            return (sum(map(mul, lam, row[::-1])) for row in n)
        # one index at or beyond `base`, the other at most k - base < base
        few = k - base + 1
        head = lam[:few][::-1]
        tail = lam[: base - 1 : -1] if base else lam[::-1]
        return (
            known[i][k - base] + sum(map(mul, row[base:], head)) + sum(map(mul, tail, row[:few]))
            for i, row in enumerate(n)
        )

    def _reach(self, e: Expansion) -> Fraction:
        """How much longer the step may be until its last two terms are 2^-bits."""
        reach = min(
            (GUARD + SLACK - abs(row[k]).bit_length()) / k
            for row in e.coefficients
            for k in (self.order - 1, self.order)
        )
        return Fraction(max(int(2 ** min(reach, 1.0) * GRAIN), 1), GRAIN)


def coarse(h: Fraction) -> Fraction:
    """About h, with a short binary denominator so that times stay short."""
    shift = 10 - (h.numerator.bit_length() - h.denominator.bit_length())
    scale = Fraction(2) ** shift
    return Fraction(int(h * scale)) / scale


class ColumnSource:
    """Six float columns for each step: the linearised flow about (p, K), from a good frame at the step's start."""

    def __init__(self, world: World) -> None:
        """Read the constants as floats."""
        self.w = np.array([float(x) for x in world.omega])
        self.c = np.array([float(x) for x in world.c])
        self.g, self.w0 = float(world.drag), float(world.w0)
        self.end: Any = np.eye(6)

    def propose(self, step: Step, widths: Iterable[float]) -> list[list[list[int]]]:
        """Integer polynomials over 2^COLUMN_BITS, column by column."""
        h, M = float(step.h), COLUMN_ORDER
        w, c, g = self.w * h, self.c * h * h, self.g * h
        one = 1 << step.bits
        rows = np.array([[x / one for x in row[: M + 1]] + [0.0] * (M + 1 - len(row)) for row in step.coefficients])
        n, turn = rows[:3].T, rows[3:].T.copy()
        turn[0] -= w
        field = np.zeros((6, M + 1, 6))
        field[:3, :, :3] = hats(turn).transpose(1, 0, 2)
        field[:3, :, 3:] = -hats(n).transpose(1, 0, 2)
        field[3:, 0, :3] = -hats(c[None])[0]
        field[3:, 0, 3:] = -hats(w[None])[0]
        if g:
            along = n @ w
            field[3:, :, :3] -= g * (n.T[:, :, None] * w + np.eye(3)[:, None, :] * along[:, None])
            field[3:, 0, 3:] -= g * np.eye(3)
        back = np.zeros((M + 1, 6, 6))  # coefficient k at M - k
        back[M] = np.eye(6)
        for k in range(M):
            back[M - k - 1] = field[:, : k + 1].reshape(6, -1) @ back[M - k :].reshape(-1, 6) / (k + 1)
        flow = back[::-1]
        a, b = float(step.low), float(step.high)
        unit = np.array([1.0] * 3 + [h * self.w0] * 3)
        powers = np.arange(M + 1)
        start, end = (np.tensordot(s**powers, flow, 1) for s in (a, b))
        combine = np.linalg.solve(start, unit[:, None] * self._frame(np.fromiter(widths, float)))
        columns = flow @ combine
        self.end = (end @ combine) / unit[:, None]
        whole = np.rint(np.ldexp(columns, COLUMN_BITS))
        return [[[int(x) for x in whole[:, i, j]] for i in range(6)] for j in range(6)]

    def _frame(self, widths: Any) -> Any:
        lengths = np.linalg.norm(self.end, axis=0)
        straight = self.end / lengths
        if np.linalg.cond(straight) < ILL:
            return straight
        order = np.argsort(-(np.log(lengths) + widths))
        return np.linalg.qr(straight[:, order])[0]


def hats(rows: Any) -> Any:
    """The matrices a× of the rows a."""
    x, y, z = rows.T
    zero = np.zeros_like(x)
    return np.stack([np.stack(r, -1) for r in ((zero, -z, y), (z, zero, -x), (-y, x, zero))], 1)
