"""Differentiate straight-line code into straight-line code: the Jacobian that implicit methods need."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .straight_line import Program
from .tracing import RecordingFunctions, Tape


def differentiated(program: Program, variables: Sequence[str]) -> Program:
    """Return the program of the Jacobian: ∂ output / ∂ variable, row by row, shape (outputs, variables) flattened."""
    tape = Tape()
    functions = RecordingFunctions(tape)
    values: dict[str, Any] = {name: tape.input(name) for name in program.inputs}
    slopes: dict[str, list[Any]] = {v: [int(v == u) for u in variables] for v in variables}
    none = [0] * len(variables)

    def value(name: str) -> Any:
        return values[name] if name in values else float(name)

    for line in program.lines:
        operands = [value(name) for name in line.operands]
        result = _apply(tape, functions, line.operation, operands)
        values[line.name] = result
        partials = _partials(tape, functions, line.operation, operands, result)
        slopes[line.name] = list(none)
        for name, partial in zip(line.operands, partials, strict=True):
            for i, slope in enumerate(slopes.get(name, none)):
                slopes[line.name][i] = tape.add(slopes[line.name][i], tape.multiply(partial, slope))
    return tape.program(program.inputs, [slope for name in program.outputs for slope in slopes.get(name, none)])


def _apply(tape: Tape, functions: RecordingFunctions, operation: str, operands: list[Any]) -> Any:
    if operation == "neg":
        return tape.negate(operands[0])
    named = {"add": tape.add, "sub": tape.subtract, "mul": tape.multiply, "div": tape.divide}
    return named[operation](*operands) if operation in named else getattr(functions, operation)(*operands)


def _partials(tape: Tape, functions: RecordingFunctions, operation: str, x: list[Any], result: Any) -> tuple[Any, ...]:
    """Return the derivatives of an operation's result by each of its operands."""
    if operation == "add":
        return (1, 1)
    if operation == "sub":
        return (1, -1)
    if operation == "mul":
        return (x[1], x[0])
    if operation == "div":
        return (tape.divide(1, x[1]), tape.negate(tape.divide(result, x[1])))
    if operation == "neg":
        return (-1,)
    if operation == "sqrt":
        return (tape.divide(0.5, result),)
    if operation == "sin":
        return (functions.cos(x[0]),)
    if operation == "cos":
        return (tape.negate(functions.sin(x[0])),)
    square = tape.add(tape.multiply(x[0], x[0]), tape.multiply(x[1], x[1]))
    return (tape.divide(x[1], square), tape.negate(tape.divide(x[0], square)))
