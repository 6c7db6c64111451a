"""TRUSTED. Every zero of a form in (0, T]: which are single, and where (THEOREM.md, section 8).

The form is xdot, or one of `sections`; all of this is in the time of a step, s = (t - centre)/h.

| name               | symbol                                                       | unit          |
|--------------------|--------------------------------------------------------------|---------------|
| `value.polynomial` | f: for xdot it is p'_x                                       | over `unit`   |
| `value.off`        | U: hF lies in f ± U; for xdot, hF is x'                      | a step's time |
| `rate.polynomial`  | f'                                                           | over `unit`   |
| `rate.off`         | A: hF' lies in f' ± A                                        | a step's time |
| `left`, `right`    | the signs of F on both sides of a cluster, 0 if not known    |               |
| `rate_sign`        | the sign of F' on a leaf: ±1 on a leaf M, 0 on a leaf R      |               |
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import pairwise
from typing import Any, NamedTuple

from flint import arb, arb_poly, ctx

from ..guess import around_zero
from .balls import SHORT, ball, cross, demand, interval
from .defect import Piece
from .shapes import Covered, EnclosedZero, Leaf
from .system import SceneBalls
from .tube import state

MOST_LEAVES = 4096  # of a step that are sorted: what is left of it is reported as one possible zero
FIRST_DEPTH = 2  # a step is cut in four
FULL_DEPTH = 4  # from here on a leaf takes all bits: most are decided before


def sign(x: arb) -> int:
    """Return the sign that all points of a ball have, or 0."""
    if x > 0:
        return 1
    return -1 if x < 0 else 0


class Enclosed(NamedTuple):
    """A polynomial of a step, and a ball around 0 that bounds how far the truth is from it."""

    polynomial: Any
    off: arb


class ShortForms(NamedTuple):
    """A form and its rate in few bits and orders, as polynomials that contain both."""

    value: arb_poly
    rate: arb_poly


class FormOnStep:
    """A form F on a step: hF lies in `value`, and hF' in `rate`, polynomials over `unit`.

    `zero_at_release` says that F is exactly 0 at the release.
    """

    value: Enclosed
    rate: Enclosed
    unit: Any
    zero_at_release: bool
    short: ShortForms | None = None

    def __init__(self, covered: Covered) -> None:
        self.covered = covered
        self.piece: Piece = covered.piece
        self.centre = ball(self.piece.step.centre)

    def value_at(self, s: arb) -> Any:
        """Return a ball that contains hF on the ball `s`."""
        return self.value.polynomial(s) / self.unit + self.value.off

    def rate_at(self, s: arb) -> Any:
        """Return a ball that contains hF' on the ball `s`."""
        return self.rate.polynomial(s) / self.unit + self.rate.off

    def rate_on_leaf(self, s: arb) -> Any:
        """Return the same; by the series about the middle of `s` if that about 0 shows no sign."""
        about_0 = self.rate_at(s)
        if sign(about_0):
            return about_0
        about_middle = arb_poly(self.rate.polynomial)(arb_poly([s.mid(), 1]))
        return about_middle(s - s.mid()) / self.unit + self.rate.off

    def sign_from_rest(self, s: arb) -> int:
        """Return the sign of F on the first leaf `s` if F and F' are 0 at the release, or 0."""
        return 0

    def row(self, s: arb) -> dict[str, Any]:
        """Return the state's balls over the length at a zero that lies in the ball `s`."""
        raise NotImplementedError


class XdotOnStep(FormOnStep):
    """xdot on a step."""

    def __init__(self, covered: Covered) -> None:
        super().__init__(covered)
        piece = covered.piece
        tube = covered.tube
        self.unit = piece.unit
        self.value = Enclosed(piece.v[0], arb(0, tube.u))
        self.rate = Enclosed(piece.v[0].derivative(), arb(0, tube.a))
        self.zero_at_release = piece.balls.slow

    def sign_from_rest(self, s: arb) -> int:
        """Return the sign of the Coriolis force on the first leaf `s`, after rest at x = 0; or 0."""
        if not self.piece.balls.flat:
            return 0
        constants = self.piece.constants
        acceleration = [f.derivative()(s) / self.unit + self.rate.off for f in self.piece.v]
        delta_squared = 4 * s.rad() ** 2
        Q = constants.c_size + constants.S**2
        # (8.10): u = (r'' × Ω)_x
        return sign(cross(acceleration, constants.omega)[0]) if delta_squared * Q < 1 else 0

    def row(self, s: arb) -> dict[str, Any]:
        """Return x, y, z, vy and ax at a transit; xdot, the velocity's first component, is 0."""
        turned = self.piece.balls.turned
        h = self.piece.constants.h
        r, v = state(self.covered, s, 1)
        x, y, z = turned(r, -1)
        _, vy, _ = turned([0, *v], -1)
        return {"x": x, "y": y, "z": z, "vy": vy / h, "ax": self.rate_at(s) / h**2}


class Place(NamedTuple):
    """A ball of s in a step, with the form there."""

    form: FormOnStep
    s: arb


class Scan:
    """Bisects the steps into leaves, and closes clusters of those that are not E, across steps too.

    With `only` a direction, single zeros in the other one are left out.
    """

    def __init__(
        self,
        balls: SceneBalls,
        form_on: Callable[[Covered], FormOnStep] = XdotOnStep,
        only: int = 0,
    ) -> None:
        self.balls = balls
        self.form_on = form_on
        self.only = only
        self.time = Fraction(0)
        self.form: FormOnStep | None = None  # on the last step
        self.leaves = 0  # of the last step
        self.left = 0
        self.cluster = list[Leaf]()
        self.found = list[EnclosedZero]()

    def advance(self, covered: Covered) -> None:
        """Sort the leaves of the next step."""
        piece = covered.piece
        joins = piece.begin == self.time and piece.balls is self.balls
        demand(joins, "steps must join, and be of one scene")
        with ctx.workprec(self.balls.prec):
            form = self.form_on(covered)
            ends = _quarters(piece.step.low, piece.step.high, self.balls.prec)
            if not self.time:
                self.left = sign(form.value_at(ends[0]))
            self.form = form
            self.time = piece.end
            self.leaves = 0
            for begin, end in pairwise(ends):
                self._sort(form, begin, end, FIRST_DEPTH)

    def finish(self) -> list[EnclosedZero]:
        """Close the cluster that is open at T; return all zeros in order."""
        with ctx.workprec(self.balls.prec):
            right = 0
            if self.form is not None:
                right = sign(self.form.value_at(ball(self.form.piece.step.high)))
            self._close(right)
        return self.found

    def _sort(self, form: FormOnStep, low: arb, high: arb, depth: int) -> None:
        """Close the cluster at a leaf E, add a leaf M or R to it, or cut the leaf in halves."""
        self.leaves += 1
        deep = depth >= FULL_DEPTH
        with ctx.workprec(self.balls.prec if deep else SHORT):
            whole = low.union(high)
            middle = ((low + high) / 2).mid()
            demand(low < middle < high, "a step is too short for the precision")
            rate = form.rate_on_leaf(whole) if deep else form.rate_at(whole)
            # (8.1)
            value = form.value_at(middle) + rate * (whole - middle)
            rate_sign = sign(rate)
            value_sign = sign(value) or self._other_sign(form, low, high, rate_sign)

        exhausted = 2 * depth >= self.balls.prec or self.leaves > MOST_LEAVES
        if value_sign:
            self._close(value_sign)
        # (8.3), (8.4)
        elif rate_sign or exhausted or not value.abs_upper() > 3 * form.value.off.rad():
            self.cluster.append(Leaf(rate_sign, low, high, form))
        else:
            self._sort(form, low, middle, depth + 1)
            self._sort(form, middle, high, depth + 1)

    def _other_sign(self, form: FormOnStep, low: arb, high: arb, rate_sign: int) -> int:
        """Return the sign of F on a leaf on which the mean value form has none, or 0."""
        first = not (self.left or self.cluster)
        if first and form.zero_at_release:
            if rate_sign:
                return rate_sign  # (8.9), (13.2a)
            return form.sign_from_rest(low.union(high))

        if rate_sign:
            # (8.2)
            at_low = sign(form.value_at(low))
            at_high = sign(form.value_at(high))
            return at_high if at_low == at_high else 0
        return 0

    def _close(self, right: int) -> None:
        """Close the cluster at a leaf E with the sign `right`, or at T."""
        leaves = self.cluster
        left = self.left
        self.cluster = []
        self.left = right
        if not leaves:
            demand(left * right >= 0, "two enclosures contradict")
            return

        rate_sign = leaves[0].rate_sign
        monotone = rate_sign != 0 and all(leaf.rate_sign == rate_sign for leaf in leaves)
        if monotone and left * right > 0:
            return  # (8.5)
        if monotone and left * right < 0:
            # (8.6)
            demand(rate_sign == right, "two enclosures contradict")
            if rate_sign != -self.only:
                self._add("one", rate_sign, leaves, narrowed(leaves, left, right))
            return

        # (8.7)
        parity = {-1: "odd", 0: "unknown", 1: "even"}[left * right]
        direction = 0
        if monotone:
            direction = rate_sign
        elif left * right < 0:
            direction = right
        t = narrowed(leaves, left, right) if monotone else time_of(leaves)
        self._add(parity, direction, leaves, t)

    def _add(self, parity: str, direction: int, leaves: list[Leaf], t: arb) -> None:
        """Add a zero that lies in the ball of time `t`, with all states that the motion has there."""
        rows = [place.form.row(place.s) for place in touched(leaves, t)]
        state = {
            name: interval(reduce(arb.union, [row[name] for row in rows]) * self.balls.length)
            for name in rows[0]
        }
        self.found.append(EnclosedZero(parity, direction, interval(t), **state))


@lru_cache(maxsize=16)  # most steps go from -1 to 1
def _quarters(low: Fraction, high: Fraction, prec: int) -> tuple[arb, ...]:
    """Return the ends of the quarters of a step in `prec` bits, those between them exact."""
    with ctx.workprec(prec):
        begin = ball(low)
        length = ball(high) - begin
        cuts = [(begin + length * k / 4).mid() for k in (1, 2, 3)]
        return (begin, *cuts, ball(high))


def time_of(leaves: Sequence[Leaf]) -> arb:
    """Return a ball of time that contains the leaves of a cluster."""
    return begin_of(leaves[0]).union(end_of(leaves[-1]))


def begin_of(leaf: Leaf) -> arb:
    """Return the time at which a leaf begins."""
    form: FormOnStep = leaf.form
    return form.centre + leaf.low * form.piece.constants.h


def end_of(leaf: Leaf) -> arb:
    """Return the time at which a leaf ends."""
    form: FormOnStep = leaf.form
    return form.centre + leaf.high * form.piece.constants.h


def touched(leaves: Sequence[Leaf], t: arb) -> list[Place]:
    """Return the part of the ball of time `t` in each leaf that it may touch."""
    places = []
    for leaf in leaves:
        s = (t - leaf.form.centre) / leaf.form.piece.constants.h
        whole = leaf.low.union(leaf.high)
        if s.overlaps(whole):
            places.append(Place(leaf.form, s.intersection(whole)))
    return places


def narrowed(leaves: Sequence[Leaf], left: int, right: int) -> arb:
    """Return where a monotone F may be 0: between proposed times, if it has its sides' signs there.

    `left` and `right` are the signs of F on both sides of the leaves, 0 if not known.
    """
    begin = begin_of(leaves[0])
    end = end_of(leaves[-1])

    def keeps(t: arb, side: int) -> bool:
        """Return whether F has the sign of a side at `t`; outside the leaves nothing is known."""
        if not begin < t < end or side == 0:
            return False
        return {sign(place.form.value_at(place.s)) for place in touched(leaves, t)} == {side}

    # (8.8)
    before, after = around_zero(leaves)
    low = before if keeps(before, left) else begin
    high = after if keeps(after, right) else end
    return low.union(high)
