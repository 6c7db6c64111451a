"""Uncertain inputs: a scene solved for every value that they may have, by a proof (THEOREM.md, section 11)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError, counted, unknown
from ..numbers.columns import STATE, TRANSITS, Framed, data_frame
from ..numbers.precision import Array, double_below
from ..numbers.zeros import XDOT, WithZeros, Zeros
from ..scenes.scene import Scene, full_name
from .swing import HOUR, Swing, swing_of


class Ends(NamedTuple):
    """The exact ends of an interval."""

    low: Fraction
    high: Fraction


@dataclass(frozen=True)
class Intervals(Framed):
    """A table of proven intervals: `low("x")` and `high("x")` are a column's ends in doubles, rounded outward.

    Attributes:
        columns: names of the columns.
        rows: intervals with exact ends, `low` and `high`, in SI units.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...] = field(repr=False)

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.rows)

    def exact(self, name: str) -> list[tuple[Fraction, Fraction]]:
        """Return the exact ends of a column's intervals."""
        if name not in self.columns:
            raise unknown("column", name, f"one of {', '.join(self.columns)}", self.columns, "")
        i = self.columns.index(name)
        return [(row[i].low, row[i].high) for row in self.rows]

    def low(self, name: str) -> Array:
        """Return the lower ends of a column, shape (rows,)."""
        return np.array([double_below(low) for low, _ in self.exact(name)])

    def high(self, name: str) -> Array:
        """Return the upper ends of a column, shape (rows,)."""
        return np.array([-double_below(-high) for _, high in self.exact(name)])

    def to_pandas(self) -> Any:
        """Return the columns x_low, x_high and so on as a pandas.DataFrame of doubles, rounded outward."""
        ends = (("low", self.low), ("high", self.high))
        return data_frame(
            {f"{name}_{word}": of(name) for name in self.columns for word, of in ends}
        )


class Derivative(NamedTuple):
    """Derivatives to one input, per SI unit of it (degrees for angles), as proven intervals.

    Attributes:
        grid: of position and velocity at the grid times.
        transits: of the times of transits; without rows where one of them is undecided.
        period: of the period; None where this is open.
        precession: of the precession, in degrees an hour; None where this is open, and without the section `highest`.
    """

    grid: Intervals
    transits: Intervals
    period: Ends | None
    precession: Ends | None


@dataclass(frozen=True)
class Ranges(WithZeros[Intervals]):
    """Proven intervals of a scene with uncertain inputs: they hold for every value that each input may have.

    Attributes:
        scene: the scene, at the level enclosed.
        uncertain: half of the width of each uncertain input as text, by its full name.
        times: grid times in s, exact.
        grid: position and velocity at those times, in m and m/s.
        zeros: the zeros that the scene asks for, by word: "xdot" for transits, and its sections; without xdot where
            that is identically zero.
        engine: whose steps were proved.
        proof: the `BoxEnclosure`; None for ranges that were read from a file.
        derivatives: whether derivatives were asked for. They may make every interval narrower.
    """

    scene: Scene
    uncertain: dict[str, str]
    times: tuple[Fraction, ...]
    grid: Intervals
    zeros: Mapping[str, Zeros[Intervals]] = field(repr=False)
    engine: str
    proof: Any = field(default=None, repr=False)
    derivatives: bool = field(default=False, repr=False)

    def _none(self) -> Intervals:
        return Intervals(TRANSITS, ())

    @property
    def t(self) -> Array:
        """Grid times in s, shape (rows,)."""
        return np.array([float(t) for t in self.times])

    @property
    def period(self) -> tuple[Fraction, Fraction] | None:
        """Mean time in s between transits in the same direction, up to the first that is undecided.

        None if open, and if one may be above the horizontal, where a swing has more than two.
        With derivatives it is what both tell: the transits' intervals, and how far inputs move the scene's own period.
        """
        swings, derivatives = self._swings, getattr(self.proof, "derivatives", None)
        if swings < 1:
            return None
        low, high = _mean([row[0] for row in self.transits.rows], swings)
        zeros = [zero for zero in derivatives.zeros[XDOT] if zero.own] if derivatives else []
        if len(zeros) < len(self.transits):
            return low, high
        least, most = _mean([zero.own.t for zero in zeros], swings)
        far = sum(moved for moved, _ in self.shares().values())
        return max(low, least - far), min(high, most + far)

    @property
    def swing(self) -> Swing | None:
        """Frequency and precession of every pendulum, from its highest points up to the first that is undecided.

        None where this is open, without the section `highest`, and for ranges that were read from a file.
        With derivatives the precession is what both tell: these points, and how far inputs move the scene's own.
        """
        (wide, points), halves = self._apses, [Fraction(width) for width in self.uncertain.values()]
        slopes = [slope for j in range(len(halves)) if (slope := self._precession(j))]
        if wide is None or wide.precession is None or len(slopes) < len(halves):
            return wide
        scene_points = [
            [(x.low, x.high) for x in (z.t, z.x, z.y, z.z)] for z in (point.own for point in points)
        ]
        far = sum(
            (half * max(-x.low, x.high) for half, x in zip(halves, slopes, strict=True)),
            Fraction(0),
        )
        return wide.near(swing_of(scene_points, self.scene.exact, self.proof.bits), far)

    @cached_property
    def _apses(self) -> tuple[Swing | None, list[Any]]:
        """The swing from the intervals of highest points, and what derivatives tell of these: nothing unless of all."""
        section = self.sections.get("highest")
        if section is None or self.proof is None:
            return None, []
        columns = (section.table.exact(name) for name in ("t", "x", "y", "z"))
        intervals, derivatives = (
            _decided([*zip(*columns, strict=True)], section.possible),
            self.proof.derivatives,
        )
        points = [*derivatives.zeros["highest"][: len(intervals)]] if derivatives else []
        wide = swing_of(intervals, self.scene.exact, self.proof.bits, self.proof.lean)
        return wide, points if all(point.own for point in points) else []

    def _precession(self, j: int) -> Ends | None:
        """Return the derivative of the precession to an input, in degrees an hour; None if open."""
        wide, points = self._apses
        if wide is None or wide.precession is None or not points:
            return None
        first, last, swings = points[0], points[-1], Fraction(len(points) - 1, 2)
        late = last.times[j].low - first.times[j].high, last.times[j].high - first.times[j].low
        lost = [rate * time / HOUR for rate in wide.precession for time in late]
        low = last.azimuths[j].low - first.azimuths[j].high - max(lost)
        high = last.azimuths[j].high - first.azimuths[j].low - min(lost)
        rates = [turned * hz / swings * HOUR for turned in (low, high) for hz in wide.hz]
        return Ends(min(rates), max(rates))

    @property
    def _swings(self) -> int:
        """The number of whole swings before the first undecided transit; 0 if the bob comes above the horizontal."""
        if any(high >= 0 for _, high in self.transits.exact("z")):
            return 0
        return (len(_decided([*zip(self.transits.exact("t"))], self.possible)) - 1) // 2

    def derivative(self, name: str) -> Derivative:
        """Return the derivatives to an uncertain input; they hold for every pendulum of the box.

        Args:
            name: its full name, such as "pendulum.length", or a short one.

        Raises:
            InputError: it is not uncertain, or `solve` was not asked for derivatives.
        """
        derivatives, name = getattr(self.proof, "derivatives", None), full_name(name)
        if derivatives is None:
            advice = "reference.prove_ranges(…, derivatives=True)"
            raise InputError(
                "derivative", name, "ranges that were solved with derivatives", f"Write {advice}."
            )
        names = derivatives.names
        if name not in names:
            raise unknown(
                "derivative", name, "an uncertain input", names, f"There are {', '.join(names)}."
            )
        j = names.index(name)
        times = [zero.times[j] for zero in derivatives.zeros.get(XDOT, ()) if zero.times]
        complete = len(times) == len(self.transits) > 0
        return Derivative(
            Intervals(STATE, tuple(row[j] for row in derivatives.states)),
            Intervals(("t",), tuple((x,) for x in times) if complete else ()),
            _mean(times, self._swings) if complete and self._swings > 0 else None,
            self._precession(j),
        )

    def shares(self) -> dict[str, tuple[Fraction, float]]:
        """Return by how much each uncertain input alone may move the period, in s, at most, and its share of all."""
        slopes = {name: self.derivative(name).period for name in self.uncertain}
        moved = {
            name: Fraction(self.uncertain[name]) * max(-x.low, x.high)
            for name, x in slopes.items()
            if x
        }
        whole = sum(moved.values())
        return {name: (far, float(far / whole) if whole else 0.0) for name, far in moved.items()}

    def __repr__(self) -> str:
        """Return scene, uncertain inputs, and the numbers of rows and transits."""
        box = ", ".join(f"{name} ±{width}" for name, width in self.uncertain.items())
        rows = f"{counted(len(self.times), 'grid time')}, {counted(len(self.transits), 'transit')}"
        return f"Ranges({self.scene.id}: {box}; {rows})"


def _mean(times: Sequence[Any], swings: int) -> Ends:
    """Return the mean of so many swings from intervals of the times of transits, or of derivatives of these."""
    first, last = times[0], times[2 * swings]
    return Ends((last.low - first.high) / swings, (last.high - first.low) / swings)


def _decided(rows: list[Any], possible: Sequence[tuple[Fraction, Fraction, str]]) -> list[Any]:
    """Return the rows, each of which begins with an interval of time, before the first that is undecided."""
    first = min((low for low, _, _ in possible), default=None)
    return [row for row in rows if first is None or row[0][1] < first]
