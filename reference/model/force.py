"""Force on the bob, tension of the cord, acceleration, the invariant h (energy) and the rest position.

Axes x east, y north, z up, origin at the suspension. Lengths are divided by the cord length l, so
that n = r/l, and times stay in seconds. The force per mass over l is, with the constants of
`constants.Constants` (c = pull, Ω = turn, γ = drag),

    F(n, v) = c - Ω × (Ω × n) - 2 Ω × v - γ v,

and n'' = F - n (v·v + n·F) keeps |n| = 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .algebra import add, cross, dot, minus, plus, product, scale, subtract
from .constants import Constants, Vector, is_zero


def force(n: Vector, v: Vector, k: Constants) -> Vector:
    """Return the force per mass over l, without the cord: c - Ω × (Ω × n) - 2 Ω × v - γ v, in 1/s²."""
    xx, yy, yz, zz = k.centrifugal
    centrifugal = (
        product(xx, n[0]),
        plus(product(yy, n[1]), product(yz, n[2])),
        plus(product(yz, n[1]), product(zz, n[2])),
    )
    coriolis = scale(2, cross(k.turn, v))
    return subtract(subtract(add(k.pull, centrifugal), coriolis), scale(k.drag, v))


def tension(n: Vector, v: Vector, k: Constants) -> Any:
    """Return the tension of the cord per mass over l, v·v + n·F, in 1/s².

    Where it is negative a rod is pushed.
    """
    return plus(dot(v, v), dot(n, force(n, v, k)))


def acceleration(n: Vector, v: Vector, k: Constants) -> Vector:
    """Return n'' = F - n (v·v + n·F), in 1/s²."""
    return subtract(force(n, v, k), scale(tension(n, v, k), n))


def rates(state: Sequence[Any], k: Constants) -> tuple[Any, ...]:
    """Return the rates of x, y, z (m/s) and vx, vy, vz (m/s²), given these six in m and m/s."""
    n = tuple(part / k.length for part in state[:3])
    v = tuple(part / k.length for part in state[3:])
    return (*state[3:], *(k.length * part for part in acceleration(n, v, k)))


def invariant(n: Vector, v: Vector, k: Constants) -> Any:
    """Return h = v²/2 + g z - Ω²/2 (x² + q²) in m²/s², constant without drag.

    q = R - y sin(latitude) + z cos(latitude), so that x² + q² is the squared distance from the
    Earth's axis.
    """
    q = plus(k.axis_distance, product(-1, k.sin, n[1]), product(k.cos, n[2]))
    centrifugal = product(k.rate, k.rate, plus(product(n[0], n[0]), product(q, q)))
    doubled = minus(plus(dot(v, v), product(2, k.gravity, n[2])), centrifugal)
    return product(k.length, k.length, doubled) / 2


def energy(n: Vector, v: Vector, k: Constants) -> Any:
    """Return v²/2 - c·r - |Ω × r|²/2 in m²/s², which is h + Ω²R²/2: no large constant takes its digits."""
    across = plus(product(k.cos, n[2]), product(-1, k.sin, n[1]))
    centrifugal = product(k.rate, k.rate, plus(product(n[0], n[0]), product(across, across)))
    doubled = minus(minus(dot(v, v), product(2, dot(k.pull, n))), centrifugal)
    return product(k.length, k.length, doubled) / 2


def rest_position(k: Constants, ctx: Any) -> Vector:
    """Return the rest position n = (0, sin θ, -cos θ), where the tangential force vanishes: Mathar (44), (46).

    Args:
        k: constants in the mpmath context `ctx`.
        ctx: the context; θ is exact to its last few bits.

    Raises:
        ValueError: there is no single one: no force acts at the pivot, or the rotation is so
            fast that the one next to the plumb line is not stable.
    """
    if is_zero(k.pull[1]) and is_zero(k.centrifugal[2]):
        if is_zero(k.pull[2]) and is_zero(k.centrifugal[3]):
            raise ValueError("no force acts at the pivot, so there is no single rest position")
        return (0, 0, ctx.mpf(-1))

    def tangential(theta: Any) -> Any:
        sin, cos = ctx.sin(theta), ctx.cos(theta)
        at_rest = force((0, sin, -cos), (0, 0, 0), k)
        return plus(product(at_rest[1], cos), product(at_rest[2], sin))

    theta = ctx.findroot(tangential, ctx.atan2(k.pull[1], -k.pull[2]))
    if ctx.diff(tangential, theta) > 0:
        raise ValueError("the rotation is too fast for a single rest position")
    return (0, ctx.sin(theta), -ctx.cos(theta))
