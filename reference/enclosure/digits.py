"""TRUSTED. The defects of a step by digits of radix 2^22, as exact sums in 64-bit integers.

Nothing here is a float, and no sum can overflow: `check` refuses what could (THEOREM.md, section 6). A digit of row q
stands for 2^(22 (L - 1 - q)) in a coefficient over 2^(22 L - 1), a sum of row t for 2^(22 (2 L - 2 - t)) in a product.
"""

from typing import Any

import numpy as np
from flint import arb, fmpz, fmpz_poly
from numba import njit

from ..machine_code import kept
from ..packing import DIGIT_BITS
from .balls import demand

MASK = (1 << DIGIT_BITS) - 1
TOP_ROWS = 3  # in which a sum below 2^62 is carried on


def check(rows: Any, constants: Any) -> int:
    """Return a bound of the products' sums in `norms`; raise ArithmeticError if a sum or factor may overflow."""
    (_, digits, orders), parts = rows.shape, (rows[:3], rows[3], constants)
    p, tension, constant = (max(int(x.max()), -int(x.min())) for x in parts)  # -x.min() itself may overflow
    most: int = digits * orders * p * (tension + 5 * constant + 3 * p)
    linear = orders**2 * p + constant + (1 << DIGIT_BITS) << DIGIT_BITS
    demand(most + linear < 1 << 62 and 2 * max(orders * p, tension, constant) < 1 << 31, "digits may overflow")
    return most


with kept():

    @njit(cache=True)  # type: ignore[untyped-decorator]  # numba has no types
    def multiply(to: Any, i: int, f: Any, g: Any, alike: bool) -> None:
        """Add the product of two polynomials to the sums `i`, in the rows that these have; `alike`: f is g."""
        for r in range(g.shape[0]):
            row = g[r]
            while len(row) and not row[-1]:
                row = row[:-1]
            for q in range(min(r + 1 if alike else f.shape[0], len(to) - r)):
                for k in range(f.shape[1]):
                    factor, out = np.int32((2 if alike and q < r else 1) * f[q, k]), to[q + r, i, k : k + len(row)]
                    for j in range(len(row) if factor else 0):
                        out[j] += factor * row[j]


def split(n: int, count: int) -> list[int]:
    """Return the digits of an integer, the highest first and signed."""
    return [n >> DIGIT_BITS * (count - 1), *(n >> DIGIT_BITS * q & MASK for q in range(count - 2, -1, -1))]


def norms(rows: Any, whole: list[fmpz], more: int = 1) -> list[arb]:
    """Return sums of |c| of d (three components) and of τ, and those of n |c| and n (n - 1) |c| of τ.

    Args:
        rows: digits of x, m, w, λ, shape (4, L, orders).
        whole: ω, ω², γ, c_m, c_w over 2^(22 L - 1).
        more: rows of a product that are summed beyond L; what is left out is bounded, with L - 1 it is nothing.
    """
    (_, count, orders), half = rows.shape, DIGIT_BITS - 1
    constants = np.array([split(int(n), count) for n in whole])
    most, order, rows = check(rows, constants), np.arange(orders), rows.astype(np.int32, order="C")
    turn, square, drag = constants[:3, :, None].astype(np.int32)
    p, tension = rows[:3], rows[3]
    v = (order[1:] * p[..., 1:]).astype(np.int32)
    digits = np.zeros((TOP_ROWS + count + more, 4, 2 * orders), np.int64)
    to, bend = digits[TOP_ROWS:], order[1:-1] * order[2:] * p[..., 2:] << half
    to[:count, :3, : bend.shape[2]] = bend.swapaxes(0, 1)
    to[:count, 1:3, 0] -= constants[3:].T << half
    to[0, 3, 0] -= 1 << 2 * half
    products = [(0, -square, p[0]), (1, -square, p[1]), (0, -2 * turn, v[1]), (1, 2 * turn, v[0])]
    products += [x for i, f in enumerate(p) for x in ((i, tension, f), (i, drag, v[i]), (3, f, f))]
    for i, f, g in products:
        multiply(to, i, f, g, f is g)
    # carried, digits are from 0 to 2^22 - 1, but for the highest: -1 for a negative coefficient, else 0
    for t in range(len(digits) - 1, 0, -1):
        digits[t - 1] += digits[t] >> DIGIT_BITS
        digits[t] &= MASK
    digits *= 1 + 2 * digits[0]
    # what is left out of at most 2 O coefficients, in units of the last row
    cut = 0 if more >= count - 1 else (4 * orders * most >> DIGIT_BITS) + 1
    n, last = np.arange(2 * orders), fmpz(2 - DIGIT_BITS * (count + 1 + more))
    of_d, of_tau = digits[:, :3].sum(2), digits[:, 3] @ np.stack([n**0, n, n * (n - 1)], 1)
    own = [*((x, 0) for x in of_d.T), *((x, k) for k, x in enumerate(of_tau.T))]
    return [arb((fmpz_poly(x[::-1].tolist())(1 << DIGIT_BITS) + cut * (2 * orders) ** k, last)) for x, k in own]
