"""Error measures: against candidates whose errors are known because they were put there."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from small_scenes import make_scene

from compare.candidates.arrays import candidate_of
from compare.candidates.candidate import COLUMNS, Candidate
from compare.score.errors import drifts, swing_rate, trajectory_errors
from reference import load, load_scene, trajectory
from reference.dataset.golden import Dense, dense
from reference.numbers.precision import LONG_DOUBLE
from reference.solver.solve import solve_at

TIMES = np.linspace(0.0, 3600.0, 721)


@pytest.fixture(scope="module")
def golden():
    return load("paris")


@pytest.fixture(scope="module")
def truth(golden):
    return dense(golden, TIMES)


def candidate(truth, columns=COLUMNS, **changes):
    """The truth with errors added to some columns."""
    found = {
        name: truth.states[:, COLUMNS.index(name)] + changes.get(name, 0.0) for name in columns
    }
    return Candidate.of("made", truth.t, found)


def test_an_error_that_was_put_in_is_measured(golden, truth):
    wave = 1e-3 * np.sin(TIMES)
    made = trajectory_errors(candidate(truth, x=wave, y=2e-3, z=-2e-3), truth, golden)
    assert made.max_m == pytest.approx(math.sqrt(8e-6 + np.max(wave**2)), rel=1e-9)
    assert made.rms_m == pytest.approx(math.sqrt(8e-6 + np.mean(wave**2)), rel=1e-9)
    assert made.end_m == pytest.approx(math.sqrt(8e-6 + wave[-1] ** 2), rel=1e-9)
    assert np.abs(made.components["x"] - wave).max() < 1e-15
    assert made.worst[0] == int(np.argmax(np.abs(wave)))
    assert replace(made, position=np.zeros_like(TIMES)).rms_m == 0


def test_the_worst_component_of_the_worst_row_is_named(golden, truth):
    error = np.zeros_like(TIMES)
    error[100] = -1.0
    made = trajectory_errors(candidate(truth, ("x", "y", "vx"), y=error, vx=100.0), truth, golden)
    assert made.worst == (100, "y")
    assert made.max_m == pytest.approx(1.0)  # velocities are no part of it


def test_digits_count_the_amplitude_and_stop_at_the_bound(golden, truth):
    made = trajectory_errors(candidate(truth, x=1e-6), truth, golden)
    assert made.amplitude_m == np.hypot(golden.x, golden.y).max()
    assert made.digits == pytest.approx(-math.log10(1e-6 / made.amplitude_m), abs=1e-6)
    exact = trajectory_errors(candidate(truth, ("x", "y")), truth, golden)
    assert exact.digits <= -math.log10(truth.bound_m / exact.amplitude_m)


def test_scd_and_mescd_are_those_of_the_test_set_for_ivp_solvers(golden, truth):
    made = trajectory_errors(candidate(truth, x=1e-6, vy=-1e-8), truth, golden)
    end = np.abs(truth.states[-1])
    assert made.scd == pytest.approx(-math.log10(max(1e-6 / end[0], 1e-8 / end[4])), abs=1e-6)
    mixed = max(1e-6 / (made.amplitude_m + end[0]), 1e-8 / (made.speed_m_s + end[4]))
    assert made.mescd == pytest.approx(-math.log10(mixed), abs=1e-6)


def test_a_component_whose_truth_is_zero_has_no_relative_error(golden):
    truth = dense(golden, [0.0])
    made = trajectory_errors(candidate(truth, x=3e-4, vx=1.0), truth, golden)
    assert made.scd == pytest.approx(3.0)  # vx = 0 at the release is left out
    assert made.mescd == pytest.approx(-math.log10(1 / made.speed_m_s), abs=1e-6)


@pytest.mark.parametrize("power", [1.0, 2.0, 3.5])
def test_the_growth_of_an_error_is_its_power_of_time(golden, truth, power):
    made = trajectory_errors(
        candidate(truth, ("x", "y"), x=1e-8 * (TIMES / 60) ** power), truth, golden
    )
    assert made.growth_exponent == pytest.approx(power, abs=0.1)


def test_growth_is_fitted_to_the_largest_errors_so_far_at_forty_times(golden, truth):
    """Only in the last row the error is a hundred times as large."""
    t, late = np.geomspace(1.0, 1000.0, 3901), np.append(np.ones(3900), 100.0)
    made = replace(trajectory_errors(candidate(truth), truth, golden), t=t, position=late)
    expected = np.polyfit(np.linspace(0.0, np.log(1000.0), 40), np.log([1.0] * 39 + [100.0]), 1)[0]
    assert made.growth_exponent == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("times", "found"),
    [([1, 2, 3, 4], True), ([1, 2, 3, 3.9], False), ([0, 1, 2, 4], False), ([0], False)],
)
def test_growth_needs_four_rows_after_the_release_and_four_times_the_first(golden, times, found):
    truth = dense(golden, [float(t) for t in times])
    made = trajectory_errors(candidate(truth, x=1.0), truth, golden)
    assert (made.growth_exponent is not None) is found


def test_errors_that_are_the_bound_of_the_truth_have_no_growth(golden, truth):
    made = trajectory_errors(candidate(truth), truth, golden)
    for position, grows in ((made.bound_m, False), (2 * made.bound_m, True)):
        found = replace(made, position=np.full(len(TIMES), position)).growth_exponent
        assert (found is not None) is grows


def test_a_component_is_relative_if_its_truth_is_known_and_an_error_is_at_least_the_bound(
    golden, truth
):
    end, speed = truth.states.copy(), trajectory_errors(candidate(truth), truth, golden)
    bound = 1e-6
    known = [*[bound] * 3, *[bound * speed.speed_m_s / speed.amplitude_m] * 3]
    end[-1] = [1e-5, bound, 0.0, 2 * known[3], 0.5 * known[4], 0.0]
    made = replace(speed, truth=replace(truth, states=end), bound_m=bound)
    assert made.scd == pytest.approx(-math.log10(0.5))  # vx: its known part over twice that
    assert made.mescd == pytest.approx(
        -math.log10(max(bound / (speed.amplitude_m + 0), known[4] / speed.speed_m_s))
    )
    still = replace(made, truth=replace(truth, states=np.zeros_like(end)))
    assert still.scd is None


def test_the_scales_are_the_largest_distance_and_speed_of_golden_and_truth_together(golden, truth):
    made = trajectory_errors(candidate(truth), truth, golden)
    velocities = np.column_stack([golden.vx, golden.vy, golden.vz]), truth.states[:, 3:]
    speeds = [np.linalg.norm(rows, axis=1).max() for rows in velocities]
    assert made.speed_m_s == pytest.approx(max(speeds), rel=1e-12)
    assert made.amplitude_m == pytest.approx(np.hypot(golden.x, golden.y).max(), rel=1e-12)
    wider = replace(truth, states=truth.states * 2)
    made = trajectory_errors(candidate(wider), wider, golden)
    assert made.amplitude_m == pytest.approx(
        2 * np.hypot(truth.states[:, 0], truth.states[:, 1]).max(), rel=1e-12
    )
    assert made.speed_m_s == pytest.approx(2 * speeds[1], rel=1e-12)


def test_the_amplitude_does_not_hang_on_where_the_rows_fall(golden):
    """One row near the middle of a swing, where the bob is close to the vertical."""
    t = float(golden.t[np.argmin(np.hypot(golden.x[1:200], golden.y[1:200])) + 1])
    truth = dense(golden, [t])
    made = trajectory_errors(candidate(truth, ("x", "y")), truth, golden)
    assert np.hypot(*truth.states[0, :2]) < 0.5 * made.amplitude_m
    assert made.amplitude_m > 0.49


def test_long_doubles_are_judged_with_all_their_digits(golden, truth):
    wide = truth.states.astype(np.longdouble) + truth.low.astype(np.longdouble)
    arrays = {"t": TIMES, "x": wide[:, 0] + np.longdouble("1e-18"), "y": wide[:, 1]}
    made = trajectory_errors(candidate_of("wide", arrays), truth, golden)
    assert made.max_m == pytest.approx(1e-18, rel=0.1)


def test_low_parts_count_where_doubles_agree(golden, truth):
    plain, wave = replace(truth, low=np.zeros_like(truth.low)), 1e-25 * np.arange(1, len(TIMES) + 1)
    columns = dict(zip("xyz", truth.states[:, :3].T.copy(), strict=True))
    finer = Candidate.of("finer", TIMES, columns, low=dict.fromkeys("xyz", wave))
    made = trajectory_errors(finer, plain, golden)
    assert all(np.array_equal(made.components[name], wave) for name in "xyz")
    assert made.position == pytest.approx(wave * np.sqrt(3), rel=1e-12)
    off = trajectory_errors(
        replace(finer, columns={**columns, "x": columns["x"] + 1e-3}), plain, golden
    )
    assert off.components["x"] == pytest.approx(1e-3, rel=1e-11)


def test_a_time_that_is_no_double_is_taken_as_it_is(golden):
    """Long doubles at tenths of a second: the doubles next to them are up to 1.8e-12 s off after some hours."""
    times = np.arange(199980, 200000, dtype=np.longdouble) / np.longdouble(10)
    near = times.astype(float)
    truth = dense(golden, near, 2.0**-80)
    late = (times - near).astype(float)
    around = dense(golden, np.ravel(near[:, None] + [-1e-3, 1e-3])).states
    rates = np.hstack([truth.states[:, 3:], (around[1::2] - around[::2])[:, 3:] / 2e-3])
    wide = truth.states.astype(np.longdouble) + truth.low + rates * late[:, None]
    columns = dict(zip(COLUMNS, wide.T, strict=True))
    made = trajectory_errors(candidate_of("wide", {"t": times, **columns}), truth, golden)
    assert np.abs(late).max() > 1e-12
    assert max(np.abs(made.components[name]).max() for name in ("x", "y", "vx", "vy")) < 1e-18
    # 67 m in a long double
    assert max(np.abs(made.components[name]).max() for name in ("z", "vz")) < 1e-17
    blind = trajectory_errors(
        candidate_of("wide", {"t": near, "x": wide[:, 0], "y": wide[:, 1]}), truth, golden
    )
    assert blind.max_m > 1e-14


def test_the_bound_holds_at_times_that_are_no_doubles():
    """Rows at tenths of a second, right to 34 digits, of a short cord: the bob moves on as t and not as its double."""
    scene = make_scene(
        pendulum={"length": "0.01"}, release={"x": "0.003", "y": "0.004"}, run={"t_end": "60"}
    )
    times = [Fraction(i, 10) for i in range(581, 600)]
    near = np.array([float(t) for t in times])
    solution = solve_at(scene, {*times, *map(Fraction, near.tolist())}, 34)
    row = {t: i for i, t in enumerate(solution.times)}
    truth = Dense.of(near, solution.grid, [row[Fraction(t)] for t in near.tolist()])
    right = Dense.of(near, solution.grid, [row[t] for t in times])
    lows = dict(zip(COLUMNS, right.low.T, strict=True)) | {
        "t": np.array([float(t - Fraction(float(t))) for t in times])
    }
    made = Candidate.of("right", near, dict(zip(COLUMNS, right.states.T, strict=True)), low=lows)
    errors = trajectory_errors(made, truth, solution)
    assert 10 * truth.bound_m < errors.max_m < errors.bound_m < 10 * errors.max_m


def test_a_turn_of_the_swing_plane_is_told_where_there_are_positions(golden, truth):
    x, y = truth.states[:, 0], truth.states[:, 1]
    dx, dy = (np.cos(0.1) - 1) * x - np.sin(0.1) * y, np.sin(0.1) * x + (np.cos(0.1) - 1) * y
    made = trajectory_errors(candidate(truth, x=dx, y=dy), truth, golden)
    assert made.swing((0.0, 0.0)).largest_turn == pytest.approx(0.1, rel=1e-6)
    later = replace(truth, t=TIMES[1:], states=truth.states[1:], low=truth.low[1:])
    alone = trajectory_errors(Candidate.of_transits("transits", TIMES), later, golden)
    assert alone.swing((0.0, 0.0)).largest_turn is None
    rate = swing_rate(golden.scene, alone.speed_m_s)
    assert alone.position == pytest.approx(np.abs(alone.truth.states[:, 3]) / rate)


def test_drifts_of_a_good_run_are_rounding_and_of_a_bad_one_what_was_put_in():
    scene = make_scene(pendulum={"length": "2"}, site={"latitude": "30"})
    states = trajectory(scene, np.linspace(0, 60, 100), number=LONG_DOUBLE)
    good = Candidate.of(
        "good", np.linspace(0, 60, 100), {name: states[:, i] for i, name in enumerate(COLUMNS)}
    )
    small = drifts(good, scene)
    assert small["length_m"] < 1e-15
    assert small["h_m2_s2"] < 1e-14
    longer = replace(good, columns={**good.columns, "z": good.columns["z"] - 1e-3})
    found = drifts(longer, scene)
    assert found["length_m"] == pytest.approx(1e-3, rel=0.05)
    faster = states[:, 3:] * np.linspace(1, 1.1, 100)[:, None]
    found = drifts(
        replace(good, columns={**good.columns, "vx": faster[:, 0], "vy": faster[:, 1]}), scene
    )
    kinetic = 0.5 * ((faster[:, :2] ** 2).sum(axis=1) - (states[:, 3:5] ** 2).sum(axis=1))
    assert found["h_m2_s2"] == pytest.approx(np.abs(kinetic).max(), rel=1e-6)


def test_drifts_need_the_columns_and_no_drag():
    scene = make_scene(pendulum={"drag": "0.1"})
    rows = {name: np.ones(2) for name in COLUMNS}
    assert (
        drifts(Candidate.of("a", np.array([0.0, 1.0]), {"x": rows["x"], "y": rows["y"]}), scene)
        == {}
    )
    assert set(drifts(Candidate.of("a", np.array([0.0, 1.0]), rows), scene)) == {"length_m"}


def test_an_error_of_vx_becomes_one_of_position_at_the_rate_of_a_swing_or_of_a_faster_bob():
    scene = load_scene("paris")
    # less the centrifugal force
    assert swing_rate(scene, 0.0) == pytest.approx(math.sqrt(9.80665 / 67), rel=5e-3)
    assert swing_rate(scene, 67.0) == pytest.approx(1.0)
