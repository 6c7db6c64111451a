"""A formulation of the model with constants in one of heyoka's number types.

The modules that make heyoka's arrays import this one, so that its memory handler is installed:
without it arrays of `real` leak.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...model.constants import Constants
from ...model.force import acceleration
from ...model.formulations import Formulation
from ...model.start import Start
from ...numbers.columns import RUN
from ...numbers.precision import Array, NumberType
from ...numbers.table import Table
from .conversions import Numbers
from .library import hy
from .propagator import AutonomousSystem, Propagator
from .system import rates

hy.install_custom_numpy_mem_handler()
# its log is the process's stdout; the lost roots that it would report are detected otherwise
hy.set_logger_level_critical()


class RoundedModel:
    """A formulation of the equations of motion, with constants rounded once to a number type.

    Args:
        formulation: the formulation.
        k: the constants, finer than the number type.
        number: type to compute in.

    Attributes:
        k: the constants in that type.
        symbols: heyoka's parameters in their place: scenes with the same exact zeros share the code
            of their equations.
        parameters: the values of these parameters, and then of constants that the equations do not
            have.
    """

    def __init__(self, formulation: Formulation, k: Constants, number: NumberType) -> None:
        self.formulation = formulation
        self.numbers = Numbers(number)
        self.k = k.converted(self.numbers.of)
        entries = self.k.entries()
        self.symbols = Constants.of({name: hy.par[i] for i, name in enumerate(entries)})
        self.parameters = [*entries.values()]

    def release(self, start: Start) -> list[Any]:
        """Return the state at t = 0, in numbers of the type."""
        return [self.numbers.of(value) for value in start.state(self.formulation)]

    def propagator(self, tolerance: float | None = None, radians: float = math.inf) -> Propagator:
        """Compile the equations, without events; the tolerance is the type's epsilon if None."""
        equations = rates(self.formulation, self.symbols)
        system = AutonomousSystem(self.formulation.variables, equations)
        number = self.numbers.number
        propagator = Propagator(system, number, tolerance=tolerance, radians=radians)
        propagator.parameters = self.parameters
        return propagator

    def doubles(self, states: Any) -> Array:
        """Return x, y, z in m and vx, vy, vz in m/s as the nearest doubles, shape (rows, 6).

        `states` has the shape (rows, variables).
        """
        n, v = self._cartesian(states)
        columns = []
        for component in (*n, *v):
            in_si = np.broadcast_to(component * self.k.length, len(states))
            columns.append(in_si.astype(np.float64))
        return np.array(columns).T.copy()

    def table(self, states: Any, bits: int) -> Table:
        """Return position, velocity and xddot as a table of integers over 2**bits, exactly as computed.

        `states` has the shape (rows, variables).
        """
        if len(states) == 0:
            return Table(RUN, bits, [])
        n, v = self._cartesian(states)
        ax = acceleration(n, v, self.k)[0]
        columns = []
        for component in (*n, *v, ax):
            in_si = np.asarray(component) * self.k.length
            columns.append(self.numbers.fixed(in_si, bits))
        return Table(RUN, bits, list(zip(*columns, strict=True)))

    def _cartesian(self, states: Any) -> Any:
        return self.formulation.cartesian(tuple(np.ascontiguousarray(states.T)), self.k, np)
