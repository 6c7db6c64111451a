"""Which of the packages that an engine or a method requires can be used here."""

from __future__ import annotations

import os
from collections.abc import Iterable
from importlib.util import find_spec


def missing(modules: Iterable[str]) -> list[str]:
    """Return the modules that are not installed."""
    return [name for name in modules if not _installed(name)]


def switched_off(modules: Iterable[str]) -> str | None:
    """Return the environment variable that stops one of the modules from compiling, or None."""
    variable = "NUMBA_DISABLE_JIT"
    return variable if "numba" in modules and os.environ.get(variable, "0") not in ("", "0") else None


def _installed(module: str) -> bool:
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:  # its parent package is missing
        return False
    return spec is not None and spec.origin is not None  # a folder without code has no origin
