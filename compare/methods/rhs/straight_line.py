"""Straight-line code: a list of elementary operations, printed as Python, compiled by numba and cached on disk.

A generated module's file name is the hash of its text, so that equal sources share one compiled
code, whichever scene or process needs it. Nothing in a source may depend on a scene's values: they
are passed as arguments.
"""

from __future__ import annotations

import hashlib
import sys
from dataclasses import dataclass, field
from functools import cache
from types import ModuleType

from reference.system.cache import kept
from reference.system.workspace import replace_file

FUNCTIONS = ("atan2", "cos", "sin", "sqrt")
_SYMBOLS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
HEADER = f"""import numba as nb
import numpy as np
from math import {", ".join(FUNCTIONS)}

OPTIONS = dict(cache=True, error_model="numpy", fastmath=False)
STATE = nb.types.Array(nb.float64, 1, "A", readonly=True)

"""


@dataclass(frozen=True)
class CodeLine:
    """One operation: the name it defines, the operation, and its operands, which are names or literals."""

    name: str
    operation: str
    operands: tuple[str, ...]

    @property
    def expression(self) -> str:
        """The right-hand side of the assignment, in Python."""
        if self.operation == "neg":
            return f"-{self.operands[0]}"
        if self.operation in _SYMBOLS:
            return f"{self.operands[0]} {_SYMBOLS[self.operation]} {self.operands[1]}"
        return f"{self.operation}({', '.join(self.operands)})"


@dataclass(frozen=True)
class StraightLine:
    """Straight-line code: inputs, operations in order, and the names or literals that are its results."""

    inputs: tuple[str, ...]
    lines: tuple[CodeLine, ...] = field(repr=False)
    outputs: tuple[str, ...]

    @property
    def used(self) -> set[str]:
        """Names and literals that the operations and the results use."""
        return {operand for line in self.lines for operand in line.operands} | set(self.outputs)

    def source(self, name: str) -> str:
        """Return the source of a Python function of the inputs, which returns the tuple of the outputs."""
        body = [f"{line.name} = {line.expression}" for line in self.lines]
        ending = ", ".join(self.outputs) + ("," if len(self.outputs) == 1 else "")
        return (
            "\n    ".join([f"def {name}({', '.join(self.inputs)}):", *body, f"return {ending}"])
            + "\n"
        )


def elements(array: str, count: int, row: str = "") -> str:
    """Return the elements of an array (or of one of its rows) as text, each followed by a comma."""
    return "".join(f"{array}[{row and row + ', '}{i}], " for i in range(count))


@cache
def compiled(body: str) -> ModuleType:
    """Return the module of a source whose functions numba compiles; decorators write `**OPTIONS`.

    What runs is this text, whatever its file holds: that is there for numba's cache, which goes by
    its name and times.
    """
    text = (HEADER + body).encode()
    name = f"f{hashlib.sha256(text).hexdigest()[:32]}"
    path = kept(
        "generated",
        f"{name}.py",
        lambda path: replace_file(path, lambda stream: stream.write(text)),
    )
    module = ModuleType(name)
    sys.modules[name] = module  # numba's cache unpickles its functions by the module's name
    exec(compile(text, str(path), "exec"), module.__dict__)
    return module
