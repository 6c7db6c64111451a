"""A Taylor series in limbs: its lanes and arrays, and the constants of its linear terms.

The lanes are x, m, w, Vx, Vm, Vw, λ, j; `recurrence` says what they mean and fills the series.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...numbers.precision import Array
from ..simd.lanes import LANES, aligned, shuffled

X, M, W, VX, VM, VW, TENSION, SPIN = range(LANES)
# x, m, w and the tension λ, each limb's coefficients one after another; those of sums are λ x, λ m,
# λ w, w²
PLANES = 4
WIDTH = 35 * LANES  # from plane to plane, known to the compiler; an odd number of cache lines
MOST_ORDER = WIDTH - 3 * LANES

Counts = npt.NDArray[np.int64]

# lane i takes the value of lane order[i], or 0 where that is -1
# of `LinearTerms.turn`: m, x, x, Vm, Vx, Vw, Vm, x
partner = shuffled((1, 0, 0, 4, 3, 5, 4, 0), "partner")
positions = shuffled((X, M, W, -1, -1, -1, -1, -1), "positions")
to_positions = shuffled((VX, VM, VW, -1, -1, -1, -1, -1), "to_positions")
to_speeds = shuffled((-1, -1, -1, 0, 1, 2, -1, -1), "to_speeds")


class LinearTerms(NamedTuple):
    """Constants of the linear terms for one step length: one per lane, its limbs doubled, in rows.

    Attributes:
        turn: ω, -ω, -c_m ω, ω, -ω, 3 c_w, 3 c_m, c_m, times `partner` of the coefficients.
        drag: γω, -γω, 2γ c_w, -γ, -γ, -γ, -2γ, -γ, times the coefficients.
        drag_tension: lanes m and j: 2γ c_m, 2γω.
        drag_axial: lane 0: -γω, times w².
        steady: the constant terms: c, and γω for j; not doubled.
    """

    turn: Array
    drag: Array
    drag_tension: Array
    drag_axial: Array
    steady: Array


class LimbSeries(NamedTuple):
    """Coefficients of one step, and working arrays.

    Attributes:
        c: coefficients, (order + 1) blocks of `limb_count` rows.
        first: per order its first limb that is not zero.
        planes: limb q of x, m, w, λ, doubled, each with all orders in a row.
        used: per limb the number of orders in which it may be other than zero.
        sums: limb r of λ x, λ m, λ w and w², each with all orders in a row, not carried.
        twice: order 0, doubled.
        total, partners, other, scalar: working arrays.
    """

    c: Array
    first: Counts
    planes: Array
    used: Counts
    sums: Array
    twice: Array
    total: Array
    partners: Array
    other: Array
    scalar: Array


class Step(NamedTuple):
    """A step: its series, its linear terms, and `rows`, to which all lanes at some place in it are written."""

    s: LimbSeries
    terms: LinearTerms
    rows: Array


def empty_series(order: int, limb_count: int) -> LimbSeries:
    """Return empty arrays for a series of an order, at most MOST_ORDER."""
    if order > MOST_ORDER:
        raise ValueError(f"a series of order {order}, more than {MOST_ORDER}")
    rows = LANES * (limb_count + 2)
    return LimbSeries(
        c=aligned((order + 1) * limb_count * LANES),
        first=np.zeros(order + 1, dtype=np.int64),
        planes=aligned(limb_count * PLANES * WIDTH),
        used=np.zeros(limb_count, dtype=np.int64),
        sums=aligned((limb_count + 1) * PLANES * WIDTH),
        twice=aligned(rows),
        total=aligned(rows),
        partners=aligned(rows),
        other=aligned(rows),
        scalar=aligned(rows),
    )
