"""The state inside a step: all lanes at a place, then x, y, z, vx, vy, vz, ax; and xdot alone, with its sign."""

from __future__ import annotations

import numpy as np

from ...numbers.precision import Array
from ..simd.lanes import (
    LANES,
    compiled,
    get_row,
    merged,
    occupied,
    plus_product,
    set_row,
    shuffled,
    spread,
    store,
)
from .limb import DOUBLED, RADIX, UNIT, add_product, carry, carry_scalar, divide, double_of
from .series import (
    TENSION,
    VM,
    VX,
    LimbSeries,
    M,
    Step,
    X,
    partner,
    positions,
    to_positions,
    to_speeds,
)
from .step import GRAINS, LimbModel, lane_products

_XDDOT = 6  # the lane of xddot beside position and velocity

_turning = shuffled((0, 1, -1, -1, -1, -1, -1, -1), "_turning")
_tension_first = shuffled((6, -1, -1, -1, -1, -1, -1, -1), "_tension_first")
_exchanged = shuffled((-1, 2, 1, -1, 5, 4, -1, -1), "_exchanged")


@compiled
def divide_place(place: Array, whole: int, m: int, limb_count: int) -> None:
    """Turn limbs of a place < 1, in grains, to (whole + place) / m, the place in a step of m grains."""
    place[0] += whole * UNIT
    remainder = 0.0
    for q in range(limb_count + 1):
        limb = remainder * RADIX + place[q]
        quotient = np.rint(limb / m)
        remainder = limb - quotient * m
        place[q] = quotient
    carry_scalar(place, limb_count)


@compiled
def evaluate(to: Array, s: LimbSeries, place: Array, order: int, limb_count: int) -> None:
    """Write all lanes at a place 0 <= s <= 1 of the step, by Horner's rule with as many limbs as each order has."""
    work = s.total
    to[:] = 0.0
    low = limb_count
    for k in range(order, -1, -1):
        lowest = max(min(low, s.first[k]) - 1, 0)
        for r in range(lowest, limb_count + 1):
            total = spread(0.0)
            for q in range(low, r):
                total = plus_product(total, spread(DOUBLED * place[r - 1 - q]), get_row(to, q))
            if r < limb_count:
                total = total + get_row(s.c, k * limb_count + r)
            set_row(work, r, total)
        carry(work, lowest, limb_count)
        low = lowest
        while low < limb_count and not occupied(get_row(work, low)):
            low += 1
        for r in range(lowest, limb_count):
            set_row(to, r, get_row(work, r))


@compiled
def to_cartesian(to: Array, start: int, step: Step, model: LimbModel, m: int) -> None:
    """Turn all lanes in `rows` to x, y, z, their rates and xddot, in l and the unit of time.

    They are written to seven lanes of `limb_count` rows of `to`, from `start` on. The step is m
    grains long; the matrix from the Earth's axes to east, north, up is in `model`.
    """
    total = step.s.total
    state = step.s.partners
    other = step.s.other
    limb_count = model.limb_count
    _set_rates(step, limb_count)
    _set_xddot(step, model)
    _divide_rates(step, m, limb_count)
    for r in range(limb_count):
        position = positions(get_row(step.rows, r))
        v = position + get_row(total, r) + get_row(other, r)
        set_row(state, r, v)
        set_row(other, r, _exchanged(v))

    lane_products(total, state, model.along, limb_count)
    add_product(total, model.across, other, 0, limb_count)
    carry(total, 0, limb_count)
    for r in range(limb_count):
        store(to, start + LANES * r, get_row(total, r))


@merged
def _set_rates(step: Step, limb_count: int) -> None:
    """Write xdot, mdot and wdot, times h, to `partners`, and ω Vm to `scalar`."""
    s = step.s
    rate = s.partners
    for r in range(limb_count):
        set_row(s.other, r, partner(get_row(step.rows, r)))
    s.total[:] = 0.0
    add_product(s.total, step.terms.turn, s.other, 0, limb_count)
    for r in range(limb_count + 1):
        set_row(rate, r, _turning(get_row(s.total, r)))
        s.scalar[r] = s.total[LANES * r + VX]
    for r in range(limb_count):
        set_row(rate, r, get_row(rate, r) + to_positions(get_row(step.rows, r)))
    carry(rate, 0, limb_count)


@merged
def _set_xddot(step: Step, model: LimbModel) -> None:
    """Write xddot = ω Vm - λ x - γ xdot + ω mdot to `scalar`, which holds ω Vm.

    The rates are in `partners`.
    """
    s = step.s
    total = s.total
    rate = s.partners
    other = s.other
    limb_count = model.limb_count
    for r in range(limb_count):
        set_row(other, r, partner(get_row(rate, r)))
    total[:] = 0.0
    add_product(total, step.terms.turn, other, 0, limb_count)
    for r in range(limb_count + 1):
        s.scalar[r] += total[LANES * r]

    for r in range(limb_count):
        set_row(other, r, _tension_first(get_row(step.rows, r)))
    lane_products(total, step.rows, other, limb_count)
    for r in range(limb_count + 1):
        s.scalar[r] -= total[LANES * r]

    if model.drag:
        for r in range(limb_count):
            set_row(other, r, to_speeds(get_row(rate, r)))
        total[:] = 0.0
        add_product(total, step.terms.drag, other, 0, limb_count)
        for r in range(limb_count + 1):
            s.scalar[r] += total[LANES * r + VX]
    carry_scalar(s.scalar, limb_count)


@merged
def _divide_rates(step: Step, m: int, limb_count: int) -> None:
    """Divide the rates by h and xddot by h²: rates in the unit of time in `total`, xddot in a lane of `other`."""
    s = step.s
    total = s.total
    stretch = spread(GRAINS)
    for r in range(limb_count):
        set_row(total, r, to_speeds(get_row(s.partners, r)) * stretch)
        total[LANES * r + _XDDOT] = s.scalar[r] * GRAINS
    set_row(total, limb_count, spread(0.0))
    divide(total, 0, limb_count, m)

    s.other[:] = 0.0
    for r in range(limb_count):
        s.other[LANES * r + _XDDOT] = total[LANES * r + _XDDOT] * GRAINS
        total[LANES * r + _XDDOT] = 0.0
    divide(s.other, 0, limb_count, m)


@compiled
def xdot_of(rows: Array, s: LimbSeries, turn: Array, weight: float, limb_count: int) -> float:
    """Return xdot = Vx + ω m of a state or of all lanes at some place of the step, with the sign that its limbs have.

    `weight` is DOUBLED for the model's `turn` and 1 for a step's, which comes doubled; with this
    xdot is times h.
    """
    for r in range(limb_count):
        s.scalar[r] = rows[LANES * r + VX]
    s.scalar[limb_count] = 0.0
    for p in range(limb_count):
        factor = weight * turn[LANES * p]
        for q in range(limb_count - p):
            s.scalar[p + q + 1] += factor * rows[LANES * q + M]
    carry_scalar(s.scalar, limb_count)
    return double_of(s.scalar, limb_count)


@compiled
def xdot_at(place: Array, step: Step, model: LimbModel) -> float:
    """Return xdot times h at a place of the step, with the sign that its limbs have.

    Write all lanes to `rows`.
    """
    evaluate(step.rows, step.s, place, model.order, model.limb_count)
    return xdot_of(step.rows, step.s, step.terms.turn, 1.0, model.limb_count)


@compiled
def xddot_of(step: Step, xdot: float, model: LimbModel) -> float:
    """Return xddot times h² from all lanes in `rows` and xdot times h, as a double."""
    rows = step.rows
    limb_count = model.limb_count
    turn = double_of(step.terms.turn, limb_count, 0, LANES) / DOUBLED
    x = double_of(rows, limb_count, X, LANES)
    vm = double_of(rows, limb_count, VM, LANES)
    tension = double_of(rows, limb_count, TENSION, LANES)
    value = turn * (2.0 * vm - turn * x) - tension * x
    if model.drag:
        drag = double_of(step.terms.drag, limb_count, VX, LANES) / DOUBLED
        value += drag * xdot
    return value
