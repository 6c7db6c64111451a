"""An approximant for tests: the pendulum's Taylor series in integers, written apart from heyoka's and from limbs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from operator import mul

from flint import ctx, fmpz_poly

from reference.enclosure import Enclosure, enclose
from reference.enclosure.approximant import GRAIN, pair, stretched
from reference.enclosure.prove import SCENE_GUARD_BITS
from reference.enclosure.trusted.balls import cross, fixed
from reference.enclosure.trusted.system import SceneBalls
from reference.numbers.taylor_step import TaylorStep
from reference.scenes.inputs import Inputs

# carried below the last bit of the coefficients, for the rounding of the recurrence
GUARD_BITS = 16
# rounding of coefficient k enters the defect k times: the last terms need not be smaller than that
SLACK_BITS = 12
ORDER_PER_BIT, LEAST_ORDER = 0.5, 24  # about the cheapest order, which depends little on it
POWERS = (0, 0, 0, 1, 1, 1, 2, 1)  # of h in x, m, w, V, λ, j
BLOCK = 18  # orders summed term by term before the products are taken as polynomials


def recurrence(inputs: Inputs) -> Callable[[int], Iterator[TaylorStep]]:
    """Return a scene's approximant: a function of the bits of the coefficients that gives steps without end."""

    def steps(bits: int) -> Iterator[TaylorStep]:
        order = max(LEAST_ORDER, round(ORDER_PER_BIT * bits))
        first = coarse(Fraction(1 / (4 * float(SceneBalls(inputs, 128).w0))))
        return pair(
            Recurrence(SceneBalls(inputs, bits + SCENE_GUARD_BITS), bits, order).chain(first)
        )

    return steps


def prove(inputs: Inputs, times: Sequence[Fraction], radius: Fraction) -> Enclosure:
    """Enclose a run of the recurrence."""
    return enclose(inputs, times, radius=radius, approximant=recurrence(inputs))


class Recurrence:
    """Taylor series in fixed point: V = n' + Ω × n and λ = V·V + n·c leave three convolutions, λ n.

    With drag one more, w²; for λ' = 3 c·V - c·(Ω × n) - 2 γ (λ - c·n - ω j) has j = (n × V)_w.
    """

    def __init__(self, balls: SceneBalls, bits: int, order: int) -> None:
        """Take the constants as integers over 2^(bits + GUARD_BITS)."""
        self.balls, self.bits, self.order = balls, bits, order
        self.f = bits + GUARD_BITS
        self.one = 1 << self.f
        with ctx.workprec(balls.prec + self.f):
            whole = lambda balls: [int(n) for n in fixed(balls, self.f)[0]]  # noqa: E731
            self.c, (self.w, self.g) = whole(balls.c), whole([balls.omega[2], balls.drag])
            self.n, self.V = whole(balls.r), whole(cross(balls.H, balls.r))

    def _dot(self, a: Iterable[int], b: Iterable[int]) -> int:
        return int(sum(map(mul, a, b))) >> self.f

    def chain(self, first: Fraction) -> Iterator[TaylorStep]:
        """Yield Taylor steps without end, each to where its last terms reach 2^-bits; `first` guesses the step in s."""
        t, h, before = Fraction(0), first, first
        while True:
            rows = self._expand(h)
            ratio = self._reach(rows)
            reach = h * ratio
            # where reaches shrink, the next expansion must still reach back to t
            target, length = reach * min(reach / before, Fraction(1)), h
            if target < h:
                part = Fraction(max(int(target / h * GRAIN), 1), GRAIN)
                rows, length = stretched(rows, POWERS, part), h * part
            shortened = tuple([c >> GUARD_BITS for c in row] for row in (*rows[:3], rows[6]))
            yield TaylorStep(t, length, Fraction(0), Fraction(1), self.bits, shortened)
            self._move(rows, length)
            t, before = t + length, reach
            h = h if h <= target < h * Fraction(17, 16) else coarse(min(target, 2 * h))

    def _move(self, rows: Sequence[list[int]], h: Fraction) -> None:
        """Evaluate at s = 1 and project onto the sphere."""
        n, V = ([sum(row) for row in part] for part in (rows[:3], rows[3:6]))
        lift = 3 * self.one - self._dot(n, n)
        self.n = n = [x * lift >> (self.f + 1) for x in n]
        V = [x * h.denominator // h.numerator for x in V]
        radial = self._dot(V, n)
        self.V = [v - (radial * x >> self.f) for v, x in zip(V, n, strict=True)]

    def _expand(self, h: Fraction) -> tuple[list[int], ...]:
        """Return the coefficients of x, m, w, Vx, Vm, Vw, λ, j in the time of a step."""
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
        """Return coefficients k … k + BLOCK - 1 of λ n from the terms known so far."""
        left = fmpz_poly(lam[:k])
        out = []
        for row in n:
            product = left.mul_low(fmpz_poly(row[:k]), k + BLOCK)
            out.append([int(product[i]) for i in range(k, k + BLOCK)])
        return out

    @staticmethod
    def _terms(
        lam: list[int], n: tuple[list[int], ...], known: list[list[int]], base: int, k: int
    ) -> Iterator[int]:
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
        """Return the factor by which the step may grow until its last two terms are 2^-bits."""
        reach = min(
            (GUARD_BITS + SLACK_BITS - abs(row[k]).bit_length()) / k
            for row in rows[:6]
            for k in (self.order - 1, self.order)
        )
        return Fraction(max(int(2 ** min(reach, 1.0) * GRAIN), 1), GRAIN)


def coarse(h: Fraction) -> Fraction:
    """Return about h, with a short binary denominator so that times stay short."""
    shift = 10 - (h.numerator.bit_length() - h.denominator.bit_length())
    scale = Fraction(2) ** shift
    return Fraction(int(h * scale)) / scale
