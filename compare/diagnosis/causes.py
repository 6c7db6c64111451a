"""The causes that an error may have (a solar day, no drag, ...), each one change in a `Program`: readings.py chooses.

Causes that exclude each other are in one group. The ids are stable; `text` ends the sentence "Your program …". A cause
with a number in it (`free`) is fitted; all others are named and fixed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from .case import FileCase
from .phasors import METHODS
from .programs import EFFECTIVE_G, WHOLE, Program

NAMED = 0.3  # decades by which a named cause has to lower the residual, to be believed
RARE = 0.5  # one that is met less often
FITTED = 0.7  # and a fitted number
PRINTED_DIGITS = 12  # of a fitted number at most
PUSHED = 0.2  # more, for a velocity where the scene releases at rest
SOLAR_DAY = 86400.0
SIDEREAL_DAYS = (86164.0, 86160.0, 86164.1, 86164.0905, 86164.09)
MEAN_RADIUS = 6371000.0
COMMON_GRAVITY = (9.8, 9.81, 9.80665, 9.82, 9.83, 10.0)
ROUNDED_RATES = (
    7.29e-5,
    7.3e-5,
    7.27e-5,
    7.2722e-5,
    7.292e-5,
    7.2921e-5,
    7.29212e-5,
    7.2921159e-5,
    7.26e-5,
    7e-5,
)
UNITS = {
    "g": " m/s²",
    "length": " m",
    "latitude": " degrees",
    "drag": " per second",
    "x": " m",
    "y": " m",
    "altitude": " m",
    "vx": " m/s",
    "vy": " m/s",
}
EFFECTIVE = "takes g as the effective gravity, which contains the centrifugal force (--set site.gravity_is=effective)"
TWICE = "to a g that contains it already (--set site.gravity_is=ellipsoid)"
ADDED_TWICE = f"adds the centrifugal force {TWICE}"
NO_CHANGE = "leaves out the centrifugal force's change along the swing"
# id, text, factors northward and upward, and decades by which it has to lower the residual
_WRONG_CENTRIFUGAL = (
    (
        "centrifugal_sign",
        "gives the centrifugal force at the suspension the wrong sign",
        -1.0,
        -1.0,
        NAMED,
    ),
    ("centrifugal_double", "adds the centrifugal force at the suspension twice", 2.0, 2.0, NAMED),
    ("tilt_sign", "gives the horizontal centrifugal force the wrong sign", -1.0, 1.0, RARE),
    ("tilt_double", "adds the horizontal centrifugal force twice", 2.0, 1.0, RARE),
    ("lift_sign", "gives the vertical centrifugal force the wrong sign", 1.0, -1.0, RARE),
    ("lift_double", "adds the vertical centrifugal force twice", 1.0, 2.0, RARE),
)
# of many clocks that are off by this factor: it may have another origin
LINSPACE = "as from a linspace that counts its ends wrongly"
CLOCK = "has a clock that runs {value} times as fast as its motion: divide its times by that"
FACTORS = (
    2.0,
    10.0,
    50.0,
    60.0,
    100.0,
    200.0,
    300.0,
    500.0,
    1000.0,
    2000.0,
    3600.0,
    5000.0,
    10000.0,
)


# causes that are the same motion in principle, or nearly
_SAME_MOTION = (
    # a clock that is slow by k: g smaller by k², the rotation by k
    ("clock", "site.gravity"),
    ("clock", "pendulum.length"),
    ("clock", "site.gravity site.rotation_rate"),
    ("clock", "pendulum.length site.rotation_rate"),
    ("site.gravity", "pendulum.length"),
    # the vertical centrifugal force makes g smaller
    ("site.gravity", "no_lift"),
    # the turn of the plane is Ω sin φ, whatever makes it
    ("site.latitude", "site.rotation_rate"),
    ("site.latitude", "solar_day"),
    ("hemisphere", "coriolis_sign"),
    ("hemisphere", "turned_plane_sign"),
    ("coriolis_sign", "turned_plane_sign"),
    ("hemisphere inertial_rest", "turned_plane_sign"),
    ("coriolis_sign inertial_rest", "turned_plane_sign"),
    ("coriolis_sign inertial_rest", "hemisphere inertial_rest"),
    # at the pole there is no centrifugal force at the suspension, and the plane of the swing rests among the stars
    ("pole", "pole no_centrifugal turned_plane"),
    # rows that are late show a bob that moves already
    ("late", "release.vx release.vy"),
)
# causes that differ from a simpler one by the vertical centrifugal force alone: that is the motion of another g
VERTICAL = ("no_tilt", "no_lift", "lift_sign", "lift_double")
# causes that may be the same motion as a simpler one
_SIMPLER = (
    # g without the vertical centrifugal force
    ("effective_gravity site.gravity", "no_tilt"),
    ("no_centrifugal site.gravity", "no_tilt"),
    # the scene's but for its sign
    ("site.latitude", "hemisphere"),
    # Ω turned by 180° about the vertical, and reversed
    ("coriolis_sign frame_x_west", "hemisphere"),
)
_BOTH_WAYS = tuple(way for pair in _SAME_MOTION for way in (pair, pair[::-1]))
# where the first are read, the others are tried
SAME_MOTIONS: tuple[tuple[frozenset[str], frozenset[str]], ...] = tuple(
    (frozenset(before.split()), frozenset(after.split()))
    for before, after in (*_BOTH_WAYS, *_SIMPLER)
)

# what a step error looks like: alone each may be its cause, and two at once are no other motion than a step error's
PHASE = ("site.gravity", "pendulum.length", "clock")
LIKE_A_DRIFT = (*PHASE, "pendulum.drag")
LOOSE = "has a step error: too loose a tolerance or too large a step (phase and amplitude drift)"


def is_like_a_drift(cause_id: str) -> bool:
    """Return whether a cause is the motion of a step error, or one."""
    return cause_id in LIKE_A_DRIFT or cause_id.startswith("integrator")


@dataclass(frozen=True)
class Cause:
    """One thing that a program does otherwise than the scene says.

    Attributes:
        id: a stable word.
        group: causes of one group exclude each other.
        text: the end of the sentence "Your program …"; {value} stands for a fitted number.
        change: gives the program with it.
        cost: decades by which it has to lower the residual.
        free: the field of `Program` whose value is fitted, or "".
        stage: gravity, model, input, release, frame, clock or integrator.
    """

    id: str
    group: str
    text: str
    change: Callable[[Program], Program]
    cost: float = NAMED
    free: str = ""
    stage: str = "input"

    def sentence(self, value: float, uncertainty: float, right: Program) -> str:
        """Return the text with a fitted number to the digits that are known, beside what a right program has."""
        if self.free == "pace":
            number = _printed(1 / value, uncertainty / value**2, 1.0)
        elif self.free == "rate":
            number = _printed(value / right.rate, uncertainty / abs(right.rate), 1.0)
        elif self.free == "step":
            number = f"{value:.3g} s"
        elif self.free == "late":
            side = "early" if value < 0 else "late"
            number = f"{_printed(abs(value), uncertainty, 0.0)} s {side}"
        else:
            scene = float(getattr(right, self.free))
            number = f"{_printed(value, uncertainty, scene)} and not {scene:.10g}"
            number += UNITS.get(self.free, "")
        return self.text.format(value=number)


def _printed(value: float, uncertainty: float, scene: float) -> str:
    """Return a number to the digits that are known, and at least to those that distinguish it from the scene's."""
    nearer = abs(value - scene) / 2
    decimal, _ = shortest_decimal(value, min(uncertainty, nearer))
    return f"{decimal:.{PRINTED_DIGITS}g}"


def shortest_decimal(value: float, doubt: float) -> tuple[float, int]:
    """Return the shortest decimal that is no further from a number than its doubt, and how many digits it has."""
    if abs(value) <= doubt:
        return 0.0, 1
    for digits in range(1, PRINTED_DIGITS):
        decimal = float(f"{value:.{digits}g}")
        if abs(decimal - value) <= doubt:
            return decimal, digits
    return float(f"{value:.{PRINTED_DIGITS}g}"), PRINTED_DIGITS


def causes_of(case: FileCase, kind: str) -> Iterator[Cause]:
    """Yield every cause that the program of a case may have as a member of a family: sphere, linear or angle."""
    right = case.right
    released = case.released
    cord = case.rows.cord
    yield from _gravity(right)
    if right.rate:
        yield from _rotation(right, kind)
        yield from _release()
    yield from _latitude(right)
    yield from _inputs(right, released)
    if cord is not None:
        text = f"has a cord of {cord:.10g} m on average: a spring for a cord, or an integrator that leaves the sphere"
        yield Cause("stretched_cord", "pendulum.length", text, _set(length=cord), NAMED)
    if case.intervals:
        yield from _linspace(case.intervals)
    yield fitted_number("clock", "clock", CLOCK, "pace", stage="clock")
    if not released:
        yield fitted_number("late", "clock", "writes its rows {value}", "late", stage="clock")
    for method in METHODS:
        if method.late and (kind == "sphere" or right.vx or right.vy):
            continue  # it is known from the first rows of a linear motion from rest
        text = f"integrates with {method.title} at a step of about {{value}}"
        cause_id = f"integrator_{method.id}"
        cost = FITTED + RARE * method.late
        yield Cause(cause_id, "integrator", text, _set(method=method), cost, "step", "integrator")


def _linspace(intervals: int) -> Iterator[Cause]:
    """Yield the clocks of a `linspace` that counts its ends wrongly."""
    rows = intervals + 1
    # the times of the clock are those of the motion times 1 + 1/intervals, or times 1 - 1/rows
    clocks = (("fast", intervals, intervals / rows), ("slow", rows, rows / intervals))
    for error, part, pace in clocks:
        text = f"has a clock that is too {error} by one part in {part}, {LINSPACE}"
        yield Cause("linspace_clock", "clock", text, _set(pace=pace), NAMED, stage="clock")


def _set(**fields: object) -> Callable[[Program], Program]:
    return lambda program: program.changed(**fields)


def _coriolis(**factors: float) -> Callable[[Program], Program]:
    """Return a change of some factors of the Coriolis force; the others stay as another cause has set them."""

    def change(program: Program) -> Program:
        before = dict(zip(("north", "up", "both"), program.coriolis, strict=True))
        return program.changed(coriolis=tuple((before | factors).values()))

    return change


def fitted_number(
    cause_id: str, group: str, text: str, free: str, cost: float = FITTED, stage: str = "input"
) -> Cause:
    """Return the cause that a number of a program is another one."""
    return Cause(cause_id, group, text, lambda program: program, cost, free, stage)


# the error of an integrator that has no name: a phase and an amplitude that drift, two numbers of one cause
DRIFT = (
    fitted_number("integrator_loose", "integrator", LOOSE, "phase_gain", stage="integrator"),
    fitted_number("integrator_loose", "integrator", "", "decay_rate", stage="integrator"),
)


def normal_gravities(latitude: float) -> tuple[float, ...]:
    """Return the gravity of the ellipsoid at a latitude in degrees in m/s²: the series of 1980, GRS 80 and WGS 84."""
    sine = math.sin(math.radians(latitude)) ** 2
    double = math.sin(math.radians(2 * latitude)) ** 2
    return (
        9.780327 * (1 + 0.0053024 * sine - 0.0000058 * double),
        9.7803267715 * (1 + 0.001931851353 * sine) / math.sqrt(1 - 0.00669438002290 * sine),
        9.7803253359 * (1 + 0.00193185265241 * sine) / math.sqrt(1 - 0.00669437999013 * sine),
    )


def _gravity(right: Program) -> Iterator[Cause]:
    def reading(
        cause_id: str,
        text: str,
        north: float,
        up: float,
        cost: float = NAMED,
        no_change: bool = False,
    ) -> Cause:
        change = _set(suspension=(north, up), no_change=no_change)
        return Cause(cause_id, "gravity", text, change, cost, stage="gravity")

    ellipsoid = right.suspension == WHOLE
    if right.rate:
        if ellipsoid and right.radius:
            text = f"{EFFECTIVE}, and {NO_CHANGE}"
            yield reading("no_centrifugal", text, 0.0, 0.0, 0.2, no_change=True)
            yield reading("effective_gravity", EFFECTIVE, 0.0, 0.0, 0.2)
            text = "leaves out the horizontal centrifugal force but keeps the vertical one"
            yield reading("no_tilt", text, 0.0, 1.0)
            text = f"{text}, and {NO_CHANGE}"
            yield reading("no_tilt", text, 0.0, 1.0, no_change=True)
            text = "keeps the horizontal centrifugal force but leaves out the vertical one"
            yield reading("no_lift", text, 1.0, 0.0)
            # nor the vertical part at the bob, l below the suspension
            below = right.length * math.cos(math.radians(right.latitude)) / right.axis_distance
            yield reading("no_lift", text, 1.0, below)
            text = "takes the horizontal centrifugal force without the sine of the latitude"
            sine = math.sin(math.radians(right.latitude))
            if sine:
                yield reading("tilt_no_sine", text, 1 / sine, 1.0, RARE)
            for cause_id, text, north, up, cost in _WRONG_CENTRIFUGAL:
                yield reading(cause_id, text, north, up, cost)
            # of a group of its own: whatever is added at the suspension may change along the swing
            no_change = _set(no_change=True)
            yield Cause("uniform_gravity", "gravity_change", NO_CHANGE, no_change, stage="gravity")
        else:
            text = (
                NO_CHANGE if right.suspension == EFFECTIVE_G else "leaves out the centrifugal force"
            )
            yield reading("no_centrifugal", text, 0.0, 0.0, 0.2, no_change=True)
            if right.suspension == EFFECTIVE_G:
                yield reading("ellipsoid_gravity", ADDED_TWICE, 1.0, 1.0)
                text = f"adds the centrifugal force, on a sphere of 6371000 m, {TWICE}"
                on_sphere = _set(suspension=WHOLE, flattening=0.0, radius=MEAN_RADIUS)
                yield Cause("ellipsoid_gravity", "gravity", text, on_sphere, RARE, stage="gravity")
    if right.radius:
        text = (
            "has gravity fall off with the distance from the Earth's centre and point there (1/r²)"
        )
        yield Cause("point_mass", "point_mass", text, _set(point_mass=1.0), stage="gravity")

        def both(program: Program) -> Program:
            """To first order in l/R, for small swings: 2 l/R for the fall-off and l/R for the direction."""
            return program.changed(g=program.g * (1 + 3 * program.length / program.radius))

        yield Cause("point_mass", "point_mass", text, both, stage="gravity")
    if right.flattening and right.rate and ellipsoid:
        text = "treats the Earth as a sphere of the equatorial radius"
        yield Cause("sphere", "earth", text, _set(flattening=0.0), stage="gravity")
        text = f"treats the Earth as a sphere of radius {MEAN_RADIUS:.0f} m"
        yield Cause(
            "mean_sphere", "earth", text, _set(flattening=0.0, radius=MEAN_RADIUS), stage="gravity"
        )
    if right.radius and right.rate and ellipsoid:
        text = "takes site.altitude to be {value}"
        yield fitted_number("site.altitude", "earth", text, "altitude", RARE + FITTED, "gravity")
    for g in COMMON_GRAVITY:
        if abs(g - right.g) > 1e-9:
            text = f"computes with g = {g:g} m/s²"
            yield Cause(f"gravity_{g:g}", "site.gravity", text, _set(g=g))
    for g in normal_gravities(right.latitude) if right.radius else ():
        text = f"computes with the normal gravity of its latitude, g = {g:.10g} m/s²"
        yield Cause("gravity_normal", "site.gravity", text, _set(g=g))


def _rotation(right: Program, kind: str) -> Iterator[Cause]:
    yield from _rates(right)
    yield from _coriolis_forces(kind)
    yield from _turned_planes()
    if kind == "sphere":
        yield from _frames()


def _rate(cause_id: str, text: str, value: float, cost: float = NAMED) -> Cause:
    """Return the cause that a rotation rate is another one."""
    return Cause(cause_id, "rate", text, _set(rate=value), cost)


def _rates(right: Program) -> Iterator[Cause]:
    """Yield other rotation rates."""
    sign = math.copysign(1.0, right.rate)
    size = abs(right.rate)
    is_earth = abs(size / 7.292115e-5 - 1) < 0.01
    solar = 2 * math.pi / SOLAR_DAY
    if is_earth:
        yield from _rates_of_earth(right)
    for factor in FACTORS:
        text = f"turns the Earth {factor:g} times too fast"
        cost = NAMED if factor > 2 else 0.45
        yield _rate("rate_factor", text, factor * right.rate, cost)
        if is_earth and factor > 2:
            yield _rate("rate_factor", f"{text}, in a solar day", sign * factor * solar, 0.4)
    yield _rate("no_rotation", "leaves out the rotation of the Earth", 0.0, 0.45)
    text = "turns {value} times as fast as the scene's Earth"
    yield fitted_number("site.rotation_rate", "rate", text, "rate")


def _rates_of_earth(right: Program) -> Iterator[Cause]:
    """Yield other rates that a program of the Earth may have."""
    sign = math.copysign(1.0, right.rate)
    size = abs(right.rate)
    solar = 2 * math.pi / SOLAR_DAY
    if abs(size / solar - 1) > 1e-7:
        text = "turns the Earth once in a solar day (86400 s) instead of a sidereal day (86164.1 s)"
        yield _rate("solar_day", text, sign * solar)
    for value in ROUNDED_RATES:
        if abs(value / size - 1) > 1e-9:
            text = f"rounds the rotation rate to {value:g} rad/s"
            yield _rate("rounded_rate", text, sign * value, 0.4)
    for day in SIDEREAL_DAYS:
        if abs(2 * math.pi / day / size - 1) > 1e-9:
            text = f"turns the Earth once in {day:.10g} s"
            yield _rate("sidereal_day", text, sign * 2 * math.pi / day, 0.4)
    for hours in (24.0, 23.9345, 23.93447):
        rate = f"2π/{hours:g}, which is the rotation rate in radians per hour"
        text = f"takes {rate}, as radians per second (divide by 3600)"
        yield _rate("rate_per_hour", text, sign * 2 * math.pi / hours)
    degrees = math.degrees(right.rate)
    text = "takes the rotation rate in degrees per hour as radians per second"
    yield _rate("rate_in_degrees_per_hour", text, degrees * 3600)
    text = "takes the rotation rate in degrees as radians"
    yield _rate("rate_in_degrees", text, degrees)


def _coriolis_forces(kind: str) -> Iterator[Cause]:
    """Yield other Coriolis forces."""
    # both are one motion: the centrifugal force has the square of the rate
    wrong_sign = "gives the Coriolis force the wrong sign, or turns the Earth the other way"
    factors = (
        ("coriolis_sign", wrong_sign, -1.0),
        ("coriolis_half", "omits the factor 2 in the Coriolis force", 0.5),
        ("coriolis_double", "doubles the Coriolis force", 2.0),
        ("no_coriolis", "leaves out the Coriolis force", 0.0),
    )
    for cause_id, text, factor in factors:
        yield Cause(cause_id, "coriolis", text, _coriolis(both=factor))
    if kind != "sphere":
        return
    text = "uses only the vertical part of Ω in the Coriolis force"
    yield Cause("vertical_only", "turn", text, _coriolis(north=0.0))
    text = "gives the horizontal part of Ω the wrong sign"
    yield Cause("horizontal_sign", "turn", text, _coriolis(north=-1.0), RARE)
    text = "gives the vertical part of Ω the wrong sign"
    yield Cause("vertical_sign", "turn", text, _coriolis(up=-1.0), RARE)


def _turned_planes() -> Iterator[Cause]:
    """Yield planes that are turned by hand."""
    text = "is a pendulum that feels no rotation, whose plane is turned by hand"
    by_hand = _set(turned_plane=True)
    yield Cause("turned_plane", "coriolis", text, by_hand, RARE, stage="model")
    backwards = _set(turned_plane=True, coriolis=(1.0, 1.0, -1.0))
    text = f"{text} the wrong way round"
    yield Cause("turned_plane_sign", "coriolis", text, backwards, RARE, stage="model")


def _frames() -> Iterator[Cause]:
    """Yield other horizontal axes."""
    frames = (
        ("frame_x_south", "x points south and y east", (0.0, -1.0, 1.0, 0.0)),
        ("frame_x_north", "x points north and y west", (0.0, 1.0, -1.0, 0.0)),
        ("frame_x_west", "x points west and y south", (-1.0, 0.0, 0.0, -1.0)),
        ("frame_x_north_y_east", "x points north and y east", (0.0, 1.0, 1.0, 0.0)),
    )
    for cause_id, axes, matrix in frames:
        own = f"uses axes of its own, in which {axes}"
        text = f"{own}, and takes the release's x and y in them"
        yield Cause(cause_id, "frame", text, _set(frame=matrix), 0.4, stage="frame")


def _latitude(right: Program) -> Iterator[Cause]:
    latitude = right.latitude
    if latitude:
        # of a group of its own: another latitude may have the wrong sign as well
        text = "gives the latitude the wrong sign"
        yield Cause("hemisphere", "hemisphere", text, _other_hemisphere, 0.35)
        radians = math.degrees(latitude) % 360
        text = "takes the latitude in degrees as if it were in radians"
        yield Cause("radians", "latitude", text, _set(coriolis_latitude=radians))
        # its cosine's sign stays in the turn
        folded = math.degrees(math.asin(math.sin(math.radians(radians))))
        yield Cause("radians", "latitude", text, _set(latitude=folded, coriolis_latitude=radians))
    text = "uses the colatitude instead of the latitude"
    yield Cause("colatitude", "latitude", text, _set(latitude=90 - abs(latitude)))
    pole = math.copysign(90.0, latitude)
    origin = f"(latitude {pole:g}, or no sine of the latitude)"
    all_of_omega = f"takes the vertical part of Ω to be all of Ω, as at the pole {origin}"
    if latitude != pole:
        text = f"{all_of_omega}, and g as the effective gravity"
        yield Cause("pole", "latitude", text, _at_the_pole)
    if abs(latitude) not in (0.0, 90.0):
        yield Cause("no_sine", "latitude", all_of_omega, _set(coriolis_latitude=pole))
        if right.flattening:
            phi = math.radians(latitude)
            squeeze = (1 - right.flattening) ** 2
            geocentric = math.degrees(math.atan2(squeeze * math.sin(phi), math.cos(phi)))
            text = "uses the geocentric latitude instead of the geodetic one"
            yield Cause("geocentric", "latitude", text, _set(latitude=geocentric))
            text = "uses the geocentric latitude in the Coriolis force"
            yield Cause("geocentric", "latitude", text, _set(coriolis_latitude=geocentric), 0.4)
        yield fitted_number(
            "site.latitude", "latitude", "takes site.latitude to be {value}", "latitude"
        )


def _other_hemisphere(program: Program) -> Program:
    """Return a program with its latitude's other sign."""
    return program.changed(latitude=-program.latitude)


def _at_the_pole(program: Program) -> Program:
    """Return a program at the pole of its hemisphere."""
    return program.changed(latitude=math.copysign(90.0, program.latitude))


def _release() -> Iterator[Cause]:
    speeds = (
        ("inertial_rest", "at rest relative to the stars, not to the ground", 1.0, NAMED),
        (
            "inertial_rest_sign",
            "with the velocity of rest relative to the stars, but of the wrong sign",
            -1.0,
            0.4,
        ),
        ("release_at_twice", "with twice the velocity of rest relative to the stars", 2.0, 0.4),
        (
            "release_at_twice",
            "with twice the velocity of rest relative to the stars, of the wrong sign",
            -2.0,
            0.4,
        ),
    )
    for cause_id, how, factor, cost in speeds:
        yield Cause(
            cause_id,
            "release",
            f"releases the bob {how}",
            _set(released=factor),
            cost,
            stage="release",
        )


def _inputs(right: Program, released: bool) -> Iterator[Cause]:
    if right.vx or right.vy:
        yield Cause(
            "at_rest", "release", "releases the bob at rest", _set(vx=0.0, vy=0.0), stage="release"
        )
    if right.x != right.y and not released:
        swapped = _set(x=right.y, y=right.x, vx=right.vy, vy=right.vx)
        yield Cause("swapped", "start", "swaps x and y of the release", swapped, stage="release")
    if right.drag:
        yield Cause("no_drag", "drag", "leaves out the drag", _set(drag=0.0))
        yield Cause("drag_half", "drag", "takes half the drag", _set(drag=right.drag / 2), 0.4)
        yield Cause("drag_double", "drag", "takes twice the drag", _set(drag=2 * right.drag), 0.4)
    for name, cause_id in (
        ("g", "site.gravity"),
        ("length", "pendulum.length"),
        ("drag", "pendulum.drag"),
    ):
        yield fitted_number(cause_id, cause_id, f"takes {cause_id} to be {{value}}", name)
    for name in ("vx", "vy") if released else ("x", "y", "vx", "vy"):
        cause_id = f"release.{name}"
        group = "start" if name in ("x", "y") else "release"
        # a push that the scene does not have is rarer than half a step of an integrator, which looks like one
        cost = FITTED if name in ("x", "y") or right.vx or right.vy else FITTED + PUSHED
        yield fitted_number(
            cause_id, f"{group}.{name}", f"takes {cause_id} to be {{value}}", name, cost, "release"
        )
