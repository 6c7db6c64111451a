"""The state inside a step: all lanes at a place, then x, y, z, vx, vy, vz, ax; and xdot alone, with its sign."""

from __future__ import annotations

import numpy as np

from ...numbers.precision import Array
from ..simd.lanes import (
    LANES,
    compiled,
    load,
    merged,
    occupied,
    plus_product,
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

_turning = shuffled((0, 1, -1, -1, -1, -1, -1, -1), "_turning")
_tension_first = shuffled((6, -1, -1, -1, -1, -1, -1, -1), "_tension_first")
_exchanged = shuffled((-1, 2, 1, -1, 5, 4, -1, -1), "_exchanged")


@compiled
def divide_place(place: Array, whole: int, m: int, limb_count: int) -> None:
    """Turn limbs of a place < 1, in grains, to (whole + place) / m, the place in a step of m grains."""
    place[0] += whole * UNIT
    left = 0.0
    for q in range(limb_count + 1):
        limb = left * RADIX + place[q]
        quotient = np.rint(limb / m)
        left = limb - quotient * m
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
                total = plus_product(total, spread(DOUBLED * place[r - 1 - q]), load(to, LANES * q))
            if r < limb_count:
                total = total + load(s.c, LANES * (k * limb_count + r))
            store(work, LANES * r, total)
        carry(work, lowest, limb_count)
        low = lowest
        while low < limb_count and not occupied(load(work, LANES * low)):
            low += 1
        for r in range(lowest, limb_count):
            store(to, LANES * r, load(work, LANES * r))


@compiled
def to_cartesian(to: Array, start: int, step: Step, model: LimbModel, m: int) -> None:
    """Turn all lanes in `rows` to x, y, z, their rates and xddot, in l and the unit of time.

    They are written to seven lanes of `limb_count` rows of `to`, from `start` on. The step is m grains long;
    the matrix from the Earth's axes to east, north, up is in `model`.
    """
    (s, terms, rows), limb_count = step, model.limb_count
    total, rate, other = s.total, s.partners, s.other
    for r in range(limb_count):
        store(other, LANES * r, partner(load(rows, LANES * r)))
    total[:] = 0.0
    add_product(total, terms.turn, other, 0, limb_count)
    for r in range(limb_count + 1):
        store(rate, LANES * r, _turning(load(total, LANES * r)))
        s.scalar[r] = total[LANES * r + 3]
    for r in range(limb_count):
        store(rate, LANES * r, load(rate, LANES * r) + to_positions(load(rows, LANES * r)))
    carry(rate, 0, limb_count)
    _xddot(step, model)
    stretch = spread(GRAINS)
    for r in range(limb_count):
        store(total, LANES * r, to_speeds(load(rate, LANES * r)) * stretch)
        total[LANES * r + 6] = s.scalar[r] * GRAINS
    store(total, LANES * limb_count, spread(0.0))
    divide(total, 0, limb_count, m)
    other[:] = 0.0
    for r in range(limb_count):
        other[LANES * r + 6] = total[LANES * r + 6] * GRAINS
        total[LANES * r + 6] = 0.0
    divide(other, 0, limb_count, m)
    for r in range(limb_count):
        v = positions(load(rows, LANES * r)) + load(total, LANES * r) + load(other, LANES * r)
        store(rate, LANES * r, v)
        store(other, LANES * r, _exchanged(v))
    lane_products(total, rate, model.along, limb_count)
    add_product(total, model.across, other, 0, limb_count)
    carry(total, 0, limb_count)
    for r in range(limb_count):
        store(to, start + LANES * r, load(total, LANES * r))


@merged
def _xddot(step: Step, model: LimbModel) -> None:
    """Write xddot = ω Vm - λ x - γ xdot + ω mdot to `scalar`, which holds ω Vm; the rates are in `partners`."""
    (s, terms, rows), limb_count = step, model.limb_count
    total, rate, other = s.total, s.partners, s.other
    for r in range(limb_count):
        store(other, LANES * r, partner(load(rate, LANES * r)))
    total[:] = 0.0
    add_product(total, terms.turn, other, 0, limb_count)
    for r in range(limb_count + 1):
        s.scalar[r] += total[LANES * r]
    for r in range(limb_count):
        store(other, LANES * r, _tension_first(load(rows, LANES * r)))
    lane_products(total, rows, other, limb_count)
    for r in range(limb_count + 1):
        s.scalar[r] -= total[LANES * r]
    if model.drag:
        for r in range(limb_count):
            store(other, LANES * r, to_speeds(load(rate, LANES * r)))
        total[:] = 0.0
        add_product(total, terms.drag, other, 0, limb_count)
        for r in range(limb_count + 1):
            s.scalar[r] += total[LANES * r + 3]
    carry_scalar(s.scalar, limb_count)


@compiled
def xdot_of(rows: Array, s: LimbSeries, turn: Array, weight: float, limb_count: int) -> float:
    """Return xdot = Vx + ω m of a state or of all lanes at some place of the step, with the sign that its limbs have.

    `weight` is DOUBLED for the model's `turn` and 1 for a step's, which comes doubled; with this xdot is times h.
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
    """Return xdot times h at a place of the step, with the sign that its limbs have; write all lanes to `rows`."""
    evaluate(step.rows, step.s, place, model.order, model.limb_count)
    return xdot_of(step.rows, step.s, step.terms.turn, 1.0, model.limb_count)


@compiled
def xddot_of(step: Step, xdot: float, model: LimbModel) -> float:
    """Return xddot times h² from all lanes in `rows` and xdot times h, as a double."""
    (_, terms, rows), limb_count = step, model.limb_count
    turn = double_of(terms.turn, limb_count, 0, LANES) / DOUBLED
    x, vm = double_of(rows, limb_count, X, LANES), double_of(rows, limb_count, VM, LANES)
    tension = double_of(rows, limb_count, TENSION, LANES)
    value = turn * (2.0 * vm - turn * x) - tension * x
    if model.drag:
        value += double_of(terms.drag, limb_count, VX, LANES) / DOUBLED * xdot
    return value
