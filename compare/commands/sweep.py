"""`foucault sweep`: many pendulums at once, in memory or into a folder, on cores or a cluster."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reference import InputError, UnreachableError, load_scene, scene_ids
from reference.commands.progress import progress
from reference.commands.terminal import (
    AsJson,
    Assignments,
    completion,
    emit,
    refuse,
    replacements,
    stoppable,
)
from reference.scene import LEVELS
from reference.status import Status

if TYPE_CHECKING:
    from reference import Swept
    from reference.sweeps.request import Request

ROWS_OF_JSON = 10_000  # with a folder, no more are printed
SHOWN = {
    "frequency_hz": "frequency (Hz)",
    "precession_deg_per_h": "precession (°/h)",
    "transits": "transits",
    "max_angle_deg": "angle (°)",
    "position_error_m": "error (m)",
}  # columns of the table, and their heads
_NO_GRID = dict.fromkeys(
    ("run.grid_step", "run.digits", "run.level", "run.transits"), "Give --t-end, --digits, --level or --want."
)


def command(
    scene_word: Annotated[
        str | None,
        typer.Argument(
            metavar="[SCENE]",
            help="A scene's id, or the path of a TOML file; without it, go on with the sweep in --out.",
            autocompletion=completion(scene_ids),
        ),
    ] = None,
    over: Annotated[
        list[str] | None,
        typer.Option(
            "--over",
            metavar="KEY=VALUES",
            help="Vary a field: START:STOP:STEP, or V1,V2,…, or @FILE.csv; several give all combinations.",
        ),
    ] = None,
    rows: Annotated[
        Path | None,
        typer.Option("--rows", metavar="FILE", help="Instead: CSV or Parquet, a column for each field, a row a scene."),
    ] = None,
    set_: Assignments = None,
    t_end: Annotated[
        str | None, typer.Option("--t-end", metavar="S", help="End each run at this time, in s (default: the scene's).")
    ] = None,
    want: Annotated[
        str | None,
        typer.Option(
            "--want",
            metavar="A,B,…",
            help="frequency, precession, transits, state, amplitude, all of these (default), transit-times.",
        ),
    ] = None,
    level: Annotated[
        str | None,
        typer.Option(
            "--level",
            metavar="L",
            help="Above computed, every row goes through the solver.",
            autocompletion=completion(lambda: LEVELS),
        ),
    ] = None,
    digits: Annotated[
        int | None, typer.Option("--digits", metavar="D", help="Solve every row to so many significant digits.")
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option("--tolerance", metavar="M", help="Solve rows again whose position may be off by more, in m."),
    ] = None,
    engine: Annotated[
        str | None,
        typer.Option("--engine", metavar="E", help="Solve the rows with this engine (default: the fastest)."),
    ] = None,
    audit: Annotated[
        int | None,
        typer.Option(
            "--audit",
            metavar="N",
            help="Solve N rows again in 28 digits (default: with --out a thousandth, else none).",
        ),
    ] = None,
    agree_with: Annotated[
        str | None,
        typer.Option("--agree-with", metavar="E", help="Have this engine solve each row as well, and compare."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Write the rows into this folder, in Parquet; the same command goes on."
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", metavar="N", help="Use so many cores of this machine (default: all).")
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option("--cluster", metavar="ADDRESS", help="Use dask.distributed: tcp://HOST:PORT, or local:N."),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE", help="Draw frequency and precession: .svg, .png or .pdf."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Solve a scene for many values of its fields.

    Frequency, precession, transits and final state, each with its error.

    foucault sweep paris --over site.latitude=-90:90:1 --t-end 12000
    """
    from reference.sweeps.sweep import run

    request = _request(
        scene_word, out,
        {"--over": over, "--rows": rows, "--set": set_, "--t-end": t_end, "--want": want, "--level": level,
         "--digits": digits, "--tolerance": tolerance, "--engine": engine, "--audit": audit,
         "--agree-with": agree_with},
    )  # fmt: skip
    if workers is not None and cluster is not None:
        refuse({"--workers": workers}, "together with --cluster")
    if workers is not None and workers < 1:
        raise InputError("--workers", workers, "a whole number from 1")
    if plot is not None:
        _check_plot(request, plot)
    kept = (
        f"what is done is in {out}: `foucault sweep --out {out}` goes on" if out else "nothing was kept; give --out DIR"
    )
    with stoppable(kept), progress() as show:
        move, done = show(f"sweep of {request.scene.id}", request.table.count, "rows"), [0]

        def report(count: int) -> None:
            done[0] += count
            move(done[0])

        swept = run(request, out, workers, cluster, report)
    if plot is not None:
        _draw(swept, plot)
    if as_json:
        emit(_document(swept, out, workers, cluster))
    else:
        typer.echo(_text(swept, out))
        if plot is not None:
            typer.echo(f"{plot}: the picture")
    _judge(swept)


def _request(scene_word: str | None, out: Path | None, options: dict[str, Any]) -> Request:
    """Return the sweep that the options describe, or the one that is in the folder."""
    from reference.sweeps.sweep import asked_for, opened

    if scene_word is None:
        refuse(options, "without SCENE, when a sweep is gone on with")
        if out is None:
            raise InputError("SCENE", "nothing", "a scene, or --out DIR with a sweep to go on with")
        return opened(out).request
    scene = load_scene(
        scene_word, replacements(options["--set"], {"--t-end": ("run.t_end", options["--t-end"])}, _NO_GRID)
    )
    want = options["--want"]
    return asked_for(
        scene,
        options["--over"] or (),
        options["--rows"],
        out,
        want=tuple(word.strip() for word in want.split(",")) if want is not None else ("all",),
        level=options["--level"] or "computed",
        digits=options["--digits"],
        tolerance=options["--tolerance"],
        engine=options["--engine"] or "auto",
        audit=options["--audit"],
        agree_with=options["--agree-with"],
    )


def _check_plot(request: Request, path: Path) -> None:
    from reference.sweeps.axes import Grid

    from ..report.charts.score import check_target

    check_target(path)
    shape = request.table.shape
    if not isinstance(request.table, Grid) or len(shape) > 2 or not _numeric(request):
        raise InputError(
            "--plot", str(path), "one or two fields varied by --over, both numbers", "Or draw the columns."
        )
    if not _drawn(request):
        raise InputError("--plot", str(path), "--want with frequency or precession")


def _numeric(request: Request) -> bool:
    from reference.sweeps.values import TEXTS

    return not set(request.table.keys) & set(TEXTS)


def _drawn(request: Request) -> list[str]:
    names = [column.name for column in request.columns]
    return [name for name in ("swing_hz", "precession_deg_per_h") if name in names]


def _draw(swept: Swept, path: Path) -> None:
    import numpy as np

    from ..report.charts.sweep import sweep_picture

    request = swept.request
    keys = request.table.keys
    columns = swept.columns([*keys, *_drawn(request)])
    axes = []
    for place, key in enumerate(keys):
        grid = columns[key].reshape(request.table.shape)
        axes.append((key, np.moveaxis(grid, place, 0).reshape(grid.shape[place], -1)[:, 0]))
    title = f"{request.scene.id}, {float(request.scene.exact.t_end):g} s"
    sweep_picture(title, axes, {name: columns[name] for name in _drawn(request)}, path)


def _document(swept: Swept, out: Path | None, workers: int | None, cluster: str | None) -> dict[str, Any]:
    """Return the JSON document of a sweep."""
    from reference.engines.registry import batches
    from reference.sweeps.local import default_workers

    request, tally = swept.request, swept.tally
    plan, counts = request.document(), swept.counts
    printed = out is None or len(swept) <= ROWS_OF_JSON
    return {
        "scene": request.scene.id,
        "over": plan["over"],
        "t_end": request.scene.run.t_end,
        "out": str(out) if out else None,
        "level": request.level,
        "engine": request.engine,
        "lanes": batches()[request.engine].lanes,
        "workers": None if cluster else workers or default_workers(),
        "cluster": cluster,
        "rows_total": len(swept),
        "rows_done": sum(tally.counts.values()),
        "counts": counts,
        "audit": swept.audit.document if swept.audit else None,
        "cpu_s": tally.cpu_s + tally.store_s,
        "compile_s": swept.compile_s,
        "fold_s": tally.fold_s,
        "wall_s": swept.wall_s,
        "rows_per_core_s": sum(tally.counts.values()) / tally.cpu_s if tally.cpu_s else None,
        "rows": [_row(request, number, row) for number, row in enumerate(swept.rows())] if printed else None,
    }


def _row(request: Request, number: int, row: dict[str, Any]) -> dict[str, Any]:
    texts = request.table.texts(number)
    state = [row.pop(name) for name in ("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s") if name in row]
    value = {"value": next(iter(texts.values()))} if len(texts) == 1 else {}
    rest = {name: entry for name, entry in row.items() if name not in texts and name != "row"}
    return {**value, "values": texts, **rest, "state": state if state and state[0] is not None else None}


def _text(swept: Swept, out: Path | None) -> str:
    """Return the table of a sweep, or where its folder is."""
    tally = swept.tally
    total = f"{len(swept)} rows: " + ", ".join(f"{count} {Status(word).words}" for word, count in swept.counts.items())
    cost = f"CPU {tally.cpu_s + tally.store_s:.2f} s, compiling {swept.compile_s:.2f} s; {swept.request.engine}"
    lines = []
    if out is None:
        names = [name for name in SHOWN if name in swept.names]
        keys = list(swept.request.table.keys)
        widths = [max(16, len(key) + 2) for key in keys]
        head = [key.rjust(width) for key, width in zip(keys, widths, strict=True)]
        lines.append("".join(head) + "".join(SHOWN[name].rjust(20) for name in names))
        for number, row in enumerate(swept.rows()):
            texts = swept.request.table.texts(number)
            values = "".join(texts[key].rjust(width) for key, width in zip(keys, widths, strict=True))
            ok = row["status"] == Status.OK.value
            lines.append(
                values
                + ("".join(_cell(name, row[name]) for name in names) if ok else f"    {row['status']}: {row['reason']}")
            )
    else:
        lines.append(f"{out}: {swept.request.parts} parts in Parquet")
    if swept.audit is not None:
        found = f"{len(swept.audit.wrong)} wrong, largest error {swept.audit.worst_ratio:.2g} of its estimate"
        lines.append(f"{swept.audit.rows} rows solved again in 28 digits: {found}")
    return "\n".join([*lines, total, cost])


def _cell(name: str, value: Any) -> str:
    if value is None:
        return "–".rjust(20)
    if isinstance(value, int):
        return str(value).rjust(20)
    return (f"{value:.1e}" if name.endswith("error_m") else f"{value:.12g}").rjust(20)


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
        words = ", ".join(f"{count} {Status(word).words}" for word, count in counts.items() if word != Status.OK.value)
        where = ", ".join(f"{key}={text}" for key, text in swept.request.table.texts(first).items())
        typer.echo(f"foucault: {failed} of {len(swept)} rows failed: {words} (first: row {first}, {where})", err=True)
    if swept.audit is not None and swept.audit.wrong:
        named = ", ".join(map(str, swept.audit.wrong))
        typer.echo(f"foucault: solved again, rows {named} lie outside of their errors", err=True)
        raise typer.Exit(1)
    if counts.get(Status.UNREACHABLE.value):
        raise typer.Exit(UnreachableError.exit_status)
    if failed:
        raise typer.Exit(1)
