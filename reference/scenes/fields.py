"""The tables of a scene, [pendulum], [site], [release] and [run]: each field with its default, unit and meaning.

The template, the schema and the tables of docs/scene.md are made from what stands here.
"""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema

from .inputs import GRAVITY_MEANINGS, GravityIs, azimuth_of
from .texts import OR_INF, NotNegative, Number, Positive, Refused, checked, within

_MAX_DIGITS = 1000

Level = Literal["computed", "self_consistent", "confirmed", "enclosed"]
LEVELS: tuple[Level, ...] = get_args(Level)
Confirmation = Literal["whole", "sampled", "none"]  # how much of a proof heyoka confirms
CONFIRMATIONS: tuple[Confirmation, ...] = get_args(Confirmation)
# Sections: the moments of a motion that are sought besides the transits, each named by a word of
# the scene.
SECTION_SEPARATOR = "; "  # of several words in a text
_SECTION_WORDS = "highest, lowest, gate AZIMUTH, gate AZIMUTH@0 or turn AZIMUTH"
_AZIMUTH = "-?[0-9]{1,3}(?:[.][0-9]{1,200})?"
SECTION_WORD = f"highest|lowest|turn {_AZIMUTH}|gate {_AZIMUTH}(?:@0)?"  # as a regular expression


def _section_words(value: Any) -> Any:
    """Return words from a list, or from a text with semicolons or commas between them.

    Each has single spaces.
    """
    listed = re.split("[;,]", value) if isinstance(value, str) else value
    if listed is None:
        return None
    if not isinstance(listed, list | tuple) or not all(isinstance(word, str) for word in listed):
        raise Refused(
            f"a list of words: {_SECTION_WORDS}",
            'Write each in quotes: sections = ["highest", "gate 45"].',
        )
    words = (" ".join(word.split()) for word in listed)
    return tuple(word for word in words if word) or None


def _checked_sections(words: tuple[str, ...]) -> tuple[str, ...]:
    for word in words:
        if not re.fullmatch(SECTION_WORD, word, re.ASCII) or abs(azimuth_of(word)) > 360:
            advice = f"{word!r} is not one of them; an azimuth is a decimal from -360 to 360 degrees, east to north."
            raise Refused(_SECTION_WORDS, advice)
    if len(set(words)) < len(words):
        raise Refused("different sections", "Leave out the repeated one.")
    return words


_SCHEMA = {"type": "array", "items": {"type": "string", "pattern": f"^({SECTION_WORD})$"}}
Sections = Annotated[
    Annotated[tuple[str, ...], AfterValidator(_checked_sections)] | None,
    BeforeValidator(_section_words),
    WithJsonSchema(_SCHEMA),
]


def field(default: Any, unit: str, meaning: str) -> Any:
    """Return a field of a table: its default (`...` if it has to be given), its unit ("" for none) and its meaning."""
    return Field(default, description=meaning, json_schema_extra={"unit": unit} if unit else None)


class SceneTable(BaseModel):
    """A table of a scene: frozen, without fields of other names."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Pendulum(SceneTable):
    """The cord, and what slows the bob down."""

    length: Positive = field(
        "67", "m", "length of the cord, from the suspension to the centre of the bob"
    )
    drag: NotNegative = field(
        "0",
        "1/s",
        "linear drag, deceleration over velocity: 2 ln 2 over the time in which the swing halves",
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
        "; ".join(f"{word}: {meaning}" for word, meaning in GRAVITY_MEANINGS.items()),
    )
    rotation_rate: Number = field("7.292115e-5", "rad/s", "rate at which the Earth turns")
    equatorial_radius: NotNegative = field("6378137", "m", "radius of the ellipsoid at the equator")
    inverse_flattening: Annotated[Number, within("1", open_low=True), OR_INF] = field(
        "298.257223564",
        "",
        'inverse flattening of the ellipsoid; "inf" for a sphere; the default is the paper\'s, WGS 84 has …563',
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
        None,
        "degrees",
        "direction of the bob, from east to north: 0 is east, 90 north; 90 minus the compass bearing",
    )
    angle_rate: Number | None = field(None, "degrees/s", "rate of the angle")
    azimuth_rate: Number | None = field(None, "degrees/s", "rate of the azimuth")


_DIGITS = f"a whole number from 1 to {_MAX_DIGITS}"


def _no_truth_value(value: Any) -> Any:
    if isinstance(value, bool):  # Python counts with them: true would be one digit
        raise Refused(_DIGITS)
    return value


Digits = Annotated[
    int,
    BeforeValidator(_no_truth_value),
    checked(lambda digits: 1 <= digits <= _MAX_DIGITS, _DIGITS),
]


class RunTable(SceneTable):
    """How long the motion is followed, when it is printed, and how far the digits are to be trusted."""

    t_end: Annotated[Number, within("0", "1e15", open_low=True)] = field(
        "86400", "s", "end of the motion"
    )
    grid_step: Positive = field("60", "s", "time between two rows of the grid")
    digits: Digits = field(40, "", f"significant digits, at most {_MAX_DIGITS}")
    level: Level = field(
        "confirmed", "", "what has to stand behind every digit; enclosed is a proof"
    )
    transits: bool = field(True, "", "whether to find the times of the transits")
    sections: Sections = field(
        None,
        "",
        "other moments to find: highest, lowest, gate AZIMUTH, gate AZIMUTH@0, turn AZIMUTH",
    )

    @property
    def zeros(self) -> tuple[str, ...]:
        """The words of all zeros that are sought: `XDOT` for transits, and those of sections."""
        # numpy, which it needs, is not loaded for a scene that is not solved, nor for help
        from ..numbers.zeros import XDOT

        transits = (XDOT,) if self.transits else ()
        return (*transits, *(self.sections or ()))
