"""heyoka as it is used here: number types, small systems, refusals."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import heyoka as hy
import numpy as np
import pytest
from places import ROOT
from sampled import one_in
from small_scenes import make_scene, model_at, stepper_of

from reference import trajectory
from reference.engines.heyoka.system import equations_text, system_of
from reference.engines.plan import Plan
from reference.engines.registry import run
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
@pytest.mark.parametrize(
    "name", ["spin", "plane", "angles", *(pytest.param(n, marks=pytest.mark.long) for n in LATER)]
)
def test_every_formulation_runs_to_the_same_place(paris, place, name):
    got = end_of(paris, real(180), name, t_end=20)
    assert max(abs(a - b) for a, b in zip(got, place[0], strict=True)) < Fraction(1, 10**47)


@pytest.mark.parametrize(
    ("number", "error"), [(DOUBLE, 1e-13), (LONG_DOUBLE, 1e-16), (real(113), 1e-31)], ids=str
)
def test_the_error_shrinks_with_the_precision_of_the_type(paris, place, number, error):
    got = end_of(paris, number)
    assert max(abs(a - b) for a, b in zip(got, place[1], strict=True)) < error


@pytest.mark.parametrize(
    ("name", "number"),
    [
        *(("momentum", number) for number in (DOUBLE, LONG_DOUBLE, real(48), real(168))),
        *((name, real(168)) for name in ("inertial", "space", "spin")),
    ],
)
def test_code_that_scenes_share_rounds_as_their_own(paris, name, number):
    """What ships was made by code in which each constant stood as a number: real numbers come out bit by bit."""
    other = make_scene(pendulum={"length": "1.7"}, release={"x": "0.01", "y": "0.2"})
    for scene in (paris, other):
        stepper = stepper_of(scene, number, name)
        equations, _ = system_of(FORMULATIONS[name], stepper.model.k)
        own = hy.taylor_adaptive(
            equations, stepper.state, fp_type=stepper.numbers.type, **stepper.numbers.keywords
        )
        for _ in range(9):
            own.step()
            stepper.advance(stepper.numbers.of(60))
            if not number.hardware:
                assert stepper.state.tolist() == own.state.tolist()
            assert stepper.state.astype(float) == pytest.approx(
                own.state.astype(float), rel=1e-12, abs=1e-14
            )


@pytest.mark.parametrize("number", [DOUBLE, real(90)], ids=str)
def test_steppers_that_share_their_code_find_their_own_zeros_in_turn(paris, number):
    other = make_scene(pendulum={"length": "1.7"}, release={"x": "0.01", "y": "0.2"})

    def zeros(*steppers):
        found = [[] for _ in steppers]
        for _ in range(12):
            for stepper, of_one in zip(steppers, found, strict=True):
                stepper.advance(stepper.numbers.of(60))
                of_one += [(zero.t, zero.direction, *zero.state.tolist()) for zero in stepper.zeros]
        return found

    both = zeros(*(stepper_of(scene, number, events=True) for scene in (paris, other)))
    assert min(map(len, both)) > 1
    assert both == [
        *zeros(stepper_of(paris, number, events=True)),
        *zeros(stepper_of(other, number, events=True)),
    ]


@pytest.mark.parametrize("number", [DOUBLE, real(48), real(90)], ids=str)
def test_a_run_leaves_another_of_the_same_equations_as_it_was(paris, number):
    first, second = stepper_of(paris, number), stepper_of(paris, number)
    release = first.state.tolist()
    times = [first.numbers.of(t) for t in (0, 7, 20)]
    states = first.propagate(times).tolist()
    assert second.time == 0
    assert second.state.tolist() == release
    assert second.propagate(times).tolist() == states


def test_runs_in_turn_have_their_own_terms_bits_and_tolerance(paris):
    damped = make_scene(pendulum={"drag": "1e-5"})
    numbers = (DOUBLE, LONG_DOUBLE, real(90), real(91))
    ends = [end_of(scene, number, t_end=5) for scene in (damped, paris) for number in numbers]
    assert len({*map(tuple, ends)}) == 8
    one, other, again = (
        trajectory(paris, [0, 60], tolerance=tolerance) for tolerance in (1e-9, 1e-8, 1e-9)
    )
    assert (one == again).all()
    assert (one != other).any()


@pytest.mark.parametrize(
    ("site", "gone"),
    [
        ({"rotation_rate": "0"}, {"Omega_y", "Omega_z", "c_y"}),
        ({"latitude": "90"}, {"Omega_y", "c_y"}),
        ({"latitude": "-90"}, {"Omega_y", "c_y"}),
        ({"latitude": "0"}, {"Omega_z", "c_y"}),
    ],
    ids=["no rotation", "north pole", "south pole", "equator"],
)
@pytest.mark.parametrize("name", ["momentum", "inertial", "spin"])
def test_terms_that_vanish_are_in_no_equation(site, gone, name):
    def constants(scene):
        _, k, _, _ = model_at(scene, 100)
        return {*re.findall(r"[A-Za-z]\w*", " ".join(equations_text(FORMULATIONS[name], k)))}

    assert gone <= constants(make_scene())
    assert not gone & constants(make_scene(site=site))


def test_what_is_constant_is_not_shown_and_the_motion_is_the_same():
    """At a pole H_z is constant: five variables are left. `inertial` has none that is."""
    scene = make_scene(site={"latitude": "90"})
    _, k, _, _ = model_at(scene, 100)
    shown = [line.partition("'")[0] for line in equations_text(FORMULATIONS["momentum"], k)]
    assert shown == ["nx", "ny", "nz", "Hx", "Hy"]
    times = (Fraction(0), Fraction(7), Fraction(60))
    less, whole = (
        run(Plan(scene.exact, name, real(120), times, ("xdot",)))
        for name in ("momentum", "inertial")
    )
    gaps = less.grid.distance(whole.grid).largest()
    assert all(0 <= gap < Fraction(1, 2**100) for gap in gaps.values())
    assert less.directions == whole.directions and len(less.directions) > 0


def test_drag_is_in_the_equations_when_the_scene_has_it():
    _, k, _, _ = model_at(make_scene(pendulum={"drag": "0.1"}), 100)
    assert "gamma" in "\n".join(equations_text(FORMULATIONS["momentum"], k))


def test_no_python_float_stands_in_a_real_system(paris):
    """A float is a double for ever; every constant of the equations is a parameter, which carries the run's digits."""
    model = stepper_of(paris, real(200)).model
    lines = system_of(FORMULATIONS["momentum"], model.symbols)[0]
    words = {word.strip("()-") for _, rate in lines for word in str(rate).split()}
    assert not [word for word in words if word[:1].isdigit()]
    assert {word for word in words if word[:1] == "p"} == {f"p{i}" for i in (1, 2, 3, 4)}
    assert all(value.prec == 200 for value in model.parameters)


def test_a_run_that_blows_up_is_an_error_and_gives_no_numbers():
    pushed = make_scene(
        "bad", pendulum={"length": "1e-300"}, release={"angle": "170", "azimuth": "10"}
    )
    stepper = stepper_of(pushed, DOUBLE, "space")
    with pytest.raises(IntegrationError):
        stepper.propagate([0.0, 1e6])


def test_a_step_that_blows_up_is_an_error_too():
    pushed = make_scene(
        "bad", pendulum={"length": "1e-300"}, release={"angle": "170", "azimuth": "10"}
    )
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


CACHED = """
import heyoka as hy
import reference
from reference.numbers.precision import real

print(reference.trajectory("paris", [0, 20])[1].tolist())
if hy.llvm_state.get_diskcache_enabled():
    print(hy.llvm_state.get_diskcache_path(), hy.llvm_state.get_diskcache_limit())
reference.trajectory("paris", [0, 20], number=real(160))
print(hy.llvm_state.get_diskcache_enabled())
"""


def in_a_home(home, folder):
    """What a process prints that has this home, and works in this folder."""
    environment = {name: value for name, value in os.environ.items() if name != "XDG_CACHE_HOME"}
    environment |= {"HOME": str(home), "PYTHONPATH": str(ROOT)}
    words = [sys.executable, "-c", CACHED]
    done = subprocess.run(
        words, capture_output=True, text=True, check=True, cwd=folder, env=environment
    )
    return done.stdout.splitlines()


def test_the_disk_cache_is_the_projects_own_and_bounded_and_off_for_real_where_it_never_hits(
    paris, tmp_path
):
    states, cache, kept_in_real = in_a_home(tmp_path, tmp_path)
    place, _, limit = cache.rpartition(" ")
    assert Path(place).name == "foucault"
    assert any(Path(place).iterdir())
    assert int(limit) < 100e6  # bytes
    assert kept_in_real == "False"
    assert states == str(trajectory(paris, [0, 20])[1].tolist())


@pytest.mark.parametrize("home", one_in(3, ["relative", "", "/dev/null/no_folder"]))
def test_where_no_cache_can_be_heyoka_does_without(paris, tmp_path, home):
    assert in_a_home(home, tmp_path) == [str(trajectory(paris, [0, 20])[1].tolist()), "False"]
    assert not list(tmp_path.iterdir())


def test_code_that_is_compiled_quickly_gives_the_same_numbers(paris):
    """As it is for a short run; that of a long one, whose steps are the same at first, is compiled thoroughly."""
    quick, thorough = (
        run(
            Plan(
                paris.exact,
                "space",
                real(200),
                (Fraction(0), Fraction(50), Fraction(end)),
                ("xdot",),
            )
        )
        for end in (100, 2000)
    )
    assert quick.grid.values[:2] == thorough.grid.values[:2]
    early = [row for row in quick.transits.values if row[0] < 50 << quick.transits.bits]
    assert early == thorough.transits.values[: len(early)] != []


def test_no_states_give_no_rows(paris):
    stepper = stepper_of(paris, DOUBLE)
    assert len(stepper.model.table(np.array([]), 100)) == 0
