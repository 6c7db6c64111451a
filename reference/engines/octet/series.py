"""The Taylor coefficients of a step, eight rows side by side, and the state at the step's end.

The formulation is `inertial`, V = n' + Ω × n, in the axes of the plumb line at the pivot: x east, p in the meridian,
up along -c; n = (x, p, u - 1) and V = (w - Ω_p, v, s), so that a small swing is small in every number. With C = |c|,

    x' = w - Ω_p u + Ω_u p,         w' = Ω_u v - Ω_p s - λ x,
    p' = v - Ω_u x,                 v' = Ω_u (Ω_p - w) - λ p,
    u' = s + Ω_p x,                 s' = λ - C - Ω_p² + Ω_p w - λ u,       λ' = -C (3 s + Ω_p x),

where λ = V·V + n·c is the tension of the cord: only three products of series an order. Time is in the row's unit, a
power of two in s that stays, so that nothing is scaled anew; the length of a step is a place in its own series.
"""

from __future__ import annotations

from typing import NamedTuple

from ..limbs.lanes import (
    LANES,
    compiled,
    exp2_of,
    inlined,
    larger,
    load,
    log2_of,
    magnitude,
    plus_product,
    spread,
    store,
)
from ..limbs.limb import Array, aligned

MOST_ORDER = 24  # even, as two orders are computed at a time
LONGEST = 3.0  # log2 of the longest step in units of time, where nothing changes


class Series(NamedTuple):
    """Coefficients of eight rows: rows of eight doubles, order by order.

    Attributes:
        x, p, u, tension: n in the axes of the plumb line, and λ.
        xdot, udot: of x' and u'.
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


class Terms(NamedTuple):
    """Constants of eight rows in their units of time: Ω_p, Ω_u, C."""

    turn_p: Array
    turn_u: Array
    pull: Array


class State(NamedTuple):
    """n and V of eight rows, as in the coefficients of order 0."""

    x: Array
    p: Array
    u: Array
    w: Array
    v: Array
    s: Array


def empty_series() -> Series:
    """Return empty arrays for a series."""
    return Series(*(aligned((MOST_ORDER + 2) * LANES) for _ in Series._fields))


@inlined
def _next_order(c: Series, t: Terms, k: int, inverse: float, lx: object, lp: object, lu: object) -> None:
    """Write the coefficients of order k + 1 from those of order k and from order k of λ x, λ p, λ u."""
    at, to, share = LANES * k, LANES * (k + 1), spread(inverse)
    op, ou, pull = load(t.turn_p, 0), load(t.turn_u, 0), load(t.pull, 0)
    x, p, u = load(c.x, at), load(c.p, at), load(c.u, at)
    w, v, s = load(c.w, at), load(c.v, at), load(c.s, at)
    # what comes last in the chain of dependent operations is added last
    none = spread(0.0)
    xdot = w + plus_product(ou * p, none - op, u)
    udot = plus_product(s, op, x)
    store(c.xdot, at, xdot)
    store(c.udot, at, udot)
    store(c.x, to, xdot * share)
    store(c.p, to, plus_product(v, none - ou, x) * share)
    store(c.u, to, udot * share)
    store(c.tension, to, plus_product(op * x, s, spread(3.0)) * (spread(-inverse) * pull))
    store(c.w, to, (plus_product(ou * v, none - op, s) - lx) * share)
    if k == 0:
        # λ less its value at rest, without cancellation
        excess = plus_product(plus_product(w * w, v, v), s, s)
        excess = plus_product(plus_product(excess, (none - op) - op, w), none - pull, u)
        store(c.v, to, (ou * (op - w) - lp) * share)
        store(c.s, to, (plus_product(excess, op, w) - lu) * share)
    else:
        store(c.v, to, (ou * w + lp) * spread(-inverse))
        store(c.s, to, (plus_product(load(c.tension, at), op, w) - lu) * share)


@compiled
def taylor_coefficients(c: Series, now: State, t: Terms, inverses: Array, order: int) -> None:
    """Fill the coefficients from a state; `inverses` are 1, 1/2, 1/3, …"""
    x0, p0, u0 = load(now.x, 0), load(now.p, 0), load(now.u, 0)
    w, v, s, op, pull = load(now.w, 0), load(now.v, 0), load(now.s, 0), load(t.turn_p, 0), load(t.pull, 0)
    store(c.x, 0, x0)
    store(c.p, 0, p0)
    store(c.u, 0, u0)
    store(c.w, 0, w)
    store(c.v, 0, v)
    store(c.s, 0, s)
    q = w - op
    l0 = plus_product(plus_product(plus_product(q * q, v, v), s, s), pull, spread(1.0) - u0)
    store(c.tension, 0, l0)
    _next_order(c, t, 0, inverses[0], l0 * x0, l0 * p0, l0 * u0)
    x1, p1, u1, l1 = load(c.x, LANES), load(c.p, LANES), load(c.u, LANES), load(c.tension, LANES)
    _next_order(
        c,
        t,
        1,
        inverses[1],
        plus_product(l0 * x1, l1, x0),
        plus_product(l0 * p1, l1, p0),
        plus_product(l0 * u1, l1, u0),
    )
    for k in range(2, order, 2):
        # orders k and k + 1 together: each coefficient that is loaded serves both
        ax = ap = au = bx = bp = bu = spread(0.0)
        after = load(c.tension, LANES * (k - 1))
        for j in range(2, k):
            at = LANES * j
            l, x, p, u = load(c.tension, LANES * (k - j)), load(c.x, at), load(c.p, at), load(c.u, at)
            ax, ap, au = plus_product(ax, l, x), plus_product(ap, l, p), plus_product(au, l, u)
            bx, bp, bu = plus_product(bx, after, x), plus_product(bp, after, p), plus_product(bu, after, u)
            after = l
        at = LANES * k
        before, l, x, p, u = (
            load(c.tension, at - LANES),
            load(c.tension, at),
            load(c.x, at),
            load(c.p, at),
            load(c.u, at),
        )
        ax, ap, au = plus_product(ax, before, x1), plus_product(ap, before, p1), plus_product(au, before, u1)
        ax = plus_product(plus_product(ax, l, x0), l0, x)
        ap = plus_product(plus_product(ap, l, p0), l0, p)
        au = plus_product(plus_product(au, l, u0), l0, u)
        _next_order(c, t, k, inverses[k], ax, ap, au)
        bx = plus_product(plus_product(bx, l, x1), l1, x)
        bp = plus_product(plus_product(bp, l, p1), l1, p)
        bu = plus_product(plus_product(bu, l, u1), l1, u)
        at += LANES
        l, x, p, u = load(c.tension, at), load(c.x, at), load(c.p, at), load(c.u, at)
        bx = plus_product(plus_product(bx, l, x0), l0, x)
        bp = plus_product(plus_product(bp, l, p0), l0, p)
        bu = plus_product(plus_product(bu, l, u0), l0, u)
        _next_order(c, t, k + 1, inverses[k + 1], bx, bp, bu)


@inlined
def _size(c: Series, k: int) -> object:
    return larger(magnitude(load(c.x, LANES * k)), magnitude(load(c.p, LANES * k)))


@inlined
def step_length(c: Series, tolerance: float, inverses: Array, order: int) -> object:
    """Return how far the series reaches: to where its last two coefficients are `tolerance` of the motion.

    The height u is left out: what its tail lacks is put right when n is put back on the sphere.
    """
    scale, none = larger(larger(_size(c, 0), _size(c, 1)), _size(c, 2)) * spread(tolerance), spread(0.0)
    last = log2_of(_size(c, order) / scale) * spread(inverses[order - 1])
    other = log2_of(_size(c, order - 1) / scale) * spread(inverses[order - 2])
    return exp2_of(none - larger(larger(last, other), spread(-LONGEST)))


@compiled
def sum_series(now: State, c: Series, t: Terms, length: Array, order: int) -> None:
    """Write the state at the end of the step, put back on the sphere."""
    r, none = load(length, 0), spread(0.0)
    x = p = u = w = v = s = none
    for k in range(order, -1, -1):
        at = LANES * k
        x, p, u = (
            plus_product(load(c.x, at), x, r),
            plus_product(load(c.p, at), p, r),
            plus_product(load(c.u, at), u, r),
        )
        w, v, s = (
            plus_product(load(c.w, at), w, r),
            plus_product(load(c.v, at), v, r),
            plus_product(load(c.s, at), s, r),
        )
    half = plus_product(plus_product(x * x, p, p), u, u - spread(2.0)) * spread(-0.5)
    x, p, u = plus_product(x, half, x), plus_product(p, half, p), plus_product(u, half, u - spread(1.0))
    down = u - spread(1.0)
    outward = none - plus_product(plus_product((w - load(t.turn_p, 0)) * x, v, p), s, down)
    store(now.x, 0, x)
    store(now.p, 0, p)
    store(now.u, 0, u)
    store(now.w, 0, plus_product(w, outward, x))
    store(now.v, 0, plus_product(v, outward, p))
    store(now.s, 0, plus_product(s, outward, down))


@inlined
def xdot_of(now: State, t: Terms) -> object:
    """Return x' of a state."""
    turned = plus_product(load(now.w, 0), load(t.turn_u, 0), load(now.p, 0))
    return turned - load(t.turn_p, 0) * load(now.u, 0)


@inlined
def udot_of(now: State, t: Terms) -> object:
    """Return u' of a state."""
    return plus_product(load(now.s, 0), load(t.turn_p, 0), load(now.x, 0))
