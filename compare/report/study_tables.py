"""Tables of a study, as HTML for its page and as text for a terminal.

Besides, in short form for all reports of studies: numbers, settings, outcomes, and how busy the machine was.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from operator import itemgetter
from statistics import median
from textwrap import wrap
from typing import Any

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

FRONT_MARK, PART_MARK, ABSENT = "●", "~", "–"
LONGEST_COMMAND = 400  # characters of a command that a page repeats
# processes for each core; with more, runs share cores and caches, and the clock of wide vectors is lower
BUSY = 1.0
# difference of repeated costs over their median; with more, ratios of costs are doubtful
SPREAD = 0.2

TEXTS = texts_of(__file__)  # above the tables


def costs(rows: Sequence[Row], bound_m: float) -> Html:
    """Return the cost of each error with each method, sorted by the cost at the smallest error that is reached."""
    placed = []
    least = [
        next((cpu_s for _, cpu_s in costs_at(rows, error_m, bound_m)), None)
        for error_m in TARGETS_M
    ]
    for curve in curves(rows):
        reached = [cost_at(curve, error_m, bound_m) for error_m in TARGETS_M]
        if any(reached):
            order = [math.inf if cpu_s is None else cpu_s for cpu_s in reversed(reached)]
            cells = [
                strong(cpu(cpu_s)) if cpu_s is not None and cpu_s == best else cpu(cpu_s)
                for cpu_s, best in zip(reached, least, strict=True)
            ]
            placed.append((order, [curve.label, *cells]))
    columns = {"method": "", **{f"{tidy(error_m)} m": "number" for error_m in TARGETS_M}}
    return PageTable(columns, [row for _, row in sorted(placed, key=itemgetter(0))]).html(
        TEXTS["costs"]
    )


def pareto_front(rows: Sequence[Row], bound_m: float) -> Html:
    """Return the rows of the Pareto front, cheapest first."""
    labels = {row.key: curve.label for curve in curves(rows) for row in curve.rows}
    cells = [
        (labels[row.key], setting(row), number(row.error_m), cost(row), row.reason)
        for row in front(rows, bound_m)
    ]
    columns = {"method": "", "setting": "", "error m": "number", "CPU s": "number", "": ""}
    return PageTable(columns, cells).html(TEXTS["front"])


def every_row(rows: Sequence[Row], bound_m: float) -> Html:
    """Return all rows with every measured value, method by method from the loosest setting to the tightest."""
    best = {row.key for row in front(rows, bound_m)}
    numbers = (
        "error m", "end error m", "transit error s", "h drift", "CPU s", "spread", "compile s", "evaluations", "steps",
        "last t, s",
    )  # fmt: skip
    texts = ("", "method", "formulation", "setting", "status")
    columns = {**dict.fromkeys(texts, ""), **dict.fromkeys(numbers, "number"), "reason": "line"}
    cells, kinds = [], []
    for curve in curves(rows):
        for i, row in enumerate(curve.rows):
            kinds.append(
                " ".join(
                    ["first"] * (i == 0) + ["front"] * (row.key in best) + ["failed"] * row.failed
                )
            )
            cells.append((
                FRONT_MARK if row.key in best else "", row.method, row.formulation, setting(row),
                row.status.words, number(row.error_m), number(row.end_error_m), transit_error(row),
                number(row.h_drift), cost(row), "" if row.cpu_spread is None else f"{100 * row.cpu_spread:.0f} %",
                cpu(row.compile_s), count(row.rhs_evaluations), count(row.steps),
                "" if row.reached_t is None else f"{row.reached_t:g}", row.reason,
            ))  # fmt: skip
    return PageTable(columns, cells, kinds).html(TEXTS["rows"])


def failures(rows: Sequence[Row]) -> Html | None:
    """Return the reasons for which rows failed, rows with the same reason together; None if no row failed."""
    failed = [(curve.label, row) for curve in curves(rows) for row in curve.rows if row.failed]
    if not failed:
        return None
    cells = []
    by_reason = grouped(failed, lambda pair: (pair[0], pair[1].status, pair[1].reason))
    for (label, status, reason), group in by_reason.items():
        reached = {f"{row.reached_t:g}" for _, row in group if row.reached_t is not None}
        settings = ", ".join(setting(row) for _, row in group)
        cells.append((label, settings, status.words, ", ".join(sorted(reached)), reason))
    columns = {"method": "", "settings": "prose", "status": "", "last t, s": "", "reason": "prose"}
    return PageTable(columns, cells, ["failed"] * len(cells)).html(TEXTS["failed"])


def words(statuses: Collection[Status]) -> Html:
    """Return the meaning of the words that stand for these statuses, and what to do about each."""
    columns = {"word": "", "meaning": "prose", "what to do": "prose"}
    rows = [
        (status.words, status.meaning, status.advice) for status in Status if status in statuses
    ]
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
    listed = [
        METHODS[name] for name in dict.fromkeys(row.method for row in rows) if name in METHODS
    ]
    # in its usual formulation
    of_method = {order.method: order for order in reversed(orders(rows, bound_m))}
    body = [
        (
            method.id, method.title, method.order or ABSENT, observed(of_method.get(method.id)),
            method.source, method.licence, method.extra,
        )
        for method in listed
    ]  # fmt: skip
    yours = [
        (
            name,
            shortened(command, LONGEST_COMMAND),
            "",
            observed(of_method.get(name)),
            "--run",
            "",
            "",
        )
        for name, command in programs.items()
    ]
    yours += [(row.method, "", "", "", "--candidates", "", "") for row in rows if row.kind == FILE]
    columns = {
        "method": "",
        "": "prose",
        "order": "",
        "observed": "",
        "source": "prose",
        "licence": "",
        "extra": "",
    }
    return PageTable(columns, [*body, *yours]).html(TEXTS["orders"])


def observed(order: ObservedOrder | None) -> str:
    """Return the order that runs show, with its standard error; a dash where they do not."""
    if order is None or order.observed is None:
        return ABSENT
    return f"{order.observed:.2f} ± {order.standard_error:.2f}"


def _orders_as_text(rows: Sequence[Row], bound_m: float) -> list[str]:
    """Return declared and observed orders as lines of text; a user's program declares none."""
    declared = orders(rows, bound_m)
    usual = {order.method: order.formulation for order in reversed(declared)}
    texts = []
    for order in declared:
        other = "" if usual[order.method] == order.formulation else f" ({order.formulation})"
        texts.append(f"{order.method}{other} {order.declared or ABSENT}: {observed(order)}")
    return ["", *wrap(f"Order, declared: observed. {'; '.join(texts)}", 100)] if texts else []


def text_table(document: dict[str, Any]) -> str:
    """Return rows, reasons of failures and main results as text for a terminal of 100 columns."""
    rows, reference = rows_of(document), document["reference"]
    bound_m = float(reference["bound_m"])
    best = {row.key for row in front(rows, bound_m)}
    measured, failed = [], []
    for curve in curves(rows):
        for row in curve.rows:
            if not row.failed:
                mark = "*" if row.key in best else ""
                errors = number(row.error_m), transit_error(row), number(row.h_drift)
                measured.append(
                    (
                        mark,
                        curve.label,
                        setting(row),
                        *errors,
                        cost(row),
                        count(row.rhs_evaluations),
                    )
                )
            else:
                failed.append(("", curve.label, setting(row), row.status.words, row.reason))
    columns = {"": "", "method": ""} | dict.fromkeys(
        ("setting", "error m", "transits s", "h drift", "CPU s", "calls"), "number"
    )
    lines = [
        f"{document['scene']}: {document['t_end']:g} s, reference {reference['level']}, bound {bound_m:.1e} m",
        f"load: {busy(rows)}",
        "",
        *PageTable(columns, measured).lines(),
        "",
        f"* on the Pareto front   {PART_MARK} extrapolated from a part of the span, so without its error (see --limit)",
    ]
    lost = {row.status for row in rows if row.failed}
    if failed:
        reasons = PageTable(
            {"": "", "method": "", "setting": "number", "status": "", "reason": ""}, failed
        ).lines()
        lines += ["", "Failed:", *reasons, "", *advice(lost)]
    return "\n".join([*lines, *_orders_as_text(rows, bound_m), "", *sentences(document)]) + "\n"


def setting(row: Row | Cell) -> str:
    """Return a row's setting with its unit; a dash for a file or a program that has none, 0; empty for None."""
    if not row.setting:
        return "" if row.setting is None else ABSENT
    return tidy(row.setting) + {"step": " s", "precision": " bits"}.get(row.kind, "")


def number(value: float | None) -> str:
    """Return a number with three digits and an exponent; empty for None."""
    return "" if value is None else f"{value:.2e}"


def transit_error(row: Row) -> str:
    """Return the error of a row's worst transit in s, or below what it is: not resolved; empty where none was taken."""
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
    return f"{PART_MARK if row.status == Status.EXTRAPOLATED else ''}{cpu(row.cpu_s)}"


def count(value: int | None) -> str:
    """Return a count with thin spaces between thousands; empty for None."""
    return "" if value is None else f"{value:,}".replace(",", "\u202f")


def busy(rows: Sequence[Row | Cell]) -> str:
    """Return the load while rows were measured, and the spread of repeats; and that the machine was busy if it was.

    Rows that were measured earlier, and taken from a journal, count with the load of their time.
    """
    loads = [row.load for row in rows if row.load is not None]
    spreads = [
        row.cpu_spread for row in rows if isinstance(row, Row) and row.cpu_spread is not None
    ]
    parts = []
    if loads:
        parts.append(
            f"{median(loads):.1f} processes for each core (median), {max(loads):.1f} at most"
        )
    if spreads:
        usual, most = (f"{100 * spread:.0f} %" for spread in (median(spreads), max(spreads)))
        parts.append(f"repeats of a run differ by {usual} (median), {most} at most")
    text = "; ".join(parts) or "not known"
    doubt = "ratios of costs drift too, most where vectors are wide (AVX-512)"
    if loads and median(loads) > BUSY:
        return f"{text}. The machine was busy: {doubt}"
    return f"{text}. Costs were uneven: {doubt}" if spreads and median(spreads) > SPREAD else text
