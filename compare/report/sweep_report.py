"""A sweep as a JSON document, as text, and as a picture: curves over one field, maps over two."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from reference import InputError
from reference.commands.layout import TextColumn, paragraph, table
from reference.errors import Described, counted
from reference.numbers.precision import Array, digits_that_hold
from reference.scenes.scene import unit_of
from reference.status import Status

from .drawing import BLUE, RULE, check_target, picture, sheet
from .folder import write_file

if TYPE_CHECKING:
    from reference import Swept
    from reference.sweeps.request import Request

_ROWS_OF_JSON = 10_000  # no more are printed if there is a folder
_STATE_COLUMNS = ("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s")
# columns of the table: what each is called, and its unit; then those of sections
_SHOWN = {
    "swing_hz": ("frequency", "Hz"),
    "precession_deg_per_h": ("precession", "°/h"),
    "transits": ("transits", ""),
    "max_angle_deg": ("largest angle", "°"),
    "position_error_m": ("estimated", "error, m"),
}
_OF_SECTION = {
    "passages": ("passages", ""),
    "t_first_s": ("first", "s"),
    "interval_s": ("interval", "s"),
}
_LABELS = {
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
        out: its folder, if it has one: then the rows are left out where there are more than
            `_ROWS_OF_JSON`.
        workers: how many cores were asked for; None for all.
        cluster: address of the scheduler that had the work done, if one had.
    """
    from reference.engines.registry import batches
    from reference.system.workers import usable_cores

    request = swept.request
    tally = swept.tally
    rows_done = sum(tally.counts.values())
    rows = None
    if out is None or len(swept) <= _ROWS_OF_JSON:
        rows = [_row(request, number, row) for number, row in enumerate(swept.rows())]
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
        "rows_done": rows_done,
        "counts": swept.counts,
        "audit": asdict(swept.audit) if swept.audit else None,
        "cpu_s": tally.cpu_s + tally.store_s,
        "compile_s": swept.compile_s,
        "fold_s": tally.fold_s,
        "solver_rows": tally.promoted,
        "solver_s": tally.promoted_s,
        "wall_s": swept.wall_s,
        "rows_per_core_s": rows_done / tally.cpu_s if tally.cpu_s else None,
        "rows": rows,
    }


def _row(request: Request, number: int, row: dict[str, Any]) -> dict[str, Any]:
    """Return a row of the JSON document: values of the fields, results, and state."""
    values = request.table.texts(number)
    entries: dict[str, Any] = {}
    if len(values) == 1:
        entries["value"] = next(iter(values.values()))
    entries["values"] = values
    hidden = {"row", *values, *_STATE_COLUMNS}
    entries |= {name: entry for name, entry in row.items() if name not in hidden}
    state = [row[name] for name in _STATE_COLUMNS if name in row]
    is_known = bool(state) and state[0] is not None
    return entries | {"state": state if is_known else None}


def text(swept: Swept, out: Path | None) -> str:
    """Return the table of a sweep or its folder; then findings of an audit, statuses and costs."""
    if out is None:
        lines = [*_table(swept), *_failed_lines(swept), ""]
    else:
        lines = [f"{out}: {counted(swept.request.parts, 'part')} in Parquet"]
    lines += _audit_lines(swept)
    by_status = ", ".join(f"{count} {Status(word).words}" for word, count in swept.counts.items())
    lines += paragraph(f"{counted(len(swept), 'row')}: {by_status}")
    lines += paragraph(_cost_line(swept))
    return "\n".join(lines)


def _table(swept: Swept) -> list[str]:
    """Return the rows as lines: values of the fields, and results, or dashes if there are none."""
    request = swept.request
    texts = [list(request.table.texts(number).values()) for number in range(len(swept))]
    table_columns = []
    for place, key in enumerate(request.table.values):
        # the table that a field is in is left out
        name = key.rpartition(".")[2]
        table_columns.append(TextColumn([name, unit_of(key)], [row[place] for row in texts]))

    heads = _heads(request)
    rows = list(swept.rows())
    errors = {column.name: column.error for column in request.columns}
    for column, head in heads.items():
        if column in errors:
            cells = [_result(row, column, errors[column]) for row in rows]
            table_columns.append(TextColumn(head, cells))
    return table(table_columns, keys=len(request.table.values), indent="")


def _result(row: dict[str, Any], name: str, error: str | None) -> str:
    """Return a result of a row, or a dash if it has none."""
    if row["status"] != Status.OK.value:
        return "–"
    return _cell(row[name], row.get(error) if error else None)


def _failed_lines(swept: Swept) -> Iterator[str]:
    """Yield why rows have no results."""
    names = list(swept.request.table.values)
    if len(swept) > swept.counts.get(Status.OK.value, 0):
        yield ""
    for number, row in enumerate(swept.rows()):
        if row["status"] == Status.OK.value:
            continue
        texts = swept.request.table.texts(number)
        values = ", ".join(f"{name} = {texts[name]}" for name in names)
        yield from paragraph(f"{values}: {row['status']}: {row['reason']}", hanging="  ")


def _heads(request: Request) -> dict[str, tuple[str, ...]]:
    """Return the heads of the table by the names of the columns, in order."""
    heads: dict[str, tuple[str, ...]] = dict(_SHOWN)
    if request.level == "enclosed":
        heads["position_error_m"] = ("proved", "error, m")
    for word in request.sections:
        for name, head in _OF_SECTION.items():
            heads[f"{word}: {name}"] = (word, *head)
    return heads


def _audit_lines(swept: Swept) -> list[str]:
    """Return a line with the findings of the audit, if there was one."""
    audit = swept.audit
    if audit is None:
        return []
    findings = f"{len(audit.wrong)} wrong, largest error {audit.worst_ratio:.2g} of its estimate"
    if audit.refused:
        findings += f"; {len(audit.refused)} that the solver refuses"
    rows = counted(audit.rows, "row")
    return paragraph(f"{rows} solved again in 28 digits: {findings}, CPU {swept.audit_s:.2f} s")


def _cost_line(swept: Swept) -> str:
    """Return what a sweep cost, and what solved it."""
    tally = swept.tally
    cost = f"CPU {tally.cpu_s + tally.store_s:.2f} s"
    if tally.promoted:
        rows = counted(tally.promoted, "row")
        cost += f", {tally.promoted_s:.2f} s of them for {rows} that went to the solver"
    return f"{cost}, compiling {swept.compile_s:.2f} s; {swept.request.solved_by}"


def _cell(value: Any, error: float | None) -> str:
    """Return a number with the digits that its error leaves, or with ± a larger error.

    An error itself has two digits.
    """
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
        InputError: a wrong path, other than one or two fields that are numbers, or neither quantity
            is wanted.
    """
    from reference.sweeps.axes import WORD_FIELDS

    check_target(path)
    table = request.table
    if table.typed is None or len(table.shape) > 2 or set(table.values) & set(WORD_FIELDS):
        expected = "a sweep over one or two numerical fields (--over)"
        got = Described("another kind of sweep")
        raise InputError("--plot", got, expected, "Draw other sweeps from their columns.")
    if not _drawn(request):
        raise InputError("--plot", str(path), "frequency or precession in --want")


def draw(swept: Swept, path: Path) -> None:
    """Draw frequency and precession of a sweep, as far as requested, into a file."""
    request = swept.request
    drawn = _drawn(request)
    columns = swept.columns(drawn)
    axes = [(key, np.array(texts, float)) for key, texts in request.table.values.items()]
    height = 3.0 if len(axes) == 1 else 3.6
    with sheet((8, height * len(drawn) + 0.4)) as figure:
        panels = np.atleast_1d(figure.subplots(len(drawn), 1, sharex=True))
        for panel, name in zip(panels, drawn, strict=True):
            if len(axes) == 1:
                _curve(panel, axes[0][1], _LABELS[name], columns[name])
            else:
                _map(figure, panel, axes, _LABELS[name], columns[name])
        panels[-1].set_xlabel(_label(axes[-1][0]))
        panels[0].set_title(f"{request.scene.id}, {float(request.scene.exact.t_end):g} s")
        content = picture(figure, path.suffix[1:].lower())
    write_file(path, content, "--plot")


def _drawn(request: Request) -> list[str]:
    """Return the columns that are drawn."""
    names = [column.name for column in request.columns]
    return [name for name in _LABELS if name in names]


def _label(key: str) -> str:
    """Return the label of an axis."""
    name = key.rpartition(".")[2].replace("_", " ")
    unit = unit_of(key).replace("degrees", "°")
    return f"{name} in {unit}" if unit else name


def _curve(panel: Any, x: Array, label: str, values: Array) -> None:
    """Draw a curve over one field."""
    order = np.argsort(x)
    marker = "o" if len(x) <= _MARKED else None
    panel.plot(x[order], values[order], color=BLUE, marker=marker, markersize=3)
    panel.grid(color=RULE)
    panel.ticklabel_format(axis="y", useOffset=False)
    panel.set_ylabel(label)


def _map(
    figure: Any, panel: Any, axes: Sequence[tuple[str, Array]], label: str, values: Array
) -> None:
    """Draw a map over two fields; colours are symmetric about 0 if values have both signs."""
    (key, y), (_, x) = axes
    grid = values.reshape(len(y), len(x))[np.ix_(np.argsort(y), np.argsort(x))]
    low = np.nanmin(grid, initial=np.inf)
    high = np.nanmax(grid, initial=-np.inf)
    style: dict[str, Any] = {"cmap": "cividis"}
    if low < 0 < high:
        largest = max(-low, high)
        style = {"vmin": -largest, "vmax": largest, "cmap": "RdBu_r"}
    mesh = panel.pcolormesh(np.sort(x), np.sort(y), grid, **style, rasterized=True)
    # cells reach half a step beyond the values, where there may be no latitude
    if len(x) > 1:
        panel.set_xlim(x.min(), x.max())
    if len(y) > 1:
        panel.set_ylim(y.min(), y.max())
    panel.set_ylabel(_label(key))
    bar = figure.colorbar(mesh, ax=panel, label=label)
    bar.formatter.set_useOffset(False)
