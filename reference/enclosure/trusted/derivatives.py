"""TRUSTED. Derivatives to inputs, for every pendulum of a box, and what follows from them (THEOREM.md, section 12).

A derivative is scaled by a power of two, its `scale`, so that proposals are of the size of 1.
"""

from bisect import bisect_left, bisect_right
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from itertools import pairwise
from typing import Any

from flint import arb, arb_poly, arb_series, ctx, fmpz, fmpz_poly

from .balls import SHORT, UNIT, Vector, add, ball, cross, demand, dot, interval, size, times, upper
from .box import BoxBalls, BoxRadius, Widened, Windows, near, on_the_sphere, spread
from .course import FINISHED, scan_of
from .defect import Piece
from .printed_box import end_of
from .radius import Radius
from .shapes import (
    XDOT,
    Covered,
    EnclosedZero,
    Interval,
    Led,
    ProvedDerivatives,
    State,
    Tangent,
)
from .six_columns import cut
from .tube import output, tube
from .zeros import Scan

TINY = arb(2) ** -4096  # more than nothing
TERMS = 32  # of p and K in the residuals, which are compared with proposals in doubles


class Way:
    """The derivative to one input: at the release, of Ω and of γ; then where proposals have led it, with its radius."""

    def __init__(self, balls: BoxBalls, name: str, half: Fraction, scale: int) -> None:
        self.scale, self.error = arb((fmpz(1), fmpz(scale))), arb(0)
        self.half, self.twin = (
            ball(half) / self.scale,
            balls.varied(name.partition(".")[2], self.scale),
        )
        with ctx.workprec(balls.prec):
            momentum = cross(self.twin.r, add(self.twin.v, cross(self.twin.omega, self.twin.r)))
            self.last = [first(x) for x in (*self.twin.r, *momentum)]
            self.turn, self.slow = [first(x) for x in self.twin.omega], first(self.twin.drag)


def first(x: Any) -> arb:
    """Return the first coefficient of a series; 0 of a ball, which does not depend on the input."""
    return x[1] if isinstance(x, arb_series) else arb(0)


class Tangents(BoxRadius):
    """Lemmas 12.2 and 12.4 for all inputs of a box, and Theorem C for the scene's own: they bound all motions."""

    def __init__(
        self, balls: BoxBalls, halves: dict[str, Fraction], scales: dict[str, int]
    ) -> None:
        super().__init__(balls)
        texts = {name: str(half) for name, half in halves.items()}
        ends = [end_of(balls.inputs, texts, side) for side in (-1, 1)]
        demand(ends == [balls.claim.low, balls.claim.high], "a width is missing, or another one")
        self.ways = [Way(balls, name, half, scales[name]) for name, half in halves.items()]
        self.point, self.scene = Radius(balls.own), list[Covered]()
        self.plain: BoxRadius | None = BoxRadius(balls)

    def advance(self, piece: Piece, proposal: list[Any]) -> Covered:  # type: ignore[override]
        """Carry all over a step: `proposal` has six polynomials of integers, and the bits of their unit, per input."""
        whole, own, widened = piece, Piece(self.balls.own, piece.step), self.widened(piece)
        d = widened.sizes
        self.scene, sizes, polynomials = [self.point.advance(own)], list[list[arb]](), list[Any]()
        with ctx.workprec(2 * SHORT):
            omega = times(piece.constants.h, self.balls.omega_0)
            p, v = (
                [cut(arb_poly(f) * (1 / arb(piece.unit)), TERMS) for f in part]
                for part in (piece.p, piece.v)
            )
            K = [cut(f, TERMS) for f in cross(p, add(v, cross(omega, p)))]
            for way, (rows, bits) in zip(self.ways, proposal, strict=True):
                f, unit, inverse = (
                    [fmpz_poly(row) for row in rows],
                    fmpz(1) << bits,
                    1 / piece.constants.h,
                )
                start, end = (
                    [g(ball(s)) / unit for g in f] for s in (piece.step.low, piece.step.high)
                )
                start, end = ([*x[:3], *times(inverse, x[3:])] for x in (start, end))
                jump = [(a - b).abs_upper() for a, b in zip(start, way.last, strict=True)]
                way.error, way.last = (
                    way.error + size(jump[:3]) + size(jump[3:]) / self.balls.w0,
                    end,
                )
                with ctx.workprec(SHORT):
                    sizes.append(
                        residuals(
                            whole, omega, p, K, way, [arb_poly(g) * (1 / arb(unit)) for g in f]
                        )
                    )
                polynomials.append((f[:3], unit))
        with ctx.workprec(SHORT):
            k, near_by = whole.constants, self.scene[0].tube.eta
            off, around = size(add(k.omega, times(-1, omega))), (own.constants.w + d.k) * near_by

            def bounds(e: arb, g: arb) -> tuple[arb, arb, list[list[arb]]]:
                found = [
                    carried(self.balls, whole, way, part, e, g)
                    for way, part in zip(self.ways, sizes, strict=True)
                ]
                parts = list(zip(self.ways, sizes, found, strict=True))
                far = sum((way.half * (x[0] + y[0]) for way, x, y in parts), near_by)
                fast = sum((way.half * (x[1] + y[1]) for way, x, y in parts), around)
                return upper(far), upper(fast), found

            sure = self.by_radius(whole, widened, off)
            e, g = (
                upper(2 * x + TINY).min(y)
                for x, y in zip(bounds(arb(0), arb(0))[:2], sure, strict=True)
            )
            eta, gamma, found = bounds(e, g)
            holds = (eta < e or e == sure[0]) and (gamma < g or g == sure[1])
            demand(holds, "a bound has outgrown what it rests on")
            self.eta, gamma = eta.min(sure[0]), gamma.min(sure[1])
            for way, part in zip(self.ways, found, strict=True):
                way.error = part[0]
            self.tangents = [
                Tangent(f, unit, x[0], x[2])
                for (f, unit), x in zip(polynomials, found, strict=True)
            ]
            return Covered(whole, tube(k, d, self.eta, gamma + d.p**2 * off))

    def by_radius(self, whole: Piece, widened: Widened, off: arb) -> Vector:
        """Return Theorem C's bounds of |r - p| and |H - K| for the box: no bounds from where they fail on."""
        try:
            eta = self.plain.grown(whole, widened).tube.eta if self.plain else arb("inf")
        except ArithmeticError:
            self.plain, eta = None, arb("inf")
        return [
            eta,
            ((whole.constants.w + widened.sizes.k) * eta + widened.sizes.p**2 * off).upper(),
        ]


def residuals(piece: Any, omega: Vector, p: Vector, K: Vector, way: Way, W: Vector) -> list[arb]:
    """Return |P|, |Q|, |R1|, |R2|, |p·P|, |K·P + p·Q| of polynomials (P, Q) for ρ and χ, with the scene's Ω and γ."""
    k, P, Q, rates = piece.constants, W[:3], W[3:], [f.derivative() for f in W]
    turn, slow, lean = times(k.h, way.turn), k.h * way.slow, add(K, times(-1, omega))
    r1 = add(rates[:3], cross(p, Q), cross(P, lean), cross(turn, p))
    r2 = add(rates[3:], cross(k.c, P), cross(omega, Q), cross(turn, K))
    if not k.drag_0.is_zero():
        along = times(dot(turn, p) + dot(omega, P), p)
        r2 = add(r2, times(k.drag_0, add(Q, times(-1, turn), along, times(dot(omega, p), P))))
    if not slow.is_zero():
        r2 = add(r2, times(slow, add(lean, times(dot(omega, p), p))))
    vectors = [P, Q, r1, r2, [dot(p, P)], [dot(K, P) + dot(p, Q)]]
    return [size([f(UNIT) for f in part]) for part in vectors]


def carried(balls: BoxBalls, piece: Piece, way: Way, sizes: list[arb], e: arb, g: arb) -> list[arb]:
    """Return bounds of |ρ - P|, |χ - Q|, |ρ' - P'| on a step, where |r - p| <= e and |H - K| <= g (Lemma 12.2)."""
    k, d, (P, Q, r1, r2, along, across) = piece.constants, piece.sizes, sizes
    w, span, omega = k.w, ball(piece.step.high - piece.step.low), times(k.h, balls.omega_0)
    turn, slow = size(times(k.h, way.turn)), upper(abs(k.h * way.slow))
    off, gap = size(add(k.omega, times(-1, omega))), upper(abs(k.drag - k.drag_0))
    W = k.omega_size.max(size(omega))
    s1 = (Q + turn) * e + (g + off) * P
    s2 = Q * off + g * turn + gap * (Q + turn * (1 + d.p**2) + 2 * W * d.p * P)
    s2 += k.drag_size * (turn * e * (1 + d.p) + 2 * P * (off + W * e)) + slow * (
        g + 2 * off + W * e * (1 + d.p)
    )
    aside, tilt = along + e * P, across + g * P + e * Q
    source = s1 + r1 + (s2 + r2 + aside * k.c_size + tilt * k.S) / w
    rate = k.lambda_minus.max(k.lambda_plus + k.S**2) + k.drag_size * k.omega_size
    error = upper((way.error + span * source) * (span * rate / (2 * w)).exp())
    momentum = upper((w + k.S) * error + tilt)
    return [error, momentum, upper(momentum + (k.S + k.omega_size) * error + s1 + r1)]


class Watched:
    """A scan of a box, the same of the scene alone, and steps since its cluster began; derivatives of its zeros."""

    def __init__(self, scan: Scan, own: Scan, apsis: bool) -> None:
        self.scan, self.own, self.apsis = scan, own, apsis
        self.kept, self.zeros = list[tuple[Covered, list[Tangent]]](), list[list[Vector]]()

    def advance(
        self, covered: Covered, tangents: list[Tangent], scene: Covered, ways: list[Way]
    ) -> None:
        """Take the next step."""
        self.kept.append((covered, tangents))
        self.close(ways)
        self.own.advance(scene)
        self.kept = self.kept if self.scan.cluster else []

    def close(self, ways: list[Way]) -> None:
        """Take the derivatives of the zeros that were found since."""
        for z in self.scan.found[len(self.zeros) :]:
            self.zeros.append(self.of_zero(z, ways) if z.parity == "one" else [])

    def of_zero(self, z: EnclosedZero, ways: list[Way]) -> list[Vector]:
        """Return the derivatives of a zero's time and of its azimuth, in degrees, over all times that it may have."""
        begun, ended = self.kept[0][0].piece.begin, self.kept[-1][0].piece.end
        # it lies in leaves of steps that are kept, whatever rounding adds to its interval
        demand(z.t.low < ended and begun < z.t.high, "a zero is not covered")
        found: list[list[Vector]] = [[] for _ in ways]
        for covered, tangents in self.kept:
            begin, end = max(z.t.low, covered.piece.begin), min(z.t.high, covered.piece.end)
            for s in spread(covered.piece, begin, end) if begin <= end else ():
                own = motion(covered, s)
                for way, tangent, parts in zip(ways, tangents, found, strict=True):
                    parts.append(late_and_turned(covered, own, tangent, way, s, self.apsis))
        return [[reduce(arb.union, x) for x in zip(*parts, strict=True)] for parts in found]

    def centre(self, z: Any) -> Any:
        """Return the scene's own zero in the interval of a single one of the box, where each has one; or None."""
        found = self.own.found
        first = bisect_left(found, z.t.low, key=lambda y: y.t.high)
        near = found[first : bisect_right(found, z.t.high, key=lambda y: y.t.low)]
        return near[0] if len(near) == 1 and near[0].parity == "one" else None


class Derivatives:
    """Follows a box's windows: derivatives of states at their times; of transits, highest and lowest points."""

    def __init__(
        self, windows: Windows, halves: dict[str, Fraction], scales: dict[str, int]
    ) -> None:
        self.windows, self.balls, self.course, self.names = (
            windows,
            windows.balls,
            windows.course,
            tuple(halves),
        )
        self.bound = self.course.bound = Tangents(self.balls, halves, scales)
        self.done, self.hulls, self.states, self.watched = (
            0,
            list[list[Vector]](),
            list[State](),
            dict[str, Watched](),
        )
        for word, scan in self.course.scans.items():
            # these in axes in which the plumb line is the same for all
            if word in (XDOT, "highest", "lowest"):
                own = scan_of(self.balls.own, word, second_order=True)
                self.watched[word] = Watched(scan, own, word != XDOT)
        self.course.followers.append(self)

    def advance(self, covered: Covered) -> None:
        """Take the next step: what it may hold of output times, and the zeros that are closed with it."""
        demand(not self.course.open, "a tube comes from the course alone, while it takes a step")
        (scene,), windows, tangents = self.bound.scene, self.windows, self.bound.tangents
        for n in range(self.done, len(windows.times)):
            time = windows.times[n]
            low, high = windows.pace.low * time, windows.pace.high * time
            if low > covered.piece.end:
                break
            parts = spread(
                covered.piece, max(low, covered.piece.begin), min(high, covered.piece.end)
            )
            motions = [(s, motion(covered, s)) for s in parts]
            rows = [
                [values(covered, own, tangent, way, s, ball(time)) for s, own in motions]
                for tangent, way in zip(tangents, self.bound.ways, strict=True)
            ]
            before = self.hulls[n] if n < len(self.hulls) else [[] for _ in rows]
            together = [[x, *row] if x else row for x, row in zip(before, rows, strict=True)]
            self.hulls[n : n + 1] = [
                [[reduce(arb.union, x) for x in zip(*row, strict=True)] for row in together]
            ]
            self.done += high <= covered.piece.end
        while (
            len(self.states) < len(windows.times)
            and windows.times[len(self.states)] <= scene.piece.end
        ):
            self.states.append(output(scene, windows.times[len(self.states)]))
        for watched in self.watched.values():
            watched.advance(covered, tangents, scene, self.bound.ways)

    def finish(self) -> ProvedDerivatives:
        """Return what is proved, with states and zeros that are as narrow as the derivatives make them."""
        proved, ways = self.windows.finish(), self.bound.ways
        demand(
            self.done == len(self.states) == len(self.windows.times),
            "the steps do not end with the run",
        )
        with ctx.workprec(self.balls.prec):
            states = tuple(
                tuple(
                    within(x, y, ways, [row[i] for row in rows])
                    for i, (x, y) in enumerate(zip(wide, own, strict=True))
                )
                for wide, own, rows in zip(proved.states, self.states, self.hulls, strict=True)
            )
            made = {word: self.narrowed(word, proved.zeros[word]) for word in self.watched}
        derivatives = tuple(tuple(tuple(map(interval, row)) for row in rows) for rows in self.hulls)
        narrow = replace(
            proved,
            states=states,
            zeros=proved.zeros | {word: zeros for word, (zeros, _) in made.items()},
        )
        FINISHED.add(narrow)
        led = {word: rows for word, (_, rows) in made.items()}
        FINISHED.add(result := ProvedDerivatives(narrow, self.names, derivatives, led))
        return result

    def narrowed(self, word: str, proved: Any) -> tuple[Any, tuple[Led, ...]]:
        """Return the zeros of a scan as narrow as derivatives make their times, and these; in each pendulum's time."""
        watched, zeros, led = self.watched[word], list[Any](), list[Led]()
        watched.close(self.bound.ways)
        own_zeros = pairwise(watched.own.finish())
        demand(
            all(a.t.low <= b.t.low and a.t.high <= b.t.high for a, b in own_zeros),
            "zeros must be in order",
        )
        for z, q, row in zip(proved, watched.scan.found, watched.zeros, strict=False):
            known = row if all(x.is_finite() for parts in row for x in parts) else []
            # in the scene's own clock, which is that of the course
            own = watched.centre(q) if known else None
            zeros.append(
                replace(z, t=within(z.t, own.t, self.bound.ways, [x[0] for x in row])) if own else z
            )
            led.append(
                Led(own, *(tuple(map(interval, column)) for column in zip(*known, strict=True)))
            )
        return tuple(zeros), tuple(led)


def within(wide: Interval, own: Interval, ways: list[Way], derivatives: Vector) -> Interval:
    """Return where a number is for all inputs: near the scene's own, as far as its derivatives reach; and in `wide`."""
    far = sum(
        (way.half * way.scale * x.abs_upper() for way, x in zip(ways, derivatives, strict=True)),
        arb(0),
    )
    if not far.is_finite():
        return wide
    reach = interval(far).high
    low = max(wide.low, own.low - reach)
    high = min(wide.high, own.high + reach)
    demand(low <= high, "two bounds of one number contradict each other")
    return Interval(low, high)


def motion(covered: Covered, s: arb) -> list[Vector]:
    """Return balls of r, r', r'' at `s`."""
    (piece, (eta, u, a)), h = covered, covered.piece.constants.h
    with ctx.workprec(piece.balls.prec):
        forms = zip(
            (piece.p, piece.v, [g.derivative() for g in piece.v]),
            (eta, u, a),
            (1, h, h**2),
            strict=True,
        )
        return [
            [(near(f, s) / piece.unit + arb(0, radius)) / power for f in part]
            for part, radius, power in forms
        ]


def change(covered: Covered, tangent: Tangent, s: arb) -> list[Vector]:
    """Return balls of ρ, ρ' at `s`."""
    h, rates = covered.piece.constants.h, [g.derivative() for g in tangent.rows]
    rho, rate = ([near(f, s) / tangent.unit for f in part] for part in (tangent.rows, rates))
    return [
        [q + arb(0, tangent.error) for q in rho],
        [(q + arb(0, tangent.rate)) / h for q in rate],
    ]


def late_and_turned(
    covered: Covered, own: list[Vector], tangent: Tangent, way: Way, s: arb, apsis: bool
) -> Vector:
    """Return the derivatives of time and azimuth of a zero at `s`: of r·r' across the plumb line, or of xdot (12.5)."""
    piece, (_, m, w) = covered.piece, covered.piece.balls.c
    with ctx.workprec(piece.balls.prec):
        north = times(1 / (m * m + w * w).sqrt(), [arb(0), -w, m])
        both = own + change(covered, tangent, s)
        (x, y), (vx, vy), (ax, ay), (dx, dy), (ux, uy) = ([q[0], dot(q, north)] for q in both)
        late = (
            -(dx * vx + dy * vy + x * ux + y * uy) / (vx**2 + vy**2 + x * ax + y * ay)
            if apsis
            else -ux / ax
        )
        turned = (x * dy - y * dx + late * (x * vy - y * vx)) / (x**2 + y**2) * 180 / arb.pi()
        time = first(
            arb_series([ball(piece.step.centre) + s * piece.constants.h, late], 2) / way.twin.pace
        )
        return [x / way.scale for x in ((time, turned) if apsis else (time,))]


def values(
    covered: Covered, own: list[Vector], tangent: Tangent, way: Way, s: arb, time: arb
) -> Vector:
    """Return balls of the derivatives of position and velocity, in m and m/s, at the pendulum's own time (12.3)."""
    with ctx.workprec(covered.piece.balls.prec):
        (r, v, a), (rho, rate), twin = own, change(covered, tangent, s), way.twin
        later = first(twin.pace) * time
        R = [arb_series([y, z * later + u], 2) for y, z, u in zip(r, v, rho, strict=True)]
        V = [arb_series([y, z * later + u], 2) for y, z, u in zip(v, a, rate, strict=True)]
        moving = on_the_sphere(*twin.turned(R, -1), *twin.turned(V, -1))
        moving = [*times(twin.length, moving[:3]), *times(twin.length * twin.pace, moving[3:])]
        return [first(q) / way.scale for q in moving]
