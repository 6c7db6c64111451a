"""The lines by which a program prints its rows, from docs/paste.md, as a part of a page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib.resources import files

from reference.scenes.shipped import data_root, in_checkout

from ..page import Html, text

_BLOCK = re.compile(r"^```\w*\n(.*?)^```\n", re.MULTILINE | re.DOTALL)
_TITLE_AND_LEAD = 2  # paragraphs that say where the page is
_ANSWER = "The answer"  # the page gives it itself
# what a paragraph may mark: code, and names of numbers
_MARKS = {re.compile(r"`([^`]+)`"): r"<code>\1</code>", re.compile(r"\*(\w+)\*"): r"<em>\1</em>"}


def printing() -> Html:
    """Return what a row is, and for each kind of program a heading, the text and the lines."""
    introduction, *sections = re.split("^## ", _page(), flags=re.MULTILINE)
    parts = [*_elements(introduction)][_TITLE_AND_LEAD:]
    for section in sections:
        heading, _, content = section.partition("\n")
        if heading != _ANSWER:
            parts += [f"<h3>{text(heading)}</h3>", *_elements(content)]
    return Html("\n".join(parts))


def _page() -> str:
    """Return docs/paste.md."""
    folder = data_root().parent / "docs" if in_checkout() else files(__package__)
    return folder.joinpath("paste.md").read_text(encoding="utf-8")


def _elements(content: str) -> Iterator[str]:
    """Yield paragraphs and blocks of lines as HTML."""
    # a pattern with one group: between the paragraphs stand the blocks
    for place, part in enumerate(_BLOCK.split(content)):
        if place % 2:
            yield f"<pre>{text(part.rstrip())}</pre>"
        else:
            yield from map(_paragraph, filter(None, map(str.strip, part.split("\n\n"))))


def _paragraph(words: str) -> str:
    marked = text(words)
    for mark, element in _MARKS.items():
        marked = Html(mark.sub(element, marked))
    return f"<p>{marked}</p>"
