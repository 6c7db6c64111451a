"""How functions are compiled that compiled functions call; no option lets arithmetic be rearranged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba.extending import register_jitable

Function = TypeVar("Function", bound=Callable[..., Any])

OPTIONS: dict[str, Any] = {"error_model": "numpy", "_nrt": False}  # no reference counting: arrays come from the caller


def compiled(function: Function) -> Function:
    """Compile with numba, to be called from compiled functions."""
    callee: Function = register_jitable(**OPTIONS)(function)
    return callee


def inlined(function: Function) -> Function:
    """Compile into its callers: for small parts of innermost loops, where a call would cost more than the work."""
    callee: Function = register_jitable(forceinline=True, **OPTIONS)(function)
    return callee
