"""The model in one of heyoka's number types: a formulation with a scene's constants, and its states in SI units."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...model.constants import Constants
from ...model.force import acceleration
from ...model.formulations import Formulation
from ...model.start import Start
from ...numbers.columns import RUN
from ...numbers.precision import Array, NumberType
from ...numbers.table import Table
from .numbers import Numbers
from .propagator import Propagator
from .system import rates


class RoundedModel:
    """A formulation of the equations of motion, with constants rounded once to a number type.

    Args:
        formulation: the formulation.
        k: the constants, finer than the number type.
        number: type to compute in.
    """

    def __init__(self, formulation: Formulation, k: Constants, number: NumberType) -> None:
        self.formulation, self.numbers = formulation, Numbers(number)
        self.k = k.converted(self.numbers.of)

    def release(self, start: Start) -> list[Any]:
        """Return the state at t = 0, in numbers of the type."""
        return [self.numbers.of(value) for value in start.state(self.formulation)]

    def propagator(self, tolerance: float | None = None) -> Propagator:
        """Compile the equations, without events; the tolerance is the type's epsilon if None."""
        equations = rates(self.formulation, self.k)
        return Propagator(self.formulation.variables, equations, self.numbers.number, tolerance=tolerance)

    def columns(self, states: Any) -> list[Any]:
        """Return x, y, z in m and vx, vy, vz in m/s, each of shape (rows,), from states of shape (rows, variables)."""
        n, v = self._cartesian(states)
        return [np.broadcast_to(part * self.k.length, len(states)) for part in (*n, *v)]

    def doubles(self, states: Any) -> Array:
        """Return the same as the nearest doubles, shape (rows, 6)."""
        return np.array([column.astype(np.float64) for column in self.columns(states)]).T.copy()

    def table(self, states: Any, bits: int) -> Table:
        """Return `columns.RUN` over 2**bits, exactly as computed, from states of shape (rows, variables)."""
        if len(states) == 0:
            return Table(RUN, bits, [])
        n, v = self._cartesian(states)
        ax = acceleration(n, v, self.k)[0]
        fixed = [self.numbers.fixed(np.asarray(column) * self.k.length, bits) for column in (*n, *v, ax)]
        return Table(RUN, bits, list(zip(*fixed, strict=True)))

    def _cartesian(self, states: Any) -> Any:
        return self.formulation.cartesian(tuple(np.ascontiguousarray(states.T)), self.k, np)
