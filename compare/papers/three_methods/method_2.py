"""The third source paper, method 2: the Coriolis theorem used twice, with two errors that cancel."""

from __future__ import annotations

from typing import Any

from ..checks import Check, Identity
from ..digits import MP, Vector, add, cos, cross, scale, sin, sqrt, vector_derivative
from ..linear import motion, rate_up
from ..mathar.slow import linearised
from ..points import Point
from .axes import D, axes_rate, coupled, measured_rate, stiffness


def _centrifugal(p: Point) -> Vector:
    """Return -m ω_p × (ω_p × x')."""
    axis = (MP.zero, MP.zero, axes_rate(p))
    return scale(-p.mass, cross(axis, cross(axis, (p.x, p.y, MP.zero))))[:2]


def _turned_drive(p: Point) -> Vector:
    """Return F_eff/m of the lines before, with the velocity in axes at rest, x' + ω_p × x'."""
    speed = add((p.vx, p.vy), scale(axes_rate(p), (-p.y, p.x)))
    return coupled(p, (p.x, p.y), speed)


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    m = f"{D}, method 2"
    return [
        Identity(
            "methods_2_vector",
            m,
            "m xddot = -(mg/L) x - 2m (ω sinα k) × xdot",
            lambda p: add(
                scale(-p.gravity / p.length, (p.x, p.y)),
                scale(-2, cross((MP.zero, MP.zero, rate_up(p)), (p.vx, p.vy, MP.zero)))[:2],
            ),
            linearised,
        ),
        Identity(
            "methods_2_coriolis",
            m,
            "m xddot' = F_eff - 2m ω_p × xdot' - m ω_p × (ω_p × x')",
            lambda p: add(
                _turned_drive(p),
                scale(-2, cross((MP.zero, MP.zero, axes_rate(p)), (p.vx, p.vy, MP.zero)))[:2],
                scale(1 / p.mass, _centrifugal(p)),
            ),
            _moved_acceleration,
            remark="F_eff with the velocity in axes at rest; truth: the linear motion, seen from the turning axes",
        ),
        Identity(
            "methods_2_centrifugal",
            m,
            "-m ω_p × (ω_p × x') = -m ω_p² x'",
            lambda p: scale(-p.mass * axes_rate(p) ** 2, (p.x, p.y)),
            _centrifugal,
            "+m ω_p² x'",
            lambda p: scale(p.mass * axes_rate(p) ** 2, (p.x, p.y)),
        ),
        Identity(
            "methods_2_force",
            m,
            "F_eff = -(mg/L) x' - 2m (ω sinα k) × xdot'",
            lambda p: coupled(p, (p.x, p.y), (p.vx, p.vy)),
            _turned_drive,
            "xdot = xdot' + ω_p × x' belongs in it; the two errors cancel",
            lambda p: coupled(p, (p.x, p.y), (p.vx - axes_rate(p) * p.y, p.vy + axes_rate(p) * p.x)),
        ),
        Identity(
            "methods_2_end",
            m,
            "xddot' = -(g/L) x' - ω_p² x'",
            lambda p: scale(-stiffness(p), (p.x, p.y)),
            _moved_acceleration,
        ),
        Identity("methods_2_omega", m, "ω = sqrt(g/L + ω_p²)", lambda p: sqrt(stiffness(p)), measured_rate),
    ]


def _moved_acceleration(p: Point) -> Vector:
    """Return the acceleration of the linear motion, seen from axes that turn at ω_p and coincide at t = 0."""
    rate = axes_rate(p)
    start = (p.x, p.y, p.vx - rate * p.y, p.vy + rate * p.x)

    def in_turning_axes(t: Any) -> Vector:
        x, y = motion(p, start, t)[:2]
        c, s = cos(rate * t), sin(rate * t)
        return x * c + y * s, y * c - x * s

    return vector_derivative(in_turning_axes, MP.zero, 2)
