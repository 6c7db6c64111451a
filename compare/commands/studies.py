"""`foucault study`, `stability` and `methods`: error against run time, difficult scenes, and what can be compared."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from reference import Scene, load_scene, scene_ids
from reference.commands.progress import progress
from reference.commands.terminal import (
    AsJson,
    Assignments,
    SceneWord,
    emit,
    option,
    refuse,
    replacements,
    stoppable,
)

from .options import (
    Commands,
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
)

LIMIT_S, STEPS_S = 8.0, "0.1,0.01"  # defaults of --limit and --settings
STABILITY_LIMIT_S = 3.0  # default of --limit in `stability`
PARIS = "paris"  # the scene with whose values a command is tried for its placeholders
# fields of a scene that make no difference to a study of these, and why
OF_METHODS = {
    "run.level": "Methods are held against a confirmed solution, or a dataset that ships.",
    "inputs=decimal": "Methods are given doubles, and are held against the solution for doubles.",
}
OF_PRECISIONS = OF_METHODS | {
    "run.digits": "The truth has as many digits as the finest precision needs."
}
OF_APPROXIMATIONS = dict.fromkeys(
    ("run.level", "run.digits", "run.transits", "run.grid_step"),
    "Approximations are held against one run, at set times.",
)

PRECISIONS = option(
    "--precisions", "Bits: measure run time against digits at these precisions.", "53,113,…"
)
APPROXIMATIONS = option(
    "--approximations",
    "Study the source papers' approximations instead: where each stops being good.",
)
CANDIDATES = option(
    "--candidates", "Put a file of somebody's output beside the methods. May be repeated.", "FILE"
)
CPU = option(
    "--cpu", "CPU seconds that each file of --candidates took; - where nobody knows.", "S,-,…"
)
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
LONG = option("--long", "Also measure how errors grow over 30 days (takes minutes more).")


def study(
    scene_word: SceneWord,
    methods: Methods = None,
    precisions: Annotated[str | None, PRECISIONS] = None,
    approximations: Annotated[bool, APPROXIMATIONS] = False,
    run: Commands = None,
    name: Names = None,
    candidates: Annotated[list[str] | None, CANDIDATES] = None,
    cpu: Annotated[str | None, CPU] = None,
    settings: Annotated[str | None, SETTINGS] = None,
    t_end: Annotated[str | None, T_END] = None,
    limit: Annotated[float | None, LIMIT] = None,
    no_formulations: Annotated[bool, NO_FORMULATIONS] = False,
    out: Folder = None,
    set_: Assignments = None,
    as_json: AsJson = False,
) -> None:
    """Measure error against run time.

    Every method is run over its settings; with the same --out a study resumes.
    """
    unused = (
        OF_APPROXIMATIONS
        if approximations
        else OF_PRECISIONS
        if precisions is not None
        else OF_METHODS
    )
    scene = load_scene(scene_word, replacements(set_, {"--t-end": ("run.t_end", t_end)}, unused))
    if approximations:
        options: dict[str, object] = {
            "--methods": methods,
            "--precisions": precisions,
            "--run": run,
            "--name": name,
        }
        options |= {
            "--candidates": candidates,
            "--cpu": cpu,
            "--settings": settings,
            "--limit": limit,
        }
        refuse({**options, "--no-formulations": no_formulations}, "together with --approximations")
        _study_approximations(scene, out, as_json)
        return
    if not run:
        refuse({"--settings": settings}, "without --run")
    if not candidates:
        refuse({"--cpu": cpu}, "without --candidates")
    check_positive("--limit", limit)
    from ..candidates.external import SETTING
    from ..report.study_page import REPORT
    from ..studies.study import study as measured
    from ..studies.study_plan import bits_of, plan, precision_items, precision_scene
    from ..studies.users_program import files_of

    REPORT.check(out)
    problem, digits = scene, None
    requested = listed(methods, "--methods")
    if precisions is None:
        items = plan(scene, requested, not no_formulations)
    else:
        bits = bits_of(precisions)
        items = precision_items(bits, requested)
        problem, digits = precision_scene(scene, bits, whole=t_end is not None)
    programs = programs_of(run, name, problem)
    if not any(SETTING in program for program in programs.values()):
        refuse({"--settings": settings}, f"with a --run that has no {SETTING}")
    files = files_of(candidates or (), cpu, programs)
    steps = numbers(STEPS_S if settings is None else settings, "--settings")
    for program, words in programs.items():
        items += [(program, "momentum", step) for step in (steps if SETTING in words else [0.0])]
    with stoppable(resumes(out)), progress() as show:
        done = measured(
            problem,
            items=items,
            programs=programs,
            candidates=files,
            limit_s=LIMIT_S if limit is None else limit,
            journal_path=out and out / "rows.jsonl",
            digits=digits,
            solving=show(f"the truth of {scene.id}", float(problem.exact.t_end)),
            report=show(scene.id, unit="runs"),
            announce=announce,
        )
    document = done.document()
    finish(document, REPORT.text, REPORT.write(document, out), as_json)


def _study_approximations(scene: Scene, out: Path | None, as_json: bool) -> None:
    with stoppable("nothing was kept"), progress() as show:
        from ..report.approximations import Swept, document_of, report_of

        swept: Swept = {}
        report = report_of(scene, swept)
        report.check(out)
        document = document_of(scene, swept, show(scene.id, unit="tables"))
    finish(document, report.text, report.write(document, out), as_json)


def stability(
    scenes: Annotated[str | None, SCENES] = None,
    methods: Methods = None,
    run: Commands = None,
    name: Names = None,
    limit: Annotated[float, STABILITY_LIMIT] = STABILITY_LIMIT_S,
    long: Annotated[bool, LONG] = False,
    out: Folder = None,
    as_json: AsJson = False,
) -> None:
    """Run methods, and your program, on the difficult scenes.

    For each: digits kept, or the way it failed; with the same --out a study resumes.
    """
    from ..report.stability_page import REPORT, document_of
    from ..studies.long_runs import long_runs
    from ..studies.stability import stability as measured
    from ..studies.study_plan import declared

    check_positive("--limit", limit)
    REPORT.check(out)
    chosen, requested = listed(scenes, "--scenes"), listed(methods, "--methods")
    programs = programs_of(run, name, load_scene(PARIS))
    items = declared(requested, "long_runs") if long else []
    with stoppable(resumes(out)), progress() as show:
        cells = measured(
            chosen,
            requested,
            programs=programs,
            limit_s=limit,
            journal_path=out and out / "cells.jsonl",
            solving=show("the truth", unit="scenes"),
            report=show("stability", unit="runs"),
        )
        runs = []
        if items:
            solving, report = (
                show("the truth over 30 days", unit="days"),
                show("30 days", unit="runs"),
            )
            runs = long_runs(
                items, journal_path=out and out / "long.jsonl", solving=solving, report=report
            )
    document = document_of(cells, runs, programs)
    finish(document, REPORT.text, REPORT.write(document, out), as_json)


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
    width = max(map(len, (*METHODS, *APPROXIMATIONS)))
    headings = (
        "Methods (study, stability)",
        "Approximations (score --approximation, study --approximations)",
    )
    for heading, listed_there in zip(headings, (integrators, analytic), strict=True):
        typer.echo(f"{heading}:")
        for each in listed_there:
            missing = f"  [{each['missing']}]" if each.get("missing") else ""
            typer.echo(f"  {each['id']:{width}}  {each['title']}{missing}")
