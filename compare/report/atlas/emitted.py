"""JavaScript that is emitted from the model: a Taylor series of the motion, and the constants of its equations.

The equations stand in `reference.model` only. They are called with numbers that record the operations on them
(`compare.methods.rhs.tracing`). For constants and releases the record is printed as it is. For the series each
operation becomes that of a coefficient: of degree k of a sum, of a multiple, and of a product, which is a
convolution. The momentum form needs no other operations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

from reference.model.algebra import plus, product
from reference.model.constants import Constants, axis_distance, centrifugal_products, turn_and_pull
from reference.model.force import force
from reference.model.formulations import FORMULATIONS
from reference.model.start import Angle, at_angles

from ...methods.rhs.straight_line import CodeLine, StraightLine
from ...methods.rhs.tracing import record

_MOMENTUM = FORMULATIONS["momentum"]
_CONSTANTS = ("turnNorth", "turnUp", "pullNorth", "pullUp")
_DRAG = "drag"
_SITE = ("length", "gravity", "rate", "radius", "flattening", "altitude", "sin", "cos")
_RELEASE = (
    "length",
    "angleSin",
    "angleCos",
    "angleRate",
    "azimuthSin",
    "azimuthCos",
    "azimuthRate",
)
_FORCE = (
    *("nx", "ny", "nz", "vx", "vy", "vz"),
    *(*_CONSTANTS, _DRAG),
    *("turnTurn", "upUp", "northUp", "northNorth"),
)
_SYMBOLS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}


@cache
def emitted() -> str:
    """Return the functions of the model in JavaScript."""
    functions = [
        _series("seriesWithoutDrag", _without_drag, _CONSTANTS),
        _series("seriesWithDrag", _with_drag, (*_CONSTANTS, _DRAG)),
        _function("constantsOfGravityAlone", _gravity_alone, _SITE),
        _function("constantsOfEffectiveGravity", _effective, _SITE),
        _function(
            "axisDistance", _axis_distance, ("radius", "flattening", "altitude", "sin", "cos")
        ),
        _function("releaseAtAngles", _released, _RELEASE),
        _function("momentumOf", _momentum, ("nx", "ny", "nz", "vx", "vy", "vz", *_CONSTANTS[:2])),
        _function("centrifugalProducts", _centrifugal, ("rate", *_CONSTANTS[:2])),
        _function("forceOn", _force, _FORCE),
        _function("tangentialForce", _tangential, ("sin", "cos", *_CONSTANTS)),
    ]
    return "\n".join(
        ["// Emitted from reference/model by emitted.py.", '"use strict";\n', *functions]
    )


def _constants(numbers: Sequence[Any], drag: Any = 0) -> Constants:
    turn_north, turn_up, pull_north, pull_up = numbers
    return Constants(turn=(0, turn_north, turn_up), pull=(0, pull_north, pull_up), drag=drag)


def _without_drag(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    return _MOMENTUM.derivatives(numbers[:6], _constants(numbers[6:]), functions)


def _with_drag(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    *others, drag = numbers
    return _MOMENTUM.derivatives(others[:6], _constants(others[6:], drag), functions)


def _gravity_alone(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    length, gravity, rate, radius, flattening, altitude, sin, cos = numbers
    distance = axis_distance(radius, flattening, altitude, sin, cos, functions.sqrt)
    return turn_and_pull(length, gravity, rate, distance, sin, cos)


def _axis_distance(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    radius, flattening, altitude, sin, cos = numbers
    return (axis_distance(radius, flattening, altitude, sin, cos, functions.sqrt),)


def _effective(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    length, gravity, rate, _, _, _, sin, cos = numbers
    # the constants of the model have R = 0 here
    turn_north, turn_up, _, pull_up = turn_and_pull(length, gravity, rate, 0, sin, cos)
    return turn_north, turn_up, 0, pull_up


def _released(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    length, *angles = numbers
    position, velocity = at_angles(length, Angle(*angles[:3]), Angle(*angles[3:]))
    return (*position, *velocity)


def _momentum(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    n = tuple(numbers[:3])
    v = tuple(numbers[3:6])
    turn = (0, *numbers[6:])
    return _MOMENTUM.start(n, v, Constants(turn=turn), functions)[3:]


def _centrifugal(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    return centrifugal_products(*numbers)


def _force(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    """Return the force on a bob, with the terms of the centrifugal force given one by one."""
    *turn_and_pull_, drag = numbers[6:11]
    centrifugal = tuple(numbers[11:])
    k = replace(_constants(turn_and_pull_, drag), centrifugal=centrifugal)
    return force(tuple(numbers[:3]), tuple(numbers[3:6]), k)


def _tangential(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
    """Return the force along the meridian of the sphere on a bob at rest, which `rest_position` makes zero."""
    sin, cos, turn_north, turn_up, pull_north, pull_up = numbers
    k = Constants(
        turn=(0, turn_north, turn_up),
        pull=(0, pull_north, pull_up),
        # the only product of the rate is xx, which drops out: the bob at rest has x = 0
        centrifugal=centrifugal_products(0, turn_north, turn_up),
    )
    at_rest = force((0, sin, -1 * cos), (0, 0, 0), k)
    return (plus(product(at_rest[1], cos), product(at_rest[2], sin)),)


def _function(
    name: str, function: Callable[[Any, Any], Sequence[Any]], inputs: Sequence[str]
) -> str:
    """Return a function that computes a recorded function in doubles."""
    program = record(function, inputs)
    body = [f"const {line.name} = {_expression(line)};" for line in program.lines]
    return _braced(
        f"function {name}({', '.join(inputs)})", [*body, f"return [{', '.join(program.outputs)}];"]
    )


def _expression(line: CodeLine) -> str:
    if line.operation == "neg":
        return f"-{line.operands[0]}"
    if line.operation in _SYMBOLS:
        return f"{line.operands[0]} {_SYMBOLS[line.operation]} {line.operands[1]}"
    return f"Math.{line.operation}({', '.join(line.operands)})"


def _series(
    name: str, function: Callable[[Any, Any], Sequence[Any]], constants: Sequence[str]
) -> str:
    """Return a function that fills in the Taylor coefficients of a solution, from those of degree 0."""
    variables = _MOMENTUM.variables
    program = record(function, [*variables, *constants])
    kinds = _Series.of(program, variables)

    steps = []
    for line in program.lines:
        target = f"{line.name}[k]" if line in kinds.stored else f"const {line.name}"
        steps.append(f"{target} = {kinds.coefficient(line)};")
    for variable, rate in zip(variables, program.outputs, strict=True):
        steps.append(f"{variable}[k + 1] = {kinds.at_degree(rate)} / (k + 1);")

    arrays = [f"const {line.name} = [];" for line in kinds.stored]
    loop = ["for (let k = 0; k < order; k += 1) {", *(f"  {step}" for step in steps), "}"]
    return _braced(
        f"function {name}([{', '.join(variables)}], [{', '.join(constants)}], order)",
        [*arrays, *loop],
    )


class _Series:
    """Which names of straight-line code are series, and which of these are kept because they are multiplied.

    Attributes:
        variables: the series that the caller has.
        stored: operations whose series are kept.
    """

    def __init__(self, variables: Iterable[str], series: set[str], stored: list[CodeLine]) -> None:
        self.variables = set(variables)
        self._series = series
        self.stored = stored
        self._arrays = self.variables | {line.name for line in stored}

    @classmethod
    def of(cls, program: StraightLine, variables: Sequence[str]) -> _Series:
        """Return the series of a program."""
        series = set(variables)
        multiplied: set[str] = set()
        for line in program.lines:
            if series.intersection(line.operands):
                series.add(line.name)
            if line.operation == "mul" and series.issuperset(line.operands):
                multiplied.update(line.operands)
        return cls(variables, series, [line for line in program.lines if line.name in multiplied])

    def at_degree(self, name: str) -> str:
        """Return the coefficient of degree k of an operand."""
        if name in self._arrays:
            return f"{name}[k]"
        return name if name in self._series else f"(k ? 0 : {name})"

    def coefficient(self, line: CodeLine) -> str:
        """Return the coefficient of degree k of an operation's result.

        Raises:
            ValueError: the operation is not that of a polynomial of degree two.
        """
        operands = line.operands
        if line.operation == "mul":
            if self._series.issuperset(operands):
                return f"product({operands[0]}, {operands[1]}, k)"
            return " * ".join(
                name if name not in self._series else self.at_degree(name) for name in operands
            )
        at_degree = [self.at_degree(name) for name in operands]
        if line.operation == "neg":
            return f"-{at_degree[0]}"
        if line.operation in ("add", "sub"):
            return f" {_SYMBOLS[line.operation]} ".join(at_degree)
        raise ValueError(f"{line.operation} has no recurrence here")


def _braced(head: str, body: Iterable[str]) -> str:
    return "\n".join([f"{head} {{", *_indented(body), "}\n"])


def _indented(lines: Iterable[str]) -> Iterator[str]:
    for line in lines:
        yield f"  {line}"
