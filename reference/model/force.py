"""The force on the bob, the tension of the cord, the acceleration, the invariant h, and the rest position.

Axes x east, y north, z up, origin at the suspension. Lengths are divided by the cord length l, so that n = r/l, and
times stay in seconds. The force per mass over l is, with the constants of `constants.Constants` (c = pull, Ω = turn,
γ = drag),

    F(n, v) = c - Ω × (Ω × n) - 2 Ω × v - γ v,

and n'' = F - n (v·v + n·F) keeps |n| = 1.
"""

from __future__ import annotations

from typing import Any

from .algebra import add, cross, dot, minus, plus, product, scale, subtract
from .constants import Constants, Vector, is_zero


def force(n: Vector, v: Vector, k: Constants) -> Vector:
    """Force per mass over l, without the cord: c - Ω × (Ω × n) - 2 Ω × v - γ v, in 1/s²."""
    xx, yy, yz, zz = k.centrifugal
    spread = (product(xx, n[0]), plus(product(yy, n[1]), product(yz, n[2])), plus(product(yz, n[1]), product(zz, n[2])))
    bent = scale(2, cross(k.turn, v))
    return subtract(subtract(add(k.pull, spread), bent), scale(k.drag, v))


def tension(n: Vector, v: Vector, k: Constants) -> Any:
    """Pull of the cord per mass over l, v·v + n·F; below zero the rod is pushed and rounding leaves the sphere."""
    return plus(dot(v, v), dot(n, force(n, v, k)))


def acceleration(n: Vector, v: Vector, k: Constants) -> Vector:
    """N'' = F - n (v·v + n·F), in 1/s²."""
    return subtract(force(n, v, k), scale(tension(n, v, k), n))


def invariant(n: Vector, v: Vector, k: Constants) -> Any:
    """H = v²/2 + g z - Ω²/2 (x² + q²) in m²/s², q = R - s y + c z; constant when there is no drag."""
    q = plus(k.axis_distance, product(-1, k.sin, n[1]), product(k.cos, n[2]))
    turning = product(k.rate, k.rate, plus(product(n[0], n[0]), product(q, q)))
    doubled = minus(plus(dot(v, v), product(2, k.gravity, n[2])), turning)
    return product(k.length, k.length, doubled) / 2


def rest_position(k: Constants, ctx: Any) -> Vector:
    """Where the bob hangs at rest, n = (0, sin θ, -cos θ): the tangential force vanishes, Mathar (44), (46).

    Args:
        k: constants in the mpmath context `ctx`.
        ctx: the context; θ is exact to its last few bits.

    Raises:
        ValueError: nothing pulls, so that every point is a rest position.
    """
    if is_zero(k.pull[1]) and is_zero(k.centrifugal[2]):
        if is_zero(k.pull[2]) and is_zero(k.centrifugal[3]):
            raise ValueError("without gravity and rotation every point is a rest position")
        return (0, 0, ctx.mpf(-1))

    def tangential(theta: Any) -> Any:
        sin, cos = ctx.sin(theta), ctx.cos(theta)
        pulled = force((0, sin, -cos), (0, 0, 0), k)
        return plus(product(pulled[1], cos), product(pulled[2], sin))

    theta = ctx.findroot(tangential, ctx.atan2(k.pull[1], -k.pull[2]))
    return (0, ctx.sin(theta), -ctx.cos(theta))
