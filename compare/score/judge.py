"""Judge a candidate against the truth, to a tolerance: `judge()` returns a `Score` with errors and verdict.

>>> from compare import judge
>>> score = judge("mine.csv", "paris")                                # doctest: +SKIP
>>> score.verdict, score.errors.max_m                                 # doctest: +SKIP
('agrees', 3.1e-11)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from reference import Golden, InputError, Scene, Solution, UnreachableError
from reference.dataset.golden import WITHIN, Dense
from reference.errors import counted, did_you_mean, in_words
from reference.model.constants import constants_in_double
from reference.model.start import Start
from reference.numbers.columns import POSITION
from reference.numbers.precision import Array
from reference.scenes.scene import AnyScene, as_scene

from ..candidates.arrays import candidate_from, real_array
from ..candidates.candidate import Candidate, Deviation, checked_transits
from ..candidates.clock import shown
from ..candidates.external import PLACEHOLDER_BITS
from ..candidates.names import LENGTHS, LONG_NAMES, TIMES
from ..candidates.read import named, read
from ..diagnosis import diagnose
from ..observed.swing_plane import rest_in_metres
from ..truth import (
    DIGITS,
    FINE,
    Report,
    by_function,
    golden_of,
    roughly_solved,
    truth_at,
    with_function,
)
from .baseline import document_of, since
from .clock_start import SUBTRACT, TOLERANCE, counted_from_release
from .errors import TrajectoryErrors, drifts, trajectory_errors
from .transit_matching import judged_transits, unjudged_transits
from .verdict import Score

# readings of the scene's numbers; auto: by the candidate's precision
READINGS = ("auto", "decimal", "binary64")
FINER = ("ms", "us", "ns")  # units of time in which a run looks longer than its scene
BEYOND = 1.01  # times the cord: farther out, no rounding and no stretching puts the bob
ROUGHLY = 1e-3  # of the tolerance: how far cheap runs may be off
SMALL = 0.1  # of the truth's reach: a candidate that stays within has a tolerance of its own size
FAR = 10  # times the scene's span: a run that ends later is rather in another unit than longer
DOUBT = 3  # times the reference's bound, which each of the three coordinates may be off by
SAME = 1e-3  # relative difference of ratios that count as one scale


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
        candidate: the trajectory, at its own times; the path of its file; or columns by name, as in a header, t, x, y
            and any of z, vx, vy, vz, in a mapping or a pandas.DataFrame; None to judge transits alone.
        scene: the problem that it claims to solve: a scene, its id, the path of a TOML file, or nested mappings.
        transits: its times of xdot = 0 in s; if None, those that came with the trajectory.
        tolerance: largest position error allowed in m; if None, `TOLERANCE` times the amplitude.
        inputs: decimal, binary64, or auto: binary64 for programs whose numbers fit in a double.
        t_end: end of the comparison in s; later rows and transits are ignored, and a note says so.
        covers: share of the scene's span, from 0 to 1, that the rows have to reach for it to agree.
        as_model: whether agreement as a named model is enough for it to pass.
        explain: whether to look for the reasons if a position is off.
        baseline: an earlier version, to say what changed since: its score, its trajectory or the path of its file, or a
            document of `foucault score --json` or the path of one (.json).
        announce: called with a message before the scene is solved, which takes long.
        report: called with the simulated time reached, in s, while the scene is solved.

    Raises:
        InputError: the candidate or the scene cannot be read, a time of the candidate is outside the scene's span, or
            the tolerance is not positive.
        UnreachableError: the scene cannot be solved.
    """
    if tolerance is not None and not (isinstance(tolerance, Real) and 0 < tolerance < math.inf):
        raise InputError("tolerance", tolerance, "a positive number of metres")
    if t_end is not None and not isinstance(t_end, Real):
        raise InputError("t_end", t_end, "a number of seconds")
    if not (isinstance(covers, Real) and 0 <= covers <= 1):
        raise InputError("covers", covers, "a share of the scene's span, from 0 to 1")
    if inputs not in READINGS:
        raise InputError(
            "inputs", inputs, in_words(READINGS), did_you_mean(str(inputs), READINGS, "")
        )
    if not isinstance(baseline, Score | Candidate | Mapping | str | Path | None):
        raise InputError(
            "baseline",
            baseline,
            "a score, a trajectory, the path of a file, or a score's JSON document",
        )
    tolerance, t_end = (None if number is None else float(number) for number in (tolerance, t_end))
    if isinstance(scene, Mapping) and "t" in scene:
        got = f"columns {', '.join(map(str, scene))}"
        raise InputError("scene", got, "a scene", "The rows stand before the scene.")
    scene = as_scene(scene).with_values({"run.sections": ""})  # it takes none of them
    times = (
        None if transits is None else checked_transits(real_array(transits, "transits"), "transits")
    )
    if candidate is None and times is not None:
        _check_transits(times, scene)
        candidate = Candidate.of_transits("transits", times[times <= float(scene.exact.t_end)])
    elif not isinstance(candidate, Candidate):
        candidate = (
            read(candidate) if isinstance(candidate, str | Path) else candidate_from(candidate)
        )
    times = candidate.transits if times is None else times
    if candidate.positions:
        candidate, times = counted_from_release(candidate, times, scene, tolerance)
    if t_end is not None:
        if candidate.t[0] > t_end:
            _check_times(candidate, scene)
        candidate = _up_to(candidate, t_end)
        times = None if times is None else times[times <= t_end]
    _check_times(candidate, scene)
    until = None if times is None else _end_of_run(candidate, times, scene)
    problem, why = _reading(candidate, scene, inputs)
    for golden, truth in _truths(candidate, problem, times is not None, announce, report):
        errors = trajectory_errors(candidate, truth, golden)
        allowed = TOLERANCE * _amplitude(candidate, errors) if tolerance is None else tolerance
        unjudged = None if times is None else unjudged_transits(golden)
        if unjudged and not candidate.positions:
            raise InputError("transits", unjudged, "a trajectory as well", "Print t,x,y.")
        result = Score(
            candidate=candidate,
            scene=problem,
            why_inputs=why,
            golden=golden,
            errors=errors,
            tolerance_m=allowed,
            swing=errors.swing(_rest(scene)),
            drifts=drifts(candidate, problem),
            transits=None
            if times is None or unjudged
            else judged_transits(times, golden, errors, allowed, until),
            notes=candidate.notes + ((unjudged,) if unjudged else ()) + _flung_off(problem),
            covers=covers,
            as_model=as_model,
        )
        if not in_doubt(result) and (
            isinstance(golden, Golden) or errors.bound_m <= ROUGHLY * allowed
        ):
            break
    result = replace(result, notes=result.notes + _as_good_as_none(result))
    if candidate.positions and (
        scale := _beyond_the_cord(candidate, scene, errors.truth.states[:, :2])
    ):
        result = replace(
            result, candidate=replace(candidate, conventions=(*candidate.conventions, scale))
        )
    if explain and result.off_path and candidate.positions and result.covered:
        result = replace(result, explanation=diagnose(candidate, problem, result.allowed_m))
    if baseline is None:
        return result
    if isinstance(baseline, str | Path):
        path = Path(baseline)
        with named("baseline"):
            baseline = document_of(path) if path.suffix == ".json" else read(path)
    if isinstance(baseline, Candidate):
        same: dict[str, Any] = {
            "tolerance": tolerance,
            "inputs": inputs,
            "t_end": t_end,
            "as_model": as_model,
        }
        baseline = judge(baseline, scene, **same, explain=explain and as_model)
    changed = since(result, baseline, explain)
    alone = () if changed else ("the baseline has no score of it: this verdict stands alone",)
    return replace(result, since=changed, notes=result.notes + alone)


def in_doubt(score: Score) -> bool:
    """Return whether the reference's own error could change the verdict."""
    transits, tolerance = score.transits, score.tolerance_m
    measured = [score.errors.max_m, *([transits.max_conditioned_m] if transits else [])]
    return any(abs(error - tolerance) <= DOUBT * score.errors.bound_m for error in measured)


def _truths(
    candidate: Candidate,
    problem: Scene,
    transits: bool,
    announce: Callable[[str], None] | None,
    report: Report | None,
) -> Iterator[tuple[Golden | Solution, Dense]]:
    """Yield datasets or solutions with the truth at the times, each known more closely than the one before."""
    if not candidate.extended:
        ships = with_function(problem)
        truth = ships and by_function(ships, candidate.t)
        if ships and truth:
            yield ships, truth
        rough = None if ships else roughly_solved(problem, candidate.t, transits, report)
        if rough is not None:
            yield rough
    digits, within = (problem.run.digits, FINE) if candidate.extended else (DIGITS, WITHIN)
    golden = golden_of(problem, digits, announce, report, float(candidate.t[-1]))
    yield golden, truth_at(golden, candidate.t, within)


def _amplitude(candidate: Candidate, errors: TrajectoryErrors) -> float:
    """Return the amplitude in m: of the truth, or of a candidate that swings far less."""
    if not candidate.positions:
        return errors.amplitude_m
    columns = ((candidate.columns["x"], candidate.columns["y"]), errors.truth.states[:, :2].T)
    reach, true = (float(np.hypot(*part).max()) for part in columns)
    return errors.amplitude_m * (reach / true if 0 < reach < SMALL * true else 1.0)


def _up_to(candidate: Candidate, end: float) -> Candidate:
    """Return the rows up to a time in s, with a note if there were later ones."""
    kept = candidate.t <= end
    if kept.all():
        return candidate
    if not kept.any():
        raise InputError(
            "t_end",
            f"{end:g}",
            f"a time from the first row on, which is at t = {candidate.t[0]:g} s",
        )
    columns, low = (
        {name: column[kept] for name, column in of.items()}
        for of in (candidate.columns, candidate.low)
    )
    note = f"{counted(int((~kept).sum()), 'row')} after t = {end:g} s ignored, the last at {candidate.t[-1]:g} s"
    return replace(
        candidate, t=candidate.t[kept], columns=columns, low=low, notes=(*candidate.notes, note)
    )


def _check_transits(times: Array, scene: Scene) -> None:
    """Refuse transits that are all beyond the scene's end."""
    end = float(scene.exact.t_end)
    if len(times) and times[0] > end:
        raise InputError(
            "transits: t",
            f"{times[0]:.10g} s first",
            f"times from 0 to {scene.run.t_end} s",
            SUBTRACT,
        )


def _end_of_run(candidate: Candidate, transits: Array, scene: Scene) -> float:
    """Return the time in s at which a run ended: no later transit can be among its own."""
    end = float(scene.exact.t_end)
    last = float(candidate.t[-1])
    goes_on = not candidate.positions or bool(len(transits) and transits[-1] > last)
    return end if goes_on else min(last, end)


def _check_times(candidate: Candidate, scene: Scene) -> None:
    """Refuse times beyond the scene's span, and say what they may be.

    Raises:
        InputError: the last time is more than a grid step beyond the scene's end.
    """
    last, end = float(candidate.t[-1]), float(scene.exact.t_end)
    # one row alone says nothing of a clock's start
    first = float(candidate.t[0]) if len(candidate.t) > 1 else 0.0
    if last <= end + float(scene.exact.grid_step):
        return
    span = last - first
    unit = next((word for word in FINER if span * float(TIMES[word]) <= end * (1 + SAME)), None)
    longer = f"--t-end {scene.run.t_end} leaves out later rows, --set run.t_end={last:.10g} makes the scene longer."
    if unit is not None and span > FAR * end:
        seconds, start = last * float(TIMES[unit]), first * float(TIMES[unit])
        what = (
            f"and they end at {seconds:.10g} s"
            if seconds <= end * (1 + SAME)
            else f"from {shown(start)} on"
        )
        longer = f"They look like {LONG_NAMES[unit]}: --units {unit} reads them so, {what}."
    elif first > 0 and span <= end:
        longer = f"{longer} Did the clock start before the release? {SUBTRACT}"
    expected = f"times from 0 to {scene.run.t_end} s"
    raise InputError(f"{candidate.name}: t", f"{last:.10g} at the end", expected, longer)


def _beyond_the_cord(candidate: Candidate, scene: Scene, truth: Array) -> Deviation | None:
    """Return what positions that no cord lets the bob reach may be: another unit of length, or pixels; or None.

    A unit is named if the rows, in metres then, leave less than all of the truth: another pendulum does not follow it.
    """
    x, y, length = candidate.columns["x"], candidate.columns["y"], float(scene.exact.length)
    reach = float(np.hypot(x, y).max())
    if reach <= BEYOND * length:
        return None
    far = f"x and y reach {reach:.4g} and the cord is {scene.pendulum.length} m long"
    release = complex(*map(float, Start.of(scene.exact, PLACEHOLDER_BITS).position[:2]))
    ratio = complex(x[0], y[0]) / release if release and candidate.t[0] == 0 else 0j
    scale = abs(ratio)
    if not abs(ratio - scale) < SAME * scale:  # it does not begin at the release, in its direction
        return Deviation(
            "beyond_the_cord",
            f"{far}: pixels, another unit, or another pendulum? Metres are wanted",
        )
    unit = next(
        (
            word
            for word, size in LENGTHS.items()
            if size != 1 and abs(scale * float(size) - 1) < SAME
        ),
        None,
    )
    times = f"the first row is {scale:.6g} times the release"
    if unit is None:
        question = f"is it another pendulum, or are {scale:.6g} pixels, or of another unit, a metre? Divide by it"
        return Deviation("scale", f"{far}: {times}; {question}")
    follows = np.linalg.norm(np.column_stack([x, y]) / scale - truth) < np.linalg.norm(truth)
    what = (
        f", so they are {LONG_NAMES[unit]};"
        if follows
        else f"; is it another pendulum, or {LONG_NAMES[unit]}?"
    )
    return Deviation("scale", f"{far}: {times}{what} --units {unit} reads them so")


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


def _rest(scene: Scene) -> tuple[float, float]:
    """Return x and y of the rest position in m; (0, 0) if none is singled out."""
    try:
        x, y, _ = rest_in_metres(scene)
    except UnreachableError:
        return 0.0, 0.0
    return float(x), float(y)


def _as_good_as_none(score: Score) -> tuple[str, ...]:
    """Return a warning where a bob that does not move would agree as well, so that to agree says little.

    It may stay at its release, as in a program that never steps, or at its rest position, as in one without a swing.
    """
    if not (score.agrees and score.candidate.positions and score.transits is None):
        return ()
    places = {
        "where it is released": np.array(
            [float(q) for q in Start.of(score.scene.exact, PLACEHOLDER_BITS).position]
        )
    }
    with suppress(UnreachableError):
        places["at its rest position"] = rest_in_metres(score.scene)
    given = [i for i, name in enumerate(POSITION) if name in score.candidate.columns]
    truth = score.errors.truth.states[:, given]
    farthest = {
        word: float(np.linalg.norm(truth - place[given], axis=1).max())
        for word, place in places.items()
    }
    word = min(farthest, key=lambda word: farthest[word])
    if farthest[word] > score.allowed_m:
        return ()
    moves = f"the true one is never more than {farthest[word]:.2g} m from there"
    advice = ": set a tolerance far below that" if farthest[word] > score.errors.bound_m else ""
    return (f"a bob that stays {word} would agree as well, as {moves}{advice}",)


def _flung_off(scene: Scene) -> tuple[str, ...]:
    """Return a warning where the centrifugal force at the suspension is larger than gravity."""
    k = constants_in_double(scene.exact)
    outward, gravity = (
        float(k.rate) ** 2 * float(k.axis_distance) * k.length,
        float(k.gravity) * k.length,
    )
    if outward <= gravity:
        return ()
    advice = "with site.gravity_is=effective g contains that force"
    return (
        f"the centrifugal force at the suspension, {outward:.3g} m/s², is larger than g: {advice}",
    )
