"""One run of any system: against closed forms, and the model against itself with every constant open."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from sampled import one_in
from small_scenes import make_scene

from reference import InputError, IntegrationError, integrate, load_scene, trajectory
from reference.engines.trajectory import Variants
from reference.numbers.precision import DOUBLE, LONG_DOUBLE, real

TIMES = np.linspace(0.0, 100.0, 57)


@pytest.fixture(scope="module")
def variants():
    return Variants()


def test_a_harmonic_oscillator_comes_out_as_sine_and_cosine():
    states = integrate(("q", "p"), lambda state, _: (state[1], -state[0]), (1.0, 0.0), TIMES)
    assert np.abs(states - np.column_stack([np.cos(TIMES), -np.sin(TIMES)])).max() < 1e-13


@pytest.mark.parametrize("number", [LONG_DOUBLE, real(120)])
def test_a_finer_type_leaves_only_the_rounding_to_doubles(number):
    times = [0.0, 1.0, 2.5]
    states = integrate(
        ("q", "p"), lambda state, _: (state[1], -state[0]), (Fraction(1), 0), times, number=number
    )
    assert np.array_equal(states, np.column_stack([np.cos(times), -np.sin(times)]))


def test_the_functions_are_those_of_the_number_type():
    states = integrate(
        ("q",), lambda state, functions: (functions.cos(state[0]),), (0.0,), [0.0, 2.0]
    )
    assert states[1, 0] == pytest.approx(2 * np.arctan(np.tanh(1.0)), abs=1e-15)  # the gudermannian


def test_a_loose_tolerance_is_loose():
    system = ("q", "p"), lambda state, _: (state[1], -state[0]), (1.0, 0.0), TIMES
    exact = np.cos(TIMES)
    loose, tight = (
        np.abs(integrate(*system, tolerance=tol)[:, 0] - exact).max() for tol in (1e-5, 1e-12)
    )
    assert 1e-9 < loose < 1e-2
    assert tight < 1e-10


def test_a_solution_that_escapes_gives_no_numbers():
    with pytest.raises(IntegrationError):
        integrate(("q",), lambda state, _: (state[0] * state[0],), (1.0,), [0.0, 2.0])  # 1/(1 - t)


def test_a_run_ends_after_its_most_steps():
    system = ("q", "p"), lambda state, _: (state[1], -state[0]), (1.0, 0.0), TIMES
    assert len(integrate(*system, max_steps=1000)) == len(TIMES)
    with pytest.raises(IntegrationError, match="step_limit"):
        integrate(*system, max_steps=10)


@pytest.fixture(scope="module")
def motion():
    """Paris by the formulation that is usual."""
    return trajectory(load_scene("paris"), TIMES, number=LONG_DOUBLE)


# that the others run to the same place is held in test_heyoka
@pytest.mark.parametrize(
    "formulation", one_in(5, ["space", "spin", "plane", "angles", "lagrangian"])
)
def test_every_formulation_gives_the_same_motion(paris, motion, formulation):
    found = trajectory(paris, TIMES, formulation=formulation, number=LONG_DOUBLE)
    assert np.abs(found - motion).max() < 1e-14


@pytest.mark.parametrize("number", [DOUBLE, real(120)])
def test_a_run_into_the_singularity_of_its_formulation_says_so(number):
    rising = make_scene(
        pendulum={"length": "1"}, release={"angle": "80", "azimuth": "20", "angle_rate": "500"}
    )
    with pytest.raises(
        IntegrationError, match=r"plane is singular at the horizontal: use momentum"
    ):
        trajectory(rising, [0.0, 10.0], formulation="plane", number=number)
    assert trajectory(rising, [0.0, 10.0], number=number).shape == (2, 6)


def test_a_run_that_needs_steps_without_end_comes_to_an_end(paris):
    """As next to a singularity; here the model is altered to turn a billion times as fast as the scene says."""
    with pytest.raises(
        IntegrationError, match=r"stopped at t = .* s, after \d{1,5} steps, .*step_limit"
    ):
        trajectory(paris, TIMES, alter=lambda k: replace(k, turn=(0, 10**5, 0)))


def test_a_run_keeps_the_grid_of_the_golden_data(paris):
    from reference import load

    golden = load("paris")
    states = trajectory(paris, golden.t[:20], number=LONG_DOUBLE)
    assert np.abs(states[:, 0] - golden.x[:20]).max() < 1e-15


def test_an_altered_constant_is_another_model(paris):
    free = trajectory(paris, TIMES, alter=lambda k: replace(k, turn=(0, 0, 0)), formulation="spin")
    still = trajectory(paris.with_values(["site.rotation_rate=0"]), TIMES)
    assert np.abs(free - trajectory(paris, TIMES)).max() > 1e-3
    assert not np.allclose(free, still, atol=1e-6)  # the centrifugal force is still there


def oscillator(state, _):
    return state[1], -state[0]


@pytest.mark.parametrize(
    "times",
    [[], [1.0, 2.0], [0.0, 2.0, 1.0], [0.0, 1.0, 1.0], [0.0, math.nan], [math.nan], [0.0, math.inf],
     np.array([0.0, math.nan]), np.zeros((2, 2)), 5.0, None, ["0", "1"], [0.0, None]],
)  # fmt: skip
def test_times_that_do_not_increase_from_zero_are_a_mistake(times, paris):
    for number in (DOUBLE, LONG_DOUBLE, real(120)):
        for call in (
            lambda number: trajectory(paris, times, number=number),
            lambda number: integrate(("q", "p"), oscillator, (1.0, 0.0), times, number=number),
        ):
            with pytest.raises(
                InputError, match=r"times: got .* increasing times in s, the first of them 0"
            ):
                call(number)


def test_other_mistakes_name_their_field(paris):
    with pytest.raises(InputError, match=r"formulation: got 'momentun', .*Did you mean momentum"):
        trajectory(paris, [0, 1], formulation="momentun")
    with pytest.raises(
        InputError, match="derivatives: got 1 rate, expected 2, one for each variable"
    ):
        integrate(("q", "p"), lambda state, _: (state[1],), (1.0, 0.0), [0, 1])
    with pytest.raises(InputError, match=r"start: .* 2 numbers, one for each variable"):
        integrate(("q", "p"), oscillator, (1.0,), [0, 1])
    for wrong in (0.0, -1.0, math.nan, math.inf, "1e-9"):
        with pytest.raises(InputError, match="tolerance: "):
            integrate(("q", "p"), oscillator, (1.0, 0.0), [0, 1], tolerance=wrong)


@pytest.mark.parametrize("formulation", one_in(2, ["momentum", "space", "spin", "plane", "angles"]))
def test_a_release_at_rest_is_at_rest_to_the_last_bit(formulation, paris):
    x, y, _, *velocity = trajectory(paris, [0, 1], formulation=formulation)[0].tolist()
    assert (x, y, velocity) == (0.3, 0.4, [0, 0, 0])


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"site": {"latitude": "90"}},
        {"site": {"rotation_rate": "0"}},
        {"pendulum": {"length": "1", "drag": "0.01"}},
        {
            "pendulum": {"length": "1"},
            "release": {"angle": "120", "azimuth": "20", "azimuth_rate": "5"},
        },
    ],
)
def test_the_model_with_open_constants_is_the_model(variants, changes):
    scene, times = make_scene(**changes), TIMES[:12]
    assert np.abs(variants.states(scene.exact, times) - trajectory(scene, times)).max() < 1e-12


def test_a_release_beyond_the_cord_is_refused(variants, paris):
    with pytest.raises(InputError, match="out of the cord's reach"):
        variants.states(replace(paris.exact, length=Fraction(1, 2)), TIMES)


@pytest.mark.parametrize(
    "times",
    [
        np.arange(3),
        np.arange(3, dtype=np.float32),
        [0, Decimal(1), Fraction(2)],
        [mpmath.mpf(0), 1, np.longdouble(2)],
    ],
)
def test_times_may_be_any_numbers(times):
    assert (trajectory("paris", times) == trajectory("paris", [0.0, 1.0, 2.0])).all()
