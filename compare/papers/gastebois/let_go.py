"""Gastebois, section 6.3: let go at rest, in closed form."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..checks import Approximate, Check, Finding, Identity, PrintedNumber, Statement
from ..digits import MP, Vector, cos, mpf, pi, radians, shown, sin, vector_derivative
from ..linear import motion, motion_at_rest, rate_up, start_at_rest, swing_rate
from ..points import Point, points
from .numbers import G
from .solution import fitted_constants
from .thrown import in_turning_axes, pantheon
from .turning_swing import precession_ratio, wide_swing

Motion = Callable[[Point, Any], Vector]


def at_rest(p: Point, t: Any) -> Vector:
    """Return x, y of a release at rest by 6.3."""
    r0, w, up = p.x, swing_rate(p), rate_up(p)
    cu, su, cw, sw = cos(up * t), sin(up * t), cos(w * t), sin(w * t)
    return (r0 * cu * cw + r0 * up / w * su * sw, -r0 * su * cw + r0 * up / w * cu * sw)


def _sense(motion_in_axes: Motion, p: Point, t: Any) -> Any:
    """Return twice the area swept per time: positive counter-clockwise from above."""
    x, y = motion_in_axes(p, t)
    vx, vy = vector_derivative(lambda s: motion_in_axes(p, s), t)
    return x * vy - y * vx


def _clockwise() -> Finding:
    p = points()[0]
    swept = _sense(_ellipse, p, p.t)
    return Finding(swept < 0, f"x vy - y vx = {shown(swept)} in the turning axes, north")


def _ellipse(p: Point, t: Any) -> Vector:
    return in_turning_axes(p, motion(p, start_at_rest(p), t)[:2], t)


def checks() -> list[Check]:
    """Return the rows of section 6.3."""

    def one_swing(s: Any) -> tuple[Any, Any]:
        p = pantheon(s)
        t = 2 * pi / swing_rate(p)
        turn = 2 * pi * rate_up(p) / swing_rate(p)
        return p.x * (1 - turn**2 / 2), motion_at_rest(p, t)[0]

    def aside(s: Any) -> tuple[Any, Any]:
        p = pantheon(s)
        return -2 * pi * p.x * rate_up(p) / swing_rate(p), motion_at_rest(p, 2 * pi / swing_rate(p))[1]

    return [
        Identity(
            "gastebois_6_3_c",
            f"{G} 6.3",
            "c1 = (ω-Ω_z) r0 / 2ω, c2 = (ω+Ω_z) r0 / 2ω",
            lambda p: tuple((swing_rate(p) + sign * rate_up(p)) * p.x / (2 * swing_rate(p)) for sign in (-1, 1)),
            lambda p: fitted_constants(p.but(y=MP.zero, vx=MP.zero, vy=MP.zero))[::2],
        ),
        Identity(
            "gastebois_6_3_xy",
            f"{G} 6.3",
            "x = r0 cosΩ_z t cosωt + r0 Ω_z/ω sinΩ_z t sinωt, y = …",
            lambda p: at_rest(p, p.t),
            lambda p: motion(p, start_at_rest(p), p.t)[:2],
        ),
        Identity(
            "gastebois_6_3_axes",
            f"{G} 6.3",
            "X = r0 cosωt, Y = r0 Ω_z/ω sinωt",
            lambda p: (p.x * cos(swing_rate(p) * p.t), p.x * rate_up(p) / swing_rate(p) * sin(swing_rate(p) * p.t)),
            lambda p: _ellipse(p, p.t),
        ),
        Statement(
            "gastebois_6_3_sense",
            f"{G} 6.3",
            "the ellipse is described clockwise in the northern hemisphere",
            _clockwise,
            "counter-clockwise, in the axes that turn with the plane",
            lambda: all(_sense(_ellipse, p, p.t) > 0 for p in points()),
        ),
        Identity(
            "gastebois_6_3_speed",
            f"{G} 6.3, remark",
            "as thrown with a transverse velocity of -r0 Ω_z",
            lambda p: -p.x * rate_up(p),
            lambda p: vector_derivative(lambda t: _ellipse(p, t), MP.zero)[1],
            "+r0 Ω_z",
            lambda p: p.x * rate_up(p),
        ),
        PrintedNumber(
            "gastebois_6_3_350",
            f"{G} 6.3, remark",
            "at 5° the precession takes about 350 times as long as the rotation",
            "350",
            lambda: precession_ratio(radians(5)),
            about=lambda: mpf(350),
            remark="by the elliptic integrals, at the pole; 8/(3θ²) = " + shown(8 / (3 * radians(5) ** 2), 8),
        ),
        Approximate(
            "gastebois_6_3_x",
            f"{G} 6.3",
            "at t = T: x = r0 (1 - (2πΩ_z/ω)²/2)",
            one_swing,
            4,
            "Ω",
        ),
        Approximate("gastebois_6_3_y", f"{G} 6.3", "at t = T: y = -2π r0 Ω_z/ω", aside, 2, "Ω"),
        Identity(
            "gastebois_6_3_rate",
            f"{G} 6.3",
            "ω_f = φ/T = Ω_z with φ = -2πΩ_z/ω",
            rate_up,
            lambda p: -2 * pi * rate_up(p) / swing_rate(p) / (2 * pi / swing_rate(p)),
            "a sign is dropped within the line: φ/T = -Ω_z",
            lambda p: -rate_up(p),
            "φ = y/r0 counts anticlockwise, ω_f clockwise as in 4.1: ω_f = -φ/T",
        ),
        Identity(
            "gastebois_6_3_tf",
            f"{G} 6.3",
            "T_f = 2π/Ω_z = T / sinλ_a",
            lambda p: 2 * pi / swing_rate(p) / sin(p.phi),
            lambda p: 2 * pi / rate_up(p),
            "T_p / sinλ_a, T_p the day",
            lambda p: 2 * pi / p.rate / sin(p.phi),
        ),
        Identity(
            "gastebois_6_3_ratio",
            f"{G} 6.3",
            "the ratio of the ellipse's axes is T/T_f",
            lambda p: (2 * pi / swing_rate(p)) / (2 * pi / rate_up(p)),
            lambda p: _ellipse(p, pi / 2 / swing_rate(p))[1] / _ellipse(p, MP.zero)[0],
        ),
        Approximate(
            "gastebois_6_3_wide",
            f"{G} 6.3",
            "T_f (1 + 3/8 r0²/L0²)",
            wide_swing,
            4,
            "r0/L0",
            remark="release at rest at the pole, r0 = 6.5 m; truth: elliptic integrals",
        ),
    ]
