"""TRUSTED. Sections of a motion: zeros of affine forms of position and velocity (THEOREM.md, section 13)."""

from fractions import Fraction
from typing import Any

from flint import arb, arb_poly, ctx, fmpz_poly

from .balls import (
    SHORT,
    UNIT,
    Vector,
    add,
    ball,
    cross,
    demand,
    dot,
    fixed,
    size,
    times,
    total,
    upper,
)
from .shapes import Covered
from .six_columns import cut
from .system import SceneBalls
from .tube import state
from .zeros import Scan, Slope, sign

WAYS = {"highest": -1, "lowest": 1}


def form(balls: SceneBalls, word: str) -> tuple[Vector, Vector, arb]:
    """Return the form a·r + b·v - d of a section's word, in the axes of the proof."""
    kind, _, azimuth = word.partition(" ")
    zero, (sin, cos) = (
        [arb(0)] * 3,
        ball(Fraction(azimuth.removesuffix("@0") or 0) / 180).sin_cos_pi(),
    )
    along, rest = balls.turned([cos, sin, arb(0)], 1), [UNIT] * 3
    if kind != "gate":
        return zero, along if kind == "turn" else times(-1, balls.c), arb(0)
    if azimuth.endswith("@0"):
        return balls.turned([-sin, cos, arb(0)], 1), zero, arb(0)
    for _ in range(balls.prec):
        pull = add(balls.c, times(-1, cross(balls.omega, cross(balls.omega, rest))))
        demand(
            dot(pull, pull) > 0,
            "so fast a rotation singles out no rest position, which the gate goes through",
        )
        rest = times(1 / dot(pull, pull).sqrt(), pull)
    return (across := cross(along, balls.c)), zero, dot(across, rest)


def vanishes_at_release(balls: SceneBalls, word: str) -> bool:
    """Return whether exact zeros of the inputs show that F(0) = 0, for every pendulum (Lemma 13.2)."""
    kind, _, azimuth = word.partition(" ")
    (x, y, _), (vx, vy, _) = balls.release
    if kind in WAYS:
        # c has no component to the east
        return bool(balls.level and (balls.upright or vy.is_zero()))
    sin, cos = ball(Fraction(azimuth.removesuffix("@0")) / 180).sin_cos_pi()
    if kind == "turn":
        return bool((vx * cos + vy * sin).is_zero())
    return azimuth.endswith("@0") and (y * cos - x * sin).is_zero()


class SectionSlope(Slope):
    """The form, times h, lies in f ± off on a piece, and its rate in f' ± off'.

    `slow` says that the form is exactly 0 at the release.
    """

    names: tuple[str, ...] = ("x", "y", "z", "vx", "vy", "vz")

    def __init__(self, covered: Covered, a: Vector, b: Vector, d: arb, slow: bool = False) -> None:
        piece = covered.piece
        eta, u, bend = covered.tube
        h, bits = piece.constants.h, piece.step.bits
        # integers over 2^bits stand for h a, b and h d; by how much they miss these, the radii of the balls included
        a_whole, a_miss = fixed(times(h, a), bits)
        b_whole, b_miss = fixed(b, bits)
        d_whole, d_miss = fixed([h * d], bits)
        self.covered, self.piece = covered, piece
        self.centre, self.unit = ball(piece.step.centre), piece.unit**2
        self.slow, self.flat = slow, False

        # Lemma 13.1: |p| <= P, |p'| <= K, |p''| <= O K
        position, speed = piece.sizes.p, piece.sizes.k
        bending = max(map(len, piece.p)) * speed
        self.lost = a_miss * position + b_miss * speed + d_miss, a_miss * speed + b_miss * bending

        terms = zip(
            [*a_whole, *b_whole, *d_whole],
            [*piece.p, *piece.v, fmpz_poly([-piece.unit])],
            strict=True,
        )
        f = arb_poly(sum((n * g for n, g in terms if n), fmpz_poly()))
        a_size, b_size = h * size(a), size(b)
        self.hold(f, a_size * eta + b_size * u, a_size * u + b_size * bend)

    def hold(self, f: Any, *offs: arb) -> None:
        """Take f, and what it and f' miss; both in few bits and orders as well, which are enough for most signs."""
        both = zip((f, f.derivative()), offs, self.lost, strict=True)
        self.forms = [(g, arb(0, upper(off + lost))) for g, off, lost in both]
        with ctx.workprec(SHORT):
            self.short = [cut(g * (1 / arb(self.unit)), SHORT // 2) + off for g, off in self.forms]

    def at(self, n: int, s: arb) -> Any:
        """Return a ball that contains the form (n = 0) or its rate (n = 1) on the ball `s`."""
        plain = self.short[n](s) if ctx.prec == SHORT else super().at(n, s)
        # about the middle where the series about 0 shows no sign, and there may be one: both ends have the same
        if (
            ctx.prec == SHORT
            and not sign(plain)
            and self.short[n](s.lower()) * self.short[n](s.upper()) > 0
        ):
            return self.short[n](arb_poly([s.mid(), 1]))(s - s.mid())
        return plain

    def row(self, s: arb) -> Vector:
        """Return the state over the length."""
        turned, (r, v) = self.piece.balls.turned, state(self.covered, s)
        return [*turned(r, -1), *turned(times(1 / self.piece.constants.h, v), -1)]


class Apsis(SectionSlope):
    """The form of highest and lowest points, b·v, by bounds of second order: v is along the sphere (Lemma 13.4)."""

    def __init__(self, covered: Covered, a: Vector, b: Vector, d: arb, slow: bool = False) -> None:
        super().__init__(covered, a, b, d, slow)
        piece, (eta, u, bend), long = self.piece, covered.tube, size(b)
        miss, bits = dot(piece.p, piece.v), piece.step.bits
        x = [f(UNIT) / piece.unit for f in (*piece.p, *piece.v, *(f.derivative() for f in piece.v))]
        aside, low, most, lost = (
            size(cross(x[:3], b)),
            dot(x[:3], b).abs_lower(),
            size(x[3:6]),
            miss.derivative(),
        )
        if low > 0:
            first = aside * u + long * (eta * (most + u) + total(miss, 2 * bits))
            second = eta * (size(x[6:]) + bend) + u * (2 * most + u) + total(lost, 2 * bits)
            self.hold(
                self.forms[0][0], long / low * first, long / low * (aside * bend + long * second)
            )

    def row(self, s: arb) -> Vector:
        """Return the state over the length, about the middle of `s`."""
        piece, (eta, u, _), (middle, off) = (
            self.piece,
            self.covered.tube,
            (arb_poly([s.mid(), 1]), s - s.mid()),
        )
        x = [arb_poly(f)(middle)(off) / piece.unit for f in (*piece.p, *piece.v)]
        r, v = (
            [q + arb(0, eta) for q in x[:3]],
            [(q + arb(0, u)) / piece.constants.h for q in x[3:]],
        )
        return [*piece.balls.turned(r, -1), *piece.balls.turned(v, -1)]


def section_scan(balls: SceneBalls, word: str, second_order: bool = False) -> Scan:
    """Return a scan for the passages of a section; `second_order`: of highest and lowest points by `Apsis`."""
    with ctx.workprec(balls.prec):
        a, b, d = form(balls, word)
        slow = vanishes_at_release(balls, word)
    kind = Apsis if second_order and word in WAYS else SectionSlope
    return Scan(balls, lambda covered: kind(covered, a, b, d, slow), WAYS.get(word, 0))
