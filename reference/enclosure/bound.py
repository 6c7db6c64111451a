"""TRUSTED. Sections 1 to 7 of THEOREM.md: scene in balls, defect of a step, one radius carried along (Theorem C).

Time on a step is s = (t - centre)/h; h Ω, h² c, h γ, h H are written Ω, c, γ, H. A name of a size is an upper bound.
"""

from fractions import Fraction
from functools import lru_cache
from typing import Any

from flint import arb, arb_poly, ctx, fmpq, fmpz, fmpz_poly

from .balls import SHORT, Vector, add, ball, cross, dot, fixed, interval, norm3, size, times, upper
from .shapes import Interval, Sizes, Step, Tube


class World:
    """The scene at `prec` bits, from its exact inputs alone; what is exactly 0 stays so."""

    def __init__(self, inputs: Any, prec: int) -> None:
        if inputs.drag < 0 or inputs.length <= 0:
            raise ArithmeticError("not a pendulum: the theorems take a length > 0 and a drag >= 0")
        self.prec = prec
        with ctx.workprec(prec):
            turn = fmpq(inputs.latitude.numerator, inputs.latitude.denominator) / 180
            sin, cos, rate = arb.sin_pi_fmpq(turn), arb.cos_pi_fmpq(turn), ball(inputs.rotation_rate)
            f, self.length, self.drag = ball(inputs.flattening), ball(inputs.length), ball(inputs.drag)
            normal = ball(inputs.equatorial_radius) / (1 - f * (2 - f) * sin * sin).sqrt()
            pull = rate * rate * (normal + ball(inputs.altitude)) * cos  # centrifugal, at the pivot
            self.omega = [arb(0), rate * cos, rate * sin]
            self.c = [arb(0), -sin * pull / self.length, (cos * pull - ball(inputs.gravity)) / self.length]
            self.r, self.v = self._release(inputs)
            self.H = cross(self.r, add(self.v, cross(self.omega, self.r)))
            x, y, vx = (q.is_zero() for q in (self.r[0], self.r[1], self.v[0]))
            at_rest, straight = all(q.is_zero() for q in self.v), (sin * cos).is_zero() or rate.is_zero()
            self.slow, self.flat = vx, at_rest and x  # xdot(0) = 0 exactly; and xddot(0) = 0
            self.still = (vx and x and rate.is_zero()) or (at_rest and x and y and straight)  # xdot = 0 for ever
            c, w = size(self.c), size(self.omega)
            self.w0 = c.sqrt().mid() if c > 0 else arb(1)  # any positive number is a valid weight
            energy = dot(self.H, self.H) / 2 - dot(self.omega, self.H) - dot(self.c, self.r)
            self.speed = upper(w + upper(w**2 + 2 * (energy + c)).sqrt())  # |H| at any time
            self.below, self.above = upper(self.w0**2 + w**2 / 2 + energy), upper(c - self.w0**2)  # -+ (c·r - w0²)

    def _release(self, inputs: Any) -> tuple[Vector, Vector]:
        if inputs.position:
            x, y, vx, vy = (ball(q) / self.length for q in inputs.position)
            z = -(1 - x * x - y * y).sqrt()
            return [x, y, z], [vx, vy, -(x * vx + y * vy) / z]
        turns = [fmpq(q.numerator, q.denominator) / 180 for q in inputs.angles]
        (s, sa), (c, ca) = map(arb.sin_pi_fmpq, turns[:2]), map(arb.cos_pi_fmpq, turns[:2])
        da, db = (arb(q) * arb.pi() for q in turns[2:])
        return [s * ca, s * sa, -c], [c * ca * da - s * sa * db, c * sa * da + s * ca * db, s * da]


class Scaled:
    """Constants in the time of a step: balls; integers over 2^bits and how far they are off; sizes."""

    def __init__(self, world: World, h: Fraction, bits: int) -> None:
        with ctx.workprec(world.prec):
            self.h, self.w = ball(h), world.w0 * ball(h)
            self.c, self.omega, self.drag = times(self.h**2, world.c), times(self.h, world.omega), self.h * world.drag
            (self.ci, self.c_off), (self.wi, self.omega_off) = fixed(self.c, bits), fixed(self.omega, bits)
            self.gi, self.drag_off = fixed([self.drag, *times(self.drag, self.omega)], bits)
            self.c_size, self.omega_size, self.drag_size = size(self.c), size(self.omega), upper(self.drag)
            self.speed, self.below, self.above = world.speed * self.h, world.below * self.h**2, world.above * self.h**2

    def torque(self, p: Vector, K: Vector) -> Vector:
        """The torque p × c + K × Ω, in integers."""
        return add(cross(p, self.ci), cross(K, self.wi))


scaled = lru_cache(maxsize=16)(Scaled)  # steps of the same length follow each other


class Piece:
    """A step with its polynomials."""

    def __init__(self, world: World, step: Step) -> None:
        if not -1 <= step.low < step.high <= 1 or step.h <= 0:
            raise ArithmeticError("a step must lie in -1 <= s <= 1, where its sizes hold")
        self.world, self.step, self.k = world, step, scaled(world, step.h, step.bits)
        self.polys, self.unit = [fmpz_poly(c) for c in step.coefficients], fmpz(1) << step.bits
        self.begin, self.end = step.centre + step.h * step.low, step.centre + step.h * step.high

    def values(self, s: Any) -> Vector:
        """Balls of p(s), K(s)."""
        return [arb_poly(f)(ball(s) if isinstance(s, Fraction) else s) / self.unit for f in self.polys]

    def sizes(self) -> Sizes:
        """The defect, in integers but for the radii of the constants (section 6)."""
        k, p, K, unit, bits = self.k, self.polys[:3], self.polys[3:], self.unit, self.step.bits
        order, scale = max(f.length() for f in self.polys), 2 * bits
        d1 = [f.derivative() * unit - t for f, t in zip(p, cross(add(K, times(-1, k.wi)), p), strict=True)]
        d2 = [f.derivative() * unit - t for f, t in zip(K, k.torque(p, K), strict=True)]
        if any(k.gi):
            along, drag = dot(k.gi[1:], p), add(times(k.gi[0], K), times(-unit, k.gi[1:]))
            d2, scale = add(times(unit, add(d2, drag)), times(along, p)), 3 * bits
        with ctx.workprec(SHORT):
            size_p, size_k = norm3(p, bits), norm3(K, bits)
            first = upper(norm3(d1, 2 * bits) + k.omega_off * size_p)
            off = k.c_off * size_p + k.omega_off * size_k + k.drag_off * (size_k + 1 + size_p**2)
            return Sizes(first, upper(norm3(d2, scale) + off), size_p, size_k, upper(2 * order * first))


def growth(k: Scaled, size_p: arb) -> arb:
    """The rate ν of Theorem N."""
    return (k.c_size + k.w**2 + k.drag_size * k.omega_size * (1 + size_p)) / (2 * k.w)


def tube(k: Scaled, d: Sizes, eta: arb, gamma: arb) -> Tube:
    """From |e| <= eta and |g| <= gamma to velocity and acceleration (section 7)."""
    turn, gw = d.k + k.omega_size, k.drag_size * k.omega_size
    u = gamma + turn * eta + d.d1
    torque = k.c_size * eta + k.omega_size * gamma + k.drag_size * gamma + gw * (1 + d.p) * eta + d.d2
    rate = d.p * k.c_size + d.k * k.omega_size + k.drag_size * d.k + gw * (1 + d.p**2) + d.d2
    a = torque + rate * eta + gamma * (turn * d.p + d.d1 + u) + turn * u + d.d1_rate
    return Tube(upper(eta), upper(gamma), upper(u), upper(a))


class Carried:
    """What goes from step to step: the time reached and the candidate's end, H in 1/s."""

    def __init__(self, world: World) -> None:
        self.world, self.time, self.last = world, Fraction(0), [*world.r, *world.H]

    def join(self, piece: Piece) -> tuple[Vector, Vector]:
        """Values at the start of `piece`, and how far each is from the end of the step before."""
        if piece.begin != self.time:
            raise ArithmeticError("steps must join")
        ends = map(piece.values, (piece.step.low, piece.step.high))
        here, end = ([*x[:3], *times(1 / piece.k.h, x[3:])] for x in ends)
        jump = [(a - b).abs_upper() for a, b in zip(here, self.last, strict=True)]
        self.time, self.last = piece.end, end
        return here, jump


class Radius(Carried):
    """Theorem C: one number, |e|² + |g⊥|²/w² <= eta²."""

    eta = arb(0)

    def advance(self, piece: Piece, d: Sizes) -> Tube:
        """Carry the bound over `piece`, whose sizes are `d`."""
        with ctx.workprec(self.world.prec):
            k, (here, jump) = piece.k, self.join(piece)
            tau, kappa = (dot(here, here) - 1).abs_upper(), (dot(here, here[3:]) * k.h).abs_upper()
        with ctx.workprec(SHORT):
            span, gw, ck = ball(piece.step.high - piece.step.low), k.drag_size * k.omega_size, k.c_size + d.k**2
            start, source = upper(self.eta + size(jump[:3]) + size(jump[3:]) / self.world.w0), d.d2 / k.w + d.d1
            tau = tau + 2 * span * d.p * d.d1
            most = kappa + span * (d.p * d.d2 + d.k * d.d1 + gw * d.p * tau)
            # Theorem N: |e| <= far
            far = upper(((1 + d.k / k.w) * start + kappa / k.w + span * source) * (span * growth(k, d.p)).exp())
            rate = (k.below.max(k.above + (k.speed + k.w * far) ** 2) + ck * far + gw * d.p) / (2 * k.w)
            self.eta = upper((start + span * ((ck * tau / 2 + most * d.k) / k.w + source)) * (span * rate).exp())
            return tube(k, d, self.eta, k.w * self.eta + most + d.k * self.eta)


def state(piece: Piece, t: Tube, s: Any) -> tuple[Vector, Vector]:
    """Balls that contain the true r and H at `s`."""
    x = piece.values(s)
    return [a + arb(0, t.eta) for a in x[:3]], [a + arb(0, t.gamma) for a in x[3:]]


def motion(k: Scaled, r: Vector, H: Vector) -> tuple[Vector, Vector, Vector]:
    """The true first three derivatives of r, in scaled time, from r and H (section 7)."""
    turn, along, g = add(H, times(-1, k.omega)), dot(k.omega, r), -k.drag
    v = cross(turn, r)
    H1 = add(cross(r, k.c), cross(H, k.omega), times(g, turn), times(g * along, r))
    a = add(cross(H1, r), cross(turn, v))
    H2 = add(cross(v, k.c), cross(H1, k.omega), times(g, H1), times(g * dot(k.omega, v), r), times(g * along, v))
    return v, a, add(cross(H2, r), times(2, cross(H1, v)), cross(turn, a))


def output(world: World, piece: Piece, t: Tube, time: Fraction) -> list[Interval]:
    """Position and velocity at an output time in m and m/s; at 0 those of the release itself."""
    with ctx.workprec(world.prec):
        if not piece.begin <= time <= piece.end:
            raise ArithmeticError("the tube holds on its own step only")
        r, H = state(piece, t, (time - piece.step.centre) / piece.step.h)
        v = times(1 / piece.k.h, motion(piece.k, r, H)[0])
        return [interval(x * world.length) for x in ([*r, *v] if time else [*world.r, *world.v])]
