"""A file that is to be explained, and what explains it: rows and truth, causes, and the lines that say so."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import zip_longest
from typing import Any

import numpy as np

from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from .advice import advice_on
from .phasors import ComplexArray, sinc
from .programs import NAMES, Program, SphericalPendulum
from .thresholds import FINEST, RIVAL, ROUNDED

_SLOWEST = 1e-6  # rad/s: used as the scale of the rotation rate where the scene has none
EXACT = 1e-14  # of the cord: two numbers that differ by less are one
CONVENTION = 0.3  # decades that a convention, or a price of one, has to explain
ROUNDING = ("decimals", "decimals_of_z", "digits", "single_precision")
HARMLESS = ("z_constant", *ROUNDING)  # conventions that a model may go with
WITHOUT_HEIGHTS = ("off_the_sphere", "z_wrong")  # conventions whose heights are left out
UNCORRECTED = (*HARMLESS, *WITHOUT_HEIGHTS)  # conventions of which nothing is put right
# stage of a cause that is not certain: the motion is like that
AS_IF = "as_if"
EITHER = "either"  # stage of several causes of which one is true: the file does not tell which
BEGIN = "It seems that your program"
EQUAL = 1.01  # ratio of two residuals that may be one: fits of the same motion end a little apart


@dataclass(frozen=True)
class FileRows:
    """The rows of a file, made right: times in s, positions in m (x, y and perhaps z), half a unit of its last digit.

    Attributes:
        times: increasing, in s, shape (rows,).
        positions: x, y and perhaps z in m, shape (rows, 2 or 3).
        noise: rounding of the numbers, in m.
        plane_noise: that of x and y alone, which may be less.
        conventions: what was changed.
        starts: whether row 0 is the release.
        cord: mean distance from the suspension in m, where the rows do not keep it; else None.
    """

    times: Array
    positions: Array
    noise: float
    plane_noise: float
    conventions: tuple[Deviation, ...] = ()
    starts: bool = True
    cord: float | None = None

    @property
    def plane(self) -> Array:
        """x and y in m, shape (rows, 2)."""
        return self.positions[:, :2]

    def changed(self, convention: Deviation, **fields: object) -> FileRows:
        """Return the rows with some fields replaced, and what is to be said of that."""
        return replace(self, conventions=(*self.conventions, convention), **fields)  # type: ignore[arg-type]


def largest(difference: Array) -> float:
    """Return the largest distance in m that differences of rows make."""
    return float(np.linalg.norm(difference, axis=1).max())


def rms(difference: Array | ComplexArray) -> float:
    """Return the root mean square distance in m that they make."""
    return float(np.linalg.norm(difference)) / math.sqrt(len(difference))


def first_least(residuals: Sequence[float], resolution: float = 0.0) -> int:
    """Return the index of the first of the least residuals; those below a resolution are equal.

    So rounding errors, which are others on another processor, choose between no two fits.
    """
    enough = EQUAL * max(min(residuals), resolution)
    return next(i for i, residual in enumerate(residuals) if residual <= enough)


@dataclass(frozen=True)
class NamedModel:
    """A named simplification that the file is exact within.

    Attributes:
        id: a stable word.
        text: its name.
        exact_to_m: the largest distance in m between the file and it.
        costs_m: the largest distance in m between it and the full Lagrangian.
    """

    id: str
    text: str
    exact_to_m: float
    costs_m: float


@dataclass(frozen=True)
class Explanation:
    """Reasons for an error, and how much of it they explain.

    Attributes:
        conventions: of the rows.
        causes: in the order gravity, model, inputs, release, frame, clock, integrator.
        model: the simplification that the file is exact within, if it is.
        corrected_m: the largest error in m once all of these are corrected.
        explains: whether that is within the tolerance, or the rounding of the file.
        slip: where none is known, which part of the force is off: a sentence.
        explained: share of the root mean square error that is gone with them.
        score: decades, as in `readings`: of two explanations the lower one is the better.
        allowed_m: distance in m that counts as agreement.
        next_step: what to do where no cause is certain.
        price: of its causes.
        residual_rms_m: the root mean square of the residuals in m, at least the resolution.
        reading: the `CauseReading` of its causes, whose numbers can be fitted again; None if it has none.
    """

    conventions: tuple[Deviation, ...] = ()
    causes: tuple[Deviation, ...] = ()
    model: NamedModel | None = None
    corrected_m: float = math.nan
    explains: bool = False
    slip: str = ""
    explained: float = 0.0
    score: float = 0.0
    allowed_m: float = math.inf
    next_step: str = ""
    price: int = 0
    residual_rms_m: float = math.inf
    reading: Any = field(default=None, repr=False, compare=False)

    @property
    def known(self) -> list[Deviation]:
        """The causes that are certain."""
        return [cause for cause in self.causes if cause.stage not in (AS_IF, EITHER)]

    def lines(self) -> Iterator[str]:
        """Yield what is known, line by line, for people: what is so, and below it what to do."""
        for convention, following in zip_longest(self.conventions, self.conventions[1:]):
            yield f"Your file {convention.text}."
            yield from _advised(convention, following)
        listed = self.model is not None or len(self.causes) > 1
        if self.model is not None:
            exact = f"As that model it is exact to {self.model.exact_to_m:.2g} m"
            yield f"{exact}; against the full Lagrangian it is {self.model.costs_m:.3g} m off:"
        elif listed:
            yield f"{BEGIN} (largest effect first)"
        causes = sorted(self.causes, key=lambda cause: -cause.size_m)
        for cause, following in zip_longest(causes, causes[1:]):
            yield f"{'-' if listed else BEGIN} {cause.text}: off by {cause.size_m:.3g} m"
            yield from _advised(cause, following)
        if any(cause.stage == AS_IF for cause in self.causes):
            yield 'Where it says "moves like", the cause may be another number, a clock, a step or another term.'
        if self.slip:
            yield self.slip
        yield from self._remaining_error()
        if self.next_step and not self.known and (self.causes or not self.explains):
            yield f"Next: {self.next_step}"

    def _remaining_error(self) -> Iterator[str]:
        """Yield the error once all is corrected, or that nothing is known."""
        corrected = [part for part in self.conventions if part.id not in UNCORRECTED]
        convention_ids = {part.id for part in self.conventions}
        without_z = not convention_ids.isdisjoint(WITHOUT_HEIGHTS)
        # a smaller error is rounding, and not the same on every processor
        rounding_m = self.allowed_m / 1000
        remaining = f"below {rounding_m:.1g} m"
        if self.corrected_m > rounding_m:
            remaining = f"{self.corrected_m:.2g} m"

        if not math.isfinite(self.corrected_m) or not (self.causes or corrected):
            if self.explains and without_z:
                yield f"Without its z, the error is {remaining}."
            elif self.explains and not convention_ids.isdisjoint(ROUNDING):
                yield "The rounding of its numbers explains the error."
            elif not self.slip:
                yield "Nothing that was tried explains the error."
            return
        these = "this" if len([*self.causes, *corrected]) == 1 else "all this"
        left_out = ", and without its z" if without_z else ""
        tolerances = self.corrected_m / self.allowed_m
        beyond = ""
        if tolerances > 1 and not self.explains:
            beyond = f", {tolerances:.2g} tolerances: nothing that was tried explains it"
        yield f"With {these} corrected{left_out}, the error is {remaining}{beyond}."


def _advised(part: Deviation, following: Deviation | None) -> Iterator[str]:
    """Yield what to do about a convention or a cause, unless the following one has the same advice."""
    text = _advice(part)
    if text and (following is None or text != _advice(following)):
        yield f"  → {text}"


def _advice(part: Deviation) -> str:
    """Return what to do about a convention or a cause that is certain; "" if there is nothing to do."""
    return "" if part.stage in (AS_IF, EITHER) else advice_on(part.id)


@dataclass(frozen=True)
class FileCase:
    """A file that is to be explained.

    Attributes:
        rows: of the file, conventions put right.
        truth: the positions of the full model at their times in m, shape (rows, 2 or 3).
        right: what a right program computes with.
        pendulum: runs a program.
        frequency: of the scene's swing in rad/s.
        allowed_m: distance in m that counts as agreement.
        intervals: between the rows of the whole file, from the release on; 0 if it begins later.
    """

    rows: FileRows
    truth: Array
    right: Program
    pendulum: SphericalPendulum
    frequency: float
    allowed_m: float
    intervals: int = 0

    @property
    def error(self) -> float:
        """Root mean square error of the rows in m."""
        return rms(self.rows.positions - self.truth)

    @property
    def floor(self) -> float:
        """Root mean square in m below which no error needs a cause."""
        return max(self.rows.noise, self.allowed_m / RIVAL)

    @property
    def needs_cause(self) -> bool:
        """Whether the error of the rows is more than their rounding, or a small part of the tolerance."""
        is_rounding = largest(self.rows.positions - self.truth) <= self.rounding_of_row
        return self.error > self.floor and not is_rounding

    @property
    def rounding_of_row(self) -> float:
        """Largest distance in m by which rounding moves a row."""
        return ROUNDED * math.sqrt(self.rows.positions.shape[1]) * self.rows.noise

    @property
    def resolution(self) -> float:
        """Root mean square in m below which residuals are rounding, and equal."""
        return max(self.rows.noise, FINEST * self.allowed_m)

    @property
    def enough(self) -> float:
        """Largest residual in m of rows that are explained."""
        return max(self.allowed_m, self.rounding_of_row)

    @property
    def released(self) -> bool:
        """True if row 0 is the release to its last digit, so that neither its place nor its time is off."""
        off = np.abs(self.rows.positions[0, :2] - (self.right.x, self.right.y)).max()
        same = 2 * self.rows.plane_noise + EXACT * self.right.length
        return bool(self.rows.times[0] == 0 and off <= same)

    @property
    def pull(self) -> float:
        """Gravity over the length in 1/s², or what stands for it where there is none."""
        return self.right.g / self.right.length or abs(float(self.right.theta()[5]))

    @property
    def scales(self) -> Array:
        """Sizes of the numbers of theta, in the order of `NAMES`."""
        length = self.right.length
        rate = max(abs(self.right.rate), _SLOWEST)
        swing = math.sqrt(self.pull)
        sizes = {
            "turn_x": rate,
            "turn_y": rate,
            "turn_z": rate,
            "pull_x": self.pull,
            "pull_y": self.pull,
            "pull_z": self.pull,
            "drag": swing,
            "x": length,
            "y": length,
            "vx": length * swing,
            "vy": length * swing,
            "length": length,
            "gradient": 1.0,
            "point_mass": 1.0,
        }
        return np.array([sizes[name] for name in NAMES])

    def part(self, count: int) -> FileCase:
        """Return the case of the first `count` rows."""
        times = self.rows.times[:count]
        rows = replace(self.rows, times=times, positions=self.rows.positions[:count])
        return replace(self, rows=rows, truth=self.truth[:count])

    def in_the_plane(self) -> FileCase:
        """Return the case of x and y alone."""
        positions = np.ascontiguousarray(self.rows.plane)
        rows = replace(self.rows, positions=positions, cord=None)
        return replace(self, rows=rows, truth=self.truth[:, :2])

    def explanation(
        self, causes: tuple[Deviation, ...], residuals: Array, price: int
    ) -> Explanation:
        """Return the explanation that some causes make up.

        Args:
            causes: as in `Explanation`.
            residuals: of the rows in m, shape (rows, 2 or 3).
            price: of the causes; each convention costs one.
        """
        corrected_m = largest(residuals)
        residual_rms_m = rms(residuals)
        explains = corrected_m <= self.enough
        # what is within the tolerance speaks against no explanation
        counted_m = 0.0 if explains else residual_rms_m
        size = math.log10(max(counted_m / self.allowed_m, 1e-2))
        score = size + CONVENTION * (len(self.rows.conventions) + price)
        return Explanation(
            conventions=self.rows.conventions,
            causes=causes,
            corrected_m=corrected_m,
            explains=explains,
            explained=1 - residual_rms_m / self.error if self.error else 0.0,
            score=score,
            allowed_m=self.allowed_m,
            price=price,
            residual_rms_m=max(residual_rms_m, self.resolution),
        )

    def pendulum_of(self, program: Program) -> tuple[SphericalPendulum, Array]:
        """Return the pendulum and the theta of a program, the centrifugal force's change that of its own latitude."""
        theta = program.theta()
        if program.kind == "sphere":
            theta[NAMES.index("gradient")] = program.gradient * program.pace**2
        return replace(self.pendulum, square=program.gradient_square), theta

    def positions(self, program: Program) -> Array:
        """Return what a program writes, in the rows' columns, shape (rows, 2 or 3)."""
        times = self.rows.times
        columns = self.rows.positions.shape[1]
        if program.kind == "sphere":
            pendulum, theta = self.pendulum_of(program)
            return pendulum.rows(theta, times, columns)
        plane = program.phasors().at(times)
        if program.kind == "angle":
            plane = plane * sinc(np.abs(plane) / program.length)
        below = np.maximum(program.length**2 - np.abs(plane) ** 2, 0)
        return np.column_stack([plane.real, plane.imag, -np.sqrt(below)])[:, :columns]

    def residuals(self, program: Program) -> Array:
        """Return the rows less those of a program in m, shape (rows, 2 or 3)."""
        return self.rows.positions - self.positions(program)
