"""Many trajectories in double with changed inputs or constants: the model compiled once, constants as parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import InputError
from ..model.constants import Constants
from ..model.formulations import FORMULATIONS
from ..model.start import Start
from ..precision import DOUBLE, GUARD_BITS, Array
from ..scene import Inputs

MAX_STEPS = 3_000_000  # of one run, so that a variant much stiffer than the scene comes to an end


class Variants:
    """The model in double, compiled once with every constant as a parameter, for runs with other inputs or constants.

    `spin` is used because it takes each term of the force by itself, so that a change to one leaves the others alone,
    and because it is neutral off the sphere at every angle.
    """

    _MODEL = FORMULATIONS["spin"]

    def __init__(self) -> None:
        from .heyoka.propagator import Propagator

        self._propagator = Propagator(self._MODEL.variables, self._rates, DOUBLE, parameters=9)

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
        state = [float(value) for value in replace(start, k=k).state(self._MODEL)]
        parameters = [float(value) for value in (*k.turn[1:], *k.pull[1:], *k.centrifugal, k.drag)]
        rows = self._propagator.from_zero(state, times, parameters, MAX_STEPS)
        n_rows, spin = rows[:, :3], rows[:, 3:]
        return np.hstack([n_rows, np.cross(spin, n_rows)]) * float(k.length)

    @classmethod
    def _rates(cls, state: Sequence[Any], functions: Any, parameters: Sequence[Any]) -> Sequence[Any]:
        turn_y, turn_z, pull_y, pull_z, xx, yy, yz, zz, drag = parameters
        k = Constants(turn=(0, turn_y, turn_z), pull=(0, pull_y, pull_z), centrifugal=(xx, yy, yz, zz), drag=drag)
        return cls._MODEL.derivatives(state, k, functions)
