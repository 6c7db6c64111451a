"""What fixed-step integrators make of an oscillator: exact for linear models, the leading order for others.

A Runge-Kutta method multiplies the phasor exp(iγt) by its stability polynomial R(iγh) every step, so that the rows show
the rate log R(iγh)/(ih) in place of γ. Semi-implicit Euler couples position and velocity: its 2 × 2 propagator is used.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np

from .phasors import Phasors


@dataclass(frozen=True)
class Method:
    """A fixed-step integrator.

    Attributes:
        id: a short word.
        title: as a person calls it.
        order: of its error.
        coefficients: of the stability polynomial; empty for the semi-implicit ones.
        kick: of a semi-implicit one, whether the velocity goes first; None for leapfrog, whose start is exact.
    """

    id: str
    title: str
    order: int
    coefficients: tuple[float, ...] = ()
    kick: bool | None = None

    def computed(self, phasors: Phasors, step: float) -> Phasors:
        """Return the phasors that the rows of a program with this method show; the same if it cannot be told."""
        try:
            return self._polynomial(phasors, step) if self.coefficients else self._split(phasors, step)
        except (ValueError, ZeroDivisionError, OverflowError, np.linalg.LinAlgError):
            return phasors

    def first_step(self, square: float, square_shown: float, drag: float, drag_shown: float) -> float:
        """Return the step in s that the leading error of an oscillator of ω² asks for; 0 if there is none."""
        if square <= 0:
            return 0.0
        omega = math.sqrt(square)
        excess, growth = square_shown / square - 1, (drag - drag_shown) / omega
        if not self.coefficients:
            return math.sqrt(max(12 * excess, 0.0)) / omega
        if self.order == 1:
            return max(growth, 0.0) / omega
        if self.order == 2:
            return math.sqrt(max(3 * excess, 0.0)) / omega
        if self.order == 3:
            return float(max(-12 * growth, 0.0) ** (1 / 3)) / omega
        return float(max(-60 * excess, 0.0) ** 0.25) / omega

    def _polynomial(self, phasors: Phasors, step: float) -> Phasors:
        def shown(rate: complex) -> complex:
            z = 1j * rate * step
            value = sum(c * z**n for n, c in enumerate(self.coefficients))
            return cmath.log(value) / (1j * step)

        first, second = phasors.rates
        return Phasors((shown(first), shown(second)), phasors.amplitudes, phasors.centre)

    def _split(self, phasors: Phasors, step: float) -> Phasors:
        """Return the modes of one step of w'' = -d w' - q w about the centre, d and q complex."""
        q, d = phasors.square, -1j * (phasors.rates[0] + phasors.rates[1])
        start, speed = phasors.start - phasors.centre, phasors.speed
        if self.kick is None:  # leapfrog: half a kick, a drift, half a kick; its Coriolis force is explicit
            half = np.array([[1, 0], [-q * step / 2, 1 - d * step / 2]])
            other = np.array([[1, 0], [-q * step / 2 / (1 + d * step / 2), 1 / (1 + d * step / 2)]])
            matrix = other @ np.array([[1, step], [0, 1]]) @ half
        else:
            kick = np.array([[1, 0], [-q * step, 1 - d * step]])
            drift = np.array([[1, step], [0, 1]])
            matrix = drift @ kick if self.kick else kick @ drift
        values, vectors = np.linalg.eig(matrix.astype(complex))
        parts = np.linalg.solve(vectors, np.array([start, speed]))
        rates = [cmath.log(value) / (1j * step) for value in values]
        amplitudes = [complex(vectors[0, i] * parts[i]) for i in range(2)]
        order = sorted(range(2), key=lambda i: -rates[i].real)
        return Phasors((rates[order[0]], rates[order[1]]), (amplitudes[order[0]], amplitudes[order[1]]), phasors.centre)


def _taylor(order: int) -> tuple[float, ...]:
    return tuple(1 / math.factorial(n) for n in range(order + 1))


METHODS = (
    Method("semi_implicit_euler", "semi-implicit (symplectic) Euler", 1, kick=True),
    Method("semi_implicit_euler_drift", "semi-implicit (symplectic) Euler, position first", 1, kick=False),
    Method("explicit_euler", "explicit Euler", 1, _taylor(1)),
    Method("leapfrog", "leapfrog (Verlet)", 2),
    Method("rk2", "a Runge-Kutta method of order 2 (midpoint, Heun)", 2, _taylor(2)),
    Method("rk3", "a Runge-Kutta method of order 3", 3, _taylor(3)),
    Method("rk4", "a Runge-Kutta method of order 4", 4, _taylor(4)),
)
