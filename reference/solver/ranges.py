"""Proven intervals of a scene for every value that its inputs may have (THEOREM.md, 11)."""

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
from ..numbers.zeros import XDOT, Undecided, WithZeros, Zeros
from ..scenes.scene import Scene, full_name
from .swing import HOUR, Ends, Swing, swing_of


@dataclass(frozen=True)
class Intervals(Framed):
    """A table of proven intervals.

    `low("x")` and `high("x")` are the ends of a column in doubles, rounded outward.

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
        """Return columns x_low, x_high and so on as a pandas.DataFrame, rounded outward."""
        columns = {}
        for name in self.columns:
            columns[f"{name}_low"] = self.low(name)
            columns[f"{name}_high"] = self.high(name)
        return data_frame(columns)


class Derivative(NamedTuple):
    """Derivatives to one input, per SI unit of it (degrees for angles), as proven intervals.

    Attributes:
        grid: of position and velocity at the grid times.
        transits: of the times of transits; without rows where one of them is undecided.
        period: of the period; None where this is open.
        precession: of the precession, in degrees an hour; None where this is open, and without the
            section `highest`.
    """

    grid: Intervals
    transits: Intervals
    period: Ends | None
    precession: Ends | None


@dataclass(frozen=True)
class Ranges(WithZeros[Intervals]):
    """Proven intervals of a scene, which hold for every value that its uncertain inputs may have.

    Attributes:
        scene: the scene, at the level enclosed.
        uncertain: half of the width of each uncertain input as text, by its full name.
        times: grid times in s, exact.
        grid: position and velocity at those times, in m and m/s.
        zeros: the zeros that the scene asks for, by word: "xdot" for transits, and its sections;
            without xdot where that is identically zero.
        engine: the engine whose steps were proved.
        proof: the `BoxEnclosure`; None for ranges that were read from a file.
        derivatives: whether derivatives were requested. They may make every interval narrower.
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
    def period(self) -> Ends | None:
        """Mean time in s between transits in the same direction, up to the first that is undecided.

        None if that is open, or if the bob may rise above the horizontal, where a swing has more
        than two transits. With derivatives two intervals are intersected: that of the transits, and
        the one that follows from the scene's own period and how far the inputs move it.
        """
        swings = self._swings
        if swings < 1:
            return None
        wide = _mean([row[0] for row in self.transits.rows], swings)
        derivatives = self._derivatives
        if derivatives is None:
            return wide
        own_times = [zero.own.t for zero in derivatives.zeros[XDOT] if zero.own]
        if len(own_times) < len(self.transits):
            return wide
        own = _mean(own_times, swings)
        far = sum(moved for moved, _ in self.shares().values())
        return Ends(max(wide.low, own.low - far), min(wide.high, own.high + far))

    @property
    def swing(self) -> Swing | None:
        """Frequency and precession of every pendulum, from its highest points.

        The first point that is undecided, and all after it, are not used.

        None where this is open, without the section `highest`, and for ranges that were read from a
        file. With derivatives two intervals of the precession are intersected: that of these
        points, and the one that follows from the scene's own and how far the inputs move it.
        """
        wide = self._wide_swing
        if wide is None or wide.precession is None:
            return wide
        far = Fraction(0)
        for j, width in enumerate(self.uncertain.values()):
            slope = self._precession(j)
            if slope is None:
                return wide
            far += Fraction(width) * max(-slope.low, slope.high)
        own_points = []
        for point in self._apses:
            own = point.own
            own_points.append([(x.low, x.high) for x in (own.t, own.x, own.y, own.z)])
        return wide.near(swing_of(own_points, self.scene.exact, self.proof.bits), far)

    @property
    def _derivatives(self) -> Any:
        """The `ProvedDerivatives`; None where there are none."""
        return getattr(self.proof, "derivatives", None)

    @cached_property
    def _highest(self) -> list[tuple[tuple[Fraction, Fraction], ...]]:
        """The intervals of t, x, y and z of highest points, up to the first that is undecided."""
        section = self.sections.get("highest")
        if section is None:
            return []
        columns = [section.table.exact(name) for name in ("t", "x", "y", "z")]
        return _decided([*zip(*columns, strict=True)], section.possible)

    @cached_property
    def _wide_swing(self) -> Swing | None:
        """The swing from the intervals of highest points alone."""
        if self.proof is None:
            return None
        return swing_of(self._highest, self.scene.exact, self.proof.bits, self.proof.lean)

    @property
    def _apses(self) -> list[Any]:
        """The derivatives of the points of `_highest`; empty unless all have them."""
        if self._derivatives is None or "highest" not in self.sections:
            return []
        points = self._derivatives.zeros["highest"][: len(self._highest)]
        return list(points) if all(point.own for point in points) else []

    def _precession(self, j: int) -> Ends | None:
        """Return the derivative of the precession to input j, in degrees an hour; None if open."""
        wide = self._wide_swing
        apses = self._apses
        if wide is None or wide.precession is None or not apses:
            return None
        first = apses[0]
        last = apses[-1]
        swings = Fraction(len(apses) - 1, 2)
        # by how much the span grows
        span = Ends(
            last.times[j].low - first.times[j].high, last.times[j].high - first.times[j].low
        )
        # in which the plane turns on
        turned_on = [rate * time / HOUR for rate in wide.precession for time in span]
        low = last.azimuths[j].low - first.azimuths[j].high - max(turned_on)
        high = last.azimuths[j].high - first.azimuths[j].low - min(turned_on)
        rates = [turned * hz / swings * HOUR for turned in (low, high) for hz in wide.hz]
        return Ends(min(rates), max(rates))

    @property
    def _swings(self) -> int:
        """The number of whole swings before the first undecided transit.

        0 if the bob may rise above the horizontal.
        """
        if any(high >= 0 for _, high in self.transits.exact("z")):
            return 0
        times = [(interval,) for interval in self.transits.exact("t")]
        return (len(_decided(times, self.possible)) - 1) // 2

    def derivative(self, name: str) -> Derivative:
        """Return the derivatives to an uncertain input; they hold for every pendulum of the box.

        Args:
            name: its full name, such as "pendulum.length", or a short one.

        Raises:
            InputError: it is not uncertain, or `solve` was not asked for derivatives.
        """
        name = full_name(name)
        derivatives = self._derivatives
        if derivatives is None:
            expected = "ranges that were proved with derivatives"
            advice = "Call reference.prove_ranges(…, derivatives=True)."
            raise InputError("derivative", name, expected, advice)
        names = derivatives.names
        if name not in names:
            there_are = f"There are {', '.join(names)}."
            raise unknown("derivative", name, "an uncertain input", names, there_are)

        j = names.index(name)
        times = [zero.times[j] for zero in derivatives.zeros.get(XDOT, ()) if zero.times]
        complete = len(times) == len(self.transits) > 0
        return Derivative(
            grid=Intervals(STATE, tuple(row[j] for row in derivatives.states)),
            transits=Intervals(("t",), tuple((x,) for x in times) if complete else ()),
            period=_mean(times, self._swings) if complete and self._swings > 0 else None,
            precession=self._precession(j),
        )

    def shares(self) -> dict[str, tuple[Fraction, float]]:
        """Return a bound on how far each input alone moves the period, in s, and its share of these bounds."""
        moved = {}
        for name, width in self.uncertain.items():
            slope = self.derivative(name).period
            if slope:
                moved[name] = Fraction(width) * max(-slope.low, slope.high)
        whole = sum(moved.values())
        return {name: (far, float(far / whole) if whole else 0.0) for name, far in moved.items()}

    def __repr__(self) -> str:
        """Return scene, uncertain inputs, and the numbers of rows and transits."""
        box = ", ".join(f"{name} ±{width}" for name, width in self.uncertain.items())
        rows = f"{counted(len(self.times), 'grid time')}, {counted(len(self.transits), 'transit')}"
        return f"Ranges({self.scene.id}: {box}; {rows})"


def _mean(times: Sequence[Any], swings: int) -> Ends:
    """Return the mean of so many swings, an interval.

    Args:
        times: intervals of the times of transits, or of derivatives of these.
        swings: number of swings.
    """
    first = times[0]
    last = times[2 * swings]
    return Ends((last.low - first.high) / swings, (last.high - first.low) / swings)


def _decided(rows: list[Any], possible: Undecided) -> list[Any]:
    """Return the rows, each beginning with an interval of time, before the first undecided one."""
    if not possible:
        return rows
    first = min(low for low, _, _ in possible)
    return [row for row in rows if row[0][1] < first]
