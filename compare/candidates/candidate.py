"""A candidate: a trajectory to be judged, as checked NumPy arrays, whatever its source."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

import numpy as np
import numpy.typing as npt

from reference import InputError
from reference.errors import Described, counted
from reference.numbers.precision import Array

COLUMNS = ("x", "y", "z", "vx", "vy", "vz")
LARGEST = 1e100  # a larger number means that the run has blown up; below, squares cannot overflow
ADVICE = "Columns are t, x, y and optionally z, vx, vy, vz."
NO_ROWS = Described("no rows")
# advice for too large an output
FEWER_ROWS = "Print fewer rows."


class NotFiniteError(InputError):
    """A candidate holds a number that is not finite: the run has blown up."""


@dataclass(frozen=True)
class Deviation:
    """How a candidate deviates from what was expected: in the form of its file, or in what its program does.

    Attributes:
        id: a stable word.
        text: of a reading, its sentence; else the end of the sentence "Your file …" or "Your
            program …".
        size_m: the distance in m by which it moves the bob, in addition to the parts before it; 0
            if that is unknown.
        stage: of a program's: gravity, model, input, release, frame, clock or integrator; or as_if or
            either, if it is not certain. Empty for a convention of the file.
        value: a fitted number, in its unit.
        shift: by how much it differs from the scene's.
        uncertainty: of it, an estimate from the residual.
    """

    id: str
    text: str
    size_m: float = 0.0
    stage: str = ""
    value: float | None = None
    shift: float | None = None
    uncertainty: float | None = None

    @property
    def is_convention(self) -> bool:
        """Whether it is a convention of the file, and no cause in the program."""
        return not self.stage


@dataclass(frozen=True, repr=False)
class Candidate:
    """A trajectory to be judged.

    Attributes:
        name: the file or program that it came from.
        t: times in s, shape (rows,), strictly increasing, from 0 on.
        columns: x, y and any of z, vx, vy, vz in m and m/s, each of shape (rows,).
        low: low parts of t and `columns`, for numbers with more digits than a double: the number is
            double + low part.
        transits: times of xdot = 0 in s that came with it, or None.
        notes: remarks that a reader ought to know.
        conventions: names, units and scales that were recognised while reading.
        clock_s: the time on its clock in the first row, in s, if t is counted from that row; None if
            t is counted from the release.
    """

    name: str
    t: Array = field(repr=False)
    columns: dict[str, Array] = field(repr=False)
    low: dict[str, Array] = field(default_factory=dict, repr=False)
    transits: Array | None = field(default=None, repr=False)
    notes: tuple[str, ...] = ()
    conventions: tuple[Deviation, ...] = ()
    clock_s: float | None = None

    def __repr__(self) -> str:
        return f"Candidate({Path(self.name).name}: {counted(len(self.t), 'row')} of t, {', '.join(self.columns)})"

    @property
    def extended(self) -> bool:
        """True if some number has more digits than a double holds."""
        return bool(self.low)

    @property
    def positions(self) -> bool:
        """True if it has positions; False if it has only transits."""
        return "x" in self.columns

    @classmethod
    def of_transits(cls, name: str, times: Array) -> Candidate:
        """Make a candidate of transits alone, sorted times in s at which vx = 0 and nothing else is known.

        Raises:
            InputError: no time is above 0.
        """
        t = np.unique(times[times > 0])
        if not len(t):
            advice = "Did the program stop early?"
            got = Described("no transit after t = 0")
            raise InputError(f"{name}: t", got, "at least one", advice)
        return cls(name, t, {"vx": np.zeros(len(t))}, transits=times)

    @classmethod
    def of(cls, name: str, t: Array, columns: dict[str, Array], **more: object) -> Candidate:
        """Check the arrays and make a candidate of them, leaving out lost frames: rows of NaN followed by others.

        Raises:
            InputError: a column is missing, lengths differ, a number is not finite, or times do not
                increase.
        """
        _check_columns(name, t, columns)
        lost = _lost_frames(columns)
        _check_finite(name, {"t": t, **columns}, ~lost)
        if lost.any():
            rows = counted(int(lost.sum()), "row")
            first = float(t[int(np.argmax(lost))])
            note = f"{rows} of NaN left out, the first at t = {first:.10g} s"
            more["notes"] = (*more.get("notes", ()), note)  # type: ignore[misc]
            more["low"] = {word: part[~lost] for word, part in (more.get("low") or {}).items()}  # type: ignore[attr-defined]
            t = t[~lost]
            columns = {word: column[~lost] for word, column in columns.items()}
        if not len(t):
            raise InputError(name, NO_ROWS, "at least one row", "Is the output empty?")
        _check_order(
            t, f"{name}: t", "in row", "Sort the rows and drop repeated times.", strictly=True
        )
        return cls(name, t, columns, **more)  # type: ignore[arg-type]


@dataclass(frozen=True)
class Passages:
    """Times at which a bob passed, measured or computed.

    Attributes:
        name: the file that they came from.
        times: in s, in order.
        section: the word of the section that was passed, such as "gate 30"; None for transits, xdot
            = 0.
    """

    name: str
    times: Array
    section: str | None = None


def _check_columns(name: str, t: Array, columns: dict[str, Array]) -> None:
    """Refuse arrays without x or y, or of other shapes than (rows,).

    Raises:
        InputError: they are such.
    """
    for required in ("x", "y"):
        if required not in columns:
            got = Described(f"the columns t, {', '.join(columns)}")
            raise InputError(name, got, f"a column {required}", ADVICE)
    if t.ndim != 1:
        got = Described(f"shape {t.shape}")
        raise InputError(f"{name}: t", got, "a one-dimensional array")
    for word, column in columns.items():
        if column.shape != t.shape:
            got = Described(f"shape {column.shape}")
            expected = f"a one-dimensional array of {t.size} numbers, as many as t has"
            raise InputError(f"{name}: {word}", got, expected)


def _check_finite(name: str, columns: dict[str, Array], rows: npt.NDArray[np.bool_]) -> None:
    """Refuse numbers that are not finite or too large, in the rows that count.

    Raises:
        NotFiniteError: there is one.
    """
    for word, column in columns.items():
        invalid = ~(np.abs(column) <= LARGEST) & rows  # true for NaN as well
        if invalid.any():
            row = int(np.argmax(invalid))
            got = Described(f"{column[row]} in row {row + 1}")
            expected = f"a finite number of absolute value below {LARGEST:g}"
            advice = "The run failed there: correct it, or score only the rows before it."
            raise NotFiniteError(f"{name}: {word}", got, expected, advice)


def _lost_frames(columns: dict[str, Array]) -> npt.NDArray[np.bool_]:
    """Return which rows hold NaN though a later row does not: a camera may miss a frame, but no run recovers."""
    lost = np.zeros(len(next(iter(columns.values()))), dtype=bool)
    for column in columns.values():
        lost |= np.isnan(column)
    later = np.flatnonzero(~lost)
    lost[later[-1] if len(later) else 0 :] = False
    return lost


def checked_transits(times: Array, name: str) -> Array:
    """Check transit times and return them as doubles.

    Raises:
        InputError: they are not one-dimensional, not finite, negative, or decrease; a time that
            stands there twice is an extra transit.
    """
    times = np.asarray(times, dtype=np.float64)
    if times.ndim != 1:
        got = Described(f"shape {times.shape}")
        raise InputError(name, got, "a one-dimensional array of times in s")
    if not np.isfinite(times).all():
        row = int(np.argmin(np.isfinite(times)))
        got = Described(f"{times[row]} as transit {row + 1}")
        raise InputError(name, got, "finite times in s")
    _check_order(times, name, "as transit", "", strictly=False)
    return times


def _check_order(times: Array, name: str, at: str, advice: str, *, strictly: bool) -> None:
    """Refuse times before the release, and times that do not increase.

    `at` is how a message names a place.
    """
    if len(times) and times[0] < 0:
        got = Described(f"{times[0]:.17g} {at} 1")
        advice = "Count times from the release, and leave out rows before it."
        raise InputError(name, got, "times in s, 0 or later", advice)
    unordered = np.diff(times) <= 0 if strictly else np.diff(times) < 0
    if unordered.any():
        row = int(np.argmax(unordered))
        got = Described(f"{times[row + 1]:.17g} {at} {row + 2} after {times[row]:.17g}")
        expected = f"{'strictly ' * strictly}increasing times, in s"
        raise InputError(name, got, expected, advice)


def multiplied(near: Array, low: Array, factor: Fraction) -> tuple[Array, Array]:
    """Multiply doubles with low parts; numbers that are not finite, and will be refused, stay as they are."""
    scaled = near.copy()
    scaled_low = np.zeros_like(low)
    for i in np.flatnonzero(np.isfinite(near)).tolist():
        exact = (Fraction(float(near[i])) + Fraction(float(low[i]))) * factor
        scaled[i] = float(exact)
        scaled_low[i] = float(exact - Fraction(float(scaled[i])))
    return scaled, scaled_low
