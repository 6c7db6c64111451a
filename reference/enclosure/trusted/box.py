"""TRUSTED. A box of inputs: what holds for every pendulum with inputs in it, by one radius (THEOREM.md, section 11).

The motion of each is turned, so that its c has the direction of the scene's, and its time is scaled, so that c has the
same size. What is left of the box is in Ω, γ and the release. A proof of a point imports none of this.

| name                        | symbol                                               | unit             |
|-----------------------------|------------------------------------------------------|------------------|
| `pace`                      | s: the scene's time is s times a pendulum's own      | 1                |
| `omega`, `drag`             | Ω, γ: balls that hold those of each pendulum         | 1/s; of a step 1 |
| `omega_0`, `drag_0`         | Ω₀, γ₀ of the scene                                  | 1/s; of a step 1 |
| `delta_omega`, `delta_drag` | |δΩ|, |δγ|                                           | 1                |
| `lean`, `theta_0`, `psi`    | β, θ₀, ψ                                             | radians          |
| `delta_p`, `delta_K`        | |Δp|, |ΔK| with each Ω                               | 1, 1/s           |
| `length`                    | l in `BoxBalls`; ℓ, the length of a step, in `grown` | m; 1             |
| `eta_start`, `eta`, `b`     | η(a), η, b                                           | 1                |
| `E`                         | E, a bound of η that η₁ has to confirm               | 1                |
| `two_w_mu_0`, `two_w_mu`    | 2 w μ for E = 0; 2 w μ                               | 1                |
"""

from copy import copy
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from typing import Any, NamedTuple

from flint import arb, arb_series, ctx

from .balls import SHORT, Vector, add, ball, demand, interval, size, times, total, upper
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
    if isinstance(low, tuple):
        return tuple(map(hull, low, high))
    return ball(low).union(ball(high))


class BoxBalls(SceneBalls):
    """The balls of a scene, with Ω, γ, length, pace and release as balls that hold those of every pendulum of a box.

    `own` are those of the scene alone. In the scene's time, and turned as the scene is (Lemma 11.1), c has one value.
    """

    def __init__(self, box: Box, prec: int) -> None:
        demand(min(box.low.drag, box.high.drag) >= 0, "the theorems take a drag >= 0")
        own = SceneBalls(box.inputs, prec)
        with ctx.workprec(prec):
            wide = {name: hull(low, getattr(box.high, name)) for name, low in vars(box.low).items()}
        # exact zeros are those of all pendulums; of the drag, a ball from 0 on reaches a little beyond
        super().__init__(replace(box.inputs, **wide | {"drag": box.low.drag}), prec)

        self.inputs = box.inputs
        self.claim = box
        self.wide = wide
        self.own = own
        with ctx.workprec(prec):
            # in m and m/s, without the length
            self.given = [ball(q) for q in wide["position"] or ()]
            self.c = own.c
            self.omega_0 = own.omega_0
            self.drag_0 = own.drag_0
            self.measure(wide)
            self.paces = interval(self.pace)
            self._bound_the_motion()

    def measure(self, wide: dict[str, Any]) -> None:
        """Take length, pace, axes, Ω, γ and the release from inputs that are balls, or series of balls (Lemma 11.1)."""
        _, c_m, c_w = self.c
        lean, pull = plumb(wide)
        self.length = ball(wide["length"])
        self.pace = (pull / self.length / (c_m * c_m + c_w * c_w).sqrt()).sqrt()  # (11.1a)

        theta_0 = arb.atan2(-c_w, c_m)
        psi = theta_0 - lean  # (11.1c)
        self.tilt = psi.sin_cos()
        latitude = ball(wide["latitude"]) * arb.pi() / 180
        sin, cos = (psi - latitude).sin_cos()
        self.omega = times(ball(wide["rotation_rate"]) / self.pace, [arb(0), sin, cos])  # (11.1d)
        self.drag = ball(wide["drag"]) / self.pace

        self.release = self._release(replace(self.inputs, **wide))
        position, velocity = self.release
        self.r = self.turned(position, 1)
        self.v = times(1 / self.pace, self.turned(velocity, 1))

    def varied(self, name: str, scale: arb) -> Any:
        """Return what `measure` takes of series: their first coefficients are derivatives to an input, scaled."""

        def series(x: Any) -> Any:
            return arb_series([ball(x), scale], 2)

        wide = dict(self.wide)
        kind = "position" if self.given else "angles"
        with ctx.workprec(self.prec):
            if name in RELEASES[kind]:
                release = zip(RELEASES[kind], wide[kind], strict=True)
                wide[kind] = tuple(series(x) if n == name else x for n, x in release)
            elif name == "inverse_flattening":
                wide["flattening"] = 1 / series(1 / ball(wide["flattening"]))
            else:
                wide[name] = series(wide[name])
            twin = copy(self)
            twin.measure(wide)
        return twin


def plumb(wide: dict[str, Any]) -> tuple[Any, Any]:
    """Return the angle β by which the plumb line leans, and the strength of the pull along it in m/s² (Lemma 11.1)."""
    gravity = ball(wide["gravity"])
    altitude = ball(wide["altitude"])
    rate = ball(wide["rotation_rate"])
    radius = ball(wide["equatorial_radius"])
    f = ball(wide["flattening"])

    # of twice the latitude, so that a ball of it stays narrow
    sin, cos = ball(wide["latitude"] / 90).sin_cos_pi()
    normal = radius / (1 - f * (2 - f) * (1 - cos) / 2).sqrt()
    push = rate * rate * (normal + altitude)
    if wide["gravity_is"] == "effective":
        push *= 0

    # (11.1b)
    aside = push * sin / 2
    down = gravity - push * (1 + cos) / 2
    lean: Any = arb.atan2(value(aside), value(down))
    tangent: Any = aside / down
    if isinstance(tangent, arb_series):
        # the derivative of atan2 is that of atan
        lean = arb_series([lean, tangent.atan()[1]], 2)
    return lean, (aside * aside + down * down).sqrt()


class Widened(NamedTuple):
    """What holds for every pendulum of a box: the sizes of a step, the jump at its start (Lemmas 11.2 and 11.3)."""

    sizes: Sizes
    jump: arb  # a bound of |Δp| + |ΔK|/w₀


class BoxRadius(Radius):
    """Theorem C for all inputs of a box."""

    balls: BoxBalls

    def widened(self, piece: Piece) -> Widened:
        """Return what holds for the box of the defects on a piece, and of the jump (Lemmas 11.2 and 11.3)."""
        jump = self.join(piece)
        constants = piece.constants
        with ctx.workprec(self.balls.prec):
            difference = add(constants.omega, times(-1, constants.omega_0))
            delta_omega = size(difference)
            delta_drag = upper(abs(constants.drag - constants.drag_0))
            omega_0 = size(constants.omega_0)

        norms = piece.norms
        sizes = piece.sizes
        with ctx.workprec(SHORT):
            P = sizes.p
            Omega = constants.omega_size
            p_rate = norms.p_rate

            # (11.2b) |p·δΩ| <= Σ |p_i||δΩ_i|
            along = arb(0)
            for f, x in zip(piece.p, difference, strict=True):
                along += total(f, piece.step.bits) * x.abs_upper()
            # (11.2a), of which sizes.d2 has P |d₀| + γ|Ω| T
            turned = (
                2 * along * p_rate
                + delta_omega * norms.tau_rate
                + P**2 * delta_omega * (Omega + omega_0)
            )
            D2 = upper(sizes.d2 + turned + delta_drag * P * p_rate)

            # (11.3a), in 1/s
            delta_p = size(jump.p)
            delta_K = size(jump.K) + 2 * delta_omega / constants.h * delta_p * (2 * P + delta_p)
            return Widened(
                sizes._replace(d2=D2),
                upper(delta_p + delta_K / self.balls.w0),
            )

    def advance(self, piece: Piece) -> Covered:
        """Carry the radius over a piece, with a bound of |e| that what follows has to confirm (Lemma 11.4)."""
        return self.grown(piece, self.widened(piece))

    def grown(self, piece: Piece, widened: Widened) -> Covered:
        """Carry the radius over a piece of the box (Lemma 11.4)."""
        constants = piece.constants
        sizes = widened.sizes
        with ctx.workprec(SHORT):
            c = constants.c_size
            Omega = constants.omega_size
            gamma = constants.drag_size
            w = constants.w
            S = constants.S
            P = sizes.p
            K = sizes.k
            lambda_minus = constants.lambda_minus
            lambda_plus = constants.lambda_plus
            length = ball(piece.step.high - piece.step.low)

            eta_start = self.eta + widened.jump  # (4.8)
            b = (c + K**2) * sizes.tau / (2 * w) + sizes.d2 / w + sizes.d1  # (4.4)
            driven = upper(eta_start + length * b)  # η(a) + ℓ b

            # E is twice what follows for E = 0
            two_w_mu_0 = lambda_minus.max(lambda_plus + S**2) + gamma * Omega * P
            E = upper(2 * driven * (length * two_w_mu_0 / (2 * w)).exp())

            # (11.4a)
            curvature = lambda_minus.max(lambda_plus + (S + (w + K) * E) ** 2)
            two_w_mu = curvature + (c + K**2) * E + gamma * Omega * P
            self.eta = upper(driven * (length * two_w_mu / (2 * w)).exp())  # (11.4b)
            demand(self.eta < E, "a bound has outgrown what it rests on")  # (11.4b)

            g_bound = (w + K) * self.eta  # (4.9)
            return Covered(piece, tube(constants, sizes, self.eta, g_bound))


class Windows:
    """Runs a course in the scene's time; gives states and zeros of all inputs of the box in their own time."""

    def __init__(self, box: Box, prec: int, until: list[Fraction], words: tuple[str, ...]) -> None:
        self.box = box
        self.balls = BoxBalls(box, prec)
        self.times = tuple(until)
        self.pace = self.balls.paces
        demand(
            self.pace.low > 0 and until[0] == 0,
            "a box is followed from its release on",
        )
        self.hulls = list[Vector]()  # of the states at each time so far, over the length
        self.done = 0  # times whose hulls are complete

        latest = self.pace.high * until[-1]
        self.course = Course(self.balls, [latest], False, words, second_order=True)
        self.course.bound = BoxRadius(self.balls)
        self.course.followers.append(self)

    def advance(self, covered: Covered) -> None:
        """Take the next tube: at each output time some pendulums of the box may be in it."""
        demand(not self.course.open, "a tube comes from the course alone, while it takes a step")
        piece = covered.piece
        for n in range(self.done, len(self.times)):
            low = self.pace.low * self.times[n]
            high = self.pace.high * self.times[n]
            if low > piece.end:
                break
            states = between(covered, max(low, piece.begin), min(high, piece.end))
            if n < len(self.hulls):
                states = [self.hulls[n], *states]
            self.hulls[n : n + 1] = [
                [reduce(arb.union, column) for column in zip(*states, strict=True)]
            ]
            if high <= piece.end:
                self.done += 1

    def finish(self) -> ProvedBox:
        """Return what is proved, in the time of each pendulum, to which it was `pace` times that of the course."""
        proved = self.course.finish()
        demand(self.done == len(self.times), "the steps do not end with the run")
        balls = self.balls
        with ctx.workprec(balls.prec):
            states = [
                [*times(balls.length, x[:3]), *times(balls.length * balls.pace, x[3:])]
                for x in self.hulls
            ]
            states[0] = self._released()
            intervals = tuple(tuple(map(interval, x)) for x in states)
            zeros = {word: self._in_own_time(found) for word, found in proved.zeros.items()}
        result = ProvedBox(self.box, self.times, intervals, zeros, proved.still)
        FINISHED.add(result)
        return result

    def _released(self) -> Vector:
        """Return the state at the release in m and m/s; what is given of it as it is given."""
        position, velocity = self.balls.release
        x, y, z, vx, vy, vz = (q * self.balls.length for q in (*position, *velocity))
        if self.balls.given:
            x, y, vx, vy = self.balls.given
        return [x, y, z, vx, vy, vz]

    def _in_own_time(self, zeros: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return zeros in the time of each pendulum: those that may come up to the end (Lemma 11.1)."""
        pace = self.balls.pace
        factors = {"t": 1 / pace, "vx": pace, "vy": pace, "vz": pace, "ax": pace**2}
        result = list[Any]()
        for zero in zeros:
            own = {}
            for name, factor in factors.items():
                x = getattr(zero, name, None)
                if x:
                    own[name] = interval(hull(x.low, x.high) * factor)
            result.append(replace(zero, **own))

        # those that may come are the first ones, so that others can be paired with them by number
        may_come = [zero.t.low <= self.times[-1] for zero in result]
        count = sum(may_come)
        demand(all(may_come[:count]), "zeros must be in order")
        return tuple(result[:count])


def between(covered: Covered, begin: Fraction, end: Fraction) -> list[Vector]:
    """Return balls of position and velocity that cover them from one time to another of a step, over the length."""
    piece = covered.piece
    balls = piece.balls
    states = list[Vector]()
    with ctx.workprec(balls.prec):
        eta = arb(0, covered.tube.eta)
        U = arb(0, covered.tube.u)
        for s in spread(piece, begin, end):
            r = [near(f, s) / piece.unit + eta for f in piece.p]
            v = [(near(f, s) / piece.unit + U) / piece.constants.h for f in piece.v]
            states.append(on_the_sphere(*balls.turned(r, -1), *balls.turned(v, -1)))
    return states


def on_the_sphere(x: Any, y: Any, z: Any, vx: Any, vy: Any, vz: Any) -> list[Any]:
    """Return balls, or series of balls, of position and velocity over the length: z, vz also by |r| = 1, r·v = 0."""
    below = 1 - x * x - y * y
    if value(z) < 0 < value(below):
        z = met(z, -below.sqrt())  # (11.6)
        vz = met(vz, -(x * vx + y * vy) / z)  # (11.7)
    return [x, y, z, vx, vy, vz]


def value(x: Any) -> arb:
    """Return a ball, or the one that a series begins with."""
    return x[0] if isinstance(x, arb_series) else x


def met(x: Any, y: Any) -> Any:
    """Return what is in both of two balls, or of two series of two terms."""
    if isinstance(x, arb_series):
        return arb_series([x[k].intersection(y[k]) for k in range(2)], 2)
    return x.intersection(y)


def spread(piece: Piece, begin: Fraction, end: Fraction) -> list[arb]:
    """Return balls of s that cover a time of a step, in equal parts no longer than 1/PARTS."""
    low = (begin - piece.step.centre) / piece.step.h
    high = (end - piece.step.centre) / piece.step.h
    count = 1 + (high - low) * PARTS // 1
    part = (high - low) / count
    return [ball(hull(low + part * k, low + part * (k + 1))) for k in range(count)]


def near(f: Any, s: arb) -> arb:
    """Return a ball that contains a polynomial on `s`, about the middle of this."""
    x: arb = f(s.mid()) + f.derivative()(s) * (s - s.mid())  # (11.5)
    return x
