"""Mathar, section VI: the terms dropped on the way to the harmonic equations (51)-(52), and the errors that causes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ...approximations.mathar import derivatives, truncated
from ..checks import Approximate, Check, Identity, PrintedNumber, section
from ..digits import MP, Vector, cos, shown, sin, sqrt, vector
from ..first_principles import coupled_at, in_rate, linearised, uniform_acceleration
from ..points import Point, paris
from .lagrangian import solved


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


def _depth_is_length(p: Point) -> Vector:
    """Return x'', y'' of item 5, in the term with g: z replaced by l."""
    return -p.gravity / p.length * p.position[:2]


def _dropped(item: int) -> Callable[[Any], tuple[Vector, Vector]]:
    """Return print and truth at an amplitude s times that of Paris, without rotation."""
    return lambda s: (without(item)(_swinging(s)), solved(_swinging(s)))


def _sizes_at_rate(s: Any) -> tuple[Vector, Vector]:
    p = _swinging(MP.one, paris().rate * s)
    return without(1)(p), solved(p)


def _printed_gravity(s: Any) -> tuple[Any, Any]:
    p = paris().faster(s)
    return p.gravity - p.case.outward * cos(p.phi), p.case.apparent_gravity


def _no_centrifugal_force(s: Any) -> tuple[Any, Any]:
    p = paris().faster(s)
    return p.gravity, p.case.pull_at_rest


def _cosine(s: Any) -> tuple[Vector, Vector]:
    """Return print and truth of the Coriolis part alone, which is linear in Ω."""
    p = _swinging(s)

    def linear(function: Callable[[Point], Vector], i: int) -> Any:
        return in_rate(lambda rate: function(p.but(rate=rate))[i], 1)

    printed, true = (tuple(linear(function, i) for i in (0, 1)) for function in (without(4), solved))
    return printed, true


def _whole(s: Any) -> tuple[Vector, Vector]:
    p = _swinging(s, paris().rate)
    return coupled_at(p), uniform_acceleration(p)


def _pulled(p: Point) -> Vector:
    """Return x'', y'' from which item 5 starts: the diagonal of (43), with g alone."""
    return -p.gravity * abs(p.z) / p.length**2 * p.position[:2]


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    share = paris().case.outward / paris().gravity
    place = "s × the amplitude of Paris, half way through a swing"
    return section("mathar_", "Mathar VI",
        PrintedNumber("vi_1_size", "item 1", "Ω² is of the order of 5 × 10⁻⁹", "5e-9", lambda: paris().rate ** 2),
        Approximate("vi_1", "item 1", "the terms with Ω² are neglected, being of the order of 5 × 10⁻⁹",
            _no_centrifugal_force, 1, "Ω²", "m/s²",
            remark=f"pull on the bob at rest; the terms dropped are RΩ²/g = {shown(share, 3)} of g, not Ω²"),
        Approximate("vi_1_order", "item 1", "β_x2 = β_y2 = 0",
            _sizes_at_rate, 2, "Ω", "m/s²", remark="accelerations half way through a swing; bit 2 of the program's -a"),
        Approximate("vi_1_variant", "item 1, variant", "g - RΩ² cosϕ is the first order Taylor expansion of (48)",
            _printed_gravity, 2, "RΩ²", "m/s²"),
        Approximate("vi_2", "item 2", "-yx in (43) set to zero",
            _dropped(2), 2, "amplitude", remark=f"{place}; bit 1 of the program's -a"),
        Approximate("vi_3", "item 3", "only the terms with g in (33), (39)",
            _dropped(3), 2, "amplitude", remark=place),
        Approximate("vi_4", "item 4", "only the terms with sinϕ in (34), (40)",
            _cosine, 1, "amplitude", remark=f"of the Coriolis acceleration; {place}"),
        Approximate("vi_5", "item 5", "z replaced by l",
            lambda s: (_depth_is_length(_swinging(s)), _pulled(_swinging(s))), 2, "amplitude", remark=place),
        Identity("51", "(51)", "x'' = -x̂ ĝ + 2Ω sinϕ ŷ   (x̂ = x/l, ŷ = y/l, ĝ = g/l)",
            lambda p: -(p.x / p.length) * (p.gravity / p.length) + 2 * p.rate * sin(p.phi) * p.y / p.length,
            lambda p: linearised(p)[0], "hat on x'' and dot on ŷ: x̂'' = -x̂ ĝ + 2Ω sinϕ ŷ'",
            lambda p: p.length * (-p.x / p.length * p.gravity / p.length + 2 * p.rate * sin(p.phi) * p.vy /
                p.length), remark="truth: reference.model.force without centrifugal force, linear"),
        Identity("52", "(52)", "ŷ'' = -ŷ ĝ - 2Ω sinϕ x̂'",
            lambda p: -p.y / p.length * p.gravity / p.length - 2 * p.rate * sin(p.phi) * p.vx / p.length,
            lambda p: linearised(p)[1] / p.length, remark="the text at hand has every hat and dot of this line"),
        Approximate("51_52", "(51), (52)", "an approximation of (43)",
            _whole, 1, "amplitude", remark=f"against gravity alone, all of items 2-5; {place}"),
    )  # fmt: skip
