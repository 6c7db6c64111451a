"""Integration at a fixed step size: a tableau's step, traced to code and compiled in a loop over the output times.

The steps of Runge-Kutta and Runge-Kutta-Nyström tableaux are in the model's generic style.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from reference.model.algebra import plus, product
from reference.numbers.precision import Array

from .method import Method, RunOutcome, Work, outcome
from .rhs.problem import Problem
from .rhs.straight_line import StraightLine, elements
from .tableau import NystromTableau, Tableau

Derivatives = Callable[[Sequence[Any]], Sequence[Any]]
Step = Callable[[Sequence[Any], Any, Derivatives], Sequence[Any]]
# a step may be longer than the setting by this part: 60 s then hold 600 steps of 0.1 s, although
# 0.1 is not a double
ROUNDING = 1e-9
_MARCH = """
@nb.njit("int64(float64[::1], float64[::1], float64[::1], int64[::1], float64[:, ::1])", **OPTIONS)
def march(y, k, times, counts, states):
    ${unpack_y}
    ${unpack_k}
    for row in range(1, len(times)):
        h = (times[row] - times[row - 1]) / counts[row]
        for _ in range(counts[row]):
            ${x}= traced(${x}${c}h)
        ${out}= ${x}
        if not np.isfinite(states[row]).all():
            return row + 1
    return len(times)
"""


# a method of this project's that takes steps of a fixed size, compiled by numba
fixed_step = partial(
    Method,
    setting="step",
    licence="this project's",
    requires=("numba",),
    extra="methods",
)


def runge_kutta(tableau: Tableau) -> Step:
    """Return the step of an explicit Runge-Kutta method."""

    def step(state: Sequence[Any], h: Any, derivatives: Derivatives) -> Sequence[Any]:
        slopes: list[Sequence[Any]] = []
        for row in tableau.a:
            slopes.append(derivatives(moved(state, h, row, slopes)))
        return moved(state, h, tableau.b, slopes)

    return step


def nystrom(tableau: NystromTableau) -> Step:
    """Return the step of an explicit Runge-Kutta-Nyström method, for formulations whose state is (y, y')."""

    def step(state: Sequence[Any], h: Any, derivatives: Derivatives) -> Sequence[Any]:
        half = len(state) // 2
        y, rate = state[:half], state[half:]
        forces: list[Sequence[Any]] = []

        def stage(
            c: Fraction, position: Sequence[Fraction], velocity: Sequence[Fraction]
        ) -> list[Any]:
            straight = moved(y, 1, (c,), [[product(h, v) for v in rate]])
            bent = [product(h, h, part) for part in combined(position, forces, half)]
            return [*map(plus, straight, bent), *moved(rate, h, velocity, forces)]

        for c, position, velocity in zip(
            tableau.c, tableau.position, tableau.velocity, strict=True
        ):
            forces.append(derivatives(stage(c, position, velocity))[half:])
        return stage(Fraction(1), tableau.position_weights, tableau.velocity_weights)

    return step


def combined(weights: Sequence[Fraction], slopes: Sequence[Sequence[Any]], size: int) -> list[Any]:
    """Return Σ weight slope for each of `size` components; a slope with weight zero is left out."""
    exact = [0 if weight == 0 else weight for weight in weights]
    return [
        plus(*(product(w, slope[i]) for w, slope in zip(exact, slopes, strict=True)))
        for i in range(size)
    ]


def moved(
    state: Sequence[Any], h: Any, weights: Sequence[Fraction], slopes: Sequence[Sequence[Any]]
) -> list[Any]:
    """Return state + h Σ weight slope."""
    return [
        plus(x, product(h, part))
        for x, part in zip(state, combined(weights, slopes, len(state)), strict=True)
    ]


def traced_step(problem: Problem, step: Step) -> StraightLine:
    """Trace a step to straight-line code: its inputs are state, parameters and h, its outputs the new state."""
    rates = problem.system.rates
    return problem.system.traced(
        lambda state, functions, k, h: step(state, h, lambda at: rates(at, functions, k)), "h"
    )


def explicit(step: Step, stages: int) -> Callable[[Problem, float], Work]:
    """Return the `prepare` of a method that takes explicit steps of a fixed size in s.

    The step is compiled for a problem's system. It is shortened where output times are not a whole
    number of steps apart, and the run ends after the first output time at which the state is not
    finite.

    Args:
        step: `step(state, h, derivatives)` in the model's generic style.
        stages: evaluations of the right-hand side in a step.
    """

    def prepare(problem: Problem, setting: float) -> Work:
        variables = len(problem.start)
        march = problem.compiled(
            traced_step(problem, step), _MARCH, out=elements("states", variables, "row")
        ).march
        counts = steps_between(problem.times, setting)

        def work() -> RunOutcome:
            states = np.empty((len(problem.times), variables))
            states[0] = problem.start
            rows = march(problem.start, problem.parameters, problem.times, counts, states)
            steps = int(counts[:rows].sum())
            return outcome(problem, states[:rows], steps=steps, rhs_evaluations=stages * steps)

        return work

    return prepare


def steps_between(times: Array, step: float) -> Any:
    """Return the number of steps from the previous time to each time (0 for the first), shape (rows,)."""
    counts = np.ceil(np.diff(times, prepend=times[0]) / step * (1 - ROUNDING)).astype(np.int64)
    counts[1:] = np.maximum(counts[1:], 1)
    return counts
