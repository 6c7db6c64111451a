"""Sensitivity of a trajectory to each input: first-order variational equations, integrated with the model.

The equations of `momentum` are varied along one direction of their constants and start (Ω, c, γ, n, H) at a time. How
these depend on a scene's inputs (length, latitude, …) comes in by the chain rule, from differences in 320 bits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from ..model.constants import Constants
from ..model.formulations import FORMULATIONS
from ..model.start import Start
from ..numbers.precision import DOUBLE, Array, to_fraction
from ..scenes.inputs import Inputs
from ..scenes.scene import Scene

_SITE = ("latitude", "altitude", "gravity", "rotation_rate", "equatorial_radius")
_POSITION = ("x", "y", "vx", "vy")
_ANGLES = ("angle", "azimuth", "angle_rate", "azimuth_rate")
_PREC = 320  # bits
_NUDGE = Fraction(1, 1 << 100)  # central differences in 320 bits: exact to about 2**-200
_TOLERANCE = 1e-11  # of the variational equations, whose results are used to three digits
_MODEL = FORMULATIONS["momentum"]
_CONSTANTS = ("turn_1", "turn_2", "pull_1", "pull_2", "drag")


@dataclass(frozen=True)
class Sensitivity:
    """First-order response of a scene's trajectory to each of its inputs.

    Args:
        scene: its inputs are varied.
        times: increasing, from 0, in s.
    """

    scene: Scene
    times: tuple[float, ...]

    @cached_property
    def values(self) -> dict[str, Fraction]:
        """Each input's exact value, by its name in the scene file, such as "site.gravity"."""
        inputs = self.scene.exact
        values = {"pendulum.length": inputs.length, "pendulum.drag": inputs.drag}
        values |= {f"site.{name}": getattr(inputs, name) for name in _SITE}
        if inputs.flattening:
            values["site.inverse_flattening"] = 1 / inputs.flattening
        names, numbers = (_POSITION, inputs.position) if inputs.position is not None else (_ANGLES, inputs.angles)
        assert numbers is not None
        return values | {f"release.{name}": value for name, value in zip(names, numbers, strict=True)}

    def derivative(self, name: str) -> Array:
        """Return the derivatives of x, y, z (m) and vx, vy, vz (m/s) with respect to one input, shape (times, 6).

        Per SI unit of the input (degrees for angles); relative error about 1e-9.
        """
        return self._along(self._slope(name))

    def rounding(self) -> Array:
        """Return how far rounding every input to binary64 moves the trajectory, shape (times, 6)."""
        changes = {name: Fraction(float(value)) - value for name, value in self.values.items()}
        slopes = [float(change) * self._slope(name) for name, change in changes.items() if change]
        return self._along(np.sum(slopes, axis=0)) if slopes else np.zeros((len(self.times), 6))

    def _slope(self, name: str) -> Array:
        """Return the derivative of start, constants and length with respect to one input."""
        inputs, value = self.scene.exact, self.values[name]
        nudge = _NUDGE * max(abs(value), Fraction(1))
        ahead, behind = (_parts(with_value(inputs, name, value + side * nudge)) for side in (1, -1))
        return np.array([float(to_fraction(p - q) / (2 * nudge)) for p, q in zip(ahead, behind, strict=True)])

    def _along(self, slope: Array) -> Array:
        """Return the response to a change of start, constants and length."""
        size = len(_MODEL.variables)
        base = np.array([float(part) for part in _parts(self.scene.exact)])
        start, turn, length = base[:size], np.array([0.0, *base[size : size + 2]]), base[-1]
        strength = max(1.0, float(np.abs(slope).max()))  # keeps the derivative near 1, for the step size
        parameters = [0.0, *base[size:-1], *(slope[size:-1] / strength)]
        rows = self._propagator.from_zero([*start, *(slope[:size] / strength)], self.times, parameters)
        n, momentum, dn, dmomentum = np.split(rows, 4, axis=1)
        dn, dspin = strength * dn, strength * dmomentum - np.array([0.0, *slope[size : size + 2]])
        v, dv = np.cross(momentum - turn, n), np.cross(dspin, n) + np.cross(momentum - turn, dn)
        return np.hstack([slope[-1] * n + length * dn, slope[-1] * v + length * dv])

    @cached_property
    def _propagator(self) -> Any:
        from ..engines.heyoka.propagator import Propagator

        count = 1 + 2 * len(_CONSTANTS)
        return Propagator(_MODEL.variables, _rates, DOUBLE, tolerance=_TOLERANCE, parameters=count, varied=True)


def _rates(state: Sequence[Any], functions: Any, parameters: Sequence[Any]) -> Sequence[Any]:
    """Return the rates of `momentum` with constants c + ε d as parameters, also those that are zero in the scene."""
    epsilon, *pairs = parameters
    values, direction = pairs[: len(_CONSTANTS)], pairs[len(_CONSTANTS) :]
    varied = {name: c + epsilon * d for name, c, d in zip(_CONSTANTS, values, direction, strict=True)}
    return _MODEL.derivatives(state, Constants.of(varied), functions)


def _parts(inputs: Inputs) -> list[Any]:
    """Return start (n, H), constants and length that follow from the inputs."""
    start = Start.of(inputs, _PREC)
    entries = start.k.entries()
    k = (entries.get(name, 0) for name in (*_CONSTANTS, "length"))
    return [start.ctx.mpf(part) for part in (*start.state(_MODEL), *k)]


def with_value(inputs: Inputs, name: str, value: Fraction) -> Inputs:
    """Return the inputs with one of `Sensitivity.values` replaced, unchecked, so that a mistaken value can be tried."""
    section, key = name.split(".")
    fields: dict[str, Any] = {key: value}
    if key == "inverse_flattening":
        fields = {"flattening": 1 / value}
    elif section == "release":
        names, kind = (_POSITION, "position") if key in _POSITION else (_ANGLES, "angles")
        numbers = [value if other == key else old for other, old in zip(names, getattr(inputs, kind), strict=True)]
        fields = {kind: tuple(numbers)}
    return replace(inputs, **fields)


def sensitivity(scene: Scene, times: Sequence[float] | Array) -> Sensitivity:
    """Return the response of a scene's trajectory to its inputs, at increasing times from 0 in s."""
    return Sensitivity(scene, tuple(float(t) for t in times))
