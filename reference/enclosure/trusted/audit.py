"""TRUSTED. An audit of the sums of digits, in integers of NumPy: compiled code is not believed (THEOREM.md, section 6).

Digits that compiled code returned, and their sums, are kept for some steps. Then primes q and points z are drawn, and
the digits must have, at z and modulo q, the values of the polynomials that they stand for; the sums must be those of
the digits. Every q is below 2^31, so that a product of two residues is below 2^62.

| name                | symbol                                                      |
|---------------------|-------------------------------------------------------------|
| `count`             | L, digits of a coefficient                                  |
| `orders`            | O, coefficients of a polynomial                             |
| `weights`           | 2^(22 (R − 1 − t)) mod q of the rows t of R rows of digits  |
| `powers`            | z^n mod q                                                   |
| `p`, `v`, `v_rate`  | p, p', p'' at z mod q, by rows of digits: (steps, 3, L)     |
| `tension`           | λ at z mod q, by rows of digits: (steps, L)                 |
"""

from itertools import groupby
from secrets import randbelow
from typing import Any

import numpy as np
from flint import fmpz

from ...numbers.taylor_step import DIGIT_BITS
from .shapes import CompiledSums

DRAWS = 2  # of a prime and a point, for each step (6.17)
LEAST_PRIME = 1 << 30  # primes are drawn from here to twice this
MOST_ROWS = 1 << 9  # of digits
MOST_BYTES = 1 << 22  # of digits that wait for a check
TAU = 3  # place of τ among the results


class WrongSumsError(Exception):
    """Compiled code returned digits or sums that are wrong."""


class SumsAudit:
    """Takes what compiled code returned for each step of a proof, and checks it afterwards."""

    def __init__(self) -> None:
        self.waiting = list[CompiledSums]()
        self.bytes = 0

    @property
    def full(self) -> bool:
        """Whether so much waits that it should be checked."""
        return self.bytes > MOST_BYTES

    def take(self, step: CompiledSums) -> None:
        """Keep what compiled code returned for a step until the next check."""
        self.waiting.append(step)
        self.bytes += step.digits.nbytes

    def check(self) -> None:
        """Raise WrongSumsError unless every pending sum is right; (6.17) bounds the chance of a wrong one to pass."""
        waiting = self.waiting
        self.waiting = []
        self.bytes = 0
        for _, steps in groupby(waiting, key=_shapes):
            _check(AuditedSteps(list(steps)))


def _shapes(step: CompiledSums) -> Any:
    return step.rows.shape, step.digits.shape, step.absolute.shape, step.product_rows


class AuditedSteps:
    """Steps of the same shape, as arrays whose first axis counts the steps."""

    def __init__(self, steps: list[CompiledSums]) -> None:
        self.table = np.stack([step.rows for step in steps]).astype(np.int64)
        self.constants = np.stack([step.constants for step in steps])
        self.absolute = np.stack([step.absolute for step in steps])
        self.digits = np.stack([step.digits for step in steps])
        self.product_rows = steps[0].product_rows
        _, _, self.count, self.orders = self.table.shape
        _, self.rows, _, self.columns = self.digits.shape


def _check(steps: AuditedSteps) -> None:
    """Raise WrongSumsError unless digits and sums of all steps are right."""
    top = steps.digits[:, 0]
    below = steps.digits[:, 1:]
    # (6.14): so the highest digit has the coefficient's sign
    _demand(top.min() >= -1 and top.max() <= 0)
    _demand(below.min() >= 0 and below.max() < 1 << DIGIT_BITS)
    _demand(steps.rows < MOST_ROWS)

    signs = 1 + 2 * top
    for _ in range(DRAWS):
        q = _drawn_prime()
        powers = _powers(randbelow(q), max(steps.columns, steps.orders), q)
        weights = _powers(1 << DIGIT_BITS, steps.rows, q)[::-1]

        # a sum of fewer than 2^9 products of 2^31 and 2^22
        coefficients = np.einsum("t,stin->sin", weights, steps.digits) % q
        values = _summed(coefficients, powers[: steps.columns], q)
        _demand(np.array_equal(values, _polynomials(steps, powers, weights, q)))  # (6.15)

        # (6.16): coefficients are below 2^31, and n is below 2^20
        sums_of_sizes = (signs * coefficients).sum(-1)
        sums_of_rates = (np.arange(steps.columns) * signs[:, TAU] * coefficients[:, TAU]).sum(-1)
        expected = np.concatenate([sums_of_sizes, sums_of_rates[:, None]], 1) % q
        _demand(np.array_equal(_summed(steps.absolute % q, weights, q), expected))


def _polynomials(steps: AuditedSteps, powers: Any, weights: Any, q: int) -> Any:
    """Return d, τ and p' at a point modulo q, without the rows that products leave out: (steps, 7).

    d = p'' + 2 Ω × p' + Ω × (Ω × p) + γ p' − c + λ p, where Ω × p = ω (−m, x, 0); τ = |p|² − 1.
    """
    orders = steps.orders
    n = np.arange(orders)
    taken = np.zeros((orders, 3), np.int64)
    taken[:, 0] = powers[:orders]
    taken[1:, 1] = n[1:] * powers[: orders - 1] % q
    taken[2:, 2] = n[2:] * n[1:-1] * powers[: max(orders - 2, 0)] % q
    # O times a digit of p is below 2^30 (6.12), so these sums are below 2^61
    p, v, v_rate = np.moveaxis(steps.table[:, :3] @ taken % q, -1, 0)
    tension = _summed(steps.table[:, 3], powers[:orders], q)

    # of rows of two factors: the weight of the row of their product, or 0 if that is left out
    product_weights = weights[-steps.product_rows :]
    row = np.arange(steps.count)
    padded = np.concatenate([product_weights, np.zeros(steps.count, np.int64)])
    pairs = padded[row[:, None] + row]
    p_partner = _summed(p[..., None, :], pairs, q)
    v_partner = _summed(v[..., None, :], pairs, q)

    # in the order of `Integers`, and 2^B
    omega, omega_squared, drag, c_m, c_w, _ = np.moveaxis(steps.constants % q, 1, 0)

    # 2^B has one digit, in the highest row
    unit = 1 << DIGIT_BITS - 1
    single = product_weights[: steps.count]
    v_unit = unit * _summed(v, single, q) % q
    v_rate_unit = unit * _summed(v_rate, single, q) % q
    c_unit = unit * _summed(np.stack([c_m, c_w], 1), single, q) % q
    one = unit * unit % q * int(product_weights[0]) % q

    lift = np.stack([tension - omega_squared, tension - omega_squared, tension], 1) % q
    d = _summed(lift, p_partner, q) + _summed(drag[:, None], v_partner, q) + v_rate_unit
    d[:, 0] -= 2 * _summed(omega, v_partner[:, 1], q)
    d[:, 1] += 2 * _summed(omega, v_partner[:, 0], q)
    d[:, 1:] -= c_unit
    tau = _summed(p, p_partner, q).sum(-1, keepdims=True) - one

    return np.concatenate([d, tau, v_unit], 1) % q


def _summed(factors: Any, residues: Any, q: int) -> Any:
    """Return the sums of products over the last axis modulo q; factors are below 2^31 in size."""
    return (factors * residues % q).sum(-1) % q


def _powers(base: int, number: int, q: int) -> Any:
    """Return the powers of a number modulo q, from 1 on."""
    powers = [1]
    while len(powers) < number:
        powers.append(powers[-1] * base % q)
    return np.array(powers)


def _drawn_prime() -> int:
    """Return a prime from 2^30 to 2^31, each as likely as another."""
    while True:
        q = LEAST_PRIME + randbelow(LEAST_PRIME)
        if fmpz(q).is_prime():
            return q


def _demand(holds: bool) -> None:
    if not holds:
        raise WrongSumsError("compiled sums of digits are wrong")
