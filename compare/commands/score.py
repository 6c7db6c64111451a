"""`foucault score`: judge one or more candidates against the truth of a scene."""

from __future__ import annotations

from pathlib import Path
from secrets import token_hex
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reference import InputError, load_scene
from reference.commands.terminal import (
    BESIDE_RANGES,
    AsJson,
    Assignments,
    Uncertain,
    chosen,
    completion,
    emit,
    option,
    refuse,
    replacements,
    scene_argument,
    widths_by_name,
)

from .options import announce, check_positive, listed

if TYPE_CHECKING:
    from ..score.verdict import Outcome

MAX_REPEATS = 1000
TIMEOUT_S, REPEATS = 600.0, 3  # defaults of --timeout and --repeats
UNUSED = {  # fields of a scene that make no difference to a score
    "run.level": "A candidate is held against a confirmed solution, or a dataset that ships.",
    "inputs=decimal": "Write --inputs decimal: without it doubles are held against doubles.",
}


def _readings() -> tuple[str, ...]:
    from ..score.judge import READINGS

    return READINGS


def _approximation_ids() -> list[str]:
    from ..approximations import motions

    return list(motions())


def _how(language: str | None) -> None:
    """Print how to write a candidate's file in a language, and end."""
    if language is not None:
        from ..candidates.how import how

        typer.echo(how(language))
        raise typer.Exit


SCENE = scene_argument("A scene's id, or the path of a TOML file; with --suite none.")
CANDIDATES = typer.Argument(
    metavar="CANDIDATE", help="Files: text with named columns, .npy, .npz; - is stdin."
)
SUITE = option("--suite", "Score a folder of files named after scenes: paris.csv.", "DIR")
HOW = option(
    "--how",
    "Print how to write such a file in c, fortran, python …",
    "LANGUAGE",
    callback=_how,
    is_eager=True,
)
COLUMNS = option("--columns", "A file's columns in order; - for one that is not read.", "t,x,y,…")
UNITS = option("--units", "Units of times and lengths: ms,cm (default: s,m).", "A,B")
TRANSITS = option("--transits", "Score times of xdot = 0 too, or alone: in its column t.", "FILE")
SECTION = option("--section", "--transits are passages of this section: 'gate 30'.", "WORD")
RUN = option("--run", "Run this program and score its output.", "'COMMAND'")
NAME = option("--name", "Name of the program of --run (default: the program).", "WORD", hidden=True)
SETTING = option("--setting", "{setting} in --run, in s (default: 200 a period, or more).", "S")
EXPERIMENTS = option("--experiments", "Run it up to eight times more, to measure why it is off.")
APPROXIMATION = option(
    "--approximation",
    "Score one of the source papers' approximations, which `foucault methods` lists.",
    "ID",
    completion(_approximation_ids),
    hidden=True,
)
BASELINE = option(
    "--baseline",
    "Say what changed since a file, --json document, command or suite of an earlier version.",
    "FILE",
)
TOLERANCE = option(
    "--tolerance", "Allow errors up to this, in m (default: 1e-6 of the amplitude).", "M"
)
COVERS = option("--covers", "Demand rows up to this share of the span (default: any).", "SHARE")
T_END = option("--t-end", "Ignore rows after this time, in s (default: the scene's).", "S")
INPUTS = option(
    "--inputs",
    "Read the scene as decimal or binary64; auto: by the file.",
    "READING",
    completion(_readings),
)
PLOT = option("--plot", "Draw error against time: .svg, .png or .pdf.", "FILE")
TIMEOUT = option("--timeout", f"Stop --run after this many seconds (default: {TIMEOUT_S:g}).", "S")
TIMINGS = option(
    "--repeats",
    f"Time the program of --run this often after a warm-up (default: {REPEATS}).",
    "N",
    hidden=True,
)
AS_MODEL = option("--as-model", "Count agreement with a named simpler model.")
NO_DIAGNOSIS = option("--no-diagnosis", "Do not look for the reasons of an error.")
OUT = option(
    "--out",
    "With --suite: write a page and tables into this folder; with --experiments: the outputs.",
    "DIR",
)
JUNIT = option("--junit", "Write the outcome as JUnit XML, a test for each.", "FILE")
GITHUB = option("--github", "Annotate for GitHub Actions; write the job's summary.")


def command(
    scene_word: Annotated[str | None, SCENE] = None,
    candidates: Annotated[list[str] | None, CANDIDATES] = None,
    suite: Annotated[Path | None, SUITE] = None,
    how: Annotated[str | None, HOW] = None,
    columns: Annotated[str | None, COLUMNS] = None,
    units: Annotated[str | None, UNITS] = None,
    transits: Annotated[str | None, TRANSITS] = None,
    section: Annotated[str | None, SECTION] = None,
    run: Annotated[str | None, RUN] = None,
    name: Annotated[str | None, NAME] = None,
    setting: Annotated[float | None, SETTING] = None,
    experiments: Annotated[bool, EXPERIMENTS] = False,
    approximation: Annotated[str | None, APPROXIMATION] = None,
    baseline: Annotated[str | None, BASELINE] = None,
    tolerance: Annotated[float | None, TOLERANCE] = None,
    covers: Annotated[float | None, COVERS] = None,
    t_end: Annotated[str | None, T_END] = None,
    inputs: Annotated[str, INPUTS] = "auto",
    plot: Annotated[Path | None, PLOT] = None,
    timeout: Annotated[float | None, TIMEOUT] = None,
    repeats: Annotated[int | None, TIMINGS] = None,
    as_model: Annotated[bool, AS_MODEL] = False,
    no_diagnosis: Annotated[bool, NO_DIAGNOSIS] = False,
    set_: Assignments = None,
    uncertain: Uncertain = None,
    out: Annotated[Path | None, OUT] = None,
    junit: Annotated[Path | None, JUNIT] = None,
    github: Annotated[bool, GITHUB] = False,
    as_json: AsJson = False,
) -> None:
    """Score a program's output against the truth.

    --run fills in {x0}, {latitude}, {t_end} … of the scene: see docs/commands.md, also on --approximation, --name,
    --repeats and ranges. Exit status 0: agrees (with --baseline: no worse), 1: disagrees, 2: cannot be judged.
    """
    from ..candidates.names import Naming
    from .judging import Judging, ranges_named, ranges_to_prove

    naming = Naming(
        tuple(listed(columns, "--columns") or ()), tuple(listed(units, "--units") or ())
    )
    reading = None if chosen("--inputs", inputs, _readings()) == "auto" else inputs
    check_positive("--tolerance", tolerance, "metres")
    if no_diagnosis:
        refuse(
            {"--as-model": as_model, "--experiments": experiments}, "together with --no-diagnosis"
        )
    if as_json:
        refuse({"--github": github}, "together with --json")
    if run is None:
        alone = {"--timeout": timeout, "--repeats": repeats, "--name": name, "--setting": setting}
        refuse({**alone, "--experiments": experiments}, "without --run")
    if not (candidates or run or suite):
        refuse({"--baseline": baseline}, "without a file, --run or --suite")
    if suite is None:
        refuse({"--out": None if experiments else out}, "without --suite or --experiments")
        options = {"--t-end": ("run.t_end", t_end), "--inputs": ("inputs", reading)}
        if scene_word is None:
            raise InputError(
                "SCENE", "nothing", "a scene's id, or --suite DIR", "`foucault scenes` lists them."
            )
        if (ranges := ranges_named(scene_word)) is not None:
            refuse(
                {"--uncertain": uncertain, "--set": set_, "--t-end": t_end, "--inputs": reading},
                "with ranges",
            )
        scene = (
            ranges.scene
            if ranges
            else load_scene(scene_word, replacements(set_, options, UNUSED, announce))
        )
        if ranges is None and (widths := widths_by_name(uncertain, scene)):
            ranges = ranges_to_prove(scene, widths)
        if ranges is not None or section is not None:
            unused: dict[str, object] = {
                "--run": run,
                "--approximation": approximation,
                "--covers": covers,
            }
            unused |= {"--baseline": baseline, "--plot": plot, "--junit": junit, "--github": github}
            unused |= {"--as-model": as_model, "--no-diagnosis": no_diagnosis}
            refuse(unused, "together with --section" if ranges is None else BESIDE_RANGES)
            if ranges is None and candidates:
                advice = "Its passages stand in one file: `foucault score SCENE --transits FILE --section WORD`."
                raise InputError(
                    "CANDIDATE", candidates[0], "no file beside that of --transits", advice
                )
            # as programs in double have them
            read_as = scene if reading else scene.with_values(["inputs=binary64"])
            Judging(naming, {"tolerance": tolerance}).hold(
                candidates, transits, section, ranges or read_as, as_json
            )
            return
    else:
        unused = {
            "SCENE": scene_word,
            "--run": run,
            "--transits": transits,
            "--approximation": approximation,
        }
        unused |= {"--section": section, "--t-end": t_end, "--columns": columns}
        refuse(unused | {"--uncertain": uncertain, "--set": set_ or None}, "together with --suite")
    if covers is not None and not 0 < covers <= 1:
        raise InputError(
            "--covers", f"{covers:g}", "a share of the scene's span, above 0 and up to 1"
        )
    if [*(candidates or ()), transits].count("-") > 1:
        raise InputError(
            "CANDIDATE", "- more than once", "standard input once", "It can be read only once."
        )
    timeout, repeats = (
        TIMEOUT_S if timeout is None else timeout,
        REPEATS if repeats is None else repeats,
    )
    check_positive("--timeout", timeout)
    check_positive("--setting", setting)
    if not 0 <= repeats <= MAX_REPEATS:
        raise InputError("--repeats", repeats, f"a whole number from 0 to {MAX_REPEATS}")
    if plot is not None:
        from ..report.drawing import check_target

        check_target(plot)
    from .experimenting import Runnable

    end = None if t_end is None else float(scene.exact.t_end)
    limits: dict[str, Any] = {"tolerance": tolerance, "covers": covers or 0.0, "t_end": end}
    judging = Judging(
        naming,
        limits | {"inputs": inputs, "as_model": as_model, "explain": not no_diagnosis},
        baseline,
    )
    if suite is not None:
        outcomes = judging.suite(suite, out)
    else:
        times = judging.times(transits) if candidates else None
        outcomes = [judging.file(scene, file, times) for file in candidates or ()]
        if run is not None:
            program = Runnable(scene, run, setting, timeout, out)
            if experiments:
                program.check()
            outcomes.append(
                judging.program(program, name or "the program", transits, repeats, experiments)
            )
        if approximation is not None:
            outcomes.append(judging.approximation(scene, approximation, transits))
        if not outcomes and transits is not None:
            outcomes.append(judging.transits(scene, transits))
        if not outcomes:
            expected = "a file, - for stdin, --run, --transits or --approximation"
            raise InputError("CANDIDATE", "nothing", expected, "Name what is to be scored.")
        if len(outcomes) == 1 and outcomes[0].error is not None and not (github or junit):
            raise outcomes[0].error
    _show(outcomes, as_json, plot, junit, github)
    if suite is not None and out is not None and not as_json:
        typer.echo(f"{out / 'index.html'}: the page; badge.svg is beside it")
    status = max(outcome.exit_status for outcome in outcomes)
    if status:
        raise typer.Exit(status)


def _show(
    outcomes: list[Outcome], as_json: bool, plot: Path | None, junit: Path | None, github: bool
) -> None:
    """Print and write outcomes in the forms that were asked for."""
    from ..report.suite import annotation, append_summary, suite_document, summary, write_junit
    from ..score.document import of_outcome

    scores = [outcome.score for outcome in outcomes if outcome.score is not None]
    if plot is not None and scores:
        from ..report.folder import write_file
        from ..report.plot import error_picture

        write_file(plot, error_picture(scores, plot), "--plot")
    if junit is not None:
        write_junit(outcomes, junit)
    if as_json:
        emit(of_outcome(outcomes[0]) if len(outcomes) == 1 else suite_document(outcomes))
        return
    lines = [line for outcome in outcomes for line in outcome.lines]
    if github:  # nothing in them is a command to it; the annotations are
        token = token_hex()
        lines = [f"::stop-commands::{token}", *lines, f"::{token}::", *map(annotation, outcomes)]
    for line in lines:
        typer.echo(line)
    if github:
        append_summary(summary(outcomes))
