"""The compiled equations of a scene as text, and the terms that are left out of them, with the reason."""

from __future__ import annotations

from ..model.carried import constant_variables
from ..model.formulations import FORMULATIONS
from ..model.start import Start, xdot_vanishes
from ..numbers.precision import DOUBLE, LONG_DOUBLE
from ..scenes.scene import Scene
from .heyoka.system import equations_text

_PREC = 128  # bits; only exact zeros matter here


def lines_and_left_out(scene: Scene, formulation: str, number: str) -> tuple[list[str], list[str]]:
    """Return the compiled lines "name' = …", and a sentence for each group of terms that the scene does not need.

    Args:
        scene: the scene.
        formulation: that the run integrates.
        number: its number type, in words.
    """
    inputs, system, left_out = scene.exact, FORMULATIONS[formulation], []
    start = Start.of(inputs, _PREC)
    if inputs.rotation_rate == 0:
        left_out.append("Coriolis and centrifugal terms: rotation_rate is 0.")
    elif abs(inputs.latitude) == 90:
        left_out.append("the distance R from the axis and the terms with Omega_y: the latitude is a pole.")
    elif inputs.latitude == 0:
        left_out.append("the terms with Omega_z and c_y: the latitude is 0.")
    if inputs.gravity_is == "effective":
        left_out.append("the centrifugal force at the pivot: gravity is effective and contains it.")
    if inputs.drag == 0:
        left_out.append("drag: it is 0.")
    left_out += [f"the rate of {name}: it is constant." for name in constant_variables(system, start.k)]
    if inputs.gravity == 0:
        left_out.append("gravity: it is 0.")
    if not scene.run.transits:
        left_out.append("event detection: transits are off.")
    elif xdot_vanishes(start):
        left_out.append("event detection: xdot is identically zero.")
    if number == str(DOUBLE):
        left_out.append(f"extended precision: double serves {scene.run.digits} digits.")
    elif number == str(LONG_DOUBLE):
        left_out.append(f"precision beyond long double: it serves {scene.run.digits} digits.")
    if scene.run.level != "enclosed":
        left_out.append("the enclosure: the level does not ask for it.")
    return equations_text(system, start.k), left_out
