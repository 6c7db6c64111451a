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

_TEXTS = texts_of(__file__)


def page_text(document: dict[str, Any]) -> str:
    """Return the page as HTML."""
    rows = rows_of(document)
    bound_m = float(document["reference"]["bound_m"])
    coarse = not of_digits(rows, bound_m)
    parts = [section("Main results", _main_results(document))]
    if coarse:
        parts.append(section("Least cost of an error", study_tables.costs(rows, bound_m)))
    parts += _pictures(rows, bound_m)
    if coarse:
        parts.append(section("The Pareto front", study_tables.pareto_front(rows, bound_m)))
    parts.append(section("Every row", study_tables.every_row(rows, bound_m)))
    failures = study_tables.failures(rows)
    if failures:
        statuses = {row.status for row in rows if row.failed}
        parts.append(section("What failed, and why", failures, study_tables.words(statuses)))
    parts += [
        section("How it was measured", *_how_measured(document)),
        section("The methods", study_tables.methods(rows, bound_m, document["programs"])),
    ]
    title = document["title"] or document["scene"]
    return page(f"Error against run time: {title}", parts, lead=_lead(document))


def _main_results(document: dict[str, Any]) -> Html:
    conclusions = sentences(document)
    if not conclusions:
        return paragraph("No method reached an error of 1e-3 m.")
    return findings(conclusions)


def _how_measured(document: dict[str, Any]) -> list[Html]:
    limit = f"{document['limit_s']:g} CPU seconds"
    values = {"limit": limit, "repeat_s": REPEAT_S, "repeats": REPEATS}
    paragraphs = [paragraph(text.format(**values)) for text in _TEXTS["measured"]]
    if document["programs"]:
        paragraphs.append(paragraph(_TEXTS["program"]))
    return paragraphs


def _lead(document: dict[str, Any]) -> Html:
    reference = document["reference"]
    machine = document["machine"]
    versions = {name: text for name, text in machine.items() if name not in ("processor", "system")}
    details = {
        "scene": document["scene"],
        "span": f"{document['t_end']:g} s, {reference['transits']} transits",
        "reference": f"level {reference['level']}, bound {float(reference['bound_m']):.1e} m",
        "load": study_tables.busy(rows_of(document)),
        "machine": f"{machine['processor']}, {machine['system']}",
        "versions": ", ".join(f"{name} {text}" for name, text in versions.items()),
    }
    return join([paragraph(_TEXTS["lead"]), facts(details)])


def _pictures(rows: Sequence[Row], bound_m: float) -> list[Html]:
    if missing(["matplotlib"]):
        return [section("Pictures", paragraph(_TEXTS["no_pictures"]))]
    from . import study_charts

    charts = _TEXTS["pictures"]
    if of_digits(rows, bound_m):
        charts = {"precision_ladder": charts["precision_ladder"]}
    pictures = []
    for chart, words in charts.items():
        svg = getattr(study_charts, chart)(rows, bound_m)
        if svg is None:
            continue
        caption = words["caption"]
        if chart == "overview":
            caption += _hidden(rows)
        pictures.append(section(words["heading"], figure(svg, caption)))
    return pictures


def _hidden(rows: Sequence[Row]) -> str:
    """Return a sentence about the methods that the picture of all of them cannot show."""
    unknown = {row.key for row in rows if not row.cpu_s or not (row.measured or row.failed)}
    hidden = []
    for curve in curves(rows):
        keys = {row.key for row in curve.rows}
        if keys & unknown:
            hidden.append(curve.label)
    if not hidden:
        return ""
    return f" Runs without a cost or an error are of {', '.join(hidden)}."


REPORT = Report("study.json", study_tables.text_table, page_text)
