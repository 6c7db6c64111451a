"""Tables of a study, as HTML for its page and as text for a terminal.

Also how all reports of studies write numbers, settings, outcomes, and the load of the machine.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from statistics import median
from typing import Any

from reference.commands.layout import TextColumn
from reference.commands.layout import paragraph as as_lines
from reference.commands.layout import table as columns_as_lines
from reference.plain_text import shortened
from reference.status import Status
from reference.system.documents import texts_of

from ..methods import METHODS
from ..studies.row import Row, grouped
from ..studies.stability import Cell
from ..studies.study import ObservedOrder, orders
from ..studies.users_program import FILE
from .page import Html, PageTable, strong
from .pareto import TARGETS_M, cost_at, costs_at, curves, front, rows_of, sentences, tidy

_FRONT_MARK = "●"
_PART_MARK = "~"
_ABSENT = "–"
_OF_PROGRAMS = (
    "Your program: CPU seconds of the whole process; transits are not measured, and h drift needs "
    "its velocities"
)
LONGEST_COMMAND = 400  # characters of a command that a page repeats
# processes for each core; with more, runs share cores and caches, and the clock of wide vectors is
# lower
_MAX_LOAD = 1.0
# difference of repeated costs over their median; with more, ratios of costs are doubtful
_MAX_SPREAD = 0.2

# the columns of the table of all rows; the reason of a failure follows
_TEXT_COLUMNS = ("", "method", "formulation", "setting", "status")
_NUMBER_COLUMNS = (
    "error m",
    "end error m",
    "transit error s",
    "h drift",
    "CPU s",
    "spread",
    "compile s",
    "evaluations",
    "steps",
    "last t, s",
)

_CAPTIONS = texts_of(__file__)


def costs(rows: Sequence[Row], bound_m: float) -> Html:
    """Return the cost of each error with each method, cheapest first at the smallest error reached."""
    costs_by_method = {}
    for curve in curves(rows):
        costs_s = [cost_at(curve, error_m, bound_m) for error_m in TARGETS_M]
        if any(costs_s):
            costs_by_method[curve.label] = costs_s

    least = []
    for error_m in TARGETS_M:
        cheapest_first = costs_at(rows, error_m, bound_m)
        least.append(cheapest_first[0][1] if cheapest_first else None)

    def from_the_smallest_error(label: str) -> list[float]:
        costs_s = reversed(costs_by_method[label])
        return [math.inf if cpu_s is None else cpu_s for cpu_s in costs_s]

    table = []
    for label in sorted(costs_by_method, key=from_the_smallest_error):
        cells: list[str] = []
        for cpu_s, least_s in zip(costs_by_method[label], least, strict=True):
            is_cheapest = cpu_s is not None and cpu_s == least_s
            cells.append(strong(cpu(cpu_s)) if is_cheapest else cpu(cpu_s))
        table.append([label, *cells])
    columns = {"method": "", **{f"{tidy(error_m)} m": "number" for error_m in TARGETS_M}}
    return PageTable(columns, table).html(_CAPTIONS["costs"])


def pareto_front(rows: Sequence[Row], bound_m: float) -> Html:
    """Return the rows of the Pareto front, cheapest first."""
    labels = {row.key: curve.label for curve in curves(rows) for row in curve.rows}
    cells = [
        (labels[row.key], setting(row), number(row.error_m), cost(row), row.reason)
        for row in front(rows, bound_m)
    ]
    columns = {"method": "", "setting": "", "error m": "number", "CPU s": "number", "": ""}
    return PageTable(columns, cells).html(_CAPTIONS["front"])


def every_row(rows: Sequence[Row], bound_m: float) -> Html:
    """Return all rows with every measured value, method by method from the loosest setting to the tightest."""
    front_keys = {row.key for row in front(rows, bound_m)}
    columns = (
        dict.fromkeys(_TEXT_COLUMNS, "")
        | dict.fromkeys(_NUMBER_COLUMNS, "number")
        | {"reason": "line"}
    )
    table = []
    row_classes = []
    for curve in curves(rows):
        for row in curve.rows:
            on_front = row.key in front_keys
            classes = []
            if row is curve.rows[0]:
                classes.append("first")
            if on_front:
                classes.append("front")
            if row.failed:
                classes.append("failed")
            row_classes.append(" ".join(classes))
            cells = _cells_of(row, on_front)
            table.append([cells[name] for name in columns])
    return PageTable(columns, table, row_classes).html(_CAPTIONS["rows"])


def _cells_of(row: Row, on_front: bool) -> dict[str, str]:
    """Return everything that was measured of a row, by the title of its column."""
    return {
        "": _FRONT_MARK if on_front else "",
        "method": row.method,
        "formulation": row.formulation,
        "setting": setting(row),
        "status": row.status.words,
        "error m": number(row.error_m),
        "end error m": number(row.end_error_m),
        "transit error s": transit_error(row),
        "h drift": number(row.h_drift),
        "CPU s": cost(row),
        "spread": "" if row.cpu_spread is None else f"{100 * row.cpu_spread:.0f} %",
        "compile s": cpu(row.compile_s),
        "evaluations": count(row.rhs_evaluations),
        "steps": count(row.steps),
        "last t, s": "" if row.reached_t is None else f"{row.reached_t:g}",
        "reason": row.reason,
    }


def failures(rows: Sequence[Row]) -> Html | None:
    """Return the reasons for which rows failed, rows with the same reason together.

    None if no row failed.
    """
    failed = [(curve.label, row) for curve in curves(rows) for row in curve.rows if row.failed]
    if not failed:
        return None
    cells = []
    by_reason = grouped(failed, lambda pair: (pair[0], pair[1].status, pair[1].reason))
    for (label, status, reason), group in by_reason.items():
        times_s = sorted(row.reached_t for _, row in group if row.reached_t is not None)
        reached = ", ".join(dict.fromkeys(f"{t:g}" for t in times_s))
        settings = ", ".join(setting(row) for _, row in group)
        cells.append((label, settings, status.words, reached, reason))
    columns = {"method": "", "settings": "prose", "status": "", "last t, s": "", "reason": "prose"}
    return PageTable(columns, cells, ["failed"] * len(cells)).html(_CAPTIONS["failed"])


def words(statuses: Collection[Status], meanings: Mapping[Status, str] | None = None) -> Html:
    """Return the meaning of the words that stand for these statuses, and what to do about each.

    `meanings` are those that a report defines more exactly.
    """
    columns = {"word": "", "meaning": "prose", "what to do": "prose"}
    exact = meanings or {}
    rows = []
    for status in Status:
        if status in statuses:
            rows.append((status.words, exact.get(status, status.meaning), status.advice))
    return PageTable(columns, rows).html()


def advice(statuses: Collection[Status]) -> list[str]:
    """Return what to do about each of these statuses, as lines of text."""
    return [
        f"{status.words}: {status.advice}"
        for status in Status
        if status in statuses and status.advice
    ]


def methods(rows: Sequence[Row], bound_m: float, programs: Mapping[str, str]) -> Html:
    """Return titles, orders, sources and licences of the methods, and the user's programs and files."""
    # reversed: the first formulation, which is the usual one, is kept
    measured = {order.method: order for order in reversed(orders(rows, bound_m))}
    table = []
    for name in dict.fromkeys(row.method for row in rows):
        if name in METHODS:
            method = METHODS[name]
            declared = method.order or _ABSENT
            orders_shown = (declared, observed(measured.get(name)))
            about = (method.source, method.licence, method.extra)
            table.append((name, method.title, *orders_shown, *about))
    for name, command in programs.items():
        shown = shortened(command, LONGEST_COMMAND)
        table.append((name, shown, "", observed(measured.get(name)), "--run", "", ""))
    for row in rows:
        if row.kind == FILE:
            table.append((row.method, "", "", "", "--candidates", "", ""))
    columns = {
        "method": "",
        "": "prose",
        "order": "",
        "observed": "",
        "source": "prose",
        "licence": "",
        "extra": "",
    }
    return PageTable(columns, table).html(_CAPTIONS["orders"])


def observed(order: ObservedOrder | None) -> str:
    """Return the order that runs show, with its standard error; a dash where they do not."""
    if order is None or order.observed is None:
        return _ABSENT
    return f"{order.observed:.2f} ± {order.standard_error:.2f}"


def _orders_as_text(rows: Sequence[Row], bound_m: float) -> list[str]:
    """Return declared and observed orders as lines of text; a user's program declares none."""
    declared = orders(rows, bound_m)
    if not declared:
        return []
    usual = {order.method: order.formulation for order in reversed(declared)}
    cells = []
    for order in declared:
        other = "" if usual[order.method] == order.formulation else order.formulation
        cells.append((order.method, other, order.declared or _ABSENT, observed(order)))
    columns = {"order of": "", "": "", "declared": "number", "observed": "number"}
    return ["", *PageTable(columns, cells).lines()]


def text_table(document: dict[str, Any]) -> str:
    """Return main results, rows, and reasons of failures as text for a terminal."""
    rows = rows_of(document)
    reference = document["reference"]
    bound_m = float(reference["bound_m"])
    heading = f"{document['scene']}: {document['t_end']:g} s"
    lines = as_lines(f"{heading}, reference {reference['level']}, bound {bound_m:.1e} m")
    lines.append("")
    for sentence in sentences(document):
        lines += as_lines(sentence, hanging="  ")
    legend = (
        f"* on the Pareto front   {_PART_MARK} extrapolated from a part of the span, so without its "
        "error (see --limit)"
    )
    lines += ["", *_measured_as_text(rows, bound_m), "", *as_lines(legend)]
    if document["programs"]:
        lines += as_lines(_OF_PROGRAMS)
    statuses = {row.status for row in rows if row.failed}
    if statuses:
        lines += ["", "Failed:", *_failed_as_text(rows), ""]
        for text in advice(statuses):
            lines += as_lines(text, hanging="  ")
    lines += _orders_as_text(rows, bound_m)
    lines += ["", *as_lines(f"load: {busy(rows)}", hanging="  ")]
    return "\n".join(lines) + "\n"


def _measured_as_text(rows: Sequence[Row], bound_m: float) -> list[str]:
    """Return the rows that did not fail as lines of text."""
    front_keys = {row.key for row in front(rows, bound_m)}
    table = []
    for curve in curves(rows):
        for row in curve.rows:
            if row.failed:
                continue
            mark = "*" if row.key in front_keys else ""
            errors = (number(row.error_m), transit_error(row), number(row.h_drift))
            costs_shown = (cost(row), count(row.rhs_evaluations))
            table.append((mark, curve.label, setting(row), *errors, *costs_shown))
    heads: tuple[tuple[str, ...], ...] = (
        ("",),
        ("method",),
        ("setting",),
        ("error", "m"),
        ("transits", "s"),
        ("h drift",),
        ("CPU", "s"),
        ("calls",),
    )
    columns = []
    for place, head in enumerate(heads):
        cells = [row[place] for row in table]
        columns.append(TextColumn(head, cells, is_number=place > 1))
    # the mark, the method and its setting
    return columns_as_lines(columns, keys=3, indent="")


def _failed_as_text(rows: Sequence[Row]) -> list[str]:
    """Return the rows that failed as lines of text, with their reasons."""
    lines = []
    for curve in curves(rows):
        for row in curve.rows:
            if row.failed:
                run = f"{curve.label} {setting(row)}".rstrip()
                lines += as_lines(f"{run}: {row.status.words}: {row.reason}", "  ", hanging="  ")
    return lines


def setting(row: Row | Cell) -> str:
    """Return a row's setting with its unit; a dash for a program without one; empty for None."""
    if row.setting is None:
        return ""
    if row.setting == 0:
        return _ABSENT
    return tidy(row.setting) + {"step": " s", "precision": " bits"}.get(row.kind, "")


def number(value: float | None) -> str:
    """Return a number with three digits and an exponent; empty for None."""
    return "" if value is None else f"{value:.2e}"


def transit_error(row: Row) -> str:
    """Return the error of a row's worst transit in s, or the floor below which it is not resolved."""
    if row.transit_error_s is None and row.transit_floor_s is not None:
        return f"<{row.transit_floor_s:.1e}"
    return number(row.transit_error_s)


def cpu(value: float | None) -> str:
    """Return CPU seconds with three digits and no exponent; empty for None."""
    if value is None:
        return ""
    places = max(0, min(8, 2 - math.floor(math.log10(value)))) if value > 0 else 0
    return f"{value:.{places}f}"


def cost(row: Row) -> str:
    """Return a row's CPU seconds, marked if they are extrapolated."""
    mark = _PART_MARK if row.status == Status.EXTRAPOLATED else ""
    return f"{mark}{cpu(row.cpu_s)}"


def count(value: int | None) -> str:
    """Return a count with narrow no-break spaces between thousands; empty for None."""
    return "" if value is None else f"{value:,}".replace(",", "\u202f")


def busy(rows: Sequence[Row | Cell]) -> str:
    """Return the load while rows were measured, the spread of repeats, and a warning if it is needed.

    Rows from a journal count with the load at the time when they were measured.
    """
    loads = [row.load for row in rows if row.load is not None]
    of_study = [row for row in rows if isinstance(row, Row)]
    spreads = [row.cpu_spread for row in of_study if row.cpu_spread is not None]
    load = median(loads) if loads else 0.0
    spread = median(spreads) if spreads else 0.0
    measured = []
    if loads:
        measured.append(f"{load:.1f} processes for each core (median), {max(loads):.1f} at most")
    if spreads:
        most = max(spreads)
        measured.append(
            f"repeats of a run differ by {100 * spread:.0f} % (median), {100 * most:.0f} % at most"
        )
    text = "; ".join(measured) or "not known"
    doubt = "ratios of costs drift too, most where vectors are wide (AVX-512)"
    if load > _MAX_LOAD:
        return f"{text}. The machine was busy: {doubt}"
    if spread > _MAX_SPREAD:
        return f"{text}. Costs were uneven: {doubt}"
    return text
