"""`foucault stability`: run the methods on stiff and extreme scenes."""

from __future__ import annotations

from typing import Annotated

from reference import load_scene, scene_ids
from reference.commands.progress import progress
from reference.commands.terminal import AsJson, option, stoppable

from .options import (
    Commands,
    Folder,
    Methods,
    Names,
    check_limit,
    completion_of_lists,
    finish,
    listed,
    programs_of,
    resumes,
)

LIMIT_S = 3.0  # default of --limit
PARIS = "paris"  # the scene with whose values a command is tried for its placeholders


SCENES = option(
    "--scenes", "Ids of scenes (default: paris and all that have flags).", "A,B,…", completion_of_lists(scene_ids)
)
LIMIT = option("--limit", "Allow one run this many CPU seconds.", "S")
LONG = option("--long", "Also measure how errors grow over 30 days (takes minutes more).")


def command(
    scenes: Annotated[str | None, SCENES] = None,
    methods: Methods = None,
    run: Commands = None,
    name: Names = None,
    limit: Annotated[float, LIMIT] = LIMIT_S,
    long: Annotated[bool, LONG] = False,
    out: Folder = None,
    as_json: AsJson = False,
) -> None:
    """Run methods, and your program, on the difficult scenes.

    For each: digits kept, or the way it failed; with the same --out a study resumes.
    """
    from ..report.stability_page import REPORT, document_of
    from ..studies.long_runs import long_runs
    from ..studies.stability import stability as measure
    from ..studies.study_plan import declared

    check_limit(limit)
    REPORT.check(out)
    chosen, requested = listed(scenes, "--scenes"), listed(methods, "--methods")
    programs = programs_of(run, name, load_scene(PARIS))
    items = declared(requested, "long_runs") if long else []
    with stoppable(resumes(out)), progress() as show:
        cells = measure(
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
            solving, report = show("the truth over 30 days", unit="days"), show("30 days", unit="runs")
            runs = long_runs(items, journal_path=out and out / "long.jsonl", solving=solving, report=report)
    document = document_of(cells, runs, programs)
    finish(document, REPORT.text, REPORT.write(document, out), as_json)
