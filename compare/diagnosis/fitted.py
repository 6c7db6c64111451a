"""Compare the families of models that fit a file, run the readings of each, and name the causes of the best one."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..candidates.candidate import Deviation
from .case import AS_IF, EQUAL, HARMLESS, Explanation, FileCase, NamedModel, largest, rms
from .causes import Cause, causes_of
from .families import FamilyFit, fits_of
from .gate import (
    CLEAN,
    Evidence,
    divides,
    hedged,
    is_typed,
    loose,
    supported_causes,
    without_doubtful_steps,
)
from .programs import NAMES, Program
from .readings import CauseReading, Reader, adjusted

TRIED = 6  # readings of a family that are run
# decades by which a family's readings may be dearer than the best of another, before they are polished
CLOSE = 0.5
# decades above the best reading within which others are polished before they are compared
NEAR = 1.0
RIVAL = 3.0  # times what a reading leaves: another that leaves no more may be meant
POLISHED = 3  # steps by which fitted numbers are moved
# decades: readings that may as well be true, and are distinguished by what they leave below the tolerance
TIE = 0.2
EXACT = 3.0  # times what fit and rounding leave, for a reading that leaves no more than they do
BETTER = 0.9  # of what was left, for a step that is taken
# decades by which a simpler family has to be better
EXTRA = {"sphere": 0.0, "linear": 0.3, "angle": 0.6}
NAMED_SHARE = 0.03  # of the error that may be left if causes are to be named
FITTED_SHARE = 0.01  # and if one of them is a fitted number
ORDER = ("gravity", "model", "input", "release", "frame", "clock", "integrator")
# times the square of the swing: what the leading error of a step leaves of the whole one
WIDE = 2.0
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
    "linear_g": "the linear two-dimensional model", "linear_in_angle": "the model linear in the angle",
    "no_centrifugal": "no centrifugal force (g effective)", "effective_gravity": "g effective",
    "uniform_gravity": "no change of the centrifugal force along the swing",
    "no_tilt": "no horizontal centrifugal force", "point_mass": "gravity of a point mass",
    "sphere": "a spherical Earth", "mean_sphere": "a spherical Earth",
    "turned_plane": "a plane turned by hand", "turned_plane_sign": "a plane turned by hand, the wrong way",
}  # fmt: skip


def best_of(case: FileCase, stepped: bool = False) -> CauseReading | None:
    """Return the best reading of all families; None if it leaves too much for anything to be named.

    Args:
        case: the file.
        stepped: whether what steps do was taken from its rows: then no integrator is among the causes, and of what is
            left the steps decide.
    """
    fits = list(fits_of(case))
    noise = 1.5 * case.rows.noise
    least = min((fit.rest for fit in fits), default=math.inf)
    if not stepped and least > max(NAMED_SHARE * case.error, noise):
        return None

    def causes(kind: str) -> list[Cause]:
        return [
            cause for cause in causes_of(case, kind) if not stepped or cause.stage != "integrator"
        ]

    run = ranked(case, readers_of(case, fits), causes)
    finest = max(case.resolution, 1.2 * least)
    if not stepped and run and _is_tied(case, run):
        exact = ranked(case, readers_of(case, fits, finest), causes)
        run = next(
            (readings for readings in (exact, run) if readings[0].rest <= EXACT * finest), []
        )
    best = run[0] if run else None
    if best is None or stepped:
        return best
    # a family fits any such rows: what leaves much of them says nothing
    if case.rows.plane.size <= len(NAMES):
        return best if best.rest <= case.enough else None
    # 9.81, 9.80665 and so on
    many_values = any(cause.free or cause.group == "g" for cause in best.causes)
    share = FITTED_SHARE if many_values else NAMED_SHARE
    return best if best.rest <= max(share * case.error, noise) else None


def _price(reading: CauseReading) -> float:
    """Return the score of a reading in decades, with what a simpler family costs: less is better."""
    return reading.score + EXTRA[reading.reader.right.kind]


def _is_tied(case: FileCase, run: Sequence[CauseReading]) -> bool:
    """Return whether a reading of another motion, with nothing in common with the best one, is about as likely."""
    best = run[0]
    groups = {cause.group for cause in best.causes}
    likely = [
        reading for reading in run[1:] if reading.causes and _price(reading) < _price(best) + TIE
    ]
    rivals = [
        reading for reading in likely if groups.isdisjoint(cause.group for cause in reading.causes)
    ]
    return any(not _is_same_motion(case, reading, best) for reading in rivals)


def _is_same_motion(case: FileCase, reading: CauseReading, other: CauseReading) -> bool:
    """Return whether two readings move alike, as no rotation and neither of its two forces do."""
    return rms(case.positions(reading.program) - case.positions(other.program)) <= case.resolution


def _first_of_equals(
    case: FileCase, run: list[CauseReading], places: dict[int, int]
) -> CauseReading:
    """Return the best reading; of those that are as good, the surest, and then the first of the catalogue.

    Args:
        case: the file.
        run: the readings, at least one.
        places: of each cause in the catalogue, by its identity.
    """
    least = min(map(_price, run))
    equals = [reading for reading in run if _price(reading) <= least + math.log10(EQUAL)]
    kinds = list(EXTRA)

    def order(reading: CauseReading) -> tuple[int, int, list[int]]:
        in_catalogue = sorted(places[id(cause)] for cause in reading.causes)
        return unsure_causes(case, reading), kinds.index(reading.reader.right.kind), in_catalogue

    return min(equals, key=order)


def unsure_causes(case: FileCase, reading: CauseReading) -> int:
    """Return how many numbers of a reading nobody typed, and steps that do not clearly divide the spacing of rows."""
    spacing = float(np.ptp(case.rows.times[:2]))
    clean = clean_share(case, reading.reader.right.kind)
    unsure = 0
    for cause in reading.causes:
        if not cause.free:
            continue
        value = reading.value(cause)
        if cause.stage == "integrator":
            unsure += not divides(value, spacing, clean)
            continue
        shift = value - float(getattr(case.right, cause.free))
        uncertainty = reading.reader.uncertainty(reading, cause, case.resolution)
        unsure += not is_typed(
            Deviation(cause.id, cause.text, 0.0, cause.stage, value, shift, uncertainty)
        )
    return unsure


def readers_of(
    case: FileCase, fits: Sequence[FamilyFit], floor: float | None = None
) -> list[Reader]:
    """Return what reads a case, for each family that fits it about as well as the best.

    Args:
        case: the file.
        fits: of the families.
        floor: as in `Reader`; None for the tolerance's, or that of the fits.
    """
    least = min((fit.rest for fit in fits), default=math.inf)
    floor = floor or max(case.floor, 1.2 * least)
    near = [fit for fit in fits if not fit.rest > 3 * max(least, floor / 1.2)]
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
    places: dict[int, int] = {}
    numbers = case.rows.plane[int(case.released) :].size  # as many that are fitted make any rows
    for reader in sorted(readers, key=lambda reader: reader.fit.rest):
        causes = causes_of(reader.right.kind)
        places |= {id(cause): len(places) + n for n, cause in enumerate(causes)}
        least = min(map(_price, run), default=math.inf)
        most = least - EXTRA[reader.right.kind] + CLOSE
        likely = reader.readings(causes, most)
        likely = [
            reading
            for reading in likely
            if sum(bool(cause.free) for cause in reading.causes) < numbers
        ][:tried]
        likely += [
            reader.without(reading, [cause]) for reading in likely[:2] for cause in reading.causes
        ]
        # the distance from the fit is linear in theta: what counts is the program itself
        for reading in likely:
            leaves = rms(case.left(reading.program))
            if math.isfinite(leaves):
                run.append(reader.scored(reading.causes, reading.program, leaves))
    if not run:
        return []
    near = min(map(_price, run)) + NEAR
    run = [polished(case, reading) if _price(reading) <= near else reading for reading in run]
    best = _first_of_equals(case, run, places)
    return [best, *sorted((reading for reading in run if reading is not best), key=_price)]


def polished(case: FileCase, reading: CauseReading) -> CauseReading:
    """Return the best reading with its fitted numbers moved to where its program, run, leaves least.

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


def explanation_of(
    case: FileCase, reading: CauseReading, step: Deviation | None = None
) -> Explanation:
    """Return the explanation that the best reading of a case makes up, and a step that was taken from its rows."""
    rows, reader = case.rows, reading.reader
    kind, reading = reader.right.kind, _without_needless(case, reading)
    left = case.left(reading.program)
    corrected = largest(left)
    spacing, enough = float(np.ptp(rows.times[:2])), max(case.allowed_m, 2 * rows.noise)
    shown = ("release.x", "release.y") if rows.starts and rows.times[0] == 0 else ()
    evidence = Evidence(
        corrected, case.allowed_m, enough, spacing, case.frequency, clean_share(case, kind), shown
    )
    read = [*sized(case, reading), *([] if step is None else [step])]
    causes = list(supported_causes(read, evidence))
    program = _with(reading, causes)
    if program != reading.program:  # a cause that is not reported is not put right
        left = case.left(program)
        corrected = largest(left)
        causes = without_doubtful_steps(causes, corrected, enough)
    if any(cause.stage == AS_IF for cause in causes) and _may_be_a_clock(case, program):
        rates = {cause.id for cause in reading.causes if cause.group == "rate"}
        causes = [hedged(cause) if cause.id in rates else cause for cause in causes]
    more = evidence.left_m > case.allowed_m and reading.rest > 2 * max(rows.noise, reader.fit.rest)
    if more and reader.drifts(case, reading.program):
        causes.append(loose(corrected))
    model = None
    simple = {cause.stage for cause in causes} <= {"gravity", "model"}
    if (
        simple
        and corrected <= case.allowed_m
        and all(convention.id in HARMLESS for convention in rows.conventions)
    ):
        model = _model_of(kind, case.right, causes, corrected, largest(rows.positions - case.truth))
    price = sum(cause.cost for cause in reading.causes)
    explanation = case.tested(tuple(causes), left, price)
    return replace(explanation, model=model) if explanation.causes else explanation


def _may_be_a_clock(case: FileCase, program: Program) -> bool:
    """Return whether a clock of another pace explains the rows as well, with the scene's own g, length and rate.

    A clock that runs fast by a factor k makes g look smaller by k² and the rotation slower by k.
    """
    right = case.right
    pull = program.g / program.length
    if not right.rate or pull * right.g <= 0 or program.rate == right.rate:
        return False
    pace = math.sqrt(pull * right.length / right.g)
    clock = program.changed(
        g=right.g, length=right.length, rate=right.rate, pace=pace * program.pace
    )
    return rms(case.left(clock)) <= RIVAL * max(rms(case.left(program)), case.floor)


def clean_share(case: FileCase, kind: str) -> float:
    """Return the share of what an integrator does that its leading error may leave."""
    width = (
        float(np.hypot(*case.rows.plane.T).max()) / case.right.length if kind == "sphere" else 0.0
    )
    return max(CLEAN, WIDE * width**2, WIDE * CLEAN if width else 0.0)


def _with(reading: CauseReading, reported: Sequence[Deviation]) -> Program:
    """Return the program that has, of the causes of a reading, those that are reported."""
    words = {cause.id.removeprefix(f"{AS_IF}.") for cause in reported}
    drift = (
        {"site.gravity", "pendulum.length", "pendulum.drag"}
        if "integrator_loose" in words
        else set()
    )
    kept = [
        cause
        for cause in reading.causes
        if cause.id in words | drift or cause.stage == "integrator"
    ]
    if len(kept) == len(reading.causes):
        return reading.program
    return reading.reader.without(
        reading, [cause for cause in reading.causes if cause not in kept]
    ).program


def _without_needless(case: FileCase, reading: CauseReading) -> CauseReading:
    """Return a reading without the causes without which what is left is within the tolerance as well."""
    while reading.causes:
        fewer = [reading.reader.without(reading, [cause]) for cause in reading.causes]
        left = {largest(case.left(shorter.program)): shorter for shorter in fewer}
        least = min(filter(math.isfinite, left), default=math.inf)
        if least > case.allowed_m:
            break
        reading = replace(left[least], rest=rms(case.left(left[least].program)))
    return reading


def sized(case: FileCase, reading: CauseReading) -> Iterator[Deviation]:
    """Yield the causes in their order, each with the distance by which it moves the bob."""
    kind = reading.reader.right.kind
    changes = [(cause.stage, cause) for cause in reading.causes] + [("model", None)] * (
        kind != "sphere"
    )
    program, before = case.right, case.truth
    for stage, cause in sorted(changes, key=lambda change: ORDER.index(change[0])):
        value = shift = uncertainty = None
        if cause is None:
            (word, text), program = MODELS[kind], replace(program, kind=kind)
        else:
            word, text, program = cause.id, cause.text, cause.change(program)
            if cause.free:
                value = reading.value(cause)
                program = program.changed(**{cause.free: value})
                shift = value - float(getattr(case.right, cause.free))
                uncertainty = reading.reader.uncertainty(reading, cause, case.resolution)
                text = cause.sentence(value, uncertainty, case.right)
        after = case.positions(program)
        size = largest(after - before)
        # another cause, put right before it, may have made it small
        if cause is not None and size <= case.enough:
            without = reading.reader.without(reading, [cause]).program
            size = largest(case.positions(reading.program) - case.positions(without))
        yield Deviation(word, text, size, stage, value, shift, uncertainty)
        before = after


def _model_of(
    kind: str, right: Program, causes: Sequence[Deviation], exact: float, costs: float
) -> NamedModel | None:
    """Return the model that causes make up; None if one of them is no simplification with a name."""
    words = [cause.id for cause in causes]
    if kind != "sphere":
        words = [MODELS[kind][0], *(word for word in words if word != MODELS[kind][0])]
    if not words or any(word not in TITLES for word in words):
        return None
    titles = (
        TITLES
        if right.gravity_reading != "effective"
        else TITLES | {"no_centrifugal": TITLES["uniform_gravity"]}
    )
    return NamedModel("+".join(words), ", ".join(titles[word] for word in words), exact, costs)
