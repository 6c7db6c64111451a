"""TRUSTED. Polynomials by their digits of radix 2^22: defects and values as exact sums in 64-bit integers.

Nothing here is a float, and no sum can overflow: `check` refuses what could (THEOREM.md, section 6). A digit of row q
stands for 2^(22 (L - 1 - q)) in a coefficient over 2^(22 L - 1), a sum of row t for 2^(22 (2 L - 2 - t)) in a product.
"""

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from flint import arb, fmpz
from numba import njit

from ..machine_code import kept
from ..packing import DIGIT_BITS

MASK = (1 << DIGIT_BITS) - 1
PAD = 3  # zeros before each row, and at least as many behind it, for sums of four products at once
MORE_ROWS = 1  # of a product's rows that are summed, beyond those of its factors; what is left out is bounded
# which sum (of d, or 3 of τ) a product is added to; its factors, as in `defects`: a number, and derivative and row
PRODUCTS = (
    *((0, 0, 0, 0), (1, 0, 0, 1), (2, 1, 0, 2), (0, 2, 1, 0), (1, 2, 1, 1), (2, 2, 1, 2)),
    *((0, 3, 1, 1), (1, 4, 1, 0), (3, 5, 0, 0), (3, 6, 0, 1), (3, 7, 0, 2)),
)
TOP_ROWS = 3  # in which a sum below 2^62 is carried on


def check(rows: Any, constants: Any) -> tuple[int, int]:
    """Return bounds of the products' sums in `defects` and of p's digits; raise ArithmeticError if one may overflow."""
    (_, digits, orders), parts = rows.shape, (rows[:3], rows[3], constants)
    p, tension, constant = (max(int(x.max()), -int(x.min())) for x in parts)  # -x.min() itself may overflow
    most = digits * orders * p * (tension + 5 * constant + 3 * p)
    linear = orders**2 * p << DIGIT_BITS
    if (
        most + linear + (constant + (1 << DIGIT_BITS) << DIGIT_BITS) >= 1 << 62
        or 2 * max(orders * p, tension, constant) >= 1 << 31
    ):
        raise ArithmeticError("sums of digits may overflow")
    return most, p


compiled: Callable[[Any], Any] = njit(cache=True)

with kept("the proof's sums", 5):

    @compiled
    def used(row: Any) -> Any:
        """Return the number of orders up to the last digit that is not 0."""
        k = row.size - 2 * PAD
        while k and not row[k - 1 + PAD]:
            k -= 1
        return k

    @compiled
    def multiply(to: Any, f: Any, g: Any, alike: bool) -> None:
        """Add the product of two polynomials to the sums, in the rows that these have; `alike` says that f is g."""
        for q in range(f.shape[0]):
            terms = used(f[q])
            for r in range(q if alike else 0, min(g.shape[0], to.shape[0] - q)):
                line, row, count = to[q + r], g[r], used(g[r])
                twice = np.int32(2 if alike and r > q else 1)
                for k in range(PAD, terms + PAD, 4):
                    a, b = np.int32(twice * f[q, k]), np.int32(twice * f[q, k + 1])
                    c, d = np.int32(twice * f[q, k + 2]), np.int32(twice * f[q, k + 3])
                    out = line[k - PAD : k - PAD + count + PAD]  # the compiler knows their indices to be >= 0
                    r0, r1, r2, r3 = row[3:], row[2:], row[1:], row[: count + PAD]
                    for j in range(count + PAD):
                        out[j] += a * r0[j] + b * r1[j] + c * r2[j] + d * r3[j]

    @compiled
    def multiply_all(to: Any, factors: Any, f: Any) -> None:
        """Add all products of a defect and of τ."""
        for i, factor, derivative, row in PRODUCTS:
            multiply(to[i], factors[factor], f[derivative, row], i == 3)

    @compiled
    def weigh(to: Any) -> Any:
        """Return the sums over the orders n of |c|, n |c| and n (n - 1) |c|, in digits of TOP_ROWS more rows."""
        count, rows, orders = to.shape
        out, digits = np.zeros((count, 3, rows + TOP_ROWS), np.int64), np.zeros(rows + TOP_ROWS, np.int64)
        for i in range(count):
            for n in range(orders):
                for sign in (1, -1):
                    over = 0
                    for t in range(rows + TOP_ROWS - 1, -1, -1):
                        whole = over + (sign * to[i, t - TOP_ROWS, n] if t >= TOP_ROWS else 0)
                        digits[t], over = whole & MASK, whole >> DIGIT_BITS
                    if not over:  # else the coefficient is negative
                        break
                for t in range(rows + TOP_ROWS):
                    out[i, 0, t] += digits[t]
                    out[i, 1, t] += n * digits[t]
                    out[i, 2, t] += n * (n - 1) * digits[t]
        return out

    @compiled
    def powers(s: Any, orders: int) -> Any:
        """Return the digits of the powers of s, cut; row q of s in [0, 1] and of these stands for 2^(-22 q)."""
        out, sums = np.zeros((s.size, orders), np.int32), np.zeros(s.size, np.int64)
        out[0, 0] = 1
        for k in range(1, orders):
            for t in range(s.size):
                sums[t] = 0
            for q in range(s.size):
                for r in range(s.size - q):
                    sums[q + r] += np.int64(out[q, k - 1]) * s[r]
            over = 0
            for t in range(s.size - 1, -1, -1):
                whole = sums[t] + over
                out[t, k], over = (whole & MASK if t else whole), whole >> DIGIT_BITS
        return out

    @compiled
    def summed(f: Any, s: Any) -> Any:
        """Return the sums, by row, of padded polynomials times the powers `s`; row t stands for 2^(1 - 22 t)."""
        out = np.zeros((f.shape[0], s.shape[0] + 1), np.int64)
        for i in range(f.shape[0]):
            for q in range(f.shape[1]):
                for r in range(s.shape[0] - q):
                    total, row, power = 0, f[i, q, PAD:], s[r]
                    for k in range(power.size):
                        total += row[k] * power[k]
                    out[i, q + r] += total >> DIGIT_BITS
                    out[i, q + r + 1] += total & MASK
        return out


def padded(rows: Any) -> Any:
    """Return the rows of digits between zeros, and those of the derivatives."""
    *shape, orders = rows.shape
    f = np.zeros((2, *shape, orders + 3 * PAD), np.int32)
    f[0, ..., PAD : PAD + orders] = rows
    f[1, ..., PAD : PAD + orders - 1] = rows[..., 1:] * np.arange(1, orders, dtype=np.int32)
    return f


def defects(rows: Any, f: Any, constants: Any, more: int) -> tuple[Any, Any]:
    """Return the weighed sums of d (three components) and τ, and of p; with more = L - 1 nothing is left out.

    Args:
        rows: digits of x, m, w, λ, shape (4, L, orders).
        f: the same, padded.
        constants: digits of ω, ω², γ, c_m, c_w, shape (5, L).
        more: rows of a product that are summed beyond L.
    """
    _, digits, orders = rows.shape
    half, order = DIGIT_BITS - 1, np.arange(1, orders - 1, dtype=np.int64)
    to = np.zeros((4, digits + more, 2 * orders + 3 * PAD + 4), np.int64)
    factors = np.zeros((8, digits, f.shape[3]), np.int32)
    factors[:2], factors[5:] = f[0, 3], f[0, :3]
    factors[0, :, PAD] -= constants[1]
    for i, (factor, constant) in enumerate(((1, 2), (-2, 0), (2, 0)), 2):
        factors[i, :, PAD] = factor * constants[constant]
    multiply_all(to, factors, f)
    to[:3, :digits, : order.size] += rows[:3, :, 2:] * (order * (order + 1)) << half
    to[1:3, :digits, 0] -= constants[3:] << half
    to[3, 0, 0] -= 1 << 2 * half
    return weigh(to), weigh(rows[:3].astype(np.int64))


def whole(digits: Iterable[int]) -> fmpz:
    """Return the integer of digits, the highest first."""
    n = 0
    for digit in digits:
        n = (n << DIGIT_BITS) + digit
    return fmpz(n)


@lru_cache(maxsize=64)
def split(n: int, count: int) -> tuple[int, ...]:
    """Return the digits of an integer, the highest first and signed."""
    return n >> DIGIT_BITS * (count - 1), *(n >> DIGIT_BITS * q & MASK for q in range(count - 2, -1, -1))


@lru_cache(maxsize=16)
def power_table(s: Fraction, orders: int, count: int) -> Any:
    """Return the powers of s in [-1, 1], cut to `count` digits."""
    table = powers(np.array(split(abs(s) * (1 << DIGIT_BITS * (count - 1)) // 1, count)), orders)
    if s < 0:
        table[:, 1::2] *= -1
    return table


class DigitRows:
    """The polynomials p and λ of a step by their digits: norms of the defects, and values at a point."""

    def __init__(self, rows: Any, whole: list[fmpz]) -> None:
        (_, self.count, self.orders), self.rows = rows.shape, rows
        self.constants = np.array([split(int(n), self.count) for n in whole])
        (self.most, self.largest), self.padded = check(rows, self.constants), padded(rows)

    def norms(self, more: int = MORE_ROWS) -> list[list[arb]]:
        """Return sums of |c|, n |c|, n (n - 1) |c| of d (three components), τ, x, m, w; exact with more = L - 1."""
        products, own = defects(self.rows, self.padded, self.constants, more)
        cut = 0 if more >= self.count - 1 else (4 * self.orders * self.most >> DIGIT_BITS) + 1
        last = -DIGIT_BITS * (self.count + 1 + more) + 2
        out = []
        for f, extra, place in [
            *((f, cut, last) for f in products),
            *((f, 0, 1 - DIGIT_BITS * self.count) for f in own),
        ]:
            sums = (whole(x) + extra * (2 * self.orders) ** n for n, x in enumerate(f.tolist()))
            out.append([arb((n, fmpz(place))) for n in sums])
        return out

    def values(self, s: Fraction, near: arb, rates: Sequence[arb], n: int) -> list[arb]:
        """Return balls of the n-th derivative of p within `near` of s, from bounds of the next one on [-1, 1]."""
        count = self.count + 2
        table = power_table(s, self.orders, count)
        # the powers are cut, and s is; and the rows below the last are left out
        off = near + arb((fmpz(2 * count + 1), fmpz(DIGIT_BITS * (2 - count))))
        last, left = fmpz(1 - DIGIT_BITS * count), fmpz(2 * self.count * self.orders**2 * self.largest)
        sums = summed(self.padded[n, :3], table).tolist()
        return [
            arb((whole(x), last)) + arb(0, rate * off + arb((left, last))) for x, rate in zip(sums, rates, strict=True)
        ]
