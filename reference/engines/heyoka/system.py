"""A formulation as heyoka expressions, ready to be compiled, and as text.

The text names the terms that a scene does not need.

heyoka's cache of machine code on disk is set here too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...errors import Described, InputError, counted
from ...model.algebra import minus, product
from ...model.carried import constant_variables
from ...model.constants import Constants
from ...model.formulations import FORMULATIONS, Formulation, Lagrangian
from ...model.start import Start, xdot_vanishes
from ...numbers.precision import DOUBLE, LONG_DOUBLE, NumberType
from .library import hy

if TYPE_CHECKING:
    from ...scenes.scene import Scene

# in heyoka's own: opening a cache takes the longer the more it holds, of whatever program
FOLDER = "foucault"
_MOST_BYTES = 1 << 25
_EQUATIONS_PREC = 128  # bits; of the constants where exact zeros alone matter


def keep_on_disk(number: NumberType) -> None:
    """Keep on disk the code compiled from now on, if that helps for numbers of this type.

    Beyond hardware numbers the cache never hits, and without a home heyoka has no place for it: it
    is switched off.
    """
    hy.llvm_state.set_diskcache_enabled(number.hardware and _has_place())


@cache
def _has_place() -> bool:
    """Give the cache a folder of its own, of bounded size; return whether it can be used."""
    place = Path(hy.llvm_state.get_diskcache_path())
    if not place.is_absolute():
        return False
    try:
        hy.llvm_state.set_diskcache_path(place / FOLDER)
        hy.llvm_state.set_diskcache_limit(_MOST_BYTES)
    except RuntimeError:  # it cannot be written, or is damaged
        return False
    return True


_NAMES = {
    "turn_1": "Omega_y", "turn_2": "Omega_z", "pull_1": "c_y", "pull_2": "c_z", "centrifugal_0": "Omega2",
    "centrifugal_1": "Omega_z2", "centrifugal_2": "minus_Omega_yz", "centrifugal_3": "Omega_y2", "drag": "gamma",
    "length": "l", "gravity": "g_l", "axis_distance": "R_l", "rate": "Omega", "sin": "sin_lat", "cos": "cos_lat",
}  # fmt: skip


def system_of(formulation: Formulation, constants: Constants) -> tuple[list[tuple[Any, Any]], Any]:
    """Return a formulation's equations as pairs of a variable and its rate, and xdot over l.

    They are heyoka expressions; `constants` are numbers of the run's type, or variables.
    """
    state = hy.make_vars(*formulation.variables)
    _, v = formulation.cartesian(state, constants, hy)
    return as_pairs(state, rates(formulation, constants)(state, hy)), v[0]


def rates(formulation: Formulation, constants: Constants) -> Callable[[Any, Any], Sequence[Any]]:
    """Return a formulation's derivatives as a function of the state and elementary functions."""
    if isinstance(formulation, Lagrangian):
        return lambda state, _: _euler_lagrange(formulation, state, constants)
    return lambda state, functions: formulation.derivatives(state, constants, functions)


def as_pairs(state: Sequence[Any], rates: Sequence[Any]) -> list[tuple[Any, Any]]:
    """Return the pairs (variable, rate) that heyoka takes.

    A rate that is the int 0 becomes an expression.

    Raises:
        InputError: there are not as many rates as variables, or one is neither a number nor an
            expression.
    """
    try:
        expressions = [rate + hy.expression(0.0) for rate in rates]
    except TypeError:
        raise InputError("derivatives", rates, "a list of rates, numbers or expressions") from None
    if len(expressions) != len(state):
        raise InputError(
            "derivatives",
            Described(counted(len(expressions), "rate")),
            f"{len(state)}, one for each variable",
        )
    return [*zip(state, expressions, strict=True)]


def _euler_lagrange(formulation: Lagrangian, state: Any, constants: Constants) -> list[Any]:
    """Return heyoka's equations of L.

    Linear drag, with Rayleigh function γ α0/2, adds -γ q' to each q'', whatever q is.
    """
    derived = hy.lagrangian(
        formulation.lagrangian(state, constants, hy), list(state[:2]), list(state[2:])
    )
    rates = {str(name): rate for name, rate in derived}
    for velocity in state[2:]:
        rates[str(velocity)] = minus(rates[str(velocity)], product(constants.drag, velocity))
    return [rates[str(variable)] for variable in state]


def equations_text(formulation: Formulation, constants: Constants) -> list[str]:
    """Return the lines "name' = …" that are compiled, with constants by name.

    Exact zeros and constant variables are left out.
    """
    named = Constants.of({name: hy.make_vars(_NAMES[name]) for name in constants.entries()})
    constant = constant_variables(formulation, constants)
    equations, _ = system_of(formulation, named)
    lines = []
    for name, (_, rate) in zip(formulation.variables, equations, strict=True):
        if name not in constant:
            lines.append(f"{name}' = {rate}")
    return lines


def lines_and_left_out(scene: Scene, formulation: str, number: str) -> tuple[list[str], list[str]]:
    """Return the compiled lines "name' = …", and the terms that the scene does not need.

    These are sentences, one for each group of terms.

    Args:
        scene: the scene.
        formulation: that the run integrates.
        number: its number type, in words.
    """
    inputs = scene.exact
    run = scene.run
    system = FORMULATIONS[formulation]
    start = Start.of(inputs, _EQUATIONS_PREC)
    turns = inputs.rotation_rate != 0
    at_pole = abs(inputs.latitude) == 90
    at_equator = inputs.latitude == 0
    effective = inputs.gravity_is == "effective"
    no_transits = run.transits and xdot_vanishes(start)
    constant = constant_variables(system, start.k)
    sentences = {
        "Coriolis and centrifugal terms: rotation_rate is 0.": not turns,
        "the distance R from the axis and the terms with Omega_y: the latitude is a pole.": (
            turns and at_pole
        ),
        "the terms with Omega_z and c_y: the latitude is 0.": turns and at_equator,
        "the centrifugal force at the pivot: gravity is effective and contains it.": effective,
        "drag: it is 0.": inputs.drag == 0,
        **{f"the rate of {name}: it is constant.": True for name in constant},
        "gravity: it is 0.": inputs.gravity == 0,
        "event detection: transits are off.": not run.transits,
        "event detection: xdot is identically zero.": no_transits,
        f"extended precision: double serves {run.digits} digits.": number == str(DOUBLE),
        f"precision beyond long double: it serves {run.digits} digits.": number == str(LONG_DOUBLE),
        "the enclosure: the level does not ask for it.": run.level != "enclosed",
    }
    left_out = [sentence for sentence, applies in sentences.items() if applies]
    return equations_text(system, start.k), left_out
