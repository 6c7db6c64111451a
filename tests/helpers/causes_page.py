"""The table of all causes in docs/oracle.md, written anew from the code: python tests/helpers/causes_page.py."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from places import ROOT

from compare.diagnosis.advice import DO, FAMILIES, HABITS
from compare.diagnosis.causes import LOOSE, causes_of
from compare.diagnosis.fitted import MODELS
from compare.diagnosis.programs import EFFECTIVE_G, Program

PAGE, BEFORE = ROOT / "docs/oracle.md", "## All causes\n"
RIGHT = Program(
    9.80665, 67.0, 48.846, 7.292115e-5, 6378137.0, 1 / 298.257, 0.0, 0.001, 0.3, 0.4, 0.01, 0.02
)


def causes() -> dict[str, str]:
    """Return what is said of each cause, by its word; one entry for a family of words."""
    said: dict[str, str] = {}
    rows = SimpleNamespace(cord=67.1)
    for right in (RIGHT, replace(RIGHT, suspension=EFFECTIVE_G)):
        for released in (True, False):
            for kind in ("sphere", "linear", "angle"):
                case: Any = SimpleNamespace(
                    right=right, released=released, rows=rows, intervals=1440
                )
                for cause in causes_of(case, kind):
                    family = next((one for one in FAMILIES if cause.id.startswith(one)), cause.id)
                    said.setdefault(family, cause.text.replace("{value}", "…"))
    return dict(MODELS.values()) | said | {"integrator_loose": LOOSE}


def lines() -> Iterator[str]:
    """Yield the lines of the section.

    Raises:
        SystemExit: a cause has no advice here, or an advice no cause.
    """
    said = causes()
    if set(said) != set(DO):
        raise SystemExit(
            f"{__file__}: DO lacks {set(said) - set(DO)}, and has for nothing {set(DO) - set(said)}"
        )
    yield "The word appears in the JSON document (`causes`). A word that ends in … represents several."
    yield ""
    yield "| word | your program … | what to do |"
    yield "|---|---|---|"
    for word, text in said.items():
        yield f"| `{word}{'…' * (word in FAMILIES)}` | {text.replace('|', chr(92) + '|')} | {DO[word]} |"
    yield ""
    yield "And these are conventions of a file. Most are converted:"
    yield ""
    yield "| word | your file … | what to do |"
    yield "|---|---|---|"
    for words, (text, advice) in HABITS.items():
        quoted = ", ".join(f"`{word}`" for word in words.split(", "))
        yield f"| {quoted} | {text.replace('|', chr(92) + '|')} | {advice} |"


def page() -> str:
    """Return the page as it should be: what is written by hand, then the tables."""
    return "\n".join([PAGE.read_text(encoding="utf-8").partition(BEFORE)[0] + BEFORE, *lines(), ""])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
