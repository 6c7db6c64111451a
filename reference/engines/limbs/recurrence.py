"""Taylor coefficients of the pendulum's n, V, tension and spin in limbs, by recurrence, order by order.

The formulation is `inertial`, V = n' + Ω × n, in axes of the Earth: w along its axis, x east, m towards the axis' far
side. Time is in steps (h is in every constant below, and coefficients are multiplied by h**k):

    n' = V - Ω × n,    V' = c - Ω × V - λ n - γ n',    λ' = 3 c·V - c·(Ω × n) - 2 γ (λ - c·n - ω j),
    j' = c_m x - γ (j - ω (1 - w²)),

where λ = V·V + n·c is the tension of the cord and j = (n × V)_w. All but λ n (and w², with drag) is linear. Coefficient
k is small as h**k, its leading limbs are zero and are not touched, so that high orders cost little.

The sums of products, λ n and with drag w², are kept of all orders as the coefficients become known. An order's sums
lack its products with order 0, which the recurrence adds itself, as it needs them at once.
"""

from __future__ import annotations

from ...numbers.precision import Array
from ..simd.lanes import (
    LANES,
    at_least,
    compiled,
    inlined,
    load,
    magnitude,
    merged,
    occupied,
    plus_product,
    shuffled,
    spread,
    store,
)
from .limb import DOUBLED, LARGEST, carry_scalar, divide
from .series import (
    PLANES,
    SPIN,
    TENSION,
    VX,
    WIDTH,
    Counts,
    LimbSeries,
    LinearTerms,
    M,
    W,
    X,
    partner,
    to_positions,
    to_speeds,
)

_turned = shuffled((0, 1, -1, 3, 4, -1, 6, 7), "_turned")
_tension_axial = shuffled((-1, -1, -1, -1, -1, -1, 5, -1), "_tension_axial")
_tension_turned = shuffled((-1, -1, -1, -1, -1, -1, 2, -1), "_tension_turned")
_dragged = shuffled((-1, -1, -1, 3, 4, 5, 6, 7), "_dragged")
_dragged_aside = shuffled((-1, -1, -1, 1, 0, -1, 2, -1), "_dragged_aside")
_tension_across = shuffled((-1, -1, -1, -1, -1, -1, 1, -1), "_tension_across")
_tension_spin = shuffled((-1, -1, -1, -1, -1, -1, 7, -1), "_tension_spin")


@merged
def clear_sums(s: LimbSeries, order: int, limb_count: int, drag: bool) -> None:
    """Set the sums and the planes to zero, as far as a series of this order uses them."""
    zero = spread(0.0)
    for row in range(0, limb_count * PLANES * WIDTH, WIDTH):
        for i in range(0, order // 2 + LANES, LANES):
            store(s.planes, row + i, zero)
    for limb in range(0, (limb_count + 1) * PLANES * WIDTH, PLANES * WIDTH):
        for row in range(limb, limb + (PLANES if drag else 3) * WIDTH, WIDTH):
            for i in range(0, order + LANES, LANES):
                store(s.sums, row + i, zero)
    for q in range(limb_count):
        s.used[q] = 0


@merged
def add_squares(s: LimbSeries, k: int, first: int, limb_count: int, drag: bool) -> None:
    """Add the products of a coefficient with itself, or of λ and n of one order, to the sums of order 2 k."""
    c, sums, block = s.c, s.sums, k * limb_count * LANES
    for r in range(2 * first + 1, limb_count + 1):
        total, square = spread(0.0), 0.0
        for q in range(first, r - first):
            a, b = block + LANES * q, block + LANES * (r - 1 - q)
            total = plus_product(total, spread(c[a + TENSION]), load(c, b))
            if drag:
                square += c[a + W] * c[b + W]
        store(s.other, 0, total * spread(DOUBLED))
        at = r * PLANES * WIDTH + 2 * k
        sums[at] += s.other[X]
        sums[at + WIDTH] += s.other[M]
        sums[at + 2 * WIDTH] += s.other[W]
        sums[at + 3 * WIDTH] += DOUBLED * square


@merged
def add_products(s: LimbSeries, k: int, order: int, limb_count: int, drag: bool) -> None:
    """Add to the sums all products of order k with lower orders."""
    c, planes, sums, factors, first = s.c, s.planes, s.sums, s.factors, s.first[k]
    for p in range(first, limb_count):
        limb, row = LANES * (k * limb_count + p), PLANES * LANES * p
        store(factors, row, spread(DOUBLED * c[limb + X]))
        store(factors, row + LANES, spread(DOUBLED * c[limb + M]))
        store(factors, row + 2 * LANES, spread(DOUBLED * c[limb + W]))
        store(factors, row + 3 * LANES, spread(DOUBLED * c[limb + TENSION]))
    highest = 0
    for j in range(0, max(min(k, order - k), 1), LANES):
        while j > 0 and highest < limb_count and s.used[highest] <= j:
            highest += 1
        for r in range(first + highest + 1, limb_count + 1):
            row = r * PLANES * WIDTH + k + j
            x, m, w = load(sums, row), load(sums, row + WIDTH), load(sums, row + 2 * WIDTH)
            square = load(sums, row + 3 * WIDTH)
            for p in range(first, r - highest):
                plane, factor = (r - 1 - p) * PLANES * WIDTH + j, PLANES * LANES * p
                axial, tension = load(planes, plane + 2 * WIDTH), load(planes, plane + 3 * WIDTH)
                fw, f = load(factors, factor + 2 * LANES), load(factors, factor + 3 * LANES)
                x = plus_product(
                    plus_product(x, f, load(planes, plane)), load(factors, factor), tension
                )
                m = plus_product(
                    plus_product(m, f, load(planes, plane + WIDTH)),
                    load(factors, factor + LANES),
                    tension,
                )
                w = plus_product(plus_product(w, f, axial), fw, tension)
                if drag:
                    square = plus_product(square, fw + fw, axial)
            store(sums, row, x)
            store(sums, row + WIDTH, m)
            store(sums, row + 2 * WIDTH, w)
            store(sums, row + 3 * WIDTH, square)


@merged
def copy_to_planes(s: LimbSeries, k: int, first: int, limb_count: int) -> None:
    """Copy x, m, w, λ of order k to the planes, for the products with higher orders."""
    c, planes = s.c, s.planes
    for q in range(first, limb_count):
        at, plane = LANES * (k * limb_count + q), q * PLANES * WIDTH + k
        planes[plane] = c[at + X]
        planes[plane + WIDTH] = c[at + M]
        planes[plane + 2 * WIDTH] = c[at + W]
        planes[plane + 3 * WIDTH] = c[at + TENSION]
        s.used[q] = k + 1


@compiled
def taylor_coefficients(
    s: LimbSeries, terms: LinearTerms, order: int, limb_count: int, drag: bool
) -> bool:
    """Fill the coefficients from those of order 0; return false if one is too large for exact arithmetic.

    Of λ n only the products with order 0 are needed at once; the others of an order are added to the sums while the
    processor waits for the divisions of the next.
    """
    clear_sums(s, order, limb_count, drag)
    if not _note_first_limb(s.c, s.first, 0, 0, limb_count):
        return False
    for k in range(order):
        first = s.first[k]
        _set_derivative(s, terms, k, first, limb_count)
        if drag:
            _add_drag(s, terms, k, first, limb_count)
        low = 0
        while low < limb_count and not occupied(load(s.total, LANES * low)):
            low += 1
        divide(s.total, low, limb_count, k + 1.0)
        block = (k + 1) * limb_count * LANES
        for q in range(limb_count):
            store(s.c, block + LANES * q, load(s.total, LANES * q))
        if not _note_first_limb(s.c, s.first, k + 1, max(low - 1, 0), limb_count):
            return False
        add_products(s, k, order, limb_count, drag)
        if 2 * k < order:
            # last, as a vector that is loaded just after a part of it was stored must wait
            add_squares(s, k, first, limb_count, drag)
            copy_to_planes(s, k, first, limb_count)
    return True


@inlined
def _note_first_limb(c: Array, firsts: Counts, k: int, low: int, limb_count: int) -> bool:
    """Note the first limb of order k that is not zero, from `low` on; return false if a number is too large."""
    block, first = k * limb_count * LANES, low
    while first < limb_count and not occupied(load(c, block + LANES * first)):
        first += 1
    firsts[k] = first
    # 0 also where a lane is not a number
    small = at_least(spread(LARGEST), magnitude(load(c, block)))
    return first > 0 or not occupied(small - spread(1.0))


@merged
def _set_derivative(s: LimbSeries, terms: LinearTerms, k: int, first: int, limb_count: int) -> None:
    """Write the derivative's coefficient of order k, drag left out, to `total`; not carried."""
    c, block, turn, total = s.c, k * limb_count * LANES, terms.turn, s.total
    if k == 1:
        for q in range(limb_count):
            v = load(c, LANES * q)
            store(s.twice, LANES * q, v + v)
    zeroth = s.twice if k else c
    for r in range(limb_count + 1):
        turned, pulled = spread(0.0), spread(0.0)
        for q in range(first, r):
            v, p = load(c, block + LANES * q), LANES * (r - 1 - q)
            turned = plus_product(turned, load(turn, p), partner(v))
            pulled = plus_product(pulled, spread(c[block + LANES * q + TENSION]), load(zeroth, p))
            pulled = plus_product(pulled, spread(zeroth[p + TENSION]), v)
        value = (
            _turned(turned) + (_tension_axial(turned) + _tension_turned(turned)) - to_speeds(pulled)
        )
        if first <= r < limb_count:
            value = value + to_positions(load(c, block + LANES * r))
        if k == 0:
            value = value + load(terms.steady, LANES * r)
        store(total, LANES * r, value)
        for i in range(3):
            total[LANES * r + VX + i] -= s.sums[(r * PLANES + i) * WIDTH + k]


@merged
def _add_drag(s: LimbSeries, terms: LinearTerms, k: int, first: int, limb_count: int) -> None:
    """Add the terms of drag to `total`."""
    c, block, start, stride = s.c, k * limb_count * LANES, 3 * WIDTH + k, PLANES * WIDTH
    weight = 2.0 * DOUBLED if k else DOUBLED
    for r in range(limb_count + 1):
        square = s.sums[start + r * stride]
        for q in range(first, r):
            square += weight * c[block + LANES * q + W] * c[LANES * (r - 1 - q) + W]
        s.scalar[r] = square
    carry_scalar(s.scalar, limb_count)
    for r in range(1, limb_count + 1):
        slowed, pulled, axial = spread(0.0), spread(0.0), 0.0
        for q in range(first, r):
            v, p = load(c, block + LANES * q), LANES * (r - 1 - q)
            slowed = plus_product(slowed, load(terms.drag, p), v)
            pulled = plus_product(pulled, load(terms.drag_tension, p), v)
        for q in range(r):
            axial += terms.drag_axial[LANES * (r - 1 - q)] * s.scalar[q]
        value = load(s.total, LANES * r) + _dragged(slowed) + _dragged_aside(slowed)
        store(s.total, LANES * r, value + (_tension_across(pulled) + _tension_spin(pulled)))
        s.total[LANES * r + SPIN] += axial
