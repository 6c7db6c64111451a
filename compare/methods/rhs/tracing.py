"""Trace a generic function of numbers to straight-line source code, which numba can compile.

The model is written once, for any number type (`reference.model.formulations`). Called with numbers
that record the operations on them, it produces a list of elementary operations, in which each
expression stands once and exact zeros are left out. Printed as Python, the list is a right-hand
side, or a whole Runge-Kutta step, of nothing but arithmetic; numba compiles it as well as a C
compiler would compile the same lines. The code differentiated is straight-line code too: the
Jacobian that implicit methods need.

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

import functools
from collections.abc import Callable, Sequence
from fractions import Fraction
from operator import add, mul, neg, sub, truediv
from types import SimpleNamespace
from typing import Any

from reference.model.algebra import plus, product

from .straight_line import FUNCTIONS, CodeLine, StraightLine


class TracingError(TypeError):
    """The traced function did something with a number that straight-line code cannot do."""


class TracedNumber:
    """A number that records the operations on it.

    It has no value, so that nothing may branch on it.

    An exact zero, and factors of one and minus one, need no operation; no bit of the result depends
    on that.
    """

    __slots__ = ("_tape", "name")

    def __init__(self, tape: Tape, name: str) -> None:
        self._tape, self.name = tape, name

    def __add__(self, other: Any) -> Any:
        return self if _is(other, 0) else self._tape.record("add", self, other)

    def __sub__(self, other: Any) -> Any:
        return self if _is(other, 0) else self._tape.record("sub", self, other)

    def __rsub__(self, other: Any) -> Any:
        return -self if _is(other, 0) else self._tape.record("sub", other, self)

    def __mul__(self, other: Any) -> Any:
        if _is(other, 0):
            return 0
        if _is(other, 1):
            return self
        return -self if _is(other, -1) else self._tape.record("mul", self, other)

    def __truediv__(self, other: Any) -> Any:
        return self if _is(other, 1) else self._tape.record("div", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return 0 if _is(other, 0) else self._tape.record("div", other, self)

    def __neg__(self) -> Any:
        return self._tape.record("neg", self)

    def __pow__(self, exponent: Any) -> Any:
        if not isinstance(exponent, int) or exponent < 1:
            raise TracingError(f"got the exponent {exponent!r}, expected a whole number, 1 or more")
        power = self
        for _ in range(exponent - 1):
            power = power * self
        return power

    def _refuse(self, *_: Any) -> Any:
        raise TracingError(
            "a traced function must not compare or convert numbers: straight-line code has no branches"
        )

    __radd__, __rmul__ = __add__, __mul__
    __bool__ = __lt__ = __le__ = __gt__ = __ge__ = __float__ = __int__ = __abs__ = _refuse


class Tape:
    """The operations recorded so far, each once."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, tuple[str, ...]], TracedNumber] = {}
        self.lines: list[CodeLine] = []

    def operand(self, value: Any) -> str:
        """Return the name of a number, or the literal of a constant (the nearest double of a fraction)."""
        if isinstance(value, TracedNumber):
            return value.name
        if isinstance(value, bool) or not isinstance(value, int | float | Fraction):
            raise TracingError(
                f"got {value!r}, expected a recorded number, an int, a float or a Fraction"
            )
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

    def program(self, inputs: Sequence[str], outputs: Sequence[Any]) -> StraightLine:
        """Return the operations that the outputs need."""
        results = tuple(map(self.operand, outputs))
        needed, lines = set(results), []
        for line in reversed(self.lines):
            if line.name in needed:
                needed.update(line.operands)
                lines.append(line)
        return StraightLine(tuple(inputs), tuple(reversed(lines)), results)


def _is(value: Any, number: int) -> bool:
    """Return True for an exact int or Fraction.

    The double 0.0 is not exact, because its sign and a NaN matter.
    """
    return isinstance(value, int | Fraction) and value == number


def recording(tape: Tape) -> SimpleNamespace:
    """Return sqrt, sin, cos and atan2 of traced numbers, as attributes."""
    return SimpleNamespace(**{name: functools.partial(tape.record, name) for name in FUNCTIONS})


def record(function: Callable[[Any, Any], Sequence[Any]], inputs: Sequence[str]) -> StraightLine:
    """Trace a generic function.

    Args:
        function: `function(numbers, functions)` returns a sequence of numbers; it may add,
            subtract, multiply, divide, negate, raise to whole powers, and call sqrt, sin, cos,
            atan2 of `functions`. An int 0 stands for an exact zero and drops out. Ints, floats and
            fractions become literals.
        inputs: names of the numbers, in order; any identifiers but t0, t1, …

    Raises:
        TracingError: the function did something else with a number.
        AttributeError: it called another function of `functions`.
    """
    tape = Tape()
    outputs = function([TracedNumber(tape, name) for name in inputs], recording(tape))
    return tape.program(inputs, outputs)


def differentiated(program: StraightLine, variables: Sequence[str]) -> StraightLine:
    """Return the program of the Jacobian: ∂ output / ∂ variable, row by row, shape (outputs, variables) flattened."""
    tape = Tape()
    functions = recording(tape)
    values: dict[str, Any] = {name: TracedNumber(tape, name) for name in program.inputs}
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
                slopes[line.name][i] = plus(slopes[line.name][i], product(partial, slope))
    return tape.program(
        program.inputs, [slope for name in program.outputs for slope in slopes.get(name, none)]
    )


_OPERATORS: dict[str, Callable[..., Any]] = {
    "add": add,
    "sub": sub,
    "mul": mul,
    "div": truediv,
    "neg": neg,
}
# the derivatives of an operation's result by each of its operands, from functions, the result and
# the operands
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
