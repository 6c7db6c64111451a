"""A sweep as a JSON document, and as the text of a terminal."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reference.numbers.precision import digits_that_hold
from reference.status import Status

from .page import Table

if TYPE_CHECKING:
    from reference import Swept
    from reference.sweeps.request import Request

ROWS_OF_JSON = 10_000  # with a folder, no more are printed
SHOWN = {
    "swing_hz": "frequency (Hz)",
    "precession_deg_per_h": "precession (°/h)",
    "transits": "transits",
    "max_angle_deg": "angle (°)",
    "position_error_m": "estimated error (m)",
}  # columns of the table, and their heads


def document(swept: Swept, out: Path | None, workers: int | None, cluster: str | None) -> dict[str, Any]:
    """Return the JSON document of a sweep.

    Args:
        swept: the sweep.
        out: its folder, if it has one: then the rows are left out where there are more than `ROWS_OF_JSON`.
        workers: how many cores were asked for; None for all.
        cluster: address of the scheduler that had the work done, if one had.
    """
    from reference.engines.registry import batches
    from reference.system.workers import usable_cores

    request, tally = swept.request, swept.tally
    printed = out is None or len(swept) <= ROWS_OF_JSON
    return {
        "scene": request.scene.id,
        "over": request.table.typed,
        "t_end": request.scene.run.t_end,
        "out": str(out) if out else None,
        "level": request.level,
        "engine": request.engine,
        "lanes": batches()[request.engine].lanes,
        "workers": None if cluster else workers or usable_cores(),
        "cluster": cluster,
        "rows_total": len(swept),
        "rows_done": sum(tally.counts.values()),
        "counts": swept.counts,
        "audit": asdict(swept.audit) if swept.audit else None,
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


def text(swept: Swept, out: Path | None) -> str:
    """Return the table of a sweep, or where its folder is; then what an audit found, statuses and costs."""
    tally, counts = swept.tally, swept.counts
    by_status = ", ".join(f"{count} {Status(word).words}" for word, count in counts.items())
    total = f"{len(swept)} rows: {by_status}"
    cost = f"CPU {tally.cpu_s + tally.store_s:.2f} s, compiling {swept.compile_s:.2f} s; {swept.request.engine}"
    lines = []
    if out is None:
        columns = {column.name: column for column in swept.request.columns}
        shown = [columns[name] for name in SHOWN if name in columns]
        keys = list(swept.request.table.values)
        rows = []
        for number, row in enumerate(swept.rows()):
            texts = swept.request.table.texts(number)
            ok = row["status"] == Status.OK.value
            results = [_cell(row[column.name], row.get(column.error)) if ok else "" for column in shown]
            rows.append((*(texts[key] for key in keys), *results, "" if ok else f"{row['status']}: {row['reason']}"))
        heads = (*keys, *(SHOWN[column.name] for column in shown))
        lines += Table({**dict.fromkeys(heads, "number"), "": ""}, rows).lines()
    else:
        lines.append(f"{out}: {swept.request.parts} parts in Parquet")
    if swept.audit is not None:
        found = f"{len(swept.audit.wrong)} wrong, largest error {swept.audit.worst_ratio:.2g} of its estimate"
        lines.append(f"{swept.audit.rows} rows solved again in 28 digits: {found}")
    return "\n".join([*lines, total, cost])


def _cell(value: Any, error: float | None) -> str:
    """Return a number with the digits that its error leaves, or ± the error where that is larger; an error with two."""
    if value is None:
        return "–"
    if isinstance(value, int):
        return str(value)
    if error is None:
        return f"{value:.1e}"
    return digits_that_hold(value, error)
