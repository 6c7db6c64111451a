"""Straight-line code: the same numbers as the generic function, nothing twice, nothing that is zero."""

from __future__ import annotations

import doctest
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from method_cases import python_function
from small_scenes import make_scene

import compare.methods.rhs.tracing
from compare.methods.rhs.problem import FirstOrderSystem, Problem
from compare.methods.rhs.tracing import TracingError, differentiated, record
from reference import InputError, load_scene
from reference.model.constants import constants, constants_in_double
from reference.model.formulations import FORMULATIONS
from reference.numbers.precision import context

TRACED = ["momentum", "space", "spin", "plane", "angles"]


def problem(formulation, **sections):
    return Problem.of(make_scene(**sections), formulation, [0.0, 1.0])


def test_the_example_in_the_module_runs():
    assert doctest.testmod(compare.methods.rhs.tracing).failed == 0


@pytest.mark.parametrize("formulation", TRACED)
def test_traced_code_gives_the_bits_of_the_model_evaluated_in_doubles(formulation):
    example = problem(formulation, pendulum={"drag": "0.1"}, site={"rotation_rate": "0.05"})
    state = example.start + 0.01 * np.arange(1, len(example.start) + 1)
    expected = FORMULATIONS[formulation].derivatives(state.tolist(), example.constants, math)
    values = python_function(example.system.program)(*state.tolist(), *example.parameters.tolist())
    np.testing.assert_allclose(values, expected, rtol=1e-14, atol=1e-18)


def test_an_expression_that_stands_twice_is_computed_once():
    program = record(lambda s, _: (s[0] * s[1] + 1, s[1] * s[0] - 1), ["a", "b"])
    assert [line.operation for line in program.lines] == ["mul", "add", "sub"]


def test_what_no_result_needs_is_left_out():
    def wasteful(state, functions):
        functions.sin(state[0])
        return (state[0],)

    assert record(wasteful, ["a"]).lines == ()


@given(st.floats(allow_nan=False), st.floats(allow_nan=False))
def test_rewritings_change_no_bit(a, b):
    def function(s, _):
        x, y = s
        negated = -x
        return (x + -y, -x + y, x - (-y), -negated, -1 * x, 0 + x, x - 0, 0 - x, 1 * y, x / 1)

    values = python_function(record(function, ["x", "y"]))(a, b)
    expected = (a + -b, -a + b, a - -b, a, -1 * a, a, a, -a, b, a)
    assert all(
        p == q or (math.isnan(p) and math.isnan(q)) for p, q in zip(values, expected, strict=True)
    )


def test_an_exact_zero_drops_out_but_a_double_zero_does_not():
    program = record(lambda s, _: (0 * s[0], s[0] + 0.0), ["a"])
    assert program.outputs[0] == "0.0"
    assert len(program.lines) == 1


def test_fractions_become_the_nearest_double():
    assert "* 0.3333333333333333\n" in record(lambda s, _: (Fraction(1, 3) * s[0],), ["a"]).source(
        "f"
    )


@pytest.mark.parametrize(
    "function",
    [
        lambda s, _: (abs(s[0]),),
        lambda s, _: (s[0] if s[0] > 0 else -s[0],),
        lambda s, _: (s[0] or 1,),
        lambda s, _: (s[0] ** 0.5,),
        lambda s, _: (s[0] + "1",),
        lambda s, _: (math.sin(s[0]),),
    ],
)
def test_what_cannot_be_straight_line_code_is_refused(function):
    with pytest.raises(TracingError):
        record(function, ["a"])


def test_a_function_that_straight_line_code_does_not_have_is_named():
    with pytest.raises(AttributeError, match="'tan'"):
        record(lambda s, f: (f.tan(s[0]),), ["a"])


@pytest.mark.parametrize("formulation", TRACED)
def test_the_jacobian_is_the_derivative_of_the_rates(formulation):
    example = problem(formulation, pendulum={"drag": "0.1"}, site={"rotation_rate": "0.05"})
    at = (example.start + 0.05 * np.arange(1, len(example.start) + 1)).tolist()
    rates, slopes = (
        python_function(example.system.program),
        python_function(example.system.jacobian),
    )
    k, step = example.parameters.tolist(), 1e-6
    values = np.array(slopes(*at, *k)).reshape(len(at), len(at))
    for i in range(len(at)):
        ahead, behind = (
            [x + (sign * step if j == i else 0) for j, x in enumerate(at)] for sign in (1, -1)
        )
        slope = (np.array(rates(*ahead, *k)) - np.array(rates(*behind, *k))) / (2 * step)
        np.testing.assert_allclose(values[:, i], slope, rtol=1e-7, atol=1e-8)


def test_every_operation_has_its_derivative():
    def function(s, f):
        x, y = s
        return (f.atan2(y, x), f.sqrt(x) / y, f.sin(x) * f.cos(y), -x - y, x**3)

    slopes = python_function(differentiated(record(function, ["x", "y"]), ["x", "y"]))(0.7, 1.3)
    s2 = 0.7**2 + 1.3**2
    expected = [-1.3 / s2, 0.7 / s2, 0.5 / math.sqrt(0.7) / 1.3, -math.sqrt(0.7) / 1.69]
    expected += [math.cos(0.7) * math.cos(1.3), -math.sin(0.7) * math.sin(1.3), -1, -1, 3 * 0.49, 0]
    np.testing.assert_allclose(slopes, expected, rtol=1e-14)


def test_constants_that_a_scene_does_not_have_are_no_parameters():
    everything = problem("space", pendulum={"drag": "0.1"}).system
    pole = problem("space", site={"latitude": "90"}).system
    still = problem("space", site={"rotation_rate": "0"}).system
    assert {"drag", "turn_1", "turn_2", "pull_1", "pull_2"} <= everything.parameters.keys()
    assert "turn_1" not in pole.parameters
    assert still.parameters.keys() == {"pull_2"}
    assert len(still.program.lines) < len(pole.program.lines) < len(everything.program.lines)


def test_scenes_of_one_kind_share_their_code():
    assert (
        problem("momentum").system.program
        == problem("momentum", site={"latitude": "-33"}).system.program
    )


@pytest.mark.parametrize("scene", ["paris", "pole_near", "equator_near", "weightless", "damped"])
def test_constants_are_rounded_once(scene):
    exact = load_scene(scene).exact
    k = Problem.of(load_scene(scene), "momentum").constants
    assert k == constants_in_double(exact) == constants(exact, context(500)).converted(float)
    assert all(isinstance(value, float) for value in k.entries().values())


def test_a_system_of_somebody_else_is_compiled_too():
    def rates(state, functions, parameters):
        return (state[1], -1 * parameters["k"] * functions.sin(state[0]))

    program = FirstOrderSystem(("x", "v"), rates, {"k": 4.0}).program
    assert python_function(program)(1.0, 2.0, 4.0) == (2.0, -4.0 * math.sin(1.0))


def test_a_state_goes_back_to_metres():
    example = Problem.of(load_scene("paris"), "plane")
    rows = example.cartesian(example.start[None, :])
    np.testing.assert_allclose(rows, [[0.3, 0.4, -math.sqrt(67**2 - 0.25), 0, 0, 0]], rtol=1e-15)


@pytest.mark.parametrize(
    "times", [[], [0.0], [1.0, 2.0], [0.0, 2.0, 1.0], [0.0, math.nan], [0.0, 0.0]]
)
def test_times_that_do_not_increase_from_zero_are_refused(times):
    with pytest.raises(InputError, match="increasing"):
        Problem.of(load_scene("paris"), "plane", times)


def test_a_release_that_a_formulation_cannot_express_is_refused():
    with pytest.raises(InputError, match="below the suspension"):
        Problem.of(make_scene(release={"angle": "120", "azimuth": "0"}), "plane")
