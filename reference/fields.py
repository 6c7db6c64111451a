"""The fields of a scene: types of checked text, mostly decimal numbers in a range, and what is said of a wrong one."""

from __future__ import annotations

import re
from collections.abc import Iterable
from decimal import Decimal
from fractions import Fraction
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, ValidationError

from .errors import InputError
from .nearest import did_you_mean

MAX_EXPONENT = 400  # keeps a slip of typing such as 1e999999999 from filling the memory

_DECIMAL = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")


class Refused(ValueError):
    """Raised by a validator with its expectation and advice; becomes an `InputError` with the field's name."""

    def __init__(self, expected: str, advice: str = "") -> None:
        super().__init__(expected)
        self.expected, self.advice = expected, advice


def _as_text(value: object) -> object:
    if isinstance(value, float):
        raise Refused("a decimal number in quotes", 'A bare TOML float is rounded: write it as a string, "0.3".')
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _decimal(text: str) -> str:
    if not _DECIMAL.fullmatch(text) or len(text) > 2000:
        raise Refused("a decimal number such as 67 or 7.292115e-5", "NaN and inf are not numbers here.")
    exponent = int(Decimal(text).adjusted())
    if Decimal(text) != 0 and abs(exponent) > MAX_EXPONENT:
        raise Refused(f"a number between 1e-{MAX_EXPONENT} and 1e{MAX_EXPONENT} in size")
    return text


def _decimal_or_inf(text: str) -> str:
    return text if text == "inf" else _decimal(text)


def within(low: str | None, high: str | None = None, *, open_low: bool = False) -> AfterValidator:
    """Return the check that a number lies in a range, with its ends or (`open_low`) without the lower one."""
    words = [
        *([f"{'above' if open_low else 'at least'} {low}"] if low is not None else []),
        *([f"at most {high}"] if high is not None else []),
    ]

    def check(text: str) -> str:
        if text == "inf":
            return text
        value = Fraction(text)
        too_low = low is not None and (value < Fraction(low) or (open_low and value == Fraction(low)))
        if too_low or (high is not None and value > Fraction(high)):
            raise Refused("a number " + " and ".join(words))
        return text

    return AfterValidator(check)


Number = Annotated[str, BeforeValidator(_as_text), AfterValidator(_decimal)]
NumberOrInf = Annotated[str, BeforeValidator(_as_text), AfterValidator(_decimal_or_inf)]
Positive = Annotated[Number, within("0", open_low=True)]
NotNegative = Annotated[Number, within("0")]


def explained(error: ValidationError, known: Iterable[str]) -> InputError:
    """Return the error that a user reads: the first wrong field, what it got, what was expected.

    Args:
        error: as pydantic raised it.
        known: names of the fields that there are.
    """
    details = error.errors()[0]
    field = ".".join(str(part) for part in details["loc"])
    kind, got = details["type"], details["input"]
    cause = details.get("ctx", {}).get("error")
    if isinstance(cause, Refused):
        return InputError(field, got, cause.expected, cause.advice)
    if kind == "extra_forbidden":
        return InputError(
            field, got, "a field that scenes have", did_you_mean(field, known, "`foucault show SCENE` lists them.")
        )
    if kind == "missing":
        return InputError(field, "nothing", "a value", "Add this field to the scene.")
    expected = {
        "literal_error": "one of " + str(details.get("ctx", {}).get("expected", "")),
        "int_parsing": "a whole number",
        "int_type": "a whole number",
        "int_from_float": "a whole number",
        "bool_parsing": "true or false",
        "bool_type": "true or false",
        "string_type": "a number in quotes",
        "model_type": f"a table, written [{field}]",
    }.get(kind, details["msg"])
    return InputError(field, got, expected)
