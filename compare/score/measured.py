"""Hold rows, measured or computed, against what is proved for every value of uncertain inputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from reference import InputError, Ranges, prove_ranges
from reference.errors import counted
from reference.numbers.columns import STATE
from reference.numbers.precision import Array

from ..candidates.candidate import Candidate
from ..candidates.clock import shown
from .clock_start import SUBTRACT, clock_starts, starts_in_words

# of the numbers outside, those in the lines for people: the farthest of each column first
LISTED = 5
# of a column's largest number: what doubles cannot hold says nothing
ROUNDING = Fraction(1, 1 << 48)
SWING = 7.0  # times sqrt(l/g): a period, and some
TRANSIT = "transit"
APART, INSIDE = "disagrees", "cannot be told apart"


# the ends of each, and whether it holds just one zero
Intervals = list[tuple[tuple[Fraction, Fraction], bool]]


class Outside(NamedTuple):
    """A number outside of what is proved: where, what it is, the interval, by how much it misses this; m, s."""

    column: str
    t: float
    got: float
    low: float
    high: float
    by: float


@dataclass(frozen=True)
class Measured:
    """The verdict on a file of measurements: rows and transits that contradict what is proved for uncertain inputs.

    Attributes:
        name: of the candidate.
        ranges: what was proved, at the times of its rows.
        rows: the number of rows up to the end of the scene.
        transits: the number of its transits or passages at times where the proof decides; None if it has none.
        outside: every number that contradicts the proof, the farthest of a column first.
        notes: remarks that a reader ought to know.
        section: the word of the section whose passages the transits are; None for transits.
        starts: what the clock may have shown at the release, in s, if all passages fit by such a clock alone.
    """

    name: str
    ranges: Ranges
    rows: int
    transits: int | None
    outside: tuple[Outside, ...]
    notes: tuple[str, ...]
    section: str | None = None
    starts: tuple[tuple[Fraction, Fraction], ...] = ()

    @property
    def verdict(self) -> str:
        """'cannot be told apart', or 'disagrees'."""
        return APART if self.outside else INSIDE

    def lines(self) -> Iterator[str]:
        """Yield the lines for people, the verdict first."""
        box = ", ".join(f"{name} ±{width}" for name, width in self.ranges.uncertain.items())
        parts = [counted(self.rows, "row")] if self.rows else []
        zero, section = ("passage", f" of {self.section}") if self.section else (TRANSIT, "")
        parts += [] if self.transits is None else [f"{counted(self.transits, zero)}{section}"]
        scene, what = self.ranges.scene.id, " and ".join(parts)
        clock = (
            f" by a clock that showed {starts_in_words(self.starts)} at the release"
            if self.starts
            else ""
        )
        if not self.outside:
            yield f"{self.name} cannot be told apart from {scene} with {box}: {what}, all inside what is proved{clock}"
        else:
            numbers = counted(len(self.outside), "number")
            yield f"{self.name} disagrees with {scene}, whatever {box}: of {what}, {numbers} outside what is proved"
        for column, t, got, low, high, by in self.outside[:LISTED]:
            at, unit = (
                (f" at t = {t:.10g} s", "m/s" if column[0] == "v" else "m")
                if column in STATE
                else ("", "s")
            )
            yield f"  {column}{at}: {got:.10g}, proved {low:.10g} to {high:.10g} {unit} ({by:.2g} outside)"
        for note in self.notes:
            yield f"Note: {note}."

    def document(self) -> dict[str, Any]:
        """Return it as a JSON document."""
        return {
            "scene": self.ranges.scene.id,
            "candidate": self.name,
            "verdict": self.verdict,
            "uncertain": {name: f"±{width}" for name, width in self.ranges.uncertain.items()},
            "rows": self.rows,
            "transits": self.transits,
            "section": self.section,
            "clock_at_release_s": [[*map(float, start)] for start in self.starts],
            "outside": [number._asdict() for number in self.outside],
            "notes": list(self.notes),
        }


def measured(
    candidate: Candidate | None,
    transits: Array | None,
    ranges: Ranges,
    tolerance: float = 0.0,
    name: str = "",
    report: Any = None,
    section: str | None = None,
) -> Measured:
    """Hold a candidate, or transits alone, against ranges; rows at other times than theirs take another proof.

    Args:
        candidate: rows of positions and, if there, velocities.
        transits: times of xdot = 0 in s, or of passages of a section.
        ranges: read from files, or made for these rows where they have no times.
        tolerance: how far outside a number of a row may lie, in m or m/s, at least the rounding of doubles; transits
            are taken as they are.
        name: of transits alone.
        report: called with the simulated time reached, in s.
        section: the word of the section that `transits` are passages of.

    Raises:
        InputError: no row or transit lies within the scene's span, or the proof decides nothing at any of the times.
        UnreachableError: the box is too wide.
    """
    end, sections = ranges.scene.exact.t_end, ranges.scene.run.sections or ()
    times = (
        [] if candidate is None else [_exact(candidate, "t", k) for k in range(len(candidate.t))]
    )
    zeros = [] if transits is None else sorted(_decimal(t) for t in transits)
    kept, seen = [t for t in times if t <= end], [t for t in zeros if 0 < t <= end]
    name = name if candidate is None else candidate.name
    if candidate is not None and (candidate.clock_s is not None or (not kept and _fit(times, end))):
        raise InputError(
            f"{name}: t",
            f"{_clock_of(candidate)} in the first row",
            "times since the release",
            SUBTRACT,
        )
    other_clock = candidate is None and _fit(zeros, end)
    if not kept and not seen and not other_clock:
        raise InputError(
            name, "no row", f"one up to {float(end):g} s", "The scene ends there: run.t_end."
        )
    wanted = bool(seen or not kept)  # transits or passages
    if not ({*kept} <= {*ranges.times} and (_intervals(ranges, section) or not wanted)):
        last = max([*kept, *seen]) if kept or seen else zeros[-1] - zeros[0]
        ranges = _proved(ranges, kept, last, section, wanted, report)
    if wanted and not _intervals(ranges, section):
        none = f"none: {section or 'xdot'} has no single zeros in this scene"
        raise InputError(name, "transits", none, "Give positions instead.")
    word = section or TRANSIT
    decided = [t for t in seen if not _undecided(t, _intervals(ranges, section))]
    off = [*_rows(candidate, kept, ranges, tolerance)] if candidate else []
    off += _zeros(decided, _intervals(ranges, section), word)
    starts: list[tuple[Fraction, Fraction]] = []
    if other_clock and (off or not seen):
        starts = _starts(zeros, _intervals(ranges, section))
    # a program prints transits, by a clock of its own from the release on
    measured_by_gate = bool(starts and section)
    if measured_by_gate:
        off, seen, decided = [], zeros, zeros
    if not seen and not kept:
        span = f"times above 0, up to {float(end):g} s"
        raise InputError(f"{name}: t", f"{float(zeros[0]):.10g} s first", span, SUBTRACT)
    if seen and not decided and not kept:
        free = _intervals(ranges, section)
        (low, high) = next(
            ends for ends, single in free if not single and ends[0] <= seen[0] <= ends[1]
        )
        advice = f"The proof leaves {float(low):g} to {float(high):g} s open. Take smaller widths, or another section."
        raise InputError(
            f"{name}: t", f"{float(seen[0]):g} s", f"a time at which {word} is decided", advice
        )
    farthest = {number.column: number.by for number in sorted(off, key=lambda number: number.by)}
    notes = list(candidate.notes if candidate else ())
    if starts and not measured_by_gate:
        notes.append(
            f"all transits are inside by a clock that showed {starts_in_words(starts)} at the release"
        )
    late = 0 if measured_by_gate else sum(t > end for t in [*times, *zeros])
    if late:
        notes.append(f"after {float(end):g} s {counted(late, 'time')} left out")
    if open_ := len(seen) - len(decided):
        notes.append(
            f"{counted(open_, 'time')} left out, at which the proof does not decide {word}"
        )
    if TRANSIT in farthest and sections:
        notes.append(f"for passages of {sections[0]} write --section '{sections[0]}'")
    off.sort(
        key=lambda number: (
            number.by < farthest[number.column],
            number.column not in STATE,
            -number.by,
        )
    )
    count = len(decided) if transits is not None else None
    return Measured(
        name, ranges, len(kept), count, tuple(off), tuple(notes), section, tuple(starts)
    )


def _proved(
    ranges: Ranges,
    kept: Sequence[Fraction],
    last: Fraction,
    section: str | None,
    wanted: bool,
    report: Any,
) -> Ranges:
    """Return a proof at the times of rows, and if they are wanted of transits or passages, a swing beyond the last."""
    end, inputs = ranges.scene.exact.t_end, ranges.scene.exact
    # a swing beyond the last one, so that a transit is not cut off
    swing = (
        Fraction(SWING * float(inputs.length / abs(inputs.gravity)) ** 0.5)
        if inputs.gravity
        else last
    )
    grid = sorted({Fraction(0), *kept, *([min(last + swing, end)] if wanted or not last else [])})
    sought = {"run.transits": str(wanted and not section).lower(), "run.sections": section or ""}
    box = {name: f"±{width}" for name, width in ranges.uncertain.items()}
    return prove_ranges(ranges.scene.with_values(sought), box, times=grid, report=report)


def _fit(times: Sequence[Fraction], end: Fraction) -> bool:
    """Return whether times, more than one, may be by a clock that did not start at the release."""
    return len(times) > 1 and times[-1] - times[0] <= end


def _clock_of(candidate: Candidate) -> str:
    return shown(float(candidate.t[0]) if candidate.clock_s is None else candidate.clock_s)


def _starts(times: Sequence[Fraction], intervals: Intervals) -> list[tuple[Fraction, Fraction]]:
    """Return what a clock may have shown at the release, if each time lies in an interval of its own by it."""
    possible = clock_starts(times, [ends for ends, _ in intervals])
    middles = [(low + high) / 2 for low, high in possible]
    fits = [not any(_zeros([t - middle for t in times], intervals, TRANSIT)) for middle in middles]
    return [start for start, fit in zip(possible, fits, strict=True) if fit]


def _rows(
    candidate: Candidate, times: Sequence[Fraction], ranges: Ranges, tolerance: float
) -> Iterator[Outside]:
    """Yield the numbers of rows that lie outside."""
    place = {t: k for k, t in enumerate(ranges.times)}
    for name in (name for name in STATE if name in candidate.columns):
        intervals = ranges.grid.exact(name)
        allowed = max(
            Fraction(tolerance), ROUNDING * max(max(-low, high) for low, high in intervals)
        )
        for k, t in enumerate(times):
            (low, high), got = intervals[place[t]], _exact(candidate, name, k)
            by = max(low - got, got - high)
            if by > allowed:
                yield Outside(name, *map(float, (t, got, low, high, by)))


def _intervals(ranges: Ranges, section: str | None) -> Intervals:
    """Return the intervals of transits, or of a section's passages, and whether each has just one."""
    passages = ranges.sections.get(section) if section else None
    if section and not passages:
        return []
    table, possible = (
        (passages.table, passages.possible) if passages else (ranges.transits, ranges.possible)
    )
    single = [(ends, True) for ends in table.exact("t")] if len(table) else []
    return [*single, *(((low, high), False) for low, high, _ in possible)]


def _undecided(t: Fraction, free: Intervals) -> bool:
    """Return whether a time lies in an interval that may hold zeros, and in none that holds just one."""
    inside = [single for (low, high), single in free if low <= t <= high]
    return bool(inside) and not any(inside)


def _zeros(times: Sequence[Fraction], free: Intervals, word: str) -> Iterator[Outside]:
    """Yield transits or passages in no proven interval, or in one whose only one is another."""
    every = [*free]

    def gap(t: Fraction, ends: tuple[Fraction, Fraction]) -> Fraction:
        return max(ends[0] - t, t - ends[1], Fraction(0))

    for t in times:
        ends, single = min(free or every, key=lambda interval: gap(t, interval[0]))
        if not free or gap(t, ends):
            yield Outside(word, *map(float, (t, t, *ends, gap(t, ends))))
        elif single:
            free.remove((ends, single))


def _exact(candidate: Candidate, name: str, k: int) -> Fraction:
    """Return a number of a row exactly: the shortest decimal of a double, and what the file has beyond it."""
    column = candidate.t if name == "t" else candidate.columns[name]
    low = candidate.low.get(name)
    return (
        _decimal(column[k])
        if low is None or not low[k]
        else Fraction(float(column[k])) + Fraction(float(low[k]))
    )


def _decimal(x: float) -> Fraction:
    return Fraction(repr(float(x)))
