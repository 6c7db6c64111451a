"""Sensitivity of a trajectory to its inputs: to each by variational equations, and the digits lost by the end.

The equations of `momentum` are varied along one direction of their constants and start (Ω, c, γ, n, H) at a time. How
these depend on a scene's inputs (length, latitude, …) comes in by the chain rule, from differences in 320 bits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from ..engines.plan import Plan
from ..engines.registry import run
from ..errors import UnreachableError
from ..model.constants import Constants
from ..model.formulations import FORMULATIONS
from ..model.start import Start
from ..numbers.columns import GRID
from ..numbers.precision import DOUBLE, LONG_DOUBLE, Array, real, to_fraction
from ..scenes.inputs import RELEASES, Inputs
from ..scenes.scene import Scene
from .pilot import MAX_PREC, run_pilot

# a change above this part of a column's size is no longer proportional to the perturbation
DIVERGED = Fraction(1, 64)
# In which each input is nudged: most get smaller, as x, y and the angle must, to stay on the sphere; length and
# gravity, which set the swing's frequency, change in opposite directions.
_WAYS = {"y": Fraction(-1, 2), "azimuth": Fraction(-1, 2)}
_WAYS |= dict.fromkeys(("vx", "angle_rate", "length", "rotation_rate", "altitude"), Fraction(1))


def digits_lost(inputs: Inputs, times: tuple[Fraction, ...], *, constants: bool = True) -> float:
    """Return the decimal digits that the motion costs: n digits of every result need n + this many in the inputs.

    Three runs are compared: the scene's own, one with a perturbed release, and one with perturbed constants. At a
    precision of p bits the perturbation is a relative 2**-(p // 2). The column that changes most counts, its change
    over its largest number. An input that is zero, or a latitude where a term vanishes, is taken as exact. If the
    perturbed runs diverge, they are repeated at a higher precision.

    Args:
        inputs: the exact inputs of a scene.
        times: increasing, from 0, in s.
        constants: whether errors of the constants count as well, or only those of the release.

    Raises:
        UnreachableError: as `run_pilot`, or the perturbed runs diverge at every precision.
    """
    pilot = run_pilot(inputs, times)
    number = DOUBLE if pilot.prec <= DOUBLE.prec else real(2 * LONG_DOUBLE.prec)
    while number.prec <= MAX_PREC:
        nudge = Fraction(1, 2 ** (number.prec // 2))
        changed = [
            _perturbed(inputs, nudge, release=release) for release in (True, False)[: 1 + constants]
        ]
        base, *perturbed = (
            run(Plan(each, "momentum", number, times)) for each in (inputs, *changed)
        )
        changes = [base.grid.only(GRID).distance(other.grid).largest() for other in perturbed]
        worst = max(
            change[name] / size for change in changes for name, size in pilot.sizes.items() if size
        )
        if worst <= DIVERGED:
            ratio = worst / nudge
            return (
                max(0.0, math.log10(ratio.numerator) - math.log10(ratio.denominator))
                if ratio
                else 0.0
            )
        number = LONG_DOUBLE if number is DOUBLE else real(2 * number.prec)
    raise UnreachableError(
        f"Even at {MAX_PREC} bits perturbed runs diverge completely, so the sensitivity cannot be measured.",
        "Ask for a shorter run: run.t_end.",
    )


def _perturbed(inputs: Inputs, nudge: Fraction, *, release: bool) -> Inputs:
    """Change each number of the release, or each constant, by a factor; a latitude where a term vanishes is exact."""
    for name, value in inputs.by_name.items():
        section, key = name.split(".")
        if (section == "release") == release and not (key == "latitude" and value % 90 == 0):
            inputs = with_value(inputs, name, value * (1 + _WAYS.get(key, -1) * nudge))
    return inputs


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
    times: Sequence[float] | Array

    def derivative(self, name: str) -> Array:
        """Return the derivatives of x, y, z (m) and vx, vy, vz (m/s) with respect to one input, shape (times, 6).

        Per SI unit of the input (degrees for angles); relative error about 1e-9.
        """
        return self._along(self._slope(name))

    def rounding(self) -> Array:
        """Return how far rounding every input to binary64 moves the trajectory, shape (times, 6)."""
        changes = {
            name: Fraction(float(value)) - value for name, value in self.scene.exact.by_name.items()
        }
        slopes = [float(change) * self._slope(name) for name, change in changes.items() if change]
        return self._along(np.sum(slopes, axis=0)) if slopes else np.zeros((len(self.times), 6))

    def _slope(self, name: str) -> Array:
        """Return the derivative of start, constants and length with respect to one input."""
        inputs, value = self.scene.exact, self.scene.exact.by_name[name]
        nudge = _NUDGE * max(abs(value), Fraction(1))
        ahead, behind = (_parts(with_value(inputs, name, value + side * nudge)) for side in (1, -1))
        return np.array(
            [float(to_fraction(p - q) / (2 * nudge)) for p, q in zip(ahead, behind, strict=True)]
        )

    def _along(self, slope: Array) -> Array:
        """Return the response to a change of start, constants and length."""
        from ..engines.heyoka.propagator import Propagator

        size = len(_MODEL.variables)
        base = np.array([float(part) for part in _parts(self.scene.exact)])
        start, turn, length = base[:size], np.array([0.0, *base[size : size + 2]]), base[-1]
        # keeps the derivative near 1, for the step size
        strength = max(1.0, float(np.abs(slope).max()))
        parameters = [0.0, *base[size:-1], *(slope[size:-1] / strength)]
        count = len(parameters)
        propagator = Propagator(
            _MODEL.variables, _rates, DOUBLE, tolerance=_TOLERANCE, parameters=count, varied=True
        )
        rows = propagator.from_zero([*start, *(slope[:size] / strength)], self.times, parameters)
        n, momentum, dn, dmomentum = np.split(rows, 4, axis=1)
        dn, dspin = strength * dn, strength * dmomentum - np.array([0.0, *slope[size : size + 2]])
        v, dv = np.cross(momentum - turn, n), np.cross(dspin, n) + np.cross(momentum - turn, dn)
        return np.hstack([slope[-1] * n + length * dn, slope[-1] * v + length * dv])


def _rates(state: Sequence[Any], functions: Any, parameters: Sequence[Any]) -> Sequence[Any]:
    """Return the rates of `momentum` with constants c + ε d as parameters, also those that are zero in the scene."""
    epsilon, *pairs = parameters
    values, direction = pairs[: len(_CONSTANTS)], pairs[len(_CONSTANTS) :]
    varied = {
        name: c + epsilon * d for name, c, d in zip(_CONSTANTS, values, direction, strict=True)
    }
    return _MODEL.derivatives(state, Constants.of(varied), functions)


def _parts(inputs: Inputs) -> list[Any]:
    """Return start (n, H), constants and length that follow from the inputs."""
    start = Start.of(inputs, _PREC)
    entries = start.k.entries()
    k = (entries.get(name, 0) for name in (*_CONSTANTS, "length"))
    return [start.ctx.mpf(part) for part in (*start.state(_MODEL), *k)]


def with_value(inputs: Inputs, name: str, value: Fraction) -> Inputs:
    """Return the inputs with one of `Inputs.by_name` replaced, unchecked, so that a mistaken value can be tried."""
    section, key = name.split(".")
    fields: dict[str, Any] = {key: value}
    if key == "inverse_flattening":
        fields = {"flattening": 1 / value}
    elif section == "release":
        kind = next(kind for kind, names in RELEASES.items() if key in names)
        old = zip(RELEASES[kind], getattr(inputs, kind), strict=True)
        fields = {kind: tuple(value if name == key else before for name, before in old)}
    return replace(inputs, **fields)
