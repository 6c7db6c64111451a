"""The Taylor coefficients of a step, eight rows side by side, its length, and the state at its end.

The formulation is `inertial`, V = n' + Ω × n, in the axes of the plumb line at the pivot: x east, p in the meridian,
up along -c; n = (x, p, u - 1) and V = (w - Ω_p, v, s), so that a small swing is small in every number. With C = |c|,

    x' = w - Ω_p u + Ω_u p,         w' = Ω_u v - Ω_p s - λ x,
    p' = v - Ω_u x,                 v' = Ω_u (Ω_p - w) - λ p,
    u' = s + Ω_p x,                 s' = λ - C - Ω_p² + Ω_p w - λ u,       λ' = -C (3 s + Ω_p x),

where λ = V·V + n·c is the tension of the cord: only three products of series an order. Time is in the row's unit, a
power of two in s that stays, so that nothing is scaled anew; the length of a step is a place in its own series.
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
    inlined,
    larger,
    load,
    log2_of,
    magnitude,
    spread,
    store,
)
from .rows import FORM, PULL, TOLERANCE, TURN_P, TURN_U, P, S, U, V, W, X

MOST_ORDER = 24  # even, as two orders are computed at a time
LONGEST = 3.0  # log2 of the longest step in units of time, where nothing changes


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


@inlined
def _next_order(c: LaneSeries, state: Array, k: int, lx: Any, lp: Any, lu: Any) -> None:
    """Write the coefficients of order k + 1 from those of order k and from order k of λ x, λ p, λ u."""
    at, to, share, less = LANES * k, LANES * (k + 1), spread(1.0 / (k + 1)), spread(-1.0 / (k + 1))
    op, ou, pull = (
        load(state, LANES * TURN_P),
        load(state, LANES * TURN_U),
        load(state, LANES * PULL),
    )
    x, p, u = load(c.x, at), load(c.p, at), load(c.u, at)
    w, v, s = load(c.w, at), load(c.v, at), load(c.s, at)
    # what comes last in the chain of dependent operations is added last
    zero = spread(0.0)
    xdot = w + fma(ou * p, zero - op, u)
    udot = fma(s, op, x)
    store(c.xdot, at, xdot)
    store(c.udot, at, udot)
    store(c.x, to, xdot * share)
    store(c.p, to, fma(v, zero - ou, x) * share)
    store(c.u, to, udot * share)
    store(c.tension, to, fma(op * x, s, spread(3.0)) * (less * pull))
    store(c.w, to, (fma(ou * v, zero - op, s) - lx) * share)
    if k == 0:
        # λ less its value at rest, without cancellation
        excess = fma(fma(w * w, v, v), s, s)
        excess = fma(fma(excess, (zero - op) - op, w), zero - pull, u)
        store(c.v, to, (ou * (op - w) - lp) * share)
        store(c.s, to, (fma(excess, op, w) - lu) * share)
    else:
        store(c.v, to, (ou * w + lp) * less)
        store(c.s, to, (fma(load(c.tension, at), op, w) - lu) * share)


@compiled
def taylor_coefficients(c: LaneSeries, state: Array, order: int) -> None:
    """Fill the coefficients from the state and the constants, a row of eight for each of `rows`' columns."""
    for array, column in ((c.x, X), (c.p, P), (c.u, U), (c.w, W), (c.v, V), (c.s, S)):
        store(array, 0, load(state, LANES * column))
    x0, p0, u0, op = load(c.x, 0), load(c.p, 0), load(c.u, 0), load(state, LANES * TURN_P)
    w, v, s = load(c.w, 0) - op, load(c.v, 0), load(c.s, 0)
    l0 = fma(fma(fma(w * w, v, v), s, s), load(state, LANES * PULL), spread(1.0) - u0)
    store(c.tension, 0, l0)
    _next_order(c, state, 0, l0 * x0, l0 * p0, l0 * u0)
    x1, p1, u1, l1 = load(c.x, LANES), load(c.p, LANES), load(c.u, LANES), load(c.tension, LANES)
    _next_order(c, state, 1, fma(l0 * x1, l1, x0), fma(l0 * p1, l1, p0), fma(l0 * u1, l1, u0))
    for k in range(2, order, 2):
        # orders k and k + 1 together: each coefficient that is loaded serves both
        ax = ap = au = bx = bp = bu = spread(0.0)
        after = load(c.tension, LANES * (k - 1))
        for j in range(2, k):
            at = LANES * j
            pull, x, p, u = (
                load(c.tension, LANES * (k - j)),
                load(c.x, at),
                load(c.p, at),
                load(c.u, at),
            )
            ax, ap, au = fma(ax, pull, x), fma(ap, pull, p), fma(au, pull, u)
            bx, bp, bu = fma(bx, after, x), fma(bp, after, p), fma(bu, after, u)
            after = pull
        at = LANES * k
        before, pull = load(c.tension, at - LANES), load(c.tension, at)
        x, p, u = load(c.x, at), load(c.p, at), load(c.u, at)
        ax, ap, au = fma(ax, before, x1), fma(ap, before, p1), fma(au, before, u1)
        ax, ap, au = (
            fma(fma(ax, pull, x0), l0, x),
            fma(fma(ap, pull, p0), l0, p),
            fma(fma(au, pull, u0), l0, u),
        )
        _next_order(c, state, k, ax, ap, au)
        bx, bp, bu = (
            fma(fma(bx, pull, x1), l1, x),
            fma(fma(bp, pull, p1), l1, p),
            fma(fma(bu, pull, u1), l1, u),
        )
        at += LANES
        pull, x, p, u = load(c.tension, at), load(c.x, at), load(c.p, at), load(c.u, at)
        bx, bp, bu = (
            fma(fma(bx, pull, x0), l0, x),
            fma(fma(bp, pull, p0), l0, p),
            fma(fma(bu, pull, u0), l0, u),
        )
        _next_order(c, state, k + 1, bx, bp, bu)


@inlined
def _size(c: LaneSeries, k: int) -> Any:
    return larger(magnitude(load(c.x, LANES * k)), magnitude(load(c.p, LANES * k)))


@inlined
def step_length(c: LaneSeries, order: int) -> Any:
    """Return how far the series reaches: to where its last two coefficients are TOLERANCE of the motion.

    The height u is left out: what its tail lacks is put right when n is put back on the sphere.
    """
    scale, zero = (
        larger(larger(_size(c, 0), _size(c, 1)), _size(c, 2)) * spread(TOLERANCE),
        spread(0.0),
    )
    last = log2_of(_size(c, order) / scale) * spread(1.0 / order)
    other = log2_of(_size(c, order - 1) / scale) * spread(1.0 / (order - 1))
    return exp2_of(zero - larger(larger(last, other), spread(-LONGEST)))


@compiled
def sum_series(state: Array, c: LaneSeries, length: Array, order: int) -> None:
    """Write the state at the end of the step, put back on the sphere."""
    r, zero = load(length, 0), spread(0.0)
    x = p = u = w = v = s = zero
    for k in range(order, -1, -1):
        at = LANES * k
        x, p, u = fma(load(c.x, at), x, r), fma(load(c.p, at), p, r), fma(load(c.u, at), u, r)
        w, v, s = fma(load(c.w, at), w, r), fma(load(c.v, at), v, r), fma(load(c.s, at), s, r)
    half = fma(fma(x * x, p, p), u, u - spread(2.0)) * spread(-0.5)
    x, p, u = fma(x, half, x), fma(p, half, p), fma(u, half, u - spread(1.0))
    down = u - spread(1.0)
    outward = zero - fma(fma((w - load(state, LANES * TURN_P)) * x, v, p), s, down)
    store(state, LANES * X, x)
    store(state, LANES * P, p)
    store(state, LANES * U, u)
    store(state, LANES * W, fma(w, outward, x))
    store(state, LANES * V, fma(v, outward, p))
    store(state, LANES * S, fma(s, outward, down))


@inlined
def _form(state: Array, x: Any, p: Any, u: Any, xdot: Any, pdot: Any, udot: Any) -> Any:
    """Return a·n + b·n'."""
    total = fma(load(state, LANES * FORM) * x, load(state, LANES * (FORM + 1)), p)
    total = fma(
        fma(total, load(state, LANES * (FORM + 2)), u), load(state, LANES * (FORM + 3)), xdot
    )
    return fma(
        fma(total, load(state, LANES * (FORM + 4)), pdot), load(state, LANES * (FORM + 5)), udot
    )


@compiled
def put_form(c: LaneSeries, state: Array, order: int) -> None:
    """Put the coefficients of the rows' forms in the place of those of x'."""
    for k in range(order):
        at = LANES * k
        pdot = load(c.p, at + LANES) * spread(k + 1.0)
        total = _form(
            state,
            load(c.x, at),
            load(c.p, at),
            load(c.u, at),
            load(c.xdot, at),
            pdot,
            load(c.udot, at),
        )
        store(c.xdot, at, total - load(state, LANES * (FORM + 6)) if k == 0 else total)


@inlined
def form_of(state: Array) -> Any:
    """Return the form of a state."""
    x, p, u = load(state, LANES * X), load(state, LANES * P), load(state, LANES * U)
    pdot = load(state, LANES * V) - load(state, LANES * TURN_U) * x
    return _form(state, x, p, u, xdot_of(state), pdot, udot_of(state)) - load(
        state, LANES * (FORM + 6)
    )


@inlined
def xdot_of(state: Array) -> Any:
    """Return x' of a state."""
    turned = fma(load(state, LANES * W), load(state, LANES * TURN_U), load(state, LANES * P))
    return turned - load(state, LANES * TURN_P) * load(state, LANES * U)


@inlined
def udot_of(state: Array) -> Any:
    """Return u' of a state."""
    return fma(load(state, LANES * S), load(state, LANES * TURN_P), load(state, LANES * X))
