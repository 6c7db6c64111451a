"""The explanations of several runs together: causes, and the way in which each follows the scene.

One file does not show whether a program takes g to be 9.81, or 1.0003 times what it is given, or
has a fast clock. In a scene with another g these are different motions. So the rows of all runs are
put together, and read like those of one file.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import count
from typing import NamedTuple

import numpy as np

from reference.numbers.precision import Array

from ...candidates.candidate import Deviation
from ..case import Explanation, FileCase, largest
from ..causes import Cause, causes_of
from ..explain import KnownScene
from ..families import FamilyFit, fits_of
from ..fitted import MODELS, polished, ranked, readers_of, sized
from ..phasors import FixedStepMethod
from ..programs import Program
from ..readings import CauseReading
from ..stepped import FIRST_STEPS, Steps, step_cause
from ..thresholds import RIVAL

# how a cause follows the scene; the end of its sentence
_RULE = ""
TYPED = ", whatever it is given"
FACTOR = ", in proportion to what it is given"
# numbers that a scene, or {setting}, gives
_INPUTS = ("g", "length", "latitude", "rate", "x", "y", "vx", "vy", "step")
# relative error of the leading error of a step, over the square of the swing's angle
_WIDE = 2.0
_WHOLE = 1e-3  # of a number of steps: how far it may be from a whole number
# inputs of the frequency of the swing that a program may have typed into it
_IGNORED = ("g",), ("length",), ("g", "length")
_TRIED = 30  # readings of a family that are run
# decades by which a reading that explains all files may be dearer than the cheapest
EQUAL = math.log10(RIVAL)


@dataclass(frozen=True)
class Trial:
    """A run of a program.

    Attributes:
        problem: the scene that it was given.
        case: its rows.
        setting: its {setting} over that of the first run.
    """

    problem: KnownScene
    case: FileCase
    setting: float = 1.0

    @cached_property
    def fits(self) -> dict[str, FamilyFit]:
        """The fits of its rows by family."""
        return {fit.kind: fit for fit in fits_of(self.case)}

    def ignoring(self, names: Sequence[str], first: Trial) -> Trial:
        """Return the trial of a program that was given some numbers, and computed with those of the first run.

        Of two frequencies that sparse rows do not distinguish, the fits find the one that is
        nearer to the frequency of such a program.
        """
        numbers = {name: getattr(first.case.right, name) for name in names}
        right = self.case.right.changed(**numbers)
        frequency = math.sqrt(abs(right.theta()[5]))
        fastest = max(frequency, self.case.frequency)
        spacing_s = float(np.median(np.diff(self.case.rows.times)))
        is_sparse = fastest * spacing_s > math.pi  # fewer than two rows a swing
        if right == self.case.right or not is_sparse:
            return self
        return replace(self, case=replace(self.case, right=right, frequency=frequency))

    @cached_property
    def causes(self) -> dict[tuple[str, str, int], Cause]:
        """The mistakes that a program of its scene may have.

        The keys are the family, the id, and the index among those of one id.
        """
        causes = {}
        counters = defaultdict[tuple[str, str], Iterator[int]](count)
        for kind in ("sphere", *MODELS):
            for cause in causes_of(self.case, kind):
                index = next(counters[kind, cause.id])
                causes[kind, cause.id, index] = cause
        return causes

    def given(self, name: str) -> float:
        """Return a number that the program was given."""
        return self.setting if name == "step" else float(getattr(self.case.right, name))


class FollowedCause(NamedTuple):
    """A cause of the first scene, and the way in which it follows the scene."""

    key: tuple[str, str, int]
    cause: Cause
    way: str

    def applied(self, program: Program, value: float, first: Trial, trial: Trial) -> Program:
        """Return a trial's program with the cause; `value` is its number in the first scene."""
        if self.way == _RULE:
            # a cause that the scene does not have, such as the sign of no rotation, changes nothing
            cause = trial.causes.get(self.key)
            return program if cause is None else cause.change(program)
        program = self.cause.change(program)
        free = self.cause.free
        if not free:
            return program
        if self.way == FACTOR and first.given(free):
            value *= trial.given(free) / first.given(free)
        return program.changed(**{free: value})


@dataclass(frozen=True)
class Joint(Program):
    """The program of the first run, from which those of the others follow.

    Attributes:
        runs: all of them.
        parts: its causes.
    """

    runs: tuple[Trial, ...] = field(default=(), compare=False, repr=False)
    parts: tuple[FollowedCause, ...] = ()

    @cached_property
    def programs(self) -> list[Program]:
        """The program of each run."""
        programs = []
        for trial in self.runs:
            program = trial.case.right.changed(kind=self.kind)
            for part in self.parts:
                value = getattr(self, part.cause.free) if part.cause.free else 0.0
                program = part.applied(program, value, self.runs[0], trial)
            programs.append(program)
        return programs

    @property
    def sensible(self) -> bool:
        """False if no program can have its inputs in one of the runs."""
        return all(program.sensible for program in self.programs)

    def theta(self) -> Array:
        """Return the theta of all runs, one after the other."""
        return np.concatenate([program.theta() for program in self.programs])


@dataclass(frozen=True)
class JointCase(FileCase):
    """The rows of all runs as those of one file, weighted by their largest permitted residuals."""

    runs: tuple[Trial, ...] = ()

    @classmethod
    def of(cls, runs: Sequence[Trial]) -> JointCase:
        """Return the case of some runs."""
        first = runs[0].case
        runs = tuple(runs)
        joint = cls(**vars(first), runs=runs)
        times = np.concatenate([run.case.rows.times for run in runs])
        positions = joint.side_by_side([run.case.rows.positions for run in runs])
        rows = replace(first.rows, times=times, positions=positions)
        truth = joint.side_by_side([run.case.truth for run in runs])
        return replace(joint, rows=rows, truth=truth, right=Joint(**vars(first.right), runs=runs))

    def weight(self, run: Trial) -> float:
        """Return by what the rows of a run are multiplied."""
        return self.runs[0].case.enough / run.case.enough

    def side_by_side(self, rows: Sequence[Array]) -> Array:
        """Return the weighted positions of all runs as those of one file."""
        weighted = [
            positions * self.weight(run) for positions, run in zip(rows, self.runs, strict=True)
        ]
        return np.concatenate(weighted)

    def positions(self, program: Program) -> Array:
        """Return what a program writes in all runs."""
        assert isinstance(program, Joint)
        runs = zip(self.runs, program.programs, strict=True)
        return self.side_by_side([run.case.positions(run_program) for run, run_program in runs])

    def _fit(self, kind: str, fitted: Sequence[Trial]) -> FamilyFit:
        """Return the fits of a family to all runs as one fit.

        Args:
            kind: of the family.
            fitted: the runs, or what their fits start from.
        """
        fits = []
        for run, fitted_run in zip(self.runs, fitted, strict=True):
            fit = fitted_run.fits[kind]
            share = math.sqrt(len(run.case.rows.times) / len(self.rows.times))
            weight = self.weight(run) * share
            fits.append(
                replace(fit, residual_rms_m=weight * fit.residual_rms_m, slopes=weight * fit.slopes)
            )
        theta = np.concatenate([fit.theta for fit in fits])
        residual_rms_m = math.hypot(*(fit.residual_rms_m for fit in fits))
        free = []
        for index, fit in enumerate(fits):
            first = index * len(fit.theta)
            free += [first + i for i in fit.free]
        # the triangular factor of the slopes is as good as they are, and shorter
        triangles = [np.asarray(np.linalg.qr(fit.slopes, mode="r")) for fit in fits]
        return FamilyFit(kind, theta, residual_rms_m, tuple(free), _block_diagonal(triangles))

    def causes(self, kind: str) -> list[Cause]:
        """Return the causes of a family, in every way in which the runs may distinguish them."""
        causes = []
        for key, cause in self.runs[0].causes.items():
            if key[0] != kind:
                continue
            varied = cause.free in _INPUTS and len({run.given(cause.free) for run in self.runs}) > 1
            if not cause.free:
                ways = [_RULE, TYPED]
            else:
                ways = [TYPED, FACTOR] if varied else [TYPED]
            causes += [_following(FollowedCause(key, cause, way), varied) for way in ways]
        return causes

    def readings(self, most: float = 1.0) -> list[CauseReading]:
        """Return the readings that explain all runs, the best first.

        Their residuals are at most `most` times what is permitted in each run.
        """
        for fitted in self._fitted():
            readings = self._readings_of(fitted, most)
            if readings:
                return readings
        return []

    def _fitted(self) -> Iterator[tuple[Trial, ...]]:
        """Yield the runs, then what else their fits may start from if their rows are sparse."""
        yield self.runs
        for names in _IGNORED:
            fitted = tuple(run.ignoring(names, self.runs[0]) for run in self.runs)
            if any(new is not run for new, run in zip(fitted, self.runs, strict=True)):
                yield fitted

    def _readings_of(self, fitted: Sequence[Trial], most: float) -> list[CauseReading]:
        """Return the readings of some fits of all runs, as `readings` does."""
        fits = [self._fit(kind, fitted) for kind in _common_kinds(fitted)]
        finite = [fit for fit in fits if np.isfinite(fit.slopes).all()]
        readers = [replace(reader, joint=True) for reader in readers_of(self, finite)]
        readings = [
            polished(self, reading) for reading in ranked(self, readers, self.causes, _TRIED)
        ]
        explaining = [reading for reading in readings if self.off(reading) <= most]
        return sorted(explaining, key=lambda reading: reading.score)

    def off(self, reading: CauseReading) -> float:
        """Return the largest residual of a reading in any run, over what is permitted there."""
        assert isinstance(reading.program, Joint)
        most = 0.0
        for run, program in zip(self.runs, reading.program.programs, strict=True):
            positions = run.case.positions(program)
            permitted_m = run.case.enough
            if program.method is not None and program.kind == "sphere":
                permitted_m += _error_of_effect_m(run.case, program, positions)
            most = max(most, largest(run.case.rows.positions - positions) / permitted_m)
        return most

    def without_steps(
        self, steps: Steps, way: str, reading: CauseReading | None = None
    ) -> tuple[JointCase, Deviation]:
        """Return the case with the effect of steps subtracted from its rows, and their cause.

        The effect of the steps of right programs is that of programs with mistakes in the first rows alone: of
        long files only these are taken then.

        Args:
            steps: of the first run.
            way: TYPED or FACTOR: how a step follows {setting}.
            reading: of the programs that take the steps; None for right programs.
        """
        program = self.right if reading is None else reading.program
        assert isinstance(program, Joint)
        runs = []
        causes = []
        for run, run_program in zip(self.runs, program.programs, strict=True):
            setting = run.setting if way == FACTOR else 1.0
            run_steps = replace(steps, steps_per_row=round(steps.steps_per_row / setting))
            case = run.case
            if reading is None:
                first_s = run_steps.step_s * FIRST_STEPS
                case = case.part(int((case.rows.times <= first_s).sum()))
            pendulum, theta = case.pendulum_of(run_program)
            times = case.rows.times
            stepped = replace(run_steps, **vars(pendulum)).rows(theta, times, 2)
            effect = stepped - pendulum.rows(theta, times, 2)
            rows = replace(case.rows, positions=case.rows.positions - effect)
            runs.append(replace(run, case=replace(case, rows=rows)))
            causes.append(step_cause(run_steps, largest(effect)))
        return JointCase.of(runs), causes[0]

    def explanation_of(self, reading: CauseReading, *besides: Deviation) -> Explanation:
        """Return the explanation of the first run by a reading, and what was subtracted before."""
        assert isinstance(reading.program, Joint)
        case = self.runs[0].case
        program = reading.program.programs[0]
        spacing = float(case.rows.times[1] - case.rows.times[0])
        causes = [
            _by_order(cause, spacing, program.method)
            for cause in (*sized(case, reading), *besides)
            if cause.size_m > case.enough
        ]
        return Explanation(
            causes=tuple(causes),
            corrected_m=largest(case.residuals(program)),
            score=reading.score,
            allowed_m=case.allowed_m,
        )


def _common_kinds(runs: Sequence[Trial]) -> list[str]:
    """Return the families that fit all runs."""
    kinds = list(runs[0].fits)
    for run in runs:
        kinds = [kind for kind in kinds if kind in run.fits]
    return kinds


def _block_diagonal(blocks: Sequence[Array]) -> Array:
    """Return the matrix with some blocks along its diagonal, and zeros elsewhere."""
    rows = sum(len(block) for block in blocks)
    columns = sum(block.shape[1] for block in blocks)
    matrix = np.zeros((rows, columns))
    row = 0
    column = 0
    for block in blocks:
        next_row = row + len(block)
        next_column = column + block.shape[1]
        matrix[row:next_row, column:next_column] = block
        row = next_row
        column = next_column
    return matrix


def _error_of_effect_m(case: FileCase, program: Program, positions: Array) -> float:
    """Return an estimate of the difference between the leading and the whole error of a step."""
    exact = case.positions(replace(program, method=None, step=0.0))
    width = float(np.hypot(*case.rows.plane.T).max()) / case.right.length
    return _WIDE * width**2 * largest(positions - exact)


def _by_order(cause: Deviation, spacing: float, method: FixedStepMethod | None) -> Deviation:
    """Return a cause; if a step does not divide the rows' spacing, only its measured order."""
    if cause.stage != "integrator" or not cause.value or method is None:
        return cause
    count = spacing / cause.value
    if abs(count - round(count)) <= _WHOLE * count:
        return cause
    way = next((way for way in (TYPED, FACTOR) if cause.text.endswith(way)), "")
    smaller = f"half the step, a {2**method.order}th of the error"
    order = f"has the error of a method of order {method.order} ({smaller})"
    text = f"{order}, such as {method.title}{way}"
    return replace(cause, id=f"integrator_order_{method.order}", text=text)


def _following(part: FollowedCause, varied: bool) -> Cause:
    """Return a cause that changes the programs of all runs.

    If the runs varied its number, its text says how it follows them.
    """

    def change(program: Program) -> Program:
        changed = part.cause.change(program)
        if not isinstance(changed, Joint):
            return changed
        return changed.changed(parts=(*changed.parts, part))

    text = part.cause.text + part.way if varied else part.cause.text
    return replace(part.cause, change=change, text=text)
