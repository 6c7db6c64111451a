"""The outputs of a suite: JSON, a page and a badge, tests in JUnit XML, annotations and a summary for GitHub.

For GitHub Actions as it documents them: workflow commands on stdout, and Markdown appended to the
file that GITHUB_STEP_SUMMARY names.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any
from xml.etree import ElementTree

from reference.errors import counted, usable
from reference.plain_text import plain_lines
from reference.scenes.shipped import DATA_VERSION

from ..score.document import of_outcome
from ..score.verdict import REFUSED, Outcome, percent
from .folder import CSV, PAGE, check_folder, json_text, write_file, write_files
from .page import Html, PageTable, findings, page, paragraph, section, text

_JSON = "suite.json"
_BADGE = "badge.svg"
# of rows.csv
_KEYS = (
    "scene",
    "candidate",
    "verdict",
    "covered",
    "max_error_m",
    "digits",
    "tolerance_m",
    "error",
)
_SUMMARY = "GITHUB_STEP_SUMMARY"
_SIGNS = {"agrees": "✅", "disagrees": "❌", REFUSED: "⚠️"}  # from best to worst
_LABEL = "Foucault pendulum"
_DISAGREES = 1  # the exit status of what was judged and did not pass
# white text on these has a contrast above 5 to 1
_GOOD = "#2f7d32"
_BAD = "#b3261e"
_WIDTH = 6.2  # px of a letter of 11 px, about; textLength makes it exact
_MARGIN = 8


def suite_document(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Return the JSON document of several candidates, each of a scene of its own or all of one."""
    scenes = list(dict.fromkeys(outcome.scene for outcome in outcomes))
    return {
        "scene": scenes[0] if len(scenes) == 1 else None,
        "scenes": scenes,
        "agree": _agreeing(outcomes),
        "digits": _fewest_digits(outcomes),
        "data": DATA_VERSION,
        "verdict": max((outcome.verdict for outcome in outcomes), key=[*_SIGNS].index),
        "rows": [of_outcome(outcome) for outcome in outcomes],
    }


def _agreeing(outcomes: Sequence[Outcome]) -> int:
    return sum(outcome.verdict == "agrees" for outcome in outcomes)


def _fewest_digits(outcomes: Sequence[Outcome]) -> float | None:
    """Return the least digits of the scenes that agree, rounded down to a tenth.

    None if none does.
    """
    scores = [outcome.score for outcome in outcomes if outcome.score is not None]
    digits = [score.errors.digits for score in scores if score.agrees]
    if not digits:
        return None
    return math.floor(10 * min(digits)) / 10


def check(out: Path) -> None:
    """Before the work, refuse a folder that contains other files."""
    check_folder(out, (_JSON, CSV, PAGE, _BADGE))


def write(outcomes: Sequence[Outcome], out: Path) -> None:
    """Write page, badge, JSON and CSV into a folder."""
    document = suite_document(outcomes)
    contents = {
        CSV: PageTable.of_records(_KEYS, document["rows"]).csv(),
        _JSON: json_text(document),
        _BADGE: badge(outcomes),
        PAGE: page_text(outcomes),
    }
    write_files(out, contents)


def message(outcomes: Sequence[Outcome]) -> str:
    """Return the text of the badge."""
    facts = [f"{_agreeing(outcomes)} of {counted(len(outcomes), 'scene')}"]
    digits = _fewest_digits(outcomes)
    if digits is not None:
        facts.append(f"{digits:.1f} digits")
    facts.append(f"data {DATA_VERSION}")
    return " · ".join(facts)


def badge(outcomes: Sequence[Outcome]) -> str:
    """Return the badge as SVG; the same outcomes give the same bytes."""
    right = message(outcomes)
    title = escape(f"{_LABEL}: {right}")
    colour = _GOOD if _agreeing(outcomes) == len(outcomes) else _BAD
    label_width = round(len(_LABEL) * _WIDTH)
    message_width = round(len(right) * _WIDTH)
    first = label_width + 2 * _MARGIN
    second = message_width + 2 * _MARGIN
    texts = _badge_text(_MARGIN, label_width, _LABEL)
    texts += _badge_text(first + _MARGIN, message_width, right)
    places = {"first": first, "second": second, "whole": first + second}
    drawing = files(__package__).joinpath("badge.svg").read_text(encoding="utf-8")
    return Template(drawing).substitute(places, title=title, colour=colour, texts=texts)


def _badge_text(x: int, width: int, words: str) -> str:
    return f'<text x="{x}" y="14" textLength="{width}">{escape(words)}</text>'


def page_text(outcomes: Sequence[Outcome]) -> str:
    """Return the page as HTML."""
    numbers = ("covered", "largest error", "tolerance", "digits")
    columns = {
        "scene": "",
        "verdict": "",
        **dict.fromkeys(numbers, "number"),
        "transits": "",
        "candidate": "prose",
    }
    kinds = ["" if outcome.verdict == "agrees" else "failed" for outcome in outcomes]
    table = PageTable(columns, list(map(_cells, outcomes)), kinds)
    parts = [section("Scenes", Html(f'<div class="wide">{badge(outcomes)}</div>'), table.html())]
    reasons = [
        Html(f"<h3>{text(outcome.scene)}</h3>\n{findings(_without_bullets(outcome))}")
        for outcome in outcomes
        if outcome.verdict != "agrees" or outcome.since is not None
    ]
    if reasons:
        parts.append(section("What was found", *reasons))
    lead = paragraph(
        f"{message(outcomes)}: candidates compared with the reference solutions of their scenes. Digits are those of "
        "the largest error, relative to the amplitude."
    )
    return page("Foucault pendulum: a suite of scenes", parts, lead=lead)


def _main_lines(outcome: Outcome) -> list[str]:
    """Return the lines for people without details, which are indented."""
    first, *further = outcome.lines
    return [first, *(line for line in further if not line.startswith("  "))]


def _without_bullets(outcome: Outcome) -> list[str]:
    """Return the lines for people as items of a list, which has bullets of its own."""
    return [line.removeprefix("- ") for line in _main_lines(outcome)]


def _cells(outcome: Outcome) -> tuple[str, ...]:
    score = outcome.score
    if score is None:
        return outcome.scene, outcome.verdict, "", "", "", "", "", outcome.name
    errors = score.errors
    transits = score.transits
    matched = ""
    if transits is not None:
        missed = len(transits.missed)
        extra = len(transits.extra)
        matched = f"{transits.matched} matched, {missed} missed, {extra} extra"
    numbers = (
        percent(score.covered),
        f"{errors.max_m:.2g} m",
        f"{score.tolerance_m:.2g} m",
        f"{errors.digits:.1f}",
    )
    return outcome.scene, outcome.verdict, *numbers, matched, outcome.name


def annotation(outcome: Outcome) -> str:
    """Return the workflow command that shows an outcome, with the verdict and what is known of its reason."""
    passes = outcome.exit_status == 0
    kind = "notice" if passes else "error"
    lines = _main_lines(outcome)
    if passes and outcome.since is None:
        lines = lines[:1]
    title = _property(f"foucault {outcome.scene}")
    place = f"title={title}"
    if os.path.isfile(outcome.name):  # not a program: GitHub can link to it
        place = f"file={_property(outcome.name)},{place}"
    content = _data("\n".join(lines))
    return f"::{kind} {place}::{content}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")


def summary(outcomes: Sequence[Outcome]) -> str:
    """Return the table of the outcomes as Markdown, and the reasons of those that do not agree."""
    rows = [
        "| | scene | candidate | verdict | largest error | digits |",
        "|---|---|---|---|---|---|",
    ]
    details = []
    for outcome in outcomes:
        errors = None if outcome.score is None else outcome.score.errors
        numbers = ("", "") if errors is None else (f"{errors.max_m:.3g} m", f"{errors.digits:.1f}")
        names = [f"`{name.replace('`', chr(39))}`" for name in (outcome.scene, outcome.name)]
        cells = [_SIGNS[outcome.verdict], *names, outcome.verdict, *numbers]
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
        if outcome.verdict != "agrees" or outcome.since is not None:
            fence = "\n".join(line.replace("```", "'''") for line in outcome.lines)
            details.append(
                f"\n<details><summary>{escape(outcome.scene)}</summary>\n\n```\n{fence}\n```\n</details>"
            )
    return "\n".join(["### Foucault pendulum", "", *rows, *details, ""])


def append_summary(text: str) -> None:
    """Append a text to the summary of the job, if this runs in one.

    Raises:
        InputError: the summary cannot be written.
    """
    name = os.environ.get(_SUMMARY)
    if not name:
        return
    path = Path(name)
    with usable(_SUMMARY, path, "a file that can be written to"), path.open("ab") as stream:
        stream.write(text.encode(errors="backslashreplace"))


def write_junit(outcomes: Sequence[Outcome], path: Path) -> None:
    """Write a JUnit XML test for each candidate: a status of 1 is a failure, a refusal is an error.

    Raises:
        InputError: the file cannot be written.
    """
    failed = [outcome.exit_status for outcome in outcomes if outcome.exit_status]
    failures = failed.count(_DISAGREES)
    counts = {
        "tests": str(len(outcomes)),
        "failures": str(failures),
        "errors": str(len(failed) - failures),
    }
    root = ElementTree.Element("testsuites", counts)
    suite = ElementTree.SubElement(root, "testsuite", {"name": "foucault", **counts})
    for outcome in outcomes:
        _add_test(suite, outcome)
    ElementTree.indent(root)
    xml = ElementTree.tostring(root, encoding="unicode")
    document = f'<?xml version="1.0" encoding="UTF-8"?>\n{xml}\n'
    write_file(path, document, "--junit")


def _add_test(suite: ElementTree.Element, outcome: Outcome) -> None:
    """Add the test of a candidate."""
    timing = None if outcome.score is None else outcome.score.timing
    fields = {"classname": f"foucault.{outcome.scene}", "name": outcome.name}
    if timing:
        fields["time"] = f"{timing.wall_s:.3f}"
    case = ElementTree.SubElement(suite, "testcase", fields)
    lines = [plain_lines(line) for line in outcome.lines]
    if outcome.exit_status == 0:
        result = ElementTree.SubElement(case, "system-out")
    else:
        word = "failure" if outcome.exit_status == _DISAGREES else "error"
        message_line = lines[0] if outcome.since is None else lines[1]
        result = ElementTree.SubElement(case, word, {"message": message_line})
    result.text = "\n".join(lines)
