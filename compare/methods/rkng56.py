"""Fehlberg's RKN-G 5(6), order 5, explicit Runge-Kutta-Nyström for y'' = f(y, y'), fixed step: foucPend's -R 5."""

from __future__ import annotations

from .method import TWO_HUNDRED_STEPS, Family
from .runge_kutta.fixed_step import explicit, fixed_step, nystrom
from .runge_kutta.tableau import NystromTableau, fractions, triangle

TABLEAU = NystromTableau(
    name="RKN-G-5(6)-8",
    order=5,
    c=fractions("0 4/15 2/5 3/5 9/10 3/4 2/7 1"),
    velocity=triangle(
        "",
        "4/15",
        "1/10 3/10",
        "3/20 0 9/20",
        "9/40 0 0 27/40",
        "11/48 0 0 5/8 -5/48",
        "27112/194481 0 0 56450/64827 80000/194481 -24544/21609",
        "-26033/41796 0 0 -236575/38313 -14500/10449 275936/45279 228095/73788",
    ),
    position=triangle(
        "",
        "8/225",
        "1/25 1/25",
        "9/160 81/800 9/400",
        "81/640 0 729/3200 81/1600",
        "11283/88064 0 3159/88064 7275/44032 -33/688",
        "6250/194481 0 0 0 -3400/194481 1696/64827",
        "-6706/45279 0 0 0 1047925/1946997 -147544/196209 1615873/1874886",
    ),
    velocity_weights=fractions("7/81 0 0 0 -250/3483 160/351 2401/5590 1/10"),
    position_weights=fractions("31/360 0 0 0 0 64/585 2401/7800 -1/300"),
)

# Misprints of public copies: (table, row, column, as printed), counted from 0. Only the tests use them: put in place of
# the entry above, each must make the order conditions fail.
MISPRINTS = (("position", 4, 0, "81/840"),)

METHODS = (
    fixed_step(
        id="rkng56",
        title="Runge-Kutta-Nyström-Fehlberg RKN-G 5(6), order 5",
        ladder=(1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01),
        source="E. Fehlberg, NASA TR R-432 (1974), and Computing 14 (1975) 371; Mathar, appendix A, option -R 5",
        prepare=explicit(nystrom(TABLEAU), TABLEAU.stages),
        formulations=("plane", "space"),
        order=TABLEAU.order,
        family=Family.PAPER,
        stability=TWO_HUNDRED_STEPS,
    ),
)
