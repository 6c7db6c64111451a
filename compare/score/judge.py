"""Judge a candidate against the truth, to a tolerance: `judge()` returns a `Score` with errors and verdict.

>>> from compare import judge
>>> score = judge("mine.csv", "paris")                                # doctest: +SKIP
>>> score.verdict, score.errors.max_m                                 # doctest: +SKIP
('agrees', 3.1e-11)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from reference import Golden, InputError, Scene, Solution, UnreachableError
from reference.dataset.golden import WITHIN, Dense
from reference.errors import Described, did_you_mean, in_words
from reference.numbers.precision import Array
from reference.scenes.scene import AnyScene, as_scene
from reference.solver.doubles import TOLERANCE
from reference.system.imports import install_command, missing

from ..candidates.arrays import candidate_from, real_array
from ..candidates.candidate import Candidate, checked_transits
from ..candidates.read import named, read
from ..diagnosis import diagnose
from ..observed.swing_plane import rest_in_metres
from ..truth import (
    DIGITS,
    FINE,
    SILENT,
    Progress,
    Report,
    by_function,
    golden_of,
    roughly_solved,
    truth_at,
    with_function,
)
from .baseline import document_of, since
from .clock_start import counted_from_release
from .errors import TrajectoryErrors, drifts, trajectory_errors
from .remarks import scale_beyond_the_cord, warning_of_a_flung_bob, warning_of_a_resting_bob
from .time_span import check_end, check_transits, end_of_run, rows_until
from .transit_matching import judged_transits, unjudged_transits
from .verdict import Score

# readings of the scene's numbers; auto: by the candidate's precision
READINGS = ("auto", "decimal", "binary64")
_NO_REASONS = "no reasons are looked for, because heyoka is not installed: {}"
_ROUGHLY = 1e-3  # largest error of a cheap run, over the tolerance
# reach of a candidate over that of the truth: below it the tolerance follows from the candidate's
SMALL = 0.1
_DOUBT = 3  # times the reference's bound: each of the three coordinates may be off by it


@dataclass(frozen=True)
class JudgeOptions:
    """What counts as agreement, and whether reasons are looked for.

    Attributes:
        tolerance_m: largest position error allowed; None for `TOLERANCE` times the amplitude.
        inputs: how the scene's numbers are read: decimal, binary64, or auto, by the candidate.
        t_end_s: end of the comparison; None for the scene's.
        covers: share of the scene's span, from 0 to 1, that the rows have to reach.
        as_model: whether agreement as a named model is enough.
        explain: whether to look for the reasons if a position is off.
    """

    tolerance_m: float | None = None
    inputs: str = "auto"
    t_end_s: float | None = None
    covers: float = 0.0
    as_model: bool = False
    explain: bool = True


def judge(
    candidate: Candidate | str | Path | Mapping[str, Any] | None,
    scene: AnyScene,
    *,
    transits: npt.ArrayLike | None = None,
    tolerance: float | None = None,
    inputs: str = "auto",
    t_end: float | None = None,
    covers: float = 0.0,
    as_model: bool = False,
    explain: bool = True,
    baseline: Score | Candidate | Mapping[str, Any] | str | Path | None = None,
    announce: Callable[[str], None] | None = None,
    report: Report | None = None,
) -> Score:
    """Judge a candidate against the truth of a scene.

    Args:
        candidate: the trajectory, at its own times; the path of its file; or columns by name, as in
            a header, t, x, y and any of z, vx, vy, vz, in a mapping or a pandas.DataFrame; None to
            judge transits alone.
        scene: the problem that it claims to solve: a scene, its id, the path of a TOML file, or
            nested mappings.
        transits: its times of xdot = 0 in s; if None, those that came with the trajectory.
        tolerance: largest position error allowed in m; if None, `TOLERANCE` times the amplitude.
        inputs: decimal, binary64, or auto: binary64 for programs whose numbers fit in a double.
        t_end: end of the comparison in s; later rows and transits are ignored, and a note says so.
        covers: share of the scene's span, from 0 to 1, that the rows have to reach for it to agree.
        as_model: whether agreement as a named model is enough for it to pass.
        explain: whether to look for the reasons if a position is off.
        baseline: an earlier version, to say what changed since: its score, its trajectory or the
            path of its file, or a document of `foucault score --json` or the path of one (.json).
        announce: called with a message before the scene is solved, which takes long.
        report: called with the simulated time reached, in s, while the scene is solved.

    Raises:
        InputError: the candidate or the scene cannot be read, a time of the candidate is outside
            the scene's span, or the tolerance is not positive.
        UnreachableError: the scene cannot be solved.
    """
    options = checked_options(tolerance, inputs, t_end, covers, as_model, explain)
    progress = Progress(announce, report)
    return judge_with(
        options, candidate, scene, transits=transits, baseline=baseline, progress=progress
    )


def checked_options(
    tolerance: float | None,
    inputs: str,
    t_end: float | None,
    covers: float,
    as_model: bool,
    explain: bool,
) -> JudgeOptions:
    """Return the options of `judge` in one object.

    Raises:
        InputError: one of them has a wrong type or is out of range.
    """
    if tolerance is not None and not (isinstance(tolerance, Real) and 0 < tolerance < math.inf):
        raise InputError("tolerance", tolerance, "a positive number of metres")
    if t_end is not None and not isinstance(t_end, Real):
        raise InputError("t_end", t_end, "a number of seconds")
    if not (isinstance(covers, Real) and 0 <= covers <= 1):
        raise InputError("covers", covers, "a share of the scene's span, from 0 to 1")
    if inputs not in READINGS:
        advice = did_you_mean(str(inputs), READINGS, "")
        raise InputError("inputs", inputs, in_words(READINGS), advice)
    return JudgeOptions(
        tolerance_m=None if tolerance is None else float(tolerance),
        inputs=inputs,
        t_end_s=None if t_end is None else float(t_end),
        covers=covers,
        as_model=as_model,
        explain=explain,
    )


def judge_with(
    options: JudgeOptions,
    candidate: Candidate | str | Path | Mapping[str, Any] | None,
    scene: AnyScene,
    *,
    transits: npt.ArrayLike | None = None,
    baseline: Score | Candidate | Mapping[str, Any] | str | Path | None = None,
    progress: Progress = SILENT,
) -> Score:
    """Judge a candidate as `judge` does, with its options in one object."""
    if not isinstance(baseline, Score | Candidate | Mapping | str | Path | None):
        expected = "a score, a trajectory, the path of a file, or a score's JSON document"
        raise InputError("baseline", baseline, expected)
    if isinstance(scene, Mapping) and "t" in scene:
        got = Described(f"the columns {', '.join(map(str, scene))}")
        advice = "The arguments are in the wrong order: call judge(rows, scene)."
        raise InputError("scene", got, "a scene", advice)
    scene = as_scene(scene).with_values({"run.sections": ""})  # it takes none of them

    trial = _trial_of(_candidate_of(candidate, transits, scene), scene, options)
    score = _with_remarks(_score_of(trial, progress), trial)
    if options.explain and score.off_path and trial.candidate.positions and score.covered:
        score = _explained(score, trial)
    return score if baseline is None else _with_changes(score, baseline, trial)


def _explained(score: Score, trial: _Trial) -> Score:
    """Return a score with the reasons of its error, or with a note on what finding them needs."""
    if missing(["heyoka"]):
        return replace(
            score, notes=(*score.notes, _NO_REASONS.format(install_command("heyoka", "")))
        )
    explanation = diagnose(trial.candidate, trial.problem, score.allowed_m)
    return replace(score, explanation=explanation)


@dataclass(frozen=True)
class _Trial:
    """What is judged, and how.

    Attributes:
        candidate: rows and transits up to the end of the comparison, in times since the release.
        scene: as it was given.
        problem: the scene with its inputs read as decimals or as doubles.
        why_inputs: the reason for that reading.
        options: what counts as agreement.
    """

    candidate: Candidate
    scene: Scene
    problem: Scene
    why_inputs: str
    options: JudgeOptions


def _candidate_of(
    candidate: Candidate | str | Path | Mapping[str, Any] | None,
    transits: npt.ArrayLike | None,
    scene: Scene,
) -> Candidate:
    """Return a candidate with its transits, or one of transits alone.

    Raises:
        InputError: it cannot be read, or all transits are beyond the scene's end.
    """
    times = None
    if transits is not None:
        times = checked_transits(real_array(transits, "transits"), "transits")

    if candidate is None and times is not None:
        check_transits(times, scene)
        return Candidate.of_transits("transits", times[times <= float(scene.exact.t_end)])
    if isinstance(candidate, str | Path):
        candidate = read(candidate)
    elif not isinstance(candidate, Candidate):
        candidate = candidate_from(candidate)
    return candidate if times is None else replace(candidate, transits=times)


def _trial_of(candidate: Candidate, scene: Scene, options: JudgeOptions) -> _Trial:
    """Return the trial of a candidate.

    Raises:
        InputError: its clock cannot be known, or its times are beyond the scene's end.
    """
    if candidate.positions:
        candidate = counted_from_release(candidate, scene, options.tolerance_m)
    if options.t_end_s is not None:
        if candidate.t[0] > options.t_end_s:
            check_end(candidate, scene)
        candidate = rows_until(candidate, options.t_end_s)
    check_end(candidate, scene)
    problem, why_inputs = _reading(candidate, scene, options.inputs)
    return _Trial(candidate, scene, problem, why_inputs, options)


def _reading(candidate: Candidate, scene: Scene, inputs: str) -> tuple[Scene, str]:
    """Return the scene with its inputs read as decimals or as doubles, and the reason for the choice."""
    if inputs != "auto":
        return scene.with_values([f"inputs={inputs}"]), "as asked"
    if scene.inputs == "binary64":
        return scene, "as the scene says"
    if candidate.extended:
        return scene, "its numbers have more digits than a double: it can hold the decimal inputs"
    why = "its numbers are doubles, and so its inputs must have been rounded to doubles"
    return scene.with_values(["inputs=binary64"]), why


def _score_of(trial: _Trial, progress: Progress) -> Score:
    """Return the score by the first truth that is known closely enough to decide the verdict."""
    for golden, truth in _truths(trial, progress):
        score = _score_by(golden, truth, trial)
        if _decides(score):
            return score
    return score  # by the closest truth there is, which may leave a doubt


def _truths(trial: _Trial, progress: Progress) -> Iterator[tuple[Golden | Solution, Dense]]:
    """Yield datasets or solutions with the truth at the times, each known more closely than the one before."""
    candidate = trial.candidate
    problem = trial.problem
    if not candidate.extended:
        dataset = with_function(problem)
        if dataset is None:
            transits = candidate.transits is not None
            rough = roughly_solved(problem, candidate.t, transits, progress.report)
            if rough is not None:
                yield rough
        else:
            truth = by_function(dataset, candidate.t)
            if truth is not None:
                yield dataset, truth

    digits = problem.run.digits if candidate.extended else DIGITS
    within = FINE if candidate.extended else WITHIN
    golden = golden_of(problem, digits, progress, until=float(candidate.t[-1]))
    yield golden, truth_at(golden, candidate.t, within)


def _score_by(golden: Golden | Solution, truth: Dense, trial: _Trial) -> Score:
    """Return the score by one truth, without an explanation.

    Raises:
        InputError: there are transits alone, and the scene has none.
    """
    candidate = trial.candidate
    options = trial.options
    errors = trajectory_errors(candidate, truth, golden)
    tolerance_m = options.tolerance_m
    if tolerance_m is None:
        tolerance_m = TOLERANCE * _amplitude(candidate, errors)

    transits = None
    notes = candidate.notes
    if candidate.transits is not None:
        reason = unjudged_transits(golden)
        if reason is None:
            until = end_of_run(candidate, trial.scene)
            transits = judged_transits(candidate.transits, golden, errors, tolerance_m, until)
        elif candidate.positions:
            notes = (*notes, reason)
        else:
            advice = f"Print t,x,y as well: {reason}."
            raise InputError("transits", Described("transits alone"), "a trajectory", advice)

    return Score(
        candidate=candidate,
        scene=trial.problem,
        why_inputs=trial.why_inputs,
        golden=golden,
        errors=errors,
        tolerance_m=tolerance_m,
        swing=errors.swing(_rest(trial.scene)),
        drifts=drifts(candidate, trial.problem),
        transits=transits,
        notes=notes,
        covers=options.covers,
        as_model=options.as_model,
    )


def _amplitude(candidate: Candidate, errors: TrajectoryErrors) -> float:
    """Return the amplitude in m: of the truth, or of a candidate that swings far less."""
    if not candidate.positions:
        return errors.amplitude_m
    reach_m = _reach(candidate.columns["x"], candidate.columns["y"])
    true_reach_m = _reach(errors.truth.states[:, 0], errors.truth.states[:, 1])
    if 0 < reach_m < SMALL * true_reach_m:
        return errors.amplitude_m * (reach_m / true_reach_m)
    return errors.amplitude_m


def _reach(x: Array, y: Array) -> float:
    """Return the largest distance from the vertical in m."""
    return float(np.hypot(x, y).max())


def _rest(scene: Scene) -> tuple[float, float]:
    """Return x and y of the rest position in m; (0, 0) if there is no single one."""
    try:
        x, y, _ = rest_in_metres(scene)
    except UnreachableError:
        return 0.0, 0.0
    return float(x), float(y)


def _decides(score: Score) -> bool:
    """Return whether a more accurate truth would leave the verdict as it is."""
    if _in_doubt(score):
        return False
    is_dataset = isinstance(score.golden, Golden)  # proved or confirmed, far below any tolerance
    return is_dataset or score.errors.bound_m <= _ROUGHLY * score.tolerance_m


def _in_doubt(score: Score) -> bool:
    """Return whether the reference's own error could change the verdict."""
    errors_m = [score.errors.max_m]
    if score.transits is not None:
        errors_m.append(score.transits.max_conditioned_m)
    doubt_m = _DOUBT * score.errors.bound_m
    return any(abs(error_m - score.tolerance_m) <= doubt_m for error_m in errors_m)


def _with_remarks(score: Score, trial: _Trial) -> Score:
    """Return a score with what a reader ought to know of the scene, the tolerance and the unit of length."""
    notes = [
        *score.notes,
        *warning_of_a_flung_bob(score.scene),
        *warning_of_a_resting_bob(score),
    ]
    candidate = score.candidate
    if candidate.positions:
        truth = score.errors.truth.states[:, :2]
        scale = scale_beyond_the_cord(candidate, trial.scene, truth)
        if scale is not None:
            candidate = replace(candidate, conventions=(*candidate.conventions, scale))
    return replace(score, candidate=candidate, notes=tuple(notes))


def _with_changes(
    score: Score, baseline: Score | Candidate | Mapping[str, Any] | str | Path, trial: _Trial
) -> Score:
    """Return a score with what changed since an earlier version.

    Raises:
        InputError: the earlier version cannot be read, or is of another problem.
    """
    options = trial.options
    if isinstance(baseline, str | Path):
        path = Path(baseline)
        with named("baseline"):
            baseline = document_of(path) if path.suffix == ".json" else read(path)
    if isinstance(baseline, Candidate):
        # its reasons matter only to decide whether it agreed as a model
        explain = options.explain and options.as_model
        same = replace(options, covers=0.0, explain=explain)
        baseline = judge_with(same, baseline, trial.scene)

    changes = since(score, baseline, options.explain)
    notes = score.notes
    if changes is None:
        notes = (*notes, "the baseline has no score of it, so nothing is compared")
    return replace(score, since=changes, notes=notes)
