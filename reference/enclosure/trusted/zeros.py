"""TRUSTED. Every zero of a form in (0, T]: which are single, and where; xdot itself (THEOREM.md, section 8)."""

from fractions import Fraction
from functools import reduce
from itertools import pairwise
from typing import Any

from flint import arb, arb_poly, ctx

from ..guess import around_zero
from .balls import SHORT, Vector, ball, cross, demand, interval
from .shapes import Covered, EnclosedZero, Leaf
from .system import SceneBalls
from .tube import state

MOST_LEAVES = 4096  # of a step that are sorted: what is left of it is reported as one possible zero


def sign(x: arb) -> int:
    """Return the sign that all points of a ball have, or 0."""
    return 1 if x > 0 else -1 if x < 0 else 0


class Slope:
    """xdot lies in f ± u and xddot in f' ± a on a piece, f = p'_x; all in scaled time."""

    names: tuple[str, ...] = ("x", "y", "z", "vy", "ax")  # what `row` returns

    def __init__(self, covered: Covered) -> None:
        self.covered, self.piece, self.unit, (piece, tube) = (
            covered,
            covered.piece,
            covered.piece.unit,
            covered,
        )
        self.centre, self.slow, self.flat = (
            ball(piece.step.centre),
            piece.balls.slow,
            piece.balls.flat,
        )
        self.forms: Any = ((piece.v[0], arb(0, tube.u)), (piece.v[0].derivative(), arb(0, tube.a)))

    def at(self, n: int, s: arb) -> Any:
        """Return a ball that contains xdot (n = 0) or xddot (n = 1) on the ball `s`."""
        return self.forms[n][0](s) / self.unit + self.forms[n][1]

    def rate(self, s: arb) -> Any:
        """Return a ball that contains xddot on `s`; about the middle of `s` where the series about 0 shows no sign."""
        (f, off), plain = self.forms[1], self.at(1, s)
        return (
            plain
            if sign(plain)
            else arb_poly(f)(arb_poly([s.mid(), 1]))(s - s.mid()) / self.unit + off
        )

    def push(self, s: arb) -> int:
        """Return the sign of xdot on `s` after a start at rest with x = 0: that of the Coriolis force; or 0."""
        k, bend = (
            self.piece.constants,
            [f.derivative()(s) / self.piece.unit + self.forms[1][1] for f in self.piece.v],
        )
        return sign(cross(bend, k.omega)[0]) if 4 * s.rad() ** 2 * (k.c_size + k.S**2) < 1 else 0

    def row(self, s: arb) -> Vector:
        """Return x, y, z, vy and ax over the length at a transit; xdot, the velocity's first component, is 0."""
        turned, h, (r, v) = (
            self.piece.balls.turned,
            self.piece.constants.h,
            state(self.covered, s, 1),
        )
        return [*turned(r, -1), turned([0, *v], -1)[1] / h, self.at(1, s) / h**2]


class Scan:
    """Bisects the steps into leaves and closes clusters of those that are not E, also across steps (section 8).

    With `only` a direction, single zeros in the other one are left out.
    """

    def __init__(self, balls: SceneBalls, slope: Any = Slope, only: int = 0) -> None:
        self.balls, self.left, self.time, self.leaves, self.slope = balls, 0, Fraction(0), 0, slope
        self.end: tuple[Slope, arb] | None = None
        self.only, self.found, self.cluster = only, list[EnclosedZero](), list[Leaf]()

    def advance(self, covered: Covered) -> None:
        """Sort the leaves of the next step."""
        piece = covered.piece
        demand(
            piece.begin == self.time and piece.balls is self.balls,
            "steps must join, and be of one scene",
        )
        with ctx.workprec(self.balls.prec):
            slope, low, high = self.slope(covered), ball(piece.step.low), ball(piece.step.high)
            self.left = self.left if self.time else sign(slope.at(0, low))
            self.end, self.time, self.leaves = (slope, high), piece.end, 0
            for part in pairwise(
                [low, *((low + (high - low) * k / 4).mid() for k in (1, 2, 3)), high]
            ):
                self._sort(slope, *part, 2)

    def _sort(self, slope: Slope, low: arb, high: arb, depth: int) -> None:
        self.leaves += 1
        # most leaves are decided at low precision, and only a few need all bits
        with ctx.workprec(SHORT if depth < 4 else self.balls.prec):
            whole, middle = low.union(high), ((low + high) / 2).mid()
            demand(low < middle < high, "a step is too short for the precision")
            rate = slope.at(1, whole) if depth < 4 else slope.rate(whole)
            speed = slope.at(0, middle) + rate * (whole - middle)  # the mean value form
            way, bend = sign(speed), sign(rate)
            if not way and slope.slow and not (self.left or self.cluster):
                # this is the first leaf: from rest, xdot takes the sign of its first derivative that is not 0
                way = bend or (slope.push(whole) if slope.flat else 0)
            elif not way and bend and sign(slope.at(0, low)) == (last := sign(slope.at(0, high))):
                way = last
        deep = 2 * depth >= self.balls.prec or self.leaves > MOST_LEAVES
        if way:
            self._close(way)
        elif bend or deep or not speed.abs_upper() > 3 * slope.forms[0][1].rad():
            self.cluster.append(Leaf(bend, low, high, slope))
        else:
            self._sort(slope, low, middle, depth + 1)
            self._sort(slope, middle, high, depth + 1)

    def finish(self) -> list[EnclosedZero]:
        """Close the cluster that is open at T; return all zeros in order."""
        with ctx.workprec(self.balls.prec):
            self._close(sign(self.end[0].at(0, self.end[1])) if self.end else 0)
        return self.found

    def _close(self, right: int) -> None:
        leaves, sides, self.cluster, self.left = self.cluster, (self.left, right), [], right
        steady, product = {leaf.bend for leaf in leaves} in ({1}, {-1}), sides[0] * right
        demand(
            product >= 0 or (leaves[0].bend == right if steady else bool(leaves)),
            "two enclosures contradict",
        )
        if not leaves or (
            steady and (product > 0 or (product < 0 and leaves[0].bend == -self.only))
        ):
            return
        ends = ((leaves[0].slope, leaves[0].low), (leaves[-1].slope, leaves[-1].high))
        begin, end = (slope.centre + s * slope.piece.constants.h for slope, s in ends)
        t = narrowed(leaves, begin, end, sides) if steady else begin.union(end)
        parity = "one" if steady and product < 0 else {-1: "odd", 0: "unknown", 1: "even"}[product]
        way = leaves[0].bend if steady else right if product < 0 else 0
        rows = zip(*(slope.row(s) for slope, s in touched(leaves, t)), strict=True)
        values = (interval(reduce(arb.union, x) * self.balls.length) for x in rows)
        named = dict(zip(leaves[0].slope.names, values, strict=True))
        self.found.append(EnclosedZero(parity, way, interval(t), **named))


def touched(leaves: list[Leaf], t: arb) -> list[tuple[Slope, arb]]:
    """Return the leaves that the time ball `t` may touch, each with the part of `t` in it as s."""
    parts = [
        (x.slope, (t - x.slope.centre) / x.slope.piece.constants.h, x.low.union(x.high))
        for x in leaves
    ]
    return [(slope, s.intersection(whole)) for slope, s, whole in parts if s.overlaps(whole)]


def narrowed(leaves: list[Leaf], begin: arb, end: arb, sides: tuple[int, int]) -> arb:
    """Return where a monotone xdot may be 0: between proposed times, if it has its sides' signs there still."""
    ends = [begin, end]
    for n, t in enumerate(around_zero(leaves)):
        # outside the leaves nothing is known
        if begin < t < end and {sign(f.at(0, s)) for f, s in touched(leaves, t)} == {sides[n]} != {
            0
        }:
            ends[n] = t
    return ends[0].union(ends[1])
