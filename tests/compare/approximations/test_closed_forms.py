"""Closed solutions and truncated systems against textbook formulas, other methods and the papers' own equations."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from itertools import pairwise

import mpmath
import numpy as np
import pytest

from compare.approximations import APPROXIMATIONS, motions
from compare.approximations.case import PaperCase
from compare.approximations.gastebois import small_angles
from compare.approximations.linear_3d import plumb_line, stiffness
from compare.approximations.mathar import derivatives, truncated
from compare.approximations.planar import sn_cn
from reference import integrate, load_scene, parse_scene, trajectory
from reference.model.constants import constants
from reference.model.formulations import FORMULATIONS
from reference.numbers.precision import LONG_DOUBLE, context

DAY = np.linspace(0.0, 86400.0, 2001)
PARIS = load_scene("paris")
MOVING = PARIS.with_values(["release.vx=0.05", "release.vy=-0.11"])
CONE = parse_scene(
    {
        "id": "cone",
        "pendulum": {"length": "12.25"},
        "site": {"gravity": "9.8", "rotation_rate": "0"},
        "release": {"x": "7.35", "y": "0", "vy": "-7.35"},
    }
)


def random_state(ctx, rng):
    return tuple(ctx.mpf(rng.uniform(-0.4, 0.4)) for _ in range(4))


def scene_for(word):
    return {"conical": CONE}.get(word, PARIS)


# The truncations of section VI -----------------------------------------------------------------------------------
def test_with_nothing_left_out_the_truncated_equations_are_the_model():
    ctx, rng = context(200), random.Random(1)
    k = constants(PARIS.with_values(["site.rotation_rate=0.3", "pendulum.drag=0.1"]).exact, ctx)
    for _ in range(20):
        state = random_state(ctx, rng)
        expected = FORMULATIONS["plane"].derivatives(state, k, ctx)
        for got, right in zip(derivatives(state, k, ctx), expected, strict=True):
            assert abs(got - right) <= 1e-55 * (1 + abs(right))


def test_all_five_items_leave_the_squares_of_the_diagonal_and_are_not_51_and_52_yet():
    ctx, rng = context(200), random.Random(2)
    items = frozenset({1, 2, 3, 4, 5})
    k = truncated(constants(PARIS.exact, ctx), items)
    gravity, turn = k.gravity, k.turn[2]
    for _ in range(5):
        x, y, vx, vy = random_state(ctx, rng)
        _, _, ax, ay = derivatives((x, y, vx, vy), k, ctx, items)
        assert abs(ax - (1 + y**2) * (-gravity * x + 2 * turn * vy)) < 1e-55
        assert abs(ay - (1 + x**2) * (-gravity * y - 2 * turn * vx)) < 1e-55


@pytest.mark.parametrize("item", [1, 2, 3, 4, 5])
def test_each_item_changes_the_equations_only_where_it_says(item):
    # Item 1 vanishes with Ω² terms, 2 and 5 with x y and z - l at the origin, 3 with the velocity, 4 with cos φ.
    ctx = context(100)
    scene = PARIS.with_values(["site.rotation_rate=0.01"])
    k = constants(scene.exact, ctx)
    if item == 1:
        k = replace(k, pull=(0, 0, -k.gravity), centrifugal=(0, 0, 0, 0))
    if item == 4:
        k = replace(k, turn=(0, 0, k.turn[2]))
    x, y, vx, vy = (ctx.mpf(v) for v in (0.1, 0.2, 0.03, -0.07))
    if item in (2, 5):
        x = y = ctx.zero
    if item == 3:
        vx = vy = ctx.zero
    state, items = (x, y, vx, vy), frozenset({item})
    assert derivatives(state, truncated(k, items), ctx, items) == pytest.approx(
        derivatives(state, k, ctx), abs=1e-25
    )


# Harmonic pendulum on a turntable --------------------------------------------------------------------------------
@pytest.mark.parametrize("word", ["method_1", "method_2", "method_3"])
def test_the_three_methods_are_one_motion(word):
    expected = APPROXIMATIONS["linear_g"].trajectory(MOVING, DAY)
    assert np.max(np.abs(APPROXIMATIONS[word].trajectory(MOVING, DAY) - expected)) < 3e-11


def test_the_solution_6_1_solves_the_system_of_section_5():
    case = PaperCase.of_scene(MOVING)
    (omega, turn), plumb = small_angles(case), case.plumb
    square, turning = float(omega**2 - turn**2), float(turn)
    place, speed = plumb.inward(case.position), plumb.inward(case.velocity)

    def section_5(state, functions):
        x, y, vx, vy = state
        return vx, vy, -square * x + 2 * turning * vy, -square * y - 2 * turning * vx

    states = integrate(("x", "y", "vx", "vy"), section_5, (*place[:2], *speed[:2]), DAY)
    rows = APPROXIMATIONS["gastebois_6_1"].trajectory(MOVING, DAY)
    along = np.column_stack(
        [np.asarray(part, dtype=float) for part in plumb.inward(tuple(rows.T[:3]))]
    )
    assert np.max(np.abs(along[:, :2] - states[:, :2])) < 1e-10


def test_6_3_is_6_1_for_a_release_at_rest():
    general, released = (APPROXIMATIONS[f"gastebois_6_{i}"].trajectory(PARIS, DAY) for i in (1, 3))
    assert np.max(np.abs(general - released)) < 1e-11


def test_6_2_is_6_1_for_its_own_launch():
    # On the axis nothing is tilted: launched to the south with r0 Ωz.
    scene = parse_scene(
        {
            "id": "launch",
            "site": {"equatorial_radius": "0", "latitude": "30", "rotation_rate": "1e-4"},
            "release": {"x": "0.5", "y": "0", "vy": "-2.5e-5"},
        }
    )
    general, simple = (APPROXIMATIONS[f"gastebois_6_{i}"].trajectory(scene, DAY) for i in (1, 2))
    assert np.max(np.abs(general - simple)) < 1e-11
    # It swings through the plumb line in a plane that turns at -Ωz.
    slowly = np.exp(1j * 5e-5 * DAY) * (simple[:, 0] + 1j * simple[:, 1])
    assert np.max(np.abs(slowly.imag)) < 1e-11


# Any amplitude in uniform apparent gravity ---------------------------------------------------------------------------
def test_his_general_system_is_that_of_the_angles_of_7_2():
    scene = PARIS.with_values(
        ["release.x=20", "release.y=-9", "release.vx=2", "release.vy=6", "site.rotation_rate=0.002"]
    )
    case = PaperCase.of_scene(scene)
    plumb = case.plumb
    (x, y, z), (vx, vy, vz) = plumb.inward(case.position), plumb.inward(case.velocity)
    aside = case.ctx.hypot(x, y)
    start = (
        case.ctx.atan2(aside, -z),
        case.ctx.atan2(y, x),
        vz / aside,
        (x * vy - y * vx) / aside**2,
    )
    fall, rate, latitude = (
        float(v) for v in (case.apparent_gravity / case.length, case.k.rate, case.apparent_latitude)
    )

    def section_7_2(state, functions):
        theta, phi, theta_rate, phi_rate = state
        sine, cosine = functions.sin(theta), functions.cos(theta)
        felt = cosine * math.sin(latitude) - sine * functions.sin(phi) * math.cos(latitude)
        return (
            theta_rate,
            phi_rate,
            -fall * sine + sine * cosine * phi_rate * phi_rate + 2 * sine * felt * rate * phi_rate,
            (-2 * cosine * theta_rate * phi_rate - 2 * felt * rate * theta_rate) / sine,
        )

    times = np.linspace(0.0, 600.0, 301)
    theta, phi, _, _ = integrate(
        ("theta", "phi", "theta_rate", "phi_rate"), section_7_2, start, times
    ).T
    rows = APPROXIMATIONS["gastebois_general"].trajectory(scene, times)
    along = plumb.inward(tuple(rows.T[:3]))
    expected = 67 * np.array(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), -np.cos(theta)]
    )
    assert (
        np.max(np.abs(np.array([np.asarray(part, dtype=float) for part in along]) - expected))
        < 1e-10
    )


# Plane, cone, and the linear system --------------------------------------------------------------------------------
@pytest.mark.parametrize("modulus", ["1e-6", "0.1", "0.7", "0.999"])
def test_the_fourier_series_are_jacobis_functions(modulus):
    ctx = context(100)
    k = ctx.mpf(modulus)
    u = np.linspace(-7.0, 30.0, 41)
    sn, cn = sn_cn(u, k, ctx)
    for i, at in enumerate(u):
        assert sn[i] == pytest.approx(float(k * ctx.ellipfun("sn", ctx.mpf(at), m=k**2)), abs=2e-15)
        assert cn[i] == pytest.approx(float(k * ctx.ellipfun("cn", ctx.mpf(at), m=k**2)), abs=2e-15)


@pytest.mark.parametrize("angle", ["5", "89", "135", "179"])
def test_the_plane_pendulum_is_the_reference_without_rotation_at_any_amplitude(angle):
    scene = parse_scene(
        {
            "id": "plane",
            "site": {"rotation_rate": "0"},
            "release": {"angle": angle, "azimuth": "127"},
        }
    )
    times = np.linspace(0.0, 200.0, 401)
    # near the top a rounding grows by four decades
    truth = trajectory(scene, times, number=LONG_DOUBLE)
    assert np.max(np.abs(APPROXIMATIONS["planar"].trajectory(scene, times) - truth)) < 1e-10


def test_the_conical_pendulum_goes_round_either_way():
    times = np.linspace(0.0, 100.0, 201)
    rows = APPROXIMATIONS["conical"].trajectory(CONE, times)
    assert np.allclose(rows[:, 0], 7.35 * np.cos(times), atol=1e-12)
    assert np.allclose(rows[:, 1], -7.35 * np.sin(times), atol=1e-12)
    assert np.max(np.abs(rows - trajectory(CONE, times))) < 1e-11


def test_the_linear_solution_is_the_exponential_of_its_matrix():
    scene = MOVING.with_values(
        ["site.equatorial_radius=500", "site.rotation_rate=0.05", "release.x=0.1"]
    )
    case = PaperCase.of_scene(scene)
    a, b, turn = stiffness(case)
    plumb = plumb_line(case)
    start = [*plumb.inward(case.position)[:2], *plumb.inward(case.velocity)[:2]]
    ctx = case.ctx
    matrix = ctx.matrix([[0, 0, 1, 0], [0, 0, 0, 1], [-a, 0, 0, 2 * turn], [0, -b, -2 * turn, 0]])
    times = np.array([0.0, 3.0, 70.0])
    rows = APPROXIMATIONS["linear_3d"].trajectory(scene, times)
    for t, row in zip(times, rows, strict=True):
        x, y, vx, vy = ctx.expm(matrix * ctx.mpf(t)) * ctx.matrix(start)
        got = plumb.inward(tuple(row[:3])), plumb.inward(tuple(row[3:]))
        assert [float(got[0][0] - x), float(got[0][1] - y)] == pytest.approx([0, 0], abs=1e-13)
        assert [float(got[1][0] - vx), float(got[1][1] - vy)] == pytest.approx([0, 0], abs=1e-13)


def test_the_linear_system_is_the_derivative_of_the_model_at_its_point_of_rest():
    case = PaperCase.of_scene(
        MOVING.with_values(["site.rotation_rate=0.02", "site.equatorial_radius=3000"])
    )
    ctx = case.ctx
    a, b, turn = stiffness(case)
    plumb, rest = plumb_line(case), case.rest
    axes = ((1, 0, 0), (0, plumb.cos, plumb.sin))
    tiny = ctx.mpf(10) ** -25

    def felt(place, speed):
        rates = FORMULATIONS["space"].derivatives((*place, *speed), case.k, ctx)[3:]
        return plumb.inward(rates)[:2]

    for axis, stiff in zip(axes, ((-a, 0), (0, -b)), strict=True):
        moved = felt(tuple(r + tiny * e for r, e in zip(rest, axis, strict=True)), (0, 0, 0))
        assert [float(part / tiny) for part in moved] == pytest.approx(
            [float(s) for s in stiff], abs=1e-18
        )
    pushed = felt(rest, tuple(tiny * e for e in axes[1]))
    assert float(pushed[0] / tiny) == pytest.approx(float(2 * turn), rel=1e-15)


def test_at_the_pole_the_linear_frequencies_are_those_of_a_turntable():
    a, b, turn = stiffness(PaperCase.of_scene(load_scene("pole")))
    rate = mpmath.mpf("7.292115e-5")
    assert float(turn) == pytest.approx(float(rate), rel=1e-15)
    assert (
        float(a)
        == float(b)
        == pytest.approx(float(mpmath.mpf("9.80665") / 67 - rate**2), rel=1e-15)
    )


# What every motion keeps ---------------------------------------------------------------------------------------------
@pytest.mark.parametrize("word", motions())
def test_a_motion_starts_at_the_release_stays_on_the_sphere_and_moves_with_its_velocity(word):
    scene = scene_for(word)
    step, times = 2e-3, np.array([0.0, 1.7, 40.0, 333.0])
    around = np.unique(np.concatenate([times[1:] + shift * step for shift in (-2, -1, 1, 2)]))
    every = np.unique(np.concatenate((times, around)))
    rows = dict(zip(every.tolist(), APPROXIMATIONS[word].trajectory(scene, every), strict=True))
    length = float(scene.exact.length)
    truth = trajectory(scene, [0.0])[0]
    assert rows[0.0][:3] == pytest.approx(truth[:3], abs=1e-13)
    if word != "gastebois_6_2":  # launched with a velocity of its own
        assert rows[0.0][3:] == pytest.approx(truth[3:], abs=1e-13)
    for row in rows.values():
        assert np.linalg.norm(row[:3]) == pytest.approx(length, rel=1e-14)
        assert row[:3] @ row[3:] == pytest.approx(0, abs=1e-11)
    for t in times[1:]:
        before2, before, after, after2 = (
            rows[min(rows, key=lambda s: abs(s - t - n * step))][:3] for n in (-2, -1, 1, 2)
        )
        slope = (8 * (after - before) - (after2 - before2)) / (12 * step)
        assert slope == pytest.approx(rows[float(t)][3:], abs=2e-10)


@pytest.mark.parametrize("word", motions())
def test_rows_do_not_depend_on_which_other_times_are_asked_for(word):
    scene = scene_for(word)
    rows = APPROXIMATIONS[word].trajectory(scene, [0.0, 5.0, 300.0])
    assert APPROXIMATIONS[word].trajectory(scene, [300.0])[0] == pytest.approx(rows[2], abs=1e-11)


def test_the_sense_of_rotation_follows_the_hemisphere():
    for scene, sense in ((load_scene("paris"), -1), (load_scene("southern"), 1)):
        for word in ("linear_recentred", "gastebois_6_1", "linear_3d", "gastebois_general"):
            rows = APPROXIMATIONS[word].trajectory(scene, np.linspace(0.0, 7200.0, 4001))
            north = float(PaperCase.of_scene(scene).rest[1] * 67)
            far = np.argsort(-np.hypot(rows[:, 0], rows[:, 1] - north))[:200]
            azimuth = (
                np.unwrap(2 * np.arctan2(rows[far, 1] - north, rows[far, 0])[np.argsort(far)]) / 2
            )
            assert np.sign(azimuth[-1] - azimuth[0]) == sense
            assert all(b * sense >= a * sense - 1e-2 for a, b in pairwise(azimuth))
