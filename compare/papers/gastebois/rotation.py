"""Gastebois, sections 1 to 4: turning axes, the rotation of the swing plane, apparent gravity."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from reference import load_scene
from reference.model.constants import axis_distance

from ...approximations.case import PaperCase
from ..checks import Answer, Approximate, Check, Identity, PrintedNumber, Statement, over, section
from ..digits import (
    MP,
    Vector,
    atan2,
    cos,
    cross,
    degrees,
    derivative,
    dot,
    mpf,
    norm,
    pi,
    radians,
    shown,
    sin,
    sqrt,
    vector,
)
from ..first_principles import (
    AXIS,
    linearised,
    moving_velocity,
    rate_up,
    rotated,
    turning,
    turning_rates,
)
from ..points import Point, paris, path_in, points, rotation, solved, swing_plane

RATE = mpf("7.292115e-5")  # rad/s, WGS84
SIDEREAL_DAY = 2 * pi / RATE / 3600  # h
EARTH_RADIUS = mpf("6370e3")  # m, as in the paper
GRAVITY = mpf("9.8")  # m/s², as in the paper's 4.1
PANTHEON_LATITUDE = mpf("48.87")
PANTHEON_RELEASE = mpf("6.5")
PANTHEON_LENGTH = mpf("67")
MEAN_RADIUS = mpf("6371008.7714")  # m, NIMA TR8350.2: mean radius of semi-axes


def swing_period(length: Any, r0: Any, gravity: Any, rate: Any) -> tuple[Any, Any]:
    """Return period in s, and turn in rad a period, of a spherical pendulum let go at rest on ground that turns.

    Closed form, in axes that do not turn: l² z'² = 2g (z - z1)(z - z2)(z - z3), z = z1 + (z2 - z1)
    sn², and the azimuth is the elliptic integral of the third kind; z2 is the height of the
    release.
    """
    high = -sqrt(length**2 - r0**2)
    speed = r0 * rate
    energy, momentum = speed**2 / 2 + gravity * high, r0 * speed
    half = (energy / gravity - high) / 2  # z1 and z3 are the roots of z² - 2 half z + product
    product = (momentum**2 / 2 - energy * length**2) / gravity / high
    spread = sqrt(half**2 - product)
    low, outer = half - spread, half + spread
    w = sqrt(gravity * (outer - low) / 2) / length
    span, m = high - low, (high - low) / (outer - low)
    above, below = length - low, length + low
    pieces = MP.ellippi(span / above, m) / above + MP.ellippi(-span / below, m) / below
    return 4 * MP.ellipk(m) / w, 2 * (momentum / (length * w) * pieces - pi)


def plane_period(length: Any, r0: Any, gravity: Any, rate: Any) -> Any:
    """Return T_f of a release at rest, as seen from the ground, in s."""
    period, turn = swing_period(length, r0, gravity, rate)
    return 2 * pi / (rate - turn / period)


def wide_swing(s: Any) -> tuple[Any, Any]:
    """Return T_f / T_p (1 + 3/8 r0²/L0²) and the closed form, at s times the Pantheon's amplitude."""
    r0 = PANTHEON_RELEASE * s
    true = plane_period(PANTHEON_LENGTH, r0, GRAVITY, RATE) * RATE / (2 * pi)
    return 1 + mpf("0.375") * (r0 / PANTHEON_LENGTH) ** 2, true


def precession_ratio(angle: Any) -> Any:
    """Return the rotation of the plane over the precession of the ellipse, for a release at rest at the pole."""
    period, turn = swing_period(PANTHEON_LENGTH, PANTHEON_LENGTH * sin(angle), GRAVITY, RATE)
    return RATE * period / turn


def _relative(p: Point) -> tuple[Vector, Vector, Vector]:
    """Return place, velocity and acceleration of a point in axes that turn about z."""
    return vector(p.x, p.y, p.t), vector(p.vx, p.vy, 0), vector(p.ax, p.ay, 0)


def _seen_at_rest(order: int) -> Callable[[Point], Vector]:
    """Return a function that gives the velocity (1) or the acceleration (2) of that point in axes at rest."""

    def seen(p: Point) -> Vector:
        place, speed, second = _relative(p)
        return derivative(
            lambda s: rotated(place + s * speed + s * s / 2 * second, AXIS, p.rate * s), 0, order
        )

    return seen


def _forces_of_rotation(p: Point) -> Vector:
    """Return Ω² R + 2 v_r × Ω."""
    (x, y, _), speed, _ = _relative(p)
    return p.rate**2 * vector(x, y, 0) + 2 * p.rate * cross(speed, AXIS)


def _tilted_frame(p: Point) -> Vector:
    """Return the acceleration of a point that moves uniformly in axes turning about an inclined axis."""
    axis = turning(p) / p.rate
    return derivative(lambda s: rotated(p.position + s * p.velocity, axis, p.rate * s), 0, 2)


def _bending(p: Point) -> Any:
    """Return how fast the horizontal velocity turns, clockwise, where the Coriolis force acts alone."""
    ax, ay = linearised(p.but(gravity=MP.zero))
    return (p.vy * ax - p.vx * ay) / (p.vx**2 + p.vy**2)


def _shorter_than_the_arc() -> Answer:
    p = points()[0].but(azimuth_rate=MP.zero)
    velocity = moving_velocity(p)
    share = norm(velocity[:2]) / norm(velocity)
    return Answer(share < 1, f"dx / (v dt) = {shown(share)} at θ = {shown(p.cord, 6)}")


def _slower_when_wide() -> Answer:
    """Run the reference at the pole with the Pantheon's amplitude: its transits are its points of rest."""
    run = solved(("site.latitude=90", "site.gravity=9.8", "release.x=6.5", "release.y=0"), "20", 30)
    t, x, y = (mpf(run.transits.exact(name)[1]) for name in ("t", "x", "y"))
    ratio = -2 * pi * t / atan2(y, x) / (SIDEREAL_DAY * 3600)
    closed = wide_swing(MP.one)[1]
    holds = bool(ratio > 1 and abs(ratio - closed) < mpf("1e-20"))
    return Answer(holds, f"T_f/T_p = {shown(ratio)} at r0 = 6.5 m, pole")


def _turn(latitude: str) -> float:
    """Return the rotation of the swing plane in degrees an hour, by its azimuths every 10 s for two hours."""
    scene, times = load_scene("paris", [f"site.latitude={latitude}"]), np.arange(0.0, 7205.0, 10.0)
    return rotation(times, swing_plane(scene, path_in(scene, times)))[0]


def _pole() -> Answer:
    turn = _turn("90")
    return Answer(
        abs(turn / -15.04106864 - 1) < 1e-4,
        f"{turn:.15f}° an hour, the Earth -15.041068640° in the sky",
    )


def _equator() -> Answer:
    turn = _turn("0")
    return Answer(abs(turn) < 1e-3, f"{turn:.15f}° an hour")


def _south() -> Answer:
    turn = _turn("-48.846111")
    return Answer(turn > 0, f"{turn:+.15f}° an hour, east to north (anticlockwise from above)")


def _on_sphere(p: Point) -> PaperCase:
    """Return the numbers on a sphere of radius R_p, as in the paper's 2 and 4: there a_e = Ω² R_p cosλ."""
    return p.but(flattening=MP.zero, altitude=MP.zero).case


def apparent(p: Point) -> Vector:
    """Return g_a = g + a_e of the reference's model, on east, north, up."""
    return p.length * vector(*_on_sphere(p).k.pull)


def outward(p: Point) -> Any:
    """Return a_e."""
    return _on_sphere(p).outward


def tilt(p: Point) -> Any:
    """Return α from the vectors."""
    _, north, up = apparent(p)
    return atan2(-north, -up)


def _tangents(p: Point) -> Vector:
    """Return tanα by a_e, and with a_e written out."""
    out, whole, s, c = outward(p), p.rate**2 * p.radius, sin(p.phi), cos(p.phi)
    return vector(out * s / (p.gravity - out * c), whole * c * s / (p.gravity - whole * c**2))


def _vertical_rate(p: Point) -> Any:
    """Return the part of Ω along -g_a, over Ω."""
    pull = apparent(p)
    return -dot(turning(p), pull) / norm(pull) / p.rate


def pantheon_on_sphere(s: Any) -> Point:
    """Return the Pantheon on a sphere, Ω² s times the Earth's."""
    return paris().faster(s).but(radius=EARTH_RADIUS, latitude=PANTHEON_LATITUDE, gravity=GRAVITY)


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    return section("gastebois_", "Gastebois",
        Identity("3_1_v", "3.1", "dOM/dt = x' i + x Ω j + y' j - y Ω i + z' k",
            lambda p: (p.vx - p.y * p.rate, p.x * p.rate + p.vy, 0), _seen_at_rest(1)),
        Identity("3_1_a", "3.1", "d²OM/dt² = x'' i + x'Ω j + x'Ω j - xΩ² i + y'' j - y'Ω i - y'Ω i - yΩ² j + z'' k",
            lambda p: (p.ax - p.x * p.rate**2 - 2 * p.vy * p.rate, 2 * p.vx * p.rate + p.ay - p.y * p.rate**2, 0),
            _seen_at_rest(2)),
        Identity("3_1_vector", "3.1", "a = a_r - Ω² R - 2 v_r × Ω",
            lambda p: _relative(p)[2] - _forces_of_rotation(p), _seen_at_rest(2)),
        Identity("3_1_any", "3.1", "true for any orientation of Ω",
            lambda p: -cross(turning(p), cross(p.position, turning(p))) - 2 * cross(p.velocity, turning(p)),
            _tilted_frame),
        Identity("3_2", "3.2", "m a_r = ΣF + m Ω² R + 2 m v_r × Ω",
            lambda p: p.mass * (_seen_at_rest(2)(p) + _forces_of_rotation(p)), lambda p: p.mass * _relative(p)[2]),
        Identity("annex_i", ", annex", "i' = (-sinθ, cosθ) dθ/dt = Ω j",
            lambda p: p.rate * vector(-sin(p.rate * p.t), cos(p.rate * p.t)),
            lambda p: derivative(lambda t: vector(cos(p.rate * t), sin(p.rate * t)), p.t)),
        Identity("annex_j", ", annex", "j' = (-cosθ, -sinθ) dθ/dt = -Ω i",
            lambda p: -p.rate * vector(cos(p.rate * p.t), sin(p.rate * p.t)),
            lambda p: derivative(lambda t: vector(-sin(p.rate * t), cos(p.rate * t)), p.t)),
        PrintedNumber("1", "1", "in one hour the pendulum had turned by 11,3°",
            "11.3", lambda: 360 / SIDEREAL_DAY * sin(paris().phi)),
        PrintedNumber("2_radius", "2", "R_p = 6370 km",
            "6370e3", lambda: MEAN_RADIUS, about=lambda: MEAN_RADIUS, remark="m; mean radius of the ellipsoid"),
        Identity("2_distance", "2", "R = R_p cosλ", lambda p: p.radius * cos(p.phi),
            lambda p: axis_distance(p.radius, 0, 0, sin(p.phi), cos(p.phi), MP.sqrt),
            remark="truth: reference.model.earth"),
        PrintedNumber("2_day", "2", "T_p = 23,92 h", "23.92", lambda: SIDEREAL_DAY, remark="2π/Ω of WGS84"),
        PrintedNumber("2_rate", "2", "Ω = 2π/T_p = 7,297 · 10⁻⁵ rd/s",
            "7.297e-5", lambda: RATE, from_inputs=lambda: 2 * pi / (mpf("23.92") * 3600),
            inputs="T_p = 23,92 h"),
        PrintedNumber("4_1_bound", "4.1", "a_e < 0,034 m/s²",
            "0.034", lambda: paris().rate ** 2 * paris().radius, remark="at the equator"),
        PrintedNumber("4_1_paris", "4.1", "24 / sin 49° = 31 h 48 min",
            "1908", lambda: 24 * 60 / sin(radians(49)), remark="minutes"),
        PrintedNumber("4_1_hour", "4.1", "(11,3° in 1 hour)", "11.3", lambda: 360 * sin(radians(49)) / 24),
        Approximate("4_1_ga", "4.1", "g_a = g",
            over(pantheon_on_sphere, lambda p: p.gravity, lambda p: norm(apparent(p))), 1, "Ω²", "m/s²",
            remark="at 48.87°"),
        Identity("4_1_omega", "4.1", "Ω = Ω cosλ j + Ω sinλ k",
            turning, lambda p: p.k.turn, remark="truth: reference.model.constants"),
        Identity("4_1_cross", "4.1", "v_r × Ω = v_y Ω sinλ i for v_r = v_y j",
            lambda p: (p.vy * p.rate * sin(p.phi), 0, 0),
            lambda p: cross((0, p.vy, 0), turning(p))),
        Identity("4_1_curve", "4.1", "v_r²/r = 2 v_r Ω sinλ, so v_r/r = 2 Ω sinλ", lambda p: 2 * rate_up(p), _bending,
            remark="truth: how fast the velocity turns clockwise without gravity"),
        Identity("4_1_half", "4.1", "r dφ = dx/2, so v_r/r = 2 dφ/dt", lambda p: -sum(turning_rates(p)), _bending,
            remark="the plane turns at half the difference of the two eigenvalues' sizes"),
        Identity("4_1_tf", "4.1", "T_f = 2π/ω_f = T_p / sinλ",
            lambda p: 2 * pi / p.rate / sin(p.phi), lambda p: 2 * pi / dot(turning(p), (0, 0, MP.one))),
        Approximate("4_1_small", "4.1", "ω_f = Ω sinλ for small angles",
            lambda s: (MP.one, wide_swing(s)[1]), 2, "r0/L0",
            remark="T_f/T_p at the pole, r0 = 6.5 m; truth: elliptic integrals"),
        Statement("4_1_pole", "4.1", "at the poles T_f = T_p", _pole, by_run=True),
        Statement("4_1_equator", "4.1", "at the equator the plane does not turn", _equator, by_run=True),
        Statement("4_1_dx", "4.1, remark", "if the amplitude grows, dx < v dt", _shorter_than_the_arc),
        Statement("4_1_wide", "4.1, remark", "T_f grows slightly with the amplitude", _slower_when_wide, by_run=True),
        Statement("4_1_south", "4.1, remark", "in the south it turns anticlockwise seen from above",
            _south, by_run=True),
        Identity("4_2_cosines", "4.2", "g_a² = g² + a_e² - 2 g a_e cosλ",
            lambda p: p.gravity**2 + outward(p) ** 2 - 2 * p.gravity * outward(p) * cos(p.phi),
            lambda p: dot(apparent(p), apparent(p))),
        Identity("4_2_ga", "4.2", "g_a² = g² + Ω² R_p cosλ - 2 g Ω² R_p cos²λ",
            lambda p: p.gravity**2 + outward(p) - 2 * p.gravity * p.rate**2 * p.radius * cos(p.phi) ** 2,
            lambda p: dot(apparent(p), apparent(p)), "g_a² = g² + Ω⁴ R_p² cos²λ - 2 g Ω² R_p cos²λ",
            lambda p: p.gravity**2 + (p.rate**4 * p.radius - 2 * p.gravity * p.rate**2) * p.radius * cos(p.phi) ** 2),
        Identity("4_2_alpha", "4.2", "tanα = a_e sinλ / (g - a_e cosλ) = Ω² R_p cosλ sinλ / (g - Ω² R_p cos²λ)",
            _tangents, lambda p: (MP.tan(tilt(p)), MP.tan(tilt(p)))),
        Identity("4_2_lambda", "4.2", "λ_a = λ + α", lambda p: sin(p.phi + tilt(p)), _vertical_rate,
            remark="sine of the angle between the axis of the Earth and the plumb line's horizon"),
        Identity("4_2_tf", "4.2", "T_f = T_p / sinλ_a",
            lambda p: 2 * pi / p.rate / sin(p.phi + tilt(p)), lambda p: 2 * pi / (p.rate * _vertical_rate(p))),
        PrintedNumber("6_3_lambda", "6.3", "λ_a = 48,97°",
            "48.97", lambda: PANTHEON_LATITUDE + degrees(tilt(pantheon_on_sphere(1)))),
    )  # fmt: skip
