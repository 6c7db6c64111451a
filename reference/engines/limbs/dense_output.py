"""The series at a point of its step, in digits, and what a reader wants of it: east, north, up, and rates."""

from __future__ import annotations

import numpy as np

from .lanes import LANES, compiled, load, occupied, plus_product, shuffled, spread, store
from .limb import DOUBLED, RADIX, UNIT, Array, add_product, carry, carry_scalar, clear, divide
from .series import VX, Line, M, Series, partner
from .step import GRAINS, Model, lanewise

_turning = shuffled((0, 1, -1, -1, -1, -1, -1, -1), "_turning")
_rates = shuffled((3, 4, 5, -1, -1, -1, -1, -1), "_rates")
_to_speeds = shuffled((-1, -1, -1, 0, 1, 2, -1, -1), "_to_speeds")
_places = shuffled((0, 1, 2, -1, -1, -1, -1, -1), "_places")
_pull_first = shuffled((6, -1, -1, -1, -1, -1, -1, -1), "_pull_first")
_exchanged = shuffled((-1, 2, 1, -1, 5, 4, -1, -1), "_exchanged")


@compiled
def divide_place(place: Array, whole: int, m: int, limbs: int) -> None:
    """Digits of (whole + place) / m, the place in a step of m grains, from those of place < 1."""
    place[0] += whole * UNIT
    left = 0.0
    for q in range(limbs + 1):
        digit = left * RADIX + place[q]
        quotient = np.rint(digit / m)
        left = digit - quotient * m
        place[q] = quotient
    carry_scalar(place, limbs)


@compiled
def shift_part(to: Array, by: float, limbs: int) -> None:
    """Add a double to a number's digits."""
    left = by * UNIT
    for q in range(limbs):
        digit = np.rint(left)
        to[q] += digit
        left = (left - digit) * RADIX
    carry_scalar(to, limbs - 1)


@compiled
def evaluate(to: Array, s: Series, place: Array, order: int, limbs: int) -> None:
    """All lanes at a place 0 <= s <= 1 of the step, by Horner's rule in as many digits as each order has."""
    work = s.total
    clear(to, limbs + 1)
    low = limbs
    for k in range(order, -1, -1):
        lowest = max(min(low, s.first[k]) - 1, 0)
        for r in range(lowest, limbs + 1):
            total = spread(0.0)
            for q in range(low, r):
                total = plus_product(total, spread(DOUBLED * place[r - 1 - q]), load(to, LANES * q))
            if r < limbs:
                total = total + load(s.c, LANES * (k * limbs + r))
            store(work, LANES * r, total)
        carry(work, lowest, limbs)
        low = lowest
        while low < limbs and not occupied(load(work, LANES * low)):
            low += 1
        for r in range(lowest, limbs):
            store(to, LANES * r, load(work, LANES * r))


@compiled
def slope(s: Series, line: Line, rows: Array, limbs: int) -> None:
    """Xdot times h from all lanes at some place: its digits in `scalar`."""
    for r in range(limbs):
        s.scalar[r] = rows[LANES * r + VX]
    s.scalar[limbs] = 0.0
    for p in range(limbs):
        factor = line.turn[LANES * p]
        for q in range(limbs - p):
            s.scalar[p + q + 1] += factor * rows[LANES * q + M]
    carry_scalar(s.scalar, limbs)


@compiled
def finish(to: Array, start: int, rows: Array, s: Series, line: Line, model: Model, m: int) -> None:
    """From all lanes at some place to x, y, z, their rates and xddot, in l and the unit of time.

    Seven lanes of `limbs` rows from `start` on in `to`. `line` and the length m in grains are those of the step, the
    matrix from the Earth's axes to east, north, up is in `model`.
    """
    limbs, total, rate, other = model.limbs, s.total, s.partners, s.other
    for r in range(limbs):
        store(other, LANES * r, partner(load(rows, LANES * r)))
    clear(total, limbs + 1)
    add_product(total, line.turn, other, 0, limbs)
    for r in range(limbs + 1):
        store(rate, LANES * r, _turning(load(total, LANES * r)))
        s.scalar[r] = total[LANES * r + 3]
    for r in range(limbs):
        store(rate, LANES * r, load(rate, LANES * r) + _rates(load(rows, LANES * r)))
    carry(rate, 0, limbs)
    _second_rate(rows, s, line, model)
    stretch = spread(GRAINS)
    for r in range(limbs):
        store(total, LANES * r, _to_speeds(load(rate, LANES * r)) * stretch)
        total[LANES * r + 6] = s.scalar[r] * GRAINS
    store(total, LANES * limbs, spread(0.0))
    divide(total, 0, limbs, m)
    carry(total, 0, limbs)
    clear(other, limbs + 1)
    for r in range(limbs):
        other[LANES * r + 6] = total[LANES * r + 6] * GRAINS
        total[LANES * r + 6] = 0.0
    divide(other, 0, limbs, m)
    carry(other, 0, limbs)
    for r in range(limbs):
        v = _places(load(rows, LANES * r)) + load(total, LANES * r) + load(other, LANES * r)
        store(rate, LANES * r, v)
        store(other, LANES * r, _exchanged(v))
    lanewise(total, rate, model.along, limbs)
    add_product(total, model.across, other, 0, limbs)
    carry(total, 0, limbs)
    for r in range(limbs):
        store(to, start + LANES * r, load(total, LANES * r))


@compiled
def _second_rate(rows: Array, s: Series, line: Line, model: Model) -> None:
    """Xddot = ω Vm - λ x - γ xdot + ω mdot in `scalar`, which holds ω Vm; the rates are in `partners`."""
    limbs, total, rate, other = model.limbs, s.total, s.partners, s.other
    for r in range(limbs):
        store(other, LANES * r, partner(load(rate, LANES * r)))
    clear(total, limbs + 1)
    add_product(total, line.turn, other, 0, limbs)
    for r in range(limbs + 1):
        s.scalar[r] += total[LANES * r]
    for r in range(limbs):
        store(other, LANES * r, _pull_first(load(rows, LANES * r)))
    lanewise(total, rows, other, limbs)
    for r in range(limbs + 1):
        s.scalar[r] -= total[LANES * r]
    if model.drag:
        for r in range(limbs):
            store(other, LANES * r, _to_speeds(load(rate, LANES * r)))
        clear(total, limbs + 1)
        add_product(total, line.drag, other, 0, limbs)
        for r in range(limbs + 1):
            s.scalar[r] += total[LANES * r + 3]
    carry_scalar(s.scalar, limbs)
