"""A failure is an outcome with a status, a reason and the rows that were reached; nothing is raised."""

from __future__ import annotations

import shlex
import sys

import numpy as np
import pytest
from method_cases import case
from small_scenes import make_scene

from compare import study
from compare.methods import METHODS, gauss_legendre
from compare.methods.external import external
from compare.methods.rhs.problem import Problem
from reference import InputError


def over_the_horizontal():
    """Falls from 80 degrees so fast that it passes the horizontal, which `plane` cannot follow."""
    return make_scene(
        inputs="binary64",
        pendulum={"length": "1"},
        release={"angle": "80", "azimuth": "20", "angle_rate": "300"},
        run={"t_end": "4", "grid_step": "0.01"},
    )


# explicit steps share the loop that ends a run; how Gauss-Legendre gives up is below
FIXED = [
    name if name == "rk4" else pytest.param(name, marks=pytest.mark.long)
    for name, method in METHODS.items()
    if method.setting == "step" and "plane" in method.formulations
]
EXPLICIT = [
    name for name, method in METHODS.items() if method.native and not name.startswith("cvode")
]


@pytest.mark.parametrize(
    "name", [*FIXED, "scipy_lsoda", "numbalsoda_lsoda", "rebound_bs", *EXPLICIT]
)
def test_a_formulation_that_ends_at_the_horizontal_ends_the_run(name, installed):
    problem = Problem.of(over_the_horizontal(), "plane")
    outcome = installed(name).prepare(problem, METHODS[name].settings(problem.scene)[1])()
    assert outcome.status in ("gave_up", "not_finite")
    assert outcome.reason
    assert outcome.reached_t < problem.times[-1]
    assert len(outcome.states) == np.searchsorted(problem.times, outcome.reached_t) + 1
    assert np.isfinite(outcome.states).all()


def test_a_tolerance_that_scipy_raises_is_said(installed):
    problem = Problem.of(case("steep").scene, "momentum", [0.0, 1.0])
    outcome = installed("scipy_dop853").prepare(problem, 1e-17)()
    assert outcome.status == "ok"
    assert "rtol" in outcome.reason


def test_compiled_lsoda_gives_up_in_its_own_words_and_keeps_stdout_clean(capfd, installed):
    installed("numbalsoda_lsoda")
    (row,) = study(case("steep").scene, items=[("numbalsoda_lsoda", "momentum", 1e-17)]).rows
    assert row.status == "gave_up"
    assert row.reason
    assert capfd.readouterr() == ("", "")


def test_a_step_too_long_for_the_implicit_equations_is_said(installed):
    installed("gauss_legendre")
    problem = Problem.of(case("steep").scene, "momentum")
    outcome = gauss_legendre.prepare(problem, 2.0, stages=2)()  # fewer stages are compiled sooner
    assert outcome.status == "gave_up"
    assert "shorten the step" in outcome.reason
    assert outcome.reached_t == 0


def test_an_unstable_step_ends_in_numbers_that_are_not_finite(installed):
    scene = make_scene(pendulum={"length": "1"}, run={"t_end": "40", "grid_step": "2"})
    outcome = installed("rk4").prepare(Problem.of(scene, "plane"), 2.0)()
    assert outcome.status == "not_finite"
    assert outcome.reached_t < 40


def program(body):
    return f'{shlex.quote(sys.executable)} -c "{body}" {{x0}} {{t_end}} {{grid_step}} {{setting}}'


def test_a_program_of_somebody_else_is_a_method_too():
    body = (
        "import sys; x, t, g, s = map(float, sys.argv[1:]); n = round(t / g); print('t,x,y');"
        " [print(i * g, x + s, 0.4, sep=',') for i in range(n + 1)]"
    )
    problem = Problem.of(make_scene(run={"t_end": "3", "grid_step": "1"}), "momentum")
    outcome = external(program(body)).prepare(problem, 0.5)()
    assert (outcome.status, outcome.reached_t) == ("ok", 3.0)
    np.testing.assert_allclose(outcome.states[:, :2], [[0.8, 0.4]] * 4)
    np.testing.assert_allclose(outcome.states[:, 2], -np.sqrt(67**2 - 0.8**2 - 0.4**2))
    assert np.isnan(outcome.states[:, 3:]).all()
    assert outcome.cpu_s > 0


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("raise SystemExit(3)", "exit status 3"),
        ("print('t,x,y'); print('0,0.3,0.4'); print('1,0.3,nan')", "finite"),
        ("print('t,x,y'); print('0,0.3,0.4'); print('1,0.3,0.4')", "lacks a grid time"),
        ("print('t,x,y'); print('1,0.3,0.4')", "begin at t = 0"),
    ],
)
def test_a_program_that_fails_is_an_outcome_with_its_reason(body, reason):
    problem = Problem.of(make_scene(run={"t_end": "3", "grid_step": "1"}), "momentum")
    outcome = external(program(body)).prepare(problem, 1.0)()
    assert outcome.status == "gave_up"
    assert reason in outcome.reason


def test_a_command_with_an_unknown_placeholder_is_a_mistake_of_the_users():
    problem = Problem.of(make_scene(run={"t_end": "3", "grid_step": "1"}), "momentum")
    with pytest.raises(InputError, match="nonsense"):
        external("prog {nonsense}").prepare(problem, 1.0)
