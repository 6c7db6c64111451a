"""Transits of a candidate against the truth's: matched, missed, extra, shifted, and undecided ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compare import judge
from compare.score.transit_matching import TransitErrors, judged_transits, transit_errors
from reference import load

TRUTH = np.arange(1, 21) * 8.2
AX = 0.05 * (-1.0) ** np.arange(20)
OMEGA = 0.38
END = 170.0


def against(found, truth=TRUTH, ax=AX, until=END, **more):
    return transit_errors(np.asarray(found, dtype=float), truth, ax / OMEGA, until, **more)


def test_the_truth_matches_itself():
    made = against(TRUTH)
    assert (made.matched, made.missed, made.extra, made.max_error_s) == (20, [], [], 0.0)


def test_errors_are_weighted_by_the_acceleration():
    off = np.linspace(-1e-3, 1e-3, 20)
    made = against(TRUTH + off)
    assert np.allclose(made.errors_s, off, atol=1e-12)
    assert made.max_error_s == pytest.approx(1e-3)
    assert made.max_conditioned_m == pytest.approx(1e-3 * 0.05 / OMEGA)


@pytest.mark.parametrize(
    ("gone", "more"),
    [([7], []), ([], [40.0]), ([], [TRUTH[0] + 1]), ([3], [TRUTH[3] + 4.3])],
    ids=["missed", "extra", "beside the first", "shifted beyond the window"],
)
def test_missed_and_extra_ones_are_named_and_the_others_keep_their_place(gone, more):
    made = against(np.sort([*np.delete(TRUTH, gone), *more]))
    assert (made.missed, made.extra) == (TRUTH[gone].tolist() if gone else [], more)
    assert (made.matched, made.max_error_s) == (20 - len(gone), 0.0)


def test_one_that_is_listed_twice_is_extra_although_xdot_is_zero_there():
    twice = np.sort([*TRUTH, TRUTH[5]])
    made = against(twice, tolerance_m=1e-6, away=np.zeros_like)
    assert (made.extra, made.missed) == ([TRUTH[5]], [])
    made = against(np.sort([*TRUTH, 40.0]), tolerance_m=1e-6, away=np.zeros_like)
    assert made.extra == []


def test_a_shifted_one_is_named_with_its_shift():
    moved = TRUTH.copy()
    moved[3] += 0.5
    made = against(moved)
    assert [round(t, 6) for t, _ in made.shifted(1e-3)] == [TRUTH[3]]
    assert made.shifted(1e-3)[0][1] == pytest.approx(0.5)
    assert made.shifted(0.1) == []


def test_what_the_candidate_did_not_reach_is_not_missed():
    made = against(TRUTH[:5], until=TRUTH[5] - 1)
    assert (made.matched, made.missed, made.extra) == (5, [], [])
    assert made.undecided == []  # neither the fifteen later ones
    assert against(TRUTH[:5], until=TRUTH[5] + 1).missed == [TRUTH[5]]


def test_one_at_the_very_end_may_fall_beyond_it():
    until = TRUTH[5] + 1e-7
    assert against(TRUTH[:5], until=until, tolerance_m=1e-6).missed == []
    assert against(TRUTH[:5], until=until, tolerance_m=1e-9).missed == [TRUTH[5]]


PAIR = np.sort([*TRUTH, 42.0, 42.002])
# between two zeros the velocity reaches 1e-5 * 0.002 / 4 m/s
PAIR_AX = np.insert(AX, 5, [1e-5, -1e-5])


def test_a_close_pair_that_moves_together_is_matched_one_to_one():
    moved = PAIR + 0.005
    made = against(moved, PAIR, PAIR_AX)
    assert (made.matched, made.missed, made.extra) == (22, [], [])
    assert np.allclose(made.errors_s, 0.005)
    assert made.conditioned_m[5] == pytest.approx(0.005 * 1e-5 / OMEGA)


def test_an_ill_conditioned_pair_that_vanishes_is_no_fault():
    made = against(TRUTH, PAIR, PAIR_AX, tolerance_m=1e-6)
    assert (made.missed, made.undecided) == ([], [42.0, 42.002])
    strict = against(TRUTH, PAIR, PAIR_AX, tolerance_m=1e-9)
    assert (strict.missed, strict.undecided) == ([42.0, 42.002], [])


def test_a_pair_that_appears_where_the_truth_nearly_stands_still_is_no_fault():
    found = np.sort([*TRUTH, 42.0, 42.002])
    asked = []

    def distance(times):
        asked.append(times)
        return np.full(len(times), 1e-8 / OMEGA)

    made = against(found, tolerance_m=1e-6, away=distance)
    assert (made.extra, made.undecided) == ([], [42.0, 42.002])
    assert np.array_equal(asked[0], [42.0, 42.002])
    assert against(found, tolerance_m=1e-9, away=distance).extra == [42.0, 42.002]


def test_no_transits_at_all_are_all_missed_or_all_extra():
    assert len(against([]).missed) == 20
    assert against(TRUTH, np.empty(0), np.empty(0)).extra == TRUTH.tolist()
    none = against([], np.empty(0), np.empty(0))
    assert (none.matched, none.missed, none.extra, none.max_error_s, none.max_conditioned_m) == (
        0,
        [],
        [],
        0.0,
        0.0,
    )


@given(st.lists(st.floats(0, 170), max_size=30, unique=True))
def test_every_transit_is_matched_missed_or_extra_exactly_once(found):
    made = against(sorted(found))
    assert made.matched + len(made.missed) + len(made.undecided) == len(TRUTH)
    assert made.matched + len(made.extra) == len(found)
    assert (np.diff(made.at + made.errors_s) > 0).all()  # in order


def test_a_transit_matches_within_half_a_swing_and_not_beyond():
    one, slope = np.array([8.0]), np.array([0.05])
    assert against([12.0], one, slope).matched == 1  # a single one: a swing is the time to it
    assert against([12.1], one, slope).matched == 0
    assert against([4.0], one, slope).matched == 1
    found = against([*TRUTH[:-1], 150.0, TRUTH[-1] + 4.05])
    assert (found.matched, found.extra) == (20, [150.0])


def test_half_a_swing_to_the_last_bit_is_within_it():
    swing, three = np.array([8.0]), np.array([8.0, 9.0, 17.0])  # in both half of it is 4 s
    assert against([12.0, 100.0], swing, np.ones(1)).matched == 1
    assert against([12.0, 13.0], three, np.ones(3)).at.tolist() == [8.0, 9.0]
    assert against([12.0], three, np.ones(3)).at.tolist() == [8.0]  # in order, and once


def test_what_is_off_by_the_tolerance_to_the_last_bit_is_within_it():
    one = np.array([0.5])
    assert TransitErrors(one, one, [], [], one).shifted(0.5) == []
    # between the pair the bob is off by 4 m/s * 0.5 s / 4
    truth = np.array([8.0, 16.0, 16.5, 24.0])
    pair = transit_errors(truth[[0, 3]], truth, np.full(4, 4.0), 30.0, tolerance_m=0.5)
    assert pair.undecided == [16.0, 16.5]


def test_one_at_the_very_end_of_the_candidate_is_undecided():
    made = against(TRUTH[:5], until=TRUTH[5])
    assert (made.missed, made.undecided) == ([], [TRUTH[5]])


@pytest.mark.parametrize(("part", "excused"), [(0.99, False), (1.01, True)])
def test_a_motion_within_the_tolerance_and_no_more_excuses(part, excused):
    depth = 1e-5 * 0.002 / 4 / OMEGA  # of the parabola between the two zeros
    pair = against(TRUTH, PAIR, PAIR_AX, tolerance_m=part * depth)
    assert pair.undecided == ([42.0, 42.002] if excused else [])
    one = against(
        np.sort([*TRUTH, 42.0]), tolerance_m=part * 1e-8, away=lambda t: np.full(len(t), -1e-8)
    )
    assert one.undecided == ([42.0] if excused else [])
    end = against(TRUTH[:5], until=TRUTH[5] + 1e-6, tolerance_m=part * 1e-6 * 0.05 / OMEGA)
    assert end.undecided == ([TRUTH[5]] if excused else [])


def test_a_pair_is_excused_and_not_its_neighbours():
    found = np.delete(PAIR, [2, 5, 6, 9])
    made = against(found, PAIR, PAIR_AX, tolerance_m=1e-6)
    assert (made.missed, made.undecided) == ([PAIR[2], PAIR[9]], [42.0, 42.002])
    three = against(np.delete(PAIR, [5, 6, 7]), PAIR, PAIR_AX, tolerance_m=1e-6)
    assert (three.missed, three.undecided) == ([PAIR[7]], [42.0, 42.002])


@pytest.mark.parametrize(("count", "excused"), [(0, 0), (1000, 1000), (1001, 0)])
def test_too_many_extra_ones_are_no_grazing_zeros(count, excused):
    asked = []

    def distance(times):
        asked.append(len(times))
        return np.zeros(len(times))

    made = against(np.sort([*TRUTH, *np.linspace(40.0, 40.5, count)]), away=distance)
    assert (len(made.undecided), len(made.extra)) == (excused, count - excused)
    assert asked == ([count] if excused else [])


def test_without_any_swing_a_time_has_no_weight():
    """And no extra transit is excused, as no velocity is a distance."""
    golden = load("force_free")
    times = golden.transits["t"]
    score = judge({"t": golden.t, "x": golden.x, "y": golden.y}, golden.scene, explain=False)
    still = replace(score.errors, speed_m_s=0.0)
    made = judged_transits(times + 0.1, golden, still, 1.0)
    assert (made.max_conditioned_m, made.max_error_s) == (0.0, pytest.approx(0.1))
    doubled = judged_transits(np.append(times, times[-1] + 1e-9), golden, still, 1.0)
    assert (doubled.extra, doubled.undecided) == ([times[-1] + 1e-9], [])
