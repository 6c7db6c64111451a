"""A scene for people, one fact on each line: its inputs, and what follows from them without solving it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from math import log

from ..scenes.inputs import GRAVITY_MEANINGS
from ..scenes.scene import Scene, unit_of
from .layout import Fact, enumerated
from .progress import duration_in_words

_READINGS = {
    "decimal": "decimal: each number is exact as written",
    "binary64": "binary64: each number is the double nearest to it",
}
# inputs that are named if they have no width; those of the release come to them
_MEASURED = ("pendulum.length", "pendulum.drag", "site.latitude", "site.gravity")
_UNCERTAIN_DIGITS = 6  # of the period of small swings, where inputs are uncertain
_SEEN_M = 1e-6  # a rest position nearer to the vertical is not told apart from it by eye or tape
_LEAST_DRAG = 1e-300  # in 1/s: how soon a smaller one halves the swing is beyond the range of doubles, or nearly
# of a compass, clockwise from north
_DIRECTIONS = (
    "north",
    "north-north-east",
    "north-east",
    "east-north-east",
    "east",
    "east-south-east",
    "south-east",
    "south-south-east",
    "south",
    "south-south-west",
    "south-west",
    "west-south-west",
    "west",
    "west-north-west",
    "north-west",
    "north-north-west",
)


def title_of(scene: Scene) -> str:
    """Return the id and the title of a scene."""
    return f"{scene.id}: {scene.title}" if scene.title else scene.id


def input_facts(
    scene: Scene, flag_meanings: dict[str, str], widths: Mapping[str, str]
) -> Iterator[Fact]:
    """Yield the inputs of a scene in words and with units, with a line for each flag and each uncertain input.

    Args:
        scene: the scene.
        flag_meanings: its flags, and what they mean.
        widths: half of the width of each input that is taken as uncertain.
    """
    if scene.source:
        yield "source", scene.source
    for flag, meaning in flag_meanings.items():
        yield "difficult", f"{flag}: {meaning}"
    yield "cord", _cord(scene)
    yield "site", _site(scene)
    site = scene.site
    yield "gravity", f"{site.gravity} m/s², {GRAVITY_MEANINGS[site.gravity_is]} ({site.gravity_is})"
    yield "Earth", _earth(scene)
    yield "release", _release(scene)
    yield "run", _run(scene)
    if scene.run.sections:
        yield "sections", ", ".join(scene.run.sections)
    for name, width in widths.items():
        yield "uncertain", f"{name} ±{width} {unit_of(name)}".rstrip()
    exact = _exact_beside(scene, widths)
    if exact:
        yield "without width", f"{enumerated(exact)}: taken as exact"
    yield "inputs", _READINGS[scene.inputs]


def _exact_beside(scene: Scene, widths: Mapping[str, str]) -> list[str]:
    """Return the inputs that somebody measures and that have no width, while others have one."""
    if not widths:
        return []
    release = [name for name in scene.exact.by_name if name.startswith("release.")]
    return [name for name in (*_MEASURED, *release) if name not in widths]


def derived_facts(derived: dict[str, str], *, is_uncertain: bool = False) -> Iterator[Fact]:
    """Yield what follows from the inputs of a scene, such as its rest position, or that it has none.

    Args:
        derived: the numbers, as text.
        is_uncertain: whether inputs are uncertain. Then the period of small swings has six digits, and a rest
            position within a micrometre of the vertical is not shown.
    """
    if "axis_distance_m" in derived:
        yield "Earth's axis", f"{derived['axis_distance_m']} m away"
    pull = f"{derived['pivot_gravity_m_s2']} m/s²"
    yield "pull", f"{pull}, gravity and centrifugal force together"
    if "normal_gravity_m_s2" in derived:
        normal = f"{derived['normal_gravity_m_s2']} m/s²"
        yield "normal gravity", f"{normal} at this latitude (GRS 80), effective"
    if "small_swing_period_s" in derived:
        period_s = derived["small_swing_period_s"]
        if is_uncertain:
            period_s = f"{float(period_s):.{_UNCERTAIN_DIGITS}g}"
        yield "small swing", f"{period_s} s"
    if "rest_y_m" not in derived:
        yield "rest position", "none"
    elif not (is_uncertain and abs(float(derived["rest_y_m"])) < _SEEN_M):
        yield "hangs", _rest(derived)


def _cord(scene: Scene) -> str:
    return f"{scene.pendulum.length} m, {_drag(scene)}"


def _drag(scene: Scene) -> str:
    """Return the drag, and how soon the swing halves; a bob that creeps does not swing."""
    drag = scene.exact.drag
    if not drag:
        return "no drag"
    text = f"drag {scene.pendulum.drag} 1/s"
    if scene.exact.creeps or not scene.exact.gravity or float(drag) < _LEAST_DRAG:
        return text
    halves_s = 2 * log(2) / float(drag)
    return f"{text} (the swing halves in {duration_in_words(halves_s)})"


def _site(scene: Scene) -> str:
    latitude = toward(scene.site.latitude, "° north", "° south")
    return f"{latitude}, altitude {scene.site.altitude} m"


def _earth(scene: Scene) -> str:
    site = scene.site
    if site.inverse_flattening == "inf":
        shape = "a sphere"
    else:
        shape = f"flattening 1/{site.inverse_flattening}"
    return f"turns at {site.rotation_rate} rad/s; radius {site.equatorial_radius} m, {shape}"


def _release(scene: Scene) -> str:
    """Return where the bob is let go, and how fast it moves then."""
    release = scene.release
    if release.angle is None:
        east = toward(release.x or "0", " m east", " m west")
        north = toward(release.y or "0", " m north", " m south")
        place = f"{east}, {north} of the suspension"
        rates = {"m/s east": release.vx, "m/s north": release.vy}
    else:
        azimuth = f"azimuth {release.azimuth}° ({_bearing(scene)})"
        place = f"{release.angle}° from straight down, {azimuth}"
        rates = {
            "°/s of the angle": release.angle_rate,
            "°/s of the azimuth": release.azimuth_rate,
        }
    moving = [f"{rate} {unit}" for unit, rate in rates.items() if rate and float(rate)]
    if not moving:
        return f"{place}, at rest"
    return f"{place}, moving at {' and '.join(moving)}"


def _bearing(scene: Scene) -> str:
    """Return the compass bearing of the azimuth of the release, and the nearest of 16 directions."""
    bearing = (90 - scene.exact.by_name["release.azimuth"]) % 360
    direction = _DIRECTIONS[round(bearing / Fraction(45, 2)) % len(_DIRECTIONS)]
    return f"bearing {float(bearing):g}°, {direction}"


def _run(scene: Scene) -> str:
    run = scene.run
    transits = "" if run.transits else ", no transits"
    return (
        f"{run.t_end} s, a row each {run.grid_step} s, {run.digits} digits, {run.level}{transits}"
    )


def _rest(derived: dict[str, str]) -> str:
    """Return the rest position of the bob, about which it swings."""
    aside_m = float(derived["rest_y_m"])
    upward = " above the suspension" if float(derived["rest_z_m"]) > 0 else ""
    if not aside_m:
        return f"in the vertical{upward}"
    return f"{toward(f'{aside_m:.4g}', ' m north', ' m south')} of the vertical{upward}"


def toward(number: str, positive: str, negative: str) -> str:
    """Return the absolute value of a number, and the word for the side that its sign means."""
    if number.startswith("-"):
        return f"{number[1:]}{negative}"
    return f"{number.removeprefix('+')}{positive}"
