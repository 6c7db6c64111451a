"""TRUSTED. How the error grows from step to step: Theorem N, and Theorem C with one radius (THEOREM.md, 3 and 4)."""

from fractions import Fraction

from flint import arb, ctx

from .balls import SHORT, Vector, add, ball, cross, demand, size, times, upper
from .defect import Piece
from .shapes import Covered
from .system import Scaled, SceneBalls
from .tube import tube


def error_rate(k: Scaled, size_p: arb) -> arb:
    """Return the rate ν of Theorem N."""
    return (k.c_size + k.w**2 + k.drag_size * k.omega_size * (1 + size_p)) / (2 * k.w)


class CarriedState:
    """State carried from step to step: the time reached, and p and K there (K in 1/s); at t = 0 balls of r and H."""

    def __init__(self, balls: SceneBalls) -> None:
        self.balls, self.time, self.last = balls, Fraction(0), [*balls.r, *balls.H]

    def join(self, piece: Piece) -> Vector:
        """Return bounds of the jumps in p and K from the end of the step before to the start of `piece`."""
        demand(
            piece.begin == self.time and piece.balls is self.balls,
            "steps must join, and be of one scene",
        )
        with ctx.workprec(self.balls.prec):
            ends = (piece.values(ball(s)) for s in (piece.step.low, piece.step.high))
            start, end = (
                [*p, *times(1 / piece.k.h, cross(p, add(v, cross(piece.k.omega, p))))]
                for p, v in ends
            )
            self.time, self.last, before = piece.end, end, self.last
            return [(a - b).abs_upper() for a, b in zip(start, before, strict=True)]


class Radius(CarriedState):
    """Theorem C: one radius, |e|² + |g⊥|²/w² <= eta²."""

    eta = arb(0)

    def advance(self, piece: Piece) -> Covered:
        """Carry the radius over a piece."""
        k, jump, d = piece.k, self.join(piece), piece.sizes
        with ctx.workprec(SHORT):
            span, gw, ck = (
                ball(piece.step.high - piece.step.low),
                k.drag_size * k.omega_size,
                k.c_size + d.k**2,
            )
            start, source = (
                upper(self.eta + size(jump[:3]) + size(jump[3:]) / self.balls.w0),
                d.d2 / k.w + d.d1,
            )
            # Theorem N: |e| <= far
            far = upper(
                ((1 + d.k / k.w) * start + span * source) * (span * error_rate(k, d.p)).exp()
            )
            rate = (k.below.max(k.above + (k.speed + k.w * far) ** 2) + ck * far + gw * d.p) / (
                2 * k.w
            )
            self.eta = upper(
                (start + span * (ck * d.tau / (2 * k.w) + source)) * (span * rate).exp()
            )
            return Covered(piece, tube(k, d, self.eta, (k.w + d.k) * self.eta))
