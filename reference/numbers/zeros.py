"""The zeros of a motion: of xdot, which are called transits, and of the forms of sections, by their words."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any, Generic, NamedTuple, TypeVar

from .columns import SECTION, TRANSITS

XDOT = "xdot"  # the word of the zeros that are called transits; every other word is that of a section
Undecided = tuple[tuple[Fraction, Fraction, str], ...]  # intervals in s, each with the parity of its zeros
T = TypeVar("T")


class Zeros(NamedTuple, Generic[T]):
    """The zeros of xdot, or of a section's form.

    Attributes:
        table: `columns_of(word)` at each zero, in SI units: a `Table`; of uncertain inputs `Intervals`, in each of
            which every pendulum of the box has one, in order; the last one may come after the end for some.
        directions: +1 where the form grows, per zero.
        possible: intervals in s, each with a parity, that may hold zeros which a proof could not decide.
    """

    table: T
    directions: list[int]
    possible: Undecided = ()


def columns_of(word: str) -> tuple[str, ...]:
    """Return the columns that are printed of zeros: of xdot those of transits.csv, else those of sections.csv."""
    return TRANSITS if word == XDOT else SECTION


def sections_of(zeros: Mapping[str, Any]) -> dict[str, Any]:
    """Return the zeros of sections alone."""
    return {word: of_word for word, of_word in zeros.items() if word != XDOT}
