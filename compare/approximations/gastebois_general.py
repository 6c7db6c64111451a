"""Spherical pendulum of any amplitude in uniform apparent gravity, with the Coriolis force: Gastebois 7.2.

His angles θ (from the plumb line) and φ (from east to north) are singular on the plumb line. Along the scene's axes
his system is the model without the centrifugal gradient: the apparent gravity is everywhere that at the suspension,
`pull`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from reference import Scene
from reference.model.constants import Constants
from reference.model.formulations import FORMULATIONS

from .approximation import Array, Motion, Order
from .case import Case
from .truncated import integrated


def uniform(k: Constants) -> Constants:
    """Return the model's constants with the apparent gravity at the suspension everywhere."""
    return replace(k, centrifugal=(0, 0, 0, 0))


def hanging(scene: Scene) -> Any:
    """Return his rest position in m, along the apparent gravity of 4.2: (0, -l sin α, -l cos α)."""
    case = Case.of_scene(scene)
    return (0, -case.length * case.ctx.sin(case.tilt), -case.length * case.ctx.cos(case.tilt))


def _path(scene: Scene, times: Array) -> Array:
    case, model = Case.of_scene(scene), FORMULATIONS["spin"]
    case = replace(case, k=uniform(case.k))
    k = case.k
    states = integrated(model.variables, model.derivatives, case.state(model), k, times)
    place, speed = model.cartesian(tuple(states.T), k, np)
    return np.column_stack((*place, *speed)) * float(case.length)


APPROXIMATIONS = (
    Motion(
        id="gastebois_general",
        title="any amplitude in uniform apparent gravity",
        where="Gastebois 7.2, with g_a and λ_a of 4.2",
        domain="any amplitude; a day",
        drops="the centrifugal gradient: Ω² times distances of the order of l",
        orders=(
            Order("amplitude", None, (0.5, 8.0, 66.0), ("site.rotation_rate=0",)),
            Order("rotation_rate", 2, (5e-5, 1e-4, 2e-4, 4e-4), (), 0.5),
        ),
        path=_path,
        rest=hanging,
    ),
)
