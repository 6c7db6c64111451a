"""Generated Python source as a module that numba compiles, kept on disk so that it is compiled once.

A module's file name is the hash of its text, so that equal sources share one compiled code, whichever scene
or process asks. Nothing in a source may depend on a scene's values: they come as arguments.
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
    """A program as a compiled function of numbers."""
    return "@nb.njit(**OPTIONS)\n" + program.source(name) + "\n\n"


def fill(template: str, **texts: str) -> str:
    """A template with texts put in its ${places}."""
    return Template(template).substitute(texts)


def names(letter: str, count: int) -> str:
    """Local variables x0, x1, … as arguments or targets, with a trailing comma; nothing if there are none."""
    return "".join(f"{letter}{i}, " for i in range(count))


def elements(array: str, count: int, row: str = "") -> str:
    """The elements of an array (of its row, if one is named) in the same way."""
    return "".join(f"{array}[{row and row + ', '}{i}], " for i in range(count))


def unpacked(letter: str, array: str, count: int) -> str:
    """The statement that takes an array apart."""
    return f"{names(letter, count)}= {elements(array, count)}" if count else "pass"


@cache
def compiled(body: str) -> ModuleType:
    """The module of a source whose functions numba compiles; decorators write `**OPTIONS`.

    It is read from the cache if the very same text is there; where the cache cannot be written it is compiled
    in memory.
    """
    on_disk = _stored(HEADER.replace("CACHE", "True") + body)
    if on_disk is not None:
        return _imported(on_disk)
    return _in_memory(HEADER.replace("CACHE", "False") + body)


def _stored(text: str) -> Path | None:
    """The file of a text, written atomically if it is not there yet; None if there is no place for it."""
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
    sys.modules[path.stem] = module  # numba's cache unpickles functions of it by the module's name
    spec.loader.exec_module(module)
    return module


def _in_memory(text: str) -> ModuleType:
    name = f"<generated {hashlib.sha256(text.encode()).hexdigest()[:12]}>"
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
    module = ModuleType(name)
    namespace: dict[str, Any] = module.__dict__
    exec(compile(text, name, "exec"), namespace)
    return module
