"""heyoka as it is used here: number types, small systems, refusals."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import heyoka as hy
import numpy as np
import pytest
from sampled import one_in
from small_scenes import make_scene, model_at, stepper_of

import reference.engines.heyoka.run as module
from reference.engines.heyoka import model as model_module
from reference.engines.heyoka import stepper as stepper_module
from reference.engines.heyoka import system
from reference.engines.heyoka.system import equations_text, system_of
from reference.engines.plan import Plan
from reference.errors import IntegrationError
from reference.model.formulations import FORMULATIONS
from reference.numbers.columns import STATE
from reference.numbers.precision import DOUBLE, LONG_DOUBLE, real


def end_of(scene, number, name="momentum", t_end=60):
    stepper = stepper_of(scene, number, name)
    states = stepper.propagate([stepper.numbers.of(0), stepper.numbers.of(t_end)])
    table = stepper.model.table(states, 300)
    return [table.exact(name)[-1] for name in STATE]


LATER = ("space", "lagrangian")


@pytest.fixture(scope="module")
def place():
    """Where the formulation that is usual is after 20 s, and after 60 s with more digits."""
    paris = make_scene("paris")
    return end_of(paris, real(180), t_end=20), end_of(paris, real(250))


# space is held in test_trajectory; the equations of each are those of all others in test_formulations
@pytest.mark.parametrize("name", ["spin", "plane", "angles", *(pytest.param(n, marks=pytest.mark.long) for n in LATER)])
def test_every_formulation_runs_to_the_same_place(paris, place, name):
    got = end_of(paris, real(180), name, t_end=20)
    assert max(abs(a - b) for a, b in zip(got, place[0], strict=True)) < Fraction(1, 10**47)


@pytest.mark.parametrize(("number", "error"), [(DOUBLE, 1e-13), (LONG_DOUBLE, 1e-16), (real(113), 1e-31)], ids=str)
def test_the_error_shrinks_with_the_precision_of_the_type(paris, place, number, error):
    got = end_of(paris, number)
    assert max(abs(a - b) for a, b in zip(got, place[1], strict=True)) < error


@pytest.fixture(scope="module")
def full():
    """A function that gives the size of the system of Paris, in which no term vanishes."""
    return cache(lambda name: len(stepper_of(make_scene("paris"), DOUBLE, name)._ta.decomposition))


@pytest.mark.parametrize(
    "sections",
    [{"rotation_rate": "0"}, {"latitude": "90"}, {"latitude": "0"}, {"latitude": "-90"}],
    ids=["no rotation", "north pole", "equator", "south pole"],
)
@pytest.mark.parametrize("name", one_in(3, ["momentum", "space", "spin"]))
def test_a_scene_whose_terms_vanish_compiles_a_smaller_system(full, sections, name):
    small = stepper_of(make_scene(site=sections), DOUBLE, name)
    assert len(small._ta.decomposition) < full(name)


def test_events_are_compiled_only_when_asked_for(paris):
    assert not stepper_of(paris, DOUBLE)._ta.with_events
    assert stepper_of(paris, DOUBLE, events=True)._ta.with_events


@pytest.mark.parametrize(
    ("name", "number"),
    [
        *(("momentum", number) for number in (DOUBLE, LONG_DOUBLE, real(48), real(168))),
        *((name, real(168)) for name in ("inertial", "space", "spin")),
    ],
)
def test_other_numbers_in_the_same_terms_share_the_code_and_it_rounds_as_their_own(paris, name, number):
    """What ships was made by code in which each constant stood as a number: real numbers come out bit by bit."""
    model_module._compiled.cache_clear()
    other = make_scene(pendulum={"length": "1.7"}, release={"x": "0.01", "y": "0.2"})
    for scene in (paris, other):
        stepper = stepper_of(scene, number, name)
        equations, _ = system_of(FORMULATIONS[name], stepper.model.k)
        own = hy.taylor_adaptive(equations, stepper.state, fp_type=stepper.numbers.type, **stepper.numbers.keywords)
        for _ in range(9):
            own.step()
            stepper.advance(stepper.numbers.of(60))
            if not number.hardware:
                assert stepper.state.tolist() == own.state.tolist()
            assert stepper.state.astype(float) == pytest.approx(own.state.astype(float), rel=1e-12, abs=1e-14)
    kept = model_module._compiled.cache_info()
    assert (kept.misses, kept.hits) == (1, 1)


@pytest.mark.parametrize("number", [DOUBLE, real(90)], ids=str)
def test_steppers_that_share_their_code_find_their_own_zeros_in_turn(paris, number):
    model_module._compiled.cache_clear()
    other = make_scene(pendulum={"length": "1.7"}, release={"x": "0.01", "y": "0.2"})

    def zeros(*steppers):
        found = [[] for _ in steppers]
        for _ in range(12):
            for stepper, of_one in zip(steppers, found, strict=True):
                stepper.advance(stepper.numbers.of(60))
                of_one += [(zero.t, zero.direction, *zero.state.tolist()) for zero in stepper.zeros]
        return found

    both = zeros(*(stepper_of(scene, number, events=True) for scene in (paris, other)))
    assert model_module._compiled.cache_info().hits == 1
    assert min(map(len, both)) > 1
    assert both == [*zeros(stepper_of(paris, number, events=True)), *zeros(stepper_of(other, number, events=True))]


@pytest.mark.parametrize("number", [DOUBLE, real(48), real(90)], ids=str)
def test_runs_of_the_same_equations_share_their_code_and_nothing_else(paris, number):
    model_module._compiled.cache_clear()
    first, second = stepper_of(paris, number), stepper_of(paris, number)
    kept = model_module._compiled.cache_info()
    assert (kept.misses, kept.hits) == (1, 1)
    release = first.state.tolist()
    times = [first.numbers.of(t) for t in (0, 7, 20)]
    states = first.propagate(times).tolist()
    assert second.time == 0
    assert second.state.tolist() == release
    assert second.propagate(times).tolist() == states
    model_module._compiled.cache_clear()
    assert stepper_of(paris, number).propagate(times).tolist() == states


def test_other_terms_bits_or_tolerances_are_other_code(paris):
    model_module._compiled.cache_clear()
    stepper_of(make_scene(pendulum={"drag": "1e-5"}), DOUBLE)
    for number in (LONG_DOUBLE, real(90), real(91), DOUBLE):
        model = stepper_of(paris, number).model
    for tolerance in (1e-9, 1e-8):
        model.propagator(tolerance)
    assert model_module._compiled.cache_info().hits == 0


def test_the_equations_shown_are_the_ones_compiled():
    _, k, _, _ = model_at(make_scene(site={"latitude": "90"}), 100)
    text = "\n".join(equations_text(FORMULATIONS["momentum"], k))
    assert "Omega_z" in text
    assert "Omega_y" not in text
    assert "gamma" not in text


def test_what_is_constant_is_neither_shown_nor_integrated(monkeypatch):
    """At a pole H_z is constant: five variables are left, and the states are those of all six to the last bits."""
    scene = make_scene(site={"latitude": "90"}, run={"t_end": "60"})
    _, k, _, _ = model_at(scene, 100)
    assert [line.partition("'")[0] for line in equations_text(FORMULATIONS["momentum"], k)] == [
        "nx", "ny", "nz", "Hx", "Hy",
    ]  # fmt: skip
    plan = Plan(scene.exact, "momentum", real(120), (Fraction(0), Fraction(7), Fraction(60)), ("xdot",))
    integrated = []

    def stepper(formulation, *arguments, **options):
        integrated.append(formulation.variables)
        return stepper_module.Stepper(formulation, *arguments, **options)

    monkeypatch.setattr(module, "Stepper", stepper)
    less = module.run(plan)
    monkeypatch.setattr(module, "carried", lambda formulation, start, number: formulation)
    whole = module.run(plan)
    assert [*map(len, integrated)] == [5, 6]
    gaps = less.grid.distance(whole.grid).largest()
    assert all(0 <= gap < Fraction(1, 2**100) for gap in gaps.values())
    assert less.directions == whole.directions and len(less.directions) > 0


def test_drag_is_in_the_equations_when_the_scene_has_it():
    _, k, _, _ = model_at(make_scene(pendulum={"drag": "0.1"}), 100)
    assert "gamma" in "\n".join(equations_text(FORMULATIONS["momentum"], k))


def test_no_python_float_stands_in_a_real_system(paris):
    """A float is a double for ever; every constant of the equations is a parameter, which carries the run's digits."""
    stepper = stepper_of(paris, real(200))
    lines = system_of(FORMULATIONS["momentum"], stepper.model.symbols)[0]
    words = {word.strip("()-") for _, rate in lines for word in str(rate).split()}
    assert not [word for word in words if word[:1].isdigit()]
    assert {word for word in words if word[:1] == "p"} == {f"p{i}" for i in (1, 2, 3, 4)}
    assert all(value.prec == 200 for value in stepper._ta.pars)
    assert stepper._ta.pars[1:].tolist() == [*stepper.model.k.entries("turn", "pull").values()]


def test_a_run_that_blows_up_is_an_error_and_gives_no_numbers():
    pushed = make_scene("bad", pendulum={"length": "1e-300"}, release={"angle": "170", "azimuth": "10"})
    stepper = stepper_of(pushed, DOUBLE, "space")
    with pytest.raises(IntegrationError):
        stepper.propagate([0.0, 1e6])


def test_a_step_that_blows_up_is_an_error_too():
    pushed = make_scene("bad", pendulum={"length": "1e-300"}, release={"angle": "170", "azimuth": "10"})
    stepper = stepper_of(pushed, DOUBLE, "space", events=True)
    with pytest.raises(IntegrationError):
        for _ in range(100_000):
            stepper.advance(1e6)


def test_the_run_reports_the_time_it_has_reached(paris):
    seen: list[float] = []
    stepper = stepper_of(paris, DOUBLE)
    stepper.propagate([0.0, 3600.0], seen.append)
    assert seen == sorted(seen)
    assert 0 < seen[0] < seen[-1] <= 3600


def test_one_time_is_the_release_itself(paris):
    stepper = stepper_of(paris, DOUBLE)
    states = stepper.propagate([0.0])
    assert states.shape == (1, 6)


@pytest.fixture
def asked_anew():
    """Code is compiled, and the place of its cache looked for again where there was none: locked, or without a home."""
    model_module._compiled.cache_clear()
    if not system._has_place():
        system._has_place.cache_clear()


@pytest.mark.usefixtures("asked_anew")
def test_the_disk_cache_is_off_for_real_where_it_never_hits(paris):
    stepper_of(paris, DOUBLE)
    assert hy.llvm_state.get_diskcache_enabled()
    stepper_of(paris, real(160))
    assert not hy.llvm_state.get_diskcache_enabled()


@pytest.mark.usefixtures("asked_anew")
def test_the_disk_cache_is_the_projects_own_and_bounded(paris):
    stepper_of(paris, DOUBLE)
    assert hy.llvm_state.get_diskcache_path().name == system.FOLDER
    assert hy.llvm_state.get_diskcache_limit() == system.MOST_BYTES


@pytest.mark.parametrize("place", ["relative", "", "/dev/null/no_folder"])
def test_where_no_cache_can_be_heyoka_does_without(paris, monkeypatch, tmp_path, place):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(system.hy.llvm_state, "get_diskcache_path", lambda: place)
    system._has_place.cache_clear()
    model_module._compiled.cache_clear()
    try:
        stepper_of(paris, DOUBLE)
        assert not hy.llvm_state.get_diskcache_enabled()
        assert not list(tmp_path.iterdir())
    finally:
        monkeypatch.undo()
        system._has_place.cache_clear()


@pytest.mark.parametrize("prec", one_in(2, [200, 80]))
def test_code_that_is_compiled_quickly_gives_the_same_numbers(paris, monkeypatch, prec):
    plan = Plan(paris.exact, "space", real(prec), (Fraction(0), Fraction(50), Fraction(100)), ("xdot",))
    quick = module.run(plan)
    monkeypatch.setattr(model_module, "SHORT_WORK", 0)
    thorough = module.run(plan)
    assert quick.grid.values == thorough.grid.values
    assert quick.transits.values == thorough.transits.values


def test_no_states_give_no_rows(paris):
    stepper = stepper_of(paris, DOUBLE)
    assert len(stepper.model.table(np.array([]), 100)) == 0
