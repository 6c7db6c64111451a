"""The innermost sums of the series with every product written out: of few digits a loop costs more than its work.

They are triangles: row r gets the products of digits p and r - p. The loops here run when numba compiles, once for
each number of rows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import types

from .lanes import FUSE, LANES, VECTOR, Lanes, address, instruction

MOST_ROWS = 8  # written out; where there are more, loops do the rest
PLANES = 4  # x, m, w and the pull, each digit's coefficients one after another
WIDTH = 35 * LANES  # from plane to plane, a number the compiler knows; an odd number of cache lines
MOST_ORDER = WIDTH - 3 * LANES
PULL = 3  # among the planes

# lane by lane what `Line.turn` is multiplied with, m, x, x, Vm, Vx, Vw, Vm, x, and where that goes
PARTNER = (1, 0, 0, 4, 3, 5, 4, 0)
TURNED = ((0, 1, -1, 3, 4, -1, 6, 7), (-1, -1, -1, -1, -1, -1, 5, -1), (-1, -1, -1, -1, -1, -1, 2, -1))
TO_SPEEDS = (-1, -1, -1, 0, 1, 2, -1, -1)

_PULL_LANE = (6,) * LANES
_WHOLE = ir.IntType(64)
_ZERO = ir.Constant(VECTOR, [0.0] * LANES)


class _Code:
    """What an instruction is written with: its arguments are flat arrays, each with an index behind it."""

    def __init__(self, context: Any, builder: Any, kinds: Sequence[Any], given: Sequence[Any]) -> None:
        self.context, self.builder, self.kinds, self.given = context, builder, kinds, given

    def _place(self, array: int, offset: int) -> Any:
        index = self.builder.add(self.given[array + 1], ir.Constant(_WHOLE, offset))
        return address(self.context, self.builder, self.kinds[array], self.given[array], index)

    def get(self, array: int, offset: int) -> Any:
        made = self.builder.load(self._place(array, offset))
        made.align = 8
        return made

    def put(self, array: int, offset: int, value: Any) -> None:
        self.builder.store(value, self._place(array, offset)).align = 8

    def fused(self, total: Any, a: Any, b: Any) -> Any:
        return self.builder.fadd(total, self.builder.fmul(a, b, flags=FUSE), flags=FUSE)

    def shuffled(self, vector: Any, order: Sequence[int]) -> Any:
        places = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [i if i >= 0 else LANES for i in order])
        return self.builder.shuffle_vector(vector, _ZERO, places)


def _by_rows(write: Callable[[_Code, int], None]) -> Any:
    """Code for an instruction whose first argument says how many rows, 0 to MOST_ROWS, are to be written out."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        code = _Code(context, builder, signature.args[1:], given[1:])
        after = builder.append_basic_block()
        switch = builder.switch(given[0], after)
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
    """Add to rows of the sums of λ n the products of one order's digits with those of eight others.

    Of `Series.planes`, `factors` and `sums` come the indices of the first digit that counts (x of the first of the
    eight), of the one order's first digit, and of the first row's first order. There may be no rows at all.
    """
    kinds = (types.intp, planes, types.intp, factors, types.intp, sums, types.intp)
    return types.void(*kinds), _by_rows(_convolution)


def _convolution(code: _Code, rows: int) -> None:
    """Two rows at a time: each digit that is loaded serves both."""
    planes, factors, sums = 0, 2, 4
    for top in range(-(rows % 2), rows, 2):
        pair = [r for r in (top, top + 1) if r >= 0]
        totals = {(r, lane): code.get(sums, (r * PLANES + lane) * WIDTH) for r in pair for lane in range(PULL)}
        for p in range(pair[-1] + 1):
            factor = [code.get(factors, (p * PLANES + lane) * LANES) for lane in range(PLANES)]
            for r in [r for r in pair if r >= p]:
                digit = [code.get(planes, ((r - p) * PLANES + lane) * WIDTH) for lane in range(PLANES)]
                for lane in range(PULL):
                    totals[r, lane] = code.fused(totals[r, lane], factor[PULL], digit[lane])
                    totals[r, lane] = code.fused(totals[r, lane], factor[lane], digit[PULL])
        for (r, lane), total in totals.items():
            code.put(sums, (r * PLANES + lane) * WIDTH, total)


@instruction
def add_linear(_: Any, rows: Any, c: Any, at: Any, n: Any, zero: Any, turn: Any, start: Any, to: Any, row: Any) -> Any:
    """Add to rows of a derivative its linear terms, and those of λ n in which one factor is of order 0.

    `c` are coefficients, `at` is the index of the first digit that counts, of the order in question; `n` those of
    order 0, doubled unless that is the order, from index `zero` on; `turn` is `Line.turn`, from `start` on. There
    may be no rows at all.
    """
    kinds = (types.intp, c, types.intp, n, types.intp, turn, types.intp, to, types.intp)
    return types.void(*kinds), _by_rows(_linear)


def _linear(code: _Code, rows: int) -> None:
    c, n, turn, to = 0, 2, 4, 6
    digits = [code.get(c, q * LANES) for q in range(rows)]
    partners, pulls = ([code.shuffled(v, order) for v in digits] for order in (PARTNER, _PULL_LANE))
    steady = [code.get(n, p * LANES) for p in range(rows)]
    steady_pulls = [code.shuffled(v, _PULL_LANE) for v in steady]
    made = []
    for r in range(rows):
        turned = pulled = other = _ZERO
        for p in range(r + 1):
            turned = code.fused(turned, code.get(turn, p * LANES), partners[r - p])
            pulled = code.fused(pulled, pulls[r - p], steady[p])
            other = code.fused(other, steady_pulls[p], digits[r - p])
        value = code.get(to, r * LANES)
        for order in TURNED:
            value = code.builder.fadd(value, code.shuffled(turned, order))
        made.append(code.builder.fsub(value, code.shuffled(code.builder.fadd(pulled, other), TO_SPEEDS)))
    for r, value in enumerate(made):
        code.put(to, r * LANES, value)


@instruction
def column(_: Any, sums: Any, index: Any) -> Any:
    """Three sums of one order, a plane apart, from `index` on, in the lanes of the velocity; the rest is 0."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, given[0]).data
        made = _ZERO
        for i in range(PULL):
            place = builder.gep(data, [builder.add(given[1], ir.Constant(_WHOLE, i * WIDTH))])
            made = builder.insert_element(made, builder.load(place), ir.Constant(ir.IntType(32), PULL + i))
        return made

    return Lanes(sums, types.intp), generate
