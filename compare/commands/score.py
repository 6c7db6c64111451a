"""`foucault score`: judge one or more candidates against the truth of a scene."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reference import InputError, Scene, load_scene
from reference.commands.progress import progress
from reference.commands.terminal import (
    AsJson,
    Assignments,
    SceneWord,
    chosen,
    completion,
    emit,
    refuse,
    replacements,
    stoppable,
)

from .options import announce

if TYPE_CHECKING:
    from ..candidates.candidate import Candidate
    from ..candidates.external import Timing
    from ..score.judge import Score

MAX_REPEATS = 1000
TIMEOUT_S, REPEATS = 600.0, 3  # defaults of --timeout and --repeats
UNUSED = {  # fields of a scene that make no difference to a score
    "run.level": "A candidate is held against a confirmed solution, or a dataset that ships.",
    "inputs=decimal": "Write --inputs decimal: without it doubles are held against doubles.",
}
INPUTS = ("auto", "decimal", "binary64")  # readings of the scene's numbers; auto: by the candidate's precision


def _approximation_ids() -> list[str]:
    from ..approximations import motions

    return list(motions())


def command(
    scene_word: SceneWord,
    candidates: Annotated[
        list[str] | None,
        typer.Argument(metavar="CANDIDATE", help="Files to score: CSV, foucPend's output or .npz; - is stdin."),
    ] = None,
    transits: Annotated[
        str | None,
        typer.Option(
            "--transits", metavar="FILE", help="Score transits too: a CSV file with times of xdot = 0 in its column t."
        ),
    ] = None,
    run: Annotated[
        str | None, typer.Option("--run", metavar="'COMMAND'", help="Run this program and score its output.")
    ] = None,
    approximation: Annotated[
        str | None,
        typer.Option(
            "--approximation",
            metavar="ID",
            help="Score one of the source papers' approximations, which `foucault methods` lists.",
            autocompletion=completion(_approximation_ids),
        ),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            "--tolerance", metavar="M", help="Allow position errors up to this, in m (default: 1e-6 of the amplitude)."
        ),
    ] = None,
    covers: Annotated[
        float | None,
        typer.Option(
            "--covers",
            metavar="SHARE",
            help="Demand that the rows reach this share of the scene's span; 1 is all of it (default: any).",
        ),
    ] = None,
    t_end: Annotated[
        str | None,
        typer.Option(
            "--t-end", metavar="S", help="Compare up to this time, in s, and ignore later rows (default: the scene's)."
        ),
    ] = None,
    inputs: Annotated[
        str,
        typer.Option(
            "--inputs",
            metavar="READING",
            help="Read the scene's numbers as decimal or binary64; auto: as the candidate's digits suggest.",
            autocompletion=completion(lambda: INPUTS),
        ),
    ] = "auto",
    plot: Annotated[
        Path | None, typer.Option("--plot", metavar="FILE", help="Draw error against time: .svg, .png or .pdf.")
    ] = None,
    timeout: Annotated[
        float | None,
        typer.Option(
            "--timeout",
            metavar="S",
            help=f"Stop the program of --run after this many seconds (default: {TIMEOUT_S:g}).",
        ),
    ] = None,
    repeats: Annotated[
        int | None,
        typer.Option(
            "--repeats",
            metavar="N",
            help=f"Time the program of --run this often after a warm-up (default: {REPEATS}).",
        ),
    ] = None,
    no_diagnosis: Annotated[
        bool, typer.Option("--no-diagnosis", help="Do not look for the reason of an error.")
    ] = False,
    set_: Assignments = None,
    as_json: AsJson = False,
) -> None:
    """Score a program's output against the truth.

    Exit status 0: agrees, 1: disagrees.

    --run fills in these placeholders: {x0} {y0} {z0} {vx0} {vy0} {vz0} {length} {drag} {latitude} {altitude} {gravity}
    {gravity_is} {rotation_rate} {equatorial_radius} {inverse_flattening} {angle} {azimuth} {angle_rate}
    {azimuth_rate} {t_end} {grid_step}.
    """
    reading = None if chosen("--inputs", inputs, INPUTS) == "auto" else inputs
    options = {"--t-end": ("run.t_end", t_end), "--inputs": ("inputs", reading)}
    scene = load_scene(scene_word, replacements(set_, options, UNUSED))
    if tolerance is not None and not 0 < tolerance < float("inf"):
        raise InputError("--tolerance", f"{tolerance:g}", "a positive number of metres")
    if covers is not None and not 0 < covers <= 1:
        raise InputError("--covers", f"{covers:g}", "a share of the scene's span, above 0 and up to 1")
    if not candidates and run is None and approximation is None and transits is None:
        expected = "a file, - for stdin, --run, --transits or --approximation"
        raise InputError("CANDIDATE", "nothing", expected, "Name what is to be scored.")
    if [*(candidates or ()), transits].count("-") > 1:
        raise InputError("CANDIDATE", "- more than once", "standard input once", "It can be read only once.")
    if run is None:
        refuse({"--timeout": timeout, "--repeats": repeats}, "without --run")
    timeout, repeats = TIMEOUT_S if timeout is None else timeout, REPEATS if repeats is None else repeats
    if not 0 < timeout < float("inf"):
        raise InputError("--timeout", f"{timeout:g}", "a positive number of seconds")
    if not 0 <= repeats <= MAX_REPEATS:
        raise InputError("--repeats", repeats, f"a whole number from 0 to {MAX_REPEATS}")
    if plot is not None:
        from ..report.charts.score import check_target

        check_target(plot)
    from ..candidates.read import read, read_transits
    from ..score.judge import judge

    transit_times = None if transits is None else read_transits(transits)
    timed_candidates: list[tuple[Candidate | None, Timing | None]] = [(read(name), None) for name in candidates or ()]
    if run is not None:
        timed_candidates.append(_run(run, scene, timeout, repeats))
    if approximation is not None:
        timed_candidates.append((_approximate(approximation, scene), None))
    if not timed_candidates:
        timed_candidates.append((None, None))  # transits alone
    scores = []
    for candidate, timing in timed_candidates:
        with stoppable("nothing was written"), progress() as show:
            score = judge(
                candidate,
                scene,
                transits=transit_times,
                tolerance=tolerance,
                inputs=inputs,
                t_end=None if t_end is None else float(scene.exact.t_end),
                covers=covers or 0.0,
                explain=not no_diagnosis,
                announce=announce,
                report=show(f"the truth of {scene.id}", float(scene.exact.t_end)),
            )
        scores.append(replace(score, timing=timing))
    if plot is not None:
        from ..report.charts.score import error_picture

        error_picture(scores, plot)
    _print(scores, as_json)
    if not all(score.agrees for score in scores):
        raise typer.Exit(1)


def _run(words: str, scene: Scene, timeout: float, repeats: int) -> tuple[Candidate, Timing]:
    """Run a program and return the candidate that it prints, and its run time."""
    from ..candidates.external import arguments, timed
    from ..candidates.read import read_stream

    output, timing = timed(arguments(words, scene), timeout, repeats)
    with output:
        return read_stream(output, "the program"), timing


def _approximate(word: str, scene: Scene) -> Candidate:
    """Return the motion of an approximation at the scene's grid times."""
    import numpy as np

    from ..approximations import APPROXIMATIONS, Motion
    from ..candidates.candidate import COLUMNS, candidate_of

    motion = APPROXIMATIONS[word]
    if not isinstance(motion, Motion):
        raise InputError(
            "--approximation", word, "an approximation of the motion", "This one gives a number, not a motion."
        )
    times = [float(t) for t in scene.exact.grid]
    columns = dict(zip(COLUMNS, motion.trajectory(scene, times).T, strict=True))
    return candidate_of(word, {"t": np.array(times), **columns})


def _print(scores: list[Score], as_json: bool) -> None:
    from ..score.document import document
    from ..score.verdict import lines

    if as_json:
        documents = [document(score) for score in scores]
        verdict = "agrees" if all(score.agrees for score in scores) else "disagrees"
        rows = {"scene": scores[0].scene.id, "verdict": verdict, "rows": documents}
        emit(documents[0] if len(documents) == 1 else rows)
        return
    for score in scores:
        for line in lines(score):
            typer.echo(line)
