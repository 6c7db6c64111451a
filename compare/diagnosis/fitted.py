"""Propose explanations: the readings of the families of models that fit a file, their programs run."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from ..candidates.candidate import Deviation
from .case import FileCase, NamedModel, largest, rms
from .causes import DRIFT, LOOSE, SAME_MOTIONS, Cause, causes_of
from .families import FamilyFit, fits_of
from .programs import EFFECTIVE_G, Program
from .readings import CauseReading, Reader, adjusted
from .thresholds import RIVAL

TRIED = 8  # readings of a family that are run
LIKELIEST = 3  # of which those that are the same motion are tried as well
# decades by which a family's readings may be dearer than the best of another, before they are polished
CLOSE = 0.5
# decades above the best reading within which others are polished before they are compared
NEAR = 1.0
POLISHED = 3  # steps by which fitted numbers are moved
BETTER = 0.9  # of the residual before it: a step with a larger one is not taken
# decades by which a simpler family has to be better
EXTRA = {"sphere": 0.0, "linear": 0.3, "angle": 0.6}
ORDER = ("gravity", "model", "input", "release", "frame", "clock", "integrator")
MODELS = {
    "linear": (
        "linear_g",
        "is the linear two-dimensional model: its period does not grow with the amplitude",
    ),
    "angle": (
        "linear_in_angle",
        "is linear in the angle of the cord: its period does not grow with the amplitude",
    ),
}
TITLES = {
    "linear_g": "the linear two-dimensional model",
    "linear_in_angle": "the model linear in the angle",
    "no_centrifugal": "no centrifugal force (g effective)",
    "effective_gravity": "g effective",
    "uniform_gravity": "no change of the centrifugal force along the swing",
    "no_tilt": "no horizontal centrifugal force",
    "point_mass": "gravity of a point mass",
    "sphere": "a spherical Earth",
    "mean_sphere": "a spherical Earth",
    "turned_plane": "a plane turned by hand",
    "turned_plane_sign": "a plane turned by hand, the wrong way",
}


def readings_of(case: FileCase, stepped: bool = False) -> list[CauseReading]:
    """Return the readings of all families that were run, the likeliest first; none if no family fits the rows.

    Args:
        case: the file.
        stepped: whether what steps do was taken from its rows: then no integrator is among the causes.
    """
    fits = list(fits_of(case))

    def catalogue(kind: str) -> list[Cause]:
        every = causes_of(case, kind)
        return [cause for cause in every if not stepped or cause.stage != "integrator"]

    run = ranked(case, readers_of(case, fits), catalogue)
    if not run:
        return []
    # a search ends at its floor, the tolerance; it is repeated with a lower one if residuals may become smaller
    least = min(fit.residual_rms_m for fit in fits)
    finest = max(case.resolution, least)
    if min(reading.residual_rms_m for reading in run) > RIVAL * finest:
        run += ranked(case, readers_of(case, fits, finest), catalogue)
    for reading in run[:LIKELIEST]:
        run += same_motions(case, reading, catalogue(reading.program.kind))
    return run


def same_motions(
    case: FileCase, reading: CauseReading, catalogue: Sequence[Cause]
) -> Iterator[CauseReading]:
    """Yield readings with other causes in place of some, which are the same motion in principle, or nearly.

    In each of these, further causes may have others in their place.
    """
    seen = {_cause_ids(reading)}
    waiting = [reading]
    while waiting:
        known = waiting.pop()
        cause_ids = _cause_ids(known)
        for before, after in SAME_MOTIONS:
            exchanged_ids = (cause_ids - before) | after
            if not before <= cause_ids or exchanged_ids in seen:
                continue
            other = _exchanged(known, before, after, catalogue)
            if other is None:
                continue
            seen.add(exchanged_ids)
            # one that is farther from the rows than the truth is not the same motion
            if other.residual_rms_m < case.error:
                other = polished(case, other)
                waiting.append(other)
                yield other


def _cause_ids(reading: CauseReading) -> frozenset[str]:
    """Return the ids of the causes of a reading."""
    return frozenset(cause.id for cause in reading.causes)


def _exchanged(
    reading: CauseReading,
    before: frozenset[str],
    after: frozenset[str],
    catalogue: Sequence[Cause],
) -> CauseReading | None:
    """Return a reading with causes of some ids in place of others; None if no program can have them."""
    dropped = [cause for cause in reading.causes if cause.id in before - after]
    kept = reading.reader.without(reading, dropped)
    missing = after - _cause_ids(reading)
    # several causes may have one id
    forms = [[cause for cause in catalogue if cause.id == cause_id] for cause_id in sorted(missing)]
    others = [_with_causes(kept, causes) for causes in itertools.product(*forms)]
    possible = [other for other in others if other is not None]
    return min(possible, key=lambda other: other.residual_rms_m, default=None)


def _with_causes(reading: CauseReading, causes: Sequence[Cause]) -> CauseReading | None:
    """Return a reading with more causes; None if no program can have them."""
    other: CauseReading | None = reading
    for cause in causes:
        if other is None or cause.group in {part.group for part in other.causes}:
            return None
        other = other.reader.with_cause(other, cause)
    return other


def _price(reading: CauseReading) -> float:
    """Return the score of a reading in decades, with what a simpler family costs: less is better."""
    return reading.score + EXTRA[reading.reader.right.kind]


def readers_of(
    case: FileCase, fits: Sequence[FamilyFit], floor: float | None = None
) -> list[Reader]:
    """Return what reads a case, for each family that fits it about as well as the best.

    Args:
        case: the file.
        fits: of the families.
        floor: as in `Reader`; None for the tolerance's, or that of the fits.
    """
    least = min((fit.residual_rms_m for fit in fits), default=math.inf)
    floor = floor or max(case.floor, 1.2 * least)
    near = [fit for fit in fits if not fit.residual_rms_m > 3 * max(least, floor / 1.2)]
    return [Reader(replace(case.right, kind=fit.kind), fit, floor, least) for fit in near]


def ranked(
    case: FileCase,
    readers: Sequence[Reader],
    causes_of: Callable[[str], Sequence[Cause]],
    tried: int = TRIED,
) -> list[CauseReading]:
    """Return the likeliest readings of a case, their programs run and the near ones polished, the best first.

    Args:
        case: the file.
        readers: of the families that it may be of.
        causes_of: the causes that a family may have.
        tried: number of readings of a family that are run.
    """
    run: list[CauseReading] = []
    for reader in sorted(readers, key=lambda reader: reader.fit.residual_rms_m):
        least = min(map(_price, run), default=math.inf)
        most = least - EXTRA[reader.right.kind] + CLOSE
        likely = reader.readings(causes_of(reader.right.kind), most)
        likely = [reading for reading in likely if _is_determined(case, reading)][:tried]
        for reading in likely[:2]:
            likely += [reader.without(reading, [cause]) for cause in reading.causes]
        # the distance from the fit is linear in theta: what counts is the program itself
        for reading in likely:
            residual_m = rms(case.residuals(reading.program))
            if math.isfinite(residual_m):
                run.append(reader.scored(reading.causes, reading.program, residual_m))
    if not run:
        return []
    near = min(map(_price, run)) + NEAR
    run = [polished(case, reading) if _price(reading) <= near else reading for reading in run]
    return sorted(run, key=_price)


def _is_determined(case: FileCase, reading: CauseReading) -> bool:
    """Return whether the rows have more numbers than are fitted: as many make any rows."""
    fitted = sum(bool(cause.free) for cause in reading.causes)
    return fitted < case.rows.plane[int(case.released) :].size


def polished(case: FileCase, reading: CauseReading) -> CauseReading:
    """Return the best reading with its fitted numbers moved to where the residual of its program, run, is least.

    The numbers of a reading are linear in those of the fit, which a number that is far off is not.
    """
    names = [cause.free for cause in reading.causes if cause.free]
    if not names:
        return reading
    goal = case.rows.positions
    program, size = adjusted(
        reading.program, names, case.positions, goal, steps=POLISHED, gain=BETTER
    )
    if program == reading.program:
        return reading
    return reading.reader.scored(reading.causes, program, size / math.sqrt(len(goal)))


def adjusted_to(case: FileCase, program: Program, names: Sequence[str]) -> Program:
    """Return a program with some of its numbers moved to where its residual in the rows of a case is least."""
    goal = case.rows.positions
    made, _ = adjusted(program, names, case.positions, goal, steps=POLISHED, gain=BETTER)
    return made


def sentences(case: FileCase, reading: CauseReading) -> Iterator[tuple[str, str]]:
    """Yield the id and the sentence of each cause of a reading, and of its model."""
    if reading.program.kind != "sphere":
        yield MODELS[reading.program.kind]
    for cause in reading.causes:
        text = cause.text
        if cause.free:
            uncertainty = reading.reader.uncertainty(reading, cause, case.resolution)
            text = cause.sentence(reading.value(cause), uncertainty, case.right)
        if text:  # which a second number of one cause does not have
            yield cause.id, text


def sized(case: FileCase, reading: CauseReading) -> Iterator[Deviation]:
    """Yield the causes in their order, each with the distance by which it moves the bob."""
    parts: list[_Part] = [_CausePart(cause) for cause in reading.causes if cause not in DRIFT]
    if reading.program.kind != "sphere":
        parts.append(_ModelPart(reading.program.kind))
    program = case.right
    before = case.truth
    for part in sorted(parts, key=lambda part: ORDER.index(part.stage)):
        program = part.applied(program, reading)
        after = case.positions(program)
        yield part.deviation(case, reading, largest(after - before))
        before = after
    if DRIFT[0] in reading.causes:
        size_m = largest(case.positions(reading.program) - before)
        yield Deviation(DRIFT[0].id, LOOSE, size_m, "integrator")


@dataclass(frozen=True)
class _ModelPart:
    """The model of a reading, as one of the things that it says.

    Attributes:
        kind: of its program.
    """

    kind: str
    stage = "model"

    def applied(self, program: Program, reading: CauseReading) -> Program:
        """Return a program of this model."""
        return replace(program, kind=self.kind)

    def deviation(self, case: FileCase, reading: CauseReading, size_m: float) -> Deviation:
        """Return it as a finding; it moves the bob by a size in m."""
        model_id, text = MODELS[self.kind]
        return Deviation(model_id, text, size_m, self.stage)


@dataclass(frozen=True)
class _CausePart:
    """A cause of a reading, as one of the things that it says."""

    cause: Cause

    @property
    def stage(self) -> str:
        """Its stage."""
        return self.cause.stage

    def applied(self, program: Program, reading: CauseReading) -> Program:
        """Return a program with the cause, and the number that it has in the reading."""
        changed = self.cause.change(program)
        if not self.cause.free:
            return changed
        return changed.changed(**{self.cause.free: reading.value(self.cause)})

    def deviation(self, case: FileCase, reading: CauseReading, size_m: float) -> Deviation:
        """Return it as a finding; beside the causes before it, it moves the bob by a size in m."""
        cause = self.cause
        if size_m <= case.enough:
            # another cause, put right before it, may have made it small
            without = reading.reader.without(reading, [cause]).program
            size_m = largest(case.positions(reading.program) - case.positions(without))
        if not cause.free:
            return Deviation(cause.id, cause.text, size_m, cause.stage)
        value = reading.value(cause)
        shift = value - float(getattr(case.right, cause.free))
        uncertainty = reading.reader.uncertainty(reading, cause, case.resolution)
        text = cause.sentence(value, uncertainty, case.right)
        return Deviation(cause.id, text, size_m, cause.stage, value, shift, uncertainty)


_Part = _ModelPart | _CausePart


def model_of(
    kind: str, right: Program, causes: Sequence[Deviation], exact: float, costs: float
) -> NamedModel | None:
    """Return the model that causes make up; None if one of them is no simplification with a name."""
    cause_ids = [cause.id for cause in causes]
    if kind != "sphere":
        model, _ = MODELS[kind]
        others = [cause_id for cause_id in cause_ids if cause_id != model]
        cause_ids = [model, *others]
    if not cause_ids or any(cause_id not in TITLES for cause_id in cause_ids):
        return None
    titles = dict(TITLES)
    if right.suspension == EFFECTIVE_G:
        titles["no_centrifugal"] = TITLES["uniform_gravity"]
    text = ", ".join(titles[cause_id] for cause_id in cause_ids)
    return NamedModel("+".join(cause_ids), text, exact, costs)
