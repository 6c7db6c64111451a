"""Compile generated Python source with numba, and cache it on disk so that it is compiled only once.

A module's file name is the hash of its text, so that equal sources share one compiled code, whichever scene or process
needs it. Nothing in a source may depend on a scene's values: they are passed as arguments.
"""

from __future__ import annotations

import hashlib
import importlib.util
import linecache
import os
import sys
import tempfile
from functools import cache
from pathlib import Path
from string import Template
from types import ModuleType
from typing import Any

from ..cache import root
from .program import FUNCTIONS, Program

HEADER = f"""import numba as nb
import numpy as np
from math import {", ".join(FUNCTIONS)}

OPTIONS = dict(cache=CACHE, error_model="numpy", fastmath=False)

"""


def function_text(program: Program, name: str) -> str:
    """Return the source of a program as a compiled function of numbers."""
    return "@nb.njit(**OPTIONS)\n" + program.source(name) + "\n\n"


def fill(template: str, **texts: str) -> str:
    """Return a template with texts in place of its ${placeholders}."""
    return Template(template).substitute(texts)


def names(letter: str, count: int) -> str:
    """Return variables x0, x1, … as arguments or targets, with a trailing comma; nothing if there are none."""
    return "".join(f"{letter}{i}, " for i in range(count))


def elements(array: str, count: int, row: str = "") -> str:
    """Return the elements of an array (of its row, if one is named) in the same way."""
    return "".join(f"{array}[{row and row + ', '}{i}], " for i in range(count))


def unpacked(letter: str, array: str, count: int) -> str:
    """Return the statement that unpacks an array into variables."""
    return f"{names(letter, count)}= {elements(array, count)}" if count else "pass"


@cache
def compiled(body: str) -> ModuleType:
    """Return the module of a source whose functions numba compiles; decorators write `**OPTIONS`.

    It is read from the cache if the very same text is there; if the cache cannot be written, it is compiled in memory.
    """
    on_disk = _stored(HEADER.replace("CACHE", "True") + body)
    if on_disk is not None:
        return _imported(on_disk)
    return _in_memory(HEADER.replace("CACHE", "False") + body)


def _stored(text: str) -> Path | None:
    """Return the cached file of a text, written atomically if need be; None if the cache cannot be written."""
    data = text.encode()
    try:
        folder = root() / "generated"
        path = folder / f"f{hashlib.sha256(data).hexdigest()[:32]}.py"
        if path.is_file() and path.read_bytes() == data:  # rewriting it would make numba compile again
            return path
        folder.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=folder, suffix=".tmp")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
            os.replace(name, path)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
    except OSError:
        return None
    return path


def _imported(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module  # numba's cache unpickles its functions by the module's name
    spec.loader.exec_module(module)
    return module


def _in_memory(text: str) -> ModuleType:
    name = f"<generated {hashlib.sha256(text.encode()).hexdigest()[:12]}>"
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
    module = ModuleType(name)
    namespace: dict[str, Any] = module.__dict__
    exec(compile(text, name, "exec"), namespace)
    return module
