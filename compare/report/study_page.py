"""Report of a study (error against run time)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from reference.system.documents import texts_of
from reference.system.imports import missing

from ..studies.measure import REPEAT_S, REPEATS
from ..studies.row import Row
from . import study_tables
from .folder import Report
from .page import Html, facts, figure, findings, join, page, paragraph, section
from .pareto import curves, of_digits, rows_of, sentences

TEXTS = texts_of(__file__)


def page_text(document: dict[str, Any]) -> str:
    """Return the page as HTML."""
    rows, bound_m = rows_of(document), float(document["reference"]["bound_m"])
    conclusions, coarse = sentences(document), not of_digits(rows, bound_m)
    main = (
        findings(conclusions) if conclusions else paragraph("No method reached an error of 1e-3 m.")
    )
    failed, lost = study_tables.failures(rows), {row.status for row in rows if row.failed}
    limit = f"{document['limit_s']:g} CPU seconds"
    measured = [
        words.format(limit=limit, repeat_s=REPEAT_S, repeats=REPEATS) for words in TEXTS["measured"]
    ]
    parts = [
        section("Main results", main),
        *([section("Least cost of an error", study_tables.costs(rows, bound_m))] if coarse else []),
        *_pictures(rows, bound_m),
        *(
            [section("The Pareto front", study_tables.pareto_front(rows, bound_m))]
            if coarse
            else []
        ),
        section("Every row", study_tables.every_row(rows, bound_m)),
        *([section("What failed, and why", failed, study_tables.words(lost))] if failed else []),
        section("How it was measured", *map(paragraph, measured)),
        section("The methods", study_tables.methods(rows, bound_m, document["programs"])),
    ]
    return page(
        f"Error against run time: {document['title'] or document['scene']}",
        parts,
        lead=_lead(document),
    )


def _lead(document: dict[str, Any]) -> Html:
    reference, machine = document["reference"], document["machine"]
    details = {
        "scene": document["scene"],
        "span": f"{document['t_end']:g} s, {reference['transits']} transits",
        "reference": f"level {reference['level']}, bound {float(reference['bound_m']):.1e} m",
        "load": study_tables.busy(rows_of(document)),
        "machine": f"{machine['processor']}, {machine['system']}",
        "versions": ", ".join(
            f"{k} {v}" for k, v in machine.items() if k not in ("processor", "system")
        ),
    }
    return join([paragraph(TEXTS["lead"]), facts(details)])


def _pictures(rows: Sequence[Row], bound_m: float) -> list[Html]:
    if missing(["matplotlib"]):
        return [section("Pictures", paragraph(TEXTS["no_pictures"]))]
    from . import study_charts

    pictures = []
    for chart, words in TEXTS["pictures"].items():
        if not of_digits(rows, bound_m) or chart == study_charts.precision_ladder.__name__:
            svg = getattr(study_charts, chart)(rows, bound_m)
            caption = words["caption"] + (
                _hidden(rows) if chart == study_charts.overview.__name__ else ""
            )
            pictures += [section(words["heading"], figure(svg, caption))] if svg is not None else []
    return pictures


def _hidden(rows: Sequence[Row]) -> str:
    """Return a sentence about the methods that the picture of all of them cannot show."""
    unknown = {row.key for row in rows if not row.cpu_s or not (row.measured or row.failed)}
    hidden = [curve.label for curve in curves(rows) if unknown & {row.key for row in curve.rows}]
    return f" Runs without a cost or an error are of {', '.join(hidden)}." if hidden else ""


REPORT = Report("study.json", study_tables.text_table, page_text)
