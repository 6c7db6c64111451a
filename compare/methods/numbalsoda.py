"""DOP853 (explicit Runge-Kutta, order 8) and LSODA (multistep, orders 1 to 12), compiled: numbalsoda.

They are Fortran and C, and no Python runs between their steps. The relative tolerance is the
setting; the absolute tolerance is one number for all variables, the setting times the smallest of
their swings. The library is built from source, which needs a Fortran compiler.
"""

from __future__ import annotations

import os
from functools import partial
from typing import Any

import numpy as np

from .library import captured, quoted
from .method import HIGH_ORDER, SPACE_FIRST, Family, RunOutcome, Work, adaptive, leading, outcome
from .rhs.problem import Problem

MOST_STEPS = 100_000_000  # between two output times for LSODA, in all for DOP853

_RATES = """
@nb.cfunc("void(float64, CPointer(float64), CPointer(float64), CPointer(float64))", **OPTIONS)
def rates(t, y, dy, k):
    k[${counter}] += 1.0
    ${dy}= traced(${y}${k})
"""


def prepare(problem: Problem, setting: float, code: str) -> Work:
    """Compile the right-hand side; the returned function runs the library's integration."""
    # otherwise its messages appear when the process ends
    os.environ.setdefault("GFORTRAN_UNBUFFERED_PRECONNECTED", "y")
    from numbalsoda import driver, driver_dop853

    variables = len(problem.start)
    address = problem.compiled(problem.system.program, _RATES).rates.address
    integrate = {"dop853": driver_dop853.dop853_wrapper, "lsoda": driver.lsoda_wrapper}[code]
    absolute = setting * float(problem.sizes.min())

    def work() -> RunOutcome:
        rows = len(problem.times)
        states, success = np.full((rows, variables), np.nan), np.array(999, np.int32)
        states[0], start = problem.start, problem.start.copy()
        data = np.append(problem.parameters, 0.0)
        pointers: list[Any] = [
            array.ctypes.data for array in (start, data, problem.times, states, success)
        ]
        with captured() as output:
            integrate(
                address, variables, pointers[0], pointers[1], rows, pointers[2], pointers[3],
                setting, absolute, MOST_STEPS, pointers[4],
            )  # fmt: skip
        reason = quoted(output)
        if success != 1:
            # what it did not reach is NaN
            states = states[: leading(np.isfinite(states).all(axis=1))]
            reason = reason or f"numbalsoda's {code} stopped without a message"
        return outcome(problem, states, rhs_evaluations=int(data[-1]), reason=reason)

    return work


_numbalsoda = partial(
    adaptive,
    requires=("numbalsoda", "numba"),
    extra="methods-fortran",
    family=Family.COMPILED,
)

METHODS = (
    _numbalsoda(
        id="numbalsoda_dop853",
        title="Dormand-Prince 8(5,3), numbalsoda",
        ladder=HIGH_ORDER,
        source="E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I",
        licence="MIT and BSD",
        prepare=partial(prepare, code="dop853"),
        formulations=SPACE_FIRST,
        order=8,
        long_runs=(("space", 1e-14),),
    ),
    _numbalsoda(
        id="numbalsoda_lsoda",
        title="Adams and BDF with automatic switching, numbalsoda",
        ladder=(1e-7, 1e-8, 1e-10, 1e-12, 1e-13),
        source="L. R. Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136; liblsoda",
        licence="MIT",
        prepare=partial(prepare, code="lsoda"),
    ),
)
