"""Outcomes for GitHub Actions: an annotation for each candidate, and a table in the summary of the job.

As GitHub documents it: workflow commands on stdout, and Markdown appended to the file that GITHUB_STEP_SUMMARY names.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from reference import InputError

from .outcome import REFUSED, Outcome

SUMMARY = "GITHUB_STEP_SUMMARY"
LEVELS = {"agrees": "notice", "disagrees": "error", REFUSED: "error"}
SIGNS = {"agrees": "✅", "disagrees": "❌", REFUSED: "⚠️"}


def annotation(one: Outcome) -> str:
    """Return the workflow command that shows an outcome, with the verdict and what is known of its reason."""
    first, *others = one.lines
    told = [line for line in others if one.verdict != "agrees" and not line.startswith("  ")]
    place = f"file={_property(one.name)},title={_property(f'foucault {one.scene}')}"
    return f"::{LEVELS[one.verdict]} {place}::{_data(chr(10).join([first, *told]))}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")


def summary(outcomes: Sequence[Outcome]) -> str:
    """Return the table of the outcomes as Markdown, and the reasons of those that do not agree."""
    rows = ["| | scene | candidate | verdict | largest error | digits |", "|---|---|---|---|---|---|"]
    for one in outcomes:
        errors = None if one.score is None else one.score.errors
        numbers = ("", "") if errors is None else (f"{errors.max_m:.3g} m", f"{errors.digits:.1f}")
        cells = [SIGNS[one.verdict], one.scene, f"`{one.name}`", one.verdict, *numbers]
        rows.append("| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |")
    details = []
    for one in outcomes:
        if one.verdict != "agrees":
            fence = "\n".join(line.replace("```", "'''") for line in one.lines)
            details.append(f"\n<details><summary>{one.scene}</summary>\n\n```\n{fence}\n```\n</details>")
    return "\n".join(["### Foucault pendulum", "", *rows, *details, ""])


def append_summary(text: str) -> None:
    """Append a text to the summary of the job, if this runs in one.

    Raises:
        InputError: the summary cannot be written.
    """
    path = os.environ.get(SUMMARY)
    if not path:
        return
    try:
        with Path(path).open("a", encoding="utf-8", errors="backslashreplace") as stream:
            stream.write(text)
    except OSError as error:
        raise InputError(SUMMARY, path, "a file that can be written to", f"{error.strerror}.") from None
