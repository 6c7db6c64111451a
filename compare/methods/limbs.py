"""The reference's own Taylor method in numbers of many digits, each a whole number in a double."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ..rhs.problem import Array, Problem
from .method import Exact, Method, Outcome, Work, failed


def prepare(problem: Problem, setting: float) -> Work:
    """Compile the limbs' kernels by a first short run; the work is the run."""
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
            done = limbs.run(plan)
        except IntegrationError as error:
            return failed(problem, error.reason)

        def cartesian() -> Array:
            return np.array([[value / (1 << done.bits) for value in row[:6]] for row in done.grid])

        def finer() -> Exact:
            return Exact(done.bits, [row[:6] for row in done.grid])

        return Outcome("ok", "", float(problem.times[-1]), done.steps, None, cartesian, finer)

    return work


METHOD = Method(
    id="limbs",
    title="Taylor in digits of 22 bits",
    setting="precision",
    ladder=(100, 150, 200),
    source="this project's reference/limbs",
    licence="this project's",
    prepare=prepare,
    formulations=("momentum",),
    requires=("reference.engines.limbs", "numba"),
    extra="methods",
)
