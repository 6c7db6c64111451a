"""What ties a proof together: nobody who drives it can exchange, leave out or reorder what its parts are given."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from itertools import islice

import numpy as np
import pytest
from enclosure_oracle import PARIS, FailingStep, carry, in_digits, scene, steps, unit_step
from flint import arb

from reference.enclosure.trusted.course import Course, scan_of
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.radius import Radius
from reference.enclosure.trusted.shapes import Covered, Tube
from reference.enclosure.trusted.system import SceneBalls
from reference.enclosure.trusted.tube import output, tube
from reference.enclosure.trusted.zeros import MOST_LEAVES, Scan
from reference.numbers.taylor_step import Digits

TIMES = [Fraction(0), Fraction(7), Fraction(20)]
WORDS = ("xdot", "highest")


def course(proposed, times=TIMES):
    proposed = list(proposed)
    one = Course(SceneBalls(PARIS, proposed[0].bits + 64), times, columns=False, words=WORDS)
    for step in proposed:
        one.advance(step)
    return one


def test_a_whole_run_gives_its_states_and_zeros():
    proved = course(steps(PARIS, TIMES[-1])).finish()
    assert (proved.inputs, proved.times, len(proved.states)) == (PARIS, tuple(TIMES), 3)
    assert [*proved.zeros] == [*WORDS]
    transits, highest = proved.zeros.values()
    assert [z.parity for z in transits] == ["one", "one"]
    assert {z.parity for z in highest} == {"one"}
    assert all(z.ax is not None and z.vx is z.vz is None for z in transits)
    assert all(None not in (z.vx, z.vz) and z.ax is None for z in highest)


def test_a_run_that_ends_early_gives_nothing():
    with pytest.raises(ArithmeticError, match="do not end with the run"):
        course(steps(PARIS, Fraction(10))).finish()
    # beyond the end, where no zero is asked
    with pytest.raises(ArithmeticError, match="do not end with the run"):
        course(steps(PARIS, Fraction(30))).finish()


def test_a_step_left_out_or_of_another_scene_is_refused():
    rows = list(steps(PARIS, Fraction(20)))
    with pytest.raises(ArithmeticError, match="join"):
        course([rows[0], *rows[2:]])
    bound, other = Radius(SceneBalls(PARIS, 192)), SceneBalls(scene(length="66"), 192)
    with pytest.raises(ArithmeticError, match="one scene"):
        bound.advance(Piece(other, rows[0]))


@pytest.mark.parametrize("word", WORDS)
def test_a_scan_takes_the_steps_of_its_own_scene_in_order(word):
    first, second, *_ = covered = list(carry(PARIS, steps(PARIS, Fraction(20))))
    scan = scan_of(first.piece.balls, word, second_order=False)
    with pytest.raises(ArithmeticError, match="join"):
        scan.advance(second)
    with pytest.raises(ArithmeticError, match="one scene"):
        scan_of(SceneBalls(PARIS, 192), word, second_order=False).advance(first)
    assert output(covered[-1], covered[-1].piece.end)


@pytest.mark.parametrize("eta", ["2", "2.4e9", "nan", "inf"])
def test_a_tube_as_wide_as_the_sphere_is_refused(eta):
    piece = Piece(SceneBalls(PARIS, 192), next(steps(PARIS, Fraction(5))))
    with pytest.raises(ArithmeticError):
        tube(piece.constants, piece.sizes, arb(eta), arb(0))


@pytest.mark.parametrize("widths", [("1.9", "1e3", "1e12"), ("1.9", "1.9e9", "1.6e18")])
def test_leaves_that_a_useless_tube_would_ask_for_are_one_possible_transit(widths):
    """Seed 5007 of the audit: |xddot| is known a billion times less closely than xdot."""
    balls = SceneBalls(scene(vx="1"), 264)
    row = [0, 1 << 230, 1 << 214]
    step = unit_step(200, (row, *[[0]] * 3))
    scan = Scan(balls)
    scan.advance(Covered(Piece(balls, step), Tube(*map(arb, widths))))
    assert scan.leaves < MOST_LEAVES * 3
    found = scan.finish()
    assert all(t.kind == "possible" for t in found)


def test_a_closed_run_takes_no_further_step():
    first, second, third = islice(steps(PARIS, Fraction(20)), 3)
    one = Course(SceneBalls(PARIS, 192), TIMES, columns=False, words=())
    one.advance(first)
    with pytest.raises(ArithmeticError, match="join"):
        one.advance(third)
    with pytest.raises(ArithmeticError, match="closed"):
        one.advance(second)


def test_steps_that_are_read_together_are_proved_as_one_after_another():
    proposed = [in_digits(step) for step in steps(PARIS, TIMES[-1])]
    one = Course(SceneBalls(PARIS, proposed[0].bits + 64), TIMES, columns=False, words=WORDS)
    for k in range(0, len(proposed), 3):
        one.read(proposed[k : k + 3])
        for _ in proposed[k : k + 3]:
            one.take()
    proved = one.finish()
    alone = course(proposed).finish()
    assert (proved.states, proved.zeros) == (alone.states, alone.zeros)


def test_a_step_that_cannot_be_read_closes_the_run_with_those_before_it():
    first, second, *_ = proposed = list(steps(PARIS, TIMES[-1]))
    one = Course(SceneBalls(PARIS, 192), TIMES, columns=False, words=())
    with pytest.raises(ArithmeticError, match="must lie in"):
        one.read([first, second._replace(low=second.high)])
    with pytest.raises(ArithmeticError, match="closed"):
        one.take()
    with pytest.raises(ArithmeticError, match="closed"):
        one.read(proposed)


def test_a_step_that_was_not_read_is_not_taken():
    one = Course(SceneBalls(PARIS, 192), TIMES, columns=False, words=())
    with pytest.raises(ArithmeticError, match="no step was read"):
        one.take()


def swallowed(proposed, times, words, inputs=PARIS):
    """Drive a run on through every exception; return what it says at the end."""
    one = Course(SceneBalls(inputs, 400), times, False, words)
    for step in proposed:
        with suppress(ArithmeticError, RuntimeError):
            one.advance(step)
    return one.finish()


SHORT_ROD = scene(length="1", x="0.05", y="0.1")


def test_an_exception_in_a_step_closes_the_run_for_good():
    """F1 of the audit: the zeros of a step were lost when something between the bound and the scan raised."""
    *proposed, last = steps(SHORT_ROD, Fraction("5.04"), bits=160)
    times = [Fraction(0), Fraction("5.04")]
    whole = FailingStep(last, 10**6)
    found = swallowed([*proposed, whole], times, WORDS, SHORT_ROD).zeros
    assert [len(found[word]) for word in WORDS] == [5, 5]
    for readings in range(10**6 - whole.readings):
        with pytest.raises(ArithmeticError, match="do not end with the run"):
            swallowed([*proposed, FailingStep(last, readings)], times, WORDS, SHORT_ROD)


def bumped(step, size=1 << 8):
    """The step with a bump in w that vanishes, as does its slope, at both ends: only the defect sees it."""
    c, rows = [Fraction(size << step.bits)], [[*map(int, row)] for row in step.coefficients]
    for root in (step.low, step.low, step.high, step.high):
        c = [a - root * b for a, b in zip([0, *c], [*c, 0], strict=True)]
    rows[2][:5] = [a + int(b) for a, b in zip(rows[2], c, strict=False)]
    return step._replace(rows=rows)


def test_a_step_whose_bound_is_not_finite_is_not_passed_over():
    """F1: the time went on and the radius did not, so the states of another motion could be proved."""
    proposed = list(steps(SHORT_ROD, Fraction("5.04"), bits=160))
    k = len(proposed) // 2
    with pytest.raises(ArithmeticError, match="do not end with the run"):
        chain = [*proposed[:k], bumped(proposed[k]), *proposed[k + 1 :]]
        swallowed(chain, [Fraction(0), Fraction("5.04")], (), SHORT_ROD)


@pytest.mark.parametrize("word", WORDS)
def test_a_run_whose_scan_did_not_come_to_the_end_gives_nothing(word):
    one = course(steps(PARIS, TIMES[-1]))
    scan = one.scans[word]
    one.scans[word] = scan_of(one.balls, word, second_order=False)  # which was given no step
    with pytest.raises(ArithmeticError, match="do not end with the run"):
        one.finish()
    one.scans[word] = scan
    assert one.finish().zeros[word]


@pytest.mark.parametrize("word", WORDS)
def test_a_tube_that_does_not_come_from_the_course_ends_the_run(word):
    """As one that is narrower than what was proved, which would hide a zero."""
    proposed = list(steps(PARIS, TIMES[-1]))
    covered = list(carry(PARIS, proposed))
    for k in (0, len(proposed) // 2, len(proposed) - 1):
        one = Course(SceneBalls(PARIS, proposed[0].bits + 64), TIMES, columns=False, words=WORDS)
        for step in proposed[:k]:
            one.advance(step)
        narrow = Covered(Piece(one.balls, proposed[k]), covered[k].tube)
        one.scans[word].advance(narrow)
        with pytest.raises(ArithmeticError, match="join"):
            one.advance(proposed[k])
        with pytest.raises(ArithmeticError, match="do not end with the run"):
            one.finish()


class Changing(Digits):
    """Digits whose table is another at a later reading."""

    def __init__(self, first, later, readings):
        self.tables = [first] * readings

        self.later = later

    @property
    def table(self):
        return self.tables.pop() if self.tables else self.later


@pytest.mark.parametrize("readings", range(1, 6))
def test_the_defect_is_that_of_the_polynomials_whatever_becomes_of_the_digits(readings):
    """F2: p was made of one table, the defect of another."""
    honest = in_digits(next(steps(PARIS, Fraction(5))))
    table = honest.rows.table
    moved = table.copy()
    moved[0, 3, :3] += 1
    balls = SceneBalls(PARIS, 192)
    piece = Piece(balls, honest._replace(rows=Changing(moved, table, readings)))
    own = Piece(balls, honest._replace(rows=Digits(piece.rows.table.copy())))
    assert piece.p == own.p
    assert [*map(str, piece.sizes)] == [*map(str, own.sizes)]
    with pytest.raises(ValueError, match="read-only"):
        piece.rows.table[0, 0, 0] = 1


def test_digits_over_another_power_of_two_are_refused():
    """F3: sums over 2^(22 L - 1) were taken for those of digits over 2^(22 L - 2)."""
    rows, balls = np.zeros((4, 8, 3), np.int32), SceneBalls(PARIS, 400)
    Piece(balls, unit_step(22 * 8 - 1, Digits(rows)))
    for bits in (22 * 8 - 2, 22 * 8):
        with pytest.raises(ArithmeticError, match="22 bits"):
            Piece(balls, unit_step(bits, Digits(rows)))
