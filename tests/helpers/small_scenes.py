"""Small scenes for tests, the model's constants at a precision, and heyoka's integrator at the release."""

from __future__ import annotations

from typing import Any

from reference.engines.plan import Run
from reference.engines.registry import engines
from reference.model.formulations import FORMULATIONS
from reference.model.start import Start
from reference.numbers.precision import GUARD_BITS, NumberType
from reference.numbers.zeros import XDOT
from reference.scenes.scene import Scene, parse_scene


def make_scene(scene_id: str = "test", **sections: Any) -> Scene:
    """Return a scene from sections given as dicts; Paris where they say nothing."""
    return parse_scene({"id": scene_id, "release": {"x": "0.3", "y": "0.4"}, **sections})


def model_at(scene: Scene, prec: int) -> tuple[Any, Any, Any, Any]:
    """Return context, constants, n and v of a scene at a precision in bits."""
    start = Start.of(scene.exact, prec)
    return start.ctx, start.k, start.n, start.v


def run_in_limbs(
    scene: Scene, prec: int, times: Any, zeros: tuple[str, ...] = (XDOT,), report: Any = None
) -> Run:
    """Return a run of the engine limbs at a precision in bits."""
    limbs = engines()["limbs"]
    return limbs.run(limbs.plan(scene.exact, prec, times, zeros), report)


def start_for(scene: Scene, number: NumberType) -> Start:
    """Return a scene's start as a run in a number type takes it."""
    return Start.of(scene.exact, number.prec + GUARD_BITS)


def stepper_of(
    scene: Scene, number: NumberType, name: str = "momentum", kind: Any = None, **keywords: Any
) -> Any:
    """Return heyoka's integrator of a scene at its release; `kind` is a subclass of it."""
    from reference.engines.heyoka.stepper import Stepper

    return (kind or Stepper)(FORMULATIONS[name], start_for(scene, number), number, **keywords)
