"""The third source paper, method 1: axes that turn, written out."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..checks import Approximate, Check, Finding, Identity, Statement
from ..digits import MP, Vector, cos, mpf, norm, scale, shown, sin, sqrt, vector_derivative
from ..linear import rate_up
from ..points import Point, paris
from .axes import D, axes_rate, generic_path, measured_rate, primed, printed_rate, unprimed_equation


def _own_rate(p: Point) -> Any:
    """Return some ω_p, not the special one."""
    return p.cord_rate


def _first(p: Point) -> Vector:
    """Return x', y' dot as printed, second form."""
    w, c, s = _own_rate(p), cos(_own_rate(p) * p.t), sin(_own_rate(p) * p.t)
    along, across = p.vx - p.y * w, p.x * w + p.vy
    return along * c - across * s, along * s + across * c


def _second(p: Point) -> Vector:
    """Return x', y' double dot as printed, second form."""
    w, c, s = _own_rate(p), cos(_own_rate(p) * p.t), sin(_own_rate(p) * p.t)
    along, across = p.ax - 2 * p.vy * w - p.x * w**2, p.ay + 2 * p.vx * w - p.y * w**2
    return along * c - across * s, along * s + across * c


def _second_long(p: Point) -> Vector:
    """Return x', y' double dot as printed, first form."""
    w, c, s = _own_rate(p), cos(_own_rate(p) * p.t), sin(_own_rate(p) * p.t)
    return (
        (p.ax - p.vy * w) * c - (p.vx - p.y * w) * w * s - (p.vx * w + p.ay) * s - (p.x * w + p.vy) * w * c,
        (p.ax - p.vy * w) * s + (p.vx - p.y * w) * w * c + (p.vx * w + p.ay) * c - (p.x * w + p.vy) * w * s,
    )


def _derived(order: int) -> Callable[[Point], Vector]:
    return lambda p: vector_derivative(primed(generic_path(p), _own_rate(p)), p.t, order)


def _printed_unprimed(p: Point, rate: Any) -> Vector:
    """Return x'', y'' from the pair printed before "which decouples"."""
    up = rate_up(p)
    k = p.gravity / p.length - 2 * up * rate - rate**2
    return -k * p.x + 2 * (up + rate) * p.vy, -k * p.y - 2 * (up + rate) * p.vx


def _far_below_gravity() -> Finding:
    p = paris()
    ratio = p.rate * norm((p.x, p.y)) * sqrt(p.gravity / p.length) / p.gravity
    return Finding(ratio < mpf("1e-4"), f"ω xdot / g = {shown(ratio)} in Paris")


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    m = f"{D}, method 1"
    return [
        Identity(
            "methods_1_first",
            m,
            "xdot' = (xdot - yω_p) cosω_p t - (xω_p + ydot) sinω_p t, ydot' = …",
            _first,
            _derived(1),
        ),
        Identity("methods_1_second_a", m, "xddot' and yddot', first form", _second_long, _derived(2)),
        Identity(
            "methods_1_second",
            m,
            "xddot' = (xddot - 2ydot ω_p - xω_p²) cosω_p t - (yddot + 2xdot ω_p - yω_p²) sinω_p t, …",
            _second,
            _derived(2),
        ),
        Identity(
            "methods_1_pair",
            m,
            "xddot + (g/L - 2ω sinα ω_p - ω_p²) x - 2(ω sinα + ω_p) ydot = 0, yddot + …",
            lambda p: _printed_unprimed(p, _own_rate(p)),
            lambda p: unprimed_equation(p, _own_rate(p)),
        ),
        Identity(
            "methods_1_rate",
            m,
            "decouples for ω_p = -ω sinα",
            lambda p: unprimed_equation(p.but(x=MP.zero, y=MP.zero), axes_rate(p)),
            lambda p: (MP.zero, MP.zero),
            remark="x'', y'' that velocities alone give",
        ),
        Identity(
            "methods_1_simple",
            m,
            "xddot + ω̃² x = 0, yddot + ω̃² y = 0",
            lambda p: scale(-(printed_rate(p) ** 2), (p.x, p.y)),
            lambda p: unprimed_equation(p, axes_rate(p)),
        ),
        Identity(
            "methods_1_omega",
            m,
            "ω̃ = sqrt(g/L - 2ωω_p sinα - ω_p²) = sqrt(g/L + 2(ω_P/sinα) ω_p sinα - ω_p²)",
            lambda p: (
                sqrt(p.gravity / p.length - 2 * p.rate * axes_rate(p) * sin(p.phi) - axes_rate(p) ** 2),
                sqrt(
                    p.gravity / p.length + 2 * axes_rate(p) / sin(p.phi) * axes_rate(p) * sin(p.phi) - axes_rate(p) ** 2
                ),
            ),
            lambda p: (measured_rate(p), measured_rate(p)),
            remark="truth: eigenvalues of the decoupled pair",
        ),
        Identity("methods_1_omega2", m, "ω̃ = sqrt(g/L + ω_p²)", printed_rate, measured_rate),
        Approximate(
            "methods_1_omega3",
            m,
            "ω̃ ≈ sqrt(g/L)",
            lambda s: (sqrt(_turned(s).gravity / _turned(s).length), printed_rate(_turned(s))),
            2,
            "ω",
            remark="in Paris",
        ),
        Statement("methods_1_small", m, "ω xdot << g", _far_below_gravity),
    ]


def _turned(s: Any) -> Point:
    base = paris()
    return base.but(rate=base.rate * s)
