"""Mathar, appendix A: the program's defaults, its Runge-Kutta schemes, and statements about its output."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from reference import load_scene

from ...methods import rk4
from ...methods.rkng import RKNG56, RKNG67
from ...methods.tableau import NystromTableau, Tableau, TableauError
from ..checks import Answer, Check, PrintedNumber, Statement, section
from ..digits import MP, mpf, pi, shown
from ..foucpend import Transits
from ..points import paris, path_in, transits
from .paris import swings_surplus

WGS84_INVERSE_FLATTENING = "298.257223563"  # NIMA TR8350.2, table 3.1: defining parameter
WGS84_RATE = "7.292115e-5"  # rad/s, NIMA TR8350.2, table 3.1: defining parameter
WGS84_RADIUS = "6378137.0"  # m, NIMA TR8350.2, table 3.1: defining parameter
STANDARD_GRAVITY = "9.80665"  # m/s², 3rd CGPM (1901)


def _polar_radius() -> Any:
    return paris().radius * (1 - paris().flattening)


def _prolate() -> Answer:
    gap = _polar_radius() - paris().radius
    return Answer(gap > 0, f"polar radius - equatorial radius = {shown(gap)} m")


def order_of(tableau: Tableau | NystromTableau) -> int:
    """Return the highest order whose conditions a table of coefficients meets."""
    try:
        # more than any has: the first condition that fails tells its own
        return replace(tableau, order=99).order
    except TableauError as error:
        return error.order - 1


def _order(tableau: NystromTableau, printed: str) -> dict[str, Any]:
    """Return value and remark of a row about a scheme's order."""
    remark = (
        f"by the order conditions of the {tableau.name} table; those of order {printed} fail by so little that at "
        f"ordinary steps the error does shrink like h^{printed}"
    )
    return {"value": lambda: MP.mpf(order_of(tableau)), "remark": remark}


def _step_control() -> Answer:
    """Look for a second formula of order 3 in the stages of the classical scheme, whose error it would estimate."""
    table = [[mpf(part) for part in row] for row in rk4.TABLEAU.a]
    nodes = [sum(row, MP.zero) for row in table]
    inner = [
        sum((part * node for part, node in zip(row, nodes, strict=False)), MP.zero) for row in table
    ]
    conditions = MP.matrix([[MP.one] * len(nodes), nodes, [node**2 for node in nodes], inner])
    size = MP.det(conditions)
    return Answer(
        size == 0,
        f"determinant of the conditions of order 3: {shown(size)}; one formula meets them",
    )


def _by_parabola() -> Answer:
    times = np.arange(1001) / 100
    xdot = path_in(load_scene("paris"), times)[:, 3]
    xdot[0] = 0.0  # released at rest, exactly
    zero, true = Transits().of(times, xdot)[0], float(transits("t")[0])
    # of sin(wt) a parabola through three points h apart misses the zero by at most h³ w² max|s(s² -
    # 1)|/6
    bound = 0.065 * 0.01**3 * 9.80665 / 67
    return Answer(abs(zero - true) < bound, f"{zero:.12f} s, {zero - true:.2e} s from the truth")


def _two_transits() -> Answer:
    count, surplus = len(transits("t")), swings_surplus()
    share = mpf(surplus) / count
    return Answer(
        share < mpf("1e-3"),
        f"{count} transits in {count - surplus} half swings of a day",
        f"{surplus} too many, {shown(share, 3)} (relative)" if surplus else "",
    )


def _effect_of_the_digit() -> Any:
    p = paris()
    return abs(p.R - p.but(flattening=1 / MP.mpf(WGS84_INVERSE_FLATTENING)).R)


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    return [
        *section("mathar_", "Mathar VIII",
            Statement("viii_steps", "", "a program with variable Runge-Kutta-Nyström orders of the step control",
                _step_control, "of the scheme: “Step size control is not implemented” (appendix A)",
                lambda: not _step_control().holds,
                remark="the classical scheme of -R 4 has no second formula that could control its step"),
        ),
        *section("mathar_", "Mathar, appendix A",
            PrintedNumber("a_day", ", -T", "24 × 3600 s is approximately 4 minutes longer than a sidereal day",
                "4", lambda: (86400 - 2 * pi / paris().rate) / 60, remark="minutes"),
            PrintedNumber("a_g", ", -g", "9.80665 m/s²", "9.80665", lambda: mpf(STANDARD_GRAVITY)),
            PrintedNumber("a_omega", ", -O", "7.292115 × 10⁻⁵ rad/s", "7.292115e-5", lambda: mpf(WGS84_RATE)),
            Statement("a_prolate", ", -f", "the prolate elliptical coordinates",
                _prolate, "oblate: the polar axis is the shorter one", lambda: _polar_radius() < paris().radius),
            PrintedNumber("a_flattening", ", -f", "inverse flattening 298.257223564",
                "298.257223564", lambda: mpf(WGS84_INVERSE_FLATTENING),
                remark="against WGS84, the paper's reference [3]; the paper's scene keeps …564 "
                    f"(R changes by {shown(_effect_of_the_digit(), 2)} m)"),
            PrintedNumber("a_radius", ", -r", "6.378137 × 10⁶ m", "6.378137e6", lambda: mpf(WGS84_RADIUS)),
            PrintedNumber("a_stages_4", ", -R", "-R 4: 4 stages", "4", lambda: MP.mpf(len(rk4.TABLEAU.a))),
            PrintedNumber("a_stages_5", ", -R", "-R 5: 8 stages", "8", lambda: MP.mpf(len(RKNG56.c))),
            PrintedNumber("a_order_5", ", -R", "-R 5: order 6", "6", **_order(RKNG56, "6")),
            PrintedNumber("a_stages_6", ", -R", "-R 6: 10 stages", "10", lambda: MP.mpf(len(RKNG67.c))),
            PrintedNumber("a_order_6", ", -R", "-R 6: order 7", "7", **_order(RKNG67, "7")),
            Statement("a_parabola", ", output", "transits by quadratic interpolation of three points",
                _by_parabola, by_run=True, remark="first transit of Paris at the paper's step of 0.01 s"),
            Statement("a_two", ", output", "two transits occur per period", _two_transits),
        ),
    ]  # fmt: skip
