"""Fehlberg's RKN-G 5(6) and 6(7), explicit Runge-Kutta-Nyström of fixed step: options -R 5 and -R 6 of foucPend."""

from __future__ import annotations

from fractions import Fraction
from functools import partial

from reference.system.documents import texts_of

from .fixed_step import explicit, fixed_step, nystrom
from .method import TWO_HUNDRED_STEPS, Family
from .tableau import NystromTableau, parts

_TABLES = texts_of(__file__)
RKNG56 = NystromTableau("RKN-G-5(6)-8", 5, **parts(_TABLES["RKNG56"]))
RKNG67 = NystromTableau("RKN-G-6(7)-10", 6, **parts(_TABLES["RKNG67"]), tolerance=Fraction("1e-30"))

_SOURCE = (
    "E. Fehlberg, NASA TR R-432 (1974), and Computing 14 (1975) 371; Mathar, appendix A, option -R "
)
_method = partial(
    fixed_step, formulations=("plane", "space"), family=Family.PAPER, stability=TWO_HUNDRED_STEPS
)

METHODS = (
    _method(
        id="rkng56",
        title="Runge-Kutta-Nyström-Fehlberg RKN-G 5(6), order 5",
        ladder=(1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01),
        source=f"{_SOURCE}5",
        prepare=explicit(nystrom(RKNG56), len(RKNG56.c)),
        order=RKNG56.order,
    ),
    _method(
        id="rkng67",
        title="Runge-Kutta-Nyström-Fehlberg RKN-G 6(7), order 6",
        ladder=(2, 1, 0.5, 0.2, 0.1, 0.05, 0.02),
        source=f"{_SOURCE}6",
        prepare=explicit(nystrom(RKNG67), len(RKNG67.c)),
        order=RKNG67.order,
        long_runs=(("plane", 0.25),),
    ),
)
