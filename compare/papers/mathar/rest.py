"""Mathar, sections V and VI: the rest position (44)-(50), and the terms dropped on the way to (51)-(52)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from ...approximations.frequency import line_of_46, series, triangle
from ...approximations.mathar import derivatives, truncated
from ..checks import (
    Answer,
    Approximate,
    Check,
    Identity,
    PrintedNumber,
    Statement,
    component,
    over,
    section,
)
from ..digits import (
    MP,
    ZERO_BELOW,
    Vector,
    cos,
    degrees,
    derivative,
    shown,
    sin,
    sqrt,
    vanishes,
    vector,
)
from ..first_principles import (
    coupled_at,
    horizontal_acceleration,
    in_rate,
    linearised,
    rest,
    uniform_acceleration,
)
from ..points import Point, paris, points
from .lagrangian import beta_x, beta_y, solved

SERIES = (
    (2, "²", "/ 2g"),
    (4, "⁴", "[(N+h) (1+cos2ϕ)/2 - l cos2ϕ] / 2g²"),
    (
        6,
        "⁶",
        "{(N+h)² [cos4ϕ + 3cos2ϕ + 2] - (N+h) l [37/8 cos4ϕ + 11/8 + 6cos2ϕ] + l² [35/8 cos4ϕ + 13/8]} / 12g³",
    ),
)


def _at_rest(p: Point, **changes: Any) -> Point:
    return p.but(**({"vx": MP.zero, "vy": MP.zero} | changes))


def _right_side_of_45(p: Point, y: Any, sign: int = 1) -> Any:
    """Return it with one sign of its root or the other."""
    s, c, l2 = sin(p.phi), cos(p.phi), p.length**2
    bowed = sign * sqrt(l2 - y**2) * (y - p.R * s - 2 * y * c**2)
    return (bowed + c * (p.R * y + (l2 - 2 * y**2) * s)) * p.rate**2 / p.gravity


def _hanging(p: Point) -> Point:
    x, y, _ = rest(p)
    return _at_rest(p, x=x, y=y)


def _degree_of_45() -> Answer:
    p = points()[0]

    def cleared(y: Any) -> Any:
        """Return (45) without its root: the product of y - its right side, with either sign of the root."""
        return MP.re((y - _right_side_of_45(p, y)) * (y - _right_side_of_45(p, y, -1)))

    def difference(order: int) -> Any:
        return sum((-1) ** k * MP.binomial(order, k) * cleared(MP.mpf(k)) for k in range(order + 1))

    holds = abs(difference(5)) < ZERO_BELOW < abs(difference(4))
    return Answer(
        holds, f"fourth difference {shown(difference(4))}, fifth {shown(difference(5), 2)}"
    )


def _first_line_of_46(p: Point, sign: int) -> Any:
    (sp, cp, *_), s, c, turn2 = p.angle_functions, sin(p.phi), cos(p.phi), p.rate**2
    far = p.R / p.length * turn2 * (sign * s * cp - c * sp)
    near = turn2 * (s * sp + sign * c * cp) * (sign * c * sp - s * cp)
    return far + near + p.gravity / p.length * sp


def _restoring(p: Point, sign: int) -> Any:
    """Return -φ'' of a bob let go at rest in the meridian, to the north (+1) or the south (-1)."""
    local = _at_rest(p, x=MP.zero, y=sign * p.length * sin(p.cord))
    return -sign * horizontal_acceleration(local)[1] / (p.length * cos(p.cord))


def _below_a_tenth() -> Answer:
    """Find the latitude where a bob of l = 1 m hangs furthest from straight down."""

    def angle(latitude: Any) -> Any:
        return degrees(paris().but(length=MP.one, latitude=latitude).case.rest_angle)

    steepest = MP.findroot(lambda latitude: derivative(angle, latitude), 45, tol=1e-40)
    holds = angle(steepest) < MP.mpf("0.1")
    return Answer(holds, f"largest {shown(angle(steepest))}° at latitude {shown(steepest, 8)}°")


def _same_curve() -> Answer:
    latitudes = [MP.mpf(10 * k) for k in range(1, 9)]
    angles = [
        [degrees(paris().but(length=MP.mpf(m), latitude=d).case.rest_angle) for m in (1, 100)]
        for d in latitudes
    ]
    gap = max(abs(a - b) for a, b in angles)
    return Answer(gap < MP.mpf("1e-4"), f"l = 1 m and 100 m differ by at most {shown(gap)}°")


def _south_in_the_north() -> Answer:
    y_at_rest = [rest(paris().but(latitude=MP.mpf(d)))[1] for d in (-60, -20, 20, 60)]
    holds = all((y < 0) == (d > 0) for y, d in zip(y_at_rest, (-60, -20, 20, 60), strict=True))
    return Answer(
        holds,
        f"y at rest at 60° south {shown(y_at_rest[0])} m, at 60° north {shown(y_at_rest[-1])} m",
    )


def _on_the_meridian() -> Answer:
    p = _hanging(paris())
    return Answer(vanishes(horizontal_acceleration(p)), f"x = {shown(p.x)}, y = {shown(p.y)} m")


def _forty_four(p: Point) -> Any:
    zero, _, two = beta_y(p)
    return p.z**2 * (-zero - two * p.rate**2) / (p.z**4 * p.length**2)


@cache
def _derived_series(p: Point) -> Vector:
    """Return the same coefficients from the reference's rest position, an even function of Ω."""

    def angle(rate: Any) -> Any:
        return p.but(rate=rate).case.rest_angle

    return vector(*(derivative(angle, order=power) / MP.factorial(power) for power in (2, 4, 6)))


def _shorter(s: Any) -> Point:
    """Return Paris with a cord s times as long."""
    return paris().but(length=paris().length * s)


def _slower(s: Any) -> Point:
    """Return Paris with RΩ² s times as large, and a cord of negligible length."""
    return paris().faster(s).but(length=MP.mpf("1e-50"))


def _two_terms(p: Point) -> Any:
    out, s, c, g = p.case.outward, sin(p.phi), cos(p.phi), p.gravity
    return s / g * out + c * s / g**2 * out**2


def _vector_sum(p: Point) -> Vector:
    out = p.case.outward
    return vector(0, -out * sin(p.phi), out * cos(p.phi) - p.gravity)


def _section_v() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    return section("mathar_", "Mathar V",
        Statement("44_x", ", before (44)", "at rest x = 0: on the meridian", _on_the_meridian),
        Identity("44_text", ", before (44)", "β_x0 and β_x1 are both proportional to x (vanish at x = 0)",
            lambda p: (beta_x(p.but(x=MP.zero))[0], beta_x(p.but(x=MP.zero))[1]), lambda p: (0, 0),
            "β_x0 and β_x2 are", lambda p: (beta_x(p.but(x=MP.zero))[0], beta_x(p.but(x=MP.zero))[2]),
            remark="β_x1 vanishes at rest for any x; what must vanish with x is β_x2; at x = 0 with a moving bob"),
        Identity("44", "(44)", "y'' = z² (-β_y0 - β_y2 Ω²) / (z⁴ l²) at x = 0, at rest",
            lambda p: _forty_four(_at_rest(p, x=MP.zero)),
            lambda p: horizontal_acceleration(_at_rest(p, x=MP.zero))[1]),
        Identity("45", "(45)", "y² = sqrt(l²-y²) (y - R sinϕ - 2y cos²ϕ) Ω²/g + cosϕ [Ry + (l²-2y²) sinϕ] Ω²/g",
            lambda p: _hanging(p).y ** 2, lambda p: _right_side_of_45(p, _hanging(p).y), "the left side is y",
            lambda p: _hanging(p).y, remark="at the rest position of the reference"),
        Statement("45_degree", "(45)", "a quartic equation for y", _degree_of_45),
        Statement("45_text", ", after (45)", "deviations from the vertical < 0.1°", _below_a_tenth),
        Statement("fig1", ", Fig. 1", "l = 1, 10, 100 m indistinguishable", _same_curve),
        Identity("46_a", "(46), first line", "R̂Ω² (±sinϕ cosφ - cosϕ sinφ) + Ω² (…)(…) + (g/l) sinφ",
            lambda p: tuple(_first_line_of_46(p, sign) for sign in (1, -1)),
            lambda p: tuple(_restoring(p, sign) for sign in (1, -1))),
        Identity("46_b", "(46), second line", "±R̂Ω² sin(ϕ∓φ) ∓ Ω² cos(ϕ∓φ) sin(ϕ∓φ) + (g/l) sinφ = 0",
            lambda p: tuple(line_of_46(p.case, p.cord, sign) for sign in (1, -1)),
            lambda p: tuple(_restoring(p, sign) for sign in (1, -1))),
        Identity("46_root", "(46)", "its root is the rest position",
            lambda p: line_of_46(p.case, p.case.rest_angle), lambda p: 0,
            remark="root: reference.model.force.rest_position"),
        *(Identity(f"47_{power}", f"(47), Ω{mark}", f"Ω{mark}: sin(2ϕ) (N+h-l) {printed}",
            component(lambda p: series(p.case), i), component(_derived_series, i),
            remark="truth: Taylor series of the rest position") for i, (power, mark, printed) in enumerate(SERIES)),
        Statement("47_text", ", after (47)", "the sign of λ is opposite to that of ϕ", _south_in_the_north),
        Approximate("48", "(48)", "g' = sqrt(g² + (RΩ²)² - 2 g RΩ² cosϕ)",
            over(_shorter, lambda p: p.case.apparent_gravity, lambda p: p.case.pull_at_rest), 1, "l", "m/s²",
            remark="N+h stands for the distance of the bob, N+h-l"),
        Identity("49", "(49)", "RΩ² / sinφ = g' / sinϕ",
            lambda p: p.case.outward / sin(p.case.tilt), lambda p: p.case.apparent_gravity / sin(p.phi),
            remark="the sine rule of the triangle of (48), its angle by atan2"),
        Identity("fig2", ", Fig. 2", "g' is the vector sum of g and RΩ², which is parallel to the equatorial plane",
            _vector_sum, lambda p: p.length * vector(*p.k.pull),
            remark="on east, north, up; truth: reference.model.constants"),
        Approximate("50", "(50)", "sinφ = RΩ² sinϕ / sqrt(g² + (RΩ²)² - 2gRΩ² cosϕ)",
            over(_shorter, lambda p: triangle(p.case), lambda p: p.case.rest_angle), 1, "l", "rad"),
        Approximate("50_two", ", after (50)", "sinφ ≈ (sinϕ/g) RΩ² + (cosϕ sinϕ/g²) (RΩ²)² + O((RΩ²)³)",
            over(_slower, _two_terms, lambda p: sin(triangle(p.case))), 3, "RΩ²", "rad"),
        Approximate("50_one", ", after (50)", "sinφ ≈ (1/2) (sin2ϕ/g) (N+h) Ω² + O((RΩ²)²)",
            over(_slower, lambda p: sin(2 * p.phi) / p.gravity * (p.N + p.altitude) * p.rate**2 / 2,
                lambda p: sin(triangle(p.case))), 2, "RΩ²", "rad"),
    )  # fmt: skip


def _swinging(s: Any, rate: Any = MP.zero) -> Point:
    """Return Paris half way through its swing, amplitude and speed s times its own, by default without rotation."""
    base = paris()
    x, y = MP.mpf("0.21") * s, MP.mpf("0.28") * s
    w = sqrt(base.gravity / base.length)
    return base.but(x=x, y=y, vx=w * y / 2, vy=w * x, rate=rate)


def without(item: int) -> Callable[[Point], Vector]:
    """Return a function that gives x'', y'' by (43) without the terms that an item leaves out."""
    items = frozenset({item})

    def accelerations(p: Point) -> Vector:
        (x, y, _), (vx, vy, _) = p.case.n, p.case.v
        return p.length * vector(*derivatives((x, y, vx, vy), truncated(p.k, items), MP, items)[2:])

    return accelerations


def _coriolis(accelerations: Callable[[Point], Vector]) -> Callable[[Point], Vector]:
    """Return the Coriolis part alone, which is linear in Ω."""
    return lambda p: in_rate(lambda rate: accelerations(p.but(rate=rate)), 1)


def _section_vi() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    share = paris().case.outward / paris().gravity
    place = "s × the amplitude of Paris, half way through a swing"
    return section("mathar_", "Mathar VI",
        PrintedNumber("vi_1_size", "item 1", "Ω² is of the order of 5 × 10⁻⁹", "5e-9", lambda: paris().rate ** 2),
        Approximate("vi_1", "item 1", "the terms with Ω² are neglected, being of the order of 5 × 10⁻⁹",
            over(paris().faster, lambda p: p.gravity, lambda p: p.case.pull_at_rest), 1, "Ω²", "m/s²",
            remark=f"pull on the bob at rest; the terms dropped are RΩ²/g = {shown(share, 3)} of g, not Ω²"),
        Approximate("vi_1_order", "item 1", "β_x2 = β_y2 = 0",
            over(lambda s: _swinging(MP.one, paris().rate * s), without(1), solved), 2, "Ω", "m/s²",
            remark="accelerations half way through a swing; bit 2 of the program's -a"),
        Approximate("vi_1_variant", "item 1, variant", "g - RΩ² cosϕ is the first order Taylor expansion of (48)",
            over(paris().faster, lambda p: p.gravity - p.case.outward * cos(p.phi),
                lambda p: p.case.apparent_gravity), 2, "RΩ²", "m/s²"),
        Approximate("vi_2", "item 2", "-yx in (43) set to zero",
            over(_swinging, without(2), solved), 2, "amplitude", remark=f"{place}; bit 1 of the program's -a"),
        Approximate("vi_3", "item 3", "only the terms with g in (33), (39)",
            over(_swinging, without(3), solved), 2, "amplitude", remark=place),
        Approximate("vi_4", "item 4", "only the terms with sinϕ in (34), (40)",
            over(_swinging, _coriolis(without(4)), _coriolis(solved)), 1, "amplitude",
            remark=f"of the Coriolis acceleration; {place}"),
        Approximate("vi_5", "item 5", "z replaced by l",
            # from the diagonal of (43), with g alone
            over(_swinging, lambda p: -p.gravity / p.length * p.position[:2],
                lambda p: -p.gravity * abs(p.z) / p.length**2 * p.position[:2]), 2, "amplitude", remark=place),
        Identity("51", "(51)", "x'' = -x̂ ĝ + 2Ω sinϕ ŷ   (x̂ = x/l, ŷ = y/l, ĝ = g/l)",
            lambda p: -(p.x / p.length) * (p.gravity / p.length) + 2 * p.rate * sin(p.phi) * p.y / p.length,
            lambda p: linearised(p)[0], "hat on x'' and dot on ŷ: x̂'' = -x̂ ĝ + 2Ω sinϕ ŷ'",
            lambda p: p.length * (-p.x / p.length * p.gravity / p.length + 2 * p.rate * sin(p.phi) * p.vy /
                p.length), remark="truth: reference.model.force without centrifugal force, linear"),
        Identity("52", "(52)", "ŷ'' = -ŷ ĝ - 2Ω sinϕ x̂'",
            lambda p: -p.y / p.length * p.gravity / p.length - 2 * p.rate * sin(p.phi) * p.vx / p.length,
            lambda p: linearised(p)[1] / p.length, remark="the text at hand has every hat and dot of this line"),
        Approximate("51_52", "(51), (52)", "an approximation of (43)",
            over(lambda s: _swinging(s, paris().rate), coupled_at, uniform_acceleration), 1, "amplitude",
            remark=f"against gravity alone, all of items 2-5; {place}"),
    )  # fmt: skip


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    return [*_section_v(), *_section_vi()]
