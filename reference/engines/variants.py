"""Many trajectories in double with changed inputs or constants: the model compiled once, constants as parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..errors import InputError
from ..model.constants import Constants
from ..model.formulations import FORMULATIONS
from ..model.start import Start
from ..numbers.precision import DOUBLE, GUARD_BITS, Array
from ..scenes.inputs import Inputs

MAX_STEPS = 3_000_000  # of one run, so that a variant much stiffer than the scene comes to an end


class Variants:
    """The model in double, compiled once with every constant as a parameter, for runs with other inputs or constants.

    `spin` is used because it takes each term of the force by itself, so that a change to one leaves the others alone,
    and because it is neutral off the sphere at every angle.
    """

    _MODEL = FORMULATIONS["spin"]
    _PARAMETERS = (
        *(f"turn_{i}" for i in range(3)),
        *(f"pull_{i}" for i in range(3)),
        *(f"centrifugal_{i}" for i in range(4)),
        "drag",
    )

    def __init__(self) -> None:
        from .heyoka.propagator import Propagator

        self._propagator = Propagator(self._MODEL.variables, self._rates, DOUBLE, parameters=len(self._PARAMETERS))

    def states(self, inputs: Inputs, times: Array, alter: Callable[[Constants], Constants] | None = None) -> Array:
        """Return the states of one run.

        Args:
            inputs: the exact inputs of a scene, or changed ones.
            times: increasing, from 0, in s.
            alter: changes the constants that follow from them.

        Returns:
            x, y, z in m and vx, vy, vz in m/s, shape (times, 6).

        Raises:
            InputError: the release is beyond the cord's reach.
            IntegrationError: heyoka stops before the last time, or a state is not finite.
        """
        if inputs.position is not None and inputs.position[0] ** 2 + inputs.position[1] ** 2 >= inputs.length**2:
            raise InputError("release", "a point beyond the cord", "x² + y² less than length²")
        start = Start.of(inputs, DOUBLE.prec + GUARD_BITS)
        k = (start.k if alter is None else alter(start.k)).converted(float)
        return self.run([float(value) for value in (*start.n, *start.v)], times, k)

    def run(self, start: Sequence[float], times: Array, k: Constants) -> Array:
        """Return the states of one run from position and velocity over l (six numbers) with any constants.

        Returns:
            x, y, z in m and vx, vy, vz in m/s, shape (times, 6).

        Raises:
            IntegrationError: as in `states`.
        """
        entries = k.entries()
        state = [*start[:3], *np.cross(start[:3], start[3:])]
        parameters = [entries.get(name, 0.0) for name in self._PARAMETERS]
        rows = self._propagator.from_zero(state, times, parameters, MAX_STEPS)
        n_rows, spin = rows[:, :3], rows[:, 3:]
        return np.hstack([n_rows, np.cross(spin, n_rows)]) * float(k.length)

    @classmethod
    def _rates(cls, state: Sequence[Any], functions: Any, parameters: Sequence[Any]) -> Sequence[Any]:
        k = Constants.of(dict(zip(cls._PARAMETERS, parameters, strict=True)))
        return cls._MODEL.derivatives(state, k, functions)
