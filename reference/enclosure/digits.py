"""TRUSTED. The defects of a step by digits of radix 2^22, as exact sums in 64-bit integers.

Nothing here is a float, and no sum can overflow: `check` refuses what could (THEOREM.md, section 6). A digit of row q
stands for 2^(22 (L - 1 - q)) in a coefficient over 2^(22 L - 1), a sum of row t for 2^(22 (2 L - 2 - t)) in a product.
`multiply` and `carry` are compiled: numba, LLVM and the machine code kept on disk are believed, but where FLINT audits.
"""

from functools import lru_cache
from typing import Any

import numpy as np
from flint import arb, fmpz, fmpz_poly

from ..numbers.taylor_step import DIGIT_BITS
from ..system.machine_code import kept
from .balls import demand

# orders of a factor that are taken at once; rows in which a sum below 2^62 is carried on
MASK, BLOCK, TOP_ROWS = (1 << DIGIT_BITS) - 1, 8, 3


def check(rows: Any, constants: Any) -> int:
    """Return a bound of the products' sums in `norms`; raise ArithmeticError if a sum or factor may overflow."""
    (_, digits, orders), parts = rows.shape, (rows[:3], rows[3], constants)
    p, tension, constant = (max(int(x.max()), -int(x.min())) for x in parts)  # -x.min() itself may overflow
    most: int = digits * orders * p * (tension + 5 * constant + 3 * p)
    linear = orders**2 * p + constant + (1 << DIGIT_BITS) << DIGIT_BITS
    demand(most + linear < 1 << 62 and 2 * max(orders * p, tension, constant) < 1 << 31, "digits may overflow")
    return most


@kept()
def multiply(to: Any, i: int, f: Any, g: Any, alike: bool) -> None:
    """Add the product of two polynomials to the sums `i`, in the rows that these have; `alike`: f is g."""
    for r in range(g.shape[0]):
        row = g[r]
        while len(row) > 2 * BLOCK and not row[-BLOCK - 1]:
            row = row[:-1]
        for q in range(min(r + 1 if alike else f.shape[0], len(to) - r)):
            for k in range(0, f.shape[1] - 2 * BLOCK, BLOCK):
                s, out = f[q, BLOCK + k : 2 * BLOCK + k], to[q + r, i, k : k + len(row) - BLOCK]
                a, b, c, d, e, u, v, w = s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7]  # held in registers
                for j in range(len(out) if a | b | c | d | e | u | v | w else 0):
                    x = a * row[j + 8] + b * row[j + 7] + c * row[j + 6] + d * row[j + 5]
                    x += e * row[j + 4] + u * row[j + 3] + v * row[j + 2] + w * row[j + 1]
                    out[j] += (2 if alike and q < r else 1) * x


@kept()
def carry(digits: Any) -> None:
    """Make digits from 0 to 2^22 - 1 of sums; the highest, -1 for a negative coefficient, else 0, turns all signs."""
    for t in range(len(digits) - 1, 0, -1):
        for n in range(digits.shape[1]):
            digits[t - 1, n] += digits[t, n] >> DIGIT_BITS
            digits[t, n] &= MASK
    digits *= 1 + 2 * digits[0]


def padded(table: Any) -> Any:
    """Return digits as `multiply` takes them, in 32 bits, with a block of zeros before the orders and one after."""
    wide = np.zeros((*table.shape[:-1], table.shape[-1] + 2 * BLOCK), np.int32)
    wide[..., BLOCK:-BLOCK] = table
    return wide


@lru_cache(maxsize=64)  # steps of the same length follow each other
def split(n: fmpz, count: int) -> list[int]:
    """Return the digits of an integer, the highest first and signed."""
    return [int(n >> DIGIT_BITS * (count - 1)), *(int(n >> DIGIT_BITS * q) & MASK for q in range(count - 2, -1, -1))]


def norms(rows: Any, whole: list[fmpz], more: int = 1) -> list[arb]:
    """Return sums of |c| of d (three components), of τ, of p' (three components) and of τ' (n |c|).

    Args:
        rows: digits of x, m, w, λ, shape (4, L, orders).
        whole: ω, ω², γ, c_m, c_w over 2^(22 L - 1).
        more: rows of a product that are summed beyond L; what is left out is bounded, with L - 1 it is nothing.
    """
    (_, count, orders), half = rows.shape, DIGIT_BITS - 1
    constants, order = np.array([split(n, count) for n in whole]), np.arange(orders)
    most, p, bend = check(rows, constants), padded(rows[:3]), order[1:-1] * order[2:] * rows[:3, :, 2:] << half
    (turn, _, drag), v = padded(constants[:3, :, None]), padded(order[1:] * rows[:3, :, 1:])
    tension, lift = padded(rows[3]), padded(rows[3] - constants[1, :, None] * (order == 0))
    digits = np.zeros((TOP_ROWS + count + more, 7, 2 * (orders + BLOCK)), np.int64)
    to = digits[TOP_ROWS:]
    to[:count, :3, : bend.shape[2]] = bend.swapaxes(0, 1)
    to[:count, 4:, : orders - 1] = (order[1:] * rows[:3, :, 1:] << half).swapaxes(0, 1)
    to[:count, 1:3, 0] -= constants[3:].T << half
    to[0, 3, 0] -= 1 << 2 * half
    products = [(0, lift, p[0]), (1, lift, p[1]), (2, tension, p[2]), (0, -2 * turn, v[1]), (1, 2 * turn, v[0])]
    for i, f, g in (*products, *(x for n in range(3) for x in ((n, drag, v[n]), (3, p[n], p[n])))):
        multiply(to, i, f, g, f is g)
    carry(digits.reshape(len(digits), -1))
    # what is left out of at most 2 O coefficients, in units of the last row
    cut = 0 if more >= count - 1 else (4 * orders * most >> DIGIT_BITS) + 1
    last = fmpz(2 - DIGIT_BITS * (count + 1 + more))
    own = [(x, 1) for x in digits.sum(2).T] + [(digits[:, 3] @ np.arange(digits.shape[2]), 2 * orders)]
    return [arb((fmpz_poly(x[::-1].tolist())(1 << DIGIT_BITS) + cut * k, last)) for x, k in own]
