"""The explanations of several runs together: causes, and the way in which each follows the scene.

One file does not show whether a program takes g to be 9.81, or 1.0003 times what it is given, or has a fast clock. Of a
scene with another g these are different motions. So the numbers of all runs stand side by side as those of one file do,
and are read in the same way.
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
from ..stepped import LONGEST, Steps, step_cause

# how a cause follows the scene
RULE, TYPED, FACTOR = "", ", whatever it is given", ", in proportion to what it is given"
# numbers that a scene, or {setting}, gives
INPUTS = ("g", "length", "latitude", "rate", "x", "y", "vx", "vy", "step")
# times the square of the swing: what the leading error of a step leaves of the whole one
WIDE = 2.0
WHOLE = 1e-3  # of a number of steps: how far it may be from a whole one
TRIED = 30  # readings of a family that are run
EQUAL = 0.35  # decades by which a reading that makes all files may be dearer than the cheapest


@dataclass(frozen=True)
class Trial:
    """A run of a program.

    Attributes:
        problem: of the scene that it was given.
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

    @cached_property
    def causes(self) -> dict[tuple[str, str, int], Cause]:
        """The mistakes that a program of its scene may have, by family, id, and number among those of one id."""
        causes, seen = {}, defaultdict[tuple[str, str], Iterator[int]](count)
        for kind in ("sphere", *MODELS):
            for cause in causes_of(self.case, kind):
                causes[kind, cause.id, next(seen[kind, cause.id])] = cause
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
        """Return the program of a trial's scene with it; `value` is its number in the first scene."""
        # a cause that the scene does not know, such as a sign of no rotation, does nothing there
        if self.way == RULE:
            return trial.causes[self.key].change(program) if self.key in trial.causes else program
        program, free = self.cause.change(program), self.cause.free
        if self.way == FACTOR and first.given(free):
            value *= trial.given(free) / first.given(free)
        return program.changed(**{free: value}) if free else program


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
        made = []
        for trial in self.runs:
            program = trial.case.right.changed(kind=self.kind)
            for part in self.parts:
                value = getattr(self, part.cause.free) if part.cause.free else 0.0
                program = part.applied(program, value, self.runs[0], trial)
            made.append(program)
        return made

    @property
    def sensible(self) -> bool:
        """False if no program can have its inputs in one of the runs."""
        return all(program.sensible for program in self.programs)

    def theta(self) -> Array:
        """Return the numbers of all runs, those of the first before."""
        return np.concatenate([program.theta() for program in self.programs])


@dataclass(frozen=True)
class JointCase(FileCase):
    """The rows of all runs as those of one file, each in units of what may be left of it."""

    runs: tuple[Trial, ...] = ()

    @classmethod
    def of(cls, runs: Sequence[Trial]) -> JointCase:
        """Return the case of some runs."""
        first, runs = runs[0].case, tuple(runs)
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
        """Return positions of each run as those of one."""
        return np.concatenate(
            [positions * self.weight(run) for positions, run in zip(rows, self.runs, strict=True)]
        )

    def positions(self, program: Program) -> Array:
        """Return what a program writes in all runs."""
        assert isinstance(program, Joint)
        made = zip(self.runs, program.programs, strict=True)
        return self.side_by_side([run.case.positions(run_program) for run, run_program in made])

    def _fit(self, kind: str, fits: Sequence[FamilyFit]) -> FamilyFit:
        weights = [
            self.weight(run) * math.sqrt(len(run.case.rows.times) / len(self.rows.times))
            for run in self.runs
        ]
        fits = [
            replace(fit, rest=w * fit.rest, slopes=w * fit.slopes)
            for w, fit in zip(weights, fits, strict=True)
        ]
        blocks = [np.asarray(np.linalg.qr(fit.slopes, mode="r")) for fit in fits]
        slopes = np.block(
            [[a if a is b else np.zeros((len(a), b.shape[1])) for b in blocks] for a in blocks]
        )
        free = tuple(at * len(fit.theta) + i for at, fit in enumerate(fits) for i in fit.free)
        rest = math.hypot(*(fit.rest for fit in fits))
        return FamilyFit(kind, np.concatenate([fit.theta for fit in fits]), rest, free, slopes)

    def causes(self, kind: str) -> list[Cause]:
        """Return the causes of a family in every way in which the runs may distinguish them."""
        causes = []
        for key, cause in self.runs[0].causes.items():
            varied = cause.free in INPUTS and len({run.given(cause.free) for run in self.runs}) > 1
            ways = (TYPED, FACTOR)[: 1 + varied] if cause.free else (RULE, TYPED)
            causes += [
                _following(FollowedCause(key, cause, way), varied) for way in ways if key[0] == kind
            ]
        return causes

    def readings(self, most: float = 1.0) -> list[CauseReading]:
        """Return the readings of all runs that leave of each no more than may be left, `most` times; the best first."""
        kinds = [kind for kind in self.runs[0].fits if all(kind in run.fits for run in self.runs)]
        fits = [self._fit(kind, [run.fits[kind] for run in self.runs]) for kind in kinds]
        finite = [fit for fit in fits if np.isfinite(fit.slopes).all()]
        readers = [replace(reader, joint=True) for reader in readers_of(self, finite)]
        readings = [
            polished(self, reading) for reading in ranked(self, readers, self.causes, TRIED)
        ]
        return sorted(
            (reading for reading in readings if self.off(reading) <= most),
            key=lambda reading: reading.score,
        )

    def off(self, reading: CauseReading) -> float:
        """Return the most that a reading leaves of a run, over what may be left."""
        assert isinstance(reading.program, Joint)
        most = 0.0
        for run, program in zip(self.runs, reading.program.programs, strict=True):
            made, allowed = run.case.positions(program), run.case.enough
            if program.method is not None:
                # what the leading error of a step leaves of the whole one on the sphere
                effect = largest(made - run.case.positions(replace(program, method=None, step=0.0)))
                width = float(np.hypot(*run.case.rows.plane.T).max()) / run.case.right.length
                allowed += WIDE * width**2 * effect if program.kind == "sphere" else 0.0
            most = max(most, largest(run.case.rows.positions - made) / allowed)
        return most

    def without_steps(
        self, steps: Steps, way: str, reading: CauseReading | None = None
    ) -> tuple[JointCase, Deviation]:
        """Return the case with what steps do to the programs of a reading taken from the rows, and that cause."""
        program, seen, causes = self.right if reading is None else reading.program, [], []
        assert isinstance(program, Joint)
        for run, run_program in zip(self.runs, program.programs, strict=True):
            taken = replace(
                steps,
                steps_per_row=round(steps.steps_per_row / (run.setting if way == FACTOR else 1.0)),
            )
            case = run.case.part(int((run.case.rows.times <= taken.step_s * LONGEST).sum()))
            pendulum, theta = case.pendulum_of(run_program)
            moved = replace(taken, **vars(pendulum)).rows(theta, case.rows.times, 2)
            effect = moved - pendulum.rows(theta, case.rows.times, 2)
            case = replace(case, rows=replace(case.rows, positions=case.rows.positions - effect))
            seen.append(replace(run, case=case))
            causes.append(step_cause(taken, effect))
        return JointCase.of(seen), causes[0]

    def explanation_of(self, reading: CauseReading, *besides: Deviation) -> Explanation:
        """Return the explanation of the first run that a reading makes up, beside what was taken from its rows."""
        assert isinstance(reading.program, Joint)
        case = self.runs[0].case
        left_m = largest(case.left(reading.program.programs[0]))
        spacing = float(case.rows.times[1] - case.rows.times[0])
        causes = [
            _by_order(cause, spacing, reading.program.programs[0].method)
            for cause in (*sized(case, reading), *besides)
            if cause.size_m > case.enough
        ]
        return Explanation(
            causes=tuple(causes),
            corrected_m=left_m,
            score=reading.score,
            allowed_m=case.allowed_m,
        )


def _by_order(cause: Deviation, spacing: float, method: FixedStepMethod | None) -> Deviation:
    """Return a cause; of a step that does not go into the spacing of the rows only the order that was measured."""
    if cause.stage != "integrator" or not cause.value or method is None:
        return cause
    count = spacing / cause.value
    if abs(count - round(count)) <= WHOLE * count:
        return cause
    way = next((way for way in (TYPED, FACTOR) if way and cause.text.endswith(way)), "")
    less = f"half the step, a {2**method.order}th of the error"
    text = (
        f"has the error of a method of order {method.order} ({less}), such as {method.title}{way}"
    )
    return replace(cause, id=f"integrator_order_{method.order}", text=text)


def _following(part: FollowedCause, varied: bool) -> Cause:
    """Return a cause that changes the programs of all runs; its text says how, if the runs varied its number."""

    def change(program: Program) -> Program:
        changed = part.cause.change(program)
        return (
            changed.changed(parts=(*changed.parts, part)) if isinstance(changed, Joint) else changed
        )

    return replace(part.cause, change=change, text=part.cause.text + part.way * varied)
