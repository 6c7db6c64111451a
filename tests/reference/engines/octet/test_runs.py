"""Rows solved by the kernel: against limbs at 110 bits, and bit for bit the same in any company."""

from __future__ import annotations

from dataclasses import fields, replace
from fractions import Fraction

import numpy as np
import pytest

pytest.importorskip("numba")

from against_limbs import compare
from random_rows import KINDS, random_kinds, rows_of

from reference.engines.batch_interface import DOUBTFUL, OK, STOPPED, Outcomes, Rows, RunOptions
from reference.engines.octet.batch import BATCH
from reference.scenes.scene import load_scene

SPAN = Fraction(100)
LISTS = ("transit_row", "transit_t", "transit_direction")


@pytest.mark.parametrize("kind", KINDS)
def test_transits_and_states_are_those_of_limbs(kind, tally):
    found = compare(BATCH, list(random_kinds(f"test {kind}", 12, SPAN, (kind,))))
    tally(f"octet against limbs, {kind}: {found}")
    assert not found.miscounted and not found.underestimated
    assert found.doubtful == 0
    assert found.worst_time < 2e-12 or kind == "over"


def test_a_row_is_bit_for_bit_the_same_alone_and_in_company():
    many = list(random_kinds(3, 25, Fraction(60)))
    rows, options = rows_of(many), RunOptions(times=True)
    together, backwards = BATCH.solve(rows, options), BATCH.solve(rows[::-1], options)
    for i in range(len(many)):
        alone = BATCH.solve(rows[[i]], options)
        for whole, at in ((together, i), (backwards, len(many) - 1 - i)):
            for field in fields(Outcomes):
                if field.name not in LISTS:
                    own, one = getattr(whole, field.name)[at], getattr(alone, field.name)[0]
                    assert np.array_equal(own, one, equal_nan=True), (i, field.name)
            chosen = whole.transit_row == at
            assert np.array_equal(whole.transit_t[chosen], alone.transit_t)
            assert np.array_equal(whole.transit_direction[chosen], alone.transit_direction)


def test_what_is_wanted_does_not_change_what_comes_out():
    rows = rows_of(list(random_kinds(4, 10, Fraction(60))))
    whole = BATCH.solve(rows, RunOptions(times=True))
    for options in (
        RunOptions(apsides=False),
        RunOptions(transits=False),
        RunOptions(transits=False, apsides=False),
    ):
        other = BATCH.solve(rows, options)
        assert np.array_equal(whole.state, other.state)
        assert np.array_equal(
            whole.transits if options.transits else 0 * whole.transits, other.transits
        )
        assert np.array_equal(
            whole.apsides if options.apsides else 0 * whole.apsides, other.apsides
        )


def test_arrays_that_lie_apart_in_memory_give_the_same_numbers():
    rows = rows_of(list(random_kinds(5, 6, Fraction(20))))
    whole = BATCH.solve(rows, RunOptions())
    apart = Rows(
        *(np.asfortranarray(np.repeat(getattr(rows, f.name), 2, axis=0))[::2] for f in fields(Rows))
    )
    assert not apart.n.flags.c_contiguous
    assert np.array_equal(BATCH.solve(apart, RunOptions()).state, whole.state)


def test_highest_points_are_counted_once(paris):
    # between the transits of a swing that is far from north-south there is one highest point each
    many = [
        replace(paris.exact, latitude=Fraction(lat), t_end=Fraction(500))
        for lat in (-60, 0, 30, 90)
    ]
    run = BATCH.solve(rows_of(many), RunOptions(times=True))
    swings = 500 / (2 * np.pi * np.sqrt(67 / 9.81))
    assert (np.abs(run.apsides - 2 * swings) < 1.0).all()
    assert (np.abs(run.apsides - run.transits) <= 1).all()
    assert np.allclose(
        (run.apsis_last - run.apsis_first) / (run.apsides - 1), 0.5 * 500 / swings, rtol=2e-3
    )


def test_highest_points_on_the_side_of_the_one_before_are_those_of_a_bob_that_goes_over_the_top():
    inputs = [
        load_scene(name, ["run.t_end=20"]).exact
        for name in ("over_top", "barely_over", "hard", "paris")
    ]
    run = BATCH.solve(rows_of(inputs), RunOptions())
    assert run.same_side.tolist() == [run.apsides[0] - 1, run.apsides[1] - 1, 0, 0]
    assert (run.apsides > 1).all()


def test_a_plane_that_turns_by_many_half_turns_is_followed(paris):
    # 0.01 rad/s at a pole, no force from it: Ω t exactly, but for the ellipse
    fast = replace(
        paris.exact, latitude=Fraction(90), rotation_rate=Fraction(1, 100), t_end=Fraction(3000)
    )
    fast = replace(fast, position=(Fraction(1, 10), Fraction(0), Fraction(0), Fraction(1, 1000)))
    run = BATCH.solve(rows_of([fast]), RunOptions())
    assert abs(run.turn[0] / (run.apsis_last[0] - run.apsis_first[0]) + 0.01) < 1e-5
    assert abs(run.turn[0]) > 9 * np.pi


def test_conical_orbits_have_no_highest_points(paris):
    rate = Fraction(np.degrees(np.sqrt(9.80665 / 67 / np.cos(np.pi / 6))))
    cone = replace(
        paris.exact,
        latitude=Fraction(90),
        rotation_rate=Fraction(0),
        position=None,
        angles=(Fraction(30), Fraction(0), Fraction(0), rate),
        t_end=Fraction(200),
    )
    run = BATCH.solve(rows_of([cone]), RunOptions())
    assert run.fate[0] == OK
    assert run.apsides[0] == 0 and np.isnan(run.turn[0])
    assert abs(run.largest_angle[0] - np.pi / 6) < 1e-12


def test_rows_that_fail_do_not_disturb_the_others(paris):
    rows = rows_of([replace(paris.exact, t_end=Fraction(100))] * 12)
    alone = BATCH.solve(rows[:1], RunOptions())
    rows.n[3] = np.nan
    run = BATCH.solve(rows, RunOptions())
    assert run.fate.tolist() == [OK] * 3 + [STOPPED] + [OK] * 8
    assert np.isnan(run.state[3]).all()
    assert (np.delete(run.state, 3, axis=0) == alone.state[0]).all()


def test_a_transit_that_rounding_hides_is_in_doubt(paris):
    # all but in the meridian, at the equator: x is nothing but rounding
    hidden = replace(
        paris.exact,
        latitude=Fraction(0),
        position=(Fraction(1, 10**40), Fraction(1), Fraction(1, 10**45), Fraction(0)),
    )
    run = BATCH.solve(rows_of([replace(hidden, t_end=Fraction(100))]), RunOptions())
    assert run.fate[0] == DOUBTFUL


def test_no_rows_and_still_rows(paris):
    assert len(BATCH.solve(rows_of([paris.exact])[:0], RunOptions()).state) == 0
    still = replace(
        paris.exact, latitude=Fraction(90), position=(Fraction(0),) * 4, t_end=Fraction(100)
    )
    run = BATCH.solve(rows_of([still]), RunOptions(times=True))
    assert run.fate[0] == OK and run.transits[0] == 0 and np.isnan(run.t_first[0])
    assert np.abs(run.state[0, [0, 1, 3, 4, 5]]).max() == 0


def test_a_still_row_finds_nothing_in_a_lane_that_has_just_found_a_transit(paris):
    # the rows before end on a transit and leave their lanes to rows in which none is looked for
    moving = replace(paris.exact, latitude=Fraction(40), t_end=Fraction(200))
    t = BATCH.solve(rows_of([moving]), RunOptions()).t_last[0]
    moving = replace(moving, t_end=Fraction(t) + Fraction(1, 100))
    still = replace(
        paris.exact, latitude=Fraction(90), position=(Fraction(0),) * 4, t_end=Fraction(100)
    )
    run = BATCH.solve(rows_of([moving] * 8 + [still] * 8), RunOptions(times=True))
    assert (run.transits[:8] == run.transits[0]).all() and run.transits[0] > 0
    assert (run.transits[8:] == 0).all() and (run.transit_row < 8).all()
    assert (run.fate == OK).all()


def test_drag_is_not_for_this_kernel(paris):
    assert not BATCH.drag
    with pytest.raises(ValueError, match="drag"):
        BATCH.solve(rows_of([replace(paris.exact, drag=Fraction(1, 10))]), RunOptions())
