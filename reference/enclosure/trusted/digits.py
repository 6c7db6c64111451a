"""TRUSTED. The defects of a step by digits of radix 2^22, as exact sums in 64-bit integers.

Nothing here is a float, and no sum can overflow: `check` refuses what could (THEOREM.md, section 6). A digit of row q
stands for 2^(22 (L - 1 - q)) in a coefficient over 2^(22 L - 1), a sum of row t for 2^(22 (2 L - 2 - t)) in a product.
`multiply` and `sums` are compiled: numba, LLVM and the machine code kept on disk are believed, but where FLINT audits.
"""

from functools import lru_cache
from typing import Any

import numpy as np
from flint import arb, fmpz, fmpz_poly

from ...numbers.taylor_step import DIGIT_BITS
from ...system.machine_code import kept
from .balls import demand

# orders of a factor that are taken at once; rows in which a sum below 2^62 is carried on
MASK, BLOCK, TOP_ROWS = (1 << DIGIT_BITS) - 1, 8, 3
# sum, factor, constant and series of a term of `sums`: - ω² p, 2 Ω × p', - c, the - 1 of τ; and γ p', p'
FEW = (
    (0, -1, 1, 0),
    (1, -1, 1, 1),
    (0, -2, 0, 5),
    (1, 2, 0, 4),
    (1, -1, 3, 7),
    (2, -1, 4, 7),
    (3, -1, 5, 7),
)
LINEAR = FEW + tuple(term for n in range(3) for term in ((n, 1, 2, 4 + n), (4 + n, 1, 5, 4 + n)))


def check(rows: Any, constants: Any) -> int:
    """Return a bound of the products' sums in `norms`; raise ArithmeticError if a sum or factor may overflow."""
    (_, digits, orders), parts = rows.shape, (rows[:3], rows[3], constants)
    # -x.min() itself may overflow
    p, tension, constant = (max(int(x.max()), -int(x.min())) for x in parts)
    most: int = digits * orders * p * (tension + 5 * constant + 3 * p)
    linear = orders**2 * p + constant + (1 << DIGIT_BITS) << DIGIT_BITS
    demand(
        most + linear < 1 << 62 and 2 * max(orders * p, tension, constant) < 1 << 31,
        "digits may overflow",
    )
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
                # held in registers
                a, b, c, d, e, u, v, w = s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7]
                for j in range(len(out) if a | b | c | d | e | u | v | w else 0):
                    x = a * row[j + 8] + b * row[j + 7] + c * row[j + 6] + d * row[j + 5]
                    x += e * row[j + 4] + u * row[j + 3] + v * row[j + 2] + w * row[j + 1]
                    out[j] += (2 if alike and q < r else 1) * x


@kept()
def sums(series: Any, constants: Any, more: int) -> Any:
    """Return the sums over all orders of the digits of |c|, by rows: of d, of τ, of p', and of n |c| of τ."""
    _, count, width = series.shape
    digits = np.zeros((TOP_ROWS + count + more, 7, 2 * (width - BLOCK)), np.int64)
    own, to = np.zeros((8, len(digits)), np.int64), digits[TOP_ROWS:]
    for i in range(3):
        multiply(to, i, series[3], series[i], False)
        multiply(to, 3, series[i], series[i], True)
    for i, times, constant, factor in LINEAR:
        for q in range(count):
            c = times * constants[constant, q]
            for r in range(min(count, len(to) - q) if c else 0):
                for n in range(width - 2 * BLOCK):
                    to[q + r, i, n] += c * series[factor, r, BLOCK + n]
    for i in range(7):
        for t in range(count if i < 3 else 0):
            for n in range(width):
                to[t, i, n] += (n + 1) * to[t, 4 + i, n + 1]  # p''
        for t in range(len(digits) - 1, 0, -1):
            for n in range(digits.shape[2]):
                digits[t - 1, i, n] += digits[t, i, n] >> DIGIT_BITS
                digits[t, i, n] &= MASK
        for t in range(len(digits)):
            for n in range(digits.shape[2]):
                # the highest digit, -1 for a negative coefficient, else 0, turns all signs
                x = (digits[t, i, n] ^ digits[0, i, n]) - digits[0, i, n]
                own[i, t] += x
                own[7, t] += n * x if i == 3 else 0
    return own


@lru_cache(maxsize=64)  # steps of the same length follow each other
def split(count: int, *whole: fmpz) -> Any:
    """Return the digits of integers, the highest first and signed."""
    low = range(DIGIT_BITS * (count - 2), -1, -DIGIT_BITS)
    return np.array(
        [
            [int(n >> DIGIT_BITS * (count - 1)), *(int(n >> bits) & MASK for bits in low)]
            for n in whole
        ]
    )


def norms(rows: Any, whole: list[fmpz], more: int = 1) -> list[arb]:
    """Return sums of |c| of d (three components), of τ, of p' (three components) and of τ' (n |c|).

    Args:
        rows: digits of x, m, w, λ, shape (4, L, orders).
        whole: ω, ω², γ, c_m, c_w over 2^(22 L - 1).
        more: rows of a product that are summed beyond L; what is left out is bounded, with L - 1 it is nothing.
    """
    (_, count, orders), last = rows.shape, 2 - DIGIT_BITS * (rows.shape[1] + 1 + more)
    series = np.zeros((8, count, orders + 2 * BLOCK), np.int32)
    constants, inner = (
        split(count, *whole, fmpz(1) << DIGIT_BITS * count - 1),
        series[..., BLOCK:-BLOCK],
    )
    most = check(rows, constants[:5])
    inner[:4], inner[4:7, :, :-1], inner[7, :, 0] = (
        rows,
        np.arange(1, orders) * rows[:3, :, 1:],
        constants[5],
    )
    # what is left out of at most 2 O coefficients, in units of the last row
    cut = 0 if more >= count - 1 else (4 * orders * most >> DIGIT_BITS) + 1
    own = enumerate(sums(series, constants, more)[:, ::-1].tolist())
    return [
        arb((fmpz_poly(x)(1 << DIGIT_BITS) + cut * (2 * orders if i == 7 else 1), fmpz(last)))
        for i, x in own
    ]
