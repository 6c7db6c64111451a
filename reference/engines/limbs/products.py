"""The sums of products in a Taylor series: λ n, and with drag w², of all orders, as the coefficients become known.

An order's sums lack its products with order 0, which the recurrence adds itself, as it needs them at once.
"""

from __future__ import annotations

from .compiling import compiled, inlined
from .lanes import LANES, load, plus_product, spread, store
from .limb import DOUBLED, Array
from .series import AXIAL_SQUARE, TENSION, M, Series, W, X
from .unrolled import MOST_ROWS, PLANES, WIDTH, add_convolved


@inlined
def clear_sums(s: Series, order: int, limb_count: int, drag: bool) -> None:
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


@inlined
def add_squares(s: Series, k: int, first: int, limb_count: int, drag: bool) -> None:
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


@inlined
def add_products(s: Series, k: int, order: int, limb_count: int, drag: bool) -> None:
    """Add to the sums all products of order k with lower orders."""
    c, planes, sums, factors, first, stride = s.c, s.planes, s.sums, s.factors, s.first[k], PLANES * WIDTH
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
        r, at = first + highest + 1, k + j
        if drag:
            _add_axial_squares(planes, factors, sums, first, highest, limb_count, j, at)
        rows = limb_count + 1 - r
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
    """Add the products to rows r and r + 1 of the sums: each limb that is loaded serves both."""
    stride, factor = PLANES * WIDTH, PLANES * LANES * first
    row, plane = r * stride + at, (r - first) * stride + j
    below = row + stride
    x, m, w = load(sums, row), load(sums, row + WIDTH), load(sums, row + 2 * WIDTH)
    x1, m1, w1 = load(sums, below), load(sums, below + WIDTH), load(sums, below + 2 * WIDTH)
    nx, nm, nw = load(planes, plane), load(planes, plane + WIDTH), load(planes, plane + 2 * WIDTH)
    tension = load(planes, plane + 3 * WIDTH)
    for p in range(first, r - highest + 1):
        fx, fm, fw = load(factors, factor), load(factors, factor + LANES), load(factors, factor + 2 * LANES)
        f = load(factors, factor + 3 * LANES)
        x1 = plus_product(plus_product(x1, f, nx), fx, tension)
        m1 = plus_product(plus_product(m1, f, nm), fm, tension)
        w1 = plus_product(plus_product(w1, f, nw), fw, tension)
        if p == r - highest:
            break
        plane -= stride
        nx, nm, nw = load(planes, plane), load(planes, plane + WIDTH), load(planes, plane + 2 * WIDTH)
        tension = load(planes, plane + 3 * WIDTH)
        x = plus_product(plus_product(x, f, nx), fx, tension)
        m = plus_product(plus_product(m, f, nm), fm, tension)
        w = plus_product(plus_product(w, f, nw), fw, tension)
        factor += PLANES * LANES
    store(sums, row, x)
    store(sums, row + WIDTH, m)
    store(sums, row + 2 * WIDTH, w)
    store(sums, below, x1)
    store(sums, below + WIDTH, m1)
    store(sums, below + 2 * WIDTH, w1)


@compiled
def _add_axial_squares(
    planes: Array, factors: Array, sums: Array, first: int, highest: int, limb_count: int, j: int, at: int
) -> None:
    """Do the part of `add_products` for w²."""
    for r in range(first + highest + 1, limb_count + 1):
        row = (r * PLANES + AXIAL_SQUARE) * WIDTH + at
        square = load(sums, row)
        for p in range(first, r - highest):
            axial = load(factors, (PLANES * p + 2) * LANES)
            square = plus_product(square, axial + axial, load(planes, ((r - 1 - p) * PLANES + 2) * WIDTH + j))
        store(sums, row, square)


@inlined
def copy_to_planes(s: Series, k: int, first: int, limb_count: int) -> None:
    """Copy x, m, w, λ of order k to the planes, for the products with higher orders."""
    c, planes = s.c, s.planes
    for q in range(first, limb_count):
        at, plane = LANES * (k * limb_count + q), q * PLANES * WIDTH + k
        planes[plane] = c[at + X]
        planes[plane + WIDTH] = c[at + M]
        planes[plane + 2 * WIDTH] = c[at + W]
        planes[plane + 3 * WIDTH] = c[at + TENSION]
        s.used[q] = k + 1
