"""Kernels: compiled functions that others call by the address of their machine code.

What compiled functions call is linked into them (`compiling`), so that one process compiles all of it. A kernel is
compiled, and kept on disk, by itself: on the first use on a machine two processes compile different kernels.
"""

from __future__ import annotations

from collections.abc import Callable
from types import NoneType
from typing import Any, get_type_hints

from numba import types
from numba.core import cgutils

from ...system.machine_code import missing
from .compiling import entry
from .lanes import instruction
from .limb import Array
from .series import Counts

COMPILE_S = 8  # what compiling all kernels takes in two processes, about, of which users are told

_intp: Any = types.intp
_TYPES: dict[Any, Any] = {
    Array: types.float64[::1],
    Counts: types.int64[::1],
    bool: types.boolean,
    float: types.float64,
    int: _intp,
    NoneType: types.none,
}


class Kernel:
    """A compiled function of fixed types, those that its annotations name.

    Attributes:
        call: to be called from compiled functions with the address, then the function's arguments.
        python: to be called from Python with the function's arguments.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        hints = get_type_hints(function)
        returned = _type(hints.pop("return"))
        self._signature: Any = returned(*map(_type, hints.values()))
        self.python: Any = entry("limbs", COMPILE_S)(function)
        self.call: Any = _by_address(self._signature)

    @property
    def missing(self) -> bool:
        """Whether the machine code could be on disk, but is not."""
        return missing(self.python, self._signature.args)

    def address(self) -> int:
        """Return the address of the machine code, which is compiled or loaded if need be.

        Raises:
            TypeError: the function returns another type than its annotation says.
        """
        kinds = self._signature.args
        self.python.compile(kinds)
        code = self.python.overloads[kinds]
        if code.signature != self._signature:
            raise TypeError(f"{self.python.__name__} is {code.signature}, not {self._signature}")
        return int(code.library.get_pointer_to_function(code.fndesc.llvm_func_name))


def _type(annotation: Any) -> Any:
    """Return numba's type for an annotation: of a number, an array, or a named tuple of such."""
    if annotation in _TYPES:
        return _TYPES[annotation]
    fields: Any = get_type_hints(annotation).values()
    return types.BaseTuple.from_types(tuple(map(_type, fields)), annotation)


def _by_address(signature: Any) -> Any:
    """Return an instruction that calls machine code of a signature; its first argument is the address."""

    def generate(context: Any, builder: Any, called: Any, arguments: Any) -> Any:
        convention, (address, values) = context.call_conv, arguments
        kind = convention.get_function_type(signature.return_type, signature.args)
        code, values = builder.inttoptr(address, kind.as_pointer()), cgutils.unpack_tuple(builder, values)
        status, result = convention.call_function(builder, code, signature.return_type, signature.args, values)
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return result

    @instruction
    def call(_: Any, address: Any, *arguments: Any) -> Any:
        return signature.return_type(_intp, types.BaseTuple.from_types(signature.args)), generate

    return call
