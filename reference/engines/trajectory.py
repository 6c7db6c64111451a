"""Trajectories as binary64 from a single, unconfirmed run.

They are those of the model, or of any autonomous system.

They are as good as their number type and tolerance, no better: `solver.solve` gives digits whose
error is known.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import (
    BeyondDoublesError,
    Described,
    InputError,
    IntegrationError,
    check_whole,
    counted,
    unknown,
)
from ..model.carried import carried
from ..model.constants import Constants
from ..model.formulations import FORMULATIONS
from ..model.start import Start
from ..numbers.precision import DOUBLE, GUARD_BITS, Array, NumberType
from ..scenes.inputs import Inputs
from ..scenes.scene import AnyScene, as_scene

# Of one run: 30 days of Paris take 1.2 million, but a variant may be much stiffer, and towards a
# singularity steps shrink without end.
MAX_STEPS = 3_000_000


class Variants:
    """The model in double, compiled once, for runs with other inputs or constants.

    Every constant is a parameter.

    `spin` is used because it takes each term of the force by itself, so that a change to one leaves
    the others alone, and because it is neutral off the sphere at every angle.
    """

    _MODEL = FORMULATIONS["spin"]
    _PARAMETERS = (
        "turn_0", "turn_1", "turn_2", "pull_0", "pull_1", "pull_2",
        "centrifugal_0", "centrifugal_1", "centrifugal_2", "centrifugal_3", "drag",
    )  # fmt: skip

    def __init__(self) -> None:
        from .heyoka.propagator import AutonomousSystem, Propagator

        count = len(self._PARAMETERS)
        system = AutonomousSystem(self._MODEL.variables, self._rates, count)
        self._propagator = Propagator(system, DOUBLE)

    def states(
        self, inputs: Inputs, times: Array, alter: Callable[[Constants], Constants] | None = None
    ) -> Array:
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
        if inputs.position is not None:
            x, y, *_ = inputs.position
            if x**2 + y**2 >= inputs.length**2:
                got = Described("a point out of the cord's reach")
                raise InputError("release", got, "x² + y² less than length²")
        start = Start.of(inputs, DOUBLE.prec + GUARD_BITS)
        k = start.k if alter is None else alter(start.k)
        release = [float(value) for value in (*start.n, *start.v)]
        return self.run(release, times, k.converted(float))

    def run(self, start: Sequence[float], times: Array, k: Constants) -> Array:
        """Return the states of one run with any constants.

        Args:
            start: position and velocity over l, six numbers.
            times: increasing, from 0, in s.
            k: the constants.

        Returns:
            x, y, z in m and vx, vy, vz in m/s, shape (times, 6).

        Raises:
            IntegrationError: as in `states`.
        """
        entries = k.entries()
        state = [*start[:3], *np.cross(start[:3], start[3:])]
        parameters = [entries.get(name, 0.0) for name in self._PARAMETERS]
        rows = self._propagator.from_zero(state, times, parameters, MAX_STEPS)
        n = rows[:, :3]
        spin = rows[:, 3:]
        return np.hstack([n, np.cross(spin, n)]) * float(k.length)

    @classmethod
    def _rates(
        cls, state: Sequence[Any], functions: Any, parameters: Sequence[Any]
    ) -> Sequence[Any]:
        k = Constants.of(dict(zip(cls._PARAMETERS, parameters, strict=True)))
        return cls._MODEL.derivatives(state, k, functions)


# most steps while the scene's fastest rate goes through a radian: a run takes one or two
_STEPS_PER_RADIAN = 100
_LEAST_STEPS = 10_000  # and of a whole run
_SINGULAR = {
    "plane": "at the horizontal",
    "angles": "on the vertical",
    "lagrangian": "on the vertical",
}


def integrate(
    variables: Sequence[str],
    derivatives: Callable[..., Sequence[Any]],
    start: Sequence[Any],
    times: Sequence[Any] | Array,
    *,
    number: NumberType = DOUBLE,
    tolerance: float | None = None,
    max_steps: int = 0,
) -> Array:
    """Solve an autonomous system with heyoka's Taylor method.

    Args:
        variables: names of the state's variables.
        derivatives: `derivatives(state, functions)` returns their rates; `functions` offers sqrt,
            sin, cos.
        start: the state at t = 0; mpf, Fraction or float.
        times: increasing, from 0, in s.
        number: type to compute in.
        tolerance: relative error of a step, the type's epsilon if None.
        max_steps: largest number of steps; 0 for no limit.

    Returns:
        The states as binary64, shape (times, variables).

    Raises:
        InputError: times that do not increase from 0; a wrong number type, tolerance or
            `max_steps`; variables that are no names; not as many rates, or numbers of `start`, as
            variables, or others than numbers.
        IntegrationError: heyoka stops before the last time, also because `max_steps` do not
            suffice, or a state is not finite.
    """
    from .heyoka.propagator import AutonomousSystem, Propagator

    _check_number(number)
    check_whole("max_steps", max_steps, 0, "a whole number of steps, or 0 for any number")
    if not callable(derivatives):
        raise InputError("derivatives", derivatives, "a function derivatives(state, functions)")
    names = list(variables) if isinstance(variables, Iterable) else []
    if not names or not all(isinstance(name, str) for name in names) or len({*names}) < len(names):
        raise InputError("variables", variables, "a different name for each variable")
    system = AutonomousSystem(names, derivatives)
    propagator = Propagator(system, number, tolerance=tolerance)
    numbers = propagator.numbers
    expected = f"{counted(len(names), 'finite number')}, one for each variable"
    state = _numbers("start", start, numbers, expected)
    if len(state) != len(names):
        raise InputError("start", start, f"{counted(len(names), 'number')}, one for each variable")
    states = propagator.from_zero(state, _from_zero(times, numbers), max_steps=max_steps)
    return np.asarray(states.astype(float))


def trajectory(
    scene: AnyScene,
    times: Sequence[Any] | Array,
    *,
    formulation: str = "momentum",
    number: NumberType = DOUBLE,
    tolerance: float | None = None,
    alter: Callable[[Constants], Constants] | None = None,
) -> Array:
    """Integrate a scene in one run.

    Args:
        scene: a scene, its id, the path of a TOML file, or nested mappings; its exact inputs are
            used.
        times: increasing, from 0, in s.
        formulation: a name of `model.formulations.FORMULATIONS`.
        number: type to compute in.
        tolerance: relative error of a step, the type's epsilon if None.
        alter: function that changes the model's constants, to get the motion that a program with
            another model would compute.

    Returns:
        x, y, z in m and vx, vy, vz in m/s as binary64, shape (times, 6).

    Raises:
        InputError: a wrong scene, formulation or tolerance; times that do not increase from 0.
        UnreachableError: a number of the scene is too large.
        IntegrationError: heyoka stops before the last time, for example where the formulation is
            singular.
    """
    scene = as_scene(scene)
    if formulation not in FORMULATIONS:
        raise unknown(
            "formulation", formulation, f"one of {', '.join(FORMULATIONS)}", FORMULATIONS, ""
        )
    _check_number(number)
    start = Start.of(scene.exact, number.prec + GUARD_BITS)
    if alter is not None:
        start = replace(start, k=alter(start.k))
    from .heyoka.conversions import Numbers
    from .heyoka.model import RoundedModel

    try:
        rounded = carried(FORMULATIONS[formulation], start, Numbers(number).of)
        model = RoundedModel(rounded, start.k, number)
        moments = _from_zero(times, model.numbers)
        release = model.release(start)
    except OverflowError:
        raise BeyondDoublesError from None
    radians = start.fastest_rate * float(moments[-1])
    max_steps = _LEAST_STEPS + math.ceil(_STEPS_PER_RADIAN * radians)
    propagator = model.propagator(tolerance, radians)
    try:
        states = propagator.from_zero(release, moments, max_steps=max_steps)
    except IntegrationError as error:
        advice = ""
        if formulation in _SINGULAR:
            where = _SINGULAR[formulation]
            advice = f"The formulation {formulation} is singular {where}: use momentum."
        raise IntegrationError(error.reason, advice) from None
    rows = model.doubles(states)
    # a formulation rounds the release
    rows[0] = [float(part * start.k.length) for part in (*start.n, *start.v)]
    return rows


def _check_number(number: object) -> None:
    if not isinstance(number, NumberType):
        raise InputError(
            "number", number, "DOUBLE, LONG_DOUBLE or real(BITS) of reference.numbers.precision"
        )


def _from_zero(times: Sequence[Any] | Array, numbers: Any) -> Any:
    """Return times as heyoka's numbers of a run's type."""
    expected = "increasing times in s, the first of them 0"
    moments = _numbers("times", times, numbers, expected)
    line = np.array(moments, dtype=numbers.dtype)
    starts_at_zero = line.ndim == 1 and line.size and line[0] == 0
    if not starts_at_zero or not (line[1:] > line[:-1]).all():
        raise InputError("times", times, expected)
    return moments


def _numbers(field: str, values: Any, numbers: Any, expected: str) -> Any:
    """Return what a caller gave as heyoka's numbers of a run's type."""
    try:
        return numbers.all_of(values)
    # raised for what is no number, and for infinity and NaN
    except (ArithmeticError, AttributeError, TypeError, ValueError):
        raise InputError(field, values, expected) from None
