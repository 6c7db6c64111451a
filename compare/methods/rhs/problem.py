"""The initial value problem for methods: start and constants in double, right-hand side, conversion to metres.

How far and how fast a bob can get, by its energy, gives the scales for tolerances, and which
formulations hold.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from string import Template
from types import ModuleType
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from reference import InputError, Scene
from reference.errors import BeyondDoublesError, Described
from reference.model.constants import Constants
from reference.model.formulations import FORMULATIONS
from reference.model.start import Start
from reference.numbers.precision import DOUBLE_BITS, GUARD_BITS, Array

from .straight_line import StraightLine, compiled, elements
from .tracing import differentiated, record

# least swing of a variable, so that tolerances for a bob at rest are not zero
SMALLEST_SIZE = 1e-12
Rates = Callable[[Sequence[Any], Any, Mapping[str, Any]], Sequence[Any]]
Derivatives = Callable[[Sequence[Any], Constants, Any], Sequence[Any]]
# of the last array, from a state and the parameters
Filling = Callable[[Array, Array, Array], None]


@dataclass(frozen=True)
class FirstOrderSystem:
    """An autonomous first-order system in the model's generic style.

    Attributes:
        variables: names of the state's variables.
        rates: `rates(state, functions, parameters)` returns their derivatives; see
            `tracing.record`.
        parameters: doubles by name, which `rates` gets as numbers; literals in it need none.
    """

    variables: tuple[str, ...]
    rates: Rates
    parameters: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(
        cls, variables: tuple[str, ...], derivatives: Derivatives, k: Constants
    ) -> FirstOrderSystem:
        """Return equations of motion as a system whose parameters are the constants in double that they use.

        Compiled code is shared by all scenes with the same constants other than zero.
        """

        def rates(
            state: Sequence[Any], functions: Any, parameters: Mapping[str, Any]
        ) -> Sequence[Any]:
            return derivatives(state, Constants.of(parameters), functions)

        complete = cls(variables, rates, k.entries())
        symbols = zip(complete.inputs[len(variables) :], complete.parameters.items(), strict=True)
        used = complete.program.used
        return cls(
            variables, rates, dict(parameter for symbol, parameter in symbols if symbol in used)
        )

    @cached_property
    def program(self) -> StraightLine:
        """The derivatives as straight-line code of the variables and the parameters."""
        return self.traced(self.rates)

    @cached_property
    def jacobian(self) -> StraightLine:
        """∂ derivative / ∂ variable, row by row, as straight-line code of the variables and the parameters."""
        return differentiated(self.program, self.inputs[: len(self.variables)])

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names in generated code: x0, x1, … for the variables, k0, k1, … for the parameters."""
        return tuple(f"x{i}" for i in range(len(self.variables))) + tuple(
            f"k{i}" for i in range(len(self.parameters))
        )

    def traced(self, function: Callable[..., Sequence[Any]], *more: str) -> StraightLine:
        """Trace a function of state, functions, parameters, and of further inputs named by `more`."""
        count, end = len(self.variables), len(self.inputs)

        def flat(numbers: Sequence[Any], functions: Any) -> Sequence[Any]:
            parameters = dict(zip(self.parameters, numbers[count:end], strict=True))
            return function(numbers[:count], functions, parameters, *numbers[end:])

        return record(flat, (*self.inputs, *more))


@dataclass(frozen=True)
class SwingReach:
    """Bounds on how far and how fast the bob can move, from its energy about the rest position.

    Without the small gradient of the centrifugal force v²/2 - n·c is constant, so that the angle
    from the rest position c/|c| never exceeds the one where v would vanish, nor the speed its value
    at the bottom.

    Attributes:
        below: True if the bob stays below the horizontal, where the cord always pulls.
        reach: bound on the distance from the vertical, as a part of l.
        fastest: speed over l, in 1/s.
    """

    below: bool
    reach: float
    fastest: float

    @classmethod
    def of(cls, start: Start) -> SwingReach:
        """Return the reach of the swing that follows from the release.

        Raises:
            UnreachableError: a number of the scene is too large for binary64.
        """
        n, v, pull = (np.array(part, dtype=float) for part in (start.n, start.v, start.k.pull))
        rate = float(start.k.rate)
        if not (np.isfinite((n, v, pull)).all() and math.isfinite(rate * rate)):
            raise BeyondDoublesError
        strength = float(np.linalg.norm(pull))
        if strength == 0:
            return cls(False, 1.0, float(np.linalg.norm(v)))
        energy = float(v @ v / 2 - n @ pull)
        # of the largest angle; -1 or less where the bob can go over the top
        cosine = min(-energy / strength, 1.0)
        # distance of the rest position from the vertical
        aside = float(np.hypot(*pull[:2])) / strength
        # largest energy that the centrifugal gradient may add, as a part of the pull
        spread = rate * rate / strength
        reach = math.sqrt(1 - cosine**2) if cosine > 0 else 1.0
        return cls(
            cosine > aside + spread,
            min(reach + aside, 1.0),
            math.sqrt(max(2 * (energy + strength), 0.0)),
        )

    def sizes(self, variables: int) -> Array:
        """Return bounds on positions (radians, or n) and rates (1/s), in the order of a state's variables."""
        # 1 - cos of the largest angle from the vertical
        rise = self.reach**2 / (1 + math.sqrt(1 - self.reach**2))
        positions, rates = (
            (self.reach, self.reach, rise),
            (self.fastest, self.fastest, self.fastest * self.reach),
        )
        half = variables // 2
        return np.maximum([*positions[:half], *rates[:half]], SMALLEST_SIZE)


@dataclass(frozen=True)
class Problem:
    """A scene's initial value problem in binary64.

    Attributes:
        scene: its exact inputs, in the scene's own reading.
        formulation: a key of `reference.model.formulations.FORMULATIONS`.
        constants: of the model, each rounded once.
        start: state at t = 0, rounded once, shape (variables,).
        times: output times in s, increasing, from 0, at least two, shape (rows,).
        sizes: bound on each variable's swing, from the energy; absolute tolerances are parts of it.
        system: the equations, with the constants they use as parameters.
    """

    scene: Scene
    formulation: str
    constants: Constants = field(repr=False)
    start: Array
    times: Array = field(repr=False)
    sizes: Array
    system: FirstOrderSystem = field(repr=False)

    @classmethod
    def of(cls, scene: Scene, formulation: str, times: npt.ArrayLike | None = None) -> Problem:
        """Return the problem of a scene, with output at its own grid times unless others are given.

        Raises:
            InputError: the formulation cannot express the release, or the times do not increase
                from 0.
        """
        model, start = FORMULATIONS[formulation], Start.of(scene.exact, DOUBLE_BITS + GUARD_BITS)
        try:
            state = start.state(model)
        except ValueError as error:
            raise InputError(
                "formulation",
                formulation,
                "a formulation that is valid at the release",
                f"{error}.",
            ) from None
        if times is None:
            times = [float(t) for t in scene.exact.grid]
        rounded = start.k.converted(float)
        return cls(
            scene=scene,
            formulation=formulation,
            constants=rounded,
            start=np.array([float(value) for value in state]),
            times=_increasing(times),
            sizes=SwingReach.of(start).sizes(len(model.variables)),
            system=FirstOrderSystem.of(model.variables, model.derivatives, rounded),
        )

    @property
    def parameters(self) -> Array:
        """Values of the system's parameters, in its order; at least one, for libraries that require one."""
        return np.array([*self.system.parameters.values()] or [0.0])

    @cached_property
    def rates(self) -> Filling:
        """`rates(y, k, dy)` writes the derivatives, compiled by numba; k are the `parameters`."""
        return cast(Filling, self.compiled(self.system.program, _RATES).rates)

    @cached_property
    def slopes(self) -> Filling:
        """`slopes(y, k, j)` writes the Jacobian, shape (variables, variables), compiled by numba."""
        rows = range(len(self.start))
        targets = "".join(elements("j", len(rows), str(i)) for i in rows)
        return cast(Filling, self.compiled(self.system.jacobian, _SLOPES, j=targets).slopes)

    def compiled(self, program: StraightLine, template: str, **texts: object) -> ModuleType:
        """Return the module compiled from a program (the function `traced`) and a template with texts filled in.

        Arguments and targets in the template: `${y}`, `${z}`, `${f}`, `${p}`, `${dy}` are the
        elements of arrays of these names, as many as variables (`${size}`); `${k}` are those of the
        parameters. `${x}` and `${c}` are numbers with names of their own, which `${unpack_y}` and
        `${unpack_k}` take from y and k. `${counter}` is the place behind the parameters, of which
        libraries are given one at least.
        """
        variables, parameters = len(self.start), len(self.system.parameters)
        for array in ("y", "z", "f", "p", "dy"):
            texts[array] = elements(array, variables)
        texts |= {"k": elements("k", parameters), "size": variables, "counter": max(parameters, 1)}
        for letter, array, count in (("x", "y", variables), ("c", "k", parameters)):
            texts[letter] = "".join(f"{letter}{i}, " for i in range(count))
            texts[f"unpack_{array}"] = f"{texts[letter]}= {texts[array]}" if count else "pass"
        return compiled(
            f"@nb.njit(**OPTIONS)\n{program.source('traced')}\n\n{Template(template).substitute(texts)}"
        )

    def cartesian(self, states: Array) -> Array:
        """Return x, y, z in m and vx, vy, vz in m/s, shape (rows, 6), of states of shape (rows, variables)."""
        columns = tuple(np.ascontiguousarray(states.T))
        n, v = FORMULATIONS[self.formulation].cartesian(columns, self.constants, np)
        rows = [np.broadcast_to(part * self.constants.length, len(states)) for part in (*n, *v)]
        return np.array(rows, dtype=np.float64).T.copy()


_RATES = """
@nb.njit(nb.void(STATE, nb.float64[::1], nb.float64[:]), **OPTIONS)
def rates(y, k, dy):
    ${dy}= traced(${y}${k})
"""

_SLOPES = """
@nb.njit(nb.void(STATE, nb.float64[::1], nb.float64[:, :]), **OPTIONS)
def slopes(y, k, j):
    ${j}= traced(${y}${k})
"""


def _increasing(times: npt.ArrayLike) -> Array:
    t = np.array(times, dtype=np.float64).ravel()
    if len(t) < 2 or t[0] != 0 or not np.isfinite(t).all() or not (np.diff(t) > 0).all():
        given = t.tolist() if len(t) < 9 else Described("an array")
        raise InputError("times", given, "at least two finite times, increasing from 0")
    return t


def suited(scene: Scene, formulations: Sequence[str]) -> str:
    """Return the first of some formulations that can describe the scene's whole motion.

    `plane` holds below the horizontal only, and `space` leaves the sphere where a rod is pushed;
    for a bob whose energy may take it there any other formulation is better, `space` is second
    best, and `plane` fails.
    """
    if SwingReach.of(Start.of(scene.exact, DOUBLE_BITS + GUARD_BITS)).below:
        return formulations[0]
    return min(formulations, key=lambda word: {"space": 1, "plane": 2}.get(word, 0))
