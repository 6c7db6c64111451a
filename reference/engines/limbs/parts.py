"""How functions that only compiled functions call are compiled: machine code is made once, of all that Python calls.

numba would optimise each function, and make machine code of it, by itself, again in its callers, in their callers and
so on: the series six times. Here it makes LLVM's text of it, which is linked into the callers; the function that
Python calls is then optimised as a whole.
"""

from __future__ import annotations

from typing import Any

from numba import _dynfunc
from numba.core import codegen, compiler


class _Part(codegen.JITCodeLibrary):  # type: ignore[misc]  # numba has no types
    """The code of one function and of those that it calls, to be linked into others."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalized = True  # and no machine code


class AsPart(compiler.Compiler):  # type: ignore[misc]
    """numba's compiler (its option `pipeline_class`) for functions that only compiled functions call."""

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
