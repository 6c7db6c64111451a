"""Boost odeint, GSL, CVODE and ARKODE as their own users call them: a program in C++, of which no Python is a part.

They stand beside the same codes behind a wrapper. The program is compiled for the scene's equations once and kept; it
integrates, tells the CPU seconds of that by its own clock, and writes its states. A tolerance t means rtol = t and
atol = t times each variable's swing; odeint takes one number for all, t times the smallest of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from reference import InputError

from ..rhs.problem import Problem
from .method import HIGH_ORDER, SPACE_FIRST, Family, Method, Outcome, Work, failed, outcome
from .native.cpp_program import prepared
from .native.library import BOOST, GSL, SUNDIALS, Library

DENSE = ("sundials_nvecserial", "sundials_sunmatrixdense", "sundials_sunlinsoldense")


def prepare(
    problem: Problem,
    setting: float,
    library: Library,
    parts: Sequence[str],
    defines: Sequence[str] = (),
    link: Sequence[str] = (),
) -> Work:
    """Compile the program; the returned function runs it."""
    if len(problem.times) == 1:
        return lambda: outcome(problem, problem.start[None, :], steps=0, rhs_evaluations=0)
    if library is SUNDIALS and not f"{library.version}".startswith("6."):  # since 7
        link = (*link, "sundials_core")
    run = prepared(problem, setting, library, parts, defines, link)

    def work() -> Outcome:
        try:
            found = run()
        except InputError as error:  # it crashed, or was ended
            return failed(problem, str(error))
        result = outcome(problem, found.states, steps=found.steps, rhs_evaluations=found.calls, reason=found.reason)
        return replace(result, cpu_s=found.cpu_s)

    return work


_native = partial(Method, setting="tolerance", family=Family.COMPILED)
_odeint = partial(
    _native,
    ladder=HIGH_ORDER,
    native=BOOST,
    extra="methods-native",
    licence="BSL-1.0",
    formulations=SPACE_FIRST,
    dense=False,
)
_sundials = partial(
    _native,
    native=SUNDIALS,
    licence="BSD-3-Clause",
    source="A. C. Hindmarsh et al., ACM Trans. Math. Softw. 31 (2005) 363",
)
_cvode = partial(_sundials, ladder=(1e-8, 1e-10, 1e-12, 1e-14))
_multistep = partial(prepare, library=SUNDIALS, parts=("sundials.hpp", "cvode.cpp"), link=("sundials_cvode", *DENSE))

METHODS = (
    _odeint(
        id="odeint_rkf78",
        title="Fehlberg 8(7), Boost odeint in C++",
        source="E. Fehlberg, NASA TR R-287 (1968); K. Ahnert and M. Mulansky, AIP Conf. Proc. 1389 (2011) 1586",
        prepare=partial(prepare, library=BOOST, parts=("odeint.cpp",)),
        order=8,
    ),
    _odeint(
        id="odeint_bulirsch_stoer",
        title="Bulirsch-Stoer extrapolation, Boost odeint in C++",
        source="R. Bulirsch and J. Stoer, Numer. Math. 8 (1966) 1; K. Ahnert and M. Mulansky (2011)",
        prepare=partial(prepare, library=BOOST, parts=("odeint.cpp",), defines=("BULIRSCH_STOER",)),
    ),
    _native(
        id="gsl_rk8pd",
        title="Prince-Dormand 8(9), GSL in C",
        ladder=HIGH_ORDER,
        source="P. J. Prince and J. R. Dormand, J. Comput. Appl. Math. 7 (1981) 67; GSL odeiv2",
        licence="GPL-3.0-or-later",
        native=GSL,
        prepare=partial(prepare, library=GSL, parts=("gsl.cpp",), link=("gsl", "gslcblas")),
        formulations=SPACE_FIRST,
        dense=False,
        order=8,
    ),
    _cvode(
        id="cvode_c_adams",
        title="Adams, orders 1 to 12, CVODE in C",
        prepare=partial(_multistep, defines=("MULTISTEP=CV_ADAMS",)),
    ),
    _cvode(
        id="cvode_c_bdf",
        title="backward differentiation, orders 1 to 5, CVODE in C",
        prepare=partial(_multistep, defines=("MULTISTEP=CV_BDF",)),
        stiff=True,
    ),
    _sundials(
        id="arkode_erk8",
        title="Fehlberg 8(7), ARKODE in C",
        ladder=HIGH_ORDER,
        prepare=partial(
            prepare,
            library=SUNDIALS,
            parts=("sundials.hpp", "arkode.cpp"),
            link=("sundials_arkode", "sundials_nvecserial"),
        ),
        formulations=SPACE_FIRST,
        dense=False,
        order=8,
    ),
)
