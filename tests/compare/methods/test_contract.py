"""The contract of every method, tested against the reference on a gentle and on a steep scene."""

from __future__ import annotations

import subprocess
import sys
from functools import cache

import numpy as np
import pytest
from method_cases import Counted, case

from compare.methods import METHODS
from compare.methods.method import Family, Method, available
from compare.methods.rhs.problem import suited
from reference import InputError
from reference.system.imports import install_command

# looser than the tight end of the ladder, which would take longer than a test may
SETTINGS = {"heyoka_real": 160, "mpmath_odefun": 113}
ROWS = {"mpmath_odefun": 2}
ERROR = 1e-7  # of the cord length: every method gets there …
ERRORS = {
    "scipy_bdf": 1e-5,
    "scipy_radau": 1e-6,
    "scipy_rk45": 1e-6,
}  # … but for those whose ladder ends where they become too dear


@cache
def prepared(name, scene, setting=None):
    method, example = METHODS[name], case(scene)
    problem = example.problem(name, rows=ROWS.get(name))
    return problem, method.prepare(
        problem, setting or SETTINGS.get(name) or method.settings(example.scene)[-1]
    )


@cache
def run(name, scene, setting=None):
    problem, work = prepared(name, scene, setting)
    return problem, work()


@pytest.fixture(params=list(METHODS))
def name(request, installed):
    return installed(request.param).id


# in every run: one of each family
STEEP = {"rk4", "rkmk4", "heyoka_real", "scipy_dop853", "cvode_adams"}
CASES = [(name, "paris") for name in METHODS]
CASES += [
    (name, "steep") if name in STEEP else pytest.param(name, "steep", marks=pytest.mark.long)
    for name in METHODS
]


@pytest.mark.parametrize(("name", "scene"), CASES)
def test_every_method_finds_the_reference(name, scene, installed):
    installed(name)
    problem, outcome = run(name, scene)
    truth, length = case(scene).truth[: len(problem.times)], float(case(scene).scene.exact.length)
    assert (outcome.status, outcome.reached_t) == ("ok", problem.times[-1])
    assert outcome.states.shape == (len(problem.times), 6)
    assert np.abs(outcome.states - truth)[:, :3].max() < ERRORS.get(name, ERROR) * length
    assert np.abs(outcome.states - truth)[:, 3:].max() < ERRORS.get(name, ERROR) * length * np.sqrt(
        9.8 / length
    )


def test_a_run_can_be_repeated_and_gives_the_same_bits(name):
    coarse = METHODS[name].ladder[0]
    first, second = run(name, "paris", coarse)[1], prepared(name, "paris", coarse)[1]()
    assert np.array_equal(first.states, second.states)
    assert (first.steps, first.rhs_evaluations) == (second.steps, second.rhs_evaluations)


def test_a_tighter_setting_is_better(name):
    (problem, coarse), (_, fine) = run(name, "paris", METHODS[name].ladder[0]), run(name, "paris")
    truth = case("paris").truth[: len(problem.times)]
    errors = [np.abs(outcome.states - truth)[:, :3].max() for outcome in (coarse, fine)]
    assert errors[1] < errors[0] or errors[0] < 1e-13


def test_a_word_that_no_method_has_may_be_looked_for():
    assert METHODS.get("nothing") is None
    assert METHODS.get("nothing", 0) == 0


def test_a_declaration_is_complete(name):
    method = METHODS[name]
    assert method.id == name
    assert method.title
    assert method.source
    assert method.licence
    assert len(method.ladder) >= 2
    finer = method.setting == "precision"
    assert list(method.ladder) == sorted(method.ladder, reverse=not finer)
    assert all(install_command(name, method.extra or "") for name in method.requires)


@pytest.mark.parametrize(
    "name", [name for name, method in METHODS.items() if method.number != "double"]
)
def test_exact_states_show_errors_far_below_a_doubles(name, installed):
    installed(name)
    problem, outcome = run(name, "paris")
    grid = case("paris").solution.grid
    errors = [
        abs(x - truth) for x, truth in zip(outcome.exact.exact("x"), grid.exact("x"), strict=False)
    ]
    assert len(outcome.exact) == len(problem.times)
    assert float(max(errors)) < {"heyoka_long_double": 1e-17}.get(name, 1e-27)
    np.testing.assert_allclose(outcome.states[:, 0], outcome.exact["x"], rtol=3e-16, atol=1e-19)


def test_doubles_have_no_finer_form():
    assert run("heyoka_double", "paris")[1].exact is None


def test_fixed_steps_are_counted_by_the_step():
    for name, stages in (("rk4", 4), ("rkng56", 8), ("rkng67", 10), ("rkmk4", 4)):
        if available(METHODS[name]) is None:
            _, outcome = run(name, "paris", 0.1)
            assert (outcome.steps, outcome.rhs_evaluations) == (600, 600 * stages)


def test_steps_end_on_output_times_that_they_do_not_divide(installed):
    problem = case("paris").problem("rk4")
    assert installed("rk4").prepare(problem, 1.5)().steps == 12 * 4  # 5 s in four steps


@pytest.mark.parametrize(
    "name", [name for name, method in METHODS.items() if method.family is Family.SCIPY]
)
def test_scipy_reports_every_call_of_the_right_hand_side(name, installed):
    installed(name)
    problem = case("paris").problem(name, kind=Counted)
    work = METHODS[name].prepare(problem, 1e-6)
    problem.calls.clear()
    assert work().rhs_evaluations == len(problem.calls) > 0


@pytest.mark.parametrize("name", ["cvode_adams", "cvode_bdf"])
def test_cvode_reports_every_call_of_the_right_hand_side(name, installed):
    installed(name)
    problem = case("steep").problem(name, kind=Counted)
    assert METHODS[name].prepare(problem, 1e-6)().rhs_evaluations == len(problem.calls) > 0


def test_dop853_needs_about_the_same_calls_in_scipy_and_compiled(installed):
    names = [installed(name).id for name in ("scipy_dop853", "numbalsoda_dop853")]
    first, second = (run(name, "steep", 1e-9)[1].rhs_evaluations for name in names)
    assert abs(first - second) < 0.3 * first


IDS = """
rk4 rkng56 rkng67 rkmk4 gauss_legendre limbs heyoka_double heyoka_long_double heyoka_real128 heyoka_real mpmath_odefun
scipy_rk45 scipy_dop853 scipy_radau scipy_bdf scipy_lsoda numbalsoda_dop853 numbalsoda_lsoda cvode_adams cvode_bdf
rebound_bs rebound_ias15 diffrax_dopri8 odeint_rkf78 odeint_bulirsch_stoer gsl_rk8pd cvode_c_adams cvode_c_bdf
arkode_erk8
"""


def test_the_registry_knows_every_id_of_the_issue():
    assert {*IDS.split()} <= {*METHODS}


def test_an_unknown_method_is_refused_by_name():
    with pytest.raises(InputError, match=r"scipy_dop852.*Did you mean scipy_dop853"):
        METHODS["scipy_dop852"]
    assert "scipy_dop852" not in METHODS


def test_methods_are_listed_by_family_and_then_by_file():
    families = [method.family for method in METHODS.values()]
    assert families == sorted(families, key=list(Family).index)
    by_file = ["rk4", "rkng56", "rkng67", "gauss_legendre", "rkmk4"]
    assert [name for name in METHODS if name in by_file] == by_file


def test_declarations_load_no_library():
    code = (
        "import sys, compare.methods as m; [m.METHODS[name] for name in m.METHODS]; "
        "print([x for x in ('heyoka', 'scipy', 'numba', 'flint', 'rebound', 'jax', 'sksundae') if x in sys.modules])"
    )
    process = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    )
    assert process.stdout.strip() == "[]"


def test_what_is_not_installed_says_what_brings_it():
    nothing = Method(
        "x", "x", "step", (1,), "", "", lambda problem, setting: None, requires=("no_such_thing",)
    )
    assert available(nothing) == "not installed (no_such_thing)"
    extra = Method(
        "x",
        "x",
        "step",
        (1,),
        "",
        "",
        lambda p, s: None,
        requires=("no.such.thing",),
        extra="methods",
    )
    assert "pip install 'foucault-reference[methods]'" in available(extra)


def test_what_numba_would_compile_is_not_run_without_its_compiler(monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    assert available(METHODS["rk4"]) == "NUMBA_DISABLE_JIT is set: unset it"
    assert available(METHODS["heyoka_double"]) is None


def test_steps_are_scaled_to_the_swing_of_the_scene():
    rk4 = METHODS["rk4"]
    assert rk4.settings(case("paris").scene) == rk4.ladder
    assert rk4.settings(case("steep").scene)[:2] == (0.02, 0.01)
    dop853 = METHODS["scipy_dop853"]
    assert dop853.settings(case("steep").scene) == dop853.ladder


def test_the_formulation_suits_the_motion():
    words = ("plane", "space", "momentum")
    steep = case("steep").scene
    assert suited(steep, words) == "plane"
    assert suited(steep.with_values(["release.angle=100"]), words) == "momentum"
    assert suited(steep.with_values(["release.azimuth_rate=400"]), words) == "momentum"
    assert suited(steep.with_values(["site.rotation_rate=3"]), words) == "momentum"
    assert suited(steep.with_values(["release.angle=100"]), ("plane", "space")) == "space"
