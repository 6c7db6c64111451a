"""Integration of truncated systems, with the constants as extra state variables so that scenes share compiled code.

The constants are carried along as variables whose derivative is zero. A sweep over latitudes then compiles one system
instead of one for each latitude, and compiling costs thirty times as much as the integration itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from reference import integrate
from reference.model.algebra import Functions, State
from reference.model.constants import Constants

from .approximation import Array

_USED = ("turn", "pull", "centrifugal", "drag")  # another would only take part in the choice of steps
MAX_STEPS = 3_000_000  # 30 days of Paris take 1.2 million; towards a singularity steps shrink without end

Derivatives = Callable[[State, Constants, Functions], State]


def integrated(
    variables: Sequence[str], derivatives: Derivatives, start: Sequence[Any], k: Constants, times: Array
) -> Array:
    """Integrate a system and return its states at the times.

    Args:
        variables: names of the state variables.
        derivatives: `derivatives(state, constants, functions)`; it may use the constants turn, pull, centrifugal and
            drag.
        start: the state at t = 0, mpf.
        k: constants in any number type; those that are exactly zero are left out of the system.
        times: increasing, from 0, in s.

    Returns:
        Shape (times, variables).

    Raises:
        IntegrationError: the motion comes to a singularity, or needs more than `MAX_STEPS` steps.
    """
    carried, count = k.entries(*_USED), len(variables)

    def rates(state: State, functions: Functions) -> State:
        constants = Constants.of(dict(zip(carried, state[count:], strict=True)))
        return (*derivatives(state[:count], constants, functions), *(0 for _ in carried))

    return integrate([*variables, *carried], rates, [*start, *carried.values()], times, max_steps=MAX_STEPS)[:, :count]
