"""TRUSTED. How the error grows from step to step: Theorem N, and Theorem C with one radius (THEOREM.md, 3 and 4).

In the time of a step, lengths over that of the rod; η is the same in physical time.

| name                       | symbol                                      | unit   |
|----------------------------|---------------------------------------------|--------|
| `length`                   | ℓ, the length of a step in s                | 1      |
| `eta_start`, `eta`         | η(a), η(s)                                  | 1      |
| `e_bar`                    | ē >= |e|                                    | 1      |
| `nu`, `mu`                 | ν, μ, the rates of Theorems N and C         | 1      |
| `b`                        | b, what the defects add to η in a unit of s | 1      |
| `c`, `Omega`, `gamma`, `w` | |c|, |Ω|, γ, w                              | 1      |
| `S`                        | S >= |H|                                    | 1      |
| `P`, `K`, `T`, `D1`, `D2`  | the sizes of section 6                      | 1      |
| `g_bound`                  | Γ >= |g|                                    | 1      |
| `Jump`                     | |Δp|, |ΔK|                                  | 1, 1/s |
"""

from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx, fmpz

from .balls import SHORT, Vector, add, ball, cross, demand, size, times, upper
from .defect import Piece
from .shapes import Covered
from .system import Scaled, SceneBalls
from .tube import tube


def error_rate(constants: Scaled, P: arb) -> arb:
    """Return the rate ν of Theorem N."""
    c = constants.c_size
    Omega = constants.omega_size
    gamma = constants.drag_size
    w = constants.w
    return (c + w**2 + gamma * Omega * (1 + P)) / (2 * w)  # (3.1)


class PhasePoint(NamedTuple):
    """A point of a motion, r and H, or of the polynomials p and K that stand for them; H and K in 1/s, with Ω₀."""

    r: Vector
    H: Vector


class Jump(NamedTuple):
    """Bounds of the components of Δp and ΔK where one step joins the next, ΔK in 1/s, with Ω₀."""

    p: Vector
    K: Vector


class CarriedState:
    """State carried from step to step: the time reached, and p and K there; at t = 0 balls of r and H."""

    def __init__(self, balls: SceneBalls) -> None:
        self.balls = balls
        self.time = Fraction(0)
        self.last = PhasePoint(balls.r, balls.H)

    def join(self, piece: Piece) -> Jump:
        """Return bounds of the jumps in p and K from the end of the step before to the start of `piece`."""
        demand(
            piece.begin == self.time and piece.balls is self.balls,
            "steps must join, and be of one scene",
        )
        with ctx.workprec(self.balls.prec):
            start = _point(piece, piece.step.low)
            end = _point(piece, piece.step.high)
            jump = Jump(_distances(start.r, self.last.r), _distances(start.H, self.last.H))
        self.time = piece.end
        self.last = end
        return jump


def _point(piece: Piece, s: Fraction) -> PhasePoint:
    """Return p and K = p × (p' + Ω₀ × p) at `s`, K in 1/s."""
    # most steps end at ±1, where integers are faster than balls
    at = ball(s) if s.denominator > 1 else fmpz(s.numerator)
    p, v = piece.values(at)
    K = cross(p, add(v, cross(piece.constants.omega_0, p)))
    return PhasePoint(p, times(1 / piece.constants.h, K))


def _distances(a: Vector, b: Vector) -> Vector:
    """Return bounds of |a_i − b_i|."""
    return [(x - y).abs_upper() for x, y in zip(a, b, strict=True)]


class Radius(CarriedState):
    """Theorem C: one radius, |e|² + |g⊥|²/w² <= eta²."""

    eta = arb(0)

    def advance(self, piece: Piece) -> Covered:
        """Carry the radius over a piece (Theorem C)."""
        jump = self.join(piece)
        constants = piece.constants
        sizes = piece.sizes
        with ctx.workprec(SHORT):
            c = constants.c_size
            Omega = constants.omega_size
            gamma = constants.drag_size
            w = constants.w
            S = constants.S
            P = sizes.p
            K = sizes.k
            T = sizes.tau
            D1 = sizes.d1
            D2 = sizes.d2
            length = ball(piece.step.high - piece.step.low)

            # from step to step, in physical time
            eta_start = upper(self.eta + size(jump.p) + size(jump.K) / self.balls.w0)  # (4.8)

            # Theorem N
            defects = D2 / w + D1
            growth = (length * error_rate(constants, P)).exp()
            e_bar = upper(((1 + K / w) * eta_start + length * defects) * growth)  # (4.1)

            # Theorem C
            curvature = constants.lambda_minus.max(constants.lambda_plus + (S + w * e_bar) ** 2)
            mu = (curvature + (c + K**2) * e_bar + gamma * Omega * P) / (2 * w)  # (4.3)
            b = (c + K**2) * T / (2 * w) + defects  # (4.4)
            self.eta = upper((eta_start + length * b) * (length * mu).exp())  # (4.2)

            g_bound = (w + K) * self.eta  # (4.9), the Γ of section 7
            return Covered(piece, tube(constants, sizes, self.eta, g_bound))
