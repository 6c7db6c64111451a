"""TRUSTED. Sections of a motion: zeros of affine forms of position and velocity (THEOREM.md, section 13).

| name                 | symbol                                          | unit                    |
|----------------------|-------------------------------------------------|-------------------------|
| `form.a`, `.b`, `.d` | a, b, d of F = a·r + b·v - d                    | 1; 1/s² in (13.6, 13.8) |
| `a_whole`, …         | integers that stand for ha, b, hd               | over 2^bits             |
| `a_miss`, …          | ϑa, ϑb, ϑd: by how much these miss              | a step's time           |
| `eta`, `U`, `A`      | bounds of |r - p|, |v - p'|, |r'' - p''|        | a step's time           |
| `lost`               | (13.1c) and (13.1d)                             | a step's time           |
| `value`, `rate`      | f ± off of hF and f' ± off' of hF'              | over 2^(2 bits)         |
| `along`              | e, along the azimuth α                          | 1                       |
| `rest`               | r₀, the rest position                           | lengths of the rod      |
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

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
from .zeros import Enclosed, FormOnStep, Scan, ShortForms, sign

DIRECTIONS = {"highest": -1, "lowest": 1}  # where a word counts zeros in one direction alone
SHORT_ORDERS = 32  # of a form in few bits


@dataclass(frozen=True)
class AffineForm:
    """F = a·r + b·v - d, in the axes of the proof."""

    a: Vector
    b: Vector
    d: arb


class ByForm(NamedTuple):
    """A number for a form, and one for its rate."""

    value: arb
    rate: arb


def azimuth_of(word: str) -> tuple[arb, arb]:
    """Return sine and cosine of the azimuth of `gate α`, `gate α@0` or `turn α`."""
    kind, _, azimuth = word.partition(" ")
    demand(kind in ("gate", "turn"), f"there is no section {word}")
    if kind == "gate":
        azimuth = azimuth.removesuffix("@0")
    return ball(Fraction(azimuth) / 180).sin_cos_pi()


def form(balls: SceneBalls, word: str) -> AffineForm:
    """Return the form of a section's word."""
    zero = [arb(0)] * 3
    if word in DIRECTIONS:
        return AffineForm(zero, times(-1, balls.c), arb(0))  # (13.6)

    sin, cos = azimuth_of(word)
    along = balls.turned([cos, sin, arb(0)], 1)
    if word.startswith("turn "):
        return AffineForm(zero, along, arb(0))  # (13.5)
    if word.endswith("@0"):
        return AffineForm(balls.turned([-sin, cos, arb(0)], 1), zero, arb(0))  # (13.7)
    across = cross(along, balls.c)
    return AffineForm(across, zero, dot(across, rest_position(balls)))  # (13.8)


def rest_position(balls: SceneBalls) -> Vector:
    """Return balls that contain every hanging rest position, for all pendulums (Lemma 13.3)."""
    rest: Vector = [UNIT] * 3
    for _ in range(balls.prec):
        # (13.3a)
        G = add(balls.c, times(-1, cross(balls.omega, cross(balls.omega, rest))))
        demand(
            dot(G, G) > 0,
            "the rotation is too fast for a single rest position, which a gate passes through",
        )
        rest = times(1 / dot(G, G).sqrt(), G)
    return rest


def vanishes_at_release(balls: SceneBalls, word: str) -> bool:
    """Return whether exact zeros of the inputs show that F(0) = 0, for every pendulum (Lemma 13.2)."""
    position, velocity = balls.release
    x, y, _ = position
    vx, vy, _ = velocity
    if word in DIRECTIONS:
        # (13.2d): c has no component to the east
        return bool(balls.level and (balls.upright or vy.is_zero()))

    sin, cos = azimuth_of(word)
    if word.startswith("turn "):
        return bool((vx * cos + vy * sin).is_zero())  # (13.2b)
    return word.endswith("@0") and (y * cos - x * sin).is_zero()  # (13.2c)


class SectionOnStep(FormOnStep):
    """The function whose zeros are a section's passages, on one step (Lemma 13.1)."""

    short: ShortForms

    def __init__(self, covered: Covered, form: AffineForm, zero_at_release: bool = False) -> None:
        super().__init__(covered)
        piece = covered.piece
        h = piece.constants.h
        bits = piece.step.bits
        self.unit = piece.unit**2
        self.zero_at_release = zero_at_release

        a_whole, a_miss = fixed(times(h, form.a), bits)
        b_whole, b_miss = fixed(form.b, bits)
        d_whole, d_miss = fixed([h * form.d], bits)
        terms = zip(
            [*a_whole, *b_whole, *d_whole],
            [*piece.p, *piece.v, fmpz_poly([-piece.unit])],
            strict=True,
        )
        self.f = arb_poly(sum((n * g for n, g in terms if n), fmpz_poly()))

        P = piece.sizes.p
        K = piece.sizes.k
        orders = max(map(len, piece.p))
        self.lost = ByForm(
            value=a_miss * P + b_miss * K + d_miss,  # (13.1c)
            rate=a_miss * K + b_miss * (orders * K),  # (13.1d)
        )

        eta, U, A = covered.tube
        a_size = h * size(form.a)
        b_size = size(form.b)
        # (13.1a, b)
        self.hold(ByForm(a_size * eta + b_size * U, a_size * U + b_size * A))

    def hold(self, off: ByForm) -> None:
        """Take bounds of how far hF and hF' are from f and f', but for what integers lose."""
        self.value = Enclosed(self.f, arb(0, upper(off.value + self.lost.value)))
        self.rate = Enclosed(self.f.derivative(), arb(0, upper(off.rate + self.lost.rate)))
        # most signs are clear, and need no more bits and orders than these
        with ctx.workprec(SHORT):
            self.short = ShortForms(self._short(self.value), self._short(self.rate))

    def _short(self, form: Enclosed) -> arb_poly:
        """Return a form in few bits and orders."""
        return cut(form.polynomial * (1 / arb(self.unit)), SHORT_ORDERS) + form.off

    def value_at(self, s: arb) -> Any:
        """Return a ball that contains hF on the ball `s`."""
        if ctx.prec == SHORT:
            return short_at(self.short.value, s)
        return super().value_at(s)

    def rate_at(self, s: arb) -> Any:
        """Return a ball that contains hF' on the ball `s`."""
        if ctx.prec == SHORT:
            return short_at(self.short.rate, s)
        return super().rate_at(s)

    def row(self, s: arb) -> dict[str, Any]:
        """Return the state over the length at a zero that lies in the ball `s`."""
        r, v = state(self.covered, s)
        return self._turned(r, times(1 / self.piece.constants.h, v))

    def _turned(self, r: Vector, v: Vector) -> dict[str, Any]:
        """Return a state in axes east, north, up."""
        turned = self.piece.balls.turned
        names = ("x", "y", "z", "vx", "vy", "vz")
        return dict(zip(names, [*turned(r, -1), *turned(v, -1)], strict=True))


def short_at(f: arb_poly, s: arb) -> Any:
    """Return a ball that contains a short form on the ball `s`.

    It is read about the middle of `s` where the series about 0 shows no sign, and there may be one:
    where both ends have the same.
    """
    about_0 = f(s)
    if not sign(about_0) and f(s.lower()) * f(s.upper()) > 0:
        return f(arb_poly([s.mid(), 1]))(s - s.mid())
    return about_0


class ApsisOnStep(SectionOnStep):
    """The form of highest and lowest points, b·v, by bounds of second order (Lemma 13.4)."""

    def __init__(self, covered: Covered, form: AffineForm, zero_at_release: bool = False) -> None:
        super().__init__(covered, form, zero_at_release)
        piece = self.piece
        b = form.b
        bits = piece.step.bits
        eta, U, A = covered.tube
        p = [f(UNIT) / piece.unit for f in piece.p]
        p_rate = [f(UNIT) / piece.unit for f in piece.v]
        p_bend = [f.derivative()(UNIT) / piece.unit for f in piece.v]

        b_dot_p = dot(p, b).abs_lower()
        if not b_dot_p > 0:
            return  # Lemma 13.1 alone
        b_size = size(b)
        b_cross_p = size(cross(p, b))
        speed = size(p_rate)
        # p·p' and its derivative, in integers over 2^(2 bits)
        p_dot_p_rate = dot(piece.p, piece.v)

        # (13.4a)
        first = eta * (speed + U) + total(p_dot_p_rate, 2 * bits)
        value = b_size / b_dot_p * (b_cross_p * U + b_size * first)
        # (13.4b)
        second = eta * (size(p_bend) + A) + U * (2 * speed + U)
        second = second + total(p_dot_p_rate.derivative(), 2 * bits)
        rate = b_size / b_dot_p * (b_cross_p * A + b_size * second)
        self.hold(ByForm(value, rate))

    def row(self, s: arb) -> dict[str, Any]:
        """Return the state over the length at a zero, read about the middle of the ball `s`."""
        piece = self.piece
        tube = self.covered.tube
        middle = arb_poly([s.mid(), 1])
        off = s - s.mid()
        p = [arb_poly(f)(middle)(off) / piece.unit for f in piece.p]
        p_rate = [arb_poly(f)(middle)(off) / piece.unit for f in piece.v]
        r = [x + arb(0, tube.eta) for x in p]
        v = [(x + arb(0, tube.u)) / piece.constants.h for x in p_rate]
        return self._turned(r, v)


def section_scan(balls: SceneBalls, word: str, second_order: bool = False) -> Scan:
    """Return a scan for the passages of a section.

    With `second_order` highest and lowest points are bounded by Lemma 13.4.
    """
    with ctx.workprec(balls.prec):
        affine = form(balls, word)
        zero_at_release = vanishes_at_release(balls, word)
    kind = ApsisOnStep if second_order and word in DIRECTIONS else SectionOnStep
    form_on = partial(kind, form=affine, zero_at_release=zero_at_release)
    return Scan(balls, form_on, DIRECTIONS.get(word, 0))
