"""Report of the source papers' approximations on a scene: errors, and where each is accurate; text, JSON and page."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np

from reference import Scene
from reference.status import Status

from ..approximations import APPROXIMATIONS
from ..studies.approximation_errors import error_table, quantity_table
from ..studies.approximation_limits import LIMITS, SWEEP_S, limits, sweep
from .charts.approximations import plot
from .folder import Report
from .page import Html, Table, figure, page, paragraph, section

OVERS = ("time", "amplitude", "latitude", "length")
CURVE_TIMES = 80  # points of a curve over time


def document_of(scene: Scene, report: Callable[[int, int], None] | None = None) -> dict[str, Any]:
    """Return errors up to 20 s, 1 h, 12000 s and the end, ranges good to 1 mm, 1 µm and 1 arcsecond, and quantities.

    Args:
        scene: the scene to approximate.
        report: called with the number of tables that are measured, and of all.
    """
    t_end = float(scene.exact.t_end)
    within = min(SWEEP_S, t_end)
    tables: list[Callable[[], Iterable[Any]]] = [
        *(partial(limits, scene, over=over, t_end=t_end if over == "time" else within) for over in OVERS),
        partial(error_table, scene, t_end=t_end),
        partial(quantity_table, scene),
    ]
    measured = []
    for count, rows in enumerate(tables):
        if report is not None:
            report(count, len(tables))
        measured.append([vars(row) for row in rows()])
    *good, errors, quantities = measured
    return {
        "scene": scene.id,
        "t_end": t_end,
        "rows": errors,
        "limits": [row for of_one in good for row in of_one],
        "quantities": quantities,
    }


def text_table(report: dict[str, Any]) -> str:
    """Return the report as text for a terminal."""
    times = sorted({row["t"] for row in report["rows"]})
    errors = {(row["approximation"], row["t"]): row for row in report["rows"]}
    names = list(dict.fromkeys(row["approximation"] for row in report["rows"]))
    good = {(row["approximation"], row["limit"]): row for row in report["limits"] if row["over"] == "time"}
    rows: list[list[str]] = []
    for name in names:
        values = [errors[name, t]["error_m"] for t in times]
        cells = ["" if value is None else f"{value:.2e}" for value in values]
        intervals = [good[name, limit]["good"] for limit, _, _ in LIMITS]
        first = [name, cells[0] or "does not apply", *cells[1:]]
        rows.append([*first, *(f"{one[0][1]:.4g} s" if one else "–" for one in intervals)])
    heads = (*(f"{t:g} s" for t in times), *(f"within {name}" for name, _, _ in LIMITS))
    lines = [
        f"{report['scene']}: largest position error in m up to a time, and how long it stays within a limit",
        *Table({"": "", **dict.fromkeys(heads, "number")}, rows).lines(),
    ]
    lines.append("")
    for row in report["quantities"]:
        error = "" if row["relative_error"] is None else f"  relative error {row['relative_error']:.1e}"
        lines.append(f"{row['approximation']:22}{row['value'] or row['reason']} {row['unit']}{error}")
    return "\n".join(lines)


def report_of(scene: Scene) -> Report:
    """Return the report of a scene, whose pictures are measured when the page is made."""
    return Report("approximations.json", text_table, partial(page_text, scene))


def page_text(scene: Scene, report: dict[str, Any]) -> str:
    """Return the page as HTML."""
    t_end = report["t_end"]
    over_time = error_table(scene, t_end=t_end, times=[float(t) for t in np.geomspace(1.0, t_end, CURVE_TIMES)])
    pictures = [
        figure(
            plot(over_time),
            "Largest position error up to each time. Approximations with nearly equal errors share a line.",
        ),
        figure(
            plot(over_time, "plane_error_arcsec"), "Largest error of the direction of the swing plane up to each time."
        ),
    ]
    pictures += [
        figure(
            plot(sweep(scene, over=over, t=min(SWEEP_S, t_end))),
            f"Largest position error within {min(SWEEP_S, t_end):g} s, as a function of {over}.",
        )
        for over in OVERS[1:]
    ]
    return page(
        f"{scene.id}: how accurate the approximations are",
        [
            section("Error over time", *pictures[:2], _errors(report)),
            section("Where each is accurate", *pictures[2:], *(_limits(report, over) for over in OVERS)),
            section("Single quantities", _quantities(report)),
            section("The approximations", _about()),
        ],
        lead=paragraph(
            "The analytic and truncated models of the source papers, compared with the full Lagrangian system."
        ),
    )


def _errors(report: dict[str, Any]) -> Html:
    """Return a table with one row for each approximation: errors of position and swing plane up to each time."""
    times = sorted({row["t"] for row in report["rows"]})
    by_key = {(row["approximation"], row["t"]): row for row in report["rows"]}
    heads = (*(f"m, up to {t:g} s" for t in times), *(f"arcsec, up to {t:g} s" for t in times))
    rows = []
    for name in dict.fromkeys(row["approximation"] for row in report["rows"]):
        values = [by_key[name, t][what] for what in ("error_m", "plane_error_arcsec") for t in times]
        remark = "" if by_key[name, times[0]]["status"] == Status.OK else "does not apply to this scene"
        rows.append((name, *("" if value is None else f"{value:.3g}" for value in values), remark))
    columns = {"approximation": "", **dict.fromkeys(heads, "number"), "remark": "prose"}
    return Table(columns, rows).html("Largest errors of position and of the swing plane's direction")


def _limits(report: dict[str, Any], over: str) -> Html:
    rows = [row for row in report["limits"] if row["over"] == over]
    names = list(dict.fromkeys(row["approximation"] for row in rows))
    by_key = {(row["approximation"], row["limit"]): row for row in rows}
    columns = {"approximation": "", **{f"within {name}": "number" for name, _, _ in LIMITS}}
    cells = [(name, *(_intervals(by_key[name, limit]) for limit, _, _ in LIMITS)) for name in names]
    return Table(columns, cells).html(f"Ranges of {over} in {rows[0]['unit'] if rows else ''}")


def _intervals(row: dict[str, Any]) -> str:
    return ", ".join(f"{low:.3g} to {high:.3g}" for low, high in row["good"]) or "nowhere"


def _quantities(report: dict[str, Any]) -> Html:
    columns = {"approximation": "", "value": "number", "reference": "number", "unit": "", "relative error": "number"}
    rows = [
        (
            row["approximation"], row["value"] or row["reason"], row["truth"], row["unit"],
            "" if row["relative_error"] is None else f"{row['relative_error']:.1e}",
        )
        for row in report["quantities"]
    ]  # fmt: skip
    return Table(columns, rows).html()


def _about() -> Html:
    columns = {"id": "", "description": "prose", "source": "prose", "leaves out": "prose"}
    return Table(columns, [(one.id, one.title, one.where, one.drops) for one in APPROXIMATIONS.values()]).html()
