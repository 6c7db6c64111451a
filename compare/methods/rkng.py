"""Fehlberg's RKN-G 5(6) and 6(7), explicit Runge-Kutta-Nyström of fixed step: options -R 5 and -R 6 of foucPend."""

from __future__ import annotations

from fractions import Fraction
from functools import partial

from .fixed_step import explicit, fixed_step, nystrom
from .method import TWO_HUNDRED_STEPS, Family
from .tableau import NystromTableau, fractions, triangle

RKNG56 = NystromTableau(
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

RKNG67 = NystromTableau(
    name="RKN-G-6(7)-10",
    order=6,
    c=fractions("0 11/108 11/72 11/48 5/8 3/8 2/3 1/6 5175/5333 1"),
    velocity=triangle(
        "",
        "11/108",
        "11/288 11/96",
        "11/192 0 11/64",
        "1585/1936 0 -6075/1936 1425/484",
        "69/880 0 0 243/836 9/1520",
        "1198/13365 0 0 128/627 1096/7695 56/243",
        "1979/19440 0 0 0 -128/405 248/1701 79/336",
        "-1.6746873130588455834971263869845 0 0 -7.8716193268293956927272248512526"
        " 5.3924880763160586316973727446928 -1.5448282105008430450113021691446"
        " -3.2555460065369958589440586873101 9.924565928931791659114253844655",
        "-15977204713/4603957380 0 0 -37419456/2347697 36511588/3201405 -3.4698562868578472962336158110987"
        " -11315910447/1528272116 5760820680/288879061 -0.063493713698019674173438857844779",
    ),
    position=triangle(
        "",
        "121/23328",
        "121/20736 121/20736",
        "121/9216 0 121/9216",
        "25/1408 0 0 125/704",
        "14913/774400 0 212139/5265920 3807/367840 1737/4134400",
        "914/18225 0 0 256/1995 1648/115425 752/25515",
        "5881/583200 0 0 0 -247/12150 457/51030 17/1120",
        "0.058788608928240748733225234592929 0 -0.6816741819616552879282309588555 0 0"
        " 0.039049081248066910635460201662578 0.13202858101777483299456820865647"
        " 0.92261993425952482280294445343764",
        "0.08435639912628663285756875609556 0 -1132162272/808719835 0 0 0"
        " 0.15182217068949492865241002704702 1.6612294394931082916619413173874"
        " 0.0025357326422396130665331704968283",
    ),
    velocity_weights=fractions(
        "100063/1863000 0 0 0 0 43040768/200032875 465399/1360520 728136/3214625"
        " 47451571895192760823/155717244444658077000 -11233/79000"
    ),
    position_weights=fractions(
        "698941/13041000 0 0 0 0 37507072/280046025 1090431/9523640 851292/4500475"
        " 4313779263199341893/545010355556303269500 1/1106"
    ),
    tolerance=Fraction("1e-30"),
)

# Misprints of public copies: (table, row, column, as printed), counted from 0. Only the tests use them: put in place of
# the entry above, each must make the order conditions fail. The first of 6(7) is the entry of column 2 printed in
# column 1, which leaves 0 in its own. The second violates Σ position_ij c_j^q = c_i^(q+2) / ((q+1) (q+2)) by 4.877e-24
# times c_7^q, for q = 0 to 3; the factor c_7^q identifies the column, where the 24th to the 27th digit are wrong.
MISPRINTS = {
    RKNG56: (("position", 4, 0, "81/840"),),
    RKNG67: (
        ("position", 8, 1, "-0.6816741819616552879282309588555"),
        ("position", 9, 7, "1.6612294394931082916619461943874"),
    ),
}

_SOURCE = "E. Fehlberg, NASA TR R-432 (1974), and Computing 14 (1975) 371; Mathar, appendix A, option -R "
_method = partial(fixed_step, formulations=("plane", "space"), family=Family.PAPER, stability=TWO_HUNDRED_STEPS)

METHODS = (
    _method(
        id="rkng56",
        title="Runge-Kutta-Nyström-Fehlberg RKN-G 5(6), order 5",
        ladder=(1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01),
        source=f"{_SOURCE}5",
        prepare=explicit(nystrom(RKNG56), RKNG56.stages),
        order=RKNG56.order,
    ),
    _method(
        id="rkng67",
        title="Runge-Kutta-Nyström-Fehlberg RKN-G 6(7), order 6",
        ladder=(2, 1, 0.5, 0.2, 0.1, 0.05, 0.02),
        source=f"{_SOURCE}6",
        prepare=explicit(nystrom(RKNG67), RKNG67.stages),
        order=RKNG67.order,
        long_runs=(("plane", 0.25),),
    ),
)
