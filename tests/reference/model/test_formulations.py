"""The model: all formulations are the same system, and it is the Lagrangian's."""

from __future__ import annotations

import random

import heyoka as hy
import numpy as np
import pytest
from sampled import one_in
from small_scenes import make_scene, model_at

from reference.engines.heyoka.conversions import Numbers
from reference.engines.heyoka.system import system_of
from reference.model.algebra import cross, dot, minus, plus, product
from reference.model.carried import carried, constant_variables
from reference.model.constants import Constants, axis_distance, constants
from reference.model.force import acceleration, energy, force, invariant, rest_position, tension
from reference.model.formulations import FORMULATIONS
from reference.model.start import Start, release
from reference.numbers.precision import context, real

PREC = 400  # bits; 60 digits need 200


def random_scene(seed: int, below: bool = True):
    """Every term large: Ω of order 1, an Earth of a few metres, drag, fast motion."""
    draw = random.Random(seed)

    def number(low: float, high: float) -> str:
        return repr(round(draw.uniform(low, high), 9))

    return make_scene(
        pendulum={"length": number(0.5, 3), "drag": number(0.1, 1)},
        site={
            "latitude": number(-89, 89),
            "altitude": number(0, 2),
            "gravity": number(1, 12),
            "rotation_rate": number(-2, 2),
            "equatorial_radius": number(1, 9),
            "inverse_flattening": number(3, 9),
            "gravity_is": "effective" if seed % 4 == 3 else "ellipsoid",
        },
        release={
            "angle": number(5, 85) if below else number(95, 175),
            "azimuth": number(-180, 180),
            "angle_rate": number(-90, 90),
            "azimuth_rate": number(-90, 90),
        },
    )


def acceleration_of(name: str, ctx, k, n, v):
    """n'' of a formulation: the derivative of its cartesian velocity along its own flow."""
    model = FORMULATIONS[name]
    state = model.start(n, v, k, ctx)
    rates = lagrangian_rates(state, k) if name == "lagrangian" else model.derivatives(state, k, ctx)
    step = ctx.mpf(2) ** (-PREC // 3)
    ahead, behind = (
        model.cartesian([s + sign * step * r for s, r in zip(state, rates, strict=True)], k, ctx)[1]
        for sign in (1, -1)
    )
    return [(a - b) / (2 * step) for a, b in zip(ahead, behind, strict=True)]


def lagrangian_rates(state, k):
    """heyoka's own Euler-Lagrange equations, evaluated in `real`."""
    numbers = Numbers(real(PREC))
    equations, _ = system_of(FORMULATIONS["lagrangian"], k.converted(numbers.of))
    names, rates = zip(*equations, strict=True)
    compiled = hy.cfunc(list(rates), list(names), fp_type=hy.real, prec=PREC)
    values = compiled(np.array([numbers.of(s) for s in state], dtype=hy.real))
    ctx = context(PREC)
    return [ctx.mpf(whole) / ctx.mpf(2) ** 1000 for whole in numbers.fixed(values, 1000)]


# in every run with effective gravity; above the horizontal with the ellipsoid's
@pytest.mark.parametrize("seed", one_in(20, reversed(range(20))))
def test_all_formulations_agree_to_sixty_digits_where_all_terms_are_large(seed):
    ctx, k, n, v = model_at(random_scene(seed), PREC)
    expected = acceleration(n, v, k)
    for name in FORMULATIONS:
        got = acceleration_of(name, ctx, k, n, v)
        assert max(abs(a - b) for a, b in zip(got, expected, strict=True)) < ctx.mpf(10) ** -60, (
            name
        )


def test_effective_gravity_leaves_the_centrifugal_force_of_the_swing_alone():
    """F = -g ẑ - Ω × (Ω × r) - 2 Ω × v - γ v, from the scene's own numbers and r from the pivot."""
    scene = random_scene(7)
    ctx, k, n, v = model_at(scene, PREC)
    rate, gravity, length, drag = (
        ctx.mpf(value.numerator) / value.denominator
        for value in (
            scene.exact.rotation_rate,
            scene.exact.gravity,
            scene.exact.length,
            scene.exact.drag,
        )
    )
    latitude = (
        ctx.mpf(scene.exact.latitude.numerator) / scene.exact.latitude.denominator * ctx.pi / 180
    )
    turn = (0, rate * ctx.cos(latitude), rate * ctx.sin(latitude))
    away, sideways = cross(turn, cross(turn, n)), cross(turn, v)
    for i, got in enumerate(force(n, v, k)):
        expected = -away[i] - 2 * sideways[i] - drag * v[i] - (gravity / length if i == 2 else 0)
        assert abs(got - expected) < ctx.mpf(10) ** -100
    assert scene.site.gravity_is == "effective"


@pytest.mark.parametrize("seed", one_in(5, range(5)))
def test_above_the_horizontal_all_but_the_plane_form_agree(seed):
    ctx, k, n, v = model_at(random_scene(seed, below=False), PREC)
    expected = acceleration(n, v, k)
    for name in FORMULATIONS.keys() - {"plane"}:
        got = acceleration_of(name, ctx, k, n, v)
        assert max(abs(a - b) for a, b in zip(got, expected, strict=True)) < ctx.mpf(10) ** -60, (
            name
        )


@pytest.mark.parametrize("name", one_in(4, ["momentum", "space", "spin", "plane", "angles"]))
def test_the_heyoka_expression_and_the_mpmath_evaluation_are_the_same_code(name):
    ctx, k, n, v = model_at(random_scene(3), PREC)
    numbers, model = Numbers(real(PREC)), FORMULATIONS[name]
    equations, _ = system_of(model, k.converted(numbers.of))
    state = model.start(n, v, k, ctx)
    names, rates = zip(*equations, strict=True)
    compiled = hy.cfunc(list(rates), list(names), fp_type=hy.real, prec=PREC)
    got = numbers.fixed(compiled(np.array([numbers.of(s) for s in state], dtype=hy.real)), 600)
    for whole, expected in zip(got, model.derivatives(state, k, ctx), strict=True):
        assert abs(ctx.mpf(whole) / ctx.mpf(2) ** 600 - expected) < ctx.mpf(10) ** -110


@pytest.mark.parametrize("seed", range(5))
def test_the_force_is_newtons_law_in_axes_fixed_in_space(seed):
    """Position in the inertial frame (9), differentiated twice, is gravity along e_U plus the pull of the cord."""
    ctx, k, n, v = model_at(random_scene(seed).with_values(["pendulum.drag=0"]), PREC)
    a = acceleration(n, v, k)
    step = ctx.mpf(2) ** (-PREC // 4)

    def inertial(t):
        n_t = [p + q * t + r * t * t / 2 for p, q, r in zip(n, v, a, strict=True)]
        sin_t, cos_t = ctx.sin(k.rate * t), ctx.cos(k.rate * t)
        out = k.axis_distance - k.sin * n_t[1] + k.cos * n_t[2]
        return (
            -sin_t * n_t[0] + cos_t * out,
            cos_t * n_t[0] + sin_t * out,
            k.cos * n_t[1] + k.sin * n_t[2],
        )

    second = [
        (p - 2 * q + r) / step**2
        for p, q, r in zip(inertial(step), inertial(0), inertial(-step), strict=True)
    ]
    up, north, east = (k.cos, 0, k.sin), (-k.sin, 0, k.cos), (0, 1, 0)
    rest = [s + k.gravity * u for s, u in zip(second, up, strict=True)]
    local = [dot(rest, axis) for axis in (east, north, up)]
    assert max(map(abs, cross(local, n))) < ctx.mpf(10) ** -50


@pytest.mark.parametrize("seed", range(5))
def test_the_invariant_does_not_change_along_the_flow_without_drag(seed):
    ctx, k, n, v = model_at(random_scene(seed).with_values(["pendulum.drag=0"]), PREC)
    a = acceleration(n, v, k)
    step = ctx.mpf(2) ** (-PREC // 3)

    def shifted(sign):
        return invariant(
            [p + sign * step * q for p, q in zip(n, v, strict=True)],
            [p + sign * step * q for p, q in zip(v, a, strict=True)],
            k,
        )

    assert abs(shifted(1) - shifted(-1)) / (2 * step) < ctx.mpf(10) ** -60


@pytest.mark.parametrize("seed", range(5))
def test_the_energy_is_the_invariant_without_what_the_axis_is_away(seed):
    _, k, n, v = model_at(random_scene(seed), PREC)
    at_the_axis = (k.rate * k.axis_distance * k.length) ** 2 / 2
    assert abs(energy(n, v, k) - invariant(n, v, k) - at_the_axis) < 1e-60 * max(1, at_the_axis)


def test_with_drag_the_invariant_falls_by_the_work_of_the_drag():
    ctx, k, n, v = model_at(random_scene(1), PREC)
    a = acceleration(n, v, k)
    step = ctx.mpf(2) ** (-PREC // 3)
    ahead, behind = (
        invariant(
            [p + s * q for p, q in zip(n, v, strict=True)],
            [p + s * q for p, q in zip(v, a, strict=True)],
            k,
        )
        for s in (step, -step)
    )
    work = -k.drag * dot(v, v) * k.length**2
    assert abs((ahead - behind) / (2 * step) - work) < ctx.mpf(10) ** -60


def test_the_acceleration_keeps_the_bob_on_the_sphere():
    _, k, n, v = model_at(random_scene(2), PREC)
    assert abs(dot(n, acceleration(n, v, k)) + dot(v, v)) < 1e-100
    assert tension(n, v, k) == plus(dot(v, v), dot(n, force(n, v, k)))


@pytest.mark.parametrize("latitude", ["48.846111", "-33.9", "89", "0.01", "90", "0", "-90"])
def test_at_the_rest_position_nothing_moves_and_mathars_equation_46_holds(latitude):
    ctx, k, _, _ = model_at(make_scene(site={"latitude": latitude}), 300)
    n = rest_position(k, ctx)
    assert max(abs(part) for part in acceleration(n, (0, 0, 0), k)) < ctx.mpf(10) ** -80
    phi, lat = ctx.atan2(abs(n[1]), -n[2]), ctx.asin(k.sin)
    side = -1 if k.sin > 0 else 1  # the sign of λ is the opposite of the latitude's
    arm, square = k.axis_distance, k.rate**2
    terms = side * arm * square * ctx.sin(lat - side * phi)
    terms += -side * square * ctx.cos(lat - side * phi) * ctx.sin(lat - side * phi)
    assert abs(terms + k.gravity * ctx.sin(phi)) < ctx.mpf(10) ** -75
    assert n[1] * side >= 0


@pytest.mark.parametrize("site", [{"rotation_rate": "0"}, {"latitude": "90"}])
def test_without_a_force_at_the_pivot_no_rest_position_is_singled_out(site):
    ctx, k, _, _ = model_at(make_scene(site={"gravity": "0", **site}), 100)
    assert not any(k.pull)
    with pytest.raises(ValueError, match="no force acts at the pivot"):
        rest_position(k, ctx)


@pytest.mark.parametrize(("length", "stable"), [("1e9", True), ("1e12", False)])
def test_a_rotation_so_fast_that_the_bob_would_leave_singles_out_no_rest_position(length, stable):
    """At rest the energy is least: against the neighbours on the meridian."""
    ctx, k, _, _ = model_at(make_scene(pendulum={"length": length}), 100)
    if not stable:
        with pytest.raises(ValueError, match="rotation is too fast"):
            rest_position(k, ctx)
        return
    rest = rest_position(k, ctx)
    angle = ctx.atan2(rest[1], -rest[2])
    here, *beside = (
        energy((0, ctx.sin(angle + off), -ctx.cos(angle + off)), (0, 0, 0), k)
        for off in (0, -1e-3, 1e-3)
    )
    assert here < min(beside)


def test_exact_zeros_drop_out_of_sums_and_products():
    assert product(0, "never touched") == 0
    assert plus(0, 3, 0) == 3
    assert minus(0, 2) == -2
    assert minus(2, 0) == 2
    assert cross((0, 0, 1), (0, 0, 5)) == (0, 0, 0)


@pytest.mark.parametrize(
    ("sections", "zeros"),
    [
        ({"rotation_rate": "0"}, {"turn", "pull_y", "centrifugal"}),
        ({"latitude": "90"}, {"turn_y", "pull_y"}),
        ({"latitude": "-90"}, {"turn_y", "pull_y"}),
        ({"latitude": "0"}, {"turn_z", "pull_y"}),
    ],
)
def test_a_vanishing_constant_is_exactly_zero(sections, zeros):
    _, k, _, _ = model_at(make_scene(site=sections), 100)
    seen = {"turn_y": k.turn[1], "turn_z": k.turn[2], "pull_y": k.pull[1]}
    seen |= {"turn": max(map(abs, k.turn)), "centrifugal": max(map(abs, k.centrifugal))}
    assert {name for name, value in seen.items() if isinstance(value, int) and value == 0} >= zeros


def test_constants_are_their_entries_and_exact_zeros():
    _, k, _, _ = model_at(make_scene(site={"latitude": "90"}), 100)
    assert k.entries("turn", "pull", "drag") == {"turn_2": k.turn[2], "pull_2": k.pull[2]}
    names = {
        "length",
        "turn_2",
        "pull_2",
        "centrifugal_0",
        "centrifugal_1",
        "gravity",
        "rate",
        "sin",
    }
    assert set(k.entries()) == names
    assert Constants.of(k.entries()) == k
    assert Constants.of({"turn_1": 3, "drag": 2}) == Constants(turn=(0, 3, 0), drag=2)


def test_the_distance_from_the_axis_is_wgs84s_prime_vertical_radius():
    """N at 45 degrees on WGS84 is 6388838.290 m (geodesy tables)."""
    ctx = context(100)
    half = ctx.sqrt(ctx.mpf(1) / 2)
    distance = axis_distance(
        ctx.mpf(6378137), 1 / ctx.mpf("298.257223563"), 0, half, half, ctx.sqrt
    )
    assert abs(distance / half - ctx.mpf("6388838.290")) < 5e-4


def test_a_release_by_angles_is_the_release_by_coordinates():
    scene = make_scene(
        release={"angle": "30", "azimuth": "90", "angle_rate": "10", "azimuth_rate": "20"}
    )
    ctx = context(200)
    (x, y, z), (vx, vy, vz) = release(scene.exact, ctx)
    assert x == 0
    assert abs(y - 67 / ctx.mpf(2)) < 1e-50
    assert abs(z + 67 * ctx.sqrt(3) / 2) < 1e-50
    assert abs(vx + ctx.radians(20) * 67 / 2) < 1e-50
    assert abs(x * vx + y * vy + z * vz) < 1e-50
    assert constants(scene.exact, ctx).length == 67


def test_forms_that_do_not_reach_a_state_refuse_it():
    ctx, k, n, v = model_at(make_scene(release={"angle": "120", "azimuth": "0"}), 100)
    with pytest.raises(ValueError, match="below"):
        FORMULATIONS["plane"].start(n, v, k, ctx)
    down = (ctx.mpf(0), ctx.mpf(0), ctx.mpf(-1))
    with pytest.raises(ValueError, match="vertical"):
        FORMULATIONS["angles"].start(down, (0, 0, 0), k, ctx)


@pytest.mark.parametrize(
    ("site", "name", "expected"),
    [
        ({}, "momentum", []),
        ({"latitude": "90"}, "momentum", ["Hz"]),
        ({"latitude": "-90"}, "momentum", ["Hz"]),
        ({"rotation_rate": "0"}, "momentum", ["Hz"]),
        ({"rotation_rate": "0", "gravity": "0"}, "momentum", ["Hx", "Hy", "Hz"]),
        ({"latitude": "90"}, "inertial", []),
        ({"latitude": "90"}, "spin", []),
        ({"latitude": "90"}, "angles", []),
    ],
)
def test_a_variable_whose_rate_is_exactly_zero_is_not_carried(site, name, expected):
    start = start_of(make_scene(site=site))
    whole = FORMULATIONS[name]
    assert constant_variables(whole, start.k) == expected
    less = carried(whole, start, start.ctx.mpf)
    assert less.variables == tuple(one for one in whole.variables if one not in expected)
    state, full = start.state(less), start.state(whole)
    assert len(state) == len(less.variables)
    assert less.cartesian(state, start.k, start.ctx) == whole.cartesian(full, start.k, start.ctx)
    rates = dict(zip(whole.variables, whole.derivatives(full, start.k, start.ctx), strict=True))
    assert list(less.derivatives(state, start.k, start.ctx)) == [
        rates[one] for one in less.variables
    ]
    assert [rates[one] for one in expected] == [0] * len(expected)


def test_with_drag_nothing_is_constant():
    assert (
        constant_variables(
            FORMULATIONS["momentum"],
            start_of(make_scene(pendulum={"drag": "1e-9"}, site={"latitude": "90"})).k,
        )
        == []
    )


def start_of(scene):
    return Start.of(scene.exact, PREC)
