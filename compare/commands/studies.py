"""`foucault study`, `stability`, `methods`: error against run time, difficult scenes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import typer

from reference import Scene, load_scene, scene_ids
from reference.commands.layout import echo, facts
from reference.commands.options import Conflict, refuse_conflicts
from reference.commands.progress import progress
from reference.commands.terminal import (
    AsJson,
    Assignments,
    SceneWord,
    emit,
    option,
    replacements,
    stoppable,
)
from reference.system.channel import ACTIVITY

from .options import (
    Commands,
    CommandsOfStability,
    Folder,
    Methods,
    Names,
    announce,
    check_positive,
    completion_of_lists,
    finish,
    listed,
    numbers,
    programs_of,
    resumes,
    scene_named,
)

_WRITING = "writing the report"
LIMIT_S = 8.0  # default of --limit in `study`
STABILITY_LIMIT_S = 3.0  # the same in `stability`
STEPS_S = "0.1,0.01"  # default of --settings
PARIS = "paris"  # the scene with whose values a command is tried for its placeholders
# fields of a scene that make no difference to a study of methods, of precisions, of approximations;
# and why
OF_METHODS = {
    "run.level": "Methods are compared with a confirmed solution, or a dataset that ships.",
    "inputs=decimal": "Methods are given doubles, and compared with the solution for doubles.",
}
OF_PRECISIONS = OF_METHODS | {
    "run.digits": "The truth has as many digits as the finest precision needs."
}
OF_APPROXIMATIONS = dict.fromkeys(
    ("run.level", "run.digits", "run.transits", "run.grid_step"),
    "Approximations are compared with one run, at set times.",
)

PRECISIONS = option(
    "--precisions", "Measure run time against digits at these precisions, in bits.", "53,113,…"
)
APPROXIMATIONS = option(
    "--approximations",
    "Study the source papers' approximations instead: how far each is accurate.",
)
CANDIDATES = option(
    "--candidates", "Also compare the file of a program's output. May be repeated.", "FILE"
)
CPU = option("--cpu", "CPU seconds that each file of --candidates took; - if unknown.", "S,-,…")
SETTINGS = option("--settings", f"Values of {{setting}} in --run (default: {STEPS_S}).", "S,S,…")
T_END = option(
    "--t-end", "End of the run in s (default: the scene's; at most 14400 with --precisions).", "S"
)
LIMIT = option("--limit", f"Allow one run this many CPU seconds (default: {LIMIT_S:g}).", "S")
NO_FORMULATIONS = option("--no-formulations", "Leave out the comparison of formulations.")
SCENES = option(
    "--scenes",
    "Ids of scenes (default: paris and all that have flags).",
    "A,B,…",
    completion_of_lists(scene_ids),
)
STABILITY_LIMIT = option("--limit", "Allow one run this many CPU seconds.", "S")
LONG = option("--long", "Also measure how errors grow over 30 days (takes several minutes more).")


@dataclass(frozen=True)
class StudyOptions:
    """The argument and the options of `foucault study`."""

    scene_word: SceneWord
    methods: Methods = None
    precisions: Annotated[str | None, PRECISIONS] = None
    approximations: Annotated[bool, APPROXIMATIONS] = False
    run: Commands = None
    name: Names = None
    candidates: Annotated[list[str] | None, CANDIDATES] = None
    cpu: Annotated[str | None, CPU] = None
    settings: Annotated[str | None, SETTINGS] = None
    t_end: Annotated[str | None, T_END] = None
    limit: Annotated[float | None, LIMIT] = None
    no_formulations: Annotated[bool, NO_FORMULATIONS] = False
    out: Folder = None
    set_: Assignments = None
    as_json: AsJson = False


@dataclass(frozen=True)
class StabilityOptions:
    """The options of `foucault stability`."""

    scenes: Annotated[str | None, SCENES] = None
    methods: Methods = None
    run: CommandsOfStability = None
    name: Names = None
    limit: Annotated[float, STABILITY_LIMIT] = STABILITY_LIMIT_S
    long: Annotated[bool, LONG] = False
    out: Folder = None
    as_json: AsJson = False


def _varied(options: StudyOptions) -> bool:
    """Return whether a program of --run has a setting that can be varied."""
    from ..candidates.external import SETTING

    return any(SETTING in command for command in options.run or ())


STUDY_CONFLICTS = [
    Conflict(
        "--methods --precisions --run --name --candidates --cpu --settings --limit --no-formulations",
        "together with --approximations",
        lambda options: options.approximations,
    ),
    Conflict("--name --settings", "without --run", lambda options: not options.run),
    Conflict("--cpu", "without --candidates", lambda options: not options.candidates),
    Conflict("--settings", "without {setting} in --run", lambda options: not _varied(options)),
]
STABILITY_CONFLICTS = [
    Conflict("--name", "without --run", lambda options: not options.run),
]


def study(options: StudyOptions) -> None:
    """Measure error against run time.

    Every method is run over its settings, which takes minutes: fewer --methods, --no-formulations,
    a shorter --t-end and a lower --limit save time. With the same --out a study resumes.
    """
    scene = _scene(options)
    refuse_conflicts(options, STUDY_CONFLICTS)
    if options.approximations:
        _study_approximations(scene, options)
    else:
        _study_methods(scene, options)


def _scene(options: StudyOptions) -> Scene:
    """Return the scene of a study.

    Raises:
        InputError: the scene does not exist, or `--set` replaces a field that has no effect.
    """
    if options.approximations:
        unused = OF_APPROXIMATIONS
    elif options.precisions is not None:
        unused = OF_PRECISIONS
    else:
        unused = OF_METHODS
    fields = {"--t-end": ("run.t_end", options.t_end)}
    return scene_named(options.scene_word, replacements(options.set_, fields, unused))


def _study_methods(scene: Scene, options: StudyOptions) -> None:
    check_positive("--limit", options.limit)
    from ..candidates.external import SETTING
    from ..report.study_page import REPORT
    from ..studies.row import UNKNOWN
    from ..studies.study import study as measured
    from ..studies.study_plan import bits_of, plan, precision_items, precision_scene
    from ..studies.users_program import files_of

    REPORT.check(options.out)
    requested = listed(options.methods, "--methods")
    if options.precisions is None:
        problem = scene
        digits = None
        items = plan(scene, requested, not options.no_formulations)
    else:
        bits = bits_of(options.precisions)
        items = precision_items(bits, requested)
        problem, digits = precision_scene(scene, bits, whole=options.t_end is not None)

    programs = programs_of(options.run, options.name, problem)
    files = files_of(options.candidates or (), options.cpu, programs)
    steps_s = numbers(STEPS_S if options.settings is None else options.settings, "--settings")
    for program, command in programs.items():
        settings = steps_s if SETTING in command else [0.0]
        items += [(program, UNKNOWN, setting) for setting in settings]

    with stoppable(resumes(options.out)), progress() as show:
        done = measured(
            problem,
            items=items,
            programs=programs,
            candidates=files,
            limit_s=LIMIT_S if options.limit is None else options.limit,
            journal_path=options.out and options.out / "rows.jsonl",
            digits=digits,
            solving=show(f"the truth of {scene.id}", float(problem.exact.t_end)),
            report=show(scene.id, unit="runs"),
            announce=announce,
        )
        ACTIVITY.send(_WRITING)
        document = done.document()
        page = REPORT.write(document, options.out)
    finish(document, REPORT.text, page, options.as_json)


def _study_approximations(scene: Scene, options: StudyOptions) -> None:
    with stoppable("nothing was kept"), progress() as show:
        from ..report.approximations import Swept, document_of, report_of

        swept: Swept = {}
        report = report_of(scene, swept)
        report.check(options.out)
        document = document_of(scene, swept, show(scene.id, unit="tables"))
        ACTIVITY.send(_WRITING)
        page = report.write(document, options.out)
    finish(document, report.text, page, options.as_json)


def stability(options: StabilityOptions) -> None:
    """Run methods, and your program, on the difficult scenes.

    Prints how many runs of each method failed, and of your program the digits kept on each scene.
    --out and --json have all runs; with the same --out a study resumes.
    """
    refuse_conflicts(options, STABILITY_CONFLICTS)
    from ..report.stability_page import REPORT, document_of
    from ..studies.campaign import Reports
    from ..studies.long_runs import long_runs
    from ..studies.stability import stability as measured
    from ..studies.study_plan import declared

    check_positive("--limit", options.limit)
    REPORT.check(options.out)
    scenes = listed(options.scenes, "--scenes")
    requested = listed(options.methods, "--methods")
    programs = programs_of(options.run, options.name, load_scene(PARIS))
    items = declared(requested, "long_runs") if options.long else []

    with stoppable(resumes(options.out)), progress() as show:
        cells = measured(
            scenes,
            requested,
            programs=programs,
            limit_s=options.limit,
            journal_path=options.out and options.out / "cells.jsonl",
            reports=Reports(show("the truth", unit="scenes"), show("stability", unit="runs")),
        )
        runs = []
        if items:
            days = show("the truth over 30 days", unit="days")
            runs = long_runs(
                items,
                journal_path=options.out and options.out / "long.jsonl",
                reports=Reports(days, show("30 days", unit="runs")),
            )
        ACTIVITY.send(_WRITING)
        document = document_of(cells, runs, programs)
        page = REPORT.write(document, options.out)
    finish(document, REPORT.text, page, options.as_json)


def methods(as_json: AsJson = False) -> None:
    """List the integrators and approximations that are compared."""
    from ..approximations import APPROXIMATIONS
    from ..methods import METHODS
    from ..methods.method import available

    integrators = [
        {
            "id": method.id,
            "title": method.title,
            "setting": method.setting,
            "missing": available(method),
        }
        for method in METHODS.values()
    ]
    analytic: list[dict[str, str | None]] = [
        {"id": each.id, "title": each.title} for each in APPROXIMATIONS.values()
    ]
    if as_json:
        emit({"methods": integrators, "approximations": analytic})
        return
    _print_ids("Methods (study, stability)", integrators)
    _print_ids("Approximations (score --approximation, study --approximations)", analytic)


def _print_ids(heading: str, entries: Sequence[Mapping[str, str | None]]) -> None:
    """Print ids with their titles, and what is not installed that one needs."""
    typer.echo(f"{heading}:")
    pairs = []
    for entry in entries:
        missing = f" [{entry['missing']}]" if entry.get("missing") else ""
        pairs.append((str(entry["id"]), f"{entry['title']}{missing}"))
    echo(facts(pairs))
