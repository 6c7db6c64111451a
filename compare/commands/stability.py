"""`foucault stability`: run the methods on stiff and extreme scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from reference import InputError
from reference.commands.terminal import AsJson, progress, stoppable

from .options import finish, inside, listed, resumes


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
    from ..report.stability import REPORT, document_of
    from ..studies.campaign import declared
    from ..studies.long_runs import long_runs
    from ..studies.stability import stability as measure

    if not 0 < limit < float("inf"):
        raise InputError("--limit", f"{limit:g}", "a positive number of seconds")
    REPORT.check(out)
    chosen, requested = listed(scenes, "--scenes"), listed(methods, "--methods")
    items = declared(requested, "long_runs") if long else []
    with stoppable(resumes(out)), progress("stability", unit="runs") as report:
        cells = measure(chosen, requested, limit_s=limit, journal_path=inside(out, "cells.jsonl"), report=report)
        runs = long_runs(items, journal_path=inside(out, "long.jsonl"), report=report) if items else []
    document = document_of(cells, runs)
    finish(document, REPORT.text, REPORT.write(document, out), as_json)
