"""Compare measured or computed rows with the intervals that are proved for uncertain inputs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

from reference import InputError, Ranges, prove_ranges
from reference.errors import Described, counted
from reference.numbers.columns import STATE

from ..candidates.candidate import Candidate, Passages
from ..candidates.clock import shown
from ..truth import Report
from .clock_start import SUBTRACT, Ends, clock_starts, starts_in_words

DISAGREES = "disagrees"
_INSIDE = "cannot be told apart"
SWING = 7.0  # times sqrt(l/g): a little more than a period

# of the numbers outside, those in the lines for people: the farthest of each column first
_LISTED = 5
# of a column's largest number: differences below the rounding of doubles mean nothing
_ROUNDING = Fraction(1, 1 << 48)
_TRANSIT = "transit"


class Outside(NamedTuple):
    """A number outside its proven interval.

    Attributes:
        column: of the number; "transit", or the word of a section.
        t: time of the row in s; of a passage, the passage itself.
        got: the number, in m, m/s or s.
        low: end of the proven interval, as are the following.
        high: its other end.
        by: how far outside the number is.
    """

    column: str
    t: float
    got: float
    low: float
    high: float
    by: float

    @property
    def text(self) -> str:
        """The number, where it is, and the interval."""
        where = self.column
        unit = "s"
        if self.column in STATE:
            where = f"{self.column} at t = {self.t:.10g} s"
            unit = "m/s" if self.column.startswith("v") else "m"
        proved = f"proved {self.low:.10g} to {self.high:.10g} {unit}"
        return f"{where}: {self.got:.10g}, {proved} ({self.by:.2g} outside)"


@dataclass(frozen=True)
class Measured:
    """The verdict on a file of measurements: the rows and transits outside the intervals proved for uncertain inputs.

    Attributes:
        name: of the candidate.
        ranges: what was proved, at the times of its rows.
        rows: the number of rows up to the end of the scene.
        transits: the number of its transits or passages at times where the proof decides; None if
            it has none.
        outside: every number that contradicts the proof, the farthest of a column first.
        notes: remarks that a reader ought to know.
        section: the word of the section whose passages the transits are; None for transits.
        starts: what the clock may have shown at the release, in s, if all passages fit by such a
            clock alone.
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
        return DISAGREES if self.outside else _INSIDE

    def lines(self) -> Iterator[str]:
        """Yield the lines for people, the verdict first."""
        yield self._verdict_line()
        for number in self.outside[:_LISTED]:
            yield f"  {number.text}"
        for note in self.notes:
            yield f"Note: {note}."

    def _verdict_line(self) -> str:
        scene = self.ranges.scene.id
        box = ", ".join(f"{name} ±{width}" for name, width in self.ranges.uncertain.items())
        if self.outside:
            numbers = counted(len(self.outside), "number")
            return (
                f"{self.name} disagrees with {scene}, whatever {box}: of {self._contents()}, "
                f"{numbers} outside what is proved"
            )
        clock = ""
        if self.starts:
            clock = f" if the clock showed {starts_in_words(self.starts)} at the release"
        return (
            f"{self.name} cannot be told apart from {scene} with {box}: {self._contents()}, "
            f"all inside what is proved{clock}"
        )

    def _contents(self) -> str:
        """Return how many rows and passages there are, in words."""
        words = []
        if self.rows:
            words.append(counted(self.rows, "row"))
        if self.transits is not None and self.section is None:
            words.append(counted(self.transits, _TRANSIT))
        elif self.transits is not None:
            words.append(f"{counted(self.transits, 'passage')} of {self.section}")
        return " and ".join(words)

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
    passages: Passages | None,
    ranges: Ranges,
    tolerance_m: float = 0.0,
    report: Report | None = None,
) -> Measured:
    """Compare a candidate, or passages alone, with ranges.

    Rows at other times than theirs take another proof.

    Args:
        candidate: rows of positions and, if there, velocities.
        passages: of a section, or transits.
        ranges: read from files, or made for these rows if they have no times.
        tolerance_m: how far outside a number of a row may be, in m or m/s, at least the rounding of
            doubles; passages are taken as they are.
        report: called with the simulated time reached, in s.

    Raises:
        InputError: no row or passage lies within the scene's span, or the proof decides nothing at
            any of the times.
        UnreachableError: the box is too wide.
    """
    times = _Times.of(candidate, passages, ranges.scene.exact.t_end)
    _check_clock(candidate, times)
    sections = ranges.scene.run.sections or ()  # a new proof finds no others than are needed
    ranges = _proved_at(times, ranges, report)
    intervals = _intervals(ranges, times.section)
    if times.needs_passages and not intervals:
        word = times.section or "xdot"
        expected = f"positions, for {word} has no single zeros in this scene"
        raise InputError(times.name, Described("transits"), expected, "Print t,x,y.")

    outside: list[Outside] = []
    if candidate is not None:
        outside += _rows_outside(candidate, times.rows_in_span, ranges, tolerance_m)
    decided = [t for t in times.passages_in_span if not _is_undecided(t, intervals)]
    outside += _passages_outside(decided, intervals, times.word)

    starts: tuple[Ends, ...] = ()
    if times.may_be_by_another_clock and (outside or not times.passages_in_span):
        starts = tuple(_starts(times.passages, intervals))
    if starts and times.section is not None:
        # a gate's clock starts at any time; a program's transits are since the release
        count = len(times.passages)
        return Measured(times.name, ranges, 0, count, (), (), times.section, starts)

    _check_decided(times, decided, intervals)
    notes = [
        *(candidate.notes if candidate is not None else ()),
        *_notes(times, decided, starts),
        *_notes_on_sections(sections, outside),
    ]
    return Measured(
        name=times.name,
        ranges=ranges,
        rows=len(times.rows_in_span),
        transits=None if passages is None else len(decided),
        outside=_farthest_first(outside),
        notes=tuple(notes),
        section=times.section,
        starts=starts,
    )


@dataclass(frozen=True)
class _Times:
    """The times of rows and passages in s, exactly as their decimals.

    Attributes:
        name: of the candidate.
        rows: times of rows.
        passages: times of passages of a section, or of transits, sorted.
        section: its word; None for transits.
        end: of the scene.
    """

    name: str
    rows: Sequence[Fraction]
    passages: Sequence[Fraction]
    section: str | None
    end: Fraction

    @classmethod
    def of(cls, candidate: Candidate | None, passages: Passages | None, end: Fraction) -> _Times:
        """Return the times of a candidate and of passages."""
        name = ""
        rows: list[Fraction] = []
        times: list[Fraction] = []
        section = None
        if passages is not None:
            name = passages.name
            times = sorted(_decimal(t) for t in passages.times)
            section = passages.section
        if candidate is not None:
            name = candidate.name
            rows = [_exact(candidate, "t", k) for k in range(len(candidate.t))]
        return cls(name, rows, times, section, end)

    @property
    def word(self) -> str:
        """The word for a passage: of its section, or "transit"."""
        return self.section or _TRANSIT

    @cached_property
    def rows_in_span(self) -> list[Fraction]:
        """The rows up to the end of the scene."""
        return [t for t in self.rows if t <= self.end]

    @cached_property
    def passages_in_span(self) -> list[Fraction]:
        """The passages after the release, up to the end of the scene."""
        return [t for t in self.passages if 0 < t <= self.end]

    @property
    def needs_passages(self) -> bool:
        """Whether a proof has to find passages."""
        return bool(self.passages_in_span or not self.rows_in_span)

    @property
    def may_be_by_another_clock(self) -> bool:
        """Whether there are passages alone, and their clock may not have started at the release."""
        return not self.rows and _fits(self.passages, self.end)


def _check_clock(candidate: Candidate | None, times: _Times) -> None:
    """Refuse rows by a clock that did not start at the release, and times none of which can be judged.

    Raises:
        InputError: they are such.
    """
    if candidate is not None:
        clock_s = candidate.clock_s
        if clock_s is None and not times.rows_in_span and _fits(times.rows, times.end):
            clock_s = float(candidate.t[0])
        if clock_s is not None:
            got = Described(f"{shown(clock_s)} in the first row")
            raise InputError(f"{times.name}: t", got, "times since the release", SUBTRACT)

    in_span = times.rows_in_span or times.passages_in_span
    if not in_span and not times.may_be_by_another_clock:
        got = Described("no row within the scene's span")
        expected = f"a row at most {float(times.end):g} s after the release, where the scene ends"
        raise InputError(times.name, got, expected, "Set run.t_end to a later time.")


def _fits(times: Sequence[Fraction], end: Fraction) -> bool:
    """Return whether times, more than one, may be by a clock that did not start at the release."""
    return len(times) > 1 and times[-1] - times[0] <= end


def _proved_at(times: _Times, ranges: Ranges, report: Report | None) -> Ranges:
    """Return ranges that have the times of all rows, and passages if needed: the same, or a new proof."""
    rows = times.rows_in_span
    has_rows = set(rows) <= set(ranges.times)
    has_passages = not times.needs_passages or _intervals(ranges, times.section)
    if has_rows and has_passages:
        return ranges

    inputs = ranges.scene.exact
    in_span = [*rows, *times.passages_in_span]
    last = max(in_span) if in_span else times.passages[-1] - times.passages[0]
    grid = {Fraction(0), *rows}
    if times.needs_passages or not last:
        # a swing beyond the last one, so that a transit is not cut off
        swing_s = last
        if inputs.gravity:
            swing_s = Fraction(SWING * float(inputs.length / abs(inputs.gravity)) ** 0.5)
        grid.add(min(last + swing_s, times.end))

    transits = times.needs_passages and times.section is None
    sought = {"run.transits": str(transits).lower(), "run.sections": times.section or ""}
    scene = ranges.scene.with_values(sought)
    box = {name: f"±{width}" for name, width in ranges.uncertain.items()}
    return prove_ranges(scene, box, times=sorted(grid), report=report)


def _check_decided(times: _Times, decided: Sequence[Fraction], intervals: Sequence[_Zero]) -> None:
    """Refuse a file of passages if none of them is within the scene's span, or decided by the proof.

    Raises:
        InputError: no passage can be compared.
    """
    if times.rows_in_span or decided:
        return
    if not times.passages_in_span:
        got = Described(f"{float(times.passages[0]):.10g} s as the first time")
        expected = f"times above 0 and up to {float(times.end):g} s"
        raise InputError(f"{times.name}: t", got, expected, SUBTRACT)

    first = times.passages_in_span[0]
    zero = next(zero for zero in intervals if not zero.is_single and zero.holds(first))
    advice = (
        f"Between {float(zero.low):g} and {float(zero.high):g} s nothing is proved. "
        "Give smaller widths, or choose another section."
    )
    got = Described(f"{float(first):g} s")
    expected = "a time for which the proof decides whether there is a passage"
    raise InputError(f"{times.name}: t", got, expected, advice)


def _notes(times: _Times, decided: Sequence[Fraction], starts: Sequence[Ends]) -> Iterator[str]:
    """Yield remarks on a clock, and on times that are left out."""
    if starts:
        yield f"all transits are inside if the clock showed {starts_in_words(starts)} at the release"

    late = sum(t > times.end for t in [*times.rows, *times.passages])
    if late:
        yield f"after {float(times.end):g} s {counted(late, 'time')} left out"

    undecided = len(times.passages_in_span) - len(decided)
    if undecided:
        why = f"at which the proof does not decide {times.word}"
        yield f"{counted(undecided, 'time')} left out, {why}"


def _notes_on_sections(sections: Sequence[str], outside: Iterable[Outside]) -> Iterator[str]:
    """Yield a hint if transits are outside and may be passages of the scene's section."""
    if sections and any(number.column == _TRANSIT for number in outside):
        yield f"for passages of {sections[0]} write --section '{sections[0]}'"


def _farthest_first(outside: Sequence[Outside]) -> tuple[Outside, ...]:
    """Sort numbers: first the farthest of each column, then the others; rows before passages."""
    farthest: dict[str, float] = {}
    for number in outside:
        farthest[number.column] = max(number.by, farthest.get(number.column, 0.0))

    def place(number: Outside) -> tuple[bool, bool, float]:
        is_farthest = number.by == farthest[number.column]
        return not is_farthest, number.column not in STATE, -number.by

    return tuple(sorted(outside, key=place))


def _rows_outside(
    candidate: Candidate, times: Sequence[Fraction], ranges: Ranges, tolerance_m: float
) -> Iterator[Outside]:
    """Yield the numbers of a candidate's first rows, at these times, that lie outside."""
    place = {t: k for k, t in enumerate(ranges.times)}
    for name in STATE:
        if name not in candidate.columns:
            continue
        intervals = ranges.grid.exact(name)
        largest = max(max(-low, high) for low, high in intervals)
        allowed = max(Fraction(tolerance_m), _ROUNDING * largest)
        for k, t in enumerate(times):
            low, high = intervals[place[t]]
            got = _exact(candidate, name, k)
            by = max(low - got, got - high)
            if by > allowed:
                yield Outside(name, *map(float, (t, got, low, high, by)))


@dataclass(frozen=True)
class _Zero:
    """An interval in s in which there is one zero, or in which there may be any number of them."""

    low: Fraction
    high: Fraction
    is_single: bool

    def holds(self, t: Fraction) -> bool:
        """Return whether a time lies in the interval."""
        return self.low <= t <= self.high

    def gap(self, t: Fraction) -> Fraction:
        """Return the distance in s of a time from the interval; 0 inside."""
        return max(self.low - t, t - self.high, Fraction(0))


def _intervals(ranges: Ranges, section: str | None) -> list[_Zero]:
    """Return the intervals of transits, or of a section's passages."""
    if section is None:
        table = ranges.transits
        possible = ranges.possible
    else:
        passages = ranges.sections.get(section)
        if passages is None:
            return []
        table = passages.table
        possible = passages.possible
    single = table.exact("t") if len(table) else []
    zeros = [_Zero(low, high, True) for low, high in single]
    zeros += [_Zero(low, high, False) for low, high, _ in possible]
    return zeros


def _is_undecided(t: Fraction, intervals: Sequence[_Zero]) -> bool:
    """Return whether a time lies in an interval that may hold zeros, and in none that holds just one."""
    around = [zero for zero in intervals if zero.holds(t)]
    return bool(around) and not any(zero.is_single for zero in around)


def _passages_outside(
    times: Iterable[Fraction], intervals: Sequence[_Zero], word: str
) -> Iterator[Outside]:
    """Yield passages in no proven interval, or in one whose only zero is an earlier passage."""
    free = list(intervals)
    for t in times:
        zero = min(free or intervals, key=lambda zero: zero.gap(t))
        gap = zero.gap(t)
        if gap or not free:
            yield Outside(word, *map(float, (t, t, zero.low, zero.high, gap)))
        elif zero.is_single:
            free.remove(zero)


def _starts(times: Sequence[Fraction], intervals: Sequence[_Zero]) -> Iterator[Ends]:
    """Yield what a clock may have shown at the release, if each time lies in an interval of its own by it."""
    for low, high in clock_starts(times, [(zero.low, zero.high) for zero in intervals]):
        middle = (low + high) / 2
        shifted = [t - middle for t in times]
        if not any(_passages_outside(shifted, intervals, _TRANSIT)):
            yield low, high


def _exact(candidate: Candidate, name: str, k: int) -> Fraction:
    """Return a number of a row exactly: the shortest decimal of a double, and what the file has beyond it."""
    column = candidate.t if name == "t" else candidate.columns[name]
    low = candidate.low.get(name)
    if low is None or not low[k]:
        return _decimal(column[k])
    return Fraction(float(column[k])) + Fraction(float(low[k]))


def _decimal(x: float) -> Fraction:
    return Fraction(repr(float(x)))
