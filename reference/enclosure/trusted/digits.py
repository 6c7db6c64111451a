"""TRUSTED. The defects of a step by digits of radix 2^22, as exact sums in 64-bit integers (THEOREM.md, section 6).

Nothing here is a float, and no sum can overflow: `check` refuses what could. A digit of row q stands for
2^(22 (L - 1 - q)) in a coefficient over 2^(22 L - 1), a sum of row t for 2^(22 (2 L - 2 - t)) in a product.
`multiply`, `sums_of_step` and `sums` are compiled: numba, LLVM and the machine code kept on disk are believed,
unless `audit` checks what they return.

| name                       | symbol                                                         |
|----------------------------|----------------------------------------------------------------|
| `count`                    | L, digits of a coefficient                                     |
| `orders`                   | O, coefficients of a polynomial                                |
| `p`, `tension`, `constant` | m, M, C: the largest digits of p, λ and the constants          |
| `products`                 | L O m (M + 5C + 3m), a bound of all sums of products of digits |
| `linear`                   | a bound of the products with 2^B, of c and of the 1 of τ       |
| `more`                     | T − L, rows of a product that are summed beyond L              |
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from flint import arb, fmpz, fmpz_mat

from ...numbers.taylor_step import DIGIT_BITS
from ...system.machine_code import kept
from .balls import demand
from .shapes import CompiledSums

MASK = (1 << DIGIT_BITS) - 1
BLOCK = 8  # orders of a factor that are taken at once
TOP_ROWS = 3  # rows in which a sum below 2^62 is carried on
MOST_BITS = 62  # of a sum
FACTOR_BITS = 31  # of a factor of λ p and of the squares, without its sign

# rows of the series that are multiplied: p, λ, p' and the 1, which is 2^B over 2^B
X, M, W, TENSION, X_RATE, M_RATE, W_RATE, ONE = range(8)
# rows of the constants: those of `Integers`, and the 1
OMEGA, OMEGA_SQUARED, DRAG, C_M, C_W, UNIT = range(6)
# rows of the results, in the order of `DefectNorms`
D_X, D_M, D_W, TAU, P_RATE_X, P_RATE_M, P_RATE_W, TAU_RATE = range(8)
RESULTS = 7  # that are sums of products; τ' comes from τ


class LinearTerm(NamedTuple):
    """A small integer times a constant times a series, which is added to a result."""

    result: int
    factor: int
    constant: int
    series: int


# d = λ p + p'' + 2 Ω × p' + Ω × (Ω × p) + γ p' − c without λ p and p'', τ = |p|² − 1 without |p|², and p' (section 6)
LINEAR = (
    LinearTerm(D_X, -1, OMEGA_SQUARED, X),
    LinearTerm(D_M, -1, OMEGA_SQUARED, M),
    LinearTerm(D_X, -2, OMEGA, M_RATE),
    LinearTerm(D_M, 2, OMEGA, X_RATE),
    LinearTerm(D_X, 1, DRAG, X_RATE),
    LinearTerm(D_M, 1, DRAG, M_RATE),
    LinearTerm(D_W, 1, DRAG, W_RATE),
    LinearTerm(D_M, -1, C_M, ONE),
    LinearTerm(D_W, -1, C_W, ONE),
    LinearTerm(TAU, -1, UNIT, ONE),
    LinearTerm(P_RATE_X, 1, UNIT, X_RATE),
    LinearTerm(P_RATE_M, 1, UNIT, M_RATE),
    LinearTerm(P_RATE_W, 1, UNIT, W_RATE),
)


def check(tables: Any, constants: Any) -> list[int]:
    """Return for each step a bound of the products' sums in `norms`; raise ArithmeticError if one may overflow.

    Args:
        tables: digits of x, m, w, λ of each step, shape (steps, 4, L, orders).
        constants: those of the step's constants, shape (steps, 5, L).
    """
    _, _, count, orders = tables.shape
    of_p = _largest(tables[:, :TENSION])
    of_tension = _largest(tables[:, TENSION])
    of_constants = _largest(constants)

    bounds = []
    for p, tension, constant in zip(of_p, of_tension, of_constants, strict=True):
        products = count * orders * p * (tension + 5 * constant + 3 * p)  # (6.9)
        linear = (orders**2 * p + constant + (1 << DIGIT_BITS)) << DIGIT_BITS  # (6.10)
        demand(products + linear < 1 << MOST_BITS, "digits may overflow")  # (6.11)
        # k c_k, twice a constant or a digit of λ
        demand(
            2 * max(orders * p, tension, constant) < 1 << FACTOR_BITS, "digits may overflow"
        )  # (6.12)
        bounds.append(products)
    return bounds


def _largest(digits: Any) -> list[int]:
    """Return the size of the largest digit of each step."""
    of_step = digits.reshape(len(digits), -1)
    # as integers without a limit: -digits.min() itself may overflow
    highest = of_step.max(axis=1).tolist()
    lowest = of_step.min(axis=1).tolist()
    return [max(high, -low) for high, low in zip(highest, lowest, strict=True)]


@kept()
def multiply(to: Any, i: int, f: Any, g: Any, alike: bool) -> None:
    """Add the product of two polynomials to the sums `i`, in the rows that these have; `alike`: f is g."""
    # a kernel: eight orders of f at once are held in registers, and BLOCK zeros stand around those of g
    for r in range(g.shape[0]):
        row = g[r]
        while len(row) > 2 * BLOCK and not row[-BLOCK - 1]:
            row = row[:-1]
        for q in range(min(r + 1 if alike else f.shape[0], len(to) - r)):
            twice = 2 if alike and q < r else 1
            for k in range(0, f.shape[1] - 2 * BLOCK, BLOCK):
                s = f[q, BLOCK + k : 2 * BLOCK + k]
                out = to[q + r, i, k : k + len(row) - BLOCK]
                a, b, c, d, e, u, v, w = s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7]
                for j in range(len(out) if a | b | c | d | e | u | v | w else 0):
                    x = a * row[j + 8] + b * row[j + 7] + c * row[j + 6] + d * row[j + 5]
                    x += e * row[j + 4] + u * row[j + 3] + v * row[j + 2] + w * row[j + 1]
                    out[j] += twice * x


@kept()
def sums(series: Any, constants: Any, more: int) -> Any:
    """Return the sums of digits of each step, shape (steps, 8, rows).

    The second array has the digits of all c after the carry, shape (steps, rows, 7, columns).
    """
    steps, _, count, width = series.shape
    rows = TOP_ROWS + count + more
    absolute = np.zeros((steps, RESULTS + 1, rows), np.int64)
    digits = np.zeros((steps, rows, RESULTS, 2 * (width - BLOCK)), np.int64)
    for step in range(steps):
        sums_of_step(series[step], constants[step], digits[step], absolute[step])
    return absolute, digits


@kept()
def sums_of_step(series: Any, constants: Any, digits: Any, absolute: Any) -> None:
    """Add up over all orders the digits of |c|, by rows: of d, of τ, of p', and of n |c| of τ.

    `digits` takes the digits of all c after the carry: by rows, results and orders.
    """
    # a kernel: one array of digits, from the products to their sums
    _, count, width = series.shape
    to = digits[TOP_ROWS:]

    # λ p and |p|²
    for i in range(3):
        multiply(to, D_X + i, series[TENSION], series[X + i], False)
        multiply(to, TAU, series[X + i], series[X + i], True)

    for result, factor, constant, factor_series in LINEAR:
        for q in range(count):
            c = factor * constants[constant, q]
            for r in range(min(count, len(to) - q) if c else 0):
                for n in range(width - 2 * BLOCK):
                    to[q + r, result, n] += c * series[factor_series, r, BLOCK + n]

    # p'', the derivative of p' times 2^B
    for i in range(3):
        for t in range(count):
            for n in range(width):
                to[t, D_X + i, n] += (n + 1) * to[t, P_RATE_X + i, n + 1]

    for i in range(RESULTS):
        # carry, from the lowest row up
        for t in range(len(digits) - 1, 0, -1):
            for n in range(digits.shape[2]):
                digits[t - 1, i, n] += digits[t, i, n] >> DIGIT_BITS
                digits[t, i, n] &= MASK
        for t in range(len(digits)):
            for n in range(digits.shape[2]):
                # the highest digit, -1 for a negative coefficient, else 0, turns all signs
                x = (digits[t, i, n] ^ digits[0, i, n]) - digits[0, i, n]
                absolute[i, t] += x
                if i == TAU:
                    absolute[TAU_RATE, t] += n * x


@lru_cache(maxsize=64)  # steps of the same length follow each other
def split(count: int, *integers: fmpz) -> Any:
    """Return the digits of integers, the highest first and signed."""
    shifts = range(DIGIT_BITS * (count - 2), -1, -DIGIT_BITS)
    rows = []
    for n in integers:
        highest = int(n >> DIGIT_BITS * (count - 1))
        rows.append([highest, *(int(n >> bits) & MASK for bits in shifts)])
    return np.array(rows)


def norms(tables: Any, integers: Any, more: int = 1, audit: Any = None) -> list[list[arb]]:
    """Return for each step sums of |c| of d (three components), of τ, of p' (three components) and of τ' (n |c|).

    Args:
        tables: digits of x, m, w, λ of each step, shape (steps, 4, L, orders).
        integers: of each step ω, ω², γ, c_m, c_w over 2^(22 L - 1).
        more: rows of a product that are summed beyond L; what is left out is bounded, with L - 1 it is nothing.
        audit: a `SumsAudit`, which takes what compiled code returned.
    """
    steps, _, count, orders = tables.shape
    one = fmpz(1) << DIGIT_BITS * count - 1
    constants = np.stack([split(count, *of_step, one) for of_step in integers])
    products = check(tables, constants[:, :UNIT])

    series = np.zeros((steps, 8, count, orders + 2 * BLOCK), np.int32)
    inner = series[..., BLOCK:-BLOCK]
    inner[:, : TENSION + 1] = tables
    inner[:, X_RATE : W_RATE + 1, :, :-1] = np.arange(1, orders) * tables[:, :TENSION, :, 1:]
    inner[:, ONE, :, 0] = constants[:, UNIT]
    absolute, digits = sums(series, constants, more)
    if audit is not None:
        for of_step in zip(tables, constants, absolute, digits, strict=True):
            audit.take(CompiledSums(*of_step, product_rows=count + more))

    exponent = fmpz(2 - DIGIT_BITS * (count + 1 + more))
    bounds = []
    for totals, of_products in zip(joined(absolute), products, strict=True):
        # (6.13): what is left out of at most 2 O coefficients, in units of the last row
        cut = 0
        if more < count - 1:
            cut = (4 * orders * of_products >> DIGIT_BITS) + 1
        cuts = [cut] * RESULTS + [cut * 2 * orders]
        sums_of_all = zip(totals, cuts, strict=True)
        bounds.append([arb((total + rest, exponent)) for total, rest in sums_of_all])
    return bounds


def joined(digits: Any) -> list[list[fmpz]]:
    """Return the integers whose digits are along the last axis, highest first; shape (steps, numbers, rows)."""
    steps, numbers, rows = digits.shape
    weights = [fmpz(1) << DIGIT_BITS * row for row in reversed(range(rows))]
    integers = fmpz_mat(steps * numbers, rows, digits.ravel().tolist()) * fmpz_mat(rows, 1, weights)
    entries = integers.entries()
    return [entries[i : i + numbers] for i in range(0, len(entries), numbers)]
