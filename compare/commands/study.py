"""`foucault study`: measure error against run time, of methods or of approximations."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from reference import InputError, Scene, load_scene
from reference.commands.terminal import AsJson, Assignments, SceneWord, progress, stoppable

from .options import announce, finish, inside, listed, numbers, resumes


def command(
    scene_word: SceneWord,
    methods: Annotated[
        str | None, typer.Option("--methods", metavar="A,B,…", help="Ids of methods; by default all.")
    ] = None,
    precisions: Annotated[
        str | None,
        typer.Option(
            "--precisions", metavar="53,113,…", help="Bits: measure run time against digits at these precisions."
        ),
    ] = None,
    approximations: Annotated[
        bool,
        typer.Option(
            "--approximations", help="Study the source papers' approximations instead: where each stops being good."
        ),
    ] = False,
    run: Annotated[
        list[str] | None,
        typer.Option("--run", metavar="'COMMAND'", help="Study your program too; {setting} is its step."),
    ] = None,
    settings: Annotated[
        str, typer.Option("--settings", metavar="0.1,0.01,…", help="Values of {setting} in --run.")
    ] = "0.1,0.01",
    t_end: Annotated[str | None, typer.Option("--t-end", metavar="S", help="End of the run in s.")] = None,
    limit: Annotated[float, typer.Option("--limit", metavar="S", help="Allow one run this many CPU seconds.")] = 8.0,
    no_formulations: Annotated[
        bool, typer.Option("--no-formulations", help="Leave out the comparison of formulations.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write CSV, JSON and an HTML page into this folder.")
    ] = None,
    set_: Assignments = None,
    as_json: AsJson = False,
) -> None:
    """Measure error against run time.

    Every method is run over its settings; with the same --out a study resumes.
    """
    changes = [*(set_ or ()), *([] if t_end is None else [f"run.t_end={t_end}"])]
    scene = load_scene(scene_word, changes)
    if not 0 < limit < float("inf"):
        raise InputError("--limit", f"{limit:g}", "a positive number of seconds")
    if approximations:
        _study_approximations(scene, out, as_json)
        return
    from ..methods import EXTERNAL
    from ..report.study import REPORT
    from ..studies.study import plan
    from ..studies.study import study as measure

    REPORT.check(out)
    problem, digits = scene, None
    items = plan(scene, listed(methods, "--methods"), not no_formulations)
    if precisions is not None:
        from ..studies.precisions import bits_of, precision_items, precision_scene

        bits = bits_of(precisions)
        items = precision_items(bits)
        problem, digits = precision_scene(scene, bits, whole=t_end is not None)
    for program in run or ():
        items += [(f"{EXTERNAL}{program}", "momentum", setting) for setting in numbers(settings, "--settings")]
    with stoppable(resumes(out)), progress(scene.id, unit="runs") as report:
        study = measure(
            problem,
            items=items,
            limit_s=limit,
            journal_path=inside(out, "rows.jsonl"),
            digits=digits,
            report=report,
            announce=announce,
        )
    document = study.document()
    finish(document, REPORT.text, REPORT.write(document, out), as_json)


def _study_approximations(scene: Scene, out: Path | None, as_json: bool) -> None:
    from ..report.approximations import document_of, report_of

    report = report_of(scene)
    report.check(out)
    document = document_of(scene)
    finish(document, report.text, report.write(document, out), as_json)
