"""Checked texts of a scene's fields, and what a user is told of a wrong one."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping
from decimal import Decimal
from fractions import Fraction
from numbers import Integral
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ValidationError,
    ValidationInfo,
    WithJsonSchema,
    WrapValidator,
)
from pydantic_core import ErrorDetails

from ..errors import NOTHING, InputError, did_you_mean
from ..plain_text import is_plain
from .inputs import as_read

_MAX_EXPONENT = 400  # keeps a slip of typing such as 1e999999999 from filling the memory
_MAX_LENGTH = 2000  # characters of a number
_EXPONENT_DIGITS = 9  # a Decimal can hold these; far above what is allowed
_LONGEST_KEY = 80  # characters of a wrong key that a message quotes

_PRINTED = re.compile(r"(?:np|numpy)\.\w+\((.*)\)")
_DECIMAL = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?0*(\d+))?", re.ASCII)


class Refused(ValueError):
    """Raised by a validator with its expectation and advice.

    It becomes an `InputError` with the field's name. With `has_unit` the text is a number with
    something behind it: the advice is then that of the field's unit, `number_alone`.
    """

    def __init__(self, expected: str, advice: str = "", *, has_unit: bool = False) -> None:
        super().__init__(expected)
        self.expected = expected
        self.advice = advice
        self.has_unit = has_unit

    def advice_in(self, unit: str) -> str:
        """Return the advice for a field of this unit."""
        return number_alone(unit) if self.has_unit else self.advice


# a number in the unit of a field, and what it stands for
_NUMBERS_ALONE = {
    "m": "0.005 for 5 mm",
    "s": "1200 for 20 min",
    "1/s": "2 ln 2/1200 = 0.0011552 for a swing that halves in 20 min",
    "degrees": "51.5 for 51° 30′; south is negative",
    "degrees/s": "0.5 for 30 degrees a minute",
    "m/s": "0.01 for 1 cm/s",
    "m/s²": "9.81 for 981 Gal",
    "rad/s": "7.292e-5 for a turn in 86164 s",
}


def number_alone(unit: str) -> str:
    """Return the advice for a number that has its unit behind it; "" is the unit of a pure number."""
    if unit not in _NUMBERS_ALONE:
        return "Write the number alone."
    return f"Write the number alone, in {unit}: {_NUMBERS_ALONE[unit]}."


def _reading(info: ValidationInfo) -> str:
    """Return how the numbers of the scene are read that is being checked."""
    return str((info.context or {}).get("inputs"))


def _as_text(value: object) -> object:
    if isinstance(value, float):
        raise Refused(
            "a decimal number in quotes",
            f'Write "{value}" as a string: a bare TOML float is rounded.',
        )
    if isinstance(value, Integral | Decimal) and not isinstance(value, bool):
        return str(value)
    return value


def _decimal(text: str, info: ValidationInfo) -> str:
    match = _DECIMAL.fullmatch(text) if len(text) <= _MAX_LENGTH else None
    if match is None:
        expected = "a decimal number such as 67 or 7.292115e-5"
        advice = _how_to_write(text)
        has_unit = not advice and _DECIMAL.match(text) is not None
        raise Refused(expected, advice, has_unit=has_unit)
    # zero as well: 0e999999999 is computed with a power of ten
    if len(match[4] or "") > _EXPONENT_DIGITS or abs(Decimal(text).adjusted()) > _MAX_EXPONENT:
        raise Refused(
            f"a number of absolute value between 1e-{_MAX_EXPONENT} and 1e{_MAX_EXPONENT}"
        )
    try:
        as_read(text, _reading(info))
    except OverflowError:
        raise Refused(
            f"a number in the range of a double, of absolute value at most {sys.float_info.max:.3g}",
            _DOUBLES,
        ) from None
    return text


def _how_to_write(text: str) -> str:
    """Return advice on a text that is no decimal number."""
    if printed := _PRINTED.fullmatch(text):
        return f"NumPy's repr: write {printed[1]}, as str() does."
    if text.lower().lstrip("+-") in ("nan", "inf", "infinity"):
        return "NaN and inf are not numbers here."
    if _DECIMAL.fullmatch(text.replace(",", ".")):
        return (
            "Write a decimal point, not a comma."
            if "," in text
            else f"Write at most {_MAX_LENGTH} characters."
        )
    return ""


_DOUBLES = "The numbers are read as binary64 here."


def checked(holds: Callable[[Any], bool], expected: str) -> AfterValidator:
    """Return the check that something holds of a value, of which is said what was expected."""

    def check(value: Any) -> Any:
        if not holds(value):
            raise Refused(expected)
        return value

    return AfterValidator(check)


def within(low: str, high: str | None = None, *, open_low: bool = False) -> AfterValidator:
    """Return the check that a number lies in a range, with its ends or (`open_low`) without the lower one."""
    least = Fraction(low)
    most = Fraction(high) if high else None
    expected = f"a number above {low}" if open_low else f"a number at least {low}"
    if high:
        expected += f" and at most {high}"

    def check(text: str, info: ValidationInfo) -> str:
        value = as_read(text, _reading(info))
        too_low = value <= least if open_low else value < least
        if too_low or (most is not None and value > most):
            raise Refused(expected, _DOUBLES if value != Fraction(text) else "")
        return text

    return AfterValidator(check)


Line = Annotated[str, checked(is_plain, "one line of text without control characters")]
# what an editor checks
_SCHEMA = {"type": ["string", "integer"], "pattern": f"^(inf|{_DECIMAL.pattern})$"}
Number = Annotated[
    str, BeforeValidator(_as_text), AfterValidator(_decimal), WithJsonSchema(_SCHEMA)
]
OR_INF = WrapValidator(lambda value, check: value if value == "inf" else check(value))
Positive = Annotated[Number, within("0", open_low=True)]
NotNegative = Annotated[Number, within("0")]


def by_full_name(widths: object) -> object:
    """Return widths by names such as pendulum.length, which without quotes is a table in a table for TOML."""
    if not isinstance(widths, Mapping):
        return widths
    full: dict[str, object] = {}
    for top, inner in widths.items():
        full |= (
            {f"{top}.{key}": width for key, width in inner.items()}
            if isinstance(inner, Mapping)
            else {top: inner}
        )
    return full


def without_sign(width: str) -> str:
    """Return half of a width as a number: ±0.001, +-0.001, +/-0.001 and 0.001 mean the same."""
    text = width.strip()
    return text.removeprefix(next(filter(text.startswith, _SIGNS), "")).strip()


_SIGNS = ("±", "+-", "+/-")
_Width = Annotated[
    Positive,
    BeforeValidator(lambda width: without_sign(width) if isinstance(width, str) else width),
    AfterValidator(lambda width: f"±{width}"),
    WithJsonSchema({**_SCHEMA, "pattern": rf"^(±|\+-|\+/-)?{_DECIMAL.pattern}$"}),
]
Widths = Annotated[dict[str, _Width], BeforeValidator(by_full_name)]


_TEXTS = ("id", "title", "source", "flags")


def explained(error: ValidationError, known: Mapping[str, str]) -> list[InputError]:
    """Return the errors that a user reads: each wrong field, what it got, what was expected.

    Args:
        error: as pydantic raised it.
        known: the full names of the fields that there are, with their units.
    """
    return [_explained(details, known) for details in error.errors()]


def _explained(details: ErrorDetails, known: Mapping[str, str]) -> InputError:
    field = ".".join(str(part)[:_LONGEST_KEY] for part in details["loc"])
    kind = details["type"]
    got = details["input"]
    cause = details.get("ctx", {}).get("error")
    if isinstance(cause, Refused):
        got = ", ".join(map(str, got)) if isinstance(got, tuple) else got
        advice = cause.advice_in(_unit(field, known))
        return InputError(field, got, cause.expected, advice)
    if kind == "extra_forbidden":
        advice = did_you_mean(field, known, "`foucault show SCENE` lists them.")
        return InputError(field, got, "a field that scenes have", advice)
    if kind == "missing" and field == "release":
        return InputError(field, NOTHING, "a table with x and y, or with angle and azimuth")
    if kind == "missing":
        return InputError(field, NOTHING, "a value", "Add this field to the scene.")
    expected = {
        "literal": "one of " + str(details.get("ctx", {}).get("expected", "")),
        "int": "a whole number",
        "bool": "true or false",
        "string": "text in quotes" if field.partition(".")[0] in _TEXTS else "a number in quotes",
        "tuple": "a list of words",
        "model": f"a table, written [{field}]",
        "dict": f"a table, written [{field}]",
    }.get(kind.partition("_")[0], details["msg"])
    return InputError(field, got, expected)


def _unit(field: str, units: Mapping[str, str]) -> str:
    """Return the unit of a field; that of a width, whose input may have a short name, is its input's."""
    name = field.removeprefix("uncertain.")
    for full, unit in units.items():
        if name in (full, full.rpartition(".")[2]):
            return unit
    return ""
