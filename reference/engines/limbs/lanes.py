"""Eight doubles side by side, as a type that numba compiles to whatever vector registers a machine has.

Products and sums here are exact by the caller's doing (`limb`), so that it makes no difference whether the
compiler fuses them: the same bits come out with and without FMA, on every machine.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar

import numba.extending
from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.core import cgutils

LANES = 8
# what is compiled from this package, for functions kept on disk to close over: numba looks at their own file alone
SOURCES = "".join(sha256(path.read_bytes()).hexdigest() for path in sorted(Path(__file__).parent.glob("*.py")))
_insert: Any = cgutils.get_or_insert_function
Function = TypeVar("Function", bound=Callable[..., Any])
VECTOR = ir.VectorType(ir.DoubleType(), LANES)
FUSE = ("contract",)


_extending: Any = numba.extending  # what it makes cannot be typed
_OPTIONS = {"error_model": "numpy", "_nrt": False}  # without counting references: all arrays come from outside


def compiled(function: Function) -> Function:
    """Compile with numba as a part of others; no option that lets arithmetic be rearranged."""
    made: Function = _extending.register_jitable(no_cpython_wrapper=True, no_cfunc_wrapper=True, **_OPTIONS)(function)
    return made


def inlined(function: Function) -> Function:
    """Compile into its callers: for small parts of the innermost loops, whose arguments would cost more than they."""
    made: Function = _extending.register_jitable(
        no_cpython_wrapper=True, no_cfunc_wrapper=True, forceinline=True, **_OPTIONS
    )(function)
    return made


def entry(function: Function) -> Function:
    """Compile with numba, to be called from Python; the machine code is kept on disk."""
    compiler: Any = numba.njit
    made: Function = compiler(cache=True, **_OPTIONS)(function)
    return made


_Type: Any = types.Type


class _Lanes(_Type):  # type: ignore[misc]
    """The type of eight doubles."""


Lanes: Any = _Lanes(name="Lanes")


@_extending.register_model(_Lanes)
class _Model(_extending.models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, made: Any) -> None:
        super().__init__(manager, made, VECTOR)


def instruction(generator: Any) -> Any:
    """What a call compiles to; for a type checker a function of anything."""
    return _extending.intrinsic(generator)


def address(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    """Where eight elements of a flat array begin."""
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), VECTOR.as_pointer())


@instruction
def load(_: Any, array: Any, index: Any) -> Any:
    """Eight elements of a flat array from `index` on."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        made = builder.load(address(context, builder, signature.args[0], *given))
        made.align = 8
        return made

    return Lanes(array, types.intp), generate


@instruction
def store(_: Any, array: Any, index: Any, value: Any) -> Any:
    """Write eight elements of a flat array from `index` on."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        made = builder.store(given[2], address(context, builder, signature.args[0], *given[:2]))
        made.align = 8
        return context.get_dummy_value()

    return types.void(array, types.intp, Lanes), generate


@instruction
def spread(_: Any, value: Any) -> Any:
    """The same double in every lane."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        first = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), given[0], ir.Constant(ir.IntType(32), 0))
        return builder.shuffle_vector(
            first, ir.Constant(VECTOR, ir.Undefined), ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
        )

    return Lanes(types.float64), generate


@instruction
def plus_product(_: Any, total: Any, a: Any, b: Any) -> Any:
    """Total + a b in each lane."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.fadd(given[0], builder.fmul(given[1], given[2], flags=FUSE), flags=FUSE)

    return Lanes(Lanes, Lanes, Lanes), generate


@instruction
def nearest(_: Any, a: Any) -> Any:
    """Each lane rounded to an integer."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        name, kind = f"llvm.rint.v{LANES}f64", ir.FunctionType(VECTOR, [VECTOR])
        return builder.call(_insert(builder.module, kind, name), given)

    return Lanes(Lanes), generate


@instruction
def occupied(_: Any, a: Any) -> Any:
    """True if any lane is not zero."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        bits = builder.fcmp_unordered("!=", given[0], ir.Constant(VECTOR, [0.0] * LANES))
        whole = builder.bitcast(bits, ir.IntType(LANES))
        return builder.icmp_unsigned("!=", whole, ir.Constant(ir.IntType(LANES), 0))

    return types.boolean(Lanes), generate


@instruction
def at_least(_: Any, a: Any, b: Any) -> Any:
    """1 in each lane where a >= b, else 0."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.uitofp(builder.fcmp_ordered(">=", *given), VECTOR)

    return Lanes(Lanes, Lanes), generate


@instruction
def within(_: Any, a: Any, bound: Any) -> Any:
    """True if no lane is larger in size than a double, or not a number."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        places = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
        blank = ir.Constant(VECTOR, ir.Undefined)
        first = builder.insert_element(blank, given[1], ir.Constant(ir.IntType(32), 0))
        most = builder.shuffle_vector(first, blank, places)
        low = builder.fcmp_ordered(">=", given[0], builder.fneg(most))
        high = builder.fcmp_ordered("<=", given[0], most)
        whole = builder.bitcast(builder.and_(low, high), ir.IntType(LANES))
        return builder.icmp_unsigned("==", whole, ir.Constant(ir.IntType(LANES), (1 << LANES) - 1))

    return types.boolean(Lanes, types.float64), generate


def shuffled(order: tuple[int, ...], name: str) -> Any:
    """A compiled function that takes lane order[i] to lane i, and 0 where order[i] is negative."""
    places = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [i if i >= 0 else LANES for i in order])

    def shuffle(_: Any, a: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
            return builder.shuffle_vector(given[0], ir.Constant(VECTOR, [0.0] * LANES), places)

        return Lanes(Lanes), generate

    shuffle.__name__ = shuffle.__qualname__ = name
    return _extending.intrinsic(shuffle)


def _binary(operation: Any, name: str) -> None:
    @instruction
    def apply(_: Any, a: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
            return getattr(builder, name)(*given)

        return Lanes(Lanes, Lanes), generate

    # numba takes the place of `apply` in a lambda for the signature; it wants no annotations here
    @_extending.overload(operation)
    def choose(a, b):  # type: ignore[no-untyped-def]
        if isinstance(a, _Lanes) and isinstance(b, _Lanes):
            return lambda a, b: apply(a, b)  # noqa: PLW0108
        return None


_binary(operator.add, "fadd")
_binary(operator.sub, "fsub")
_binary(operator.mul, "fmul")
