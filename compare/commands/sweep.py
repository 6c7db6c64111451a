"""`foucault sweep`: many pendulums at once, in memory or into a folder, on cores or a cluster."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reference import InputError, UnreachableError, load_scene
from reference.commands.progress import progress
from reference.commands.terminal import (
    AsJson,
    Assignments,
    Cluster,
    EndTime,
    Sections,
    Workers,
    check_workers,
    completion,
    emit,
    option,
    refuse,
    replacements,
    scene_argument,
    stoppable,
)
from reference.scenes.fields import LEVELS
from reference.status import Status

if TYPE_CHECKING:
    from reference import Swept
    from reference.sweeps.request import Request

# options that change the scene, and not what is asked of a sweep of it
ON_SCENE = ("--set", "--t-end", "--section")
_NO_GRID = dict.fromkeys(
    ("run.grid_step", "run.digits", "run.level", "run.transits"),
    "Give --t-end, --digits, --level or --want.",
)

SCENE = scene_argument(
    "A scene's id, or the path of a TOML file; without it, go on with the sweep in --out.",
    "[SCENE]",
)
OVER = option(
    "--over",
    "Vary a field: START:STOP:STEP, or V1,V2,…, or @FILE.csv; several give all combinations.",
    "KEY=VALUES",
)
ROWS = option("--rows", "Instead: CSV or Parquet, a column for each field, a row a scene.", "FILE")
WANT = option(
    "--want",
    "frequency, precession, transits, state, amplitude, all of these (default), transit-times.",
    "A,B,…",
)
LEVEL = option(
    "--level",
    "Above computed, every row goes through the solver.",
    "L",
    names=completion(lambda: LEVELS),
)
DIGITS = option(
    "--digits", "Significant digits of every row, by the solver (default: those of double).", "D"
)
TOLERANCE = option("--tolerance", "Solve rows again whose position may be off by more, in m.", "M")
ENGINE = option("--engine", "Solve the rows with this engine (default: the fastest).", "E")
AUDIT = option(
    "--audit", "Solve N rows again in 28 digits (default: with --out a thousandth, else none).", "N"
)
OUT = option(
    "--out", "Write the rows into this folder, in Parquet; the same command goes on.", "DIR"
)
PLOT = option("--plot", "Draw frequency and precession: .svg, .png or .pdf.", "FILE")


def command(
    scene_word: Annotated[str | None, SCENE] = None,
    over: Annotated[list[str] | None, OVER] = None,
    rows: Annotated[Path | None, ROWS] = None,
    set_: Assignments = None,
    t_end: EndTime = None,
    want: Annotated[str | None, WANT] = None,
    section: Sections = None,
    level: Annotated[str | None, LEVEL] = None,
    digits: Annotated[int | None, DIGITS] = None,
    tolerance: Annotated[float | None, TOLERANCE] = None,
    engine: Annotated[str | None, ENGINE] = None,
    audit: Annotated[int | None, AUDIT] = None,
    out: Annotated[Path | None, OUT] = None,
    workers: Workers = None,
    cluster: Cluster = None,
    plot: Annotated[Path | None, PLOT] = None,
    as_json: AsJson = False,
) -> None:
    """Solve a scene for many values of its fields.

    Frequency, precession, transits, passages of sections and final state, each with its error.

    foucault sweep paris --over site.latitude=-90:90:1 --t-end 12000
    """
    from reference.sweeps.request import worth_compiling
    from reference.sweeps.sweep import run

    from ..report.sweep_report import document, text

    request = _request(
        scene_word, out,
        {"--over": over, "--rows": rows, "--set": set_, "--t-end": t_end, "--want": want, "--section": section,
         "--level": level, "--digits": digits, "--tolerance": tolerance, "--engine": engine, "--audit": audit},
    )  # fmt: skip
    check_workers(workers, cluster)
    if plot is not None:
        from ..report.sweep_report import check

        check(request, plot)
    kept = (
        f"what is done is in {out}: `foucault sweep --out {out}` goes on"
        if out
        else "nothing was kept; give --out DIR"
    )
    with stoppable(kept), progress() as show:
        move, done = show(f"sweep of {request.scene.id}", request.table.count, "rows"), [0]

        def report(count: int) -> None:
            done[0] += count
            move(done[0])

        swept = run(request, out, workers, cluster, report)
    if plot is not None:
        from ..report.sweep_report import draw

        draw(swept, plot)
    if as_json:
        emit(document(swept, out, workers, cluster))
    else:
        typer.echo(text(swept, out))
        if plot is not None:
            typer.echo(f"{plot}: the picture")
        advice = worth_compiling(request) if scene_word is not None and engine is None else ""
        if advice:
            typer.echo(advice, err=True)
    _judge(swept)


def _request(scene_word: str | None, out: Path | None, options: dict[str, Any]) -> Request:
    """Return the sweep that the options describe, or the one that is in the folder."""
    from reference.sweeps.store import Store
    from reference.sweeps.sweep import asked_for

    if scene_word is None:
        refuse(options, "without SCENE, when a sweep is gone on with")
        if out is None:
            raise InputError("SCENE", "nothing", "a scene, or --out DIR with a sweep to go on with")
        return Store.opened(out).request
    sections = ",".join(options["--section"]) if options["--section"] else None
    given = {"--t-end": ("run.t_end", options["--t-end"]), "--section": ("run.sections", sections)}
    scene = load_scene(scene_word, replacements(options["--set"], given, _NO_GRID))
    chosen = {
        word.strip("-"): value
        for word, value in options.items()
        if value is not None and word not in ON_SCENE
    }
    if "want" in chosen:
        chosen["want"] = [word.strip() for word in chosen["want"].split(",")]
    request = asked_for(scene, out=out, **chosen)
    if "run.t_end" in request.table.values:
        refuse({"--t-end": options["--t-end"]}, "together with --over run.t_end")
    return request


def _judge(swept: Swept) -> None:
    """End with the exit status of a sweep with rows that failed, or with an audit that did.

    Raises:
        UnreachableError: rows could not reach the level or the digits.
        typer.Exit: other rows failed, or the audit found a wrong one.
    """
    counts = swept.counts
    failed = len(swept) - counts.get(Status.OK.value, 0)
    if failed:
        first = swept.first_bad
        words = ", ".join(
            f"{count} {Status(word).words}"
            for word, count in counts.items()
            if word != Status.OK.value
        )
        where = ", ".join(f"{key}={text}" for key, text in swept.request.table.texts(first).items())
        typer.echo(
            f"foucault: {failed} of {len(swept)} rows failed: {words} (first: row {first}, {where})",
            err=True,
        )
    if swept.audit is not None and swept.audit.wrong:
        named = ", ".join(map(str, swept.audit.wrong))
        typer.echo(f"foucault: solved again, rows {named} lie outside of their errors", err=True)
        raise typer.Exit(1)
    if counts.get(Status.UNREACHABLE.value):
        raise typer.Exit(UnreachableError.exit_status)
    if failed:
        raise typer.Exit(1)
