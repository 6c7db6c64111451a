"""How functions are compiled: those that Python calls, and those that only compiled functions call.

Of the latter numba would optimise each by itself, and make machine code of it, again in its callers, in their callers
and so on: the series six times. Here it makes LLVM's text of it, which is linked into the callers; the function that
Python calls is then optimised as a whole.
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar

import numba
import numba.extending
from numba import _dynfunc
from numba.core import codegen, compiler

from ...system.machine_code import kept

Function = TypeVar("Function", bound=Callable[..., Any])


def hashed(folder: Path) -> str:
    """Return a hash of a folder's sources, by which kept machine code is told from that of other sources."""
    return "".join(sha256(path.read_bytes()).hexdigest() for path in sorted(folder.glob("*.py")))


SOURCES = hashed(Path(__file__).parent)


class _Part(codegen.JITCodeLibrary):  # type: ignore[misc]  # numba has no types
    """The code of one function and of those that it calls, to be linked into others."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalized = True  # and no machine code


class _AsPart(compiler.Compiler):  # type: ignore[misc]
    """numba's compiler for functions that only compiled functions call."""

    def compile_extra(self, function: Any) -> Any:
        """Compile a function, as numba's compiler does, to a part."""
        context = self.state.targetctx
        self.state.library = _Part(context.codegen(), function.__qualname__)
        self.state.targetctx = context.subtarget(get_executable=_not_for_python)
        return super().compile_extra(function)


def _not_for_python(library: Any, description: Any, environment: Any) -> Any:
    """Return what stands for a compiled function where Python cannot call it: numba tells functions apart by it."""
    name = description.qualname
    return _dynfunc.make_function(description.lookup_module(), name, name, 0, environment, (library,))


_OPTIONS = {"error_model": "numpy", "_nrt": False}  # no reference counting: all arrays come from the caller
PART: dict[str, Any] = _OPTIONS | {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "pipeline_class": _AsPart}


def compiled(function: Function) -> Function:
    """Compile with numba, to be called from compiled functions; no option lets arithmetic be rearranged."""
    register: Any = numba.extending.register_jitable
    callee: Function = register(**PART)(function)
    return callee


def inlined(function: Function) -> Function:
    """Compile into its callers: for small parts of innermost loops, where a call would cost more than the work."""
    register: Any = numba.extending.register_jitable
    callee: Function = register(forceinline=True, **PART)(function)
    return callee


def entry(what: str, seconds: int, sources: str = SOURCES, nogil: bool = False) -> Callable[[Function], Function]:
    """Compile with numba, to be called from Python; the machine code is kept on disk.

    Args:
        what: what is compiled, in the plural, for the line that announces it.
        seconds: that it takes, about.
        sources: a hash of all sources that the function is made of: numba looks at its own file alone.
        nogil: whether the function lets other threads run.
    """

    def declared(function: Function) -> Function:
        compiler: Any = numba.njit
        with kept(what, seconds, sources):
            dispatcher: Function = compiler(cache=True, nogil=nogil, **_OPTIONS)(function)
        return dispatcher

    return declared
