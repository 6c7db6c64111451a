"""TRUSTED. Data types of the proof: what it returns, and bounds inside it. No arithmetic here.

| name                           | symbol                                  | unit          |
|--------------------------------|-----------------------------------------|---------------|
| `Sizes.d1`, `.d2`              | D1, D2                                  | a step's time |
| `Sizes.p`, `.k`, `.tau`        | P, K, T                                 | a step's time |
| `Sizes.d1_rate`                | a bound of |d1'|                        | a step's time |
| `Tube.eta`, `.u`, `.a`         | η, U, A of section 7                    | a step's time |
| `Tangent.P`                    | P of section 12, over `unit`            | scaled input  |
| `Tangent.a`, `.a_rate`         | bounds of |ρ - P| and |ρ' - P'|         | scaled input  |
| `Leaf.low`, `.high`            | the ends of a leaf of section 8, in s   | a step's time |
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from flint import arb

from ...scenes.inputs import Inputs


@dataclass(frozen=True, slots=True)
class Interval:
    """A closed interval with exact endpoints."""

    low: Fraction
    high: Fraction


State = tuple[Interval, ...]  # x, y, z in m, vx, vy, vz in m/s


@dataclass(frozen=True, slots=True)
class EnclosedZero:
    """A single zero of xdot or of a section's form ("one"), or an interval that may hold zeros; SI units.

    Of a zero of xdot vx and vz are None, of another one ax is.
    """

    parity: str  # "one"; of possible zeros "odd" (so at least one), "even" or "unknown"
    direction: int  # +1 where it goes from - to +, 0 if not known
    t: Interval
    x: Interval
    y: Interval
    z: Interval
    vy: Interval
    vx: Interval | None = None
    vz: Interval | None = None
    ax: Interval | None = None

    @property
    def kind(self) -> str:
        """Kind of zero: "one" where it is proved to be a single one, else "possible"."""
        return "one" if self.parity == "one" else "possible"


# the word of the zeros that are called transits; every other word is that of a section
XDOT = "xdot"
Zeros = dict[str, tuple[EnclosedZero, ...]]  # by word


@dataclass(frozen=True, eq=False)
class Proved:
    """The result of a proof: for these inputs, intervals of the state at each of `times` and of every zero."""

    inputs: Inputs
    times: tuple[Fraction, ...]
    states: tuple[State, ...]
    zeros: Zeros  # those that were requested; without xdot where that is identically zero
    still: bool  # xdot is identically zero


@dataclass(frozen=True, eq=False)
class ProvedFunction:
    """A golden function as it was bounded."""

    proved: Proved  # in the same run
    facts: dict[str, Any]  # what function.json says of its coefficients
    bounds: dict[str, Fraction]  # of what it evaluates to, in m and m/s
    data: bytes  # function.f64


class Box(NamedTuple):
    """A scene's inputs, and the least and the largest of each of them."""

    inputs: Inputs
    low: Inputs
    high: Inputs


@dataclass(frozen=True, eq=False)
class ProvedBox:
    """Proved for all inputs of a box: states at `times`, and each zero that may come up to the last of them."""

    box: Box
    times: tuple[Fraction, ...]
    states: tuple[State, ...]
    zeros: Zeros  # those that were requested; without xdot where that is identically zero
    still: bool  # xdot is identically zero


class DerivedZero(NamedTuple):
    """A zero in the scene's own motion, or None, and its derivatives to each input, or nothing."""

    own: EnclosedZero | None
    times: tuple[Interval, ...] = ()
    # about the plumb line, in degrees, at highest and lowest points
    azimuths: tuple[Interval, ...] = ()


@dataclass(frozen=True, eq=False)
class ProvedDerivatives:
    """Derivatives to `names`, for all inputs of a box: of states, and of the times of zeros."""

    proved: ProvedBox
    names: tuple[str, ...]
    states: tuple[tuple[State, ...], ...]  # per time, per name
    zeros: dict[str, tuple[DerivedZero, ...]]  # of transits, highest and lowest points, by word


class Tangent(NamedTuple):
    """Polynomials near the derivative ρ of the position to an input, on a step, and its bounds."""

    P: list[Any]
    unit: Any
    a: arb
    a_rate: arb


class Sizes(NamedTuple):
    """Upper bounds of sup norms on |s| <= 1: of the defects, |p|, |K|, ||p|² - 1|, |d1'|."""

    d1: arb
    d2: arb
    p: arb
    k: arb
    tau: arb
    d1_rate: arb


class Tube(NamedTuple):
    """Bounds of |r - p|, |r' - p'|, |r'' - p''| on a step."""

    eta: arb
    u: arb
    a: arb


class CompiledSums(NamedTuple):
    """What compiled code made of a step, from which digits, and what it returned."""

    rows: Any  # of x, m, w, λ, shape (4, L, orders)
    constants: Any  # of `system.Integers` and 2^B, shape (6, L)
    absolute: Any  # sums of digits, shape (8, rows)
    digits: Any  # shape (rows, 7, columns)
    product_rows: int  # the lowest rows, in which products are summed


class Covered(NamedTuple):
    """A step's piece, with the tube about its polynomials in which the motion stays."""

    piece: Any
    tube: Tube


Proposal = list[list[list[int]]]  # six columns of six polynomials of integers


class Leaf(NamedTuple):
    """A part of a step where a form may be 0.

    `rate_sign` is the sign of its rate on it (a leaf M, monotone), or 0 (a leaf R, undecided).
    """

    rate_sign: int
    low: arb
    high: arb
    form: Any
