"""Trajectories in one run, unconfirmed: any system written in the model's generic style, and the model itself.

What this gives is as good as its number type, no better: `solver.solve` is the way to digits that are known.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from ..model.constants import Constants, constants, release, scaled
from ..model.formulations import FORMULATIONS
from ..precision import DOUBLE, GUARD_BITS, Array, NumberType, context
from ..scene import Scene


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
    from .heyoka.propagator import Propagator

    flow = Propagator(variables, derivatives, number, tolerance=tolerance)
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
    from .heyoka.numbers import Numbers
    from .heyoka.propagator import Propagator
    from .heyoka.system import rates

    model = FORMULATIONS[formulation]
    numbers = Numbers(number)
    rounded = k.converted(numbers.of)
    flow = Propagator(model.variables, rates(model, rounded), number, tolerance=tolerance)
    start = [numbers.of(value) for value in model.start(n, v, k, ctx)]
    states = flow.from_zero(start, [numbers.of(_exact(t)) for t in times])
    columns = tuple(np.ascontiguousarray(states.T))
    position, velocity = model.cartesian(columns, rounded, np)
    rows = np.array([np.broadcast_to(part * rounded.length, len(states)) for part in (*position, *velocity)])
    return np.asarray(rows.T.astype(float))


def _exact(value: Any) -> Any:
    """Floats become the fractions they are; mpf, Fraction and int stay."""
    return Fraction(*value.as_integer_ratio()) if isinstance(value, float | np.floating) else value
