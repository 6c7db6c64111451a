"""Sensitivity of a trajectory to its inputs: the response to each, and the digits lost by the end.

The equations of `momentum` are varied along one direction of their constants and start (Ω, c, γ, n,
H) at a time. How these depend on a scene's inputs (length, latitude, …) comes in by the chain rule,
from differences in 320 bits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
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
_DIVERGED = Fraction(1, 64)
# Factors of the nudge of each input. Most get smaller, as x, y and the angle must, to stay on the
# sphere; length and gravity, which set the swing's frequency, change in opposite directions.
_NUDGE_FACTORS = {"y": Fraction(-1, 2), "azimuth": Fraction(-1, 2)}
_NUDGE_FACTORS |= dict.fromkeys(
    ("vx", "angle_rate", "length", "rotation_rate", "altitude"), Fraction(1)
)
_PREC = 320  # bits
_NUDGE = Fraction(1, 1 << 100)  # central differences in 320 bits: exact to about 2**-200
_TOLERANCE = 1e-11  # of the variational equations, whose results are used to three digits
_MODEL = FORMULATIONS["momentum"]
_CONSTANTS = ("turn_1", "turn_2", "pull_1", "pull_2", "drag")


def digits_lost(inputs: Inputs, times: tuple[Fraction, ...], *, constants: bool = True) -> float:
    """Return how many decimal digits error amplification costs between inputs and results.

    For n digits of every result the inputs need n + this many.

    Three runs are compared: the scene's own, one with a perturbed release, and one with perturbed
    constants. At a precision of p bits the perturbation is a relative 2**-(p // 2). The column that
    changes most counts, its change over its largest number. An input that is zero, or a latitude
    where a term vanishes, is taken as exact. If the perturbed runs diverge, they are repeated at a
    higher precision.

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
        perturbed = [_perturbed(inputs, nudge, release=True)]
        if constants:
            perturbed.append(_perturbed(inputs, nudge, release=False))

        base = run(Plan(inputs, "momentum", number, times)).grid.only(GRID)
        worst = Fraction(0)
        for changed in perturbed:
            grid = run(Plan(changed, "momentum", number, times)).grid
            changes = base.distance(grid).largest()
            relative = [changes[name] / size for name, size in pilot.sizes.items() if size]
            worst = max([worst, *relative])
        if worst <= _DIVERGED:
            return _digits_lost_by(worst / nudge)
        number = LONG_DOUBLE if number is DOUBLE else real(2 * number.prec)
    raise UnreachableError(
        f"Even at {MAX_PREC} bits, perturbed runs diverge completely, so the sensitivity cannot be "
        "measured.",
        "Ask for a shorter run: run.t_end.",
    )


def _digits_lost_by(growth: Fraction) -> float:
    """Return the decimal digits that are lost where relative errors grow by a factor, at least 0."""
    if growth <= 1:
        return 0.0
    return math.log10(growth.numerator) - math.log10(growth.denominator)


def _perturbed(inputs: Inputs, nudge: Fraction, *, release: bool) -> Inputs:
    """Change each number of the release, or each constant, by a factor.

    A latitude where a term vanishes is exact.
    """
    for name, value, factor in _nudged(inputs, release=release):
        inputs = with_value(inputs, name, value * (1 + factor * nudge))
    return inputs


def _nudged(inputs: Inputs, *, release: bool) -> Iterator[tuple[str, Fraction, Fraction]]:
    """Yield name, value and factor of the nudge of each number of the release, or of each constant."""
    for name, value in inputs.by_name.items():
        section, key = name.split(".")
        is_exact = key == "latitude" and value % 90 == 0
        if (section == "release") == release and not is_exact:
            yield name, value, _NUDGE_FACTORS.get(key, Fraction(-1))


@dataclass(frozen=True)
class Sensitivity:
    """First-order response of a scene's trajectory to each of its inputs.

    Attributes:
        scene: its inputs are varied.
        times: increasing, from 0, in s.
    """

    scene: Scene
    times: Sequence[float] | Array

    def derivative(self, name: str) -> Array:
        """Return the derivatives of x, y, z (m) and vx, vy, vz (m/s) with respect to one input.

        Shape (times, 6); per SI unit of the input (degrees for angles); relative error about 1e-9.
        """
        return self._along(self._slope(name))

    def relative(self, *, release: bool) -> Array:
        """Return the response to a common relative change of all numbers of the release, or of all constants.

        Shape (times, 6), in m and m/s. The signs of the changes add up their effects; a latitude
        where a term vanishes is exact, as in `digits_lost`.
        """
        slopes = [
            float(factor * value) * self._slope(name)
            for name, value, factor in _nudged(self.scene.exact, release=release)
            if value
        ]
        return self._sum(slopes)

    def rounding(self) -> Array:
        """Estimate how far rounding all inputs to binary64 moves the trajectory, in m and m/s, shape (times, 6)."""
        slopes = []
        for name, value in self.scene.exact.by_name.items():
            change = Fraction(float(value)) - value
            if change:
                slopes.append(float(change) * self._slope(name))
        return self._sum(slopes)

    def _sum(self, slopes: list[Array]) -> Array:
        """Return the response to several changes at once."""
        if not slopes:
            return np.zeros((len(self.times), 6))
        return self._along(np.sum(slopes, axis=0))

    def _slope(self, name: str) -> Array:
        """Return the derivative of start, constants and length with respect to one input."""
        inputs = self.scene.exact
        value = inputs.by_name[name]
        nudge = _NUDGE * max(abs(value), Fraction(1))
        ahead = _numbers_of(with_value(inputs, name, value + nudge))
        behind = _numbers_of(with_value(inputs, name, value - nudge))
        differences = [to_fraction(p - q) for p, q in zip(ahead, behind, strict=True)]
        return np.array([float(difference / (2 * nudge)) for difference in differences])

    def _along(self, slope: Array) -> Array:
        """Return the response to a change of start, constants and length, shape (times, 6)."""
        from ..engines.heyoka.propagator import AutonomousSystem, Propagator

        # many names, as each is a quantity of the motion or its derivative
        size = len(_MODEL.variables)
        base = np.array([float(number) for number in _numbers_of(self.scene.exact)])
        start = base[:size]
        constants = base[size:-1]
        length = base[-1]
        start_slope = slope[:size]
        constants_slope = slope[size:-1]
        length_slope = slope[-1]

        # keeps the derivative near 1, for the step size
        strength = max(1.0, float(np.abs(slope).max()))
        parameters = [0.0, *constants, *(constants_slope / strength)]
        system = AutonomousSystem(_MODEL.variables, _rates, len(parameters), varied=True)
        propagator = Propagator(system, DOUBLE, tolerance=_TOLERANCE)
        initial = [*start, *(start_slope / strength)]
        rows = propagator.from_zero(initial, self.times, parameters)
        n, momentum, dn, dmomentum = np.split(rows, 4, axis=1)

        # the spin is H - Ω, and n' = spin × n
        turn = np.array([0.0, *constants[:2]])
        turn_slope = np.array([0.0, *constants_slope[:2]])
        spin = momentum - turn
        dn = strength * dn
        dspin = strength * dmomentum - turn_slope
        v = np.cross(spin, n)
        dv = np.cross(dspin, n) + np.cross(spin, dn)
        return np.hstack([length_slope * n + length * dn, length_slope * v + length * dv])


def _rates(state: Sequence[Any], functions: Any, parameters: Sequence[Any]) -> Sequence[Any]:
    """Return the rates of `momentum` with constants c + ε d as parameters.

    All constants are there, also those that are zero in the scene.
    """
    epsilon, *numbers = parameters
    values = numbers[: len(_CONSTANTS)]
    direction = numbers[len(_CONSTANTS) :]
    varied = {}
    for name, c, d in zip(_CONSTANTS, values, direction, strict=True):
        varied[name] = c + epsilon * d
    return _MODEL.derivatives(state, Constants.of(varied), functions)


def _numbers_of(inputs: Inputs) -> list[Any]:
    """Return start (n, H), constants and length that follow from the inputs."""
    start = Start.of(inputs, _PREC)
    entries = start.k.entries()
    constants = [entries.get(name, 0) for name in (*_CONSTANTS, "length")]
    return [start.ctx.mpf(number) for number in (*start.state(_MODEL), *constants)]


def with_value(inputs: Inputs, name: str, value: Fraction) -> Inputs:
    """Return the inputs with one of `Inputs.by_name` replaced.

    The value is not checked, so that a mistaken one can be tried.
    """
    section, key = name.split(".")
    changes: dict[str, Any] = {key: value}
    if key == "inverse_flattening":
        changes = {"flattening": 1 / value}
    elif section == "release":
        kind = next(kind for kind, names in RELEASES.items() if key in names)
        release = dict(zip(RELEASES[kind], getattr(inputs, kind), strict=True))
        release[key] = value
        changes = {kind: tuple(release.values())}
    return replace(inputs, **changes)
