"""The page of a suite: a table of its scenes, what was found where one does not agree, and the badge."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from reference.scenes.shipped import DATA_VERSION

from ...score.verdict import percent
from ..folder import check_folder, json_text, write_files
from ..page import Html, findings, page, paragraph, section, text
from ..table import Table
from .outcome import Outcome, worst_verdict

LABEL = "Foucault pendulum"
GOOD, BAD = "#2f7d32", "#b3261e"  # white text on them has a contrast above 5 to 1
_WIDTH = 6.2  # px of a letter of 11 px, about; textLength makes it exact
_MARGIN = 8


def fewest_digits(outcomes: Sequence[Outcome]) -> float | None:
    """Return the least digits of the scenes that agree, rounded down to a tenth; None if none does."""
    digits = [one.score.errors.digits for one in outcomes if one.score is not None and one.score.agrees]
    return math.floor(10 * min(digits)) / 10 if digits else None


def message(outcomes: Sequence[Outcome]) -> str:
    """Return what the badge says."""
    agree = sum(one.verdict == "agrees" for one in outcomes)
    scenes = f"{agree} of {len(outcomes)} {'scene' if len(outcomes) == 1 else 'scenes'}"
    digits = fewest_digits(outcomes)
    middle = "" if digits is None else f" · {digits:.1f} digits"
    return f"{scenes}{middle} · data {DATA_VERSION}"


def badge(outcomes: Sequence[Outcome]) -> str:
    """Return the badge as SVG; the same outcomes give the same bytes."""
    right = message(outcomes)
    colour = GOOD if all(one.verdict == "agrees" for one in outcomes) else BAD
    widths = [round(len(text) * _WIDTH) for text in (LABEL, right)]
    first, whole = widths[0] + 2 * _MARGIN, sum(widths) + 4 * _MARGIN
    texts = "".join(
        f'<text x="{x}" y="14" textLength="{width}">{escape(text)}</text>'
        for x, width, text in ((_MARGIN, widths[0], LABEL), (first + _MARGIN, widths[1], right))
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{whole}" height="20" role="img" '
        f'aria-label="{escape(f"{LABEL}: {right}")}">\n<title>{escape(f"{LABEL}: {right}")}</title>\n'
        f'<clipPath id="r"><rect width="{whole}" height="20" rx="3"/></clipPath>\n<g clip-path="url(#r)">'
        f'<rect width="{first}" height="20" fill="#444"/><rect x="{first}" width="{whole - first}" height="20" '
        f'fill="{colour}"/></g>\n<g fill="#fff" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11">{texts}</g>'
        "\n</svg>\n"
    )


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
