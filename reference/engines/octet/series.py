"""The Taylor coefficients of a step, eight rows side by side, its length, and the state at its end.

The formulation is `inertial`, V = n' + Ω × n, in the axes of the plumb line at the pivot: x east, p
in the meridian, up along -c; n = (x, p, u - 1) and V = (w - Ω_p, v, s), so that a small swing is
small in every number. With C = |c|,

    x' = w - Ω_p u + Ω_u p,         w' = Ω_u v - Ω_p s - λ x,
    p' = v - Ω_u x,                 v' = Ω_u (Ω_p - w) - λ p,
    u' = s + Ω_p x,                 s' = λ - C - Ω_p² + Ω_p w - λ u,       λ' = -C (3 s + Ω_p x),

where λ = V·V + n·c is the tension of the cord: only three products of series an order. Each row
keeps its unit of time, a power of two in s, and the length of a step is a place in its series, so
that coefficients are never rescaled.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ...numbers.precision import Array
from ..simd.lanes import (
    LANES,
    aligned,
    compiled,
    exp2_of,
    fma,
    get_row,
    inlined,
    larger,
    log2_of,
    magnitude,
    set_row,
    spread,
)
from .rows import FORM, PULL, TOLERANCE, TURN_P, TURN_U, P, S, U, V, W, X

MOST_ORDER = 24  # even, as two orders are computed at a time
_LONGEST = 3.0  # log2 of the longest step in units of time, where nothing changes


class LaneSeries(NamedTuple):
    """Coefficients of eight rows: rows of eight doubles, order by order.

    Attributes:
        x, p, u, tension: n in the axes of the plumb line, and λ.
        xdot, udot: of x' and u'; where a section is sought, its form takes the place of x'.
        w, v, s: V.
    """

    x: Array
    p: Array
    u: Array
    tension: Array
    xdot: Array
    udot: Array
    w: Array
    v: Array
    s: Array


def empty_series() -> LaneSeries:
    """Return empty arrays for a series."""
    return LaneSeries(*(aligned((MOST_ORDER + 2) * LANES) for _ in LaneSeries._fields))


class Vector(NamedTuple):
    """Components in the axes of the plumb line: east, in the meridian, up; eight doubles each."""

    x: Any
    p: Any
    u: Any


@inlined
def position(c: LaneSeries, k: int) -> Vector:
    """Return the coefficients of x, p and u of order k."""
    return Vector(get_row(c.x, k), get_row(c.p, k), get_row(c.u, k))


@inlined
def _velocity(c: LaneSeries, k: int) -> Vector:
    """Return the coefficients of w, v and s of order k."""
    return Vector(get_row(c.w, k), get_row(c.v, k), get_row(c.s, k))


@inlined
def plus_multiple(total: Vector, factor: Any, vector: Vector) -> Vector:
    """Return total + factor vector, each component rounded once."""
    return Vector(
        fma(total.x, factor, vector.x),
        fma(total.p, factor, vector.p),
        fma(total.u, factor, vector.u),
    )


@inlined
def _dot(a: Vector, b: Vector) -> Any:
    """Return the scalar product a·b."""
    return fma(fma(a.x * b.x, a.p, b.p), a.u, b.u)


@inlined
def _next_order(c: LaneSeries, state: Array, k: int, pulled: Vector) -> None:
    """Write the coefficients of order k + 1 from those of order k.

    `pulled` is order k of λ x, λ p and λ u.
    """
    # one name for each symbol of the formulas above, one statement for each formula;
    # the last term of the chain of dependent operations is added last
    zero = spread(0.0)
    share = spread(1.0 / (k + 1))
    minus_share = spread(-1.0 / (k + 1))
    turn_p = get_row(state, TURN_P)
    turn_u = get_row(state, TURN_U)
    pull = get_row(state, PULL)
    x = get_row(c.x, k)
    w = get_row(c.w, k)
    v = get_row(c.v, k)
    s = get_row(c.s, k)

    xdot = w + fma(turn_u * get_row(c.p, k), zero - turn_p, get_row(c.u, k))
    udot = fma(s, turn_p, x)
    set_row(c.xdot, k, xdot)
    set_row(c.udot, k, udot)
    set_row(c.x, k + 1, xdot * share)
    set_row(c.p, k + 1, fma(v, zero - turn_u, x) * share)
    set_row(c.u, k + 1, udot * share)

    set_row(c.tension, k + 1, fma(turn_p * x, s, spread(3.0)) * (minus_share * pull))
    set_row(c.w, k + 1, (fma(turn_u * v, zero - turn_p, s) - pulled.x) * share)
    if k == 0:
        # λ - C - Ω_p², without cancellation
        excess = fma(fma(w * w, v, v), s, s)
        excess = fma(fma(excess, (zero - turn_p) - turn_p, w), zero - pull, get_row(c.u, 0))
        set_row(c.v, 1, (turn_u * (turn_p - w) - pulled.p) * share)
        set_row(c.s, 1, (fma(excess, turn_p, w) - pulled.u) * share)
    else:
        set_row(c.v, k + 1, (turn_u * w + pulled.p) * minus_share)
        set_row(c.s, k + 1, (fma(get_row(c.tension, k), turn_p, w) - pulled.u) * share)


@inlined
def _multiple(factor: Any, vector: Vector) -> Vector:
    """Return factor vector."""
    return Vector(factor * vector.x, factor * vector.p, factor * vector.u)


@inlined
def _set_order_zero(c: LaneSeries, state: Array) -> None:
    """Write the coefficients of order 0 from the state."""
    set_row(c.x, 0, get_row(state, X))
    set_row(c.p, 0, get_row(state, P))
    set_row(c.u, 0, get_row(state, U))
    set_row(c.w, 0, get_row(state, W))
    set_row(c.v, 0, get_row(state, V))
    set_row(c.s, 0, get_row(state, S))

    # λ = V·V + C (1 - u)
    inertial = Vector(get_row(c.w, 0) - get_row(state, TURN_P), get_row(c.v, 0), get_row(c.s, 0))
    below_top = spread(1.0) - get_row(c.u, 0)
    set_row(c.tension, 0, fma(_dot(inertial, inertial), get_row(state, PULL), below_top))


@compiled
def taylor_coefficients(c: LaneSeries, state: Array, order: int) -> None:
    """Fill the coefficients from the state and the constants, a row of eight for each of `rows`' columns."""
    _set_order_zero(c, state)
    n0 = position(c, 0)
    tension0 = get_row(c.tension, 0)
    _next_order(c, state, 0, _multiple(tension0, n0))

    n1 = position(c, 1)
    tension1 = get_row(c.tension, 1)
    _next_order(c, state, 1, plus_multiple(_multiple(tension0, n1), tension1, n0))

    zero = spread(0.0)
    for k in range(2, order, 2):
        # orders k and k + 1 of λ n together: each coefficient that is loaded serves both
        pulled = Vector(zero, zero, zero)
        pulled_next = Vector(zero, zero, zero)
        tension_next = get_row(c.tension, k - 1)
        for j in range(2, k):
            n = position(c, j)
            tension = get_row(c.tension, k - j)
            pulled = plus_multiple(pulled, tension, n)
            pulled_next = plus_multiple(pulled_next, tension_next, n)
            tension_next = tension

        # the products with orders 0 and 1
        n = position(c, k)
        tension = get_row(c.tension, k)
        pulled = plus_multiple(pulled, get_row(c.tension, k - 1), n1)
        pulled = plus_multiple(pulled, tension, n0)
        pulled = plus_multiple(pulled, tension0, n)
        _next_order(c, state, k, pulled)

        pulled_next = plus_multiple(pulled_next, tension, n1)
        pulled_next = plus_multiple(pulled_next, tension1, n)
        pulled_next = plus_multiple(pulled_next, get_row(c.tension, k + 1), n0)
        pulled_next = plus_multiple(pulled_next, tension0, position(c, k + 1))
        _next_order(c, state, k + 1, pulled_next)


@inlined
def _size(c: LaneSeries, k: int) -> Any:
    """Return the larger of the coefficients of x and p of order k."""
    return larger(magnitude(get_row(c.x, k)), magnitude(get_row(c.p, k)))


@inlined
def step_length(c: LaneSeries, order: int) -> Any:
    """Return how far the series reaches: to where its last two coefficients are TOLERANCE of the motion.

    The height u is left out: the error of its tail is corrected when n is projected onto the
    sphere.
    """
    scale = larger(larger(_size(c, 0), _size(c, 1)), _size(c, 2)) * spread(TOLERANCE)
    # -log2 of the length by either coefficient, and the larger of the two
    by_last = log2_of(_size(c, order) / scale) * spread(1.0 / order)
    by_last_but_one = log2_of(_size(c, order - 1) / scale) * spread(1.0 / (order - 1))
    inverse = larger(larger(by_last, by_last_but_one), spread(-_LONGEST))
    return exp2_of(spread(0.0) - inverse)


@compiled
def sum_series(state: Array, c: LaneSeries, length: Array, order: int) -> None:
    """Write the state at the end of the step, projected onto the sphere."""
    h = get_row(length, 0)
    zero = spread(0.0)
    n = Vector(zero, zero, zero)
    velocity = Vector(zero, zero, zero)
    for k in range(order, -1, -1):
        n = plus_multiple(position(c, k), h, n)
        velocity = plus_multiple(_velocity(c, k), h, velocity)
    _project(state, n, velocity)


@inlined
def _project(state: Array, n: Vector, velocity: Vector) -> None:
    """Write a state, its n lengthened to 1 and its V without the part along n."""
    half_excess = _dot(n, Vector(n.x, n.p, n.u - spread(2.0))) * spread(-0.5)
    x = fma(n.x, half_excess, n.x)
    p = fma(n.p, half_excess, n.p)
    u = fma(n.u, half_excess, n.u - spread(1.0))
    on_sphere = Vector(x, p, u - spread(1.0))

    inertial = Vector(velocity.x - get_row(state, TURN_P), velocity.p, velocity.u)
    inward = spread(0.0) - _dot(inertial, on_sphere)
    tangent = plus_multiple(velocity, inward, on_sphere)

    set_row(state, X, x)
    set_row(state, P, p)
    set_row(state, U, u)
    set_row(state, W, tangent.x)
    set_row(state, V, tangent.p)
    set_row(state, S, tangent.u)


@inlined
def _form(state: Array, n: Vector, rate: Vector) -> Any:
    """Return a·n + b·n'."""
    a = Vector(get_row(state, FORM), get_row(state, FORM + 1), get_row(state, FORM + 2))
    total = _dot(a, n)
    total = fma(total, get_row(state, FORM + 3), rate.x)
    total = fma(total, get_row(state, FORM + 4), rate.p)
    return fma(total, get_row(state, FORM + 5), rate.u)


@compiled
def put_form(c: LaneSeries, state: Array, order: int) -> None:
    """Put the coefficients of the rows' forms in the place of those of x'."""
    for k in range(order):
        pdot = get_row(c.p, k + 1) * spread(k + 1.0)
        rate = Vector(get_row(c.xdot, k), pdot, get_row(c.udot, k))
        set_row(c.xdot, k, _form(state, position(c, k), rate))
    set_row(c.xdot, 0, get_row(c.xdot, 0) - get_row(state, FORM + 6))


@inlined
def form_of(state: Array) -> Any:
    """Return the form of a state."""
    n = Vector(get_row(state, X), get_row(state, P), get_row(state, U))
    pdot = get_row(state, V) - get_row(state, TURN_U) * n.x
    rate = Vector(xdot_of(state), pdot, udot_of(state))
    return _form(state, n, rate) - get_row(state, FORM + 6)


@inlined
def xdot_of(state: Array) -> Any:
    """Return x' of a state."""
    inertial = fma(get_row(state, W), get_row(state, TURN_U), get_row(state, P))
    return inertial - get_row(state, TURN_P) * get_row(state, U)


@inlined
def udot_of(state: Array) -> Any:
    """Return u' of a state."""
    return fma(get_row(state, S), get_row(state, TURN_P), get_row(state, X))
