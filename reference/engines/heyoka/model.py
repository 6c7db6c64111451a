"""heyoka's number types, with exact conversions; its integrator of any system, without events; the model in it.

The modules that make heyoka's arrays import this one, so that its memory handler is installed: without it arrays of
`real` leak.
"""

from __future__ import annotations

import math
from typing import Any

import heyoka as hy
import numpy as np

from ...model.constants import Constants
from ...model.force import acceleration
from ...model.formulations import Formulation
from ...model.start import Start
from ...numbers.columns import RUN
from ...numbers.precision import Array, NumberType
from ...numbers.table import Table
from .conversions import Numbers
from .propagator import Propagator
from .system import rates

hy.install_custom_numpy_mem_handler()
# its log is the process's stdout; what it would tell of lost roots is found otherwise
hy.set_logger_level_critical()


class RoundedModel:
    """A formulation of the equations of motion, with constants rounded once to a number type.

    Args:
        formulation: the formulation.
        k: the constants, finer than the number type.
        number: type to compute in.

    Attributes:
        k: the constants in that type.
        symbols: heyoka's parameters in their place: scenes with the same exact zeros share the code of their equations.
        parameters: the values of these parameters, and then of constants that the equations do not have.
    """

    def __init__(self, formulation: Formulation, k: Constants, number: NumberType) -> None:
        self.formulation, self.numbers = formulation, Numbers(number)
        self.k = k.converted(self.numbers.of)
        entries = self.k.entries()
        self.symbols = Constants.of({name: hy.par[i] for i, name in enumerate(entries)})
        self.parameters = [*entries.values()]

    def release(self, start: Start) -> list[Any]:
        """Return the state at t = 0, in numbers of the type."""
        return [self.numbers.of(value) for value in start.state(self.formulation)]

    def propagator(self, tolerance: float | None = None, radians: float = math.inf) -> Propagator:
        """Compile the equations, without events; the tolerance is the type's epsilon if None."""
        variables, equations = self.formulation.variables, rates(self.formulation, self.symbols)
        made = Propagator(
            variables, equations, self.numbers.number, tolerance=tolerance, radians=radians
        )
        made.parameters = self.parameters
        return made

    def doubles(self, states: Any) -> Array:
        """Return x, y, z in m and vx, vy, vz in m/s, nearest doubles, from states of shape (rows, variables)."""
        n, v = self._cartesian(states)
        columns = [np.broadcast_to(part * self.k.length, len(states)) for part in (*n, *v)]
        return np.array([column.astype(np.float64) for column in columns]).T.copy()

    def table(self, states: Any, bits: int) -> Table:
        """Return `columns.RUN` over 2**bits, exactly as computed, from states of shape (rows, variables)."""
        if len(states) == 0:
            return Table(RUN, bits, [])
        n, v = self._cartesian(states)
        ax = acceleration(n, v, self.k)[0]
        fixed = [
            self.numbers.fixed(np.asarray(column) * self.k.length, bits) for column in (*n, *v, ax)
        ]
        return Table(RUN, bits, list(zip(*fixed, strict=True)))

    def _cartesian(self, states: Any) -> Any:
        return self.formulation.cartesian(tuple(np.ascontiguousarray(states.T)), self.k, np)
