"""TRUSTED. Section 8 of THEOREM.md: every zero of xdot in (0, T], which of them are single, and where they are."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

from flint import arb, arb_poly, ctx, fmpz

from .balls import ball, interval, norm
from .bound import Piece, World, motion, state
from .shapes import EnclosedTransit, Interval, Leaf, Tube

COARSE = 80  # bits while leaves are sorted
CUT, FEW = 40, 10  # terms taken in the first bisections, and how many those are


def sign(x: arb) -> int:
    """The sign of every point of a ball; 0 if there is none."""
    return 1 if x > 0 else -1 if x < 0 else 0


def hull(balls: Iterable[arb]) -> arb:
    """A ball that contains them all."""
    return reduce(arb.union, balls)


class Slope:
    """xdot lies in f ± u and xddot in f' ± a on a piece, f = p'_x; all in scaled time."""

    def __init__(self, piece: Piece, tube: Tube) -> None:
        self.piece, self.tube, f = piece, tube, piece.polys[0].derivative()
        self.whole, self.off = [arb_poly(g) for g in (f, f.derivative())], [arb(0, tube.u), arb(0, tube.a)]
        with ctx.workprec(COARSE):
            self.few = [arb_poly(g.truncate(CUT)) for g in (f, f.derivative())]
        self.tail = [arb(0, arb(fmpz(norm(g.right_shift(CUT))))) for g in (f, f.derivative())]

    def at(self, n: int, s: arb, few: bool = False) -> arb:
        """Contains xdot (n = 0) or xddot (n = 1) on the ball `s`; `few` terms and a bound of the others, or all."""
        return (self.few[n](s) + self.tail[n] if few else self.whole[n](s)) / self.piece.unit + self.off[n]

    def time(self, s: arb) -> arb:
        """From s to seconds."""
        return ball(self.piece.step.centre) + s * self.piece.k.h


class Scan:
    """Sorts leaves step by step and closes clusters of those that are not E, also across steps."""

    def __init__(self, world: World) -> None:
        self.world, self.begun, self.left, self.right = world, False, 0, 0
        self.found: list[EnclosedTransit] = []
        self.cluster: list[Leaf] = []

    def advance(self, piece: Piece, tube: Tube) -> None:
        """Take the next step."""
        with ctx.workprec(self.world.prec):
            slope, low, high = Slope(piece, tube), ball(piece.step.low), ball(piece.step.high)
            self.right = sign(slope.at(0, high))
            if not self.begun:
                self.left = sign(slope.at(0, low))
        self._sort(slope, low, high, 0)

    def _sort(self, slope: Slope, low: arb, high: arb, depth: int) -> None:
        few, kind = depth < FEW, "E"
        with ctx.workprec(COARSE if few else self.world.prec):
            whole, middle = low.union(high), ((low + high) / 2).mid()
            rate = slope.at(1, whole, few)
            # deep down the mean value form, or a double root would take leaves without end
            speed = slope.at(0, whole, few) if few else slope.at(0, middle) + rate * (whole - middle)
            if not (way := sign(speed)):
                way = sign(rate)
                if not self.begun and self.world.slow:
                    # from rest, xdot takes the sign of its first derivative that is not 0
                    if self.world.flat and not way:
                        way = sign(motion(slope.piece.k, *state(slope.piece, slope.tube, whole))[2][0])
                elif way:
                    ends = {sign(slope.at(0, s, few)) for s in (low, high)}
                    kind, way = ("E", ends.pop()) if ends in ({1}, {-1}) else ("M", way)
        if not way and 2 * depth < self.world.prec and speed.abs_upper() > 2 * slope.tube.u:
            self._sort(slope, low, middle, depth + 1)
            self._sort(slope, middle, high, depth + 1)
            return
        self.begun = True
        if not way or kind == "M":
            self.cluster.append(Leaf(kind if way else "R", way, low, high, slope))
            return
        self._close(way)
        self.left = way

    def finish(self) -> list[EnclosedTransit]:
        """Close at T what is open; all of them in order."""
        self._close(self.right)
        return self.found

    def _close(self, right: int) -> None:
        leaves, self.cluster, product = self.cluster, [], self.left * right
        ways = {leaf.way for leaf in leaves}
        steady = len(ways) == 1 and 0 not in ways
        if not leaves or (steady and product > 0):
            return
        with ctx.workprec(self.world.prec):
            t = leaves[0].slope.time(leaves[0].low).union(leaves[-1].slope.time(leaves[-1].high))
            inner = contract(leaves, t) if steady else t
            if inner is None and product < 0:
                raise ArithmeticError("two enclosures contradict each other")
            if inner is not None:
                kind, parity = "possible", {-1: "odd", 0: "unknown", 1: "even"}[product]
                if steady and product < 0:
                    kind = parity = "one"
                way = ways.pop() if steady else right if product < 0 else 0
                self.found.append(EnclosedTransit(kind, parity, way, interval(inner), *self._values(leaves, inner)))

    def _values(self, leaves: list[Leaf], t: arb) -> Iterable[Interval]:
        rows = []
        for slope, s in touched(leaves, t):
            k, (r, H) = slope.piece.k, state(slope.piece, slope.tube, s)
            v, a, _ = motion(k, r, H)
            rows.append([*r, v[1] / k.h, a[0] / k.h**2])
        return [interval(hull(x) * self.world.length) for x in zip(*rows, strict=True)]


def touched(leaves: list[Leaf], t: arb) -> list[tuple[Slope, arb]]:
    """The parts of the time ball `t` in the leaves that it may touch, as s."""
    local = [(leaf, (t - ball(leaf.slope.piece.step.centre)) / leaf.slope.piece.k.h) for leaf in leaves]
    parts = [(leaf.slope, s, leaf.low.union(leaf.high)) for leaf, s in local]
    return [(slope, s.intersection(whole)) for slope, s, whole in parts if s.overlaps(whole)]


def contract(leaves: list[Leaf], t: arb) -> arb | None:
    """Interval Newton where xddot keeps its sign; None if it proves that there is no zero."""
    while True:
        middle = t.mid()
        speed = hull(f.at(0, s) / f.piece.k.h for f, s in touched(leaves, middle))
        rate = hull(f.at(1, s) / f.piece.k.h**2 for f, s in touched(leaves, t))
        new = middle - speed / rate if sign(rate) else t
        if not new.overlaps(t):
            return None
        new = new.intersection(t)
        if not new.rad() < t.rad() * 3 / 4:
            return new
        t = new
