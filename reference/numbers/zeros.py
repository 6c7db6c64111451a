"""The zeros of a motion by word: of xdot, which are called transits, and of sections' forms."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any, Generic, NamedTuple, TypeVar

from .columns import SECTION, TRANSITS

# the word of the zeros that are called transits; every other word is that of a section
XDOT = "xdot"
# intervals in s, each with the parity of its zeros
Undecided = tuple[tuple[Fraction, Fraction, str], ...]
T = TypeVar("T")


class Zeros(NamedTuple, Generic[T]):
    """The zeros of xdot, or of a section's form.

    Attributes:
        table: `columns_of(word)` at each zero, in SI units: a `Table`. With uncertain inputs it is
            `Intervals`: in each row every pendulum of the box has one zero, in order; for some the
            last may come after the end of the run.
        directions: +1 where the form grows, per zero.
        possible: intervals in s, each with the parity of the zeros in it, that a proof could not
            decide.
    """

    table: T
    directions: list[int]
    possible: Undecided = ()


def columns_of(word: str) -> tuple[str, ...]:
    """Return the printed columns of zeros: for xdot those of transits.csv, else of sections.csv."""
    return TRANSITS if word == XDOT else SECTION


def sections_of(zeros: Mapping[str, Any]) -> dict[str, Any]:
    """Return the zeros of sections alone."""
    return {word: of_word for word, of_word in zeros.items() if word != XDOT}


class WithZeros(Generic[T]):
    """A result with `zeros` by word: those of xdot are its transits, the others its sections."""

    zeros: Mapping[str, Zeros[T]]

    def _none(self) -> T:
        """Return `columns.TRANSITS` without rows."""
        raise NotImplementedError

    @property
    def _of_xdot(self) -> Zeros[T]:
        return self.zeros.get(XDOT, Zeros(self._none(), []))

    @property
    def transits(self) -> T:
        """`columns.TRANSITS` at every zero of xdot.

        It has no rows if they were not asked for, or if xdot is identically zero. With uncertain
        inputs each row is an interval in which every pendulum has one zero; for some the last may
        come after the end of the run.
        """
        return self._of_xdot.table

    @property
    def directions(self) -> list[int]:
        """For each transit, +1 if xdot goes from - to +, and -1 otherwise."""
        return self._of_xdot.directions

    @property
    def possible(self) -> Undecided:
        """Intervals in s, each with a parity, in which the proof could not decide transits."""
        return self._of_xdot.possible

    @property
    def sections(self) -> dict[str, Zeros[T]]:
        """The passages of each section that the scene asks for, by its word."""
        return sections_of(self.zeros)
