"""The audit of compiled sums: every fault is found, of any kind and size, and what is right passes."""

from __future__ import annotations

from functools import cache
from itertools import islice
from random import Random

import numpy as np
import pytest

pytest.importorskip("numba")

import reference
from reference.enclosure.trusted.audit import SumsAudit, WrongSumsError
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.digits import LINEAR, ONE, UNIT
from reference.enclosure.trusted.shapes import CompiledSums
from reference.enclosure.trusted.system import SceneBalls
from reference.numbers.taylor_step import DIGIT_BITS
from reference.solver.proof_steps import Feed

SCENES = {
    "paris": 153,
    "pantheon": 219,
    "damped": 109,
    "southern": 131,
    "two_radians": 197,
    "retrograde": 241,
}  # with the bits of their coefficients
RESULTS = ("d_x", "d_m", "d_w", "tau", "p_rate_x", "p_rate_m", "p_rate_w")
TAU = RESULTS.index("tau")
P_RATE_X = RESULTS.index("p_rate_x")
RADIX = 1 << DIGIT_BITS


@cache
def compiled(name: str, count: int) -> list[CompiledSums]:
    """What compiled code returns for the first steps of a scene."""
    scene = reference.load_scene(name, ["run.t_end=20000", "run.grid_step=20000"])
    bits = SCENES[name]
    audit = SumsAudit()
    balls = SceneBalls(scene.exact, bits + 64, audit)
    feed = Feed(scene.exact, tuple(scene.exact.grid), "limbs")
    for step in islice(feed(bits), count):
        assert Piece(balls, step).norms
    feed.stop()
    assert len(audit.waiting) == count
    return audit.waiting


def coefficients(step: CompiledSums) -> np.ndarray:
    """The integers that the digits stand for, by results and orders."""
    whole = np.zeros(step.digits.shape[1:], object)
    for row in step.digits:
        whole = whole * RADIX + row.astype(object)
    return whole


def compiled_from(step: CompiledSums, whole: np.ndarray) -> CompiledSums:
    """What a step would have returned for other integers, consistent in digits and sums."""
    rest = whole.copy()
    digits = np.zeros_like(step.digits)
    for t in range(len(digits) - 1, 0, -1):
        digits[t] = (rest % RADIX).astype(np.int64)
        rest = rest // RADIX
    digits[0] = rest.astype(np.int64)
    return step._replace(digits=digits, absolute=sums_of(digits))


def sums_of(digits: np.ndarray) -> np.ndarray:
    signed = np.where(digits[0] < 0, -digits, digits)
    sums = signed.sum(-1).T
    rates = (np.arange(digits.shape[2]) * signed[:, TAU]).sum(-1)
    return np.concatenate([sums, rates[None]])


def series_of(step: CompiledSums, number: int) -> np.ndarray:
    """Rows of digits of x, m, w, λ, of the derivatives of x, m, w, and of 2^B."""
    rows = step.rows.astype(object)
    if number == ONE:
        one = np.zeros(rows.shape[1:], object)
        one[0, 0] = RADIX // 2
        return one
    if number < 4:
        return rows[number]
    rate = np.zeros(rows.shape[1:], object)
    rate[:, :-1] = rows[number - 4, :, 1:] * np.arange(1, rows.shape[2])
    return rate


def product(step: CompiledSums, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The product of two series of digits, without the rows that are left out."""
    result = np.zeros(step.digits.shape[2], object)
    lowest = step.product_rows - 1
    for q, f in enumerate(first):
        for r, g in enumerate(second[: step.product_rows - q]):
            row = np.convolve(f, g)
            result[: len(row)] += row * RADIX ** (lowest - q - r)
    return result


def a_place(rng: Random, step: CompiledSums) -> tuple[int, ...]:
    return tuple(rng.randrange(n) for n in step.digits.shape)


# Each kind of fault, of a step and with a generator of random numbers


def a_digit(rng: Random, step: CompiledSums) -> CompiledSums:
    digits = step.digits.copy()
    digits[a_place(rng, step)] ^= 1 << rng.randrange(64 - 1)
    return step._replace(digits=digits)


def a_digit_and_its_sum(rng: Random, step: CompiledSums) -> CompiledSums:
    digits = step.digits.copy()
    digits[a_place(rng, step)] ^= 1 << rng.randrange(DIGIT_BITS)
    return step._replace(digits=digits, absolute=sums_of(digits))


def a_lost_carry(rng: Random, step: CompiledSums) -> CompiledSums:
    row, result, order = a_place(rng, step)
    whole = coefficients(step)
    whole[result, order] -= RADIX**row
    return compiled_from(step, whole)


def a_carry_that_is_not_made(rng: Random, step: CompiledSums) -> CompiledSums:
    digits = step.digits.copy()
    row, result, order = a_place(rng, step)
    digits[row, result, order] -= 1
    digits[(row + 1) % len(digits), result, order] += RADIX
    return step._replace(digits=digits, absolute=sums_of(digits))


def a_sign(rng: Random, step: CompiledSums) -> CompiledSums:
    whole = coefficients(step)
    _, result, order = a_place(rng, step)
    whole[result, order] *= -1
    return compiled_from(step, whole)


def a_shifted_row(rng: Random, step: CompiledSums) -> CompiledSums:
    row, result, _ = a_place(rng, step)
    digits = step.digits.copy()
    digits[row, result] = np.roll(digits[row, result], 1)
    return step._replace(digits=digits, absolute=sums_of(digits))


def shifted_rows(rng: Random, step: CompiledSums) -> CompiledSums:
    _, result, _ = a_place(rng, step)
    whole = coefficients(step)
    whole[result] //= RADIX
    return compiled_from(step, whole)


def a_dropped_order(rng: Random, step: CompiledSums) -> CompiledSums:
    _, result, order = a_place(rng, step)
    whole = coefficients(step)
    whole[result, order] = 0
    return compiled_from(step, whole)


def dropped_last_orders(rng: Random, step: CompiledSums) -> CompiledSums:
    whole = coefficients(step)
    last = rng.randrange(1, 1 + step.rows.shape[2])
    whole[:, -last:] = 0
    return compiled_from(step, whole)


def swapped_results(rng: Random, step: CompiledSums) -> CompiledSums:
    whole = coefficients(step)
    one, other = rng.sample(range(len(RESULTS)), 2)
    whole[[one, other]] = whole[[other, one]]
    return compiled_from(step, whole)


def a_linear_term(rng: Random, step: CompiledSums) -> CompiledSums:
    """Left out or doubled; p' feeds p'', which is made of it."""
    term = rng.choice(LINEAR)
    constant = np.zeros((len(step.constants[0]), 1), object)
    constant[:, 0] = step.constants[term.constant]
    amount = rng.choice((-1, 1)) * term.factor
    change = amount * product(step, constant, series_of(step, term.series))
    whole = coefficients(step)
    whole[term.result] += change
    if term.constant == UNIT and term.result >= P_RATE_X:
        whole[term.result - P_RATE_X, :-1] += change[1:] * np.arange(1, len(change))
    return compiled_from(step, whole)


def an_order_of_a_product(rng: Random, step: CompiledSums) -> CompiledSums:
    """An order of λ or of p, which is left out of λ p or of |p|²."""
    component = rng.randrange(3)
    factor, result = rng.choice(((3, component), (component, TAU)))
    order = series_of(step, factor).copy()
    order[:, np.arange(order.shape[1]) != rng.randrange(order.shape[1])] = 0
    whole = coefficients(step)
    whole[result] -= product(step, order, series_of(step, component))
    return compiled_from(step, whole)


def a_row_of_a_product(rng: Random, step: CompiledSums) -> CompiledSums:
    component = rng.randrange(3)
    row = series_of(step, 3).copy()
    row[np.arange(len(row)) != rng.randrange(len(row))] = 0
    whole = coefficients(step)
    whole[component] -= product(step, row, series_of(step, component))
    return compiled_from(step, whole)


def a_sum(rng: Random, step: CompiledSums) -> CompiledSums:
    absolute = step.absolute.copy()
    place = tuple(rng.randrange(n) for n in absolute.shape)
    absolute[place] += rng.choice((-1, 1)) << rng.randrange(40)
    return step._replace(absolute=absolute)


def a_sum_of_fewer_orders(rng: Random, step: CompiledSums) -> CompiledSums:
    absolute = sums_of(step.digits[:, :, : rng.randrange(step.digits.shape[2])])
    return step._replace(absolute=absolute)


def swapped_sums(rng: Random, step: CompiledSums) -> CompiledSums:
    absolute = step.absolute.copy()
    one, other = rng.sample(range(len(absolute)), 2)
    absolute[[one, other]] = absolute[[other, one]]
    return step._replace(absolute=absolute)


def signs_ignored(rng: Random, step: CompiledSums) -> CompiledSums:
    sums = step.digits.sum(-1).T
    return step._replace(absolute=np.concatenate([sums, step.absolute[-1:]]))


def another_step(rng: Random, step: CompiledSums) -> CompiledSums:
    other = rng.choice([s for steps in map(steps_of, SCENES) for s in steps])
    if other.digits.shape != step.digits.shape:
        return step
    return step._replace(digits=other.digits, absolute=other.absolute)


FAULTS = (
    a_digit, a_digit_and_its_sum, a_lost_carry, a_carry_that_is_not_made, a_sign, a_shifted_row,
    shifted_rows, a_dropped_order, dropped_last_orders, swapped_results, a_linear_term,
    an_order_of_a_product, a_row_of_a_product, a_sum, a_sum_of_fewer_orders, swapped_sums,
    signs_ignored, another_step,
)  # fmt: skip


def steps_of(name: str) -> list[CompiledSums]:
    return compiled(name, 12)


def same(step: CompiledSums, other: CompiledSums) -> bool:
    return np.array_equal(step.digits, other.digits) and np.array_equal(
        step.absolute, other.absolute
    )


def faulty(seed: int) -> tuple[str, list[CompiledSums]]:
    """A kind of fault, and steps of a scene of which one has it."""
    rng = Random(seed)
    fault = FAULTS[seed % len(FAULTS)]
    while True:
        steps = list(steps_of(rng.choice(list(SCENES))))
        place = rng.randrange(len(steps))
        spoilt = fault(rng, steps[place])
        if not same(spoilt, steps[place]):
            steps[place] = spoilt
            return fault.__name__, steps


def passes(steps: list[CompiledSums]) -> bool:
    audit = SumsAudit()
    for step in steps:
        audit.take(step)
    try:
        audit.check()
    except WrongSumsError:
        return False
    return True


def test_two_hundred_faults_are_all_found(size):
    """Of each kind there are two or more in every run, and eleven or more in 200."""
    seeds = range(size(2 * len(FAULTS), 200))
    assert [kind for kind, steps in map(faulty, seeds) if passes(steps)] == []


@pytest.mark.parametrize("name", SCENES)
def test_what_is_right_passes(name, size):
    steps = compiled(name, size(30, 334))
    assert [n for n, step in enumerate(steps) if not passes([step])] == []
    assert passes(steps)


@pytest.mark.parametrize("name", SCENES)
def test_the_faults_start_from_what_compiled_code_returned(name):
    for step in steps_of(name):
        assert same(compiled_from(step, coefficients(step)), step)


def test_a_check_leaves_nothing_for_the_next_one():
    audit = SumsAudit()
    _, steps = faulty(0)
    for step in steps:
        audit.take(step)
    assert not audit.full
    with pytest.raises(WrongSumsError):
        audit.check()
    audit.check()  # of no step
