"""Taylor series, order set by the precision, adaptive step: the reference's engine `limbs`, in limbs of 22 bits."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from reference.status import Status

from ..rhs.problem import Array, Problem
from .method import Exact, Family, Method, Outcome, Work, failed


def prepare(problem: Problem, setting: float) -> Work:
    """Compile the engine's kernels by a short first run; the returned function makes the whole run."""
    from reference.engines import limbs
    from reference.engines.plan import Plan
    from reference.errors import IntegrationError
    from reference.precision import NumberType

    number = NumberType("limbs", int(setting))
    times = tuple(Fraction(t) for t in problem.times.tolist())
    plan = Plan(problem.scene.exact, problem.formulation, number, times, transits=False)
    limbs.run(Plan(plan.inputs, plan.formulation, number, times[:2], transits=False))

    def work() -> Outcome:
        try:
            finished_run = limbs.run(plan)
        except IntegrationError as error:
            return failed(problem, error.reason)

        def cartesian() -> Array:
            return np.array([[value / (1 << finished_run.bits) for value in row[:6]] for row in finished_run.grid])

        def finer() -> Exact:
            return Exact(finished_run.bits, [row[:6] for row in finished_run.grid])

        return Outcome(Status.OK, "", float(problem.times[-1]), finished_run.steps, None, cartesian, finer)

    return work


METHODS = (
    Method(
        id="limbs",
        title="Taylor series, adaptive step, this project's limbs of 22 bits",
        setting="precision",
        ladder=(100, 150, 200),
        source="this project's reference/engines/limbs",
        licence="this project's",
        prepare=prepare,
        formulations=("momentum",),
        requires=("reference.engines.limbs", "numba"),
        extra="methods",
        family=Family.MANY_DIGITS,
        number="100 bits",
        libraries=("numpy", "numba"),
        stability=((None, 100),),
        long_runs=(("momentum", 100),),
    ),
)
