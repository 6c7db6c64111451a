"""How far the bounds on a state spread until the next row: the variational equations of `momentum`, row by row.

The derivative of the rates along a direction is taken from their central difference: they are cubic at most, so that
it is right to eight digits. All rows are integrated side by side by the classical Runge-Kutta method: three are plenty.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...model.constants import Constants, constants
from ...model.formulations import FORMULATIONS
from ...numbers.precision import GUARD_BITS, Array, context
from ...scenes.inputs import Inputs
from .completion import deep, depth, vertical_velocity

NUDGE = 1e-4  # of a unit vector
STEP = 0.2  # times the fastest rate: an error below 1e-3 after a few swings
MODEL = FORMULATIONS["momentum"]


def spreads(inputs: Inputs, states: Array, bounds: Array, span: float) -> tuple[Array, Array]:
    """Return how far errors of states, up to bounds, move the motion from there.

    Args:
        inputs: the exact inputs of a scene.
        states: x, y, z in m and vx, vy, vz in m/s, shape (rows, 6).
        bounds: of the six columns; those of z and vz matter only where these do not follow from the others.
        span: in s.

    Returns:
        The largest errors of the six columns at the end of the span, and at any time in it, each of shape (rows, 6).
    """
    k = constants(inputs, context(GUARD_BITS)).converted(float)
    length = float(k.length)

    def start(rows: Any) -> Any:
        return np.array(np.broadcast_arrays(*MODEL.start(tuple(rows[:3]), tuple(rows[3:]), k, np)))

    def rates(rows: Any) -> Any:
        return np.array(np.broadcast_arrays(*MODEL.derivatives(tuple(rows), k, np)))

    def cartesian(rows: Any) -> Any:
        n, v = MODEL.cartesian(tuple(rows), k, np)
        return np.array(np.broadcast_arrays(*n, *v))

    base = states.T / length
    along = _derivative(start, base[:, None, :], _directions(base))
    state = start(base)
    steps = max(1, int(np.ceil(span * _fastest(k, base) / STEP)))
    sizes = bounds / length

    def error() -> Array:
        return np.asarray(np.einsum("ijr,j->ri", np.abs(_derivative(cartesian, state[:, None, :], along)), sizes))

    last = most = error()
    for _ in range(steps):
        state, along = _step(rates, state, along, span / steps)
        last = error()
        most = np.maximum(most, last)
    return last * length, most * length


def _fastest(k: Constants, base: Array) -> float:
    """Return the sum of the rates of swing, motion, rotation and drag in 1/s; the motion's at the lowest point."""
    pull = np.array([float(part) for part in k.pull])
    strength = np.linalg.norm(pull)
    squares = np.sum(base[3:] ** 2, axis=0) + 2 * (strength - pull @ base[:3])
    return float(np.sqrt(strength) + np.sqrt(np.max(squares, initial=0.0)) + abs(k.rate) + k.drag)


def _directions(base: Array) -> Array:
    """Return how states over l change with each column, shape (6, 6, rows): z and vz follow where they can."""
    follows = deep(base[2], 1.0)

    def completed(rows: Any) -> Any:
        x, y, z, vx, vy, vz = rows
        z = np.where(follows, depth(x, y, 1.0, np.sign(z), lambda q: np.sqrt(np.maximum(q, 0.0))), z)
        return np.array([x, y, z, vx, vy, np.where(follows, vertical_velocity(x, y, np.where(z, z, 1.0), vx, vy), vz)])

    return np.asarray(_derivative(completed, base[:, None, :], np.eye(6)[:, :, None]))


def _derivative(function: Callable[[Any], Any], at: Any, along: Any) -> Any:
    """Return the derivative of a function along directions."""
    nudge = NUDGE / max(1.0, float(np.max(np.abs(along))))
    return (function(at + nudge * along) - function(at - nudge * along)) / (2 * nudge)


def _step(rates: Callable[[Any], Any], state: Any, along: Any, h: float) -> tuple[Any, Any]:
    """Return state and directions one step of the classical Runge-Kutta method later."""
    k, d = [rates(state)], [_derivative(rates, state[:, None, :], along)]
    for part in (h / 2, h / 2, h):
        at, direction = state + part * k[-1], along + part * d[-1]
        k.append(rates(at))
        d.append(_derivative(rates, at[:, None, :], direction))
    return (
        state + h / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3]),
        along + h / 6 * (d[0] + 2 * d[1] + 2 * d[2] + d[3]),
    )
