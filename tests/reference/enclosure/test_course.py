"""What ties a proof together: nobody who drives it can exchange, leave out or reorder what its parts are given."""

from __future__ import annotations

from fractions import Fraction

import pytest
from enclosure_oracle import PARIS, carry, scene, steps, unit_step
from flint import arb

from reference.enclosure.bound import Piece, Radius, SceneBalls, output, tube
from reference.enclosure.course import Course
from reference.enclosure.enclosed_transits import MOST_LEAVES, Scan
from reference.enclosure.shapes import Covered, Tube

TIMES = [Fraction(0), Fraction(7), Fraction(20)]


def course(proposed, times=TIMES):
    proposed = list(proposed)
    one = Course(SceneBalls(PARIS, proposed[0].bits + 64), times, columns=False, transits=True)
    for step in proposed:
        one.advance(step, (), lambda _: None)
    return one


def test_a_whole_run_gives_its_states_and_transits():
    states, transits = course(steps(PARIS, TIMES[-1])).finish()
    assert len(states) == 3
    assert [t.parity for t in transits] == ["one", "one"]


def test_a_run_that_ends_early_gives_nothing():
    with pytest.raises(ArithmeticError, match="do not end with the run"):
        course(steps(PARIS, Fraction(10))).finish()
    with pytest.raises(ArithmeticError, match="do not end with the run"):  # beyond the end, where no transit is asked
        course(steps(PARIS, Fraction(30))).finish()


def test_a_step_left_out_or_of_another_scene_is_refused():
    rows = list(steps(PARIS, Fraction(20)))
    with pytest.raises(ArithmeticError, match="join"):
        course([rows[0], *rows[2:]])
    bound, other = Radius(SceneBalls(PARIS, 192)), SceneBalls(scene(length="66"), 192)
    with pytest.raises(ArithmeticError, match="one scene"):
        bound.advance(Piece(other, rows[0]))


def test_the_scan_takes_the_steps_of_its_own_scene_in_order():
    first, second, *_ = covered = list(carry(PARIS, steps(PARIS, Fraction(20))))
    scan = Scan(first.piece.balls)
    with pytest.raises(ArithmeticError, match="join"):
        scan.advance(second)
    with pytest.raises(ArithmeticError, match="one scene"):
        Scan(SceneBalls(PARIS, 192)).advance(first)
    assert output(covered[-1], covered[-1].piece.end)


@pytest.mark.parametrize("eta", ["2", "2.4e9", "nan", "inf"])
def test_a_tube_as_wide_as_the_sphere_is_refused(eta):
    piece = Piece(SceneBalls(PARIS, 192), next(steps(PARIS, Fraction(5))))
    with pytest.raises(ArithmeticError):
        tube(piece.k, piece.sizes, arb(eta), arb(0))


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
