"""`foucault stability`: run the methods on stiff and extreme scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from reference import InputError, scene_ids
from reference.commands.terminal import AsJson, emit

from .options import counting, inside, listed


def command(
    scenes: Annotated[
        str | None, typer.Option("--scenes", metavar="A,B,…", help="Ids of scenes; by default all that have flags.")
    ] = None,
    methods: Annotated[
        str | None, typer.Option("--methods", metavar="A,B,…", help="Ids of methods; by default all.")
    ] = None,
    limit: Annotated[float, typer.Option("--limit", metavar="S", help="Allow one run this many CPU seconds.")] = 3.0,
    long: Annotated[
        bool, typer.Option("--long", help="Also measure how errors grow over 30 days (takes minutes more).")
    ] = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write CSV, JSON and an HTML page into this folder.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Run methods on the difficult scenes.

    For each: digits kept, or the way it failed; with the same --out a study resumes.
    """
    from ..methods import METHODS
    from ..report import stability as stability_report
    from ..report.folder import PAGE, check_folder
    from ..studies.long_runs import over_thirty_days
    from ..studies.stability import default_scenes
    from ..studies.stability import stability as measure
    from ..studies.study import machine, single_thread

    if not 0 < limit < float("inf"):
        raise InputError("--limit", f"{limit:g}", "a positive number of seconds")
    if out is not None:
        check_folder(out, stability_report.FILES)
    single_thread()
    chosen = listed(scenes, "--scenes", scene_ids()) or default_scenes()
    requested = listed(methods, "--methods", METHODS)
    with counting("stability") as report:
        cells = measure(chosen, requested, limit_s=limit, journal_path=inside(out, "cells.jsonl"), report=report)
        runs = over_thirty_days(requested, journal_path=inside(out, "long.jsonl"), report=report) if long else []
    document = stability_report.document(cells, runs, machine())
    if out is not None:
        stability_report.write(document, cells, runs, out)
    if as_json:
        emit(document)
        return
    typer.echo(stability_report.text_table(cells, runs))
    if out is not None:
        typer.echo(f"{out / PAGE}: the report")
