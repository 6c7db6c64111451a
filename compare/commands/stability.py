"""`foucault stability`: every method on stiff and extreme scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from reference import InputError, scene_ids
from reference.commands.terminal import AsJson, emit

from .options import counting, inside, listed


def command(
    scenes: Annotated[
        str | None, typer.Option("--scenes", metavar="A,B,…", help="Ids; all with flags by default.")
    ] = None,
    methods: Annotated[str | None, typer.Option("--methods", metavar="A,B,…", help="Ids; all by default.")] = None,
    limit: Annotated[float, typer.Option("--limit", metavar="S", help="CPU seconds of one run.")] = 3.0,
    long: Annotated[
        bool, typer.Option("--long", help="Also the growth of errors over 30 days (minutes more).")
    ] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="CSV, JSON and an HTML page.")] = None,
    as_json: AsJson = False,
) -> None:
    """Every method on stiff and extreme scenes: digits kept, or how it failed; resumes with the same --out."""
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
    wanted = listed(methods, "--methods", METHODS)
    with counting("stability") as report:
        cells = measure(chosen, wanted, limit_s=limit, journal_path=inside(out, "cells.jsonl"), report=report)
        runs = over_thirty_days(wanted, journal_path=inside(out, "long.jsonl"), report=report) if long else []
    made = stability_report.document(cells, runs, machine())
    if out is not None:
        stability_report.write(made, cells, runs, out)
    if as_json:
        emit(made)
        return
    typer.echo(stability_report.text_table(cells, runs))
    if out is not None:
        typer.echo(f"{out / PAGE}: the report")
