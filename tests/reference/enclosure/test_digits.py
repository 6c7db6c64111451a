"""Sums of digits are FLINT's integers, what is left out is bounded, and sums that may overflow are refused."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest
from enclosure_oracle import PARIS, scene, unit_step
from flint import fmpz_poly

pytest.importorskip("numba")

from reference.enclosure.trusted.audit import SumsAudit
from reference.enclosure.trusted.defect import Piece, pieces, polynomials
from reference.enclosure.trusted.digits import check, norms, split
from reference.enclosure.trusted.system import SceneBalls
from reference.numbers.taylor_step import DIGIT_BITS, Digits

MOST = 1 << (DIGIT_BITS - 1)
WORLDS = [
    SceneBalls(inputs, 400)
    for inputs in (PARIS, scene(drag="0.3", rotation_rate="-0.7", equatorial_radius="5"))
]


def table(rng: Random) -> np.ndarray:
    """Digits that descend as a series does, or not at all, of any sign, or the largest that there are."""
    count, orders = rng.randint(2, 9), rng.randint(1, 40)
    kind, rows = rng.randrange(4), np.zeros((4, count, orders), np.int32)
    for i in range(4):
        for q in range(count):
            for k in range(orders if kind else min(orders, 3 * q + 2)):
                largest = rng.choice((-MOST, MOST))
                rows[i, q, k] = (
                    largest
                    if kind == 1
                    else rng.randint(-MOST, MOST)
                    if kind != 2
                    else rng.choice((0, largest))
                )
    if kind == 3:
        rows[3, 0] *= 3
    return rows


def piece_of(rows: np.ndarray, balls: SceneBalls) -> Piece:
    bits = DIGIT_BITS * rows.shape[1] - 1
    return Piece(balls, unit_step(bits, Digits(rows)))


@pytest.mark.parametrize("seed", range(40))
def test_all_rows_give_the_integers_of_flint_and_fewer_a_bound(seed):
    rng = Random(seed)
    rows = table(rng)
    balls = rng.choice(WORLDS)
    piece = piece_of(rows, balls)
    # coefficients that do not come as digits are FLINT's alone
    by_flint = Piece(balls, piece.step._replace(rows=tuple(Digits(rows)))).norms

    audit = SumsAudit()
    _, count, _ = rows.shape
    integers = [piece.constants.integers]
    [all_rows] = norms(rows[None], integers, count - 1, audit)
    [fewer_rows] = norms(rows[None], integers, audit=audit)
    audit.check()  # raises if it finds a fault
    for own, exact, bound in zip(by_flint, all_rows, fewer_rows, strict=True):
        assert exact == own
        assert bound >= own


@pytest.mark.parametrize("seed", range(10))
def test_steps_read_together_have_the_norms_and_polynomials_that_each_has_alone(seed):
    rng = Random(seed)
    balls = rng.choice(WORLDS)
    tables = [table(rng) for _ in range(3)]
    # steps of one shape beside each other and apart, and one that does not come as digits
    rows = [Digits(tables[k]) for k in (0, 0, 1, 2, 2, 0)]
    rows[1].table = -tables[0]
    rows.insert(2, tuple(Digits(tables[0])))
    bits = [DIGIT_BITS * len(x.table[0]) - 1 if isinstance(x, Digits) else 400 for x in rows]
    steps = [unit_step(*own) for own in zip(bits, rows, strict=True)]

    together = pieces(balls, steps)
    for piece, step in zip(together, steps, strict=True):
        alone = Piece(balls, step)
        assert piece.p == alone.p
        assert [*map(str, piece.norms)] == [*map(str, alone.norms)]


@pytest.mark.parametrize("seed", range(10))
def test_polynomials_are_those_of_the_same_integers(seed):
    piece = piece_of(table(Random(seed)), WORLDS[0])
    assert polynomials(piece.rows, slice(4)) == [fmpz_poly(row) for row in piece.rows]


@pytest.mark.parametrize("n", [0, 1, -1, 2**195, -(2**196), 12345678901234567890])
def test_digits_of_an_integer_are_that_integer(n):
    assert fmpz_poly(split(9, n)[0, ::-1].tolist())(1 << DIGIT_BITS) == n


@pytest.mark.parametrize("spoil", [2**30, -(2**31), 2**31 - 1])
def test_digits_whose_sums_may_overflow_are_refused(spoil):
    tables = np.full((2, 4, 9, 90), MOST, np.int32)
    constants = np.zeros((2, 5, 9), np.int64)
    check(tables, constants)
    for place in ((0, 0, 0, 0), (1, 3, 8, 89)):
        bad = tables.copy()
        bad[place] = spoil
        with pytest.raises(ArithmeticError, match="overflow"):
            check(bad, constants)
    with pytest.raises(ArithmeticError, match="overflow"):
        check(tables, constants + 2**40)


def test_sums_that_may_reach_two_to_the_62_are_refused_and_none_below():
    tables = np.full((3, 4, 64, 64), 1 << 20, np.int32)
    constants = np.zeros((3, 5, 64), np.int64)
    # 64 * 64 products with a digit of λ and three squares; two derivatives, c, and the 1 of τ
    least = (1 << 62) - (((64**2 << 20) + (1 << DIGIT_BITS)) << DIGIT_BITS)
    tables[1, 3, 5, 7] = least // (64**2 << 20) - (3 << 20)
    with pytest.raises(ArithmeticError, match="overflow"):
        check(tables, constants)
    tables[1, 3, 5, 7] -= 1
    other, largest, another = check(tables, constants)
    assert other == another < largest < least


def test_digits_hand_out_the_integers_that_they_stand_for():
    rows = [[-(2**196), 2**196 - 1, 0, -1, 1, 2**60, -(2**60)], [5] * 7]
    digits = Digits(np.array([split(9, *row).T for row in rows], np.int64))
    assert list(digits) == rows
