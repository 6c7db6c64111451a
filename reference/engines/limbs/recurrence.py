"""Taylor coefficients of the pendulum's n, V, tension and spin in limbs, by recurrence, order by order.

The formulation is `inertial`, V = n' + Ω × n, in axes of the Earth: w along its axis, x east, m
towards the axis' far side. Time is in steps (h is in every constant below, and coefficients are
multiplied by h**k):

    n' = V - Ω × n,    V' = c - Ω × V - λ n - γ n',    λ' = 3 c·V - c·(Ω × n) - 2 γ (λ - c·n - ω j),
    j' = c_m x - γ (j - ω (1 - w²)),

where λ = V·V + n·c is the tension of the cord and j = (n × V)_w. All but λ n (and w², with drag) is
linear. Coefficient k is small as h**k, its leading limbs are zero and are not touched, so that high
orders cost little.

The sums of products, λ n and with drag w², are kept for all orders and added to as coefficients
become known. The products with order 0 are not in the sums: the recurrence needs them at once and
adds them itself.
"""

from __future__ import annotations

from ...numbers.precision import Array
from ..simd.lanes import (
    LANES,
    at_least,
    compiled,
    get_row,
    inlined,
    load,
    magnitude,
    merged,
    occupied,
    plus_product,
    set_row,
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
def _clear_sums(s: LimbSeries, order: int, limb_count: int, drag: bool) -> None:
    """Set the sums and the planes to zero, as far as a series of this order uses them."""
    zero = spread(0.0)
    for row in range(0, limb_count * PLANES * WIDTH, WIDTH):
        for i in range(0, order // 2 + LANES, LANES):
            store(s.planes, row + i, zero)

    sum_count = PLANES if drag else 3
    for limb in range(0, (limb_count + 1) * PLANES * WIDTH, PLANES * WIDTH):
        for row in range(limb, limb + sum_count * WIDTH, WIDTH):
            for i in range(0, order + LANES, LANES):
                store(s.sums, row + i, zero)

    for q in range(limb_count):
        s.used[q] = 0


@merged
def _add_squares(s: LimbSeries, k: int, first: int, limb_count: int, drag: bool) -> None:
    """Add the products of a coefficient with itself, or of λ and n of one order, to the sums of order 2 k."""
    c = s.c
    sums = s.sums
    block = k * limb_count
    for r in range(2 * first + 1, limb_count + 1):
        total = spread(0.0)
        square = 0.0
        for q in range(first, r - first):
            a = block + q
            b = block + r - 1 - q
            total = plus_product(total, spread(c[LANES * a + TENSION]), get_row(c, b))
            if drag:
                square += c[LANES * a + W] * c[LANES * b + W]
        set_row(s.other, 0, total * spread(DOUBLED))

        at = r * PLANES * WIDTH + 2 * k
        sums[at] += s.other[X]
        sums[at + WIDTH] += s.other[M]
        sums[at + 2 * WIDTH] += s.other[W]
        sums[at + 3 * WIDTH] += DOUBLED * square


@merged
def _add_products(s: LimbSeries, k: int, order: int, limb_count: int, drag: bool) -> None:
    """Add to the sums all products of order k with lower orders, eight of them at a time."""
    # the innermost loop of a run: all its values are to stay in registers
    c = s.c
    planes = s.planes
    sums = s.sums
    block = k * limb_count
    first = s.first[k]
    highest = 0  # the first limb that is used by any of the eight lower orders
    for j in range(0, max(min(k, order - k), 1), LANES):
        while j > 0 and highest < limb_count and s.used[highest] <= j:
            highest += 1
        for r in range(first + highest + 1, limb_count + 1):
            row = r * PLANES * WIDTH + k + j
            x = load(sums, row)
            m = load(sums, row + WIDTH)
            w = load(sums, row + 2 * WIDTH)
            square = load(sums, row + 3 * WIDTH)
            for q in range(first, r - highest):
                plane = (r - 1 - q) * PLANES * WIDTH + j
                at = LANES * (block + q)
                axial = load(planes, plane + 2 * WIDTH)
                tension = load(planes, plane + 3 * WIDTH)
                factor_w = spread(c[at + W])
                factor_tension = spread(c[at + TENSION])

                x = plus_product(x, factor_tension, load(planes, plane))
                x = plus_product(x, spread(c[at + X]), tension)
                m = plus_product(m, factor_tension, load(planes, plane + WIDTH))
                m = plus_product(m, spread(c[at + M]), tension)
                w = plus_product(w, factor_tension, axial)
                w = plus_product(w, factor_w, tension)
                if drag:
                    square = plus_product(square, factor_w + factor_w, axial)
            store(sums, row, x)
            store(sums, row + WIDTH, m)
            store(sums, row + 2 * WIDTH, w)
            store(sums, row + 3 * WIDTH, square)


@merged
def _copy_to_planes(s: LimbSeries, k: int, first: int, limb_count: int) -> None:
    """Copy x, m, w, λ of order k, doubled, to the planes, for the products with higher orders."""
    c = s.c
    planes = s.planes
    for q in range(first, limb_count):
        at = LANES * (k * limb_count + q)
        plane = q * PLANES * WIDTH + k
        planes[plane] = DOUBLED * c[at + X]
        planes[plane + WIDTH] = DOUBLED * c[at + M]
        planes[plane + 2 * WIDTH] = DOUBLED * c[at + W]
        planes[plane + 3 * WIDTH] = DOUBLED * c[at + TENSION]
        s.used[q] = k + 1


@compiled
def taylor_coefficients(
    s: LimbSeries, terms: LinearTerms, order: int, limb_count: int, drag: bool
) -> bool:
    """Fill the coefficients from those of order 0.

    Return false if one is too large for exact arithmetic.

    Of λ n only the products with order 0 are needed at once; an order's other products are added to
    the sums while the processor waits for the divisions of the next order.
    """
    _clear_sums(s, order, limb_count, drag)
    if not _note_first_limb(s.c, s.first, 0, 0, limb_count):
        return False
    for k in range(order):
        first = s.first[k]
        _set_derivative(s, terms, k, first, limb_count)
        if drag:
            _add_drag(s, terms, k, first, limb_count)

        # the next coefficient is the derivative's over k + 1
        low = 0
        while low < limb_count and not occupied(get_row(s.total, low)):
            low += 1
        divide(s.total, low, limb_count, k + 1.0)
        for q in range(limb_count):
            set_row(s.c, (k + 1) * limb_count + q, get_row(s.total, q))
        if not _note_first_limb(s.c, s.first, k + 1, max(low - 1, 0), limb_count):
            return False

        _add_products(s, k, order, limb_count, drag)
        if 2 * k < order:
            # last, as a vector that is loaded just after a part of it was stored must wait
            _add_squares(s, k, first, limb_count, drag)
            _copy_to_planes(s, k, first, limb_count)
    return True


@inlined
def _note_first_limb(c: Array, firsts: Counts, k: int, low: int, limb_count: int) -> bool:
    """Write the first limb of order k that is not zero, from `low` on.

    Return false if a number is too large.
    """
    block = k * limb_count
    first = low
    while first < limb_count and not occupied(get_row(c, block + first)):
        first += 1
    firsts[k] = first
    # 0 also where a lane is not a number
    is_small = at_least(spread(LARGEST), magnitude(get_row(c, block)))
    return first > 0 or not occupied(is_small - spread(1.0))


@merged
def _set_derivative(s: LimbSeries, terms: LinearTerms, k: int, first: int, limb_count: int) -> None:
    """Write the derivative's coefficient of order k, without drag, to `total`; not carried."""
    c = s.c
    turn = terms.turn
    total = s.total
    block = k * limb_count
    if k == 1:
        for q in range(limb_count):
            v = get_row(c, q)
            set_row(s.twice, q, v + v)
    zeroth = s.twice if k else c
    for r in range(limb_count + 1):
        turned = spread(0.0)
        pulled = spread(0.0)  # λ n, the products with order 0
        for q in range(first, r):
            v = get_row(c, block + q)
            p = r - 1 - q
            tension = spread(c[LANES * (block + q) + TENSION])
            turned = plus_product(turned, get_row(turn, p), partner(v))
            pulled = plus_product(pulled, tension, get_row(zeroth, p))
            pulled = plus_product(pulled, spread(zeroth[LANES * p + TENSION]), v)

        linear = _turned(turned) + (_tension_axial(turned) + _tension_turned(turned))
        value = linear - to_speeds(pulled)
        if first <= r < limb_count:
            value = value + to_positions(get_row(c, block + r))
        if k == 0:
            value = value + get_row(terms.steady, r)
        set_row(total, r, value)
        for i in range(3):
            total[LANES * r + VX + i] -= s.sums[(r * PLANES + i) * WIDTH + k]


@merged
def _add_drag(s: LimbSeries, terms: LinearTerms, k: int, first: int, limb_count: int) -> None:
    """Add the terms of drag to `total`."""
    _set_axial_square(s, k, first, limb_count)
    block = k * limb_count
    for r in range(1, limb_count + 1):
        slowed = spread(0.0)
        pulled = spread(0.0)
        for q in range(first, r):
            v = get_row(s.c, block + q)
            p = r - 1 - q
            slowed = plus_product(slowed, get_row(terms.drag, p), v)
            pulled = plus_product(pulled, get_row(terms.drag_tension, p), v)
        axial = 0.0
        for q in range(r):
            axial += terms.drag_axial[LANES * (r - 1 - q)] * s.scalar[q]

        value = get_row(s.total, r) + _dragged(slowed) + _dragged_aside(slowed)
        value = value + (_tension_across(pulled) + _tension_spin(pulled))
        set_row(s.total, r, value)
        s.total[LANES * r + SPIN] += axial


@merged
def _set_axial_square(s: LimbSeries, k: int, first: int, limb_count: int) -> None:
    """Write order k of w² to `scalar`: the sums of the higher orders, and the products with order 0."""
    c = s.c
    block = k * limb_count
    weight = 2.0 * DOUBLED if k else DOUBLED
    for r in range(limb_count + 1):
        square = s.sums[(r * PLANES + 3) * WIDTH + k]
        for q in range(first, r):
            square += weight * c[LANES * (block + q) + W] * c[LANES * (r - 1 - q) + W]
        s.scalar[r] = square
    carry_scalar(s.scalar, limb_count)
