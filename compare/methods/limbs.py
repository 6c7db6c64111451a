"""Taylor series, order set by the precision, adaptive step: the reference's engine `limbs`, in limbs of 22 bits."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from reference.numbers.columns import STATE
from reference.status import Status

from .method import Family, Method, RunOutcome, Work, failed
from .rhs.problem import Problem


def prepare(problem: Problem, setting: float) -> Work:
    """Compile the engine's kernels by a short first run.

    The returned function makes the whole run.
    """
    from reference import IntegrationError
    from reference.engines.registry import engines

    limbs, inputs = engines()["limbs"], problem.scene.exact
    times = tuple(Fraction(t) for t in problem.times.tolist())
    limbs.run(limbs.plan(inputs, int(setting), times[:2]))

    def work() -> RunOutcome:
        try:
            run = limbs.run(limbs.plan(inputs, int(setting), times))
        except IntegrationError as error:
            return failed(problem, error.reason)

        return RunOutcome(
            Status.OK, float(times[-1]), lambda: run.grid.only(STATE), steps=run.steps
        )

    return work


def precision_runs(bits: Sequence[int]) -> list[tuple[str, float]]:
    """Return the runs at the precisions that the engine supports, in the engine's formulation."""
    from reference.engines.registry import engines

    limbs = engines()["limbs"]
    return [(limbs.formulation, float(prec)) for prec in bits if prec in limbs.bits]


METHODS = (
    Method(
        id="limbs",
        title="Taylor series, adaptive step, this project's limbs of 22 bits",
        setting="precision",
        ladder=(100, 150, 200),
        source="this project's reference/engines/limbs",
        licence="this project's",
        prepare=prepare,
        formulations=("inertial",),
        requires=("numba",),
        extra="methods",
        family=Family.MANY_DIGITS,
        number="100 bits",
        stability=((None, 100),),
        long_runs=(("inertial", 100),),
        precision_runs=precision_runs,
    ),
)
