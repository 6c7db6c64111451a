"""Many scenes solved in double: the input, `Rows` and `RunOptions`, and the output, `Outcomes`.

An engine that can do this declares a `Batch` as `BATCH` in the file `batch.py` of its folder. The
results of a row do not depend, in any bit, on the other rows. `PlumbAxes` are rows in the axes of
their plumb lines.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from ..numbers.double_double import DoubleDouble, square_root
from ..numbers.precision import Array
from ..system.imports import OptionalEngine

# what became of a row, in `Outcomes.fate`
OK, DOUBTFUL, STOPPED = 0, 1, 2
# of the period 2π/√|c| of a small swing, in which ordinary transits are half a period apart
CLOSE_PAIR = 0.25
LEAST_BEND = 1e-6  # of a highest point: below it the orbit is conical
XDOT = (0, 0, 0, 1, 0, 0, 0)  # the form a·n + b·n' - d of the transits: a, b and d


@dataclass(frozen=True)
class Rows:
    """The constants and the release of n scenes: x east, y north, z up; lengths over l, seconds.

    Numbers of shape (…, 2) are high + low: the double nearest to the exact number, and the double
    nearest to the remainder. All arrays are contiguous.

    Attributes:
        length: cord length l in m, shape (n, 2).
        drag: γ in 1/s, shape (n, 2).
        t_end: end of the span in s, shape (n, 2).
        turn: rotation vector Ω in rad/s, shape (n, 3, 2).
        pull: c, gravity and the centrifugal force at the pivot over l, in 1/s², shape (n, 3, 2).
        n: position over l at t = 0, a unit vector, shape (n, 3, 2).
        V: n' + Ω × n at t = 0, in 1/s, shape (n, 3, 2).
        form: a, b and d of the form a·n + b·n' - d whose zeros are the transits, b in s; `XDOT`, or
            that of a section, shape (n, 7, 2).
        zeros_at_release: multiplicity of its zero at t = 0 by the exact inputs, 0 to 4, shape (n,),
            int64.
        leaves: of a section its sign just after t = 0, NaN where it is not known; of xdot 0, shape
            (n,).
        rising: sign of u', the rate at which the bob rises along the plumb line, at t = 0 by the
            exact inputs: -1, 0 or 1, shape (n,), int64.
        still: whether xdot is zero at all times by the exact inputs, shape (n,): such a row has no
            transits.
    """

    length: Array
    drag: Array
    t_end: Array
    turn: Array
    pull: Array
    n: Array
    V: Array
    form: Array
    zeros_at_release: Any
    leaves: Array
    rising: Any
    still: Any

    def __len__(self) -> int:
        return len(self.length)

    @cached_property
    def rate(self) -> Array:
        """Angular frequency √|c| of a small swing, in rad/s."""
        return np.asarray(np.sqrt(np.linalg.norm(self.pull[..., 0], axis=1)))

    @classmethod
    def joined(cls, blocks: Sequence[Self]) -> Self:
        """Return the rows of several blocks, in order."""
        joined = {}
        for field in fields(cls):
            joined[field.name] = np.concatenate([getattr(block, field.name) for block in blocks])
        return cls(**joined)

    def __getitem__(self, chosen: Any) -> Self:
        """Return some of the rows: a slice, or an array of indices or truths."""
        columns = {}
        for field in fields(self):
            columns[field.name] = np.ascontiguousarray(getattr(self, field.name)[chosen])
        return type(self)(**columns)


@dataclass(frozen=True)
class RunOptions:
    """Which results a run returns for each row besides its final state, and whether the run is perturbed.

    Attributes:
        transits: count the zeros of xdot in 0 < t <= t_end, all of them located, and judge them.
        apsides: the highest points of the swing, for its frequency and its precession.
        times: the time and the direction of each transit as well.
        form: the transits are the zeros of `Rows.form`, which is not xdot.
        moved: a run that tells the error: another order, and every constant and start number one
            ulp further from 0 (1) or nearer to it (-1); 0 for the run itself.
    """

    transits: bool = True
    apsides: bool = True
    times: bool = False
    form: bool = False
    moved: int = 0


@dataclass(frozen=True)
class Outcomes:
    """Results of n rows, in SI units.

    A result that is not asked for, or does not exist, is 0 if it is a count, else NaN.

    Attributes:
        fate: OK, DOUBTFUL (a transit or a highest point is undecided in double) or STOPPED (the
            step became too short or a number not finite), shape (n,), int8. A stopped row's other
            numbers mean nothing.
        state: x, y, z in m and vx, vy, vz in m/s at t_end, shape (n, 6).
        steps: steps taken, int32.
        transits: number of transits, int32.
        t_first, t_last: times of the first and of the last one, in s.
        close_pairs: transits nearer to the one before than `CLOSE_PAIR` of a small swing's period,
            int32.
        least_ax: smallest |ax| at a transit, in m/s²; of a section the smallest rate of its form,
            times l.
        apsides: number of highest points (where zdot along the plumb line goes from + to -) in 0 <
            t <= t_end, int32.
        apsis_first, apsis_last: times of the first and of the last one, in s.
        turn: azimuth of the last minus that of the first about the plumb line -c, half turns left
            out, in rad, from east to north: the sum of the changes from one to the next, each taken
            between -π/2 and π/2.
        same_side: highest points that lie on the same side of the plumb line as the one before,
            int32: none of a swing to and fro, nearly all of a bob that goes over the top.
        least_bend: smallest -u''/(|c| (1 - u²)) at a highest point, u = -n·c/|c|: about 1 for a
            swing in a plane, 0 for a conical orbit; where it is below `LEAST_BEND` there are no
            highest points to speak of, and none are counted.
        least_fall: smallest -u'' at a highest point, in 1/s².
        largest_angle: largest angle from the plumb line in the whole span, in rad: at a highest
            point, the release or the end.
        transit_row, transit_t, transit_direction: of every transit, ordered by row and time; empty
            if not asked for.
    """

    fate: Any
    state: Array
    steps: Any
    transits: Any
    t_first: Array
    t_last: Array
    close_pairs: Any
    least_ax: Array
    apsides: Any
    apsis_first: Array
    apsis_last: Array
    turn: Array
    same_side: Any
    least_bend: Array
    least_fall: Array
    largest_angle: Array
    transit_row: Any
    transit_t: Array
    transit_direction: Any

    @classmethod
    def empty(cls, count: int) -> Self:
        """Return empty outcomes of `count` rows, to be filled in."""
        columns: dict[str, Any] = {field.name: np.full(count, np.nan) for field in fields(cls)}
        columns["fate"] = np.zeros(count, np.int8)
        columns["state"] = np.full((count, 6), np.nan)
        for name in ("steps", "transits", "close_pairs", "apsides", "same_side"):
            columns[name] = np.zeros(count, np.int32)
        columns["transit_row"] = np.zeros(0, np.int64)
        columns["transit_t"] = np.zeros(0, np.float64)
        columns["transit_direction"] = np.zeros(0, np.int8)
        return cls(**columns)

    def with_transits(self, times: Sequence[Array], directions: Sequence[Array]) -> Self:
        """Return the same with transits: their times and their directions, row by row."""
        counts = np.fromiter(map(len, times), np.int64)
        return replace(
            self,
            transit_row=np.repeat(np.arange(len(times)), counts),
            transit_t=np.concatenate([np.zeros(0), *times]),
            transit_direction=np.concatenate([np.zeros(0), *directions]).astype(np.int8),
        )


class Batch(OptionalEngine, ABC):
    """An engine that solves many rows in double.

    Attributes:
        drag: whether it solves rows with drag.
        lanes: rows that it solves at a time.
        swing_s: CPU seconds of a default row over the period of a small swing.
        section_work: over that, what a section adds: a gate or a turn; highest or lowest points.
        load_s: CPU seconds of loading what is kept on disk.
        compile_s: CPU seconds of compiling what rows or sections need, and beside it what the
            others need.
        identity: what decides its digits beside the rows: orders, tolerance, versions of what it
            computes with.
    """

    drag: ClassVar[bool]
    lanes: ClassVar[int] = 8
    swing_s: ClassVar[float]
    section_work: ClassVar[tuple[float, float]]
    load_s: ClassVar[float] = 0.0
    compile_s: ClassVar[tuple[float, float]]

    @property
    @abstractmethod
    def identity(self) -> str:
        """Everything that the digits depend on, in one line: name, orders, tolerance, versions."""

    @abstractmethod
    def prepare(self, options: RunOptions) -> None:
        """Compile the code that such rows without drag need, unless it is compiled already."""

    @abstractmethod
    def solve(self, rows: Rows, options: RunOptions) -> Outcomes:
        """Solve rows in the calling thread, without blocking others; `fate` says which failed."""

    def compiling_s(self, sections: bool) -> float:
        """Return the CPU seconds that compiling will take: 0 for code that is kept on disk."""
        return sum(self.compile_s[: 1 + sections])


@dataclass(frozen=True)
class PlumbAxes:
    """Constants and releases of n rows in the axes of the plumb line, each number of shape (n,).

    x points east, p lies in the meridian, u up along -c: there a small swing loses no digits.

    Attributes:
        size: |c|, in 1/s²; c points down.
        sin, cos: the direction up, north and up.
        turn: Ω without its part to the east, which is 0.
        n, V: as in `Rows`.
        speed: a bound of the velocities over l.
    """

    size: DoubleDouble
    sin: DoubleDouble
    cos: DoubleDouble
    turn: tuple[DoubleDouble, DoubleDouble]
    n: tuple[DoubleDouble, DoubleDouble, DoubleDouble]
    V: tuple[DoubleDouble, DoubleDouble, DoubleDouble]
    speed: Array

    @classmethod
    def of(cls, rows: Rows) -> Self:
        """Return the rows' constants and releases in these axes."""
        # many names, as each is a quantity of one formula
        of = DoubleDouble.from_pairs
        north = of(rows.pull[:, 1])
        up = of(rows.pull[:, 2])
        size = square_root(north * north + up * up)
        sin, cos = plumb_line(north, up, size, np.where(size.vanishes, 1.0, 0.0))
        vectors = []
        for vector in (rows.turn, rows.n, rows.V):
            x, y, z = (of(vector[:, i]) for i in range(3))
            vectors.append((x, *turned(y, z, sin, cos)))
        (_, *turn), n, V = vectors
        speed = np.abs(rows.V[:, :, 0]).sum(1) + np.abs(rows.turn[:, :, 0]).sum(1)
        return cls(size, sin, cos, (turn[0], turn[1]), n, V, speed)

    def forms(self, rows: Rows) -> Array:
        """Return the coefficients a, b and d of each row's form a·n + b·n' - d, shape (7, n).

        In these axes n is counted from the lowest point, (0, 0, -1).
        """
        numbers = [DoubleDouble.from_pairs(rows.form[:, i]) for i in range(len(XDOT))]
        ax, ay, az, bx, by, bz, d = numbers
        ap, au = turned(ay, az, self.sin, self.cos)
        bp, bu = turned(by, bz, self.sin, self.cos)
        return np.array([number.high for number in (ax, ap, au, bx, bp, bu, d + au)])


def moved(numbers: Array, way: int) -> Array:
    """Return numbers an ulp further from zero (`way` is 1), nearer to it (-1), or unchanged (0)."""
    if not way:
        return numbers
    beyond = np.copysign(np.inf, numbers) if way > 0 else 0.0
    return np.where(numbers == 0, 0.0, np.nextafter(numbers, beyond))


def plumb_line(north: Any, up: Any, size: Any, vanishes: Array) -> tuple[Any, Any]:
    """Return the north and up components of the unit vector along -c, the upward plumb line.

    Where there is no force `vanishes` is 1, and it is the vertical; elsewhere `vanishes` is 0.
    """
    return -north / (size + vanishes), (vanishes - up) / (size + vanishes)


def turned(north: Any, up: Any, sin: Any, cos: Any) -> tuple[Any, Any]:
    """Return a vector's components in the meridian and along the plumb line.

    The line leans by (sin, cos) from the vertical.
    """
    return cos * north - sin * up, sin * north + cos * up
