"""Runge-Kutta 5(4) and 8(5,3), Radau IIA of order 5, BDF (orders 1 to 5), LSODA (1 to 12): SciPy's `solve_ivp`.

The right-hand side is compiled and, for the implicit methods, the Jacobian. A tolerance t means
rtol = t and atol = t times each variable's swing, so that a variable which passes zero is
controlled to the same part of its amplitude as one which does not. Output is each method's own
dense output, through `t_eval`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from reference.numbers.precision import Array

from .method import SPACE_FIRST, TRACEABLE, Family, RunOutcome, Work, adaptive, outcome
from .rhs.problem import Filling, Problem

# solve_ivp raises a smaller one to this, with a warning
LEAST_RTOL = 100 * float(np.finfo(float).eps)
IMPLICIT = ("Radau", "BDF", "LSODA")


def returning(into: Filling, k: Array, shape: tuple[int, ...]) -> Callable[..., Array]:
    """Return a function of t and y whose result is a new array, as `into(y, k, array)` fills it."""

    def function(t: float, y: Array) -> Array:
        array = np.empty(shape)
        into(y, k, array)
        return array

    return function


def prepare(problem: Problem, setting: float, code: str) -> Work:
    """Compile the right-hand side; the returned function calls `solve_ivp`."""
    from scipy.integrate import solve_ivp

    keywords: dict[str, Any] = {"method": code, "rtol": setting, "atol": setting * problem.sizes}
    size, end, k = len(problem.start), float(problem.times[-1]), problem.parameters
    if code in IMPLICIT:
        keywords["jac"] = returning(problem.slopes, k, (size, size))
    rhs = returning(problem.rates, k, (size,))

    def work() -> RunOutcome:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            solution = solve_ivp(rhs, (0.0, end), problem.start, t_eval=problem.times, **keywords)
        words = [str(solution.message)] if solution.status < 0 else []
        reason = "; ".join(dict.fromkeys([*words, *(str(entry.message) for entry in caught)]))
        return outcome(
            problem, solution.y.T.copy(), rhs_evaluations=int(solution.nfev), reason=reason
        )

    return work


_scipy = partial(
    adaptive,
    licence="BSD-3-Clause",
    formulations=SPACE_FIRST,
    requires=("scipy", "numba"),
    extra="methods",
    family=Family.SCIPY,
)

METHODS = (
    _scipy(
        id="scipy_rk45",
        title="Dormand-Prince 5(4), SciPy",
        ladder=(1e-7, 1e-8, 1e-9, 1e-10),
        source="J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19",
        prepare=partial(prepare, code="RK45"),
        order=5,
    ),
    _scipy(
        id="scipy_dop853",
        title="Dormand-Prince 8(5,3), SciPy",
        ladder=(1e-6, 1e-8, 1e-10, 1e-12, LEAST_RTOL),
        source="E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I",
        prepare=partial(prepare, code="DOP853"),
        order=8,
    ),
    _scipy(
        id="scipy_radau",
        title="Radau IIA, order 5, implicit, SciPy",
        ladder=(1e-6, 1e-7, 1e-8),
        source="E. Hairer, G. Wanner, Solving Ordinary Differential Equations II",
        prepare=partial(prepare, code="Radau"),
        order=5,
    ),
    _scipy(
        id="scipy_bdf",
        title="backward differentiation, orders 1 to 5, SciPy",
        ladder=(1e-8, 1e-9, 1e-10),
        source="L. F. Shampine and M. W. Reichelt, SIAM J. Sci. Comput. 18 (1997) 1",
        prepare=partial(prepare, code="BDF"),
    ),
    _scipy(
        id="scipy_lsoda",
        title="Adams and BDF with automatic switching, SciPy",
        ladder=(1e-8, 1e-10, 1e-12),
        source="L. R. Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136",
        prepare=partial(prepare, code="LSODA"),
        formulations=TRACEABLE,  # in `space` it mistakes rounding for stiffness
    ),
)
