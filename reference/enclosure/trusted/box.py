"""TRUSTED. A box of inputs: what holds for every pendulum with inputs in it, by one radius (THEOREM.md, section 11).

The motion of each is turned, so that its c has the direction of the scene's, and its time is scaled, so that c has the
same size. What is left of the box is in Ω, γ and the release. A proof of a point imports none of this.
"""

from copy import copy
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from typing import Any

from flint import arb, arb_series, ctx

from .balls import SHORT, Vector, add, ball, cross, demand, interval, size, times, total, upper
from .course import FINISHED, Course
from .defect import Piece
from .printed import RELEASES
from .radius import Radius
from .shapes import Box, Covered, ProvedBox, Sizes
from .system import SceneBalls
from .tube import tube

PARTS = 16  # of a unit of s, over which a state is bounded at once


def hull(low: Any, high: Any) -> Any:
    """Return a ball that contains an interval, or such balls; what is the same at both ends is left as it is."""
    if low == high:
        return low
    return tuple(map(hull, low, high)) if isinstance(low, tuple) else ball(low).union(ball(high))


class BoxBalls(SceneBalls):
    """The balls of a scene, but for those that hold the box: release, lengths, Ω `turning`, γ `damping`, `pace`.

    `omega` and `drag` are the scene's own.
    """

    def __init__(self, box: Box, prec: int) -> None:
        demand(min(box.low.drag, box.high.drag) >= 0, "the theorems take a drag >= 0")
        own = SceneBalls(box.inputs, prec)
        with ctx.workprec(prec):
            wide = {name: hull(low, getattr(box.high, name)) for name, low in vars(box.low).items()}
        # an interval from 0 on is a ball that reaches a little beyond
        super().__init__(replace(box.inputs, **wide | {"drag": box.low.drag}), prec)
        with ctx.workprec(prec):
            # in m and m/s, without the length
            self.given = [ball(q) for q in wide["position"] or ()]
            self.inputs, self.wide, self.own, self.c = box, wide, own, own.c
            self.measure(wide)
            self.paces = interval(self.pace)
            self.begin(self.v)
            self.omega = own.omega
            self.drag = own.drag
            self.H = cross(self.r, add(self.v, cross(self.omega, self.r)))  # with the scene's Ω

    def measure(self, wide: dict[str, Any]) -> None:
        """Take what follows from inputs, balls or series of balls: length, pace, axes, Ω, γ and the release (11.1)."""
        (m, w), (lean, pull), self.length = self.c[1:], plumb(wide), ball(wide["length"])
        self.pace, turn = (
            (pull / self.length / (m * m + w * w).sqrt()).sqrt(),
            arb.atan2(-w, m) - lean,
        )
        axis, self.tilt = (turn - ball(wide["latitude"]) * arb.pi() / 180).sin_cos(), turn.sin_cos()
        self.turning = times(ball(wide["rotation_rate"]) / self.pace, [arb(0), *axis])
        self.damping, self.release = (
            ball(wide["drag"]) / self.pace,
            self._release(replace(self.inputs.inputs, **wide)),
        )
        self.r, self.v = (
            self.turned(self.release[0], 1),
            times(1 / self.pace, self.turned(self.release[1], 1)),
        )

    def varied(self, name: str, scale: arb) -> Any:
        """Return what `measure` takes of series: their first coefficients are derivatives to an input, scaled."""
        twin, wide, kind = copy(self), dict(self.wide), "position" if self.given else "angles"

        def series(x: Any) -> Any:
            return arb_series([ball(x), scale], 2)

        with ctx.workprec(self.prec):
            if name in RELEASES[kind]:
                wide[kind] = tuple(
                    series(x) if n == name else x
                    for n, x in zip(RELEASES[kind], wide[kind], strict=True)
                )
            elif name == "inverse_flattening":
                wide["flattening"] = 1 / series(1 / ball(wide["flattening"]))
            else:
                wide[name] = series(wide[name])
            twin.measure(wide)
        return twin


def plumb(wide: dict[str, Any]) -> tuple[Any, Any]:
    """Return by what angle the plumb line leans, and the strength of the pull along it."""
    names = ("gravity", "altitude", "rotation_rate", "equatorial_radius", "flattening")
    gravity, altitude, rate, radius, f = (ball(wide[name]) for name in names)
    # of twice the latitude, so that a ball of it stays narrow
    sin, cos = ball(wide["latitude"] / 90).sin_cos_pi()
    push = rate * rate * (radius / (1 - f * (2 - f) * (1 - cos) / 2).sqrt() + altitude)
    push *= 0 if wide["gravity_is"] == "effective" else 1
    aside, down = push * sin / 2, gravity - push * (1 + cos) / 2
    lean: Any = aside / down
    angle = arb.atan2(*map(value, (aside, down)))  # its derivative: of atan
    full = arb_series([angle, lean.atan()[1]], 2) if isinstance(lean, arb_series) else angle
    return full, (aside * aside + down * down).sqrt()


class BoxRadius(Radius):
    """Theorem C for all inputs of a box."""

    balls: BoxBalls

    def widened(self, piece: Piece) -> tuple[Piece, Sizes, arb]:
        """Return a piece with what holds for the box: its constants, its defects, its jump (Lemmas 11.2 and 11.3)."""
        whole, balls, jump, h = copy(piece), self.balls, self.join(piece), piece.k.h
        with ctx.workprec(balls.prec):
            k = whole.k = copy(piece.k)  # whose integers remain those of the scene
            k.omega, k.drag_size = times(h, balls.turning), upper(h * balls.damping)
            k.omega_size, off = size(k.omega), add(k.omega, times(-1, piece.k.omega))
            turn, slow = size(off), upper(abs(h * balls.damping - piece.k.drag))
        with ctx.workprec(SHORT):
            norms = whole.defects()
            whole.defects = lambda: norms  # type: ignore[method-assign]
            d: Sizes = Piece.sizes.func(whole)  # type: ignore[attr-defined]
            v1, gap = size(norms[4:7]), size(jump[:3])
            along = sum(
                (
                    total(f, piece.step.bits) * x.abs_upper()
                    for f, x in zip(piece.p, off, strict=True)
                ),
                arb(0),
            )
            more = (
                2 * along * v1
                + turn * norms[7]
                + d.p**2 * turn * (k.omega_size + piece.k.omega_size)
            )
            moved = size(jump[3:]) + 2 * turn / h * gap * (2 * d.p + gap)
            return (
                whole,
                d._replace(d2=upper(d.d2 + more + slow * d.p * v1)),
                upper(gap + moved / balls.w0),
            )

    def advance(self, piece: Piece) -> Covered:
        """Carry the radius over a piece, with a bound of |e| that what follows has to confirm (Lemma 11.4)."""
        return self.grown(*self.widened(piece))

    def grown(self, whole: Piece, d: Sizes, jump: arb) -> Covered:
        """Carry the radius over a piece of the box."""
        with ctx.workprec(SHORT):
            k, w, span = whole.k, whole.k.w, ball(whole.step.high - whole.step.low)
            ck, gw = k.c_size + d.k**2, k.drag_size * k.omega_size * d.p
            start = upper(self.eta + jump + span * (ck * d.tau / (2 * w) + d.d2 / w + d.d1))
            far = upper(
                2 * start * (span * (k.below.max(k.above + k.speed**2) + gw) / (2 * w)).exp()
            )
            rate = k.below.max(k.above + (k.speed + (w + d.k) * far) ** 2) + ck * far + gw
            self.eta = upper(start * (span * rate / (2 * w)).exp())
            demand(self.eta < far, "a bound has outgrown what it rests on")
            return Covered(whole, tube(k, d, self.eta, (w + d.k) * self.eta))


class Windows:
    """Runs a course in the scene's time; gives states and zeros of all inputs of the box in their own time."""

    def __init__(self, box: Box, prec: int, until: list[Fraction], words: tuple[str, ...]) -> None:
        self.box, self.balls, self.times = box, BoxBalls(box, prec), tuple(until)
        self.pace, self.hulls, self.done = self.balls.paces, list[Vector](), 0
        demand(self.pace.low > 0 == until[0], "a box is followed from its release on")
        latest = self.pace.high * until[-1]
        self.course = Course(self.balls, [latest], False, words, second_order=True)
        self.course.bound = BoxRadius(self.balls)
        self.course.followers.append(self)

    def advance(self, covered: Covered) -> None:
        """Take the next tube: at each output time some pendulums of the box may be in it."""
        demand(not self.course.open, "a tube comes from the course alone, while it takes a step")
        for n in range(self.done, len(self.times)):
            low, high = self.pace.low * self.times[n], self.pace.high * self.times[n]
            if low > covered.piece.end:
                break
            parts = between(covered, max(low, covered.piece.begin), min(high, covered.piece.end))
            self.hulls[n : n + 1] = [
                [reduce(arb.union, x) for x in zip(*self.hulls[n : n + 1], *parts, strict=True)]
            ]
            self.done += high <= covered.piece.end

    def finish(self) -> ProvedBox:
        """Return what is proved, in the time of each pendulum, to which it was `pace` times that of the course."""
        proved, pace, length = self.course.finish(), self.balls.pace, self.balls.length
        demand(self.done == len(self.times), "the steps do not end with the run")
        with ctx.workprec(self.balls.prec):
            own = [[*times(length, x[:3]), *times(length * pace, x[3:])] for x in self.hulls]
            own[0] = [x * length for part in self.balls.release for x in part]
            if self.balls.given:
                own[0][:2], own[0][3:5] = self.balls.given[:2], self.balls.given[2:]
            states = tuple(tuple(map(interval, x)) for x in own)
            zeros = {word: self.in_own_time(found) for word, found in proved.zeros.items()}
        FINISHED.add(result := ProvedBox(self.box, self.times, states, zeros, proved.still))
        return result

    def in_own_time(self, zeros: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return zeros in the time of each pendulum: those that may come up to the end."""
        pace, moved = self.balls.pace, list[Any]()
        factors = {"t": 1 / pace, "vx": pace, "vy": pace, "vz": pace, "ax": pace**2}
        for z in zeros:
            old = {name: getattr(z, name, None) for name in factors}
            new = {
                name: interval(hull(x.low, x.high) * factors[name]) for name, x in old.items() if x
            }
            moved += [replace(z, **new)] if new["t"].low <= self.times[-1] else []
        return tuple(moved)


def between(covered: Covered, begin: Fraction, end: Fraction) -> list[Vector]:
    """Return balls of position and velocity that cover them from one time to another of a step, over the length."""
    (piece, (eta, u, _)), parts = covered, list[Vector]()
    with ctx.workprec(piece.balls.prec):
        for s in spread(piece, begin, end):
            x = [near(f, s) / piece.unit for f in (*piece.p, *piece.v)]
            r, v = [q + arb(0, eta) for q in x[:3]], [(q + arb(0, u)) / piece.k.h for q in x[3:]]
            parts.append(on_the_sphere(*piece.balls.turned(r, -1), *piece.balls.turned(v, -1)))
    return parts


def on_the_sphere(x: Any, y: Any, z: Any, vx: Any, vy: Any, vz: Any) -> list[Any]:
    """Return balls, or series of balls, of position and velocity over the length: z, vz also by |r| = 1, r·v = 0."""
    below = 1 - x * x - y * y
    if value(z) < 0 < value(below):
        z = met(z, -below.sqrt())
        vz = met(vz, -(x * vx + y * vy) / z)
    return [x, y, z, vx, vy, vz]


def value(x: Any) -> arb:
    """Return a ball, or the one that a series begins with."""
    return x[0] if isinstance(x, arb_series) else x


def met(x: Any, y: Any) -> Any:
    """Return what is in both of two balls, or of two series of two terms."""
    both = isinstance(x, arb_series)
    return arb_series([x[k].intersection(y[k]) for k in range(2)], 2) if both else x.intersection(y)


def spread(piece: Piece, begin: Fraction, end: Fraction) -> list[arb]:
    """Return balls of s that cover a time of a step."""
    low, high = ((time - piece.step.centre) / piece.step.h for time in (begin, end))
    count = 1 + (high - low) * PARTS // 1
    return [
        ball(hull(low + (high - low) * k / count, low + (high - low) * (k + 1) / count))
        for k in range(count)
    ]


def near(f: Any, s: arb) -> arb:
    """Return a ball that contains a polynomial on `s`, about the middle of this."""
    x: arb = f(s.mid()) + f.derivative()(s) * (s - s.mid())
    return x
