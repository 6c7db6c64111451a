"""The tables of a scene, [pendulum], [site], [release] and [run]: each field with its default, unit and meaning.

The template, the schema and the tables of docs/scene.md are made from what stands here.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from .inputs import GravityIs, NotNegative, Number, NumberOrInf, Positive, Refused, within
from .sections import Sections

MAX_DIGITS = 1000

Level = Literal["computed", "self_consistent", "confirmed", "enclosed"]
LEVELS: tuple[Level, ...] = get_args(Level)
Confirmation = Literal["whole", "sampled", "none"]  # how much of a proof heyoka confirms
CONFIRMATIONS: tuple[Confirmation, ...] = get_args(Confirmation)


def field(default: Any, unit: str, meaning: str) -> Any:
    """Return a field of a table: its default (`...` if it has to be given), its unit ("" for none) and its meaning."""
    return Field(default, description=meaning, json_schema_extra={"unit": unit} if unit else None)


class SceneTable(BaseModel):
    """A table of a scene: frozen, without fields of other names."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Pendulum(SceneTable):
    """The cord, and what slows the bob down."""

    length: Positive = field("67", "m", "length of the cord, from the suspension to the centre of the bob")
    drag: NotNegative = field(
        "0", "1/s", "linear drag, deceleration over velocity: 2 ln 2 over the time in which the swing halves"
    )


class Site(SceneTable):
    """Where the suspension stands, how strong gravity is there and what it means, and the Earth that carries it."""

    latitude: Annotated[Number, within("-90", "90")] = field(
        "48.846111", "degrees", "geodetic latitude, negative in the south"
    )
    altitude: Number = field("0", "m", "height of the suspension above the ellipsoid")
    gravity: NotNegative = field("9.80665", "m/s²", "strength of gravity")
    gravity_is: GravityIs = field(
        "ellipsoid",
        "",
        "ellipsoid: gravity alone, to which the centrifugal force is added; effective: as measured, which contains it",
    )
    rotation_rate: Number = field("7.292115e-5", "rad/s", "rate at which the Earth turns")
    equatorial_radius: NotNegative = field("6378137", "m", "radius of the ellipsoid at the equator")
    inverse_flattening: Annotated[NumberOrInf, within("1", open_low=True)] = field(
        "298.257223564", "", 'inverse flattening of the ellipsoid; "inf" for a sphere'
    )


class Release(SceneTable):
    """Where the bob is let go and how fast it moves then: either x and y, or angle and azimuth."""

    x: Number | None = field(None, "m", "how far east of the suspension; the bob is below it")
    y: Number | None = field(None, "m", "how far north of the suspension")
    vx: Number | None = field(None, "m/s", "velocity to the east")
    vy: Number | None = field(None, "m/s", "velocity to the north")
    angle: Annotated[Number, within("0", "180")] | None = field(
        None, "degrees", "angle of the cord from straight down; 90 is horizontal"
    )
    azimuth: Annotated[Number, within("-360", "360")] | None = field(
        None, "degrees", "direction of the bob, from east to north: 0 is east, 90 north; 90 minus the compass bearing"
    )
    angle_rate: Number | None = field(None, "degrees/s", "rate of the angle")
    azimuth_rate: Number | None = field(None, "degrees/s", "rate of the azimuth")


def _digits(value: int) -> int:
    if not 1 <= value <= MAX_DIGITS:
        raise Refused(f"a whole number from 1 to {MAX_DIGITS}")
    return value


class RunTable(SceneTable):
    """How long the motion is followed, when it is printed, and how far the digits are to be trusted."""

    t_end: Annotated[Number, within("0", "1e15", open_low=True)] = field("86400", "s", "end of the motion")
    grid_step: Positive = field("60", "s", "time between two rows of the grid")
    digits: Annotated[int, AfterValidator(_digits)] = field(40, "", f"significant digits, at most {MAX_DIGITS}")
    level: Level = field("confirmed", "", "what has to stand behind every digit; enclosed is a proof")
    transits: bool = field(True, "", "whether the times of the transits are sought")
    sections: Sections = field(
        None, "", "other moments that are sought: highest, lowest, gate AZIMUTH, gate AZIMUTH@0, turn AZIMUTH"
    )
