"""Classical Runge-Kutta, order 4, explicit, fixed step, by this project: option -R 4 of the paper's foucPend."""

from __future__ import annotations

from ..rhs.problem import Problem
from .fixed_step import prepare_fixed, runge_kutta
from .method import TWO_HUNDRED_STEPS, Family, Method, Work
from .tableau import Tableau, fractions, triangle

TABLEAU = Tableau(
    name="rk4",
    order=4,
    a=triangle("", "1/2", "0 1/2", "0 0 1"),
    b=fractions("1/6", "1/3", "1/3", "1/6"),
)


def prepare(problem: Problem, setting: float) -> Work:
    """Compile the integration at a fixed step of `setting` seconds; the returned function runs it."""
    return prepare_fixed(problem, setting, runge_kutta(TABLEAU), stages=len(TABLEAU.b))


METHOD = Method(
    id="rk4",
    title="classical Runge-Kutta, order 4",
    setting="step",
    ladder=(0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002),
    source="W. Kutta (1901); Mathar, appendix A, option -R 4",
    licence="this project's",
    prepare=prepare,
    formulations=("plane", "momentum", "space", "spin", "angles"),
    dense=False,
    requires=("numba",),
    extra="methods",
    order=TABLEAU.order,
    family=Family.PAPER,
    libraries=("numpy", "numba"),
    stability=(("plane", 1 / 200), *TWO_HUNDRED_STEPS),
    long_runs=(("plane", 0.05),),
)
