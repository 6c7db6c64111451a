"""Integration of truncated systems, with the constants as extra state variables so that scenes share compiled code.

The constants are carried along as variables whose derivative is zero. A sweep over latitudes then compiles one system
instead of one for each latitude, and compiling costs thirty times as much as the integration itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from reference import integrate
from reference.model.algebra import Functions, State
from reference.model.constants import Constants, is_zero

from .approximation import Array

_GROUPS = {"turn": 3, "pull": 3, "centrifugal": 4, "drag": 1}  # constants of the equations of motion: entries of each

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
    """
    flat = [(name, i, _entries(k, name)[i]) for name, size in _GROUPS.items() for i in range(size)]
    carried = [(name, i, value) for name, i, value in flat if not is_zero(value)]
    count = len(variables)

    def rates(state: State, functions: Functions) -> State:
        groups: dict[str, list[Any]] = {name: [0] * size for name, size in _GROUPS.items()}
        for (name, i, _), value in zip(carried, state[count:], strict=True):
            groups[name][i] = value
        drag = groups.pop("drag")[0]
        constants = replace(k, drag=drag, **{name: tuple(values) for name, values in groups.items()})
        return (*derivatives(state[:count], constants, functions), *(0 for _ in carried))

    names = [*variables, *(f"{name}_{i}" for name, i, _ in carried)]
    return integrate(names, rates, [*start, *(value for _, _, value in carried)], times)[:, :count]


def _entries(k: Constants, name: str) -> tuple[Any, ...]:
    value = getattr(k, name)
    return value if isinstance(value, tuple) else (value,)
