"""Dense output at and between golden rows, against runs on other grids; the bounds hold."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from small_scenes import make_scene

from reference import InputError, load, solve
from reference.dataset.golden import dense
from reference.dataset.write import write
from reference.numbers.columns import STATE


@pytest.fixture(scope="module")
def decimal_grid(tmp_path_factory):
    """30 s of Paris on a grid of 0.1 s, whose times are no doubles."""
    scene = make_scene(
        "tenths", run={"t_end": "30", "grid_step": "0.1", "digits": 30, "level": "self_consistent"}
    )
    return load(write(solve(scene, transits=False), tmp_path_factory.mktemp("golden") / "tenths"))


@pytest.fixture(scope="module")
def nearly_inverted(tmp_path_factory):
    """3.1 rad at l = 1 m: two and a half digits are lost in every second near the top."""
    release = {"angle": "177.6169164905", "azimuth": "30"}
    run = {"t_end": "20", "grid_step": "10", "digits": 30, "level": "confirmed", "transits": False}
    scene = make_scene("inverted", pendulum={"length": "1"}, release=release, run=run)
    return load(write(solve(scene), tmp_path_factory.mktemp("golden") / "inverted"))


def on_another_grid(golden, step):
    """An independent solution of the same scene, on times that are doubles."""
    solution = solve(
        golden.scene.with_values([f"run.grid_step={step}"]), digits=30, level="self_consistent"
    )
    rows = [
        [Fraction(value, 1 << solution.grid.bits) for value in row] for row in solution.grid.values
    ]
    return np.array([float(t) for t in solution.times]), rows


def distance_m(evaluated, rows):
    """Largest distance of positions, all digits counted."""
    worst = 0.0
    for near, low, row in zip(evaluated.states, evaluated.low, rows, strict=True):
        error = [
            Fraction(a) + Fraction(b) - c
            for a, b, c in zip(near[:3], low[:3], row[:3], strict=True)
        ]
        worst = max(worst, float(sum(part * part for part in error)) ** 0.5)
    return worst


def test_it_agrees_with_a_run_on_another_grid_within_its_bound(decimal_grid):
    times, rows = on_another_grid(decimal_grid, "0.71875")
    for within in (2.0**-58, 2.0**-90):
        evaluated = dense(decimal_grid, times, within)
        assert distance_m(evaluated, rows) <= evaluated.bound_m <= within * 67
        assert np.array_equal(evaluated.t, times)


def test_velocities_agree_as_well(decimal_grid):
    times, rows = on_another_grid(decimal_grid, "0.71875")
    evaluated = dense(decimal_grid, times)
    expected = np.array([[float(value) for value in row[3:6]] for row in rows])
    assert np.abs(evaluated.states[:, 3:] - expected).max() < 1e-16


def test_at_a_golden_time_it_is_the_golden_state(decimal_grid):
    k = 10  # 0.1 * 10 is a double
    evaluated = dense(decimal_grid, [1.0], 2.0**-110)
    for i, name in enumerate(STATE):
        printed = decimal_grid.exact(name)[k]
        assert abs(
            Fraction(evaluated.states[0, i]) + Fraction(evaluated.low[0, i]) - printed
        ) < Fraction(evaluated.bound_m)
    assert evaluated.bound_m < float(decimal_grid.manifest.bounds.position_m) + 1e-29


def test_a_double_beside_a_grid_time_is_not_taken_for_it(decimal_grid):
    """The double 8.3 lies below the decimal and 0.3's above: the bob moves by 1e-17 m between the two."""
    for text in ("8.3", "0.3", "29.9", "29.3"):
        t = float(text)
        evaluated = dense(decimal_grid, [t], 2.0**-90)
        k = (
            decimal_grid.decimals("t").index(text)
            if text in decimal_grid.decimals("t")
            else round(t * 10)
        )
        late = Fraction(t) - Fraction(text)
        moved = decimal_grid.exact("x")[k] + late * decimal_grid.exact("vx")[k]
        value = Fraction(evaluated.states[0, 0]) + Fraction(evaluated.low[0, 0])
        assert abs(value - moved) < Fraction(1, 10**26)


def test_times_in_any_order_and_repeated_come_out_sorted_once(decimal_grid):
    evaluated = dense(decimal_grid, [2.5, 0.0, 1.25, 2.5])
    assert evaluated.t.tolist() == [0.0, 1.25, 2.5]
    assert evaluated.states.shape == evaluated.low.shape == (3, 6)
    one_by_one = np.vstack([dense(decimal_grid, [t]).states for t in evaluated.t])
    assert np.abs(one_by_one - evaluated.states).max() < 1e-16


def test_a_step_beyond_the_end_is_measured_and_more_is_refused(decimal_grid):
    evaluated = dense(decimal_grid, [30.05])
    assert 0 < evaluated.bound_m < 1e-15
    ahead = dense(decimal_grid, [30.0])
    assert evaluated.states[0, 0] == pytest.approx(
        ahead.states[0, 0] + 0.05 * ahead.states[0, 3], abs=1e-4
    )
    # the end, as a program may add it up
    assert dense(decimal_grid, [math.nextafter(30.1, 31)]).bound_m < 1e-15
    with pytest.raises(InputError, match=r"run\.t_end"):
        dense(decimal_grid, [30.11])


@pytest.mark.parametrize("times", [[], [-1.0], [float("nan")], [float("inf")], [0.0, 31.0]])
def test_times_outside_are_refused(decimal_grid, times):
    with pytest.raises(InputError, match=r"t: got"):
        dense(decimal_grid, times)


def test_near_the_inverted_position_the_bound_is_kept(nearly_inverted):
    times, rows = on_another_grid(nearly_inverted, "0.625")
    evaluated = dense(nearly_inverted, times)
    assert 0 < distance_m(evaluated, rows) <= evaluated.bound_m <= 2.0**-58
