"""Report of a study (error against run time)."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from typing import Any

from ..studies.measure import REPEAT_S, REPEATS
from ..studies.row import Row
from . import study_tables
from .folder import Report
from .page import Html, facts, figure, findings, join, page, paragraph, section
from .pareto import curves, of_digits, rows_of, sentences

_LEAD = (
    "How accurate and how fast integrators are on one Foucault pendulum: every method at a range of settings, its "
    "error measured against a reference solution with a known bound, its cost in CPU seconds of one core."
)
_FAMILIES = (
    "The same measurements in one panel for each family, so that each method can be told from its neighbours; all "
    "other methods are drawn in grey behind them. Methods with more digits than long double are shown below, under "
    "“What digits cost”."
)
_RIGHT_HAND_SIDES = (
    "Error against evaluations of the right-hand side: the work of a method, whatever the machine. Taylor methods have "
    "no such evaluations and are not shown."
)
_TOLERANCE = (
    "The error that a method achieves for the tolerance that it is given. The tolerance is relative and applies to one "
    "step; the error is in metres and over the whole span. Above the dotted line the error in metres is larger than "
    "the tolerance."
)
_FORMULATIONS = (
    "One method and one system, with its equations in several formulations: H = n × (n′ + Ω × n) and n (momentum), "
    "three coordinates (space), w = n × n′ and n (spin), the paper's x and y (plane), two angles (angles), and the "
    "equations that the computer derives from the Lagrangian (lagrangian)."
)
_PRECISION = (
    "CPU seconds against digits achieved, in numbers from double precision to many hundred bits. A broad grey line is "
    "the power law fitted to those settings of a method whose error is above the bound of the reference."
)
_NO_PICTURES = "The pictures need matplotlib: pip install 'foucault-reference[plot]'."


def page_text(document: dict[str, Any]) -> str:
    """Return the page as HTML; `title` of the scene and `limit_s` of a run are used if the document has them."""
    rows, bound_m = rows_of(document), float(document["reference"]["bound_m"])
    conclusions, coarse = sentences(document), not of_digits(rows, bound_m)
    failed, lost = study_tables.failures(rows), {row.status for row in rows if row.failed}
    programs, files = document.get("programs", {}), document.get("candidates", ())
    parts = [
        section(
            "Main results",
            findings(conclusions) if conclusions else paragraph("No method reached an error of 1e-3 m."),
        ),
        *([section("Least cost of an error", study_tables.costs(rows, bound_m))] if coarse else []),
        *_pictures(rows, bound_m),
        *([section("The Pareto front", study_tables.pareto_front(rows, bound_m))] if coarse else []),
        section("Every row", study_tables.every_row(rows, bound_m)),
        *([section("What failed, and why", failed, study_tables.words(lost))] if failed else []),
        section("How it was measured", *map(paragraph, _measured(document.get("limit_s")))),
        section("The methods", study_tables.methods(rows, bound_m, programs, files)),
    ]
    return page(f"Error against run time: {document.get('title') or document['scene']}", parts, lead=_lead(document))


def _lead(document: dict[str, Any]) -> Html:
    reference, machine = document["reference"], document["machine"]
    details = {
        "scene": document["scene"],
        "span": f"{document['t_end']:g} s, {reference['transits']} transits",
        "reference": f"level {reference['level']}, bound {float(reference['bound_m']):.1e} m",
        "load": study_tables.busy(rows_of(document)),
        "machine": ", ".join(machine[key] for key in ("processor", "system") if key in machine),
        "versions": ", ".join(f"{k} {v}" for k, v in machine.items() if k not in ("processor", "system")),
    }
    return join([paragraph(_LEAD), facts(details)])


def _pictures(rows: Sequence[Row], bound_m: float) -> list[Html]:
    if importlib.util.find_spec("matplotlib") is None:
        return [section("Pictures", paragraph(_NO_PICTURES))]
    from .charts import study_charts as charts

    digits = ("What digits cost", charts.precision_ladder(rows, bound_m), _PRECISION)
    errors = [
        ("Error against CPU time", charts.overview(rows, bound_m), _overview(rows)),
        ("Family by family", charts.by_family(rows, bound_m), _FAMILIES),
        ("Evaluations of the right-hand side", charts.right_hand_sides(rows, bound_m), _RIGHT_HAND_SIDES),
        ("Tolerance asked for, error achieved", charts.achieved_tolerance(rows, bound_m), _TOLERANCE),
        ("Formulations", charts.formulations(rows, bound_m), _FORMULATIONS),
    ]
    pictures = [digits] if of_digits(rows, bound_m) else [*errors, digits]
    return [section(heading, figure(svg, caption)) for heading, svg, caption in pictures if svg is not None]


def _overview(rows: Sequence[Row]) -> str:
    """Return the caption of the picture of all methods, with a list of the methods that it cannot show."""
    caption = (
        "Largest error of position over the grid against CPU seconds; down and to the left is better. The broad grey "
        "staircase is the Pareto front. Runs of which only a part was made have no error and are not shown. "
        "Crosses along the top: failed runs, at their cost. Errors below those of the methods of fixed precision have "
        "a panel of their own, with its own scale; the grey band is the bound of the reference."
    )
    unknown = {row.key for row in rows if not row.cpu_s or not (row.measured or row.failed)}
    hidden = [curve.label for curve in curves(rows) if unknown & {row.key for row in curve.rows}]
    return f"{caption} Runs without a cost or an error are of {', '.join(hidden)}." if hidden else caption


def _measured(limit_s: float | None) -> list[str]:
    """Return paragraphs that describe how a study measures."""
    limit = f"{limit_s:g} CPU seconds" if limit_s else "the limit of a run"
    return [
        "Every method runs in a process of its own and in one thread. The cost is the CPU time of the integration "
        "alone, with output at every time of the grid; it is the median of repeated runs. A run is repeated until "
        f"{REPEAT_S:g} CPU second is spent or it has run {REPEATS} times. Imports and compilation are timed apart. "
        "Before the timed runs, a run over a short span warms up the method and shows how much the whole span will "
        f"cost. If that exceeds {limit}, only a part of the span is run and its cost is scaled to the whole; the row "
        "says so. Such a row has the error at the end of the part, and none of the whole span: how an error will grow "
        "is not known, and it takes no part in pictures, fronts and costs.",
        "All methods get the same numbers: those of the scene, each rounded to the nearest double. They are compared "
        "with the reference solution of exactly these numbers, so that the rounding of the inputs does not count as an "
        "error of a method. The error is the largest distance from the reference over the grid, computed without "
        "cancellation in the method's own number type. No error counts as smaller than the bound of the reference, "
        "which the pictures show as a band.",
        "The error of a transit's time is computed from the state at the true time by one Newton step. A transit that "
        "is off by more than half the time to its neighbour counts as missed, and the row fails. The drift of the "
        "invariant h is its largest change, divided by the largest kinetic energy. Absolute times are those of the "
        "machine named above; their ratios hold elsewhere too.",
    ]


REPORT = Report("study.json", study_tables.text_table, page_text)
