"""Adams (orders 1 to 12) and BDF (orders 1 to 5), multistep: CVODE of SUNDIALS, through scikit-sundae.

Both solve their implicit equations by Newton's method with a dense Jacobian, the library's default.
The right-hand side and the Jacobian are compiled, but called through Python, a microsecond each. A
tolerance t means rtol = t and atol = t times each variable's swing. Output is CVODE's own dense
output.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from reference.numbers.precision import Array

from .library import captured
from .method import Family, RunOutcome, Work, adaptive, outcome
from .rhs.problem import Problem

MOST_STEPS = 100_000_000  # between two output times


def prepare(problem: Problem, setting: float, code: str) -> Work:
    """Compile the right-hand side and create the solver.

    The returned function calls its `solve`.
    """
    from sksundae.cvode import CVODE

    rates, slopes, k = problem.rates, problem.slopes, problem.parameters

    def rhs(t: float, y: Array, dy: Array) -> None:
        rates(y, k, dy)

    def jacobian(t: float, y: Array, dy: Array, matrix: Array) -> None:
        slopes(y, k, matrix)

    solver = CVODE(
        rhs,
        method=code,
        rtol=setting,
        atol=setting * problem.sizes,
        max_num_steps=MOST_STEPS,
        jacfn=jacobian,
    )

    def work() -> RunOutcome:
        times = problem.times
        # two mean every step
        output_times = times if len(times) > 2 else np.array([times[0], times[1] / 2, times[1]])
        with captured():  # it prints its message as well
            solution = solver.solve(output_times, problem.start)
        states = np.array(solution.y)[np.isin(solution.t, times)]
        reason = "" if solution.success else str(solution.message)
        return outcome(problem, states, rhs_evaluations=int(solution.nfev), reason=reason)

    return work


_cvode = partial(
    adaptive,
    ladder=(1e-8, 1e-10, 1e-12, 1e-14),
    source="A. C. Hindmarsh et al., ACM Trans. Math. Softw. 31 (2005) 363",
    licence="BSD-3-Clause",
    requires=("sksundae", "numba"),
    extra="methods",
    family=Family.COMPILED,
)

METHODS = (
    _cvode(
        id="cvode_adams",
        title="Adams, orders 1 to 12, CVODE",
        prepare=partial(prepare, code="Adams"),
    ),
    _cvode(
        id="cvode_bdf",
        title="backward differentiation, orders 1 to 5, CVODE",
        prepare=partial(prepare, code="BDF"),
    ),
)
