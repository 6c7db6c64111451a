"""How functions are compiled, and SIMD lanes: eight doubles side by side, in any machine's vector registers.

No option allows arithmetic to be rearranged, and the bits are the same with and without FMA, on
every machine. In limbs sums and products are exact, so it makes no difference whether the compiler
fuses them (`plus_product`); in octet each is rounded once (`fma`).

numba optimises a function by itself, then again in each of its callers, in their callers and so on.
So a large function with a single caller is `merged` into it: compiling takes a third less. An array
is passed as seven numbers: a function that takes many arrays and is called at every step has to be
`inlined`, or the call is most of the work.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import partial, wraps
from typing import Any, TypeVar

import numba.extending
import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba import njit, types
from numba.core import cgutils

from ...numbers.precision import Array

Function = TypeVar("Function", bound=Callable[..., Any])

# no reference counting: arrays come from the caller
OPTIONS: dict[str, Any] = {"error_model": "numpy", "_nrt": False}
_CALLEE = OPTIONS | {"no_cfunc_wrapper": True}  # not called from C


def compiled(function: Function) -> Function:
    """Compile with numba, to be called from compiled functions."""
    callee: Function = numba.extending.register_jitable(**_CALLEE)(function)
    return callee


def inlined(function: Function) -> Function:
    """Compile into its callers: for small parts of innermost loops, where a call would cost more than the work."""
    callee: Function = numba.extending.register_jitable(forceinline=True, **_CALLEE)(function)
    return callee


def merged(function: Function) -> Function:
    """Copy into the caller before anything is compiled: for large functions that are called at one place."""
    callee: Function = njit(inline="always", **OPTIONS)(function)
    return callee


LANES = 8
_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_ZERO = ir.Constant(_VECTOR, [0.0] * LANES)
_FUSE = ("contract",)
_extending: Any = numba.extending  # untyped
_insert: Any = cgutils.get_or_insert_function
_Type: Any = types.Type


def aligned(count: int) -> Array:
    """Return zeros that start on a cache line, so that each row fills one."""
    room = np.zeros(count + LANES)
    start = -room.ctypes.data // room.itemsize % LANES
    return room[start : start + count]


class _Lanes(_Type):  # type: ignore[misc]
    """The type of eight doubles."""


Lanes: Any = _Lanes(name="Lanes")


@_extending.register_model(_Lanes)
class _Model(_extending.models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, lanes_type: Any) -> None:
        super().__init__(manager, lanes_type, _VECTOR)


def _instruction(generator: Any) -> Any:
    """Register a generator of LLVM instructions as a compiled function; untyped for a type checker."""
    return _extending.intrinsic(generator)


_BLANK = ir.Constant(_VECTOR, ir.Undefined)
_FIRST = ir.Constant(ir.IntType(32), 0)
_EVERYWHERE = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)


def _by_name(builder: Any, name: str, *vectors: Any) -> Any:
    """Return the call of LLVM's function of this name with vectors."""
    function = _insert(
        builder.module,
        ir.FunctionType(_VECTOR, [_VECTOR] * len(vectors)),
        f"llvm.{name}.v{LANES}f64",
    )
    return builder.call(function, vectors)


def _address(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    """Return the pointer to eight elements of a flat array, from `index` on."""
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), _VECTOR.as_pointer())


def _load(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    """Return the instruction that loads eight elements of a flat array, from `index` on."""
    vector = builder.load(_address(context, builder, array_type, array, index))
    vector.align = 8
    return vector


def _store(context: Any, builder: Any, array_type: Any, array: Any, index: Any, value: Any) -> None:
    """Add the instruction that stores eight elements of a flat array, from `index` on."""
    write = builder.store(value, _address(context, builder, array_type, array, index))
    write.align = 8


def _lanewise(write: Callable[..., Any], taken: Any = Lanes, result: Any = Lanes) -> Any:
    """Register `write(builder, *vectors)`, which returns eight doubles, as a compiled function.

    Args:
        write: generates the instructions.
        taken: the type of its arguments, if not eight doubles.
        result: the type of its result, likewise.
    """

    @wraps(write)
    def typed(_: Any, *vectors: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return write(builder, *arguments)

        return result(*[taken] * len(vectors)), generate

    return _instruction(typed)


@_instruction
def load(_: Any, array: Any, index: Any) -> Any:
    """Return eight elements of a flat array from `index` on."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _load(context, builder, signature.args[0], *arguments)

    return Lanes(array, types.intp), generate


@_instruction
def store(_: Any, array: Any, index: Any, value: Any) -> Any:
    """Write eight elements of a flat array from `index` on."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        _store(context, builder, signature.args[0], *arguments)
        return context.get_dummy_value()

    return types.void(array, types.intp, Lanes), generate


@_instruction
def get_row(_: Any, array: Any, row: Any) -> Any:
    """Return a row of eight elements of a flat array: those from `LANES * row` on."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        rows, row = arguments
        return _load(context, builder, signature.args[0], rows, _first_of(builder, row))

    return Lanes(array, types.intp), generate


@_instruction
def set_row(_: Any, array: Any, row: Any, value: Any) -> Any:
    """Write a row of eight elements of a flat array: those from `LANES * row` on."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        rows, row, vector = arguments
        _store(context, builder, signature.args[0], rows, _first_of(builder, row), vector)
        return context.get_dummy_value()

    return types.void(array, types.intp, Lanes), generate


def _first_of(builder: Any, row: Any) -> Any:
    """Return the index of a row's first element."""
    return builder.mul(row, ir.Constant(row.type, LANES))


@partial(_lanewise, taken=types.float64)
def spread(builder: Any, value: Any) -> Any:
    """Return the same double in every lane."""
    return builder.shuffle_vector(
        builder.insert_element(_BLANK, value, _FIRST), _BLANK, _EVERYWHERE
    )


@_lanewise
def plus_product(builder: Any, total: Any, a: Any, b: Any) -> Any:
    """Return total + a b in each lane, where both operations are exact: the compiler may fuse them."""
    return builder.fadd(total, builder.fmul(a, b, flags=_FUSE), flags=_FUSE)


@_lanewise
def fma(builder: Any, total: Any, a: Any, b: Any) -> Any:
    """Return total + a b in each lane, rounded once, also where the processor has no such instruction."""
    return _by_name(builder, "fma", a, b, total)


@_lanewise
def nearest(builder: Any, a: Any) -> Any:
    """Return each lane rounded to the nearest integer."""
    return _by_name(builder, "rint", a)


@partial(_lanewise, result=types.boolean)
def occupied(builder: Any, a: Any) -> Any:
    """Return true if any lane is not zero."""
    whole = builder.bitcast(builder.fcmp_unordered("!=", a, _ZERO), ir.IntType(LANES))
    return builder.icmp_unsigned("!=", whole, ir.Constant(ir.IntType(LANES), 0))


@_lanewise
def at_least(builder: Any, a: Any, b: Any) -> Any:
    """Return 1 in each lane where a >= b, else 0."""
    return builder.uitofp(builder.fcmp_ordered(">=", a, b), _VECTOR)


@_lanewise
def magnitude(builder: Any, a: Any) -> Any:
    """Return |a| in each lane."""
    return _by_name(builder, "fabs", a)


@_lanewise
def larger(builder: Any, a: Any, b: Any) -> Any:
    """Return the larger of a and b in each lane, b where one is not a number."""
    return builder.select(builder.fcmp_ordered(">", a, b), a, b)


@_lanewise
def where(builder: Any, truth: Any, a: Any, b: Any) -> Any:
    """Return a in each lane where `truth` is not zero, else b."""
    return builder.select(builder.fcmp_unordered("!=", truth, _ZERO), a, b)


_WHOLES = ir.VectorType(ir.IntType(64), LANES)
# of the bits of a double, read as an integer: the exponent's unit, and what is added to the
# exponent
_SCALE = 2.0**52
_BIAS = 1023.0


@_lanewise
def log2_of(builder: Any, a: Any) -> Any:
    """Return log2 of positive numbers, with an error of at most 0.09: exact for powers of two, linear between them."""
    whole = builder.sitofp(builder.bitcast(a, _WHOLES), _VECTOR)
    scaled = builder.fmul(whole, ir.Constant(_VECTOR, [1.0 / _SCALE] * LANES))
    return builder.fsub(scaled, ir.Constant(_VECTOR, [_BIAS] * LANES))


@_lanewise
def exp2_of(builder: Any, a: Any) -> Any:
    """Return the inverse of `log2_of`, for numbers between -1022 and 1023."""
    raised = builder.fadd(a, ir.Constant(_VECTOR, [_BIAS] * LANES))
    scaled = builder.fmul(raised, ir.Constant(_VECTOR, [_SCALE] * LANES))
    return builder.bitcast(builder.fptosi(scaled, _WHOLES), _VECTOR)


def shuffled(order: tuple[int, ...], name: str) -> Any:
    """Return a compiled function that takes lane order[i] to lane i.

    Lane i becomes 0 where order[i] is negative.
    """
    places = ir.Constant(
        ir.VectorType(ir.IntType(32), LANES), [i if i >= 0 else LANES for i in order]
    )

    def shuffle(builder: Any, a: Any) -> Any:
        return builder.shuffle_vector(a, _ZERO, places)

    shuffle.__name__ = shuffle.__qualname__ = name
    return _lanewise(shuffle)


def _binary(operation: Any, name: str) -> None:
    @_lanewise
    def apply(builder: Any, a: Any, b: Any) -> Any:
        return getattr(builder, name)(a, b)

    # numba calls `choose` with the operands' types and reads the signature off the lambda; it wants
    # no annotations here
    @_extending.overload(operation, jit_options=OPTIONS | {"forceinline": True})
    def choose(a, b):  # type: ignore[no-untyped-def]
        if isinstance(a, _Lanes) and isinstance(b, _Lanes):
            return lambda a, b: apply(a, b)  # noqa: PLW0108
        return None


_binary(operator.add, "fadd")
_binary(operator.sub, "fsub")
_binary(operator.mul, "fmul")
_binary(operator.truediv, "fdiv")
