"""TRUSTED. The defects of a step by digits of radix 2^22, as exact sums in 64-bit integers.

Nothing here is a float, and no sum can overflow: `check` refuses what could (THEOREM.md, section 6). A digit of row q
stands for 2^(22 (L - 1 - q)) in a coefficient over 2^(22 L - 1), a sum of row t for 2^(22 (2 L - 2 - t)) in a product.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from flint import arb, fmpz, fmpz_poly
from numba import njit

from ..machine_code import kept
from ..packing import DIGIT_BITS

MASK = (1 << DIGIT_BITS) - 1
MORE_ROWS = 1  # of a product's rows that are summed, beyond those of its factors; what is left out is bounded
TOP_ROWS = 3  # in which a sum below 2^62 is carried on


def check(rows: Any, constants: Any) -> int:
    """Return a bound of the products' sums in `norms`; raise ArithmeticError if a sum or factor may overflow."""
    (_, digits, orders), parts = rows.shape, (rows[:3], rows[3], constants)
    p, tension, constant = (max(int(x.max()), -int(x.min())) for x in parts)  # -x.min() itself may overflow
    most: int = digits * orders * p * (tension + 5 * constant + 3 * p)
    linear = (orders**2 * p << DIGIT_BITS) + (constant + (1 << DIGIT_BITS) << DIGIT_BITS)
    if most + linear >= 1 << 62 or 2 * max(orders * p, tension, constant) >= 1 << 31:
        raise ArithmeticError("sums of digits may overflow")
    return most


compiled: Callable[[Any], Any] = njit(cache=True)

with kept("the proof's sums", 5):

    @compiled
    def multiply(to: Any, f: Any, g: Any, alike: bool) -> None:
        """Add the product of two polynomials to the sums, in the rows that these have; `alike` says that f is g."""
        for r in range(g.shape[0]):
            count = g.shape[1]
            while count and not g[r, count - 1]:
                count -= 1
            row = g[r, :count]
            for q in range(min(r + 1 if alike else f.shape[0], to.shape[0] - r)):
                for k in range(f.shape[1]):
                    factor, out = np.int32((2 if alike and q < r else 1) * f[q, k]), to[q + r, k : k + count]
                    for j in range(count if factor else 0):
                        out[j] += factor * row[j]

    @compiled
    def weigh(to: Any) -> Any:
        """Return the sums over the orders n of |c|, n |c| and n (n - 1) |c|, in digits of TOP_ROWS more rows."""
        count, rows, orders = to.shape
        out, digits = np.zeros((count, 3, rows + TOP_ROWS), np.int64), np.zeros(rows + TOP_ROWS, np.int64)
        for i in range(count):
            for n in range(orders):
                over = 0
                for t in range(rows + TOP_ROWS - 1, 0, -1):
                    whole = over + (to[i, t - TOP_ROWS, n] if t >= TOP_ROWS else 0)
                    digits[t], over = whole & MASK, whole >> DIGIT_BITS
                digits[0] = over  # -1 for a negative coefficient, else 0
                for t in range(rows + TOP_ROWS):
                    digit = digits[t] * (1 + 2 * over)
                    out[i, 0, t] += digit
                    out[i, 1, t] += n * digit
                    out[i, 2, t] += n * (n - 1) * digit
        return out


def split(n: int, count: int) -> list[int]:
    """Return the digits of an integer, the highest first and signed."""
    return [n >> DIGIT_BITS * (count - 1), *(n >> DIGIT_BITS * q & MASK for q in range(count - 2, -1, -1))]


def norms(rows: Any, whole: list[fmpz], more: int = MORE_ROWS) -> list[arb]:
    """Return sums of |c| of d (three components) and of τ, and those of n |c| and n (n - 1) |c| of τ.

    Args:
        rows: digits of x, m, w, λ, shape (4, L, orders).
        whole: ω, ω², γ, c_m, c_w over 2^(22 L - 1).
        more: rows of a product that are summed beyond L; with L - 1 nothing is left out.
    """
    (_, count, orders), half = rows.shape, DIGIT_BITS - 1
    constants = np.array([split(int(n), count) for n in whole])
    most, order, rows = check(rows, constants), np.arange(orders), rows.astype(np.int32, order="C")
    turn, square, drag = constants[:3, :, None].astype(np.int32)
    p, tension, lift = rows[:3], rows[3], rows[3].copy()
    lift[:, :1] -= square
    v = (order[1:] * p[..., 1:]).astype(np.int32)
    to = np.zeros((4, count + more, 2 * orders), np.int64)
    products = [(0, lift, p[0]), (1, lift, p[1]), (2, tension, p[2]), (0, -2 * turn, v[1]), (1, 2 * turn, v[0])]
    for i, f, g in [*products, *((i, drag, v[i]) for i in range(3))]:
        multiply(to[i], f, g, False)
    for f in p:
        multiply(to[3], f, f, True)
    bend = order[1:-1] * order[2:] * p[..., 2:] << half
    to[:3, :count, : bend.shape[2]] += bend
    to[1:3, :count, 0] -= constants[3:] << half
    to[3, 0, 0] -= 1 << 2 * half
    # what is left out of at most 2 O coefficients, in units of the last row
    cut = 0 if more >= count - 1 else (4 * orders * most >> DIGIT_BITS) + 1
    sums, last = weigh(to), fmpz(2 - DIGIT_BITS * (count + 1 + more))
    digits = [*((0, f[0]) for f in sums[:3]), *enumerate(sums[3])]
    return [arb((fmpz_poly(x[::-1].tolist())(1 << DIGIT_BITS) + cut * (2 * orders) ** n, last)) for n, x in digits]
