"""From a generic function of numbers to straight-line source code, compiled by numba or not.

The model is written once, for any number type (`reference.model.formulations`). Called with numbers that record
what happens to them, it leaves behind the list of its elementary operations: each expression once, what is
exactly zero nowhere. Printed as Python that is a right-hand side, or a whole Runge-Kutta step, with nothing
left in it but arithmetic, which numba compiles to what a C compiler would make of the same lines.

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
from typing import Any

from .program import FUNCTIONS, CodeLine, Program


class TracingError(TypeError):
    """The function did to a recording number what straight-line code cannot do."""


class TracedNumber:
    """A number that records what is done to it; it has no value, so that nothing may branch on it."""

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
        raise TracingError("a recorded function must not ask how large a number is: its code has no branches")

    __bool__ = __lt__ = __le__ = __gt__ = __ge__ = __float__ = __int__ = __abs__ = _refuse


class Tape:
    """What was recorded so far. Only rewritings that change no bit of the result are made."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, tuple[str, ...]], TracedNumber] = {}
        self._negated: dict[str, TracedNumber] = {}
        self.lines: list[CodeLine] = []

    def input(self, name: str) -> TracedNumber:
        """A number given from outside."""
        return TracedNumber(self, name)

    def operand(self, value: Any) -> str:
        """The name of a number, or the literal of a constant (the nearest double of a fraction)."""
        if isinstance(value, TracedNumber):
            return value.name
        if isinstance(value, bool) or not isinstance(value, int | float | Fraction):
            raise TracingError(f"got {value!r}, expected a recorded number, an int, a float or a Fraction")
        return repr(float(value))

    def record(self, operation: str, *values: Any) -> TracedNumber:
        """The result of an operation, recorded the first time only."""
        operands = tuple(map(self.operand, values))
        key = (operation, tuple(sorted(operands)) if operation in ("add", "mul") else operands)
        if key not in self._known:
            made = TracedNumber(self, f"t{len(self.lines)}")
            self.lines.append(CodeLine(made.name, operation, operands))
            self._known[key] = made
        return self._known[key]

    def add(self, a: Any, b: Any) -> Any:
        """A + b; a sum with a negated number is a difference."""
        if _is(a, 0) or _is(b, 0):
            return b if _is(a, 0) else a
        if self._positive(b) is not None:
            return self.subtract(a, self._positive(b))
        if self._positive(a) is not None:
            return self.subtract(b, self._positive(a))
        return self.record("add", a, b)

    def subtract(self, a: Any, b: Any) -> Any:
        """A - b."""
        if _is(a, 0) or _is(b, 0):
            return self.negate(b) if _is(a, 0) else a
        if self._positive(b) is not None:
            return self.add(a, self._positive(b))
        return self.record("sub", a, b)

    def multiply(self, a: Any, b: Any) -> Any:
        """A b; ±1 and an exact 0 need no multiplication."""
        for one, other in ((a, b), (b, a)):
            if _is(one, 0):
                return 0
            if _is(one, 1):
                return other
            if _is(one, -1):
                return self.negate(other)
        return self.record("mul", a, b)

    def divide(self, a: Any, b: Any) -> Any:
        """A / b."""
        if _is(a, 0) or _is(b, 1):
            return a
        return self.record("div", a, b)

    def negate(self, a: Any) -> Any:
        """-a."""
        if not isinstance(a, TracedNumber):
            return -a
        found = self._positive(a)
        if found is None:
            found = self.record("neg", a)
            self._negated[found.name] = a
        return found

    def _positive(self, a: Any) -> Any:
        return self._negated.get(a.name) if isinstance(a, TracedNumber) else None

    def program(self, inputs: Sequence[str], outputs: Sequence[Any]) -> Program:
        """The operations that the outputs need, renumbered."""
        wanted = [self.operand(value) for value in outputs]
        needed, kept = set(wanted), []
        for line in reversed(self.lines):
            if line.name in needed:
                needed.update(line.operands)
                kept.append(line)
        kept.reverse()
        short = {line.name: f"t{i}" for i, line in enumerate(kept)}

        def renamed(names: Sequence[str]) -> tuple[str, ...]:
            return tuple(short.get(name, name) for name in names)

        lines = tuple(CodeLine(short[line.name], line.operation, renamed(line.operands)) for line in kept)
        return Program(tuple(inputs), lines, renamed(wanted))


def _is(value: Any, number: int) -> bool:
    """True for an exact int or Fraction; the double 0.0 is a value like others, whose sign and NaN count."""
    return isinstance(value, int | Fraction) and value == number


class RecordingFunctions:
    """sqrt, sin, cos and atan2 of recording numbers."""

    def __init__(self, tape: Tape) -> None:
        self._tape = tape

    def __getattr__(self, name: str) -> Callable[..., TracedNumber]:
        if name not in FUNCTIONS:
            raise TracingError(f"got the function {name}, expected one of {', '.join(FUNCTIONS)}")
        return lambda *values: self._tape.record(name, *values)


def record(function: Callable[[Any, Any], Sequence[Any]], inputs: Sequence[str]) -> Program:
    """Trace a generic function.

    Args:
        function: `function(numbers, functions)` gives a sequence of numbers; it may add, subtract, multiply,
            divide, negate, raise to whole powers, and call sqrt, sin, cos, atan2 of `functions`. An int 0
            stands for an exact zero and drops out. Ints, floats and fractions become literals.
        inputs: names of the numbers, in order; any identifiers but t0, t1, …

    Raises:
        TracingError: it did something else.
    """
    tape = Tape()
    outputs = function([tape.input(name) for name in inputs], RecordingFunctions(tape))
    return tape.program(inputs, list(outputs))
