"""Explicit Runge-Kutta and Runge-Kutta-Nyström steps at a fixed step size, traced to code and compiled in a loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from reference.model.algebra import plus, product

from ..rhs.problem import Array, Problem
from ..rhs.program import Program
from .method import Family, Method, Outcome, Work, outcome
from .tableau import NystromTableau, Tableau

Derivatives = Callable[[Sequence[Any]], Sequence[Any]]
Step = Callable[[Sequence[Any], Any, Derivatives], Sequence[Any]]

# a step may be longer than the setting by this part: 60 s then hold 600 steps of 0.1 s, although 0.1 is not a double
ROUNDING = 1e-9

_MARCH = """
@nb.njit("int64(float64[::1], float64[::1], float64[::1], int64[::1], float64[:, ::1])", **OPTIONS)
def march(y, k, times, counts, states):
    ${unpack_state}
    ${unpack_parameters}
    for row in range(1, len(times)):
        h = (times[row] - times[row - 1]) / counts[row]
        for _ in range(counts[row]):
            ${x}= step(${x}${c}h)
        ${out}= ${x}
        if not np.isfinite(states[row]).all():
            return row + 1
    return len(times)
"""


def traced_step(problem: Problem, step: Step) -> Program:
    """Trace a step to straight-line code: its inputs are state, parameters and h, its outputs the new state."""

    def whole_step(state: Sequence[Any], functions: Any, parameters: Any) -> Sequence[Any]:
        constants = {name: number for name, number in parameters.items() if name != "h"}
        return step(state, parameters["h"], lambda at: problem.system.rates(at, functions, constants))

    return problem.system.traced(whole_step, "h")


def prepare_fixed(problem: Problem, setting: float, step: Step, stages: int) -> Work:
    """Compile a step for a problem's system; the returned function takes all steps.

    Args:
        problem: to be solved.
        setting: step in s; shortened where output times are not a whole number of steps apart.
        step: `step(state, h, derivatives)` in the model's generic style.
        stages: evaluations of the right-hand side in a step.
    """
    from ..rhs.compiled import compiled, elements, fill, function_text, names, unpacked

    variables, parameters = len(problem.start), len(problem.system.parameters)
    loop = fill(
        _MARCH,
        unpack_state=unpacked("x", "y", variables),
        unpack_parameters=unpacked("c", "k", parameters),
        x=names("x", variables),
        c=names("c", parameters),
        out=elements("states", variables, "row"),
    )
    march = compiled(function_text(traced_step(problem, step), "step") + loop).march
    counts = steps_between(problem.times, setting)

    def work() -> Outcome:
        states = np.empty((len(problem.times), variables))
        states[0] = problem.start
        rows = march(problem.start, problem.parameters, problem.times, counts, states)
        steps = int(counts[:rows].sum())
        return outcome(problem, states[:rows], steps=steps, rhs_evaluations=stages * steps)

    return work


def steps_between(times: Array, step: float) -> Any:
    """Return the number of steps that lead to each time from the one before (0 for the first), shape (rows,)."""
    counts = np.ceil(np.diff(times, prepend=times[0]) / step * (1 - ROUNDING)).astype(np.int64)
    counts[1:] = np.maximum(counts[1:], 1)
    return counts


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

        def stage(c: Fraction, position: Sequence[Fraction], velocity: Sequence[Fraction]) -> list[Any]:
            straight = moved(y, 1, (c,), [[product(h, v) for v in rate]])
            bent = [product(h, h, part) for part in combined(position, forces, half)]
            return [*map(plus, straight, bent), *moved(rate, h, velocity, forces)]

        for c, position, velocity in zip(tableau.c, tableau.position, tableau.velocity, strict=True):
            forces.append(derivatives(stage(c, position, velocity))[half:])
        return stage(Fraction(1), tableau.position_weights, tableau.velocity_weights)

    return step


def nystrom_method(
    name: str, title: str, tableau: NystromTableau, ladder: tuple[float, ...], source: str, **runs: Any
) -> Method:
    """Declare a Runge-Kutta-Nyström method with a fixed step, for formulations whose state is (y, y')."""

    def prepare(problem: Problem, setting: float) -> Work:
        return prepare_fixed(problem, setting, nystrom(tableau), stages=len(tableau.c))

    return Method(
        id=name,
        title=title,
        setting="step",
        ladder=ladder,
        source=source,
        licence="this project's",
        prepare=prepare,
        formulations=("plane", "space"),
        dense=False,
        requires=("numba",),
        extra="methods",
        order=tableau.order,
        family=Family.PAPER,
        libraries=("numpy", "numba"),
        **runs,
    )


def combined(weights: Sequence[Fraction], slopes: Sequence[Sequence[Any]], size: int) -> list[Any]:
    """Return Σ weight slope for each of `size` components; a slope with weight zero is left out."""
    exact = [0 if weight == 0 else weight for weight in weights]
    return [plus(*(product(w, slope[i]) for w, slope in zip(exact, slopes, strict=True))) for i in range(size)]


def moved(state: Sequence[Any], h: Any, weights: Sequence[Fraction], slopes: Sequence[Sequence[Any]]) -> list[Any]:
    """Return state + h Σ weight slope."""
    return [plus(x, product(h, part)) for x, part in zip(state, combined(weights, slopes, len(state)), strict=True)]
