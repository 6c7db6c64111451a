"""A formulation without the variables that are constant on a scene, such as H_z at a pole: they are not integrated."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from .algebra import Functions, State
from .constants import Constants, Vector, is_zero
from .formulations import Formulation
from .start import Start

# any state will do: rates that vanish do so by the exact zeros of k
_PLACES = (0.11, 0.23, 0.31, 0.17, 0.13, 0.19)


def constant_variables(formulation: Formulation, k: Constants) -> list[str]:
    """Return the variables of a formulation whose rates are exactly zero, by the constants of a scene alone."""
    unit_constants = k.converted(lambda _: 1.0)
    rates = formulation.derivatives(_PLACES[: len(formulation.variables)], unit_constants, math)
    return [name for name, rate in zip(formulation.variables, rates, strict=True) if is_zero(rate)]


def carried(formulation: Formulation, start: Start, number: Callable[[Any], Any]) -> Formulation:
    """Return a formulation without its constant variables; itself if it has none.

    Args:
        formulation: to be integrated.
        start: constants and release of a scene.
        number: rounds an mpf to the number type of the run.
    """
    names = constant_variables(formulation, start.k)
    if not names:
        return formulation
    values = zip(formulation.variables, start.state(formulation), strict=True)
    return _CarriedFormulation(
        formulation, {name: number(value) for name, value in values if name in names}
    )


@dataclass(frozen=True)
class _CarriedFormulation:
    """A formulation of which only some variables are integrated.

    Attributes:
        whole: the formulation.
        constant: values of the others, in the number type of the run.
    """

    whole: Formulation
    constant: dict[str, Any]

    @property
    def name(self) -> str:
        """The formulation's name."""
        return self.whole.name

    @property
    def variables(self) -> tuple[str, ...]:
        """The variables that are integrated."""
        return tuple(name for name in self.whole.variables if name not in self.constant)

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """Return the state of a bob at n = r/l with velocity v = r'/l."""
        return self._kept(self.whole.start(n, v, k, functions))

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """Return n and n' of a state."""
        return self.whole.cartesian(self._full(state), k, functions)

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Return the rates of the variables that are integrated."""
        return self._kept(self.whole.derivatives(self._full(state), k, functions))

    def _kept(self, values: Sequence[Any]) -> State:
        pairs = zip(self.whole.variables, values, strict=True)
        return tuple(value for name, value in pairs if name not in self.constant)

    def _full(self, state: State) -> State:
        values = iter(state)
        return tuple(
            self.constant[name] if name in self.constant else next(values)
            for name in self.whole.variables
        )
