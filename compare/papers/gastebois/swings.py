"""Gastebois, sections 6.2 and 6.3: thrown into a plane, let go at rest, and the Pantheon's numbers."""

from __future__ import annotations

from typing import Any

from ...approximations import gastebois
from ..checks import (
    Answer,
    Approximate,
    Check,
    Identity,
    PrintedNumber,
    Statement,
    component,
    over,
    section,
)
from ..digits import MP, Vector, cos, derivative, mpf, pi, radians, shown, sin, sqrt, vector
from ..first_principles import motion, rate_up, swing_rate, turned_in_plane
from ..points import Point, points
from .rotation import (
    GRAVITY,
    PANTHEON_LATITUDE,
    PANTHEON_LENGTH,
    PANTHEON_RELEASE,
    RATE,
    SIDEREAL_DAY,
    precession_ratio,
    wide_swing,
)
from .small import fitted_constants

APPARENT_LATITUDE = mpf("48.97")  # λ_a, as he rounds it


def simple(p: Point, t: Any, minor: Any = 0) -> Vector:
    """Return x, y, v_x, v_y by 6.2, or by 6.3 with `minor` = Ω_z/ω; r0 is the point's x."""
    return p.x * vector(*gastebois.in_turning_axes(minor, swing_rate(p), rate_up(p), t, MP))


def _start_simple(p: Point) -> Vector:
    return vector(p.x, 0, 0, -p.x * rate_up(p))


def motion_at_rest(p: Point, t: Any) -> Vector:
    """Return x, y of the linear system let go at rest at x, in the east."""
    return motion(p, (p.x, 0, 0, 0), t)[:2]


def pantheon(s: Any = 1) -> Point:
    """Return the Pantheon's pendulum, rotation s times the Earth's."""
    return points()[0].but(
        length=PANTHEON_LENGTH,
        gravity=GRAVITY,
        latitude=PANTHEON_LATITUDE,
        rate=RATE * MP.mpf(s),
        x=PANTHEON_RELEASE,
    )


def _axes_turn(p: Point) -> Any:
    """Return the angular velocity of the axis OX, clockwise: X is the part of (x, y) along (cos, -sin) Ω_z t."""

    def along(t: Any) -> Vector:
        return vector(cos(rate_up(p) * t), -sin(rate_up(p) * t))

    x, y = along(p.t)
    vx, vy = derivative(along, p.t)
    return y * vx - x * vy


def _half_square(p: Point) -> Any:
    return rate_up(p) ** 2 / (2 * p.gravity / p.length)


def _sense(p: Point) -> Any:
    """Return twice the area that the ellipse sweeps per time: positive counter-clockwise from above."""
    (x, y), (vx, vy) = _ellipse(p, p.t), derivative(lambda t: _ellipse(p, t), p.t)
    return x * vy - y * vx


def _clockwise() -> Answer:
    p = points()[0]
    return Answer(_sense(p) < 0, f"x vy - y vx = {shown(_sense(p))} in the turning axes, north")


def _ellipse(p: Point, t: Any) -> Vector:
    """Return X = x cosΩ_z t - y sinΩ_z t, Y = y cosΩ_z t + x sinΩ_z t of the bob let go at rest."""
    return turned_in_plane(motion_at_rest(p, t), rate_up(p) * t)


def _after_a_swing(p: Point) -> Vector:
    return motion_at_rest(p, 2 * pi / swing_rate(p))


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    up = RATE * sin(radians(PANTHEON_LATITUDE))
    w = sqrt(GRAVITY / PANTHEON_LENGTH)
    spread = 1 + mpf("0.375") * (PANTHEON_RELEASE / PANTHEON_LENGTH) ** 2
    tilted, geodetic = sin(radians(APPARENT_LATITUDE)), sin(radians(PANTHEON_LATITUDE))
    return section("gastebois_", "Gastebois",
        Identity("6_2_xy", "6.2", "x = r0 cosΩ_z t cosωt, y = -r0 sinΩ_z t cosωt",
            lambda p: simple(p, p.t)[:2], lambda p: motion(p, _start_simple(p), p.t)[:2]),
        Identity("6_2_v", "6.2", "v_x = -r0 ω cosΩ_z t sinωt - …, v_y = r0 ω sinΩ_z t sinωt - …",
            lambda p: simple(p, p.t)[2:], lambda p: motion(p, _start_simple(p), p.t)[2:]),
        Identity("6_2_axes", "6.2", "X = r0 cosωt, Y = 0", lambda p: (p.x * cos(swing_rate(p) * p.t), 0),
            lambda p: turned_in_plane(motion(p, _start_simple(p), p.t)[:2], rate_up(p) * p.t)),
        Identity("6_2_turn", "6.2", "the axes OXYZ turn about Oz with the angular velocity Ω_z", rate_up, _axes_turn,
            remark="clockwise from above counted positive, as his 4.1 counts ω_f; so do the formulas for X and Y"),
        Identity("6_2_start", "6.2", "x0 = r0, y0 = 0, v_x0 = 0, v_y0 = -r0 Ω_z", _start_simple,
            lambda p: (*simple(p, MP.zero)[:2], *derivative(lambda t: simple(p, t)[:2], MP.zero))),
        Approximate("6_2_omega", "6.2", "ω = ω0 (1 + Ω_z² / 2ω0²)",
            over(pantheon, lambda p: sqrt(p.gravity / p.length) * (1 + _half_square(p)), swing_rate), 4, "Ω"),
        Approximate("6_2_period", "6.2", "T = T0 (1 - Ω_z² / 2ω0²)",
            over(pantheon, lambda p: 2 * pi / sqrt(p.gravity / p.length) * (1 - _half_square(p)),
                lambda p: 2 * pi / swing_rate(p)), 4, "Ω"),
        Identity("6_3_c", "6.3", "c1 = (ω-Ω_z) r0 / 2ω, c2 = (ω+Ω_z) r0 / 2ω",
            lambda p: tuple((swing_rate(p) + sign * rate_up(p)) * p.x / (2 * swing_rate(p)) for sign in (-1, 1)),
            lambda p: fitted_constants(p.but(y=MP.zero, vx=MP.zero, vy=MP.zero))[::2]),
        Identity("6_3_xy", "6.3", "x = r0 cosΩ_z t cosωt + r0 Ω_z/ω sinΩ_z t sinωt, y = …",
            lambda p: simple(p, p.t, rate_up(p) / swing_rate(p))[:2], lambda p: motion_at_rest(p, p.t)),
        Identity("6_3_axes", "6.3", "X = r0 cosωt, Y = r0 Ω_z/ω sinωt",
            lambda p: (p.x * cos(swing_rate(p) * p.t), p.x * rate_up(p) / swing_rate(p) * sin(swing_rate(p) * p.t)),
            lambda p: _ellipse(p, p.t)),
        Statement("6_3_sense", "6.3", "the ellipse is described clockwise in the northern hemisphere",
            _clockwise, "counter-clockwise, in the axes that turn with the plane",
            lambda: all(_sense(p) > 0 for p in points())),
        Identity("6_3_speed", "6.3, remark", "as thrown with a transverse velocity of -r0 Ω_z",
            lambda p: -p.x * rate_up(p), lambda p: derivative(lambda t: _ellipse(p, t), 0)[1],
            "+r0 Ω_z", lambda p: p.x * rate_up(p)),
        PrintedNumber("6_3_350", "6.3, remark", "at 5° the precession takes about 350 times as long as the rotation",
            "350", lambda: precession_ratio(radians(5)), about=lambda: mpf(350),
            remark="by the elliptic integrals, at the pole; 8/(3θ²) = " + shown(8 / (3 * radians(5) ** 2), 8)),
        Approximate("6_3_x", "6.3", "at t = T: x = r0 (1 - (2πΩ_z/ω)²/2)",
            over(pantheon, lambda p: p.x * (1 - (2 * pi * rate_up(p) / swing_rate(p)) ** 2 / 2),
                component(_after_a_swing, 0)), 4, "Ω"),
        Approximate("6_3_y", "6.3", "at t = T: y = -2π r0 Ω_z/ω",
            over(pantheon, lambda p: -2 * pi * p.x * rate_up(p) / swing_rate(p), component(_after_a_swing, 1)), 2, "Ω"),
        Identity("6_3_rate", "6.3", "ω_f = φ/T = Ω_z with φ = -2πΩ_z/ω",
            rate_up, lambda p: -2 * pi * rate_up(p) / swing_rate(p) / (2 * pi / swing_rate(p)),
            "a sign is dropped within the line: φ/T = -Ω_z", lambda p: -rate_up(p),
            remark="φ = y/r0 counts anticlockwise, ω_f clockwise as in 4.1: ω_f = -φ/T"),
        Identity("6_3_tf", "6.3", "T_f = 2π/Ω_z = T / sinλ_a",
            lambda p: 2 * pi / swing_rate(p) / sin(p.phi), lambda p: 2 * pi / rate_up(p),
            "T_p / sinλ_a, T_p the day", lambda p: 2 * pi / p.rate / sin(p.phi)),
        Identity("6_3_ratio", "6.3", "the ratio of the ellipse's axes is T/T_f",
            lambda p: (2 * pi / swing_rate(p)) / (2 * pi / rate_up(p)),
            lambda p: _ellipse(p, pi / 2 / swing_rate(p))[1] / _ellipse(p, MP.zero)[0]),
        Approximate("6_3_wide", "6.3", "T_f (1 + 3/8 r0²/L0²)",
            wide_swing, 4, "r0/L0", remark="release at rest at the pole, r0 = 6.5 m; truth: elliptic integrals"),
        PrintedNumber("6_2_mm", "6.2", "v_y0 = -0,357 mm/s", "-0.357", lambda: -PANTHEON_RELEASE * up * 1000),
        PrintedNumber("6_2_mh", "6.2", "= -1,285 m/hour", "-1.285", lambda: -PANTHEON_RELEASE * up * 3600),
        PrintedNumber("6_2_tiny", "6.2", "a relative difference of 10⁻⁸", "1e-8", lambda: up**2 / (2 * w**2)),
        PrintedNumber("6_3_t", "6.3", "T = 16,43 s", "16.43", lambda: 2 * pi / w, remark="with g = 9,8 m/s² of 4.1"),
        PrintedNumber("6_3_w", "6.3", "ω = 0,382 rd/s", "0.382", lambda: w),
        PrintedNumber("6_3_up", "6.3", "Ω_z = 5,49 · 10⁻⁵ rd/s", "5.49e-5", lambda: up, remark="at 48.87°"),
        PrintedNumber("6_3_h", "6.3", "T_f = 31,77 h", "31.77", lambda: SIDEREAL_DAY / sin(radians(PANTHEON_LATITUDE)),
            from_inputs=lambda: mpf("23.93") / sin(radians(PANTHEON_LATITUDE)), inputs="T_p = 23,93 h"),
        PrintedNumber("6_3_small", "6.3", "0,93 mm at the middle", "0.93", lambda: 1000 * PANTHEON_RELEASE * up / w),
        PrintedNumber("6_3_step", "6.3", "5,88 mm after one swing",
            "5.88", lambda: 2000 * pi * PANTHEON_RELEASE * up / w,
            from_inputs=lambda: 2000 * pi * PANTHEON_RELEASE * mpf("7.297e-5") * geodetic / mpf("0.382"),
            inputs="Ω = 7,297 · 10⁻⁵ and ω = 0,382"),
        PrintedNumber("6_3_apparent", "6.3", "with the centrifugal force T_f = 31,74 h",
            "31.74", lambda: SIDEREAL_DAY / tilted, from_inputs=lambda: mpf("23.92") / tilted, inputs="T_p = 23,92 h",
            remark="at λ_a = 48,97°; T_p = 23,92 h gives "
                f"{shown(mpf('23.92') / tilted, 6)}, 23,93 h {shown(mpf('23.93') / tilted, 6)}"),
        PrintedNumber("6_3_precession", "6.3", "31,74 (1 + 3/8 r0²/L0²) = 31,85 h",
            "31.85", lambda: SIDEREAL_DAY / tilted * spread,
            from_inputs=lambda: mpf("31.74") * spread, inputs="31,74 h"),
        PrintedNumber("6_3_rounded", "6.3", "one may take 31,8 h", "31.8", lambda: SIDEREAL_DAY / tilted * spread),
    )  # fmt: skip
