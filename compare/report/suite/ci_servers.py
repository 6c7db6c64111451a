"""Outcomes for CI servers: tests in JUnit XML; for GitHub Actions annotations, and a table in the job's summary.

As GitHub documents it: workflow commands on stdout, and Markdown appended to the file that GITHUB_STEP_SUMMARY names.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from reference import InputError
from reference.errors import plain_lines
from reference.system.workspace import replace_file

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


def write_junit(outcomes: Sequence[Outcome], path: Path) -> None:
    """Write outcomes into a file, which is whole at any time.

    Raises:
        InputError: it cannot be written.
    """
    try:
        replace_file(path, lambda stream: stream.write(junit_text(outcomes).encode(errors="backslashreplace")))
    except OSError as error:
        raise InputError("--junit", str(path), "a file that can be written", f"{error.strerror}.") from None


def junit_text(outcomes: Sequence[Outcome]) -> str:
    """Return a test for each candidate: a disagreement is a failure, a candidate that cannot be judged an error."""
    verdicts = [one.verdict for one in outcomes]
    counts = {
        "tests": str(len(outcomes)),
        "failures": str(verdicts.count("disagrees")),
        "errors": str(verdicts.count(REFUSED)),
    }
    root = ElementTree.Element("testsuites", counts)
    suite = ElementTree.SubElement(root, "testsuite", {"name": "foucault", **counts})
    for one in outcomes:
        timing = None if one.score is None else one.score.timing
        fields = {"classname": f"foucault.{one.scene}", "name": plain_lines(one.name)}
        case = ElementTree.SubElement(suite, "testcase", fields | ({"time": f"{timing.wall_s:.3f}"} if timing else {}))
        first, *others = [plain_lines(line) for line in one.lines]
        if one.verdict == "agrees":
            ElementTree.SubElement(case, "system-out").text = "\n".join([first, *others])
        else:
            word = "error" if one.verdict == REFUSED else "failure"
            ElementTree.SubElement(case, word, {"message": first}).text = "\n".join([first, *others])
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'
