"""Outcomes as JUnit XML, which CI servers show as tests."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from reference import InputError
from reference.errors import plain_lines
from reference.system.workspace import replace_file

from .outcome import REFUSED, Outcome


def write(outcomes: Sequence[Outcome], path: Path) -> None:
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
