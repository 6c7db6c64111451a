"""Methods of fixed step have the order that they claim: the slope of error against step; and keep what they should."""

from __future__ import annotations

import pkgutil
from functools import cache
from importlib import import_module

import numpy as np
import pytest
from small_scenes import make_scene

import compare.methods
import reference
from compare.methods import METHODS, gauss_legendre
from compare.methods.method import available
from compare.methods.rhs.problem import Problem
from reference.numbers.precision import real

SPAN = 3.0
EXPLICIT = [
    name
    for name, method in METHODS.items()
    if method.setting == "step" and name != "gauss_legendre"
]
needs_numba = pytest.mark.skipif(
    available(METHODS["rk4"]) is not None, reason="numba is not installed"
)


@cache
def lively(drag):
    """Every term at work: 50 degrees, aside, an Earth that turns fast, and drag unless it is zero.

    Without drag it has the compiled code of the scenes of the other tests.
    """
    scene = make_scene(
        inputs="binary64",
        pendulum={"length": "1", "drag": drag},
        site={"rotation_rate": "0.7", "equatorial_radius": "3"},
        release={"angle": "50", "azimuth": "20", "angle_rate": "40", "azimuth_rate": "100"},
    )
    return scene, reference.trajectory(scene, [0.0, SPAN], number=real(128))[-1]


def fitted_order(prepare, formulation, counts, drag="0"):
    scene, truth = lively(drag)
    problem = Problem.of(scene, formulation, [0.0, SPAN])
    errors = [np.abs(prepare(problem, SPAN / count)().states[-1] - truth).max() for count in counts]
    return np.polyfit(np.log([SPAN / count for count in counts]), np.log(errors), 1)[0]


@needs_numba
@pytest.mark.parametrize(
    ("name", "formulation", "counts"),
    [
        ("rk4", "plane", (200, 400, 800, 1600)),
        pytest.param("rkng56", "space", (200, 400, 800), marks=pytest.mark.long),  # in plane: below
        ("rkng67", "plane", (160, 240, 400)),
        ("rkmk4", "momentum", (200, 400, 800, 1600)),
        pytest.param("rkmk4", "spin", (200, 400, 800, 1600), marks=pytest.mark.long),
    ],
)
def test_the_error_falls_with_the_power_of_the_step_that_the_method_claims(
    name, formulation, counts, size
):
    order = fitted_order(METHODS[name].prepare, formulation, counts, drag=size("0", "0.1"))
    assert abs(order - METHODS[name].order) < 0.2


@needs_numba
@pytest.mark.parametrize("name", EXPLICIT)
def test_the_error_falls_at_least_as_fast_as_the_claim_in_the_formulation_that_suits_it_best(name):
    method = METHODS[name]
    assert (
        fitted_order(method.prepare, method.formulations[0], (160, 240, 400)) > method.order - 0.2
    )


def test_every_method_of_fixed_step_declares_the_order_that_its_tableau_proves_and_its_title_names() -> (
    None
):
    gauss_legendre.gauss(gauss_legendre.STAGES)  # raises unless its quadrature has order 2 stages
    of_fixed_step = []
    for file in pkgutil.iter_modules(compare.methods.__path__):
        module = import_module(f"compare.methods.{file.name}")
        for method in getattr(module, "METHODS", ()):
            if method.setting == "step":
                of_fixed_step.append(method.id)
                tableau = getattr(module, "TABLEAU", None) or getattr(
                    module, method.id.upper(), None
                )
                proved = tableau.order if tableau else 2 * gauss_legendre.STAGES
                assert method.order == proved, method.id
                assert f"order {proved}" in method.title
    assert sorted(of_fixed_step) == sorted([*EXPLICIT, "gauss_legendre"])


@needs_numba
@pytest.mark.parametrize(
    ("stages", "counts", "drag"),
    [
        pytest.param(1, (100, 200, 400), "0.1", marks=pytest.mark.long),
        (2, (50, 100, 200), "0"),
        pytest.param(3, (30, 60, 120), "0.1", marks=pytest.mark.long),
    ],
)
def test_gauss_legendre_has_twice_the_order_of_its_stages(stages, counts, drag):
    def prepare(problem, setting):
        return gauss_legendre.prepare(problem, setting, stages)

    assert abs(fitted_order(prepare, "momentum", counts, drag) - 2 * stages) < 0.2


@needs_numba
def test_with_eight_stages_gauss_legendre_comes_near_to_order_sixteen_before_rounding():
    assert 15 < fitted_order(gauss_legendre.prepare, "momentum", (6, 8, 10)) < 16.2


@pytest.mark.parametrize("stages", [1, 2, 3, 8])
def test_gauss_legendre_collocates_at_the_nodes_of_the_quadrature(stages):
    a, b, ahead = gauss_legendre.gauss(stages)
    nodes, weights = np.polynomial.legendre.leggauss(stages)
    c = (nodes + 1) / 2
    np.testing.assert_allclose(b, weights / 2, atol=1e-15)
    # exact for polynomials of lower degree, within the step and ahead of it
    for power in range(stages):
        np.testing.assert_allclose(a @ c**power, c ** (power + 1) / (power + 1), atol=1e-14)
        np.testing.assert_allclose(ahead @ c**power, (1 + c) ** power, rtol=1e-9)
    m = b[:, None] * a + b[None, :] * a.T - np.outer(b, b)
    # the condition for quadratic invariants (Cooper 1987)
    np.testing.assert_allclose(m, 0, atol=1e-15)


@needs_numba
def test_the_geometric_methods_stay_on_the_sphere_and_the_others_do_not():
    scene = make_scene(
        pendulum={"length": "1"}, release={"angle": "170", "azimuth": "20"}, inputs="binary64"
    )
    off = {}
    for name, formulation, setting in (
        ("gauss_legendre", "momentum", 0.1),
        ("rkmk4", "momentum", 0.05),
        ("scipy_dop853", "momentum", 1e-6),
    ):
        problem = Problem.of(scene, formulation, [0.0, 100.0, 200.0])
        states = METHODS[name].prepare(problem, setting)().states
        off[name] = abs(np.linalg.norm(states[:, :3], axis=1) - 1).max()
    assert off["gauss_legendre"] < 1e-14
    assert off["rkmk4"] < 1e-13
    assert off["scipy_dop853"] > 1e-9


@needs_numba
def test_gauss_legendre_keeps_the_energy_whatever_the_step_because_it_is_quadratic_in_momentum():
    """h = v²/2 - c·r - Ω²/2 (x² + q²) is H²/2 - H·Ω - n·c there, up to constants of the motion."""
    scene = make_scene(
        inputs="binary64",
        pendulum={"length": "1"},
        site={"rotation_rate": "0.3", "equatorial_radius": "3"},
        release={"angle": "80", "azimuth": "20"},
    )
    problem = Problem.of(scene, "momentum", np.linspace(0, 2000, 401))
    k = problem.constants

    def run(prepare, step, problem=problem):
        x, y, z, *v = states = prepare(problem, step)().states.T
        q = k.cos * z - k.sin * y
        h = (
            sum(part * part for part in v) / 2
            - np.dot(k.pull, states[:3])
            - k.rate**2 / 2 * (x * x + q * q)
        )
        return states.T, np.abs(h - h[0])

    coarse, gauss = run(lambda problem, step: gauss_legendre.prepare(problem, step, 2), 0.1)
    fine, _ = run(gauss_legendre.prepare, 0.1)
    _, classical = run(METHODS["rk4"].prepare, 0.01, Problem.of(scene, "plane", problem.times))
    assert np.abs(coarse - fine)[:, :3].max() > 0.1  # a step so long that the bob is elsewhere
    assert gauss.max() < 1e-12  # 20,000 steps, each rounded
    assert classical.max() > 1e-6
