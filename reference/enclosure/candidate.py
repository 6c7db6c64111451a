"""Proposals for the enclosure, from an integer Taylor recurrence or from somebody else's Taylor coefficients.

Untrusted: whatever this module gets wrong, the bound measures. An expansion serves both sides of its centre, so only
every second one of a chain has to be proved: `pair` joins them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from operator import mul
from typing import Any, NamedTuple, Protocol

import numpy as np
from flint import ctx, fmpz, fmpz_poly

from ..words import WORD_BITS, Words
from .balls import cross, dot, integer
from .bound import World, scaled
from .shapes import Step

GUARD = 16  # bits below those of the steps
SLACK = 12  # rounding of coefficient k enters the defect k times: the last terms need not be smaller than that
GRAIN = 64  # step lengths change by multiples of 1/GRAIN
LOPSIDED = Fraction(33, 32)  # an expansion is stretched to its left by so much and not more
POWERS = (0, 0, 0, 1, 1, 1, 2, 1)  # of h in x, m, w, V, λ, j
BLOCK = 18  # orders summed term by term before the products are taken as polynomials
COLUMN_ORDER = 27
COLUMN_BITS = 50
ILL = 10  # condition number above which columns are made orthogonal


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


class Recurrence:
    """Own Taylor series in fixed point: V = n' + Ω × n and λ = V·V + n·c leave three convolutions, λ n.

    With drag one more, w²; for λ' = 3 c·V - c·(Ω × n) - 2 γ (λ - c·n - ω j) has j = (n × V)_w.
    """

    def __init__(self, world: World, bits: int, order: int) -> None:
        """Take the constants as integers over 2^(bits + GUARD)."""
        self.world, self.bits, self.order = world, bits, order
        self.f = bits + GUARD
        self.one = 1 << self.f
        with ctx.workprec(world.prec + self.f):
            self.c = [int(integer(x, self.f)) for x in world.c]
            self.w = int(integer(world.omega[2], self.f))
            self.g = int(integer(world.drag, self.f))
            self.n = [int(integer(x, self.f)) for x in world.r]
            self.V = [int(integer(x, self.f)) for x in cross(world.H, world.r)]

    def _dot(self, a: Iterable[int], b: Iterable[int]) -> int:
        return int(sum(map(mul, a, b))) >> self.f

    def chain(self, first: Fraction) -> Iterator[Expansion]:
        """Expansions without end, each to where its last terms reach 2^-bits; `first` guesses the step in s."""
        t, h, before = Fraction(0), first, first
        while True:
            rows = self._expand(h)
            ratio = self._reach(rows)
            reach = h * ratio
            # where reaches shrink the next one must still reach back to here
            wanted, length = reach * min(reach / before, Fraction(1)), h
            if wanted < h:
                part = Fraction(max(int(wanted / h * GRAIN), 1), GRAIN)
                rows, length = stretched(rows, POWERS, part), h * part
            yield Expansion(t, length, self.bits, tuple([c >> GUARD for c in row] for row in (*rows[:3], rows[6])))
            self._move(rows, length)
            t, before = t + length, reach
            h = h if h <= wanted < h * Fraction(17, 16) else coarse(min(wanted, 2 * h))

    def _move(self, rows: Sequence[list[int]], h: Fraction) -> None:
        """To s = 1, and back on the sphere."""
        n, V = ([sum(row) for row in part] for part in (rows[:3], rows[3:6]))
        lift = 3 * self.one - self._dot(n, n)
        self.n = n = [x * lift >> (self.f + 1) for x in n]
        V = [x * h.denominator // h.numerator for x in V]
        radial = self._dot(V, n)
        self.V = [v - (radial * x >> self.f) for v, x in zip(V, n, strict=True)]

    def _expand(self, h: Fraction) -> tuple[list[int], ...]:
        """Rows x, m, w, Vx, Vm, Vw, λ, j in the time of a step."""
        f, a, b = self.f, h.numerator, h.denominator
        _, cm, cw = (x * a * a // (b * b) for x in self.c)
        turn, g = self.w * a // b, self.g * a // b
        x, m, w = self.n
        vx, vm, vw = (u * a // b for u in self.V)
        lam, j = self._dot((vx, vm, vw, m, w), (vx, vm, vw, cm, cw)), (x * vm - m * vx) >> f
        rows: tuple[list[int], ...] = tuple([u] for u in (x, m, w, vx, vm, vw, lam, j))
        X, M, W, *_, L, _ = rows
        cmw = cm * turn >> f
        known: list[list[int]] = []
        base = 0
        for k in range(self.order):
            if k == base + BLOCK:
                known, base = self._products(L, (X, M, W), k), k
            fx, fm, fw = (u >> f for u in self._terms(L, (X, M, W), known, base, k))
            if k == 0:
                fm, fw = fm - cm, fw - cw
            nx, nm, nw = vx + (turn * m >> f), vm - (turn * x >> f), vw
            ux, um, uw = (turn * vm >> f) - fx, -(turn * vx >> f) - fm, -fw
            lam1, j1 = (3 * (cm * vm + cw * vw) - cmw * x) >> f, cm * x >> f
            if g:
                ux, um, uw = ux - (g * nx >> f), um - (g * nm >> f), uw - (g * nw >> f)
                lam1 -= 2 * g * (lam - ((cm * m + cw * w + turn * j) >> f)) >> f
                across = (0 if k else self.one) - self._dot(W, W[::-1])
                j1 -= g * (j - (turn * across >> f)) >> f
            x, m, w, vx, vm, vw, lam, j = (u // (k + 1) for u in (nx, nm, nw, ux, um, uw, lam1, j1))
            for row, value in zip(rows, (x, m, w, vx, vm, vw, lam, j), strict=True):
                row.append(value)
        return rows

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

    def _reach(self, rows: Sequence[list[int]]) -> Fraction:
        """How much longer the step may be until its last two terms are 2^-bits."""
        reach = min(
            (GUARD + SLACK - abs(row[k]).bit_length()) / k for row in rows[:6] for k in (self.order - 1, self.order)
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
        rows = [[int(x) / one for x in fmpz_poly(row).truncate(M + 2).coeffs()] for row in step.coefficients]
        whole = np.array([row + [0.0] * (M + 2 - len(row)) for row in rows[:3]]).T
        n = whole[: M + 1]
        speed = whole[1:] * np.arange(1, M + 2)[:, None] + np.cross(w, n)
        turn = np.array([np.cross(n[: k + 1], speed[k::-1]).sum(axis=0) for k in range(M + 1)])
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
