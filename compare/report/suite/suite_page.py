"""The page of a suite: a table of its scenes, what was found where one does not agree, and the badge."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from reference.scenes.shipped import DATA_VERSION

from ...score.verdict import percent
from ..folder import check_folder, json_text, write_files
from ..page import Html, findings, page, paragraph, section, text
from ..table import Table
from .badge import badge, fewest_digits, message
from .outcome import Outcome, worst_verdict

JSON, CSV, PAGE, BADGE = "suite.json", "rows.csv", "index.html", "badge.svg"
KEYS = ("scene", "candidate", "verdict", "covered", "max_error_m", "digits", "tolerance_m", "error")  # of rows.csv


def suite_document(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Return the JSON document of several candidates, each of a scene of its own or all of one."""
    scenes = list(dict.fromkeys(one.scene for one in outcomes))
    return {
        "scene": scenes[0] if len(scenes) == 1 else None,
        "scenes": scenes,
        "agree": sum(one.verdict == "agrees" for one in outcomes),
        "digits": fewest_digits(outcomes),
        "data": DATA_VERSION,
        "verdict": worst_verdict(outcomes),
        "rows": [one.document() for one in outcomes],
    }


def check(out: Path) -> None:
    """Refuse a folder with somebody else's files before the work."""
    check_folder(out, (JSON, CSV, PAGE, BADGE))


def write(outcomes: Sequence[Outcome], out: Path) -> Path:
    """Write page, badge, JSON and CSV into a folder, and return the path of the page."""
    document = suite_document(outcomes)
    rows = Table.of_records(KEYS, document["rows"]).csv()
    texts = {CSV: rows, JSON: json_text(document), BADGE: badge(outcomes), PAGE: page_text(outcomes)}
    write_files(out, texts)
    return out / PAGE


def page_text(outcomes: Sequence[Outcome]) -> str:
    """Return the page as HTML."""
    numbers = ("covered", "largest error", "tolerance", "digits")
    columns = {"scene": "", "verdict": "", **dict.fromkeys(numbers, "number"), "transits": "", "candidate": "prose"}
    kinds = ["" if one.verdict == "agrees" else "failed" for one in outcomes]
    table = Table(columns, list(map(_cells, outcomes)), kinds)
    parts = [section("Scenes", Html(f'<div class="wide">{badge(outcomes)}</div>'), table.html())]
    others = [one for one in outcomes if one.verdict != "agrees"]
    if others:
        parts.append(section("What was found", *(_found(one) for one in others)))
    lead = paragraph(
        f"{message(outcomes)}: candidates held against the reference solutions of their scenes. Digits are those of "
        "the largest error, relative to the amplitude."
    )
    return page("Foucault pendulum: a suite of scenes", parts, lead=lead)


def _cells(one: Outcome) -> tuple[str, ...]:
    score = one.score
    if score is None:
        return one.scene, one.verdict, "", "", "", "", "", one.name
    transits = score.transits
    matched = (
        ""
        if transits is None
        else f"{transits.matched} matched, {len(transits.missed)} missed, {len(transits.extra)} extra"
    )
    numbers = (
        percent(score.covered),
        f"{score.errors.max_m:.2g} m",
        f"{score.tolerance_m:.2g} m",
        f"{score.errors.digits:.1f}",
    )
    return one.scene, one.verdict, *numbers, matched, one.name


def _found(one: Outcome) -> Html:
    first, *others = one.lines
    told = [line.strip() for line in others if not line.startswith("  ")]
    return Html(f"<h3>{text(one.scene)}</h3>\n{findings([first, *told])}")
