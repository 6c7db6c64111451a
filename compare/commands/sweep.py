"""`foucault sweep`: many pendulums at once, in memory or into a folder, on cores or a cluster."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reference import InputError, UnreachableError
from reference.commands.options import Conflict, refuse_conflicts
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
from reference.errors import NOTHING
from reference.scenes.fields import LEVELS
from reference.status import Status
from reference.system.workers import usable_cores

from .options import announce, scene_named

if TYPE_CHECKING:
    from reference import Swept
    from reference.sweeps.request import Request, Settings

# fields of a scene that make no difference to a sweep, and what does instead
_NO_GRID = dict.fromkeys(
    ("run.grid_step", "run.digits", "run.level", "run.transits"),
    "Give --t-end, --digits, --level or --want.",
)

SCENE = scene_argument(
    "A scene's id, or the path of a TOML file; without it, resume the sweep in --out.",
    "[SCENE]",
)
OVER = option(
    "--over",
    "Vary a field: START:STOP:STEP, or V1,V2,…, or @FILE.csv; several give all combinations.",
    "KEY=VALUES",
)
ROWS = option(
    "--rows",
    "Instead of --over: a CSV or Parquet file, with a column for each field and a row for each scene.",
    "FILE",
)
WANT = option(
    "--want",
    "frequency, precession, transits, state, amplitude, all of these (default), transit-times.",
    "A,B,…",
)
LEVEL = option(
    "--level",
    "Level of trust; above computed, the solver solves every row.",
    "L",
    names=completion(lambda: LEVELS),
)
DIGITS = option(
    "--digits",
    "Significant digits; the solver then solves every row (default: double precision).",
    "D",
)
TOLERANCE = option(
    "--tolerance", "Solve rows again whose estimated position error is larger, in m.", "M"
)
ENGINE = option("--engine", "Solve the rows with this engine (default: the fastest).", "E")
AUDIT = option(
    "--audit", "Solve N rows again in 28 digits (default: with --out a thousandth, else none).", "N"
)
OUT = option(
    "--out", "Write the rows into this folder, in Parquet; the same command resumes.", "DIR"
)
PLOT = option("--plot", "Draw frequency and precession: .svg, .png or .pdf.", "FILE")


@dataclass(frozen=True)
class SweepOptions:
    """The argument and the options of `foucault sweep`."""

    scene_word: Annotated[str | None, SCENE] = None
    over: Annotated[list[str] | None, OVER] = None
    rows: Annotated[Path | None, ROWS] = None
    set_: Assignments = None
    t_end: EndTime = None
    want: Annotated[str | None, WANT] = None
    section: Sections = None
    level: Annotated[str | None, LEVEL] = None
    digits: Annotated[int | None, DIGITS] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    engine: Annotated[str | None, ENGINE] = None
    audit: Annotated[int | None, AUDIT] = None
    out: Annotated[Path | None, OUT] = None
    workers: Workers = None
    cluster: Cluster = None
    plot: Annotated[Path | None, PLOT] = None
    as_json: AsJson = False


CONFLICTS = [
    Conflict(
        "--over --rows --set --t-end --want --section --level --digits --tolerance --engine --audit",
        "without SCENE, when a sweep is resumed",
        lambda options: options.scene_word is None,
    ),
]


def sweep(options: SweepOptions) -> None:
    """Solve a scene for many values of its fields.

    Frequency, precession, transits, passages of sections and final state, each with its error.

    foucault sweep paris --over site.latitude=-90:90:1 --t-end 12000
    """
    refuse_conflicts(options, CONFLICTS)
    request = _request(options)
    check_workers(options.workers, options.cluster)
    if options.plot is not None:
        from ..report.sweep_report import check

        check(request, options.plot)
    if options.scene_word is not None:
        from reference.commands.cautions import warn

        warn(request.scene, options.scene_word, tuple(request.table.values))

    if options.scene_word is not None and options.engine is None and options.cluster is None:
        from reference.sweeps.background import compile_for_the_next

        begun = compile_for_the_next(request)
        if begun:
            announce(begun)
    swept = _run(request, options)
    if options.plot is not None:
        from ..report.sweep_report import draw

        draw(swept, options.plot)
    _print(swept, options)
    _end(swept)


def _request(options: SweepOptions) -> Request:
    """Return the sweep that the options describe, or the one that is in the folder."""
    from reference.sweeps.store import Store
    from reference.sweeps.sweep import checked_request

    if options.scene_word is None:
        if options.out is None:
            raise InputError("SCENE", NOTHING, "a scene, or --out DIR with a sweep to resume")
        return Store.opened(options.out).request

    sections = ",".join(options.section) if options.section else None
    fields = {"--t-end": ("run.t_end", options.t_end), "--section": ("run.sections", sections)}
    scene = scene_named(options.scene_word, replacements(options.set_, fields, _NO_GRID))
    request = checked_request(
        scene, options.over or (), options.rows, options.out, _settings(options)
    )
    if "run.t_end" in request.table.values:
        refuse({"--t-end": options.t_end}, "together with --over run.t_end")
    return request


def _settings(options: SweepOptions) -> Settings:
    """Return the settings of the sweep; those that were not given have their defaults."""
    from reference.sweeps.request import Settings

    names = ("level", "digits", "tolerance", "engine", "audit")
    values: dict[str, Any] = {name: getattr(options, name) for name in names}
    if options.want is not None:
        values["want"] = [word.strip() for word in options.want.split(",")]
    return Settings(**{name: value for name, value in values.items() if value is not None})


def _run(request: Request, options: SweepOptions) -> Swept:
    """Run the sweep and show its progress; Ctrl-C ends it with a line that says what was kept."""
    from reference.sweeps.sweep import run

    out = options.out
    if out is None:
        kept = "nothing was kept; give --out DIR"
    else:
        kept = f"finished rows are in {out}: `foucault sweep --out {out}` resumes"
    with stoppable(kept), progress() as show:
        # the audit is done on one core, after the rows on all
        workers = options.workers or usable_cores()
        rows_per_audited = request.rows_per_audited * workers
        rows = request.table.count
        move = show(f"sweep of {request.scene.id}", rows, "rows", request.audit * rows_per_audited)
        done = 0

        def report(count: int) -> None:
            nonlocal done
            done += count
            move(done)

        def report_audit(count: int) -> None:
            move(rows + count * rows_per_audited, item=f"auditing {request.audit} rows")

        return run(request, out, options.workers, options.cluster, report, report_audit)


def _print(swept: Swept, options: SweepOptions) -> None:
    """Print the sweep as JSON or as text."""
    from ..report.sweep_report import document, text

    if options.as_json:
        emit(document(swept, options.out, options.workers, options.cluster))
        return
    typer.echo(text(swept, options.out))
    if options.plot is not None:
        typer.echo(f"{options.plot}: the picture")


def _end(swept: Swept) -> None:
    """Name rows that failed, and rows that the audit found wrong; then the exit status is not 0.

    Raises:
        typer.Exit: rows failed, or the audit found a wrong one. The status is that of
            `UnreachableError` if rows could not reach the level or the digits.
    """
    counts = swept.counts
    failed = len(swept) - counts.get(Status.OK.value, 0)
    if failed:
        typer.echo(f"foucault: {failed} of {len(swept)} rows failed: {_failures(swept)}", err=True)
    if swept.audit is not None and swept.audit.wrong:
        wrong = ", ".join(map(str, swept.audit.wrong))
        typer.echo(f"foucault: solved again, rows {wrong} lie outside of their errors", err=True)
        raise typer.Exit(1)
    if counts.get(Status.UNREACHABLE.value):
        raise typer.Exit(UnreachableError.exit_status)
    if failed:
        raise typer.Exit(1)


def _failures(swept: Swept) -> str:
    """Return how many rows failed in each way, and the first one with its values."""
    counts = ", ".join(
        f"{count} {Status(word).words}"
        for word, count in swept.counts.items()
        if word != Status.OK.value
    )
    first = swept.first_bad
    values = ", ".join(f"{key}={text}" for key, text in swept.request.table.texts(first).items())
    return f"{counts} (first: row {first}, {values})"
