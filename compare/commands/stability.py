"""`foucault stability`: run the methods on stiff and extreme scenes."""

from __future__ import annotations

from typing import Annotated

import typer

from reference import load_scene
from reference.commands.progress import progress
from reference.commands.terminal import AsJson, refuse, stoppable

from .options import (
    Commands,
    Folder,
    Methods,
    Names,
    Scenes,
    check_installed,
    check_limit,
    finish,
    inside,
    listed,
    resumes,
)

LIMIT_S = 3.0  # default of --limit
PARIS = "paris"  # the scene with whose values a command is tried for its placeholders


def command(
    scenes: Scenes = None,
    methods: Methods = None,
    run: Commands = None,
    name: Names = None,
    limit: Annotated[
        float, typer.Option("--limit", metavar="S", help="Allow one run this many CPU seconds.")
    ] = LIMIT_S,
    long: Annotated[
        bool, typer.Option("--long", help="Also measure how errors grow over 30 days (takes minutes more).")
    ] = False,
    out: Folder = None,
    as_json: AsJson = False,
) -> None:
    """Run methods, and your program, on the difficult scenes.

    For each: digits kept, or the way it failed; with the same --out a study resumes.
    """
    from ..candidates.external import arguments
    from ..methods import SETTING, named_programs
    from ..report.stability_page import REPORT, document_of
    from ..studies.campaign import declared
    from ..studies.long_runs import long_runs
    from ..studies.stability import stability as measure

    check_limit(limit)
    REPORT.check(out)
    chosen, requested = listed(scenes, "--scenes"), listed(methods, "--methods")
    if run:
        programs = named_programs(run, name or ())
        for word in programs.values():
            arguments(word.replace(SETTING, "0.1"), load_scene(PARIS))  # refuses one that cannot be run before any work
    else:
        refuse({"--name": name}, "without --run")
        programs = {}
        check_installed(method for method, _, _ in declared(requested, "stability"))
    items = declared(requested, "long_runs") if long else []
    with stoppable(resumes(out)), progress() as show:
        cells = measure(
            chosen,
            requested,
            programs=programs,
            limit_s=limit,
            journal_path=inside(out, "cells.jsonl"),
            solving=show("the truth", unit="scenes"),
            report=show("stability", unit="runs"),
        )
        runs = []
        if items:
            solving, report = show("the truth over 30 days", unit="days"), show("30 days", unit="runs")
            runs = long_runs(items, journal_path=inside(out, "long.jsonl"), solving=solving, report=report)
    document = document_of(cells, runs, programs)
    finish(document, REPORT.text, REPORT.write(document, out), as_json)
