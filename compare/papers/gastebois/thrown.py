"""Gastebois, section 6.2: thrown so that it swings in a plane, in closed form."""

from __future__ import annotations

from typing import Any

from ..checks import Approximate, Check, Identity
from ..digits import MP, Vector, cos, pi, sin, sqrt, vector_derivative
from ..linear import motion, rate_up, swing_rate
from ..points import Point, points
from .numbers import GRAVITY, PANTHEON_LATITUDE, PANTHEON_LENGTH, PANTHEON_RELEASE, RATE, G


def simple(p: Point, t: Any) -> Vector:
    """Return x, y, v_x, v_y by 6.2; r0 is the point's x."""
    r0, w, up = p.x, swing_rate(p), rate_up(p)
    cu, su, cw, sw = cos(up * t), sin(up * t), cos(w * t), sin(w * t)
    return (
        r0 * cu * cw,
        -r0 * su * cw,
        -r0 * w * cu * sw - r0 * up * su * cw,
        r0 * w * su * sw - r0 * up * cu * cw,
    )


def in_turning_axes(p: Point, xy: Vector, t: Any) -> Vector:
    """Return X = x cosΩ_z t - y sinΩ_z t, Y = y cosΩ_z t + x sinΩ_z t."""
    cu, su = cos(rate_up(p) * t), sin(rate_up(p) * t)
    return xy[0] * cu - xy[1] * su, xy[1] * cu + xy[0] * su


def _start_simple(p: Point) -> Vector:
    return (p.x, MP.zero, MP.zero, -p.x * rate_up(p))


def pantheon(s: Any = 1) -> Point:
    """Return the Pantheon's pendulum, rotation s times the Earth's."""
    base = points()[0]
    return base.but(
        length=PANTHEON_LENGTH, gravity=GRAVITY, latitude=PANTHEON_LATITUDE, rate=RATE * MP.mpf(s), x=PANTHEON_RELEASE
    )


def _axes_turn(p: Point) -> Any:
    """Return the angular velocity of the axis OX, clockwise: X is the part of (x, y) along (cos, -sin) Ω_z t."""

    def along(t: Any) -> Vector:
        return cos(rate_up(p) * t), -sin(rate_up(p) * t)

    x, y = along(p.t)
    vx, vy = vector_derivative(along, p.t)
    return y * vx - x * vy


def _own_square(p: Point) -> Any:
    return rate_up(p) ** 2 / (2 * p.gravity / p.length)


def _expanded(p: Point) -> Any:
    return sqrt(p.gravity / p.length) * (1 + _own_square(p))


def _expanded_period(p: Point) -> Any:
    return 2 * pi / sqrt(p.gravity / p.length) * (1 - _own_square(p))


def checks() -> list[Check]:
    """Return the rows of section 6.2."""
    return [
        Identity(
            "gastebois_6_2_xy",
            f"{G} 6.2",
            "x = r0 cosΩ_z t cosωt, y = -r0 sinΩ_z t cosωt",
            lambda p: simple(p, p.t)[:2],
            lambda p: motion(p, _start_simple(p), p.t)[:2],
        ),
        Identity(
            "gastebois_6_2_v",
            f"{G} 6.2",
            "v_x = -r0 ω cosΩ_z t sinωt - …, v_y = r0 ω sinΩ_z t sinωt - …",
            lambda p: simple(p, p.t)[2:],
            lambda p: motion(p, _start_simple(p), p.t)[2:],
        ),
        Identity(
            "gastebois_6_2_axes",
            f"{G} 6.2",
            "X = r0 cosωt, Y = 0",
            lambda p: (p.x * cos(swing_rate(p) * p.t), MP.zero),
            lambda p: in_turning_axes(p, motion(p, _start_simple(p), p.t)[:2], p.t),
        ),
        Identity(
            "gastebois_6_2_turn",
            f"{G} 6.2",
            "the axes OXYZ turn about Oz with the angular velocity Ω_z",
            rate_up,
            _axes_turn,
            remark="clockwise from above counted positive, as his 4.1 counts ω_f; so do the formulas for X and Y",
        ),
        Identity(
            "gastebois_6_2_start",
            f"{G} 6.2",
            "x0 = r0, y0 = 0, v_x0 = 0, v_y0 = -r0 Ω_z",
            _start_simple,
            lambda p: (*simple(p, MP.zero)[:2], *vector_derivative(lambda t: simple(p, t)[:2], MP.zero)),
        ),
        Approximate(
            "gastebois_6_2_omega",
            f"{G} 6.2",
            "ω = ω0 (1 + Ω_z² / 2ω0²)",
            lambda s: (_expanded(pantheon(s)), swing_rate(pantheon(s))),
            4,
            "Ω",
        ),
        Approximate(
            "gastebois_6_2_period",
            f"{G} 6.2",
            "T = T0 (1 - Ω_z² / 2ω0²)",
            lambda s: (_expanded_period(pantheon(s)), 2 * pi / swing_rate(pantheon(s))),
            4,
            "Ω",
        ),
    ]
