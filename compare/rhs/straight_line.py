"""Straight-line code: a list of elementary operations, which can be printed as a Python function."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

FUNCTIONS = ("atan2", "cos", "sin", "sqrt")
_SYMBOLS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}


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
class Program:
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
        return "\n    ".join([f"def {name}({', '.join(self.inputs)}):", *body, f"return {ending}"]) + "\n"

    def function(self) -> Callable[..., tuple[float, ...]]:
        """Return that function, not compiled: a Python function of floats."""
        namespace: dict[str, Any] = {name: getattr(math, name) for name in FUNCTIONS}
        exec(self.source("traced"), namespace)
        function: Callable[..., tuple[float, ...]] = namespace["traced"]
        return function
