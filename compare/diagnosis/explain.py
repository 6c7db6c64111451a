"""Explain a disagreement: conventions, then the family of models, then the causes that its numbers show."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace

import numpy as np

from reference import FoucaultError, Scene
from reference.engines.trajectory import Variants
from reference.model.constants import constants_in_double
from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from .approximated import of_approximation
from .case import AS_IF, WITHOUT_HEIGHTS, Explanation, FileCase, FileRows
from .claims import (
    by_growth,
    either_of,
    explanation_of,
    hedged,
    likelier,
    likelier_step,
    no_explanation,
    or_mirrored,
)
from .conventions import (
    ROUGHLY,
    axes,
    clock,
    digits,
    heights,
    other_conventions,
    rounded_clock,
    shifted,
    unit_of_time,
    wrong_heights,
)
from .fitted import polished, readings_of
from .formulas import of_formula
from .hypotheses import Claim
from .observed import of_evident_columns, of_observation
from .programs import Program, SphericalPendulum
from .runaways import falls, growth
from .slips import of_slip
from .stepped import of_loops, of_steps
from .thresholds import NEEDED, RIVAL

RENAMED = frozenset(("xy_swapped", "x_west", "y_south", "xy_reversed", "axes_turned"))
SHIFTS = frozenset(("rows_late", "rows_early"))
# Conventions that are no facts of the printed numbers: the residual without them decides. A unit of time is not among
# them: without it the swing would be 60 times as fast as the scene's, or as slow.
QUESTIONED = RENAMED | {
    "unit_of_length",
    "angles",
    "clock_offset",
    "rows_reversed",
    *SHIFTS,
}
FAST = 20.0  # times faster than the scene: nothing is run
LEFT_OUT = ("z_constant", *WITHOUT_HEIGHTS)  # heights that no explanation is asked for
MOST_ROWS = 20_000  # that are looked at: the first half of them, and as many evenly spaced
ROWS = 500  # rows that are used at most: half evenly spaced, half at the beginning
ROWS_A_SWING = 20  # that show what an integrator does
MAPPED = 4000  # rows of which all are compared with maps of columns
SIMPLE = 2  # price of a map of columns beside which no steps are tried


def explain(times: Array, columns: dict[str, Array], scene: Scene, allowed_m: float) -> Explanation:
    """Return what is known of the reasons for an error; empty where nothing is.

    Args:
        times: of the rows, in s.
        columns: x, y and perhaps z in m.
        scene: in the reading that the file was scored in.
        allowed_m: distance in m that counts as agreement.
    """
    if len(times) > MOST_ROWS:
        half = MOST_ROWS // 2
        first = np.arange(half)
        even = np.linspace(half, len(times) - 1, half).astype(np.int64)
        chosen = np.concatenate([first, even])
        times = times[chosen]
        columns = {name: column[chosen] for name, column in columns.items()}
    try:
        with np.errstate(all="ignore"):
            problem = KnownScene.of(scene)
            found = _explained(_File(times, columns, problem, allowed_m))
            next_step = _next_step(times, problem.frequency)
            return replace(found, reading=None, next_step=next_step)
    except (FoucaultError, ArithmeticError, np.linalg.LinAlgError):
        # no program solves such a scene, or fits it
        return Explanation()


def _next_step(times: Array, frequency: float) -> str:
    """Return what to do where no cause is known."""
    most_s = 2 * math.pi / frequency / ROWS_A_SWING if frequency else math.inf
    # of rows that are nearly as dense, others would show little more
    if len(times) > 1 and float(np.median(np.diff(times))) >= 2 * most_s:
        return f"print at least {ROWS_A_SWING} rows a swing, one every {most_s:.2g} s, and score them again."
    return "let `--run 'PROGRAM {x0} {y0} … {setting}' --experiments` run your program with other numbers and steps."


@dataclass(frozen=True)
class KnownScene:
    """A scene as the explanation of a file wants it.

    Attributes:
        scene: in the reading that the file was scored in.
        model: runs it.
        start: x, y, z, vx, vy, vz at the release in m and m/s.
        right: what a right program computes with.
    """

    scene: Scene
    model: Variants
    start: Array
    right: Program

    @classmethod
    def of(cls, scene: Scene) -> KnownScene:
        """Return the problem of a scene."""
        model = Variants()
        start = model.states(scene.exact, np.zeros(1))[0]
        return cls(scene, model, start, Program.of(scene.exact, start))

    @property
    def frequency(self) -> float:
        """The frequency of its swing in rad/s."""
        return math.sqrt(abs(self.right.theta()[5]))

    def printed(self, times: Array, columns: dict[str, Array]) -> FileRows:
        """Return the rows of a file as they are printed."""
        positions = np.column_stack([columns[name] for name in "xyz" if name in columns])
        return digits(FileRows(times, positions, 0.0, 0.0))

    def rows(
        self, times: Array, columns: dict[str, Array], without: Collection[str] = ()
    ) -> FileRows:
        """Return the rows of a file in the scene's conventions.

        Args:
            times: as in the file.
            columns: x, y and perhaps z as in the file.
            without: ids of conventions that the file is taken not to have.
        """
        printed = self.printed(times, columns)
        rows = heights(printed, self.right.length)
        if {"unit_of_length", "angles"}.isdisjoint(without):
            rename = RENAMED.isdisjoint(without)
            rows = axes(rows, printed, self.start, self.right.length, rename)
        if {"rows_reversed", "clock_offset"}.isdisjoint(without):
            rows = clock(rows, self.start)
        if "unit_of_time" not in without:
            rows = unit_of_time(rows, self.frequency, self.right.length)
        rows = rounded_clock(rows, self.frequency)
        if rows.starts or not SHIFTS.isdisjoint(without):
            return rows
        in_order = "rows_reversed" in without
        return shifted(rows, self.start, self.frequency, self.right.length, in_order, self.states)

    def states(self, times: Array) -> Array:
        """Return x, y, z, vx, vy, vz of a right program at times in s from the release on."""
        since_release = times if times[0] == 0 else np.concatenate([[0.0], times])
        return self.model.states(self.scene.exact, since_release)[-len(times) :]

    def case(self, rows: FileRows, allowed_m: float, most: int = 0) -> FileCase:
        """Return what is to be explained of rows, of which some are taken if they are more than `most`."""
        count = len(rows.times)
        chosen = np.arange(count) if count <= most else _sample(count)
        rows = replace(rows, times=rows.times[chosen], positions=rows.positions[chosen])
        times = rows.times
        truth = self.states(times)[:, : rows.positions.shape[1]]
        right = self.right
        fastest = FAST * (self.frequency + abs(right.rate))
        pendulum = SphericalPendulum(self.model, right.radius, right.gradient_square, fastest)
        intervals = 0
        if times[0] == 0 < times[-1]:
            intervals = round(float(times[-1] / times[1]))
        return FileCase(rows, truth, right, pendulum, self.frequency, allowed_m, intervals)


@dataclass(frozen=True)
class _File:
    """A file as it is printed, and what it should show.

    Attributes:
        times: in s.
        columns: x, y and perhaps z.
        problem: the scene.
        allowed_m: distance in m that counts as agreement.
    """

    times: Array
    columns: dict[str, Array]
    problem: KnownScene
    allowed_m: float

    def rows(self, without: Collection[str] = ()) -> FileRows:
        """Return the rows in the scene's conventions, without those that the file is taken not to have."""
        return self.problem.rows(self.times, self.columns, without)

    def case(self, rows: FileRows, most: int = 0) -> FileCase:
        """Return what is to be explained of rows."""
        return self.problem.case(rows, self.allowed_m, most)

    def explained(self, rows: FileRows) -> Explanation:
        """Return the first good explanation of rows."""
        return first_good_explanation(self.case(rows), self.problem.scene)

    def growth_for(self, rows: FileRows, explanation: Explanation) -> float:
        """Return the factor by which the residual of an explanation grows for other rows, its numbers fitted again."""
        case = self.case(rows)
        residuals = case.rows.positions - case.truth
        if explanation.reading is not None:
            residuals = case.residuals(polished(case, explanation.reading).program)
        return Claim(case, residuals).residual_rms_m / explanation.residual_rms_m


def _explained(file: _File, without: frozenset[str] = frozenset()) -> Explanation:
    """Return the explanation of a file, without conventions that it is taken not to have."""
    rows = file.rows(without)
    by_columns = _explained_by_columns(file, rows)
    if by_columns is not None:
        return by_columns
    best, rows = _with_best_conventions(file, rows)

    # the clock is off by whole rows and by a part of one: if the part is not certain, neither is the sum
    is_doubtful_shift = any(cause.id == f"{AS_IF}.late" for cause in best.causes)
    conventions = []
    doubtful = []
    for convention in best.conventions:
        finding: Deviation | None = convention
        if convention.id in QUESTIONED:
            rows_without = file.rows(without | {convention.id})
            finding = by_growth(convention, file.growth_for(rows_without, best))
        if finding is None and convention.id not in without:
            return _explained(file, without | {convention.id})
        if finding is not None and convention.id in SHIFTS and is_doubtful_shift:
            finding = hedged(finding)
        if finding is convention:
            conventions.append(convention)
        elif finding is not None:
            doubtful.append(finding)
    if best.explains and not best.causes:
        conventions = list(map(wrong_heights, conventions))
    causes = [or_mirrored(cause, file.problem.start) for cause in best.causes]
    best = replace(best, conventions=tuple(conventions), causes=(*causes, *doubtful))
    return _with_slip(file, rows, best)


def _explained_by_columns(file: _File, rows: FileRows) -> Explanation | None:
    """Return the explanation by columns of a right program that are printed otherwise, or by a likelier program.

    None if there are none such.
    """
    case = file.case(rows)
    heights_left_out = any(part.id in LEFT_OUT for part in rows.conventions)
    if not case.needs_cause and not heights_left_out:
        return None
    printed = file.case(file.problem.printed(file.times, file.columns), MAPPED)
    observed = of_observation(printed)
    if observed is None:
        return _explained_by_evident_columns(printed, case)
    if observed.price > SIMPLE:
        return likelier(observed, first_good_explanation(case, file.problem.scene))
    likeliest = observed
    for one in (rows, *_with_names_as_printed(file, rows)):
        case = file.case(one)
        program, _ = explanation_of(case, readings_of(case))
        likeliest = likelier(likeliest, program)
    return likeliest


def _with_names_as_printed(file: _File, rows: FileRows) -> Iterator[FileRows]:
    """Yield the rows with their columns named as they are printed, if they are renamed: the release may be at fault.

    Half a swing after the right release the bob is where a mirrored one is.
    """
    if RENAMED.isdisjoint(convention.id for convention in rows.conventions):
        return
    as_printed = file.rows(RENAMED)
    yield as_printed
    if not SHIFTS.isdisjoint(convention.id for convention in as_printed.conventions):
        yield file.rows(RENAMED | SHIFTS)


def _explained_by_evident_columns(printed: FileCase, case: FileCase) -> Explanation | None:
    """Return the explanation by columns that are constants or copies in the file itself, unless a program explains it.

    None if there are none such.
    """
    observed = of_evident_columns(printed)
    if observed is None:
        return None
    named, _ = explanation_of(case, readings_of(case))
    return None if named.explains else observed


def _with_best_conventions(file: _File, rows: FileRows) -> tuple[Explanation, FileRows]:
    """Return the best explanation of a file, and its rows in the conventions that it has."""
    best = file.explained(rows)
    alternatives: list[FileRows] = []
    if best.corrected_m > file.allowed_m:
        alternatives += other_conventions(rows, file.problem.start)
    alternatives += _with_names_as_printed(file, rows)
    for alternative in alternatives:
        explanation = file.explained(alternative)
        agrees = explanation.corrected_m <= file.allowed_m
        leaves_more = explanation.residual_rms_m >= NEEDED * best.residual_rms_m
        if not agrees or leaves_more:
            continue
        mirrored = any(map(_is_mirrored, explanation.causes))
        leaves_less = NEEDED * explanation.residual_rms_m < best.residual_rms_m
        if mirrored and _is_one_motion(explanation, best):
            best = either_of(explanation, best)
        elif leaves_less or (explanation.score < best.score and not mirrored):
            best = explanation
            rows = alternative
    return best, rows


def _is_one_motion(mirrored: Explanation, other: Explanation) -> bool:
    """Return whether a mirrored release is the same motion as a mirrored axis and a force of the wrong sign.

    Each is two changes.
    """
    turned = {"hemisphere", "coriolis_sign"} & {cause.id for cause in other.known}
    as_good = mirrored.residual_rms_m < RIVAL * other.residual_rms_m
    prices = [one.price + len(one.conventions) for one in (mirrored, other)]
    return bool(turned) and as_good and prices[0] <= prices[1]


def _with_slip(file: _File, rows: FileRows, best: Explanation) -> Explanation:
    """Return an explanation with the slip that explains its residual, or with what else the rows show."""
    simple = {cause.stage for cause in best.known} <= {"gravity", "model"}
    unknown = simple and not best.explains
    is_loose = any(cause.id.endswith("integrator_loose") for cause in best.causes)
    if best.slip or not (unknown or is_loose):
        return best
    # one term of a formula, as no integrator changes it
    constants = constants_in_double(file.problem.scene.exact)
    slipped = of_slip(file.case(rows), rows, constants, best.residual_rms_m)
    if slipped is not None:
        return replace(slipped, conventions=best.conventions)
    if best.known:
        return best
    return replace(best, slip=falls(rows, file.problem.right) or growth(rows))


def first_good_explanation(case: FileCase, scene: Scene) -> Explanation:
    """Return the first explanation that is good enough, in the order in which one would believe them."""
    if not case.needs_cause:
        return no_explanation(case)
    named, best = explanation_of(case, readings_of(case))
    if best is None or not named.causes:
        other = of_steps(case, None) or of_formula(case) or of_approximation(case, scene)
        return other or named
    program = best.reading.program
    # on the sphere what a step does is known roughly; to know it better, the step is taken
    # and in a linear model it is known exactly, if it is a method that has a name
    roughly = program.method is not None and (program.kind == "sphere" or not best.is_exact)
    if roughly or not named.explains:
        stepped = of_steps(case, best.reading)
        if stepped is not None and stepped.residual_rms_m <= named.residual_rms_m:
            return stepped
    elif program.method is not None:
        loop = of_loops(case)
        if loop is not None:
            named = likelier_step(named, loop)
    if named.explains and all(cause.stage != AS_IF for cause in named.causes):
        return named
    approximation = of_approximation(case, scene)
    return named if approximation is None else likelier(approximation, named)


def _is_mirrored(cause: Deviation) -> bool:
    """Return whether a release is the scene's but for its sign, which is an axis that points the other way."""
    if not cause.id.endswith(("release.x", "release.y")):
        return False
    if cause.value is None or cause.shift is None:
        return False
    scene = cause.value - cause.shift
    return abs(cause.value + scene) < ROUGHLY * abs(scene)


def _sample(count: int) -> Array:
    """Return the indices of some rows: half of them evenly spaced, half at the beginning."""
    half = min(ROWS // 2, count)
    even = np.linspace(0, count - 1, half)
    crowded = np.geomspace(1, count, half) - 1
    first = np.arange(min(count, ROWS // 4))
    return np.unique(np.concatenate([even, crowded, first]).astype(np.int64))
