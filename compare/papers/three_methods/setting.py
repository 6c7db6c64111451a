"""The third source paper, its equations: Newton, small angles, components."""

from __future__ import annotations

from typing import Any

from ..checks import Approximate, Check, Finding, Identity, Statement
from ..digits import MP, Vector, add, cos, cross, dot, mpf, norm, scale, shown, sin, unit
from ..gastebois.frames import turning
from ..linear import acceleration_of
from ..mathar.slow import linearised, uniform_acceleration
from ..points import Point, points
from .axes import D, coupled


def _away_from_axis() -> Finding:
    p = points()[0]
    axis, far = turning(p), (MP.zero, MP.zero, p.radius)
    pushed = scale(-1, cross(axis, cross(axis, far)))
    across = add(far, scale(-dot(far, unit(axis)), unit(axis)))
    gap = norm(add(unit(pushed), scale(-1, unit(across))))
    return Finding(gap < mpf("1e-45"), f"-ω × (ω × r) points away from the axis to within {shown(gap)}")


def checks() -> list[Check]:
    """Return the rows, in the order of print."""

    def horizontal(s: Any) -> Point:
        p = points()[0].but(rate=MP.zero)
        return p.but(x=p.x * s, y=p.y * s, vx=p.vx * s, vy=p.vy * s)

    return [
        Identity(
            "methods_newton",
            D,
            "T - mgk - 2m ω × v = m a",
            lambda p: add(
                _cord(p),
                scale(p.mass, (MP.zero, MP.zero, -p.gravity)),
                scale(-2 * p.mass, cross(turning(p), p.velocity)),
            ),
            lambda p: scale(p.mass, acceleration_of(p)),
            remark="truth: reference.model.force with gravity alone; T along the cord",
        ),
        Identity(
            "methods_centrifugal",
            D,
            "|ω × (ω × r)| = ω² r cosα",
            lambda p: p.rate**2 * p.radius * cos(p.phi),
            lambda p: norm(cross(turning(p), cross(turning(p), (MP.zero, MP.zero, p.radius)))),
        ),
        Statement("methods_away", D, "with direction away from the axis of rotation", _away_from_axis),
        Approximate(
            "methods_sine",
            D,
            "mg sinθ ≈ mgθ",
            lambda s: (points()[0].cord * s, sin(points()[0].cord * s)),
            2,
            "θ",
            remark="at a random θ of 0.9 rad",
        ),
        Approximate(
            "methods_hooke",
            D,
            "T - mgk ≈ -(mg/L) ρ (i cosφ + j sinφ)",
            lambda s: (
                scale(-horizontal(s).gravity / horizontal(s).length, (horizontal(s).x, horizontal(s).y)),
                uniform_acceleration(horizontal(s)),
            ),
            2,
            "amplitude",
            remark="horizontal part, at a random point",
        ),
        Identity(
            "methods_omega",
            D,
            "ω = ω (j cosα + k sinα)",
            lambda p: (MP.zero, p.rate * cos(p.phi), p.rate * sin(p.phi)),
            lambda p: p.k.turn,
        ),
        Identity(
            "methods_cross",
            D,
            "-2ω × v = 2ω xdot k cosα - 2ω xdot j sinα + 2ω ydot i sinα",
            lambda p: (2 * p.rate * p.vy * sin(p.phi), -2 * p.rate * p.vx * sin(p.phi), 2 * p.rate * p.vx * cos(p.phi)),
            lambda p: scale(-2, cross(p.k.turn, (p.vx, p.vy, MP.zero))),
        ),
        Approximate(
            "methods_z",
            D,
            "2ω xdot cosα = zddot (and ignored)",
            lambda s: (2 * rising(s).rate * rising(s).vx * cos(rising(s).phi), acceleration_of(rising(s))[2]),
            1,
            "amplitude",
            "m/s²",
            "at a random point; the cord's vertical pull differs from mg by as much",
        ),
        Identity(
            "methods_pair",
            D,
            "xddot + (g/L) x = 2ω sinα ydot, yddot + (g/L) y = -2ω sinα xdot",
            lambda p: coupled(p, (p.x, p.y), (p.vx, p.vy)),
            linearised,
            remark="truth: reference.model.force with gravity alone, linear",
        ),
    ]


def rising(s: Any) -> Point:
    """Return the first random point, its amplitude times s."""
    p = points()[0]
    return p.but(x=p.x * s, y=p.y * s, vx=p.vx * s, vy=p.vy * s)


def _cord(p: Point) -> Vector:
    """Return T along the cord, of the size that r·r'' = -v² requires."""
    free = add((MP.zero, MP.zero, -p.gravity), scale(-2, cross(turning(p), p.velocity)))
    pull = (dot(p.velocity, p.velocity) + dot(free, p.position)) / p.length**2
    return scale(-p.mass * pull, p.position)
