"""Integrate Mathar (43) at a fixed step for foucPend, in blocks of steps, so that a long run needs little memory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from reference import InputError, IntegrationError
from reference.numbers.precision import Array

from ..approximations.mathar_items import VARIABLES, derivatives, truncated
from ..methods import METHODS, FirstOrderSystem, Problem, available
from .options import Options

BLOCK = 100_000  # steps whose states are in memory at a time
# the items of section VI that the two lowest bits of -a leave out
ITEMS = (frozenset[Any](), frozenset({2}), frozenset({1}), frozenset({1, 2}))


def blocks(options: Options) -> Iterator[tuple[Array, Array]]:
    """Yield blocks of times in s and states x, y, z, vx, vy, vz, shape (rows, 6).

    The first row of a block is the last one of the block before it.

    Raises:
        InputError: numba is not installed.
        IntegrationError: the bob reaches the height of the suspension, or the run fails otherwise.
    """
    method = METHODS[options.method]
    missing = available(method)
    if missing is not None:
        raise InputError("-R", options.method, "a method that is installed", f"It is {missing}.")
    step = float(options.step)
    problem = _problem(options, step)
    first = 0
    while first < options.steps:
        count = min(BLOCK, options.steps - first)
        times: Array = np.arange(count + 1, dtype=np.float64) * step
        problem = replace(problem, times=times)
        outcome = method.prepare(problem, step)()
        states = outcome.states
        if len(states) <= count:
            raise IntegrationError(
                f"{method.title} at {step:g} s fails after t = {first * step + outcome.reached_t:g} s.",
                "The equations in x and y hold below the suspension; a shorter step (-t) may help.",
            )
        yield np.asarray((first + np.arange(count + 1)) * step, dtype=np.float64), states
        problem = replace(problem, start=states[-1, [0, 1, 3, 4]] / problem.constants.length)
        first += count


def _problem(options: Options, step: float) -> Problem:
    problem = Problem.of(options.scene, "plane", [0.0, step])
    items = ITEMS[options.bits % len(ITEMS)]
    if not items:
        return problem
    k = truncated(problem.constants, items)
    return replace(problem, system=FirstOrderSystem.of(VARIABLES, partial(derivatives, items=items), k))
