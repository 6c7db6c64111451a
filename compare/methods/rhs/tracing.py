"""Trace a generic function of numbers to straight-line source code, which numba can compile.

The model is written once, for any number type (`reference.model.formulations`). Called with numbers that record the
operations on them, it produces a list of elementary operations, in which each expression stands once and exact zeros
are left out. Printed as Python, the list is a right-hand side, or a whole Runge-Kutta step, of nothing but arithmetic;
numba compiles it as well as a C compiler would compile the same lines. The code differentiated is straight-line code
too: the Jacobian that implicit methods need.

>>> def kepler(state, functions):
...     x, y = state
...     cube = functions.sqrt(x * x + y * y) ** 3
...     return (-1 * x / cube, -1 * y / cube)
>>> print(record(kepler, ["x", "y"]).source("kepler"))
def kepler(x, y):
    t0 = x * x
    t1 = y * y
    t2 = t0 + t1
    t3 = sqrt(t2)
    t4 = t3 * t3
    t5 = t4 * t3
    t6 = -x
    t7 = t6 / t5
    t8 = -y
    t9 = t8 / t5
    return t7, t9
<BLANKLINE>
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from operator import add, mul, neg, sub, truediv
from typing import Any

from .straight_line import FUNCTIONS, CodeLine, StraightLine


class TracingError(TypeError):
    """The traced function did something with a number that straight-line code cannot do."""


class TracedNumber:
    """A number that records the operations on it; it has no value, so that nothing may branch on it."""

    __slots__ = ("_tape", "name")

    def __init__(self, tape: Tape, name: str) -> None:
        self._tape, self.name = tape, name

    def __add__(self, other: Any) -> Any:
        return self._tape.add(self, other)

    def __radd__(self, other: Any) -> Any:
        return self._tape.add(other, self)

    def __sub__(self, other: Any) -> Any:
        return self._tape.subtract(self, other)

    def __rsub__(self, other: Any) -> Any:
        return self._tape.subtract(other, self)

    def __mul__(self, other: Any) -> Any:
        return self._tape.multiply(self, other)

    def __rmul__(self, other: Any) -> Any:
        return self._tape.multiply(other, self)

    def __truediv__(self, other: Any) -> Any:
        return self._tape.divide(self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return self._tape.divide(other, self)

    def __neg__(self) -> Any:
        return self._tape.negate(self)

    def __pow__(self, exponent: Any) -> Any:
        if not isinstance(exponent, int) or exponent < 1:
            raise TracingError(f"got the exponent {exponent!r}, expected a whole number from 1")
        power = self
        for _ in range(exponent - 1):
            power = power * self
        return power

    def _refuse(self, *_: Any) -> Any:
        raise TracingError("a traced function must not compare or convert numbers: straight-line code has no branches")

    __bool__ = __lt__ = __le__ = __gt__ = __ge__ = __float__ = __int__ = __abs__ = _refuse


class Tape:
    """The operations recorded so far. Only rewritings that change no bit of the result are made."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, tuple[str, ...]], TracedNumber] = {}
        self._negated: dict[str, TracedNumber] = {}
        self.lines: list[CodeLine] = []

    def input(self, name: str) -> TracedNumber:
        """Return a number that is an input of the code."""
        return TracedNumber(self, name)

    def operand(self, value: Any) -> str:
        """Return the name of a number, or the literal of a constant (the nearest double of a fraction)."""
        if isinstance(value, TracedNumber):
            return value.name
        if isinstance(value, bool) or not isinstance(value, int | float | Fraction):
            raise TracingError(f"got {value!r}, expected a recorded number, an int, a float or a Fraction")
        return repr(float(value))

    def record(self, operation: str, *values: Any) -> TracedNumber:
        """Return the result of an operation, which is recorded the first time only."""
        operands = tuple(map(self.operand, values))
        key = (operation, tuple(sorted(operands)) if operation in ("add", "mul") else operands)
        if key not in self._known:
            result = TracedNumber(self, f"t{len(self.lines)}")
            self.lines.append(CodeLine(result.name, operation, operands))
            self._known[key] = result
        return self._known[key]

    def add(self, a: Any, b: Any) -> Any:
        """Return a + b; a sum with a negated number is recorded as a difference."""
        if _is(a, 0) or _is(b, 0):
            return b if _is(a, 0) else a
        if self._positive(b) is not None:
            return self.subtract(a, self._positive(b))
        if self._positive(a) is not None:
            return self.subtract(b, self._positive(a))
        return self.record("add", a, b)

    def subtract(self, a: Any, b: Any) -> Any:
        """Return a - b."""
        if _is(a, 0) or _is(b, 0):
            return self.negate(b) if _is(a, 0) else a
        if self._positive(b) is not None:
            return self.add(a, self._positive(b))
        return self.record("sub", a, b)

    def multiply(self, a: Any, b: Any) -> Any:
        """Return a b; ±1 and an exact 0 need no multiplication."""
        for factor, other in ((a, b), (b, a)):
            if _is(factor, 0):
                return 0
            if _is(factor, 1):
                return other
            if _is(factor, -1):
                return self.negate(other)
        return self.record("mul", a, b)

    def divide(self, a: Any, b: Any) -> Any:
        """Return a / b."""
        if _is(a, 0) or _is(b, 1):
            return a
        return self.record("div", a, b)

    def negate(self, a: Any) -> Any:
        """Return -a."""
        if not isinstance(a, TracedNumber):
            return -a
        negated = self._positive(a)
        if negated is None:
            negated = self.record("neg", a)
            self._negated[negated.name] = a
        return negated

    def _positive(self, a: Any) -> Any:
        return self._negated.get(a.name) if isinstance(a, TracedNumber) else None

    def program(self, inputs: Sequence[str], outputs: Sequence[Any]) -> StraightLine:
        """Return the operations that the outputs need, renumbered."""
        results = [self.operand(value) for value in outputs]
        needed, lines_needed = set(results), []
        for line in reversed(self.lines):
            if line.name in needed:
                needed.update(line.operands)
                lines_needed.append(line)
        lines_needed.reverse()
        short = {line.name: f"t{i}" for i, line in enumerate(lines_needed)}

        def renamed(names: Sequence[str]) -> tuple[str, ...]:
            return tuple(short.get(name, name) for name in names)

        lines = tuple(CodeLine(short[line.name], line.operation, renamed(line.operands)) for line in lines_needed)
        return StraightLine(tuple(inputs), lines, renamed(results))


def _is(value: Any, number: int) -> bool:
    """Return True for an exact int or Fraction; the double 0.0 is not exact, because its sign and a NaN matter."""
    return isinstance(value, int | Fraction) and value == number


class RecordingFunctions:
    """sqrt, sin, cos and atan2 of traced numbers."""

    def __init__(self, tape: Tape) -> None:
        self._tape = tape

    def __getattr__(self, name: str) -> Callable[..., TracedNumber]:
        if name not in FUNCTIONS:
            raise TracingError(f"got the function {name}, expected one of {', '.join(FUNCTIONS)}")
        return lambda *values: self._tape.record(name, *values)


def record(function: Callable[[Any, Any], Sequence[Any]], inputs: Sequence[str]) -> StraightLine:
    """Trace a generic function.

    Args:
        function: `function(numbers, functions)` returns a sequence of numbers; it may add, subtract, multiply, divide,
            negate, raise to whole powers, and call sqrt, sin, cos, atan2 of `functions`. An int 0 stands for an exact
            zero and drops out. Ints, floats and fractions become literals.
        inputs: names of the numbers, in order; any identifiers but t0, t1, …

    Raises:
        TracingError: the function did something else.
    """
    tape = Tape()
    outputs = function([tape.input(name) for name in inputs], RecordingFunctions(tape))
    return tape.program(inputs, list(outputs))


def differentiated(program: StraightLine, variables: Sequence[str]) -> StraightLine:
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
        operation = _OPERATORS.get(line.operation) or getattr(functions, line.operation)
        result = values[line.name] = operation(*operands)
        partials = _PARTIALS[line.operation](functions, result, *operands)
        slopes[line.name] = list(none)
        for name, partial in zip(line.operands, partials, strict=True):
            for i, slope in enumerate(slopes.get(name, none)):
                slopes[line.name][i] = tape.add(slopes[line.name][i], tape.multiply(partial, slope))
    return tape.program(program.inputs, [slope for name in program.outputs for slope in slopes.get(name, none)])


_OPERATORS: dict[str, Callable[..., Any]] = {"add": add, "sub": sub, "mul": mul, "div": truediv, "neg": neg}
# the derivatives of an operation's result by each of its operands, from functions, the result and the operands
_PARTIALS: dict[str, Callable[..., tuple[Any, ...]]] = {
    "add": lambda f, result, x, y: (1, 1),
    "sub": lambda f, result, x, y: (1, -1),
    "mul": lambda f, result, x, y: (y, x),
    "div": lambda f, result, x, y: (1 / y, -(result / y)),
    "neg": lambda f, result, x: (-1,),
    "sqrt": lambda f, result, x: (0.5 / result,),
    "sin": lambda f, result, x: (f.cos(x),),
    "cos": lambda f, result, x: (-f.sin(x),),
    "atan2": lambda f, result, y, x: (x / (y * y + x * x), -(y / (y * y + x * x))),
}
