"""Report of a study (error against run time)."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from typing import Any

from ..studies.row import Row
from . import explanations, study_tables
from .busy import busy
from .folder import Report
from .page import Html, facts, figure, findings, join, page, paragraph, section
from .pareto import rows_of, sentences


def page_text(document: dict[str, Any]) -> str:
    """Return the page as HTML; `title` of the scene and `limit_s` of a run are used if the document has them."""
    rows, bound_m = rows_of(document), float(document["reference"]["bound_m"])
    conclusions = sentences(document)
    failed, lost = study_tables.failures(rows), {row.status for row in rows if not row.measured}
    programs, files = document.get("programs", {}), document.get("candidates", ())
    parts = [
        section(
            "Main results",
            findings(conclusions) if conclusions else paragraph("No method reached an error of 1e-3 m."),
        ),
        section("Least cost of an error", study_tables.costs(rows, bound_m)),
        *_pictures(document, rows, bound_m),
        section("The Pareto front", study_tables.pareto_front(rows, bound_m)),
        section("Every row", study_tables.every_row(rows, bound_m)),
        *([section("What failed, and why", failed, study_tables.words(lost))] if failed else []),
        section("How it was measured", *map(paragraph, explanations.measured(document.get("limit_s")))),
        section("The methods", study_tables.methods(rows, bound_m, programs, files)),
    ]
    return page(f"Error against run time: {document.get('title') or document['scene']}", parts, lead=_lead(document))


def _lead(document: dict[str, Any]) -> Html:
    reference, machine = document["reference"], document["machine"]
    details = {
        "scene": document["scene"],
        "span": f"{document['t_end']:g} s, {reference['transits']} transits",
        "reference": f"level {reference['level']}, bound {float(reference['bound_m']):.1e} m",
        "load": busy(rows_of(document)),
        "machine": ", ".join(machine[key] for key in ("processor", "system") if key in machine),
        "versions": ", ".join(f"{k} {v}" for k, v in machine.items() if k not in ("processor", "system")),
    }
    return join([paragraph(explanations.LEAD), facts(details)])


def _pictures(document: dict[str, Any], rows: Sequence[Row], bound_m: float) -> list[Html]:
    if importlib.util.find_spec("matplotlib") is None:
        return [section("Pictures", paragraph(explanations.NO_PICTURES))]
    from .charts import study_charts as charts

    pictures = [
        ("Error against CPU time", charts.overview(rows, bound_m), explanations.overview(rows)),
        ("Family by family", charts.by_family(rows, bound_m), explanations.FAMILIES),
        (
            "Evaluations of the right-hand side",
            charts.right_hand_sides(rows, bound_m, document["t_end"]),
            explanations.RIGHT_HAND_SIDES,
        ),
        ("Tolerance asked for, error achieved", charts.achieved_tolerance(rows, bound_m), explanations.TOLERANCE),
        ("Formulations", charts.formulations(rows, bound_m), explanations.FORMULATIONS),
        ("What digits cost", charts.precision_ladder(rows, bound_m), explanations.PRECISION),
    ]
    return [section(heading, figure(svg, caption)) for heading, svg, caption in pictures if svg is not None]


REPORT = Report("study.json", study_tables.text_table, page_text)
