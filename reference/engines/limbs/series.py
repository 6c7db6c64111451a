"""A Taylor series in limbs: its lanes and arrays, the constants of its linear terms, its innermost sums written out.

The lanes are x, m, w, Vx, Vm, Vw, λ, j; `recurrence` says what they mean and fills the series. For few limbs a loop
would cost more than its work, so these sums are unrolled. They are triangles: row r gets the products of limbs p and
r - p. The loops of `_convolution` and `_linear` run when numba compiles, once for each number of rows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from llvmlite import ir  # type: ignore[import-untyped]
from numba import types

from .lanes import FUSE, LANES, ZERO, Lanes, address, instruction, shuffled
from .limb import Array, aligned

X, M, W, VX, VM, VW, TENSION, SPIN = range(LANES)
MOST_ROWS = 8  # unrolled; loops do any others
AXIAL_SQUARE = 3  # index of w² among the sums
PLANES, TENSION_PLANE = 4, 3  # x, m, w and the tension λ, each limb's coefficients one after another
WIDTH = 35 * LANES  # from plane to plane, known to the compiler; an odd number of cache lines
MOST_ORDER = WIDTH - 3 * LANES

# lane by lane the factor of `LinearTerms.turn`, m, x, x, Vm, Vx, Vw, Vm, x, and where the products go
PARTNER = (1, 0, 0, 4, 3, 5, 4, 0)
TURNED = ((0, 1, -1, 3, 4, -1, 6, 7), (-1, -1, -1, -1, -1, -1, 5, -1), (-1, -1, -1, -1, -1, -1, 2, -1))
TO_SPEEDS = (-1, -1, -1, 0, 1, 2, -1, -1)

Counts = npt.NDArray[np.int64]

# lane i takes the value of lane order[i], or 0 where that is -1
partner = shuffled(PARTNER, "partner")
positions = shuffled((X, M, W, -1, -1, -1, -1, -1), "positions")
to_positions = shuffled((VX, VM, VW, -1, -1, -1, -1, -1), "to_positions")
to_speeds = shuffled(TO_SPEEDS, "to_speeds")


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


class Series(NamedTuple):
    """Coefficients of one step, and working arrays.

    Attributes:
        c: coefficients, (order + 1) blocks of `limb_count` rows.
        first: per order its first limb that is not zero.
        planes: limb q of x, m, w, λ, each with all orders in a row.
        used: per limb the number of orders in which it may be other than zero.
        sums: limb r of λ x, λ m, λ w and w², each with all orders in a row, not carried.
        factors: the limbs of x, m, w, λ of one order, doubled, each repeated in all eight lanes of a row.
        twice: order 0, doubled.
        total, partners, other, scalar: working arrays.
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


def empty_series(order: int, limb_count: int) -> Series:
    """Return empty arrays for a series of an order, at most MOST_ORDER."""
    if order > MOST_ORDER:
        raise ValueError(f"a series of order {order}, more than {MOST_ORDER}")
    rows = LANES * (limb_count + 2)
    return Series(
        c=aligned((order + 1) * limb_count * LANES),
        first=np.zeros(order + 1, dtype=np.int64),
        planes=aligned(limb_count * PLANES * WIDTH),
        used=np.zeros(limb_count, dtype=np.int64),
        sums=aligned((limb_count + 1) * PLANES * WIDTH),
        factors=aligned(PLANES * rows),
        twice=aligned(rows),
        total=aligned(rows),
        partners=aligned(rows),
        other=aligned(rows),
        scalar=aligned(rows),
    )


_TENSION_LANE = (6,) * LANES
_WHOLE = ir.IntType(64)


class _Code:
    """Writes the code of an instruction whose arguments are flat arrays, each followed by an index."""

    def __init__(self, context: Any, builder: Any, kinds: Sequence[Any], arguments: Sequence[Any]) -> None:
        self.context, self.builder, self.kinds, self.arguments = context, builder, kinds, arguments

    def _place(self, array: int, offset: int) -> Any:
        index = self.builder.add(self.arguments[array + 1], ir.Constant(_WHOLE, offset))
        return address(self.context, self.builder, self.kinds[array], self.arguments[array], index)

    def get(self, array: int, offset: int) -> Any:
        vector = self.builder.load(self._place(array, offset))
        vector.align = 8
        return vector

    def put(self, array: int, offset: int, value: Any) -> None:
        self.builder.store(value, self._place(array, offset)).align = 8

    def fused(self, total: Any, a: Any, b: Any) -> Any:
        return self.builder.fadd(total, self.builder.fmul(a, b, flags=FUSE), flags=FUSE)

    def shuffled(self, vector: Any, order: Sequence[int]) -> Any:
        places = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [i if i >= 0 else LANES for i in order])
        return self.builder.shuffle_vector(vector, ZERO, places)


def _by_rows(write: Callable[[_Code, int], None]) -> Any:
    """Return the generator of an instruction whose first argument is the number of rows to unroll, 0 to MOST_ROWS."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        code = _Code(context, builder, signature.args[1:], arguments[1:])
        after = builder.append_basic_block()
        switch = builder.switch(arguments[0], after)
        for rows in range(1, MOST_ROWS + 1):
            block = builder.append_basic_block()
            switch.add_case(ir.Constant(_WHOLE, rows), block)
            builder.position_at_end(block)
            write(code, rows)
            builder.branch(after)
        builder.position_at_end(after)
        return context.get_dummy_value()

    return generate


@instruction
def add_convolved(_: Any, rows: Any, planes: Any, plane: Any, factors: Any, factor: Any, sums: Any, row: Any) -> Any:
    """Add to rows of the sums of λ n the products of one order's limbs with those of eight others.

    `plane`, `factor` and `row` are indices into `Series.planes`, `factors` and `sums`: of the first limb that counts
    (x of the first of the eight orders), of the one order's first limb, and of the first row's first order. There may
    be no rows at all.
    """
    kinds = (types.intp, planes, types.intp, factors, types.intp, sums, types.intp)
    return types.void(*kinds), _by_rows(_convolution)


def _convolution(code: _Code, rows: int) -> None:
    """Write the code of `add_convolved`, two rows at a time: each limb that is loaded serves both."""
    planes, factors, sums = 0, 2, 4
    for top in range(-(rows % 2), rows, 2):
        pair = [r for r in (top, top + 1) if r >= 0]
        totals = {(r, lane): code.get(sums, (r * PLANES + lane) * WIDTH) for r in pair for lane in range(TENSION_PLANE)}
        for p in range(pair[-1] + 1):
            factor = [code.get(factors, (p * PLANES + lane) * LANES) for lane in range(PLANES)]
            for r in [r for r in pair if r >= p]:
                limb = [code.get(planes, ((r - p) * PLANES + lane) * WIDTH) for lane in range(PLANES)]
                for lane in range(TENSION_PLANE):
                    totals[r, lane] = code.fused(totals[r, lane], factor[TENSION_PLANE], limb[lane])
                    totals[r, lane] = code.fused(totals[r, lane], factor[lane], limb[TENSION_PLANE])
        for (r, lane), total in totals.items():
            code.put(sums, (r * PLANES + lane) * WIDTH, total)


@instruction
def add_linear(_: Any, rows: Any, c: Any, at: Any, n: Any, zero: Any, turn: Any, start: Any, to: Any, row: Any) -> Any:
    """Add to rows of a derivative its linear terms, and those of λ n in which one factor is of order 0.

    `c` are coefficients, `at` is the index of the first limb that counts, of the order in question; `n` those of
    order 0, doubled unless that is the order, from index `zero` on; `turn` is `LinearTerms.turn`, from `start` on.
    There may be no rows at all.
    """
    kinds = (types.intp, c, types.intp, n, types.intp, turn, types.intp, to, types.intp)
    return types.void(*kinds), _by_rows(_linear)


def _linear(code: _Code, rows: int) -> None:
    """Write the code of `add_linear`."""
    c, n, turn, to = 0, 2, 4, 6
    limbs = [code.get(c, q * LANES) for q in range(rows)]
    partners, tensions = ([code.shuffled(v, order) for v in limbs] for order in (PARTNER, _TENSION_LANE))
    steady = [code.get(n, p * LANES) for p in range(rows)]
    steady_tensions = [code.shuffled(v, _TENSION_LANE) for v in steady]
    values = []
    for r in range(rows):
        turned = pulled = other = ZERO
        for p in range(r + 1):
            turned = code.fused(turned, code.get(turn, p * LANES), partners[r - p])
            pulled = code.fused(pulled, tensions[r - p], steady[p])
            other = code.fused(other, steady_tensions[p], limbs[r - p])
        value = code.get(to, r * LANES)
        for order in TURNED:
            value = code.builder.fadd(value, code.shuffled(turned, order))
        values.append(code.builder.fsub(value, code.shuffled(code.builder.fadd(pulled, other), TO_SPEEDS)))
    for r, value in enumerate(values):
        code.put(to, r * LANES, value)


@instruction
def column(_: Any, sums: Any, index: Any) -> Any:
    """Return three sums of one order, a plane apart, from `index` on, in the lanes of V; the other lanes are 0."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        vector = ZERO
        for i in range(TENSION_PLANE):
            place = builder.gep(data, [builder.add(arguments[1], ir.Constant(_WHOLE, i * WIDTH))])
            vector = builder.insert_element(vector, builder.load(place), ir.Constant(ir.IntType(32), TENSION_PLANE + i))
        return vector

    return Lanes(sums, types.intp), generate
