"""The tables of a study: of the page, and as text for a terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ..methods import METHODS
from ..studies.row import EXTRAPOLATED, Row
from . import explanations as say
from .page import Column, Html, TableRow, strong, table
from .pareto import TARGETS_M, Cost, cost_at, costs_at, curves, front, rows_of, sentences

FRONT_MARK, PART_MARK = "●", "~"
SMALL = 1.5e-3  # settings below it are written with an exponent


def costs(rows: Sequence[Row], bound_m: float) -> Html:
    """What each error costs with each method: the finest error that a method reaches decides its place."""
    found = []
    least = [next((one.cpu_s for one in costs_at(rows, error_m, bound_m)), None) for error_m in TARGETS_M]
    for curve in curves(rows):
        reached = [cost_at(curve, error_m, bound_m) for error_m in TARGETS_M]
        if any(reached):
            order = [(cost is None, cost.cpu_s if cost else 0.0) for cost in reversed(reached)]
            cells = [_cost_cell(one, best) for one, best in zip(reached, least, strict=True)]
            found.append((order, TableRow([curve.label, *cells])))
    columns = [Column("method"), *[Column(f"{tidy(error_m)} m", "number") for error_m in TARGETS_M]]
    return table(columns, [row for _, row in sorted(found, key=lambda one: one[0])], say.COSTS)


def _cost_cell(one: Cost | None, least: float | None) -> str:
    if one is None:
        return ""
    shown = f"{PART_MARK if one.extrapolated else ''}{cpu(one.cpu_s)}"
    return strong(shown) if one.cpu_s == least else shown


def pareto_front(rows: Sequence[Row], bound_m: float) -> Html:
    """The front's rows, cheapest first."""
    labels = {row.key: curve.label for curve in curves(rows) for row in curve.rows}
    columns = [Column("method"), Column("setting"), Column("error m", "number"), Column("CPU s", "number"), Column("")]
    return table(
        columns,
        [
            TableRow([labels[row.key], setting(row), number(row.error_m), cost(row), row.reason])
            for row in front(rows, bound_m)
        ],
        say.FRONT,
    )


def every_row(rows: Sequence[Row], bound_m: float) -> Html:
    """All rows, method by method from loose to tight, with all that was measured."""
    best = {row.key for row in front(rows, bound_m)}
    columns = [
        Column(""), Column("method"), Column("formulation"), Column("setting"), Column("status"),
        *[Column(title, "number") for title in (
            "error m", "end error m", "transit error s", "h drift", "CPU s", "spread", "compile s", "evaluations",
            "steps", "last t, s",
        )], Column("reason", "line"),
    ]  # fmt: skip
    made = []
    for curve in curves(rows):
        for i, row in enumerate(curve.rows):
            kinds = ["first"] * (i == 0) + ["front"] * (row.key in best) + ["failed"] * (not row.measured)
            cells = [
                FRONT_MARK if row.key in best else "", row.method, row.formulation, setting(row),
                row.status.replace("_", " "), number(row.error_m), number(row.end_error_m), number(row.transit_error_s),
                number(row.h_drift), cost(row), "" if row.cpu_spread is None else f"{100 * row.cpu_spread:.0f} %",
                cpu(row.compile_s), count(row.rhs_evaluations), count(row.steps),
                "" if row.reached_t is None else f"{row.reached_t:g}", row.reason,
            ]  # fmt: skip
            made.append(TableRow(cells, " ".join(kinds)))
    return table(columns, made, say.ROWS)


def failures(rows: Sequence[Row]) -> Html | None:
    """Why rows failed, those with the same reason together."""
    groups: dict[tuple[str, str, str], list[Row]] = {}
    for curve in curves(rows):
        for row in curve.rows:
            if not row.measured:
                groups.setdefault((curve.label, row.status, row.reason), []).append(row)
    if not groups:
        return None
    made = []
    for (label, status, reason), group in groups.items():
        reached = {f"{row.reached_t:g}" for row in group if row.reached_t is not None}
        settings = ", ".join(setting(row) for row in group)
        made.append(TableRow([label, settings, status.replace("_", " "), ", ".join(sorted(reached)), reason], "failed"))
    columns = [
        Column("method"),
        Column("settings", "prose"),
        Column("status"),
        Column("last t, s"),
        Column("reason", "prose"),
    ]
    return table(columns, made, say.FAILED)


def methods(rows: Sequence[Row]) -> Html:
    """What the methods are and where they come from; a method that is not known here is left out."""
    found = [METHODS[name] for name in dict.fromkeys(row.method for row in rows) if name in METHODS]
    columns = [Column("method"), Column("", "prose"), Column("source", "prose"), Column("licence"), Column("extra")]
    return table(columns, [TableRow([one.id, one.title, one.source, one.licence, one.extra or ""]) for one in found])


def text_table(document: dict[str, Any]) -> str:
    """The rows, why some failed, and the sentences, for a terminal of 100 columns."""
    rows, reference = rows_of(document), document["reference"]
    bound_m = float(reference["bound_m"])
    best = {row.key for row in front(rows, bound_m)}
    head = f"{document['scene']}: {document['t_end']:g} s, reference {reference['level']}, bound {bound_m:.1e} m"
    lines = [
        head,
        "",
        f"  {'method':<28}{'setting':>10}{'error m':>11}{'transits s':>11}{'h drift':>10}{'CPU s':>11}{'calls':>13}",
    ]
    notes = []
    for curve in curves(rows):
        for row in curve.rows:
            values = [
                number(row.error_m),
                number(row.transit_error_s),
                number(row.h_drift),
                cost(row),
                count(row.rhs_evaluations),
            ]
            if row.measured:
                mark = "*" if row.key in best else " "
                widths = zip(values, (11, 11, 10, 11, 13), strict=True)
                lines.append(f"{mark} {curve.label:<28}{setting(row):>10}" + "".join(f"{v:>{w}}" for v, w in widths))
            else:
                notes.append(f"  {curve.label:<28}{setting(row):>10}  {_why(row)}")
    lines += [
        "",
        f"* on the Pareto front   {PART_MARK} extrapolated from a part of the span; the errors are of that part",
    ]
    lines += ["", "Failed:", *notes] if notes else []
    return "\n".join([*lines, "", *sentences(document)]) + "\n"


def _why(row: Row) -> str:
    """Status and reason, once where the one begins with the other."""
    status = row.status.replace("_", " ")
    return row.reason if row.reason.startswith(status) else f"{status}: {row.reason}"


def setting(row: Row) -> str:
    """A row's setting with its unit."""
    return tidy(row.setting) + {"step": " s", "precision": " bits"}.get(row.kind, "")


def tidy(value: float) -> str:
    """Three digits, small numbers with an exponent: 1e-4, 2.22e-16, 0.05, 113."""
    if not 0 < abs(value) < SMALL:
        return f"{value:.3g}"
    digits, _, exponent = f"{value:.2e}".partition("e")
    return f"{digits.rstrip('0').rstrip('.')}e{int(exponent)}"


def number(value: float | None) -> str:
    """Three digits, or nothing."""
    return "" if value is None else f"{value:.2e}"


def cpu(value: float | None) -> str:
    """CPU seconds: three digits without exponent."""
    if value is None:
        return ""
    places = max(0, min(8, 2 - math.floor(math.log10(value)))) if value > 0 else 0
    return f"{value:.{places}f}"


def cost(row: Row) -> str:
    """A row's CPU seconds, marked where they are extrapolated."""
    return f"{PART_MARK if row.status == EXTRAPOLATED else ''}{cpu(row.cpu_s)}"


def count(value: int | None) -> str:
    """A count with thin spaces between thousands."""
    return "" if value is None else f"{value:,}".replace(",", "\u202f")
