"""Explain a disagreement: conventions, then the family of models, then the causes that its numbers show."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from reference import FoucaultError, Scene
from reference.engines.trajectory import Variants
from reference.numbers.precision import Array

from ..approximations import APPROXIMATIONS, Motion
from ..candidates.candidate import Deviation
from .case import (
    AS_IF,
    HARMLESS,
    Explanation,
    FileCase,
    FileRows,
    NamedModel,
    largest,
)
from .claims import either_of, explanation_of, nothing, with_rival_step
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
)
from .fitted import readings_of
from .formulas import of_formula
from .observed import of_observation
from .programs import Program, SphericalPendulum
from .slips import falls, growth, slip
from .stepped import of_loops, of_steps
from .thresholds import NEEDED, RIVAL

RENAMED = ("xy_swapped", "x_west", "y_south", "xy_reversed", "axes_turned")
FAST = 20.0  # times faster than the scene: nothing is run
LEFT_OUT = ("z_constant", "off_the_sphere")  # heights that no explanation is asked for
MOST_ROWS = 20_000  # that are looked at: the first half of them, and as many evenly spaced
ROWS = 500  # rows that are used at most: half evenly spaced, half at the beginning
ROWS_A_SWING = 20  # that show what an integrator does
MAPPED = 4000  # rows of which all are compared with maps of columns
LOW = 0.25  # of the cord: a bob that comes nearer to the suspension's height makes no small swings
OF_PAPERS = 2  # price of an approximation: a model, and what it is about
SIMPLE = 2  # price of a map of columns beside which no steps are tried
CLOSELY = 0.01  # of the error that an approximation may leave
PLAINLY = 0.01  # of what fitted causes leave: an approximation that leaves less is meant


def explain(times: Array, columns: dict[str, Array], scene: Scene, allowed_m: float) -> Explanation:
    """Return what is known of the reasons for an error; empty where nothing is.

    Args:
        times: of the rows, in s.
        columns: x, y and perhaps z in m.
        scene: in the reading that the file was scored in.
        allowed_m: distance in m that counts as agreement.
    """
    if len(times) > MOST_ROWS:
        first = np.arange(MOST_ROWS // 2)
        even = np.linspace(MOST_ROWS // 2, len(times) - 1, MOST_ROWS // 2).astype(np.int64)
        chosen = np.concatenate([first, even])
        times = times[chosen]
        columns = {name: column[chosen] for name, column in columns.items()}
    try:
        with np.errstate(all="ignore"):
            problem = KnownScene.of(scene)
            found = _explained(times, columns, problem, allowed_m)
            return replace(found, next_step=_next_step(times, problem.frequency))
    except (
        FoucaultError,
        ArithmeticError,
        np.linalg.LinAlgError,
    ):  # no program solves such a scene, or fits it
        return Explanation()


def _next_step(times: Array, frequency: float) -> str:
    """Return what to do where no cause is known."""
    most_s = 2 * math.pi / frequency / ROWS_A_SWING if frequency else math.inf
    if len(times) > 1 and float(np.median(np.diff(times))) > most_s:
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
        return digits(FileRows(times, positions, 0.0))

    def rows(
        self, times: Array, columns: dict[str, Array], rename: bool = True, late: bool = True
    ) -> FileRows:
        """Return the rows of a file in the scene's conventions.

        Args:
            times: as in the file.
            columns: x, y and perhaps z as in the file.
            rename: whether the horizontal axes may have each other's names, or point the other way.
            late: whether the clock may be off.
        """
        start, length, frequency = self.start, self.right.length, self.frequency
        rows = heights(self.printed(times, columns), length)
        rows = clock(axes(rows, start, length, rename), start)
        rows = rounded_clock(unit_of_time(rows, frequency, length), frequency)
        return rows if rows.starts or not late else shifted(rows, start, frequency, length)

    def case(self, rows: FileRows, allowed_m: float, most: int = 0) -> FileCase:
        """Return what is to be explained of rows, of which some are taken if they are more than `most`."""
        count = len(rows.times)
        chosen = np.arange(count) if count <= most else _sample(count)
        rows = replace(rows, times=rows.times[chosen], positions=rows.positions[chosen])
        since_release = rows.times if rows.times[0] == 0 else np.concatenate([[0.0], rows.times])
        truth = self.model.states(self.scene.exact, since_release)[
            -len(rows.times) :, : rows.positions.shape[1]
        ]
        right, frequency = self.right, self.frequency
        pendulum = SphericalPendulum(
            self.model, right.radius, right.gradient_square, FAST * (frequency + abs(right.rate))
        )
        intervals = (
            round(float(rows.times[-1] / rows.times[1]))
            if rows.times[0] == 0 < rows.times[-1]
            else 0
        )
        return FileCase(rows, truth, right, pendulum, frequency, allowed_m, intervals)


def _explained(
    times: Array, columns: dict[str, Array], problem: KnownScene, allowed_m: float
) -> Explanation:
    scene = problem.scene
    rows = problem.rows(times, columns)
    case = problem.case(rows, allowed_m)
    heights_left_out = any(part.id in LEFT_OUT for part in rows.conventions)
    if case.error > case.floor or heights_left_out:
        observed = of_observation(problem.case(problem.printed(times, columns), allowed_m, MAPPED))
        if observed is not None and observed.price <= SIMPLE:
            return likelier(observed, explanation_of(case, readings_of(case))[0])
        if observed is not None:
            return likelier(observed, first_good_explanation(case, scene))
    best = first_good_explanation(case, scene)
    alternatives = (
        list(other_conventions(rows, problem.start)) if best.corrected_m > allowed_m else []
    )
    if any(convention.id in RENAMED for convention in rows.conventions):
        # the release may be at fault, and not the names
        alternatives.append(problem.rows(times, columns, rename=False))
    for alternative in alternatives:
        explanation = first_good_explanation(problem.case(alternative, allowed_m), scene)
        if explanation.corrected_m <= allowed_m and not any(
            _is_mirrored(cause) for cause in explanation.causes
        ):
            best, rows = min(
                (best, rows), (explanation, alternative), key=lambda pair: pair[0].score
            )
    shifts = [
        convention.size_m
        for convention in best.conventions
        if convention.id in ("rows_early", "rows_late")
    ]
    # what is left may look like it
    if shifts and not best.known and shifts[0] < RIVAL * best.corrected_m:
        rows = problem.rows(times, columns, late=False)
        best = first_good_explanation(problem.case(rows, allowed_m), scene)
    simple = {cause.stage for cause in best.known} <= {"gravity", "model"}
    unknown = simple and best.corrected_m > max(allowed_m, 1.5 * rows.noise)
    if not best.slip and (
        unknown or any(cause.id.endswith("integrator_loose") for cause in best.causes)
    ):
        wrong_term = slip(rows, scene)
        if wrong_term:  # one term of a formula, as no integrator changes it
            return Explanation(best.conventions, slip=wrong_term)
        if not best.known:
            return replace(best, slip=falls(rows, problem.right) or growth(rows))
    return best


def likelier(observed: Explanation, program: Explanation) -> Explanation:
    """Return the likelier one of an explanation of another kind, which explains the rows, and of one by a program.

    Another kind is columns that are printed otherwise, or an approximation of the source papers.
    """
    if not program.causes or program.corrected_m > program.allowed_m:
        return observed
    cheap, dear = sorted((observed, program), key=lambda explanation: explanation.price)
    if cheap.price < dear.price:
        return dear if NEEDED * dear.rest_m < cheap.rest_m else cheap
    if RIVAL * observed.rest_m < program.rest_m:
        return observed
    if RIVAL * program.rest_m < observed.rest_m:
        return program
    return either_of(program, observed)


def first_good_explanation(case: FileCase, scene: Scene) -> Explanation:
    """Return the first explanation that is good enough, in the order in which one would believe them."""
    if case.error <= case.floor:
        return nothing(case)
    named, best = explanation_of(case, readings_of(case))
    if best is None or not named.causes:
        other = of_steps(case, None) or of_formula(case) or _of_approximation(case, scene, None)
        return other or named
    program = best.reading.program
    # on the sphere what a step does is known roughly; to know it better, the step is taken
    # and in a linear model it is known exactly, if it is a method that has a name
    roughly = program.method is not None and (program.kind == "sphere" or not best.is_exact)
    if roughly or named.corrected_m > case.enough:
        stepped = of_steps(case, best.reading)
        if stepped is not None and stepped.rest_m <= named.rest_m:
            return stepped
    elif program.method is not None:
        loop = of_loops(case)
        if loop is not None:
            named = with_rival_step(named, loop, case)
    if named.corrected_m > case.enough:
        return _of_approximation(case, scene, named) or named
    certain = all(cause.stage != AS_IF for cause in named.causes)
    simple = None if certain else _of_approximation(case, scene, None)
    if simple is not None and simple.corrected_m > case.enough:
        return named
    return named if simple is None else likelier(simple, named)


def _of_approximation(
    case: FileCase, scene: Scene, named: Explanation | None
) -> Explanation | None:
    """Return the approximation of the source papers that leaves next to nothing, of equal ones the first.

    None if there is none, or causes explain the rows as well.
    """
    rows, truth = case.rows, case.truth
    count = rows.positions.shape[1]
    if count == 3 and not float(truth[:, 2].max()) < -LOW * float(scene.exact.length):
        return None
    best: tuple[Deviation, NamedModel, Array] | None = None
    least = max(
        CLOSELY * float(np.linalg.norm(rows.positions - truth)), rows.noise * len(rows.times) ** 0.5
    )
    for word, motion in APPROXIMATIONS.items():
        if not isinstance(motion, Motion) or motion.refuses(scene) is not None:
            continue
        positions = motion.trajectory(scene, rows.times)[:, :count]
        left = rows.positions - positions
        rest = float(np.linalg.norm(left))
        if rest < (least if best is None else least / 2):
            least, costs = rest, largest(positions - truth)
            text = f"solves {motion.title} ({motion.where}) instead of the full equations"
            best = (
                Deviation(word, text, costs, "model"),
                NamedModel(word, motion.title, largest(left), costs),
                left,
            )
    if best is None or (named is not None and best[1].exact_to_m > PLAINLY * named.corrected_m):
        return None
    cause, model, left = best
    corrected = model.exact_to_m
    exact = corrected <= case.enough and all(
        convention.id in HARMLESS for convention in rows.conventions
    )
    explanation = case.tested((cause,), left, OF_PAPERS)
    return replace(explanation, model=model) if exact and explanation.causes else explanation


def _is_mirrored(cause: Deviation) -> bool:
    """Return whether a release is the scene's but for its sign, which is an axis that points the other way."""
    if (
        not cause.id.endswith(("release.x", "release.y"))
        or cause.value is None
        or cause.shift is None
    ):
        return False
    scene = cause.value - cause.shift
    return abs(cause.value + scene) < ROUGHLY * abs(scene)


def _sample(count: int) -> Array:
    even = np.linspace(0, count - 1, min(ROWS // 2, count))
    crowded = np.geomspace(1, count, min(ROWS // 2, count)) - 1
    return np.unique(
        np.concatenate([even, crowded, np.arange(min(count, ROWS // 4))]).astype(np.int64)
    )
