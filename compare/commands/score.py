"""`foucault score`: judge one or more candidates against the truth of a scene."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from secrets import token_hex
from typing import TYPE_CHECKING, Annotated

import typer

from reference import InputError
from reference.commands.options import Conflict, as_command, refuse_conflicts
from reference.commands.terminal import (
    BESIDE_RANGES,
    AsJson,
    Assignments,
    Uncertain,
    chosen,
    completion,
    emit,
    option,
    replacements,
    scene_argument,
    widths_by_name,
)
from reference.errors import NOTHING, Described

from .options import announce, check_positive, listed, scene_named

if TYPE_CHECKING:
    from reference import Ranges, Scene

    from ..candidates.names import Naming
    from ..score.verdict import Outcome
    from .judging import Judging

MAX_REPEATS = 1000
TIMEOUT_S = 600.0  # default of --timeout
REPEATS = 3  # default of --repeats

_FIELDS_WITHOUT_EFFECT = {
    "run.level": "A candidate is compared with a confirmed solution, or a dataset that ships.",
    "inputs=decimal": "Write --inputs decimal: without it doubles are compared with doubles.",
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


@dataclass(frozen=True)
class ScoreOptions:
    """The options of `foucault score`, with the scene or the ranges that they name."""

    scene_word: Annotated[
        str | None,
        scene_argument("A scene's id, or the path of a TOML file; not with --suite."),
    ] = None
    candidates: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="CANDIDATE",
            help="Files: text with named columns, .npy, .npz; - is stdin.",
        ),
    ] = None
    suite: Annotated[
        Path | None,
        option("--suite", "Score a folder of files named after scenes: paris.csv.", "DIR"),
    ] = None
    how: Annotated[
        str | None,
        option(
            "--how",
            "Print how to write such a file in c, fortran, python …",
            "LANGUAGE",
            callback=_how,
            is_eager=True,
        ),
    ] = None
    columns: Annotated[
        str | None,
        option("--columns", "A file's columns in order; - skips one.", "t,x,y,…"),
    ] = None
    units: Annotated[
        str | None,
        option("--units", "Units of times and lengths: ms,cm (default: s,m).", "A,B"),
    ] = None
    transits: Annotated[
        str | None,
        option(
            "--transits",
            "Also (or only) score times of xdot = 0: column t.",
            "FILE",
        ),
    ] = None
    section: Annotated[
        str | None,
        option("--section", "Take --transits as passages of this section: 'gate 30'.", "WORD"),
    ] = None
    run: Annotated[
        str | None,
        option("--run", "Run this program and score its output.", "'COMMAND'"),
    ] = None
    name: Annotated[
        str | None,
        option(
            "--name",
            "Name of the program of --run (default: the program).",
            "WORD",
            hidden=True,
        ),
    ] = None
    setting: Annotated[
        float | None,
        option("--setting", "{setting} in --run, in s (default: 200 a period, or more).", "S"),
    ] = None
    experiments: Annotated[
        bool,
        option("--experiments", "Run it up to eight more times, to explain its error."),
    ] = False
    approximation: Annotated[
        str | None,
        option(
            "--approximation",
            "Score one of the source papers' approximations, which `foucault methods` lists.",
            "ID",
            completion(_approximation_ids),
            hidden=True,
        ),
    ] = None
    baseline: Annotated[
        str | None,
        option(
            "--baseline",
            "Report changes since an earlier version: its file, --json document, command or suite.",
            "FILE",
        ),
    ] = None
    tolerance: Annotated[
        float | None,
        option(
            "--tolerance",
            "Allow errors up to this, in m (default: 1e-6 of the amplitude).",
            "M",
        ),
    ] = None
    covers: Annotated[
        float | None,
        option("--covers", "Require rows to this share of the span (default: any).", "SHARE"),
    ] = None
    t_end: Annotated[
        str | None,
        option("--t-end", "Ignore rows after this time, in s (default: the scene's).", "S"),
    ] = None
    inputs: Annotated[
        str,
        option(
            "--inputs",
            "Read the scene as decimal or binary64; auto: by the file.",
            "READING",
            completion(_readings),
        ),
    ] = "auto"
    plot: Annotated[
        Path | None,
        option("--plot", "Draw error against time: .svg, .png or .pdf.", "FILE"),
    ] = None
    timeout: Annotated[
        float | None,
        option("--timeout", f"Stop --run after this many seconds (default: {TIMEOUT_S:g}).", "S"),
    ] = None
    repeats: Annotated[
        int | None,
        option(
            "--repeats",
            f"Time the program of --run this often after a warm-up (default: {REPEATS}).",
            "N",
            hidden=True,
        ),
    ] = None
    as_model: Annotated[
        bool,
        option("--as-model", "Accept agreement with a named simpler model."),
    ] = False
    no_diagnosis: Annotated[
        bool,
        option("--no-diagnosis", "Do not look for the reasons of an error."),
    ] = False
    set_: Assignments = None
    uncertain: Uncertain = None
    out: Annotated[
        Path | None,
        option(
            "--out",
            "With --suite: write a page and tables into this folder; with --experiments: the outputs.",
            "DIR",
        ),
    ] = None
    junit: Annotated[
        Path | None,
        option("--junit", "Write the outcome as JUnit XML, a test for each.", "FILE"),
    ] = None
    github: Annotated[
        bool,
        option("--github", "Annotate for GitHub Actions; write the job's summary."),
    ] = False
    as_json: AsJson = False

    @property
    def reading(self) -> str | None:
        """How the inputs of the scene are read; None if the candidate decides."""
        return None if self.inputs == "auto" else self.inputs

    @cached_property
    def named_ranges(self) -> Ranges | None:
        """The ranges that SCENE names; None if it names a scene, or if --suite is given.

        Raises:
            InputError: they cannot be read.
        """
        from .measuring import ranges_named

        return ranges_named(self.scene_word) if self.suite is None else None

    @cached_property
    def scene(self) -> Scene:
        """The scene that SCENE names, with the values of --set, --t-end and --inputs.

        Raises:
            InputError: no scene is named, it cannot be read, or a value is wrong.
        """
        if self.scene_word is None:
            raise InputError(
                "SCENE", NOTHING, "a scene's id, or --suite DIR", "`foucault scenes` lists the ids."
            )
        if self.named_ranges is not None:
            return self.named_ranges.scene
        fields = {"--t-end": ("run.t_end", self.t_end), "--inputs": ("inputs", self.reading)}
        chosen_values = replacements(self.set_, fields, _FIELDS_WITHOUT_EFFECT, announce)
        return scene_named(self.scene_word, chosen_values)

    @cached_property
    def ranges(self) -> Ranges | None:
        """The ranges that SCENE names, or that --uncertain or the scene asks for; None if all inputs are exact.

        Raises:
            InputError: the scene cannot be read, or a width.
        """
        from .measuring import ranges_to_prove

        if self.suite is not None or self.named_ranges is not None:
            return self.named_ranges
        widths = widths_by_name(self.uncertain, self.scene)
        return ranges_to_prove(self.scene, widths) if widths else None


# ranges and the passages of sections are compared without a verdict on a trajectory
_OF_VERDICTS = (
    "--run --approximation --covers --baseline --plot --junit --github --as-model --no-diagnosis"
)

# in the order in which they are reported
_CONFLICTS = [
    Conflict(
        "--as-model --experiments",
        "together with --no-diagnosis",
        lambda typed: typed.no_diagnosis,
    ),
    Conflict("--github", "together with --json", lambda typed: typed.as_json),
    Conflict(
        "--timeout --repeats --name --setting --experiments",
        "without --run",
        lambda typed: typed.run is None,
    ),
    Conflict(
        "--baseline",
        "without a file, --run or --suite",
        lambda typed: not (typed.candidates or typed.run or typed.suite),
    ),
    Conflict(
        "SCENE --run --transits --approximation --section --t-end --columns --uncertain --set",
        "together with --suite",
        lambda typed: typed.suite is not None,
    ),
    Conflict(
        "--out",
        "without --suite or --experiments",
        lambda typed: typed.suite is None and not typed.experiments,
    ),
    Conflict(
        "--uncertain --set --t-end --inputs",
        "with ranges",
        lambda typed: typed.named_ranges is not None,
    ),
    Conflict(
        _OF_VERDICTS,
        BESIDE_RANGES,
        lambda typed: typed.ranges is not None,
    ),
    Conflict(
        _OF_VERDICTS,
        "together with --section",
        lambda typed: typed.section is not None,
    ),
    Conflict(
        "--section",
        "without --transits",
        # beside a file of rows, `_compare_passages` says how passages are scored
        lambda typed: typed.transits is None and (typed.ranges is not None or not typed.candidates),
    ),
]


def _score(options: ScoreOptions) -> None:
    """Score a program's output against the truth.

    --run fills in {x0}, {latitude}, {t_end} … of the scene: see docs/commands.md, also on
    --approximation, --name, --repeats and ranges. Exit status 0: agrees (with --baseline: no worse),
    1: disagrees, 2: cannot be judged.
    """
    naming = _naming(options)
    chosen("--inputs", options.inputs, _readings())
    check_positive("--tolerance", options.tolerance, "metres")
    refuse_conflicts(options, _CONFLICTS)
    _check_standard_input(options)
    if options.ranges is not None:
        _compare_with_ranges(options, options.ranges, naming)
        return
    if options.section is not None:
        _compare_passages(options, naming)
        return

    _check_values(options)
    judging = _judging(options, naming)
    if options.suite is not None:
        outcomes = judging.suite(options.suite, options.out)
    else:
        outcomes = _outcomes_of_scene(options, judging)
    _show(outcomes, options)

    status = max(outcome.exit_status for outcome in outcomes)
    if status:
        raise typer.Exit(status)


command = as_command(ScoreOptions, _score)


def _naming(options: ScoreOptions) -> Naming:
    """Return what --columns and --units say of a file's columns."""
    from ..candidates.names import Naming

    columns = listed(options.columns, "--columns") or ()
    units = listed(options.units, "--units") or ()
    return Naming(tuple(columns), tuple(units))


def _check_standard_input(options: ScoreOptions) -> None:
    """Refuse a second use of standard input.

    Raises:
        InputError: `-` stands for more than one file.
    """
    files = [*(options.candidates or ()), options.transits]
    if files.count("-") > 1:
        got = Described("- more than once")
        raise InputError("CANDIDATE", got, "- once", "Standard input can be read only once.")


def _check_values(options: ScoreOptions) -> None:
    """Refuse values that are out of range, and a picture that cannot be written."""
    covers = options.covers
    if covers is not None and not 0 < covers <= 1:
        expected = "a share of the scene's span, above 0 and up to 1"
        raise InputError("--covers", f"{covers:g}", expected)

    check_positive("--timeout", options.timeout)
    check_positive("--setting", options.setting)
    if options.repeats is not None and not 0 <= options.repeats <= MAX_REPEATS:
        raise InputError("--repeats", options.repeats, f"a whole number from 0 to {MAX_REPEATS}")

    if options.plot is not None:
        from ..report.drawing import check_target

        check_target(options.plot)


def _judging(options: ScoreOptions, naming: Naming) -> Judging:
    """Return what judges every candidate of the command."""
    from ..score.judge import JudgeOptions
    from .judging import Judging

    limits = JudgeOptions(
        tolerance_m=options.tolerance,
        inputs=options.inputs,
        t_end_s=None if options.t_end is None else float(options.scene.exact.t_end),
        covers=options.covers or 0.0,
        as_model=options.as_model,
        explain=not options.no_diagnosis,
    )
    return Judging(naming, limits, options.baseline)


def _outcomes_of_scene(options: ScoreOptions, judging: Judging) -> list[Outcome]:
    """Judge the files, the program and the approximation that are given for one scene.

    Raises:
        InputError: there is no candidate.
        FoucaultError: the only one cannot be judged, and no report has to say so.
    """
    outcomes = list(_outcomes(options, judging))
    if not outcomes:
        expected = "a file, - for stdin, --run, --transits or --approximation"
        raise InputError("CANDIDATE", NOTHING, expected, "Say what to score.")

    error = outcomes[0].error
    is_reported = options.github or options.junit
    if len(outcomes) == 1 and error is not None and not is_reported:
        raise error
    return outcomes


def _outcomes(options: ScoreOptions, judging: Judging) -> Iterator[Outcome]:
    """Judge one candidate after the other; transits are one of their own only if they are alone."""
    scene = options.scene
    transits = options.transits
    if options.candidates:
        times = judging.times(transits)
        for file in options.candidates:
            yield judging.file(scene, file, times)

    if options.run is not None:
        yield _outcome_of_program(options, judging, options.run)

    if options.approximation is not None:
        yield judging.approximation(scene, options.approximation, transits)

    is_alone = not options.candidates and options.run is None and options.approximation is None
    if is_alone and transits is not None:
        yield judging.transits(scene, transits)


def _outcome_of_program(options: ScoreOptions, judging: Judging, run: str) -> Outcome:
    """Run a program by its command and judge its output; tell the step that is chosen for it."""
    from ..candidates.external import SETTING, STEPS
    from .experimenting import Runnable

    timeout_s = TIMEOUT_S if options.timeout is None else options.timeout
    repeats = REPEATS if options.repeats is None else options.repeats
    program = Runnable(options.scene, run, options.setting, timeout_s, options.out)
    if options.experiments:
        program.check()
    if options.setting is None and SETTING in run:
        announce(f"{SETTING} is {program.step:.6g} s: {STEPS} steps a period, or more (--setting)")
    name = options.name or "the program"
    return judging.program(program, name, options.transits, repeats, options.experiments)


def _show(outcomes: list[Outcome], options: ScoreOptions) -> None:
    """Print and write outcomes in the forms that were asked for."""
    from ..report.suite import suite_document, write_junit
    from ..score.document import of_outcome

    if options.plot is not None:
        _draw(outcomes, options.plot)
    if options.junit is not None:
        write_junit(outcomes, options.junit)

    if options.as_json:
        emit(of_outcome(outcomes[0]) if len(outcomes) == 1 else suite_document(outcomes))
        return
    _print_lines(outcomes, options.github)
    if options.suite is not None and options.out is not None:
        typer.echo(f"{options.out / 'index.html'}: the page; badge.svg is beside it")


def _draw(outcomes: list[Outcome], target: Path) -> None:
    """Draw the errors of the candidates that were judged, if any was."""
    from ..report.folder import write_file
    from ..report.plot import error_picture

    scores = [outcome.score for outcome in outcomes if outcome.score is not None]
    if scores:
        write_file(target, error_picture(scores, target), "--plot")


def _print_lines(outcomes: list[Outcome], github: bool) -> None:
    """Print the lines for people; for GitHub Actions with annotations, and a summary of the job."""
    from ..report.suite import annotation, append_summary, summary

    lines = [line for outcome in outcomes for line in outcome.lines]
    if github:
        # GitHub takes no line between these marks for a command; the annotations after them are
        token = token_hex()
        annotations = map(annotation, outcomes)
        lines = [f"::stop-commands::{token}", *lines, f"::{token}::", *annotations]
    for line in lines:
        typer.echo(line)
    if github:
        append_summary(summary(outcomes))


def _compare_with_ranges(options: ScoreOptions, ranges: Ranges, naming: Naming) -> None:
    """Compare files, or times alone, with what is proved for uncertain inputs, and print the scores.

    Raises:
        InputError: there is nothing to compare.
    """
    from .measuring import compare_with_ranges, passages_of, print_scores

    files = options.candidates or []
    if not files and options.transits is None:
        expected = "a file, - for stdin, or --transits"
        raise InputError("CANDIDATE", NOTHING, expected, "Say where the measurements are.")

    passages = None
    if options.transits is not None:
        passages = passages_of(options.transits, options.section, ranges.scene, naming)
    tolerance_m = options.tolerance or 0.0
    scores = compare_with_ranges(files, passages, ranges, tolerance_m, naming)
    print_scores(scores, options.as_json)


def _compare_passages(options: ScoreOptions, naming: Naming) -> None:
    """Compare passages of a section with those of the scene, and print the score.

    Raises:
        InputError: there is a file of rows as well.
    """
    from .measuring import compare_passages, passages_of, print_scores

    if options.candidates:
        raise InputError(
            "CANDIDATE",
            options.candidates[0],
            "the file of --transits alone",
            "Put all passages into one file: "
            "`foucault score SCENE --transits FILE --section WORD`.",
        )
    scene = options.scene
    if options.reading is None:
        # the program that printed the passages most likely took the inputs as doubles
        scene = scene.with_values(["inputs=binary64"])

    assert options.transits is not None  # else --section was refused
    passages = passages_of(options.transits, options.section, scene, naming)
    print_scores([compare_passages(passages, scene, options.tolerance)], options.as_json)
