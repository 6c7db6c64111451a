"""Tableaux prove their order when they are made; their steps show it: the slope of error against step."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from small_scenes import make_scene

import reference
from compare.methods import METHODS, Problem, available, gauss_legendre, rk4, rkng56, rkng67
from compare.methods.tableau import Tableau, TableauError, fractions, triangle
from compare.methods.trees import trees
from reference.precision import real

SPAN = 3.0
NYSTROM = {"rkng56": rkng56, "rkng67": rkng67}
needs_numba = pytest.mark.skipif(available(METHODS["rk4"]) is not None, reason="numba is not installed")


@cache
def lively():
    """Every term at work: 50 degrees, aside, an Earth that turns fast, drag."""
    scene = make_scene(
        inputs="binary64",
        pendulum={"length": "1", "drag": "0.1"},
        site={"rotation_rate": "0.7", "equatorial_radius": "3"},
        release={"angle": "50", "azimuth": "20", "angle_rate": "40", "azimuth_rate": "100"},
    )
    return scene, reference.trajectory(scene, [0.0, SPAN], number=real(128))[-1]


def fitted_order(prepare, formulation, counts):
    scene, truth = lively()
    problem = Problem.of(scene, formulation, [0.0, SPAN])
    errors = [np.abs(prepare(problem, SPAN / count)().states[-1] - truth).max() for count in counts]
    return np.polyfit(np.log([SPAN / count for count in counts]), np.log(errors), 1)[0]


@needs_numba
@pytest.mark.parametrize(
    ("name", "formulation", "counts", "order"),
    [
        ("rk4", "plane", (200, 400, 800, 1600), 4),
        ("rkng56", "space", (200, 400, 800), 5),
        ("rkng67", "plane", (160, 240, 400), 6),
        ("rkmk4", "momentum", (200, 400, 800, 1600), 4),
        ("rkmk4", "spin", (200, 400, 800, 1600), 4),
    ],
)
def test_the_error_falls_with_the_power_of_the_step_that_the_method_claims(name, formulation, counts, order):
    assert abs(fitted_order(METHODS[name].prepare, formulation, counts) - order) < 0.2


@needs_numba
@pytest.mark.parametrize(("stages", "counts"), [(1, (100, 200, 400)), (2, (50, 100, 200)), (3, (30, 60, 120))])
def test_gauss_legendre_has_twice_the_order_of_its_stages(stages, counts):
    def prepare(problem, setting):
        return gauss_legendre.prepare(problem, setting, stages)

    assert abs(fitted_order(prepare, "momentum", counts) - 2 * stages) < 0.2


@needs_numba
def test_with_eight_stages_gauss_legendre_comes_near_to_order_sixteen_before_rounding():
    assert 15 < fitted_order(gauss_legendre.prepare, "momentum", (6, 8, 10)) < 16.2


@pytest.mark.parametrize("name", NYSTROM)
def test_a_misprint_of_a_public_copy_is_refused(name):
    tableau = NYSTROM[name].TABLEAU
    for table, row, column, printed in NYSTROM[name].MISPRINTS:
        rows = [list(line) for line in getattr(tableau, table)]
        if len(rows[row]) > column and rows[row][column] == 0:  # an entry in the wrong column leaves its own empty
            where = rows[row].index(Fraction(printed))
            rows[row][where] = Fraction(0)
        rows[row][column] = Fraction(printed)
        with pytest.raises(TableauError, match="misprint"):
            replace(tableau, **{table: tuple(map(tuple, rows))})


@pytest.mark.parametrize("name", NYSTROM)
def test_any_wrong_coefficient_is_refused_even_where_row_sums_hide_it(name):
    tableau, wrong = NYSTROM[name].TABLEAU, Fraction("1e-20")
    for table in ("velocity", "position"):
        for i, line in enumerate(getattr(tableau, table)):
            if len(line) < 3 or (table, i, len(line)) == ("position", 0, 0):
                continue
            rows = [list(row) for row in getattr(tableau, table)]
            rows[i][0] += wrong
            rows[i][2] -= wrong
            with pytest.raises(TableauError):
                replace(tableau, **{table: tuple(map(tuple, rows))})
    for table in ("velocity_weights", "position_weights"):
        for i in range(len(tableau.c)):
            weights = list(getattr(tableau, table))
            weights[i] += wrong
            with pytest.raises(TableauError):
                replace(tableau, **{table: tuple(weights)})


@pytest.mark.parametrize("name", NYSTROM)
def test_a_nystrom_tableau_has_no_higher_order_than_it_claims(name):
    tableau = NYSTROM[name].TABLEAU
    with pytest.raises(TableauError) as caught:
        replace(tableau, order=tableau.order + 1)
    assert caught.value.order == tableau.order + 1


def test_a_runge_kutta_tableau_is_checked_by_the_same_trees():
    replace(rk4.TABLEAU, b=fractions("1/6", "1/3", "1/3", "1/6"))
    with pytest.raises(TableauError):
        replace(rk4.TABLEAU, b=fractions("1/6", "1/6", "1/2", "1/6"))
    with pytest.raises(TableauError):
        replace(rk4.TABLEAU, order=5)
    with pytest.raises(TableauError):
        Tableau(
            "3/8 rule with a sign lost",
            4,
            triangle("", "1/3", "1/3 1", "1 -1 1"),
            fractions("1/8", "3/8", "3/8", "1/8"),
        )
    Tableau("3/8 rule", 4, triangle("", "1/3", "-1/3 1", "1 -1 1"), fractions("1/8", "3/8", "3/8", "1/8"))


def test_there_are_as_many_rooted_trees_as_cayley_counted():
    assert [len(trees(order, second=False)) for order in range(1, 8)] == [1, 1, 2, 4, 9, 20, 48]


@pytest.mark.parametrize("stages", [1, 2, 3, 8])
def test_gauss_legendre_collocates_at_the_nodes_of_the_quadrature(stages):
    method = gauss_legendre.gauss(stages)
    nodes, weights = np.polynomial.legendre.leggauss(stages)
    c = (nodes + 1) / 2
    np.testing.assert_allclose(method.b, weights / 2, atol=1e-15)
    for power in range(stages):  # exact for polynomials of lower degree, within the step and ahead of it
        np.testing.assert_allclose(method.a @ c**power, c ** (power + 1) / (power + 1), atol=1e-14)
        np.testing.assert_allclose(method.ahead @ c**power, (1 + c) ** power, rtol=1e-9)
    m = method.b[:, None] * method.a + method.b[None, :] * method.a.T - np.outer(method.b, method.b)
    np.testing.assert_allclose(m, 0, atol=1e-15)  # the condition for quadratic invariants (Cooper 1987)


@needs_numba
def test_the_geometric_methods_stay_on_the_sphere_and_the_others_do_not():
    scene = make_scene(pendulum={"length": "1"}, release={"angle": "170", "azimuth": "20"}, inputs="binary64")
    off = {}
    for name, formulation, step in (
        ("gauss_legendre", "momentum", 0.1),
        ("rkmk4", "momentum", 0.05),
        ("rk4", "spin", 0.05),
    ):
        problem = Problem.of(scene, formulation, [0.0, 100.0, 200.0])
        states = METHODS[name].prepare(problem, step)().states
        off[name] = abs(np.linalg.norm(states[:, :3], axis=1) - 1).max()
    assert off["gauss_legendre"] < 1e-14
    assert off["rkmk4"] < 1e-13
    assert off["rk4"] > 1e-9


@needs_numba
def test_gauss_legendre_keeps_the_energy_whatever_the_step_because_it_is_quadratic_in_momentum():
    """h = v²/2 + g z - Ω²/2 (x² + q²) is H²/2 - H·Ω - n·c there, up to constants of the motion."""
    scene = make_scene(
        inputs="binary64",
        pendulum={"length": "1"},
        site={"rotation_rate": "0.3", "equatorial_radius": "0"},
        release={"angle": "80", "azimuth": "20"},
    )
    problem = Problem.of(scene, "momentum", np.linspace(0, 2000, 401))
    k = problem.constants

    def run(prepare, step):
        x, y, z, *v = states = prepare(problem, step)().states.T
        q = k.cos * z - k.sin * y
        h = sum(part * part for part in v) / 2 + k.gravity * z - k.rate**2 / 2 * (x * x + q * q)
        return states.T, np.abs(h - h[0])

    coarse, gauss = run(lambda problem, step: gauss_legendre.prepare(problem, step, 2), 0.1)
    fine, _ = run(gauss_legendre.prepare, 0.1)
    _, classical = run(METHODS["rk4"].prepare, 0.01)
    assert np.abs(coarse - fine)[:, :3].max() > 0.1  # a step so long that the bob is elsewhere
    assert gauss.max() < 1e-12  # 20,000 steps, each rounded
    assert classical.max() > 1e-6
