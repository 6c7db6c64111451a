"""TRUSTED. Section 8 of THEOREM.md: every zero of xdot in (0, T], which of them are single, and where they are."""

from functools import reduce

from flint import arb, arb_poly, ctx

from .balls import ball, interval
from .bound import Piece, World, motion, state
from .shapes import EnclosedTransit, Interval, Leaf, Tube


def sign(x: arb) -> int:
    """The sign of every point of a ball; 0 if there is none."""
    return 1 if x > 0 else -1 if x < 0 else 0


class Slope:
    """xdot lies in f ± u and xddot in f' ± a on a piece, f = p'_x; all in scaled time."""

    def __init__(self, piece: Piece, tube: Tube) -> None:
        self.piece, self.tube, f = piece, tube, piece.polys[0].derivative()
        self.forms = [(arb_poly(f), arb(0, tube.u)), (arb_poly(f.derivative()), arb(0, tube.a))]

    def at(self, n: int, s: arb) -> arb:
        """Contains xdot (n = 0) or xddot (n = 1) on the ball `s`."""
        return self.forms[n][0](s) / self.piece.unit + self.forms[n][1]


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
        whole, middle = low.union(high), ((low + high) / 2).mid()
        if not low < middle < high:
            raise ArithmeticError("a step is too short for the precision")
        rate = slope.at(1, whole)
        speed = slope.at(0, middle) + rate * (whole - middle)  # the mean value form
        way, bend = sign(speed), sign(rate)
        if not way and not self.begun and self.world.slow:
            # from rest, xdot takes the sign of its first derivative that is not 0
            way = bend
            if self.world.flat and not way:
                way = sign(motion(slope.piece.k, *state(slope.piece, slope.tube, whole))[2][0])
        elif not way and bend:
            first, last = sign(slope.at(0, low)), sign(slope.at(0, high))
            way = first if first == last else 0
        if way:
            self._close(way)
            self.left = way
        elif bend or 2 * depth >= self.world.prec or not speed.abs_upper() > 2 * slope.tube.u:
            self.cluster.append(Leaf(bend, low, high, slope))
        else:
            self._sort(slope, low, middle, depth + 1)
            self._sort(slope, middle, high, depth + 1)
        self.begun = True

    def finish(self) -> list[EnclosedTransit]:
        """Close at T what is open; all of them in order."""
        with ctx.workprec(self.world.prec):
            self._close(self.right)
        return self.found

    def _close(self, right: int) -> None:
        leaves, self.cluster, product = self.cluster, [], self.left * right
        steady = {leaf.bend for leaf in leaves} in ({1}, {-1})
        if not leaves or (steady and product > 0):
            return
        ends = ((leaves[0].slope.piece, leaves[0].low), (leaves[-1].slope.piece, leaves[-1].high))
        begin, end = (ball(piece.step.centre) + s * piece.k.h for piece, s in ends)
        inner = contract(leaves, begin, end) if steady else begin.union(end)
        if inner is not None:
            parity = "one" if steady and product < 0 else {-1: "odd", 0: "unknown", 1: "even"}[product]
            way = leaves[0].bend if steady else right if product < 0 else 0
            self.found.append(EnclosedTransit(parity, way, interval(inner), *self._values(leaves, inner)))
        elif product < 0:
            raise ArithmeticError("two enclosures contradict each other")

    def _values(self, leaves: list[Leaf], t: arb) -> list[Interval]:
        rows = []
        for slope, s in touched(leaves, t):
            k, (r, H) = slope.piece.k, state(slope.piece, slope.tube, s)
            v, a, _ = motion(k, r, H)
            rows.append([*r, v[1] / k.h, a[0] / k.h**2])
        return [interval(reduce(arb.union, x) * self.world.length) for x in zip(*rows, strict=True)]


def touched(leaves: list[Leaf], t: arb) -> list[tuple[Slope, arb]]:
    """The parts of the time ball `t` in the leaves that it may touch, as s."""
    local = [(leaf, (t - ball(leaf.slope.piece.step.centre)) / leaf.slope.piece.k.h) for leaf in leaves]
    parts = [(leaf.slope, s, leaf.low.union(leaf.high)) for leaf, s in local]
    return [(slope, s.intersection(whole)) for slope, s, whole in parts if s.overlaps(whole)]


def contract(leaves: list[Leaf], begin: arb, end: arb) -> arb | None:
    """Interval Newton where xddot keeps its sign; None if it proves that there is no zero."""
    t = begin.union(end)
    while begin < (middle := t.mid()) < end:  # outside of the leaves nothing is known
        speed = reduce(arb.union, (f.at(0, s) / f.piece.k.h for f, s in touched(leaves, middle)))
        rate = reduce(arb.union, (f.at(1, s) / f.piece.k.h**2 for f, s in touched(leaves, t)))
        new = middle - speed / rate if sign(rate) else t
        if not new.overlaps(t):
            return None
        new = new.intersection(t)
        if not new.rad() < t.rad() * 3 / 4:
            return new
        t = new
    return t
