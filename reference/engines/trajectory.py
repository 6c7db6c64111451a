"""Trajectories in one run, unconfirmed: any system written in the model's generic style, and the model itself.

What this gives is as good as its number type, no better: `solver.solve` is the way to digits that are known.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from ..errors import InputError
from ..model.constants import Constants, constants, release, scaled
from ..model.mechanics import FORMULATIONS
from ..precision import DOUBLE, GUARD_BITS, Array, NumberType, context
from ..scene import Inputs, Scene


def integrate(
    variables: Sequence[str],
    derivatives: Callable[..., Sequence[Any]],
    start: Sequence[Any],
    times: Sequence[Any] | Array,
    *,
    number: NumberType = DOUBLE,
    tolerance: float | None = None,
) -> Array:
    """Solve an autonomous system with heyoka's Taylor method.

    Args:
        variables: names of the state's variables.
        derivatives: `derivatives(state, functions)` gives their rates; `functions` offers sqrt, sin, cos.
        start: the state at t = 0; mpf, Fraction or float.
        times: increasing, from 0, in s.
        number: type to compute in.
        tolerance: relative error of a step, the type's epsilon if None.

    Returns:
        The states as binary64, shape (times, variables).

    Raises:
        IntegrationError: no success; no numbers then.
    """
    from .heyoka import taylor

    flow = taylor.Flow(variables, derivatives, number, tolerance=tolerance)
    of = flow.numbers.of
    states = flow.from_zero([of(_exact(v)) for v in start], [of(_exact(t)) for t in times])
    return np.asarray(states.astype(float))


def trajectory(
    scene: Scene,
    times: Sequence[Any] | Array,
    *,
    formulation: str = "momentum",
    number: NumberType = DOUBLE,
    tolerance: float | None = None,
    alter: Callable[[Constants], Constants] | None = None,
) -> Array:
    """One run of the model.

    Args:
        scene: whose exact inputs are used.
        times: increasing, from 0, in s.
        formulation: a word of `mechanics.FORMULATIONS`.
        number: type to compute in.
        tolerance: relative error of a step, the type's epsilon if None.
        alter: changes the model's constants, to ask what a program with another model would find.

    Returns:
        x, y, z in m and vx, vy, vz in m/s as binary64, shape (times, 6).
    """
    ctx = context(number.prec + GUARD_BITS)
    k = constants(scene.exact, ctx)
    n, v = (scaled(vector, k.length) for vector in release(scene.exact, ctx))
    k = k if alter is None else alter(k)
    from .heyoka import taylor

    model = FORMULATIONS[formulation]
    numbers = taylor.Numbers(number)
    rounded = k.converted(numbers.of)
    flow = taylor.Flow(model.variables, taylor.rates(model, rounded), number, tolerance=tolerance)
    start = [numbers.of(value) for value in model.start(n, v, k, ctx)]
    states = flow.from_zero(start, [numbers.of(_exact(t)) for t in times])
    columns = tuple(np.ascontiguousarray(states.T))
    position, velocity = model.cartesian(columns, rounded, np)
    rows = np.array([np.broadcast_to(part * rounded.length, len(states)) for part in (*position, *velocity)])
    return np.asarray(rows.T.astype(float))


MAX_STEPS = 3_000_000  # of a variant: a guess that is stiffer than the scene is not followed for ever


class Variants:
    """The model compiled once with every constant open, in double: what other inputs or constants would give.

    `spin` is used because it takes each term of the force by itself (a change to one leaves the others alone)
    and stays on the sphere at every angle.
    """

    _MODEL = FORMULATIONS["spin"]

    def __init__(self) -> None:
        from .heyoka import taylor

        self._ctx = context(DOUBLE.prec + GUARD_BITS)
        self._flow = taylor.Flow(self._MODEL.variables, self._rates, DOUBLE, parameters=9)

    def states(self, inputs: Inputs, times: Array, alter: Callable[[Constants], Constants] | None = None) -> Array:
        """One run.

        Args:
            inputs: the exact inputs of a scene, or changed ones.
            times: increasing, from 0, in s.
            alter: changes the constants that follow from them.

        Returns:
            x, y, z in m and vx, vy, vz in m/s, shape (times, 6).

        Raises:
            InputError: the release is beyond the cord's reach.
            IntegrationError: no success; no numbers then.
        """
        if inputs.position is not None and inputs.position[0] ** 2 + inputs.position[1] ** 2 >= inputs.length**2:
            raise InputError("release", "a point beyond the cord", "x² + y² less than length²")
        k = constants(inputs, self._ctx)
        n, v = (scaled(vector, k.length) for vector in release(inputs, self._ctx))
        k = (k if alter is None else alter(k)).converted(float)
        start = [float(value) for value in self._MODEL.start(n, v, k, self._ctx)]
        open_ = [float(value) for value in (*k.turn[1:], *k.pull[1:], *k.centrifugal, k.drag)]
        rows = self._flow.from_zero(start, times, open_, MAX_STEPS)
        n_rows, spin = rows[:, :3], rows[:, 3:]
        return np.hstack([n_rows, np.cross(spin, n_rows)]) * float(k.length)

    @classmethod
    def _rates(cls, state: Sequence[Any], functions: Any, parameters: Sequence[Any]) -> Sequence[Any]:
        turn_y, turn_z, pull_y, pull_z, xx, yy, yz, zz, drag = parameters
        k = Constants(1, (0, turn_y, turn_z), (0, pull_y, pull_z), (xx, yy, yz, zz), drag, 0, 0, 0, 0, 0)
        return cls._MODEL.derivatives(state, k, functions)


def _exact(value: Any) -> Any:
    """Floats become the fractions they are; mpf, Fraction and int stay."""
    return Fraction(*value.as_integer_ratio()) if isinstance(value, float | np.floating) else value
