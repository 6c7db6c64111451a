"""Classical Runge-Kutta, order 4, explicit, fixed step, by this project: option -R 4 of the paper's foucPend."""

from __future__ import annotations

from .fixed_step import explicit, fixed_step, runge_kutta
from .method import TWO_HUNDRED_STEPS, Family
from .tableau import Tableau, fractions, triangle

TABLEAU = Tableau(
    name="rk4",
    order=4,
    a=triangle("", "1/2", "0 1/2", "0 0 1"),
    b=fractions("1/6 1/3 1/3 1/6"),
)

METHODS = (
    fixed_step(
        id="rk4",
        title="classical Runge-Kutta, order 4",
        ladder=(0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002),
        source="W. Kutta (1901); Mathar, appendix A, option -R 4",
        prepare=explicit(runge_kutta(TABLEAU), len(TABLEAU.b)),
        formulations=("plane", "momentum", "space", "spin", "angles"),
        order=TABLEAU.order,
        family=Family.PAPER,
        stability=(("plane", 1 / 200), *TWO_HUNDRED_STEPS),
        long_runs=(("plane", 0.05),),
    ),
)
