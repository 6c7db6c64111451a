"""A scene with another amplitude, latitude, length or rotation rate."""

from __future__ import annotations

from typing import Any

from reference import InputError, Scene, parse_scene

from ..approximations.case import Case

UNITS: dict[str, str] = {"amplitude": "m", "latitude": "degrees", "length": "m", "rotation_rate": "rad/s"}
_DIGITS = 40  # of a release as it is written into a scene
_FIELDS = {"latitude": "site.latitude", "rotation_rate": "site.rotation_rate"}


def varied(scene: Scene, over: str, value: float | str) -> Scene:
    """Return the scene with one quantity changed.

    Args:
        scene: to start from.
        over: `latitude` or `rotation_rate`: that field; `length`: of the cord, with the angle of release kept;
            `amplitude`: horizontal distance of the release from the rest position in m, with its direction kept,
            and the velocity of the release in proportion.
        value: its new value.

    Raises:
        InputError: `over` is unknown, or no scene can have the value.
    """
    text = value if isinstance(value, str) else repr(float(value))
    if over in _FIELDS:
        return scene.with_values([f"{_FIELDS[over]}={text}"])
    if over == "length":
        return _lengthened(scene, text)
    if over == "amplitude":
        return _displaced(scene, text)
    raise InputError("over", over, f"one of {', '.join(UNITS)}")


def _lengthened(scene: Scene, text: str) -> Scene:
    case = Case.of_scene(scene)
    if scene.exact.position is not None:
        ratio = case.ctx.mpf(text) / case.length
        place, speed = (tuple(part * ratio for part in v) for v in (case.position, case.velocity))
        document = scene.model_dump(exclude_none=True) | {"release": _release(case, place, speed)}
        document["pendulum"]["length"] = text
        return parse_scene(document)
    return scene.with_values([f"pendulum.length={text}"])


def released(scene: Scene, east: float, north: float) -> Scene:
    """Return the scene released without velocity, `east` and `north` m (horizontally) from its rest position."""
    case = Case.of_scene(scene)
    y = case.ctx.mpf(case.rest[1]) * case.length + case.ctx.mpf(north)
    return _with_release(scene, _release(case, (case.ctx.mpf(east), y), (0, 0)))


def _displaced(scene: Scene, text: str) -> Scene:
    case = Case.of_scene(scene)
    rest_y = case.ctx.mpf(case.rest[1]) * case.length
    east, north = case.position[0], case.position[1] - rest_y
    amplitude = case.ctx.hypot(east, north)
    if not amplitude:
        raise InputError(
            "release", f"x = {scene.release.x}, y = {scene.release.y}", "a release away from the rest position"
        )
    ratio = case.ctx.mpf(text) / amplitude
    velocity = tuple(part * ratio for part in case.velocity)
    return _with_release(scene, _release(case, (east * ratio, rest_y + north * ratio), velocity))


def _with_release(scene: Scene, release: dict[str, str]) -> Scene:
    return parse_scene(scene.model_dump(exclude_none=True) | {"release": release})


def _release(case: Case, place: Any, velocity: Any) -> dict[str, str]:
    values = {"x": place[0], "y": place[1], "vx": velocity[0], "vy": velocity[1]}
    return {name: str(case.ctx.nstr(case.ctx.mpf(value), _DIGITS)) for name, value in values.items()}
