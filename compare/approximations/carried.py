"""Systems in the model's generic style, compiled once for all scenes that have the same terms.

The constants ride along as variables that do not change: a sweep over latitudes then compiles one system instead of
one for each, which otherwise costs thirty times the integration itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from reference import integrate
from reference.model.algebra import Functions, State
from reference.model.constants import Constants, is_zero

from .approximation import Array

_GROUPS = {"turn": 3, "pull": 3, "centrifugal": 4, "drag": 1}  # what the equations of motion hold

Derivatives = Callable[[State, Constants, Functions], State]


def integrated(
    variables: Sequence[str], derivatives: Derivatives, start: Sequence[Any], k: Constants, times: Array
) -> Array:
    """States of a system at the times.

    Args:
        variables: names of the state's variables.
        derivatives: `derivatives(state, constants, functions)`, of the constants turn, pull, centrifugal and drag.
        start: the state at t = 0, mpf.
        k: constants in any number type; what is exactly zero stays out of the system.
        times: increasing, from 0, in s.

    Returns:
        Shape (times, variables).
    """
    flat = [(name, i, _entries(k, name)[i]) for name, size in _GROUPS.items() for i in range(size)]
    kept = [(name, i, value) for name, i, value in flat if not is_zero(value)]
    count = len(variables)

    def rates(state: State, functions: Functions) -> State:
        groups: dict[str, list[Any]] = {name: [0] * size for name, size in _GROUPS.items()}
        for (name, i, _), value in zip(kept, state[count:], strict=True):
            groups[name][i] = value
        drag = groups.pop("drag")[0]
        here = replace(k, drag=drag, **{name: tuple(values) for name, values in groups.items()})
        return (*derivatives(state[:count], here, functions), *(0 for _ in kept))

    names = [*variables, *(f"{name}_{i}" for name, i, _ in kept)]
    return integrate(names, rates, [*start, *(value for _, _, value in kept)], times)[:, :count]


def _entries(k: Constants, name: str) -> tuple[Any, ...]:
    value = getattr(k, name)
    return value if isinstance(value, tuple) else (value,)
