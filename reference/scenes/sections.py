"""Sections: the moments of a motion that are sought besides the transits, each named by a word of the scene."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, WithJsonSchema

from .inputs import Refused

SEPARATOR = "; "  # of several words in a text
WORDS = "highest, lowest, gate AZIMUTH, gate AZIMUTH@0 or turn AZIMUTH"
_AZIMUTH = "-?[0-9]{1,3}(?:[.][0-9]{1,200})?"
WORD = f"highest|lowest|turn {_AZIMUTH}|gate {_AZIMUTH}(?:@0)?"  # as a regular expression


def _words(value: Any) -> Any:
    """Return words from a text, in which they stand between semicolons or commas, each with single spaces."""
    listed = re.split("[;,]", value) if isinstance(value, str) else value
    words = [" ".join(word.split()) if isinstance(word, str) else word for word in listed or ()]
    return tuple(word for word in words if word) or None


def _checked(words: tuple[str, ...]) -> tuple[str, ...]:
    for word in words:
        if not re.fullmatch(WORD, word, re.ASCII) or abs(azimuth_of(word)) > 360:
            raise Refused(WORDS, f"{word!r} is none; an azimuth is a decimal from -360 to 360 degrees, east to north.")
    if len(set(words)) < len(words):
        raise Refused("each section once", "Leave out the second one.")
    return words


def azimuth_of(word: str) -> Fraction:
    """Return the azimuth that a section's word names, in degrees from east to north; 0 if it names none."""
    return Fraction(word.partition(" ")[2].removesuffix("@0") or 0)


_SCHEMA = {"type": "array", "items": {"type": "string", "pattern": f"^({WORD})$"}}
Sections = Annotated[
    Annotated[tuple[str, ...], AfterValidator(_checked)] | None, BeforeValidator(_words), WithJsonSchema(_SCHEMA)
]
