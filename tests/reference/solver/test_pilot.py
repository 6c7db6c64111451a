"""Pilot runs: digits lost against closed solutions, and steps foreseen before they are taken."""

from __future__ import annotations

import math
import re
import sys
from fractions import Fraction
from functools import cache

import pytest
from small_scenes import make_scene

import reference
from reference.engines.plan import Plan
from reference.engines.registry import engines, run
from reference.errors import IntegrationError, UnreachableError
from reference.numbers.columns import STATE
from reference.numbers.precision import DOUBLE
from reference.numbers.table import bits_in
from reference.scenes.scene import load_scene
from reference.solver import pilot as pilot_runs
from reference.solver.choice import pilot_for
from reference.solver.pilot import Pace, Pilot, effort, run_pilot
from reference.solver.sensitivity import digits_lost

METRE = {"length": "1"}
STILL = {"rotation_rate": "0"}


def lost(scene, **run_):
    scene = scene.with_values(f"run.{key}={value}" for key, value in run_.items())
    return digits_lost(scene.exact, tuple(scene.exact.grid))


def test_on_the_separatrix_digits_are_lost_as_the_exponential_of_the_time():
    """Close to the top a deviation grows as exp(sqrt(g/l) t) = exp(3 t)."""
    scene = load_scene("separatrix")
    gained = lost(scene, t_end="20", grid_step="1") - lost(scene, t_end="10", grid_step="1")
    assert gained == pytest.approx(30 / math.log(10), abs=0.1)


def test_at_rest_at_the_top_the_digits_of_the_angle_are_lost_as_the_hyperbolic_cosine():
    rate = math.sqrt(9.80665)
    expected = math.log10(math.pi * math.cosh(rate * 20))
    assert lost(load_scene("inverted_rest"), t_end="20") == pytest.approx(expected, abs=0.1)


def test_a_small_swing_loses_digits_by_its_phase_alone():
    """With g and l off by ε in opposite directions the phase w t is off by w t ε, and vz ~ sin 2 w t by twice that."""
    scene = make_scene(
        site=STILL, release={"x": "0.1", "y": "0"}, run={"t_end": "3600", "grid_step": "1"}
    )
    phase = math.sqrt(9.80665 / 67) * 3600
    assert lost(scene) == pytest.approx(math.log10(2 * phase), abs=0.05)


def test_strong_drag_forgets_the_release():
    assert lost(load_scene("overdamped")) < 0.5


@pytest.mark.long
def test_growth_faster_than_any_precision_is_refused_from_the_first_runs():
    scene = load_scene("separatrix", ["run.t_end=1500", "run.grid_step=0.5"])
    with pytest.raises(UnreachableError, match=r"to the end would need about (\d+) bits") as caught:
        run_pilot(scene.exact, tuple(scene.exact.grid))
    bits = int(re.findall(r"(\d+) bits", caught.value.reason)[0])
    needed = 1500 * 3 / math.log(2)
    assert needed * 0.9 < bits < needed * 1.1


def test_a_velocity_that_shrinks_with_the_precision_is_zero_and_not_lost():
    """On the axis of a body without mass or size the bob rests, but no input says so exactly."""
    scene = make_scene(
        pendulum=METRE,
        site={"latitude": "30", "gravity": "0", "equatorial_radius": "0", "rotation_rate": "0.05"},
        release={"angle": "120", "azimuth": "90"},
        run={"t_end": "60", "transits": False, "digits": 20},
    )
    assert run_pilot(scene.exact, tuple(scene.exact.grid)).prec <= pilot_runs.ZERO_PREC
    assert max(map(abs, reference.solve(scene).vx)) < 1e-20
    # over 15 s even heyoka's step was infinite, which ended in an OverflowError
    for end in ("60", "15"):
        with pytest.raises(IntegrationError, match=r"run\.transits = false"):
            reference.solve(scene, transits=True, t_end=end)


def test_exact_rest_is_no_growth_and_a_motion_slower_than_65_bits_show_is_seen():
    """At 512 bits, as once, a month of rest took too many steps and was refused as if rounding grew."""
    still = load_scene("pole", ["release.x=0", "release.y=0"])
    pilot = run_pilot(still.exact, tuple(still.exact.grid))
    assert (pilot.prec, max(pilot.largest[name] for name in STATE[3:])) == (
        pilot_runs.STILL_PREC,
        0,
    )
    slow = load_scene("at_rest")
    assert 0 < run_pilot(slow.exact, tuple(slow.exact.grid)).largest["vx"] < Fraction(1, 10**40)


def pace_of(scene):
    times = (Fraction(0), scene.exact.t_end)
    plan = Plan(scene.exact, "momentum", DOUBLE, times)
    return run(plan, pace=Pace(scene.exact, scene.exact.t_end))


def test_watching_the_pace_changes_nothing(paris):
    plan = Plan(paris.exact, "momentum", DOUBLE, (Fraction(0), Fraction(86400)))
    assert pace_of(paris).grid == run(plan).grid


def test_a_stiff_scene_is_refused_with_its_rates_and_their_ratio():
    scene = load_scene("creeping", ["run.t_end=1e7", "run.grid_step=1e5"])
    with pytest.raises(UnreachableError) as caught:
        reference.solve(scene)
    assert caught.value.exit_status == 3
    reason = caught.value.reason
    assert reason.startswith("Stiff: drag takes the speed away at 4.0e+03/s")
    slow, ratio = (
        float(text)
        for text in re.findall(r"relaxes at (\S+)/s; .* by a factor of (\S+)\. ", reason)[0]
    )
    assert slow == pytest.approx(9.79 / 4000, rel=0.02)
    assert ratio == pytest.approx(4000**2 / 9.79, rel=0.05)


def test_without_any_force_drag_ends_all_motion_and_the_reason_says_so():
    scene = load_scene("force_free", ["pendulum.drag=1e9"])
    with pytest.raises(UnreachableError, match="nothing moves any more"):
        run_pilot(scene.exact, tuple(scene.exact.grid))


def test_a_long_run_is_refused_for_its_length_and_the_advice_is_good(paris):
    """With a step in two seconds, as Paris has them, 2**24 steps are just over a year, 3.36e7 s."""

    def begun(t_end):
        Pace(paris.exact, Fraction(t_end))(70_000, 140_000.0)

    with pytest.raises(UnreachableError, match="steps per simulated second") as caught:
        begun("1e9")
    assert "Stiff" not in caught.value.reason
    advised = re.findall(r"up to about (\S+)\)", caught.value.advice)[0]
    assert 3e7 < float(advised) < 3.36e7
    begun(advised)


def test_a_fast_start_that_drag_brings_to_rest_is_waited_for():
    """70,000 steps in the first second would be 35 million to the end, and at most 2**24 are taken."""
    fast = make_scene(
        pendulum={"length": "1", "drag": "1"},
        release={"x": "0.1", "y": "0", "vx": "100", "vy": "1"},
        run={"t_end": "500", "grid_step": "5"},
    )
    slowing, fast_for_good = (Pace(fast.exact, Fraction(500)) for _ in range(2))
    for pace in (slowing, fast_for_good):
        pace(70_000, 1.0)
    slowing(140_000, 20.0)
    with pytest.raises(UnreachableError, match="steps per simulated second"):
        fast_for_good(1_400_000, 20.0)
    with pytest.raises(UnreachableError, match="steps per simulated second"):
        Pace(fast.with_values(["pendulum.drag=0"]).exact, Fraction(500))(70_000, 1.0)


@pytest.mark.parametrize("level", ["computed", "confirmed", "enclosed"])
@pytest.mark.parametrize("change", ["pendulum.drag=1e300", "site.gravity=1e300"])
def test_rates_beyond_what_double_holds_are_refused(paris, change, level):
    with pytest.raises(UnreachableError):
        reference.solve(paris.with_values([change]), level=level, digits=10)


def test_numbers_beyond_the_range_of_double_are_refused(paris):
    with pytest.raises(UnreachableError, match="beyond the range of binary64"):
        reference.solve(paris.with_values(["pendulum.drag=1e350"]))


def test_effort_counts_steps_at_160_bits_and_grows_with_the_cube():
    assert effort(1000, 160) == 1000
    assert effort(1000, 320) == 8000
    assert effort(1000, 53) < 1000


@pytest.mark.parametrize("level", ["computed", "confirmed"])
def test_digits_that_take_too_many_bits_for_so_many_steps_are_refused(paris, level):
    with pytest.raises(
        UnreachableError, match=r"1000 digits would need \d+ bits and about \d+ steps"
    ):
        reference.solve(paris, t_end="10000", digits=1000, level=level)


@pytest.mark.parametrize("digits", [9, 25])
@pytest.mark.parametrize("level", ["computed", "self_consistent", "confirmed"])
def test_hardware_decides_nothing_but_for_results_of_its_own(paris, level, digits):
    """Of `confirmed`, as of a proof, it decides nothing at all, as they are to be the same everywhere."""
    scene = paris.with_values(["run.t_end=60", f"run.digits={digits}", f"run.level={level}"])
    pilot = pilot_for(scene, tuple(scene.exact.grid))
    number = reference.solve(scene).run.number
    assert (number in ("double", "long_double")) == (digits == 9)
    assert (pilot.prec == DOUBLE.prec) == (digits == 9 and level != "confirmed")


@pytest.mark.parametrize("digits", [9, 25])
def test_a_proof_has_no_number_of_hardware(paris, digits):
    assert reference.solve(paris, t_end="60", digits=digits, level="enclosed").run.number[:4] in (
        "real",
        "limb",
    )


@cache
def in_200_bits(times):
    """The states of Paris, with more digits than any run under test."""
    return run(engines()["limbs"].plan(load_scene("paris").exact, 200, times)).grid.only(STATE)


@pytest.mark.parametrize("engine", ["limbs", "heyoka"])
@pytest.mark.parametrize(
    "t_end", ["600", *(pytest.param(end, marks=pytest.mark.long) for end in ("5000", "20000"))]
)
def test_a_single_run_states_errors_that_its_own_arithmetic_makes(paris, t_end, engine):
    """heyoka's constants are rounded to the bits of the run, those of limbs are not: their errors differ by 2**15."""
    scene = paris.with_values(
        [f"run.t_end={t_end}", "run.grid_step=100", "run.level=computed", "run.digits=25"]
    )
    solution = reference.solve(scene, engine=engine)
    truth = in_200_bits(solution.times)
    assert solution.run.engine == engine
    for name, error in truth.distance(solution.grid).largest().items():
        assert error <= solution.grid.largest_bounds()[name] < Fraction(1, 10**20), name


@pytest.mark.parametrize("transits", [True, False])
def test_a_run_in_double_states_errors_that_double_makes(paris, transits, size):
    """A run without transits was once compared with itself, and stated 5e-15 m where it was off by 7e-12."""
    solution = reference.solve(
        paris, t_end=size("21600", "86400"), level="computed", digits=3, transits=transits
    )
    golden = reference.load("paris")
    assert solution.run.number == "double"
    for name in STATE:
        known = golden.grid.exact(name)[: len(solution.times)]
        pairs = zip(known, solution.grid.exact(name), solution.grid.bound(name), strict=True)
        assert all(abs(true - found) <= bound for true, found, bound in pairs), name


def test_without_numba_the_pilot_is_as_exact(monkeypatch, paris):
    monkeypatch.setitem(sys.modules, "numba", None)
    solution = reference.solve(paris, t_end="600", digits=25, level="confirmed")
    assert solution.run.number.startswith("real(")
    assert max(solution.grid.bound("x")) < Fraction(1, 10**25)


def test_a_column_that_is_only_rounding_is_measured_by_its_kind():
    one, tiny = Fraction(1), Fraction(1, 10**20)
    largest = dict(zip(STATE, (one, tiny, 2 * one, tiny, tiny, tiny), strict=True))
    pilot = Pilot(53, dict.fromkeys(STATE, tiny), largest, 0.0, 0.0, 1)
    assert list(pilot.sizes.values()) == [1, 2, 2, 0, 0, 0]


@pytest.mark.parametrize("power", [-2000, -3, 0, 1, 5, 3000])
def test_bits_are_counted_exactly_however_large_or_small(power):
    exact = Fraction(2) ** power
    assert bits_in(exact) == power
    assert bits_in(exact * (1 + Fraction(1, 2**80))) == power + 1
    assert bits_in(exact * (1 - Fraction(1, 2**80))) == power
    assert bits_in(Fraction(0)) == 0


def test_digits_lost_in_one_burst_are_not_taken_for_a_steady_loss():
    """From 1e-17 degrees off the top the fall costs all of double within 15 s; what follows costs little."""
    scene = make_scene(
        pendulum=METRE,
        site=STILL,
        release={"angle": "179.99999999999999999", "azimuth": "30"},
        run={"t_end": "300", "grid_step": "2", "digits": 10, "transits": False},
    )
    assert DOUBLE.prec < run_pilot(scene.exact, tuple(scene.exact.grid)).prec <= 256
