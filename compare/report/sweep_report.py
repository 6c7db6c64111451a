"""A sweep as a JSON document, as the text of a terminal, and as a picture: curves over one field, maps over two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from reference import InputError
from reference.errors import counted
from reference.numbers.precision import Array, digits_that_hold
from reference.scenes.scene import unit_of
from reference.status import Status

from .drawing import BLUE, RULE, check_target, picture, sheet
from .folder import write_file
from .page import PageTable

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
}  # columns of the table, and their heads; then those of sections
OF_SECTION = {"passages": "passages", "t_first_s": "first (s)", "interval_s": "interval (s)"}
LABELS = {
    "swing_hz": "frequency of the swing in Hz",
    "precession_deg_per_h": "precession in °/h, east to north",
}  # of the columns that are drawn
_MARKED = 40  # values up to which a curve's points are marked


def document(
    swept: Swept, out: Path | None, workers: int | None, cluster: str | None
) -> dict[str, Any]:
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
        "solver_rows": tally.promoted,
        "solver_s": tally.promoted_s,
        "wall_s": swept.wall_s,
        "rows_per_core_s": sum(tally.counts.values()) / tally.cpu_s if tally.cpu_s else None,
        "rows": [_row(request, number, row) for number, row in enumerate(swept.rows())]
        if printed
        else None,
    }


def _row(request: Request, number: int, row: dict[str, Any]) -> dict[str, Any]:
    texts = request.table.texts(number)
    state = [
        row.pop(name) for name in ("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s") if name in row
    ]
    value = {"value": next(iter(texts.values()))} if len(texts) == 1 else {}
    rest = {name: entry for name, entry in row.items() if name not in texts and name != "row"}
    return {
        **value,
        "values": texts,
        **rest,
        "state": state if state and state[0] is not None else None,
    }


def text(swept: Swept, out: Path | None) -> str:
    """Return the table of a sweep, or where its folder is; then what an audit found, statuses and costs."""
    tally, counts = swept.tally, swept.counts
    by_status = ", ".join(f"{count} {Status(word).words}" for word, count in counts.items())
    total = f"{counted(len(swept), 'row')}: {by_status}"
    cost = f"CPU {tally.cpu_s + tally.store_s:.2f} s"
    if tally.promoted:
        cost += f", {tally.promoted_s:.2f} s of them for {counted(tally.promoted, 'row')} that went to the solver"
    cost += f", compiling {swept.compile_s:.2f} s; {swept.request.solved_by}"
    lines = []
    if out is None:
        columns = {column.name: column for column in swept.request.columns}
        sections = swept.request.sections
        heads = SHOWN | {
            f"{word}: {name}": f"{word}: {head}"
            for word in sections
            for name, head in OF_SECTION.items()
        }
        if swept.request.level == "enclosed":
            heads["position_error_m"] = "bound (m)"
        shown = [columns[name] for name in heads if name in columns]
        keys = list(swept.request.table.values)
        rows = []
        for number, row in enumerate(swept.rows()):
            texts = swept.request.table.texts(number)
            ok = row["status"] == Status.OK.value
            results = [
                _cell(row[column.name], row.get(column.error)) if ok else "" for column in shown
            ]
            rows.append(
                (
                    *(texts[key] for key in keys),
                    *results,
                    "" if ok else f"{row['status']}: {row['reason']}",
                )
            )
        named = (*keys, *(heads[column.name] for column in shown))
        lines += PageTable({**dict.fromkeys(named, "number"), "": ""}, rows).lines()
    else:
        lines.append(f"{out}: {counted(swept.request.parts, 'part')} in Parquet")
    if swept.audit is not None:
        audit = f"{len(swept.audit.wrong)} wrong, largest error {swept.audit.worst_ratio:.2g} of its estimate"
        audit += (
            f"; {len(swept.audit.refused)} that the solver refuses" if swept.audit.refused else ""
        )
        lines.append(
            f"{counted(swept.audit.rows, 'row')} solved again in 28 digits: {audit}, CPU {swept.audit_s:.2f} s"
        )
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


def check(request: Request, path: Path) -> None:
    """Refuse a picture that could not be drawn, before any work.

    Raises:
        InputError: a wrong path, other than one or two fields that are numbers, or neither quantity is wanted.
    """
    from reference.sweeps.axes import TEXTS

    check_target(path)
    table = request.table
    if table.typed is None or len(table.shape) > 2 or set(table.values) & set(TEXTS):
        expected = "one or two fields varied by --over, both numbers"
        raise InputError("--plot", str(path), expected, "Or draw the columns.")
    if not _drawn(request):
        raise InputError("--plot", str(path), "--want with frequency or precession")


def draw(swept: Swept, path: Path) -> None:
    """Draw frequency and precession of a sweep, those of them that were wanted, into a file."""
    request = swept.request
    drawn = _drawn(request)
    columns = swept.columns(drawn)
    axes = [(key, np.array(texts, float)) for key, texts in request.table.values.items()]
    draw_panel, height = (_curve, 3.0) if len(axes) == 1 else (_map, 3.6)
    with sheet((8, height * len(drawn) + 0.4)) as figure:
        panels = np.atleast_1d(figure.subplots(len(drawn), 1, sharex=True))
        for panel, name in zip(panels, drawn, strict=True):
            draw_panel(figure, panel, axes, LABELS[name], columns[name])
        panels[-1].set_xlabel(_label(axes[-1][0]))
        panels[0].set_title(f"{request.scene.id}, {float(request.scene.exact.t_end):g} s")
        content = picture(figure, path.suffix[1:].lower())
    write_file(path, content, "--plot")


def _drawn(request: Request) -> list[str]:
    names = [column.name for column in request.columns]
    return [name for name in LABELS if name in names]


def _label(key: str) -> str:
    name, unit = key.rpartition(".")[2].replace("_", " "), unit_of(key).replace("degrees", "°")
    return f"{name} in {unit}" if unit else name


def _curve(
    _: Any, panel: Any, axes: Sequence[tuple[str, Array]], label: str, values: Array
) -> None:
    ((_, x),) = axes
    order = np.argsort(x)
    panel.plot(
        x[order], values[order], color=BLUE, marker="o" if len(x) <= _MARKED else None, markersize=3
    )
    panel.grid(color=RULE)
    panel.ticklabel_format(axis="y", useOffset=False)
    panel.set_ylabel(label)


def _map(
    figure: Any, panel: Any, axes: Sequence[tuple[str, Array]], label: str, values: Array
) -> None:
    (key, y), (_, x) = axes
    grid = values.reshape(len(y), len(x))[np.ix_(np.argsort(y), np.argsort(x))]
    low, high = np.nanmin(grid, initial=np.inf), np.nanmax(grid, initial=-np.inf)
    signed = low < 0 < high
    most = max(-low, high)
    style = {"vmin": -most, "vmax": most, "cmap": "RdBu_r"} if signed else {"cmap": "cividis"}
    mesh = panel.pcolormesh(np.sort(x), np.sort(y), grid, **style, rasterized=True)
    for limit, of_axis in ((panel.set_xlim, x), (panel.set_ylim, y)):
        if len(of_axis) > 1:  # cells reach half a step farther, which may be no latitude
            limit(of_axis.min(), of_axis.max())
    panel.set_ylabel(_label(key))
    bar = figure.colorbar(mesh, ax=panel, label=label)
    bar.formatter.set_useOffset(False)
