"""Mathar, appendix A: the program's defaults, its Runge-Kutta schemes, and statements about its output."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from reference import load_scene

from ...foucpend.zeros import Transits
from ...methods import rk4, rkng56, rkng67
from ...runge_kutta.tableau import NystromTableau, Tableau, TableauError
from ..checks import Check, Finding, PrintedNumber, Statement
from ..digits import MP, mpf, pi, shown
from ..points import paris
from ..runs import path_in, transit_times
from .frequency import swings_surplus

A = "Mathar, appendix A"
WGS84_INVERSE_FLATTENING = "298.257223563"  # NIMA TR8350.2, table 3.1: defining parameter
WGS84_RATE = "7.292115e-5"  # rad/s, NIMA TR8350.2, table 3.1: defining parameter
WGS84_RADIUS = "6378137.0"  # m, NIMA TR8350.2, table 3.1: defining parameter
STANDARD_GRAVITY = "9.80665"  # m/s², 3rd CGPM (1901)


def _polar_radius() -> Any:
    return paris().radius * (1 - paris().flattening)


def _prolate() -> Finding:
    gap = _polar_radius() - paris().radius
    return Finding(gap > 0, f"polar radius - equatorial radius = {shown(gap)} m")


def checks() -> list[Check]:
    """Return the rows of the appendix."""
    return [
        PrintedNumber(
            "mathar_a_day",
            f"{A}, -T",
            "24 × 3600 s is approximately 4 minutes longer than a sidereal day",
            "4",
            lambda: (86400 - 2 * pi / paris().rate) / 60,
            remark="minutes",
        ),
        PrintedNumber("mathar_a_g", f"{A}, -g", "9.80665 m/s²", "9.80665", lambda: mpf(STANDARD_GRAVITY)),
        PrintedNumber("mathar_a_omega", f"{A}, -O", "7.292115 × 10⁻⁵ rad/s", "7.292115e-5", lambda: mpf(WGS84_RATE)),
        Statement(
            "mathar_a_prolate",
            f"{A}, -f",
            "the prolate elliptical coordinates",
            _prolate,
            "oblate: the polar axis is the shorter one",
            lambda: _polar_radius() < paris().radius,
        ),
        PrintedNumber(
            "mathar_a_flattening",
            f"{A}, -f",
            "inverse flattening 298.257223564",
            "298.257223564",
            lambda: mpf(WGS84_INVERSE_FLATTENING),
            remark="against WGS84, the paper's reference [3]; the paper's scene keeps …564 "
            f"(R changes by {shown(_effect_of_the_digit(), 2)} m)",
        ),
        PrintedNumber("mathar_a_radius", f"{A}, -r", "6.378137 × 10⁶ m", "6.378137e6", lambda: mpf(WGS84_RADIUS)),
        *_schemes(),
        Statement(
            "mathar_a_parabola",
            f"{A}, output",
            "transits by quadratic interpolation of three points",
            _by_parabola,
            by_run=True,
            remark="first transit of Paris at the paper's step of 0.01 s",
        ),
        Statement(
            "mathar_a_two",
            f"{A}, output",
            "two transits occur per period",
            _two_transits,
        ),
    ]


def order_of(tableau: Tableau | NystromTableau) -> int:
    """Return the highest order whose conditions a table of coefficients meets."""
    claim = tableau.order
    while True:
        try:
            replace(tableau, order=claim + 1)
        except TableauError as error:
            return error.order - 1
        claim += 1


def _schemes() -> list[Check]:
    """Return the rows about the schemes of -R."""
    tables = (("4", rk4.TABLEAU, "4", "4"), ("5", rkng56.TABLEAU, "6", "8"), ("6", rkng67.TABLEAU, "7", "10"))
    rows: list[Check] = []
    for value, table, order, stages in tables:
        rows.append(_stages(value, stages, len(table.a if isinstance(table, Tableau) else table.c)))
        if value != "4":
            rows.append(_order(value, order, table))
    return rows


def _stages(value: str, stages: str, count: int) -> Check:
    return PrintedNumber(
        f"mathar_a_stages_{value}", f"{A}, -R", f"-R {value}: {stages} stages", stages, lambda: MP.mpf(count)
    )


def _order(value: str, order: str, table: Tableau | NystromTableau) -> Check:
    return PrintedNumber(
        f"mathar_a_order_{value}",
        f"{A}, -R",
        f"-R {value}: order {order}",
        order,
        lambda: MP.mpf(order_of(table)),
        remark=f"by the order conditions of the {table.name} table; those of order {order} fail by so little that at "
        f"ordinary steps the error does shrink like h^{order}",
    )


def _by_parabola() -> Finding:
    times = np.arange(1001) / 100
    xdot = path_in(load_scene("paris"), times)[:, 3]
    xdot[0] = 0.0  # released at rest, exactly
    zero, true = Transits().of(times, xdot)[0], float(transit_times()[0])
    # of sin(wt) a parabola through three points h apart misses the zero by at most h³ w² max|s(s² - 1)|/6
    bound = 0.065 * 0.01**3 * 9.80665 / 67
    return Finding(abs(zero - true) < bound, f"{zero:.12f} s, {zero - true:.2e} s from the truth")


def _two_transits() -> Finding:
    count, surplus = len(transit_times()), swings_surplus()
    share = mpf(surplus) / count
    return Finding(
        share < mpf("1e-3"),
        f"{count} transits in {count - surplus} half swings of a day",
        f"{surplus} too many, {shown(share, 3)} (relative)" if surplus else "",
    )


def _effect_of_the_digit() -> Any:
    p = paris()
    return abs(p.R - p.but(flattening=1 / MP.mpf(WGS84_INVERSE_FLATTENING)).R)
