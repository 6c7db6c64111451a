"""Compile generated Python source with numba, and cache it on disk so that it is compiled only once.

A module's file name is the hash of its text, so that equal sources share one compiled code, whichever scene or process
needs it. Nothing in a source may depend on a scene's values: they are passed as arguments.
"""

from __future__ import annotations

import hashlib
import linecache
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path
from string import Template
from types import ModuleType
from typing import Any

from reference.system.cache import discard, entry, store
from reference.system.workspace import replace_file

from .straight_line import FUNCTIONS, Program

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

    Machine code is read from the cache if it belongs to the very same text; if that cannot be used, it stays in memory.
    """
    on_disk = HEADER.replace("CACHE", "True") + body
    path = _stored(on_disk.encode())
    if path is None:
        return _in_memory(HEADER.replace("CACHE", "False") + body)
    return _executed(on_disk, path.stem, str(path))


def _stored(text: bytes) -> Path | None:
    """Return the cached file of a text, written if need be; None if the cache cannot be used."""
    name = f"f{hashlib.sha256(text).hexdigest()[:32]}.py"
    path = entry("generated", name)
    if path is not None:
        with suppress(OSError):
            if path.read_bytes() == text:  # rewriting it would make numba compile again
                return path
        discard(path)
    return store("generated", name, lambda path: replace_file(path, lambda stream: stream.write(text)))


def _in_memory(text: str) -> ModuleType:
    name = f"<generated {hashlib.sha256(text.encode()).hexdigest()[:12]}>"
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
    return _executed(text, name, name)


def _executed(text: str, name: str, file: str) -> ModuleType:
    module = ModuleType(name)
    sys.modules[name] = module  # numba's cache unpickles its functions by the module's name
    namespace: dict[str, Any] = module.__dict__
    exec(compile(text, file, "exec"), namespace)
    return module
