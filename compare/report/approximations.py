"""Report of the source papers' approximations on a scene, with charts of their errors and where each is accurate."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from reference import InputError, Scene
from reference.errors import Described, counted
from reference.numbers.precision import Array
from reference.status import Status

from ..approximations import APPROXIMATIONS, motions
from ..studies.approximation_errors import TimeRow, error_table, quantity_table
from ..studies.approximation_limits import LIMITS, SWEEP_S, UNITS, SweepRow
from ..studies.approximation_limits import limits as limits_of
from .drawing import (
    COLOURS,
    FAINT,
    GUIDE,
    ChartLine,
    draw,
    legend,
    limits,
    line_style,
    logarithmic,
    sheet,
    svg_text,
)
from .folder import Report
from .page import Html, PageTable, figure, page, paragraph, section

Swept = dict[str, list[SweepRow]]  # rows of sweeps, by what is varied
_OVERS = ("time", "amplitude", "latitude", "length")
_CURVE_TIMES = 80  # points of a curve over time
_SAME = 0.15  # relative difference: lines that differ by less everywhere are drawn as one
_WRAP = 2  # names per line of a label
_MEASURED = {"error_m": "m", "plane_error_arcsec": "arcsec"}  # errors and their units
_NAMES = {
    "error_m": "largest error of position up to then, m",
    "plane_error_arcsec": "largest error of the swing plane, arcsec",
}


def document_of(
    scene: Scene, swept: Swept, report: Callable[[int, int], None] | None = None
) -> dict[str, Any]:
    """Return errors up to 20 s, 1 h, 12000 s and the end, ranges good to 1 mm, 1 µm and 1 arcsecond, and quantities.

    Args:
        scene: the scene to approximate.
        swept: is filled with the rows of the sweeps, of which the page has pictures.
        report: called with the number of tables that are measured, and of all.
    """
    t_end = float(scene.exact.t_end)
    chosen = list(motions().values())
    tables: list[Callable[[], Iterable[Any]]] = []
    for over in _OVERS:
        end = t_end if over == "time" else min(SWEEP_S, t_end)
        tables.append(partial(limits_of, scene, chosen, over, end, swept))
    tables.append(partial(error_table, scene, chosen, t_end))
    tables.append(partial(quantity_table, scene))

    measured = []
    for count, rows in enumerate(tables):
        if report is not None:
            report(count, len(tables))
        measured.append([vars(row) for row in rows()])
    *ranges, errors, quantities = measured
    return {
        "scene": scene.id,
        "t_end": t_end,
        "rows": errors,
        "limits": [row for rows in ranges for row in rows],
        "quantities": quantities,
    }


def text_table(report: dict[str, Any]) -> str:
    """Return the report as text for a terminal: tables of its page, but for swing planes and sweeps."""
    tables = {
        f"{report['scene']}: largest errors of position": _errors(report, {"error_m": "m"}),
        "Ranges of time in s within a limit": _limits(report, "time"),
        "Single quantities": _quantities(report),
    }
    return "\n\n".join("\n".join([title, *table.lines()]) for title, table in tables.items())


def _by_approximation(
    rows: Iterable[dict[str, Any]], key: str
) -> dict[str, dict[Any, dict[str, Any]]]:
    """Return rows by approximation, in order of appearance, and by what they have at a key."""
    groups: dict[str, dict[Any, dict[str, Any]]] = {}
    for row in rows:
        groups.setdefault(row["approximation"], {})[row[key]] = row
    return groups


def report_of(scene: Scene, swept: Swept) -> Report:
    """Return the report of a scene; its errors over time are measured when the page is made."""
    return Report("approximations.json", text_table, partial(page_text, scene, swept))


def page_text(scene: Scene, swept: Swept, report: dict[str, Any]) -> str:
    """Return the page as HTML."""
    t_end = report["t_end"]
    times = [float(t) for t in np.geomspace(1.0, t_end, _CURVE_TIMES)]
    over_time = error_table(scene, [*motions().values()], t_end, times=times)
    same_line = "Approximations with nearly equal errors share a line."
    within = f"Largest position error within {min(SWEEP_S, t_end):g} s, as a function of"
    sweeps = [figure(chart(rows), f"{within} {over}.") for over, rows in swept.items()]
    ranges = [_limits(report, over).html(f"Ranges of {over} in {UNITS[over]}") for over in _OVERS]
    return page(
        f"{scene.id}: how accurate the approximations are",
        [
            section(
                "Error over time",
                figure(chart(over_time), f"Largest position error up to each time. {same_line}"),
                figure(
                    chart(over_time, "plane_error_arcsec"),
                    "Largest error of the direction of the swing plane up to each time.",
                ),
                _errors(report, _MEASURED).html(
                    "Largest errors of position and of the swing plane's direction"
                ),
            ),
            section("Where each is accurate", *sweeps, *ranges),
            section("Single quantities", _quantities(report).html()),
            section("The approximations", _about()),
        ],
        lead=paragraph(
            "The analytic and truncated models of the source papers, compared with the full Lagrangian system."
        ),
    )


def _errors(report: dict[str, Any], measured: Mapping[str, str]) -> PageTable:
    """Return a table of errors up to each time, one row for each approximation.

    Args:
        report: the document of the command.
        measured: the errors to show, with their units.
    """
    times = sorted({row["t"] for row in report["rows"]})
    heads = [f"{unit}, up to {t:g} s" for unit in measured.values() for t in times]
    rows = []
    for name, errors in _by_approximation(report["rows"], "t").items():
        values = [errors[t][what] for what in measured for t in times]
        texts = ["" if value is None else f"{value:.3g}" for value in values]
        applies = errors[times[0]]["status"] == Status.OK
        remark = "" if applies else "does not apply to this scene"
        rows.append((name, *texts, remark))
    columns = {"approximation": "", **dict.fromkeys(heads, "number"), "remark": "prose"}
    return PageTable(columns, rows)


def _limits(report: dict[str, Any], over: str) -> PageTable:
    rows = [row for row in report["limits"] if row["over"] == over]
    names = [name for name, _, _ in LIMITS]
    columns = {"approximation": "", **{f"within {name}": "number" for name in names}}
    cells = []
    for approximation, intervals in _by_approximation(rows, "limit").items():
        cells.append((approximation, *[_intervals(intervals[name]) for name in names]))
    return PageTable(columns, cells)


def _intervals(row: dict[str, Any]) -> str:
    return ", ".join(f"{low:.3g} to {high:.3g}" for low, high in row["good"]) or "nowhere"


def _quantities(report: dict[str, Any]) -> PageTable:
    columns = {
        "approximation": "",
        "value": "number",
        "reference": "number",
        "unit": "",
        "relative error": "number",
    }
    rows = []
    for row in report["quantities"]:
        value = row["value"] or row["reason"]
        error = row["relative_error"]
        error_text = "" if error is None else f"{error:.1e}"
        rows.append((row["approximation"], value, row["truth"], row["unit"], error_text))
    return PageTable(columns, rows)


def _about() -> Html:
    columns = {"id": "", "description": "prose", "source": "prose", "leaves out": "prose"}
    rows = [(each.id, each.title, each.where, each.drops) for each in APPROXIMATIONS.values()]
    return PageTable(columns, rows).html()


def chart(rows: Sequence[TimeRow], what: str = "error_m") -> str:
    """Return an SVG of the errors in `rows`: those of `error_table` at many times, or of one `sweep`.

    Args:
        rows: rows of one kind; those without an error are left out.
        what: error to draw, `error_m` or `plane_error_arcsec`.

    Raises:
        InputError: there is nothing to draw, or matplotlib is not installed.
    """
    lines = _lines(rows, what)
    if not lines:
        raise InputError("rows", Described(counted(len(rows), "row")), f"rows with {what}")
    over = rows[0].over if isinstance(rows[0], SweepRow) else "time"
    lines_of_legend = sum(line.name.count("\n") + 1 for line in lines)
    height_in = max(4.8, 0.3 * lines_of_legend + 3)
    with sheet((9.5, height_in)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "y", *limits([y for line in lines for y in line.y]), 16)
        low = min(line.x[0] for line in lines)
        high = max(line.x[-1] for line in lines)
        if over == "latitude":
            axes.set_xlim(low, high)
            axes.grid(True, axis="x")
        else:
            logarithmic(axes, "x", low, high)
        draw(axes, lines)
        _draw_limits(axes, what)
        if over == "time":
            axes.set_xlabel("time since release, s")
        else:
            axes.set_xlabel(f"{over.replace('_', ' ')}, {UNITS[over]}")
        axes.set_ylabel(_NAMES[what])
        legend(axes, lines)
        names = ", ".join(line.name.replace("\n", ", ") for line in lines)
        description = f"{_NAMES[what].capitalize()}, against {over}: {names}."
        return svg_text(figure, f"{over}-{what}", description)


def _draw_limits(axes: Any, what: str) -> None:
    """Draw the limits of a good approximation as guide lines, as far as the axis shows them."""
    low, high = axes.get_ylim()
    place = axes.get_yaxis_transform()
    for name, quantity, limit in LIMITS:
        if quantity == what and low < limit < high:
            axes.axhline(limit, **GUIDE)
            style = {"ha": "right", "va": "bottom", "color": FAINT, "fontsize": 8}
            axes.text(0.995, limit, name, transform=place, **style)


def _lines(rows: Sequence[TimeRow], what: str) -> list[ChartLine]:
    """Return the lines of the rows, the one with the largest last error first."""
    groups: list[_Group] = []
    for name in dict.fromkeys(row.approximation for row in rows):
        drawn = [row for row in rows if row.approximation == name and getattr(row, what)]
        if not drawn:
            continue
        x = np.array([row.value if isinstance(row, SweepRow) else row.t for row in drawn])
        y = np.array([getattr(row, what) for row in drawn])
        group = next((group for group in groups if group.coincides_with(x, y)), None)
        if group is None:
            groups.append(_Group([name], x, y))
        else:
            group.names.append(name)
    groups.sort(key=lambda group: -group.y[-1])
    lines = []
    for i, group in enumerate(groups):
        style = line_style(COLOURS[i % len(COLOURS) - 1], i)  # begins with the darkest colour
        lines.append(ChartLine(_wrapped(group.names), group.x.tolist(), group.y.tolist(), style))
    return lines


@dataclass(frozen=True)
class _Group:
    """Approximations whose errors coincide: one line with several names."""

    names: list[str]
    x: Array
    y: Array

    def coincides_with(self, x: Array, y: Array) -> bool:
        """Return whether another line has the same points, up to a difference that nobody sees."""
        return np.array_equal(self.x, x) and bool(np.all(np.abs(y / self.y - 1) < _SAME))


def _wrapped(names: Sequence[str]) -> str:
    return "\n".join(", ".join(names[i : i + _WRAP]) for i in range(0, len(names), _WRAP))
