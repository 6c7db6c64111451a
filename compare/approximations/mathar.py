"""Mathar's way from (43) to the harmonic pendulum on a turntable: without one kind of term at a time, then (51)-(52).

Section VI: (43) without an item, integrated numerically. Items 1 and 4 and the variant only change
constants of the model; items 2, 3 and 5 change (43) itself. Lengths are over the cord length,
`depth` is |z|, and g and the terms in R are folded into k.pull as everywhere in the project. All
five items together do not yet give (51)-(52): the diagonal of (43) keeps y² + l² and x² + l². To
drop these squares too is one more step, of the same order, which the paper takes without saying so.

(51)-(52), and section VII's improvements (g', centre, slow-down), are Gastebois' closed solution
6.1 with other constants: gravity g or g', the centre of the swing, and the frequency. In print
(51)-(52) lost hats and dots; dimensions and the limit of (43) leave no doubt about the right form.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from reference import IntegrationError
from reference.model.algebra import Functions, State, dot, minus, plus, product
from reference.model.constants import Constants
from reference.numbers.precision import Array

from .approximation import Motion
from .case import RELEASED_AT_REST, SWINGING, PaperCase, hung, integrated, lowest_point, underneath
from .gastebois import oscillation, turntable_frequency

VARIABLES = ("x", "y", "vx", "vy")
VARIANT = "variant of item 1"
Item = int | str


def derivatives(
    state: State, k: Constants, functions: Functions, items: frozenset[Item] = frozenset()
) -> State:
    """Return the derivatives of x, y, vx and vy by (43), without the terms of items 2, 3 and 5.

    With no item this is `reference.model.formulations.Plane.derivatives`, where powers of z are
    cancelled. It is written again on purpose, with every term multiplied by z⁴ as in the paper: the
    items leave out these terms one by one, and item 5 changes the powers of z themselves. In
    tests/compare/approximations/test_closed_forms.py
    `test_with_nothing_left_out_the_truncated_equations_are_the_model` keeps the two equal.

    Args:
        state: x, y, vx, vy over the cord length.
        k: constants, from which `truncated` has left out items 1 and 4.
        functions: elementary functions of the number type.
        items: items to leave out.
    """
    x, y, vx, vy = state
    depth = 1 if 5 in items else functions.sqrt(1 - x * x - y * y)  # item 5: z becomes l
    cube, fourth = depth * depth * depth, depth * depth * depth * depth
    area = x * vy - y * vx
    # item 3: (33), (39) keep g only
    centripetal = 0 if 3 in items else vx * vx + vy * vy - area * area
    drive = minus(centripetal, product(cube, k.pull[2]))
    _, north, up = k.turn
    _, yy, yz, zz = k.centrifugal
    beta_x = plus(
        product(x, drive),  # (33)
        product(-2, fourth, up, vy),  # (34)
        product(2, y, vy, north, cube),
        product(-1, x, fourth, yy),  # (35)
        product(-1, x, y, cube, yz),
    )
    beta_y = plus(
        product(y, drive),  # (39)
        product(2, fourth, up, vx),  # (40)
        product(-2, y, vx, north, cube),
        product(fourth, minus(product(y, minus(zz, yy)), k.pull[1])),  # (41)
        product(cube, yz, depth * depth - y * y),
    )
    crossed = 0 if 2 in items else x * y  # item 2: no off-diagonal elements -xy
    ax = minus(product(crossed, beta_y), (y * y + depth * depth) * beta_x) / fourth
    ay = minus(product(crossed, beta_x), (x * x + depth * depth) * beta_y) / fourth
    return (vx, vy, minus(ax, product(k.drag, vx)), minus(ay, product(k.drag, vy)))


def truncated(k: Constants, items: frozenset[Item]) -> Constants:
    """Return the constants without the terms that item 1 (or its variant) and item 4 leave out."""
    if 1 in items:
        k = replace(k, pull=(0, 0, product(-1, k.gravity)), centrifugal=(0, 0, 0, 0))
    if VARIANT in items:  # ḡ = g - RΩ² cos φ
        k = replace(k, pull=(0, 0, k.pull[2]), centrifugal=(0, 0, 0, 0))
    if 4 in items:
        k = replace(k, turn=(0, 0, k.turn[2]))
    return k


def _path(case: PaperCase, times: Array, items: frozenset[Item]) -> Array:
    """Integrate (43) without the terms of `items`; return rows x, y, z, vx, vy, vz."""
    start, less = (*case.n[:2], *case.v[:2]), replace(case, k=truncated(case.k, items))
    try:
        states = integrated(VARIABLES, partial(derivatives, items=items), start, less, times)
    except IntegrationError as error:
        raise IntegrationError(
            f"{error} Equation (43) is valid only until the bob reaches the horizontal."
        ) from None
    x, y, vx, vy = (states * float(case.length)).T
    return hung(x, y, vx, vy, case.length)


def _without(*items: Item, **fields: Any) -> Motion:
    """Declare (43) without `items`.

    Where item 1 or its variant is among them, it swings about the vertical.
    """
    names = ", ".join(str(item) for item in items)
    return Motion(
        where=f"Mathar (43), section VI, {'item ' if isinstance(items[0], int) else ''}{names}",
        needs=(partial(underneath, law="(43)"),),
        path=partial(_path, items=frozenset(items)),
        rest=lowest_point if 1 in items or VARIANT in items else None,
        **fields,
    )


def slow_down(case: PaperCase) -> Any:
    """Return 2K/π, the period over the harmonic one.

    K has the modulus sin(φ0/2), φ0 counted from the rest position.
    """
    cosine = dot(case.position, case.rest) / case.length
    return 2 * case.ctx.ellipk((1 - cosine) / 2) / case.ctx.pi


def _harmonic(
    case: PaperCase,
    times: Array,
    apparent: bool = True,
    about_rest: bool = True,
    slowed: bool = False,
) -> Array:
    """Return rows of (51)-(52): ω² = ω0² + (Ω sin φ)², with ω0² = g/l about the vertical as printed.

    Args:
        case: the scene's numbers.
        times: in s.
        apparent: take g' of (48) for g.
        about_rest: swing about the rest position.
        slowed: divide ω by `slow_down`.
    """
    omega = turntable_frequency(
        case, case.apparent_gravity if apparent else case.gravity, case.turn
    )
    omega = omega / slow_down(case) if slowed else omega
    centre = case.ctx.mpf(case.rest[1]) * case.length if about_rest else case.ctx.zero
    place = (case.position[0], case.position[1] - centre)
    z, rate = oscillation(place, case.velocity[:2], omega, case.turn, times)
    return hung(z.real, z.imag + float(centre), rate.real, rate.imag, case.length)


APPROXIMATIONS = (
    _without(
        1,
        id="mathar_item_1",
        title="Mathar's equations without the terms in Ω²",
        drops="β of (35), (41): centrifugal force, tilted plumb line; RΩ² is 2.3e-3 of g, not Ω² = 5e-9 as printed",
    ),
    _without(
        VARIANT,
        id="mathar_item_1_variant",
        title="Mathar's equations without the terms in Ω², gravity less RΩ² cos φ",
        drops="β of (35), (41) apart from the term in R cos φ: the tilt of the plumb line is left out",
    ),
    _without(
        2,
        id="mathar_item_2",
        title="Mathar's equations without the off-diagonal elements -xy",
        drops="the matrix elements -xy of (43)",
    ),
    _without(
        3,
        id="mathar_item_3",
        title="Mathar's equations with gravity alone in β0",
        drops="the velocities in (33), (39): the centripetal pull of the cord",
    ),
    _without(
        4,
        id="mathar_item_4",
        title="Mathar's equations without Ω cos φ",
        drops="the terms with cos φ of (34), (40): the Coriolis force of the north component of Ω",
    ),
    _without(
        5,
        id="mathar_item_5",
        title="Mathar's equations with z replaced by l",
        drops="the change of z along the sphere",
    ),
    _without(
        1, 2,
        id="mathar_items_1_2",
        title="both approximations of the paper's program, foucPend -a 3",
        drops="the terms in Ω² and the off-diagonal elements -xy",
    ),
    _without(
        1, 2, 3, 4, 5,
        id="mathar_items_1_to_5",
        title="Mathar's five items together",
        drops="everything that section VI names; the diagonal of (43) still holds x² + l² and y² + l²",
    ),
    Motion(
        id="linear_g",
        title="harmonic pendulum on a turntable",
        where="Mathar (51)-(52)",
        drops="Ω² (so the tilt and strength of the apparent gravity), all powers of x/l and y/l beyond the first",
        needs=SWINGING,
        path=partial(_harmonic, apparent=False, about_rest=False),
        rest=lowest_point,
    ),
    Motion(
        id="linear_apparent",
        title="harmonic pendulum on a turntable, apparent gravity",
        where="Mathar (51)-(52) with g' of (48), section VII",
        drops="the tilt of the plumb line, the centrifugal gradient, all powers of x/l and y/l beyond the first",
        needs=SWINGING,
        path=partial(_harmonic, about_rest=False),
        rest=lowest_point,
    ),
    Motion(
        id="linear_recentred",
        title="harmonic pendulum on a turntable, about the rest position",
        where="Mathar (51)-(52) with g' of (48), about the point of section V",
        drops="Ω at the tilted latitude (Ω³), the centrifugal gradient (Ω²), the anharmonic slow-down",
        needs=SWINGING,
        path=_harmonic,
    ),
    Motion(
        id="linear_anharmonic",
        title="harmonic pendulum on a turntable, about the rest position, with the slow-down of the plane pendulum",
        where="Mathar section VII, fifth frequency: 2K(sin(φ0/2))/π, where 4K is printed",
        drops="Ω at the tilted latitude (Ω³), the centrifugal gradient (Ω²), the overtones of the swing",
        needs=RELEASED_AT_REST,
        path=partial(_harmonic, slowed=True),
    ),
)  # fmt: skip
