"""Small scenes for tests, the model's constants at a precision, and heyoka's integrator at the release."""

from __future__ import annotations

from typing import Any

from reference.engines.run import start_of
from reference.model.constants import constants, release, scaled
from reference.model.formulations import FORMULATIONS
from reference.precision import NumberType, context
from reference.scene import Scene, parse_scene


def make_scene(scene_id: str = "test", **sections: Any) -> Scene:
    """Return a scene from sections given as dicts; Paris where they say nothing."""
    return parse_scene({"id": scene_id, "release": {"x": "0.3", "y": "0.4"}, **sections})


def model_at(scene: Scene, prec: int) -> tuple[Any, Any, Any, Any]:
    """Return context, constants, n and v of a scene at a precision in bits."""
    ctx = context(prec)
    k = constants(scene.exact, ctx)
    position, velocity = release(scene.exact, ctx)
    return ctx, k, scaled(position, k.length), scaled(velocity, k.length)


def stepper_of(scene: Scene, number: NumberType, name: str = "momentum", **keywords: Any) -> Any:
    """Return heyoka's integrator of a scene at its release."""
    from reference.engines.heyoka.stepper import Stepper

    ctx, k, n, v = start_of(scene.exact, number)
    return Stepper(FORMULATIONS[name], k, n, v, ctx, number, **keywords)
