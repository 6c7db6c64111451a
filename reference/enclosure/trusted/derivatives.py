"""TRUSTED. Derivatives of the motion to inputs, for every pendulum of a box (THEOREM.md, section 12).

Time on a step is s = (t - centre)/h; Ω, γ, H and χ are scaled with it, as in section 1. A derivative
to an input q is computed as that to q / 2^n, so that proposals are of the size of 1. The input over
2^n is called the scaled input here, and x, the variable of series, is added to it.

| name             | symbol                              | unit                                 |
|------------------|-------------------------------------|--------------------------------------|
| `omega_q`        | Ω_q = ∂Ω/∂q                         | 1/s per scaled input                 |
| `drag_q`         | γ_q = ∂γ/∂q                         | 1/s per scaled input                 |
| `P`, `Q`         | P and Q, near ρ and χ = ∂(r, H)/∂q  | per scaled input; Q in a step's time |
| `epsilon`        | ε                                   | per scaled input                     |
| `half_width`     | δ_j                                 | scaled input                         |
| `omega_0`, `K_0` | Ω₀ and K₀, those of the scene       | a step's time                        |
| `Distance`       | bounds of |r - p| and |H - K₀|      | 1, and a step's time                 |
| `assumed`        | E and G                             | likewise                             |
| `Reached`        | E₁ and G₁                           | likewise                             |
| `of_scene`       | η₀ and G₀                           | likewise                             |
| `theorem_c`      | η_C and what (12.4e) makes of it    | likewise                             |
| `length`           | ℓ, the length of a step             | a step's time                        |
| `p_size`         | |p|, at most P of section 2         | 1                                    |
"""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from itertools import pairwise
from typing import Any, NamedTuple

from flint import arb, arb_poly, arb_series, ctx, fmpz, fmpz_poly

from .balls import SHORT, Vector, add, ball, cross, demand, dot, interval, size, times, upper
from .box import BoxBalls, BoxRadius, Widened, Windows, near, on_the_sphere, spread
from .course import FINISHED, scan_of
from .defect import Piece
from .printed_box import end_of
from .radius import Radius
from .shapes import (
    XDOT,
    Covered,
    DerivedZero,
    EnclosedZero,
    Interval,
    ProvedDerivatives,
    State,
    Tangent,
)
from .six_columns import cut, sup_norm
from .system import Scaled
from .tube import output, tube
from .zeros import Scan

TINY = arb(2) ** -4096  # more than nothing
TERMS = 32  # orders of p and K₀ in the residuals, which are compared with proposals in doubles


def derivative_of(x: Any) -> arb:
    """Return the first coefficient of a series; 0 of a ball, which does not depend on the input."""
    return x[1] if isinstance(x, arb_series) else arb(0)


# ------------------------------------------------- the bounds: Lemmas 12.2 and 12.4


class Variation(NamedTuple):
    """The derivative of a state to an input, or what is proposed for it: ρ and χ, this in 1/s."""

    rho: Vector
    chi: Vector


class Proposed(NamedTuple):
    """P and Q of a step, three polynomials each, with balls for coefficients."""

    P: list[arb_poly]
    Q: list[arb_poly]


@dataclass(frozen=True)
class TangentCandidate:
    """P and Q of a step as they are proposed: integers over `unit`, and so exact."""

    P: list[fmpz_poly]
    Q: list[fmpz_poly]
    unit: fmpz

    def at(self, s: Fraction, h: arb) -> Variation:
        """Return balls of P(s) and Q(s)."""
        P = [f(ball(s)) / self.unit for f in self.P]
        Q = [f(ball(s)) / self.unit for f in self.Q]
        return Variation(P, times(1 / h, Q))

    def polynomials(self) -> Proposed:
        """Return P and Q as balls."""
        P = [arb_poly(f) * (1 / arb(self.unit)) for f in self.P]
        Q = [arb_poly(f) * (1 / arb(self.unit)) for f in self.Q]
        return Proposed(P, Q)


def candidate_of(rows: list[list[int]], bits: int) -> TangentCandidate:
    """Return a proposal: six rows of integers over 2^bits, read once."""
    polynomials = [fmpz_poly(row) for row in rows]
    return TangentCandidate(polynomials[:3], polynomials[3:], fmpz(1) << bits)


class InputSensitivity:
    """How the motion depends on one input: what drives its derivative, and the radius of this.

    `varied` has length, pace, axes, Ω, γ and release as series in x, whose first coefficients are
    those of every pendulum of the box. `end` has P and Q at the end of the last step; at t = 0 it has
    balls of ρ and χ.
    """

    def __init__(self, balls: BoxBalls, name: str, half_width: Fraction, scale: int) -> None:
        self.w0 = balls.w0
        self.scale = arb((fmpz(1), fmpz(scale)))
        self.half_width = ball(half_width) / self.scale
        self.varied = balls.varied(name.partition(".")[2], self.scale)
        self.epsilon = arb(0)
        with ctx.workprec(balls.prec):
            r = self.varied.r
            v = self.varied.v
            omega = self.varied.omega
            H = cross(r, add(v, cross(omega, r)))
            self.end = Variation([derivative_of(x) for x in r], [derivative_of(x) for x in H])
            self.omega_q = [derivative_of(x) for x in omega]
            self.drag_q = derivative_of(self.varied.drag)

    def join(self, candidate: TangentCandidate, piece: Piece) -> None:
        """Add to ε by how much the proposals of a step do not join those of the one before."""
        h = piece.constants.h
        start = candidate.at(piece.step.low, h)
        end = candidate.at(piece.step.high, h)
        P_jump = distances(start.rho, self.end.rho)
        Q_jump = distances(start.chi, self.end.chi)
        # (12.2l)
        self.epsilon = self.epsilon + size(P_jump) + size(Q_jump) / self.w0
        self.end = end


def distances(a: Vector, b: Vector) -> Vector:
    """Return bounds of |a_i - b_i|."""
    return [(x - y).abs_upper() for x, y in zip(a, b, strict=True)]


@dataclass(frozen=True)
class SceneMotion:
    """Ω₀, p and K₀ of the scene on a step, in few bits and orders; p and K₀ are polynomials."""

    omega_0: Vector
    p: Vector
    K_0: Vector


@dataclass(frozen=True)
class ResidualNorms:
    """Sup norms on a step; `off_sphere` is that of p·P, `off_momentum` that of K₀·P + p·Q."""

    P: arb
    Q: arb
    R1: arb
    R2: arb
    off_sphere: arb
    off_momentum: arb


@dataclass(frozen=True)
class BoxStep:
    """What Lemma 12.2 needs of a step, for all pendulums of the box, in the step's time.

    `delta_omega` and `delta_drag` are |δΩ| and |δγ|; `W` bounds |Ω| and |Ω₀|.
    """

    constants: Scaled
    p_size: arb
    length: arb
    delta_omega: arb
    delta_drag: arb
    W: arb


@dataclass(frozen=True)
class Distance:
    """Bounds of |r - p| and |H - K₀| on a step, of one pendulum or of all of the box."""

    r: arb
    H: arb


@dataclass(frozen=True)
class Carried:
    """Bounds of |a| = |ρ - P|, of |b| = |χ - Q| and of |a'| on a step."""

    a: arb
    b: arb
    a_rate: arb


@dataclass(frozen=True)
class Reached:
    """How far all of the box reaches from the scene, by derivatives with these bounds."""

    distance: Distance
    bounds: list[Carried]


def scene_motion(piece: Piece, omega_0: Vector) -> SceneMotion:
    """Return what the residuals have of the scene's motion, cut as section 5 cuts p and K.

    `omega_0` is in 1/s here.
    """
    omega_0 = times(piece.constants.h, omega_0)
    p = [cut(arb_poly(f) * (1 / arb(piece.unit)), TERMS) for f in piece.p]
    p_rate = [cut(arb_poly(f) * (1 / arb(piece.unit)), TERMS) for f in piece.v]
    V = add(p_rate, cross(omega_0, p))
    K_0 = [cut(f, TERMS) for f in cross(p, V)]
    return SceneMotion(omega_0, p, K_0)


def residuals(
    constants: Scaled, scene: SceneMotion, sensitivity: InputSensitivity, proposed: Proposed
) -> ResidualNorms:
    """Return the norms of P and Q, of their residuals in (12.1a, b), and of (12.1c) of p, K₀, P, Q.

    Args:
        constants: the scene's γ₀ and c, and the step's h.
        scene: its motion on the step.
        sensitivity: Ω_q and γ_q.
        proposed: P and Q.
    """
    omega_0 = scene.omega_0
    p = scene.p
    K_0 = scene.K_0
    P = proposed.P
    Q = proposed.Q
    P_rate = [f.derivative() for f in P]
    Q_rate = [f.derivative() for f in Q]
    omega_q = times(constants.h, sensitivity.omega_q)
    drag_q = constants.h * sensitivity.drag_q
    K_less_omega = add(K_0, times(-1, omega_0))

    # (12.2a)
    R1 = add(P_rate, cross(p, Q), cross(P, K_less_omega), cross(omega_q, p))

    # (12.2b)
    R2 = add(Q_rate, cross(constants.c, P), cross(omega_0, Q), cross(omega_q, K_0))
    if not constants.drag_0.is_zero():
        along_p = times(dot(omega_q, p) + dot(omega_0, P), p)
        along_P = times(dot(omega_0, p), P)
        R2 = add(R2, times(constants.drag_0, add(Q, times(-1, omega_q), along_p, along_P)))
    if not drag_q.is_zero():
        R2 = add(R2, times(drag_q, add(K_less_omega, times(dot(omega_0, p), p))))

    return ResidualNorms(
        P=sup_norm(P),
        Q=sup_norm(Q),
        R1=sup_norm(R1),
        R2=sup_norm(R2),
        off_sphere=sup_norm([dot(p, P)]),
        off_momentum=sup_norm([dot(K_0, P) + dot(p, Q)]),
    )


def box_step(piece: Piece, omega_0: Vector, p_size: arb) -> BoxStep:
    """Return what Lemma 12.2 needs of a step; `omega_0` is in 1/s here."""
    constants = piece.constants
    omega_0 = times(constants.h, omega_0)
    return BoxStep(
        constants=constants,
        p_size=p_size,
        length=ball(piece.step.high - piece.step.low),
        delta_omega=size(add(constants.omega, times(-1, omega_0))),
        delta_drag=upper(abs(constants.drag - constants.drag_0)),
        W=constants.omega_size.max(size(omega_0)),
    )


def carried(
    step: BoxStep, sensitivity: InputSensitivity, norms: ResidualNorms, assumed: Distance
) -> Carried:
    """Return the bounds of Lemma 12.2, where all of the box is as near to p and K₀ as is assumed."""
    constants = step.constants
    c = constants.c_size
    Omega = constants.omega_size
    gamma = constants.drag_size
    w = constants.w
    S = constants.S
    p = step.p_size
    W = step.W
    delta_omega = step.delta_omega
    eta = assumed.r
    G = assumed.H
    P = norms.P
    Q = norms.Q
    omega_q = size(times(constants.h, sensitivity.omega_q))
    drag_q = upper(abs(constants.h * sensitivity.drag_q))

    # (12.2e)
    S1 = (Q + omega_q) * eta + (G + delta_omega) * P

    # (12.2f): what differs by Ω and H, by δγ, and in the terms of γ and γ_q
    S2 = Q * delta_omega + G * omega_q
    S2 = S2 + step.delta_drag * (Q + omega_q * (1 + p**2) + 2 * W * p * P)
    of_drag = gamma * (omega_q * eta * (1 + p) + 2 * P * (delta_omega + W * eta))
    of_drag_q = drag_q * (G + 2 * delta_omega + W * eta * (1 + p))
    S2 = S2 + (of_drag + of_drag_q)

    # (12.2g, h)
    A = norms.off_sphere + eta * P
    B = norms.off_momentum + G * P + eta * Q

    # (12.2d)
    curvature = constants.lambda_minus.max(constants.lambda_plus + S**2)
    two_w_mu = curvature + gamma * Omega

    # (12.2c, i)
    source = S1 + norms.R1 + (S2 + norms.R2 + A * c + B * S) / w
    growth = (step.length * two_w_mu / (2 * w)).exp()
    a = upper((sensitivity.epsilon + step.length * source) * growth)

    # (12.2j, k)
    b = upper((w + S) * a + B)
    a_rate = upper(b + (S + Omega) * a + S1 + norms.R1)
    return Carried(a, b, a_rate)


class Tangents:
    """Bounds the motions of a box by their derivatives (Lemma 12.4), and these (Lemma 12.2).

    After a step, `scene` is the tube of the scene's own motion, by Theorem C, and `tangents` has the
    derivatives of the position to the inputs.
    """

    scene: Covered
    tangents: list[Tangent]

    def __init__(
        self, balls: BoxBalls, half_widths: dict[str, Fraction], scales: dict[str, int]
    ) -> None:
        self.balls = balls
        texts = {name: str(half_width) for name, half_width in half_widths.items()}
        ends = [end_of(balls.inputs, texts, side) for side in (-1, 1)]
        # Lemma 12.4 takes a box that is symmetric about the scene
        demand(ends == [balls.claim.low, balls.claim.high], "a width is missing, or another one")
        self.sensitivities = [
            InputSensitivity(balls, name, half_width, scales[name])
            for name, half_width in half_widths.items()
        ]
        self.eta = arb(0)
        self.point = Radius(balls.own)
        self.box_radius = BoxRadius(balls)
        self.box_radius_holds = True

    @property
    def time(self) -> Fraction:
        """The time up to which the steps go."""
        return self.box_radius.time

    def advance(self, piece: Piece, proposal: list[Any]) -> Covered:
        """Carry all bounds over a step.

        Args:
            piece: the step.
            proposal: six polynomials of integers, and the bits of their unit, for each input.
        """
        # Lemmas 11.2 and 11.3: sizes and jump for all of the box
        widened = self.box_radius.widened(piece)
        # the same polynomials, read once, bound the scene's own motion
        self.scene = self.point.advance(Piece(self.balls.own, piece.step))
        candidates = [candidate_of(rows, bits) for rows, bits in proposal]

        with ctx.workprec(2 * SHORT):
            scene = scene_motion(piece, self.balls.omega_0)
            norms = []
            for sensitivity, candidate in zip(self.sensitivities, candidates, strict=True):
                sensitivity.join(candidate, piece)
                with ctx.workprec(SHORT):
                    polynomials = candidate.polynomials()
                    norms.append(residuals(piece.constants, scene, sensitivity, polynomials))

        with ctx.workprec(SHORT):
            sizes = widened.sizes
            delta_omega = size(add(piece.constants.omega, times(-1, scene.omega_0)))
            theorem_c = self.by_theorem_c(piece, widened, delta_omega)
            step = box_step(piece, self.balls.omega_0, sizes.p)
            reached = self.confirmed(step, norms, self.scene_distance(sizes.k), theorem_c)

            self.eta = reached.distance.r.min(theorem_c.r)
            H_distance = reached.distance.H.min(theorem_c.H)
            self.tangents = []
            bounds = zip(self.sensitivities, candidates, reached.bounds, strict=True)
            for sensitivity, candidate, bound in bounds:
                sensitivity.epsilon = bound.a
                self.tangents.append(Tangent(candidate.P, candidate.unit, bound.a, bound.a_rate))
            gamma = H_distance + sizes.p**2 * delta_omega  # (12.4f)
            return Covered(piece, tube(piece.constants, sizes, self.eta, gamma))

    def by_theorem_c(self, piece: Piece, widened: Widened, delta_omega: arb) -> Distance:
        """Return Theorem C's bounds for all of the box; infinite ones once Lemma 11.4 has failed."""
        eta = arb("inf")
        if self.box_radius_holds:
            try:
                eta = self.box_radius.grown(piece, widened).tube.eta
            except ArithmeticError:
                self.box_radius_holds = False
        K = widened.sizes.k
        P = widened.sizes.p
        H = ((piece.constants.w + K) * eta + P**2 * delta_omega).upper()
        return Distance(eta, H)  # (12.4d, e)

    def scene_distance(self, K: arb) -> Distance:
        """Return η₀ and G₀; `K` bounds |K| for all of the box."""
        eta_0 = self.scene.tube.eta
        w = self.scene.piece.constants.w
        return Distance(eta_0, (w + K) * eta_0)  # (12.4g)

    def confirmed(
        self, step: BoxStep, norms: list[ResidualNorms], of_scene: Distance, theorem_c: Distance
    ) -> Reached:
        """Return the bounds of Lemma 12.4, with E and G twice what follows from none.

        Raises ArithmeticError if they are not confirmed, and not Theorem C's either.
        """
        least = self.reached(step, norms, Distance(arb(0), arb(0)), of_scene).distance
        E = upper(2 * least.r + TINY).min(theorem_c.r)
        G = upper(2 * least.H + TINY).min(theorem_c.H)
        reached = self.reached(step, norms, Distance(E, G), of_scene)

        # (12.4a, b); what Theorem C gives holds without
        E_holds = reached.distance.r < E or theorem_c.r == E
        G_holds = reached.distance.H < G or theorem_c.H == G
        demand(E_holds and G_holds, "a bound has outgrown what it rests on")
        return reached

    def reached(
        self, step: BoxStep, norms: list[ResidualNorms], assumed: Distance, of_scene: Distance
    ) -> Reached:
        """Return E₁ and G₁ of Lemma 12.4, and the bounds they are made of, from E and G."""
        r = of_scene.r
        H = of_scene.H
        bounds = list[Carried]()
        for sensitivity, norm in zip(self.sensitivities, norms, strict=True):
            bound = carried(step, sensitivity, norm, assumed)
            # (12.4a, b)
            r = r + sensitivity.half_width * (norm.P + bound.a)
            H = H + sensitivity.half_width * (norm.Q + bound.b)
            bounds.append(bound)
        return Reached(Distance(upper(r), upper(H)), bounds)


# ------------------------------------------------- what is delivered: Lemmas 12.3 and 12.5


@dataclass(frozen=True)
class MotionBalls:
    """Balls of r, r' and r'' of all of the box at a place of a step, in 1, 1/s and 1/s²."""

    r: Vector
    v: Vector
    a: Vector


@dataclass(frozen=True)
class VariationBalls:
    """Balls of ρ and ρ' of all of the box at a place of a step, in 1 and 1/s per scaled input."""

    rho: Vector
    rate: Vector


@dataclass(frozen=True)
class Horizontal:
    """The part of a vector across c: along x, and along y = up × x."""

    x: arb
    y: arb


@dataclass(frozen=True)
class ZeroDerivative:
    """Derivatives of a zero's time and, of highest and lowest points, of its azimuth in degrees."""

    time: arb
    azimuth: arb | None


def motion_at(covered: Covered, s: arb) -> MotionBalls:
    """Return balls of r, r', r'' on the ball `s`: those of section 7."""
    piece = covered.piece
    bounds = covered.tube
    h = piece.constants.h

    def enclosed(polynomials: list[fmpz_poly], radius: arb, time: Any) -> Vector:
        return [(near(f, s) / piece.unit + arb(0, radius)) / time for f in polynomials]

    with ctx.workprec(piece.balls.prec):
        return MotionBalls(
            r=enclosed(piece.p, bounds.eta, 1),
            v=enclosed(piece.v, bounds.u, h),
            a=enclosed([f.derivative() for f in piece.v], bounds.a, h**2),
        )


def variation_at(covered: Covered, tangent: Tangent, s: arb) -> VariationBalls:
    """Return balls of ρ and ρ' on the ball `s`: P and P' with (12.2i) and (12.2k)."""
    h = covered.piece.constants.h
    rates = [f.derivative() for f in tangent.P]
    return VariationBalls(
        rho=[near(f, s) / tangent.unit + arb(0, tangent.a) for f in tangent.P],
        rate=[(near(f, s) / tangent.unit + arb(0, tangent.a_rate)) / h for f in rates],
    )


def horizontal(vector: Vector, c: Vector) -> Horizontal:
    """Return the part of a vector across c, which has no x component."""
    _, m, w = c
    y = times(1 / (m * m + w * w).sqrt(), [arb(0), -w, m])
    return Horizontal(vector[0], dot(vector, y))


def state_derivative(
    motion: MotionBalls, variation: VariationBalls, sensitivity: InputSensitivity, time: arb
) -> Vector:
    """Return balls of the derivatives of position and velocity, in m and m/s per unit of the input.

    They are those at `time`, by the pendulum's own clock (Lemma 12.3).
    """
    varied = sensitivity.varied
    # s_q t
    later = derivative_of(varied.pace) * time
    # (12.3a)
    r_series = [
        arb_series([r, v * later + rho], 2)
        for r, v, rho in zip(motion.r, motion.v, variation.rho, strict=True)
    ]
    # (12.3b)
    v_series = [
        arb_series([v, a * later + rate], 2)
        for v, a, rate in zip(motion.v, motion.a, variation.rate, strict=True)
    ]
    # (12.3c)
    state = on_the_sphere(*varied.turned(r_series, -1), *varied.turned(v_series, -1))
    position = times(varied.length, state[:3])
    velocity = times(varied.length * varied.pace, state[3:])
    return [derivative_of(x) / sensitivity.scale for x in (*position, *velocity)]


def zero_derivative(
    covered: Covered,
    motion: MotionBalls,
    variation: VariationBalls,
    sensitivity: InputSensitivity,
    s: arb,
    apsis: bool,
) -> ZeroDerivative:
    """Return the derivatives of a zero that lies in the ball `s` of a step.

    It is one of xdot (Lemma 12.3) or, with `apsis`, of the velocity along c (Lemma 12.5).
    """
    piece = covered.piece
    if apsis:
        c = piece.balls.c
        r, v, a = (horizontal(q, c) for q in (motion.r, motion.v, motion.a))
        rho, rate = (horizontal(q, c) for q in (variation.rho, variation.rate))
        # (12.5a)
        late = -(rho.x * v.x + rho.y * v.y + r.x * rate.x + r.y * rate.y) / (
            v.x**2 + v.y**2 + r.x * a.x + r.y * a.y
        )
        # (12.5b)
        turned = (r.x * rho.y - r.y * rho.x + late * (r.x * v.y - r.y * v.x)) / (r.x**2 + r.y**2)
        azimuth = turned * 180 / arb.pi() / sensitivity.scale
    else:
        # (12.3d)
        late = -variation.rate[0] / motion.a[0]
        azimuth = None

    # (12.3e)
    theta = arb_series([ball(piece.step.centre) + s * piece.constants.h, late], 2)
    own_time = derivative_of(theta / sensitivity.varied.pace)
    return ZeroDerivative(own_time / sensitivity.scale, azimuth)


def hull_of(vectors: Sequence[Vector]) -> Vector:
    """Return balls that contain those of all the vectors, component by component."""
    return [reduce(arb.union, column) for column in zip(*vectors, strict=True)]


@dataclass(frozen=True)
class CoveredStep:
    """A step's tube for all of the box, and its derivatives to the inputs."""

    covered: Covered
    tangents: list[Tangent]


class WatchedZeros:
    """The derivatives of a scan's zeros; `kept` are the steps since its open cluster began.

    `own_scan` is the same scan of the scene's own motion. `derivatives` has a list for each zero
    that the scan has closed: one for each input if it is single and all are finite, else none.
    """

    def __init__(self, scan: Scan, own_scan: Scan, apsis: bool) -> None:
        self.scan = scan
        self.own_scan = own_scan
        self.apsis = apsis
        self.kept = list[CoveredStep]()
        self.derivatives = list[list[ZeroDerivative]]()

    def advance(
        self, step: CoveredStep, scene: Covered, sensitivities: list[InputSensitivity]
    ) -> None:
        """Take the next step."""
        self.kept.append(step)
        self.take_closed(sensitivities)
        self.own_scan.advance(scene)
        if not self.scan.cluster:
            self.kept = []

    def take_closed(self, sensitivities: list[InputSensitivity]) -> None:
        """Take the derivatives of the zeros that were closed since the last call."""
        for zero in self.scan.found[len(self.derivatives) :]:
            derivatives = self.of_zero(zero, sensitivities) if zero.parity == "one" else []
            self.derivatives.append(derivatives if all_finite(derivatives) else [])

    def of_zero(
        self, zero: EnclosedZero, sensitivities: list[InputSensitivity]
    ) -> list[ZeroDerivative]:
        """Return the derivatives of a zero to each input, over all times that it may have."""
        begin = self.kept[0].covered.piece.begin
        end = self.kept[-1].covered.piece.end
        # it lies in leaves of steps that are kept, whatever rounding adds to its interval
        demand(zero.t.low < end and begin < zero.t.high, "a zero is not covered")

        at_places = [
            self.at_place(step, s, sensitivities)
            for step in self.kept
            for s in places(step.covered.piece, zero.t.low, zero.t.high)
        ]
        return [hull_of_zeros(of_input) for of_input in zip(*at_places, strict=True)]

    def at_place(
        self, step: CoveredStep, s: arb, sensitivities: list[InputSensitivity]
    ) -> list[ZeroDerivative]:
        """Return the derivatives of a zero that lies in the ball `s` of a step, to each input."""
        covered = step.covered
        motion = motion_at(covered, s)
        derivatives = []
        with ctx.workprec(covered.piece.balls.prec):
            for sensitivity, tangent in zip(sensitivities, step.tangents, strict=True):
                variation = variation_at(covered, tangent, s)
                derivatives.append(
                    zero_derivative(covered, motion, variation, sensitivity, s, self.apsis)
                )
        return derivatives

    def own_zero(self, zero: EnclosedZero) -> EnclosedZero | None:
        """Return the scene's own zero in the interval of a single one of the box, or None.

        Each pendulum of the box has one there, so that of the scene is the only one that touches it.
        """
        found = self.own_scan.found
        first = bisect_left(found, zero.t.low, key=lambda z: z.t.high)
        last = bisect_right(found, zero.t.high, key=lambda z: z.t.low)
        touching = found[first:last]
        if len(touching) == 1 and touching[0].parity == "one":
            return touching[0]
        return None


def places(piece: Piece, begin: Fraction, end: Fraction) -> list[arb]:
    """Return balls of s that cover the part of a step from one time to another; none if it has none."""
    low = max(begin, piece.begin)
    high = min(end, piece.end)
    return spread(piece, low, high) if low <= high else []


def hull_of_zeros(derivatives: Sequence[ZeroDerivative]) -> ZeroDerivative:
    """Return balls that contain all these derivatives."""
    time = reduce(arb.union, [x.time for x in derivatives])
    azimuths = [x.azimuth for x in derivatives if x.azimuth is not None]
    return ZeroDerivative(time, reduce(arb.union, azimuths) if azimuths else None)


@dataclass(frozen=True)
class Narrowed:
    """Zeros of a word in each pendulum's own time, and their derivatives."""

    zeros: tuple[EnclosedZero, ...]
    derived: tuple[DerivedZero, ...]


class Derivatives:
    """Follows a box's windows: derivatives of states at output times, and of zeros.

    The zeros are transits, highest and lowest points.
    """

    def __init__(
        self, windows: Windows, half_widths: dict[str, Fraction], scales: dict[str, int]
    ) -> None:
        self.windows = windows
        self.balls = windows.balls
        self.course = windows.course
        self.names = tuple(half_widths)
        self.bound = Tangents(self.balls, half_widths, scales)
        self.course.bound = self.bound
        # how many output times all pendulums of the box have passed
        self.done = 0
        # of the derivatives of a state, by output time and input
        self.hulls = list[list[Vector]]()
        # of the scene's own motion
        self.states = list[State]()
        self.watched = dict[str, WatchedZeros]()
        for word, scan in self.course.scans.items():
            # their forms are the same for all, in axes in which the plumb line is the same for all
            if word in (XDOT, "highest", "lowest"):
                own_scan = scan_of(self.balls.own, word, second_order=True)
                self.watched[word] = WatchedZeros(scan, own_scan, word != XDOT)
        self.course.followers.append(self)

    def advance(self, covered: Covered) -> None:
        """Take the next step: what it may hold of output times, and the zeros closed with it."""
        demand(not self.course.open, "a tube comes from the course alone, while it takes a step")
        step = CoveredStep(covered, self.bound.tangents)
        self.take_output_times(step)
        self.take_own_states(self.bound.scene)
        for watched in self.watched.values():
            watched.advance(step, self.bound.scene, self.bound.sensitivities)

    def take_output_times(self, step: CoveredStep) -> None:
        """Take the derivatives of states at output times that some pendulum has in this step."""
        piece = step.covered.piece
        pace = self.windows.pace
        for n in range(self.done, len(self.windows.times)):
            time = self.windows.times[n]
            low = pace.low * time
            high = pace.high * time
            if low > piece.end:
                break
            self.take_output_time(n, step, places(piece, low, high))
            if high <= piece.end:
                self.done += 1

    def take_output_time(self, n: int, step: CoveredStep, at: list[arb]) -> None:
        """Add the derivatives of the state at output time `n`, on the balls `at` of a step."""
        time = ball(self.windows.times[n])
        at_places = [self.at_place(step, s, time) for s in at]
        # what the steps before have of this time
        before = self.hulls[n : n + 1]
        of_inputs = zip(*before, *at_places, strict=True)
        self.hulls[n : n + 1] = [[hull_of(states) for states in of_inputs]]

    def at_place(self, step: CoveredStep, s: arb, time: arb) -> list[Vector]:
        """Return the derivatives of the state at `time`, which lies in the ball `s`, to each input."""
        covered = step.covered
        motion = motion_at(covered, s)
        derivatives = []
        with ctx.workprec(self.balls.prec):
            for sensitivity, tangent in zip(self.bound.sensitivities, step.tangents, strict=True):
                variation = variation_at(covered, tangent, s)
                derivatives.append(state_derivative(motion, variation, sensitivity, time))
        return derivatives

    def take_own_states(self, scene: Covered) -> None:
        """Take the states of the scene's own motion at output times in this step."""
        for time in self.windows.times[len(self.states) :]:
            if time > scene.piece.end:
                break
            self.states.append(output(scene, time))

    def finish(self) -> ProvedDerivatives:
        """Return what is proved, with states and zeros as narrow as the derivatives make them."""
        proved = self.windows.finish()
        complete = self.done == len(self.states) == len(self.windows.times)
        demand(complete, "the steps do not end with the run")
        with ctx.workprec(self.balls.prec):
            states = tuple(
                self.narrowed_state(wide, own, derivatives)
                for wide, own, derivatives in zip(
                    proved.states, self.states, self.hulls, strict=True
                )
            )
            narrowed = {word: self.narrowed(word, proved.zeros[word]) for word in self.watched}
        zeros = {word: of_word.zeros for word, of_word in narrowed.items()}
        narrow = replace(proved, states=states, zeros=proved.zeros | zeros)
        FINISHED.add(narrow)

        result = ProvedDerivatives(
            narrow,
            self.names,
            tuple(tuple(intervals(row) for row in rows) for rows in self.hulls),
            {word: of_word.derived for word, of_word in narrowed.items()},
        )
        FINISHED.add(result)
        return result

    def narrowed_state(self, wide: State, own: State, derivatives: list[Vector]) -> State:
        """Return a state of all of the box: in `wide`, and as near to the scene's own as (12.4c) says."""
        by_component = zip(wide, own, zip(*derivatives, strict=True), strict=True)
        return tuple(within(x, y, self.bound.sensitivities, row) for x, y, row in by_component)

    def narrowed(self, word: str, proved: tuple[EnclosedZero, ...]) -> Narrowed:
        """Return the zeros of a word with times as narrow as derivatives make them, and these.

        `proved` are the zeros of `windows`, in each pendulum's own time.
        """
        watched = self.watched[word]
        sensitivities = self.bound.sensitivities
        watched.take_closed(sensitivities)
        in_order = all(
            z.t.low <= after.t.low and z.t.high <= after.t.high
            for z, after in pairwise(watched.own_scan.finish())
        )
        demand(in_order, "zeros must be in order")

        zeros = list[EnclosedZero]()
        derived = list[DerivedZero]()
        # `proved` lacks the last of the scan's zeros if they come after the end
        rows = zip(proved, watched.scan.found, watched.derivatives, strict=False)
        for zero, in_course, derivatives in rows:
            own = watched.own_zero(in_course) if derivatives else None
            if own is None:
                zeros.append(zero)
            else:
                # the scene's own clock is that of the course
                t = within(zero.t, own.t, sensitivities, [x.time for x in derivatives])
                zeros.append(replace(zero, t=t))
            derived.append(derived_zero(own, derivatives))
        return Narrowed(tuple(zeros), tuple(derived))


def all_finite(derivatives: list[ZeroDerivative]) -> bool:
    """Return whether no derivative of a zero has an infinite ball."""
    for derivative in derivatives:
        if not derivative.time.is_finite():
            return False
        if derivative.azimuth is not None and not derivative.azimuth.is_finite():
            return False
    return True


def derived_zero(own: EnclosedZero | None, derivatives: list[ZeroDerivative]) -> DerivedZero:
    """Return the scene's own zero with intervals for the derivatives."""
    azimuths = [x.azimuth for x in derivatives if x.azimuth is not None]
    return DerivedZero(own, intervals([x.time for x in derivatives]), intervals(azimuths))


def intervals(balls: Vector) -> tuple[Interval, ...]:
    """Return the exact endpoints of balls."""
    return tuple(interval(x) for x in balls)


def within(
    wide: Interval,
    own: Interval,
    sensitivities: list[InputSensitivity],
    derivatives: Sequence[arb],
) -> Interval:
    """Return where a number is for all inputs: in `wide`, and near the scene's own (Lemma 12.4)."""
    reach = sum(
        (
            sensitivity.half_width * sensitivity.scale * x.abs_upper()
            for sensitivity, x in zip(sensitivities, derivatives, strict=True)
        ),
        arb(0),
    )
    if not reach.is_finite():
        return wide
    far = interval(reach).high
    # (12.4c)
    low = max(wide.low, own.low - far)
    high = min(wide.high, own.high + far)
    demand(low <= high, "two bounds of one number contradict each other")
    return Interval(low, high)
