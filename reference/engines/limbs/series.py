"""Taylor coefficients of the pendulum in digits, order by order.

In axes of the Earth, w along its axis, x east, m towards the axis' far side, with V = n' + Ω × n and time in steps
(h is in every constant below, coefficients come multiplied with h**k):

    n' = V - Ω × n,    V' = A - Ω × V - λ n - γ n',    λ' = 3 A·V - A·(Ω × n) - 2 γ (λ - A·n - ω j),
    j' = A_m x - γ (j - ω (1 - w²)),

where λ = V·V + n·A is the pull of the cord and j = (n × V)_w. All but λ n (and w², with drag) is linear. Coefficient
k is small as h**k, its leading digits are zero and are not touched, so that high orders cost little. The lanes are
x, m, w, Vx, Vm, Vw, λ, j.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .lanes import LANES, compiled, inlined, load, occupied, plus_product, shuffled, spread, store, within
from .limb import DOUBLED, LARGEST, Array, aligned, carry, carry_scalar, divide
from .unrolled import (
    MOST_ORDER,
    MOST_ROWS,
    PARTNER,
    PLANES,
    TO_SPEEDS,
    TURNED,
    WIDTH,
    add_convolved,
    add_linear,
    column,
)

X, M, W, VX, VM, VW, PULL, SPIN = range(LANES)
AXIAL_SQUARE = 3  # the fourth of the sums

Counts = npt.NDArray[np.int64]

# to lane i goes lane order[i]; -1 stands for nothing
_velocity = shuffled((VX, VM, VW, -1, -1, -1, -1, -1), "_velocity")
partner = shuffled(PARTNER, "partner")
to_speeds = shuffled(TO_SPEEDS, "to_speeds")
_turned = shuffled(TURNED[0], "_turned")
_pull_axial = shuffled(TURNED[1], "_pull_axial")
_pull_turned = shuffled(TURNED[2], "_pull_turned")
_dragged = shuffled((-1, -1, -1, 3, 4, 5, 6, 7), "_dragged")
_dragged_aside = shuffled((-1, -1, -1, 1, 0, -1, 2, -1), "_dragged_aside")
_pull_across = shuffled((-1, -1, -1, -1, -1, -1, 1, -1), "_pull_across")
_pull_spin = shuffled((-1, -1, -1, -1, -1, -1, 7, -1), "_pull_spin")


class Line(NamedTuple):
    """Constants of the linear terms, doubled digits in rows, one per lane; made for one step length.

    Attributes:
        turn: ω, -ω, -A_m ω, ω, -ω, 3 A_w, 3 A_m, A_m, times `partner` of the coefficients.
        drag: γω, -γω, 2γ A_w, -γ, -γ, -γ, -2γ, -γ, times the coefficients.
        drag_pull: lanes m and j: 2γ A_m, 2γω.
        drag_axial: lane 0: -γω, times w².
        steady: what does not depend on the state: A, and γω for j; not doubled.
    """

    turn: Array
    drag: Array
    drag_pull: Array
    drag_axial: Array
    steady: Array


class Series(NamedTuple):
    """Coefficients of one step and room to work in.

    Attributes:
        c: coefficients, (order + 1) blocks of `limbs` rows.
        first: per order its first digit that is not zero.
        planes: digit q of x, m, w, λ, each with all orders in a row.
        used: per digit the number of orders in which it may be other than zero.
        sums: digit r of λ x, λ m, λ w and w², each with all orders in a row, not carried.
        factors: the digits of x, m, w, λ of one order, doubled, each a row of eight times the same.
        twice: order 0, doubled.
        total, partners, other, scalar: rows to work in.
    """

    c: Array
    first: Counts
    planes: Array
    used: Counts
    sums: Array
    factors: Array
    twice: Array
    total: Array
    partners: Array
    other: Array
    scalar: Array


def room(order: int, limbs: int) -> Series:
    """Empty arrays for a series of an order, MOST_ORDER at most."""
    if order > MOST_ORDER:
        raise ValueError(f"a series of order {order}, more than {MOST_ORDER}")
    rows = LANES * (limbs + 2)
    return Series(
        c=aligned((order + 1) * limbs * LANES),
        first=np.zeros(order + 1, dtype=np.int64),
        planes=aligned(limbs * PLANES * WIDTH),
        used=np.zeros(limbs, dtype=np.int64),
        sums=aligned((limbs + 1) * PLANES * WIDTH),
        factors=aligned(PLANES * rows),
        twice=aligned(rows),
        total=aligned(rows),
        partners=aligned(rows),
        other=aligned(rows),
        scalar=aligned(rows),
    )


@compiled
def expand(s: Series, line: Line, order: int, limbs: int, drag: bool) -> bool:
    """Fill the coefficients from those of order 0; False if one is too large for exact arithmetic.

    Of λ n only the products with order 0 are wanted at once; the others of an order are added to the sums while the
    processor waits for the divisions of the next.
    """
    _empty(s, order, limbs, drag)
    if not _looked_at(s.c, s.first, 0, 0, limbs):
        return False
    for k in range(order):
        first = s.first[k]
        _derive(s, line, k, first, limbs)
        if drag:
            _slow(s, line, k, first, limbs)
        low = 0
        while low < limbs and not occupied(load(s.total, LANES * low)):
            low += 1
        divide(s.total, low, limbs, k + 1.0)
        low = max(low - 1, 0)
        carry(s.total, low, limbs)
        block = (k + 1) * limbs * LANES
        for q in range(limbs):
            store(s.c, block + LANES * q, load(s.total, LANES * q))
        if not _looked_at(s.c, s.first, k + 1, low, limbs):
            return False
        _convolve(s, k, order, limbs, drag)
        if 2 * k < order:
            # last, as a vector that is loaded just after a part of it was stored must wait
            _double(s, k, first, limbs, drag)
            _enter(s, k, first, limbs)
    return True


@inlined
def _empty(s: Series, order: int, limbs: int, drag: bool) -> None:
    zero = spread(0.0)
    for row in range(0, limbs * PLANES * WIDTH, WIDTH):
        for i in range(0, order // 2 + LANES, LANES):
            store(s.planes, row + i, zero)
    for digit in range(0, (limbs + 1) * PLANES * WIDTH, PLANES * WIDTH):
        for row in range(digit, digit + (PLANES if drag else 3) * WIDTH, WIDTH):
            for i in range(0, order + LANES, LANES):
                store(s.sums, row + i, zero)
    for q in range(limbs):
        s.used[q] = 0


@inlined
def _looked_at(c: Array, firsts: Counts, k: int, low: int, limbs: int) -> bool:
    """Note the first digit of order k, from `low` on; False if a number is too large."""
    block, first = k * limbs * LANES, low
    while first < limbs and not occupied(load(c, block + LANES * first)):
        first += 1
    firsts[k] = first
    return first > 0 or within(load(c, block), LARGEST)


@inlined
def _derive(s: Series, line: Line, k: int, first: int, limbs: int) -> None:
    """The derivative's coefficient of order k in `total`, not carried; all but drag."""
    c, block, turn, total = s.c, k * limbs * LANES, line.turn, s.total
    for r in range(limbs + 1):
        value = spread(0.0) - column(s.sums, r * PLANES * WIDTH + k)
        if first <= r < limbs:
            value = value + _velocity(load(c, block + LANES * r))
        if k == 0:
            value = value + load(line.steady, LANES * r)
        store(total, LANES * r, value)
    if k == 1:
        for q in range(limbs):
            v = load(c, LANES * q)
            store(s.twice, LANES * q, v + v)
    zeroth = s.twice if k else c
    for r in range(first + 1 + MOST_ROWS, limbs + 1):
        turned, pulled = spread(0.0), spread(0.0)
        for q in range(first, r):
            v, p = load(c, block + LANES * q), LANES * (r - 1 - q)
            turned = plus_product(turned, load(turn, p), partner(v))
            pulled = plus_product(pulled, spread(c[block + LANES * q + PULL]), load(zeroth, p))
            pulled = plus_product(pulled, spread(zeroth[p + PULL]), v)
        value = _turned(turned) + (_pull_axial(turned) + _pull_turned(turned)) - to_speeds(pulled)
        store(total, LANES * r, load(total, LANES * r) + value)
    rows = min(limbs - first, MOST_ROWS)
    add_linear(rows, c, block + LANES * first, zeroth, 0, turn, 0, total, LANES * (first + 1))


@compiled
def _slow(s: Series, line: Line, k: int, first: int, limbs: int) -> None:
    """Add the terms of drag to `total`."""
    c, block, start, stride = s.c, k * limbs * LANES, AXIAL_SQUARE * WIDTH + k, PLANES * WIDTH
    weight = 2.0 * DOUBLED if k else DOUBLED
    for r in range(limbs + 1):
        square = s.sums[start + r * stride]
        for q in range(first, r):
            square += weight * c[block + LANES * q + W] * c[LANES * (r - 1 - q) + W]
        s.scalar[r] = square
    carry_scalar(s.scalar, limbs)
    for r in range(1, limbs + 1):
        slowed, pulled, axial = spread(0.0), spread(0.0), 0.0
        for q in range(first, r):
            v, p = load(c, block + LANES * q), LANES * (r - 1 - q)
            slowed = plus_product(slowed, load(line.drag, p), v)
            pulled = plus_product(pulled, load(line.drag_pull, p), v)
        for q in range(r):
            axial += line.drag_axial[LANES * (r - 1 - q)] * s.scalar[q]
        value = load(s.total, LANES * r) + _dragged(slowed) + _dragged_aside(slowed)
        store(s.total, LANES * r, value + (_pull_across(pulled) + _pull_spin(pulled)))
        s.total[LANES * r + SPIN] += axial


@inlined
def _double(s: Series, k: int, first: int, limbs: int, drag: bool) -> None:
    """Add the products of a coefficient with itself, or of λ and n of one order, to the sums of order 2 k."""
    c, sums, block = s.c, s.sums, k * limbs * LANES
    for r in range(2 * first + 1, limbs + 1):
        total, square = spread(0.0), 0.0
        for q in range(first, r - first):
            a, b = block + LANES * q, block + LANES * (r - 1 - q)
            total = plus_product(total, spread(c[a + PULL]), load(c, b))
            if drag:
                square += c[a + W] * c[b + W]
        store(s.other, 0, total * spread(DOUBLED))
        at = r * PLANES * WIDTH + 2 * k
        sums[at] += s.other[X]
        sums[at + WIDTH] += s.other[M]
        sums[at + 2 * WIDTH] += s.other[W]
        sums[at + 3 * WIDTH] += DOUBLED * square


@inlined
def _convolve(s: Series, k: int, order: int, limbs: int, drag: bool) -> None:
    """Add to the sums all products of order k with lower ones."""
    c, planes, sums, factors, first, stride = s.c, s.planes, s.sums, s.factors, s.first[k], PLANES * WIDTH
    for p in range(first, limbs):
        digit, row = LANES * (k * limbs + p), PLANES * LANES * p
        store(factors, row, spread(DOUBLED * c[digit + X]))
        store(factors, row + LANES, spread(DOUBLED * c[digit + M]))
        store(factors, row + 2 * LANES, spread(DOUBLED * c[digit + W]))
        store(factors, row + 3 * LANES, spread(DOUBLED * c[digit + PULL]))
    highest = 0
    for j in range(0, max(min(k, order - k), 1), LANES):
        while j > 0 and highest < limbs and s.used[highest] <= j:
            highest += 1
        r, at = first + highest + 1, k + j
        if drag:
            _convolve_square(planes, factors, sums, first, highest, limbs, j, at)
        rows = limbs + 1 - r
        while rows > MOST_ROWS:
            rows -= 2
            _two_rows(planes, factors, sums, first, highest, r + rows, j, at)
        plane, row = highest * stride + j, r * stride + at
        add_convolved(rows, planes, plane, factors, PLANES * LANES * first, sums, row)


@inlined
def _two_rows(
    planes: Array,
    factors: Array,
    sums: Array,
    first: int,
    highest: int,
    r: int,
    j: int,
    at: int,
) -> None:
    """Rows r and r + 1 of the sums: each digit that is loaded serves both."""
    stride, factor = PLANES * WIDTH, PLANES * LANES * first
    row, plane = r * stride + at, (r - first) * stride + j
    below = row + stride
    x, m, w = load(sums, row), load(sums, row + WIDTH), load(sums, row + 2 * WIDTH)
    x1, m1, w1 = load(sums, below), load(sums, below + WIDTH), load(sums, below + 2 * WIDTH)
    nx, nm, nw = load(planes, plane), load(planes, plane + WIDTH), load(planes, plane + 2 * WIDTH)
    pull = load(planes, plane + 3 * WIDTH)
    for p in range(first, r - highest + 1):
        fx, fm, fw = load(factors, factor), load(factors, factor + LANES), load(factors, factor + 2 * LANES)
        f = load(factors, factor + 3 * LANES)
        x1 = plus_product(plus_product(x1, f, nx), fx, pull)
        m1 = plus_product(plus_product(m1, f, nm), fm, pull)
        w1 = plus_product(plus_product(w1, f, nw), fw, pull)
        if p == r - highest:
            break
        plane -= stride
        nx, nm, nw = load(planes, plane), load(planes, plane + WIDTH), load(planes, plane + 2 * WIDTH)
        pull = load(planes, plane + 3 * WIDTH)
        x = plus_product(plus_product(x, f, nx), fx, pull)
        m = plus_product(plus_product(m, f, nm), fm, pull)
        w = plus_product(plus_product(w, f, nw), fw, pull)
        factor += PLANES * LANES
    store(sums, row, x)
    store(sums, row + WIDTH, m)
    store(sums, row + 2 * WIDTH, w)
    store(sums, below, x1)
    store(sums, below + WIDTH, m1)
    store(sums, below + 2 * WIDTH, w1)


@compiled
def _convolve_square(
    planes: Array, factors: Array, sums: Array, first: int, highest: int, limbs: int, j: int, at: int
) -> None:
    """The part of `_convolve` for w²."""
    for r in range(first + highest + 1, limbs + 1):
        row = (r * PLANES + AXIAL_SQUARE) * WIDTH + at
        square = load(sums, row)
        for p in range(first, r - highest):
            axial = load(factors, (PLANES * p + 2) * LANES)
            square = plus_product(square, axial + axial, load(planes, ((r - 1 - p) * PLANES + 2) * WIDTH + j))
        store(sums, row, square)


@inlined
def _enter(s: Series, k: int, first: int, limbs: int) -> None:
    """Copy x, m, w, λ of order k to the planes, from where higher orders take them."""
    c, planes = s.c, s.planes
    for q in range(first, limbs):
        at, plane = LANES * (k * limbs + q), q * PLANES * WIDTH + k
        planes[plane] = c[at + X]
        planes[plane + WIDTH] = c[at + M]
        planes[plane + 2 * WIDTH] = c[at + W]
        planes[plane + 3 * WIDTH] = c[at + PULL]
        s.used[q] = k + 1
