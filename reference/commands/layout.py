"""Text for people: headings, facts, paragraphs and tables, in lines of at most 80 characters."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from textwrap import wrap

import typer

from ..plain_text import terminal_of

WIDEST = 80
_NARROWEST = 40
_INDENT = "  "
_GAP = "  "  # between two columns
_LABEL = 14  # width of the labels of facts, if none is wider
_BOLD = "\x1b[1m"
_USUAL = "\x1b[0m"

Fact = tuple[str, str]


def line_width() -> int:
    """Return the width of a line in characters: that of the terminal, at most 80."""
    columns = shutil.get_terminal_size((WIDEST, 24)).columns
    return max(_NARROWEST, min(WIDEST, columns))


def paragraph(text: str, indent: str = "", hanging: str = "") -> list[str]:
    """Return a text in lines. Words that are wider than a line, such as paths, stay whole.

    Args:
        text: the paragraph.
        indent: what every line begins with.
        hanging: what the lines after the first begin with besides.
    """
    return wrap(
        text,
        line_width(),
        initial_indent=indent,
        subsequent_indent=indent + hanging,
        break_long_words=False,
        break_on_hyphens=False,
    )


def facts(pairs: Iterable[Fact]) -> list[str]:
    """Return one line for each label and its text; long texts are wrapped beside their label.

    The same label again is left out.
    """
    pairs = list(pairs)
    label_width = max([_LABEL, *(len(label) for label, _ in pairs)])
    hanging = " " * (label_width + len(_GAP))
    lines = []
    before = ""
    for label, text in pairs:
        shown = "" if label == before else label
        before = label
        # the label's own spaces must not be taken for places to wrap at
        wrapped = paragraph(text, _INDENT + hanging) or [""]
        first = wrapped[0].removeprefix(_INDENT + hanging)
        lines.append(f"{_INDENT}{shown:{label_width}}{_GAP}{first}".rstrip())
        lines += wrapped[1:]
    return lines


def enumerated(texts: Sequence[str]) -> str:
    """Return texts as a phrase: a, b and c."""
    *first, last = texts
    return f"{', '.join(first)} and {last}" if first else last


@dataclass(frozen=True)
class TextColumn:
    """A column of a table: the lines of its head, and its cells; numbers are aligned right."""

    heads: Sequence[str]
    cells: Sequence[str]
    is_number: bool = True

    @property
    def width(self) -> int:
        """The number of characters of its widest head or cell."""
        return max(map(len, (*self.heads, *self.cells)), default=0)

    def lines(self, heads: int) -> Iterator[str]:
        """Yield the column line by line, with so many lines for the heads."""
        side = ">" if self.is_number else "<"
        empty = [""] * (heads - len(self.heads))
        for text in (*self.heads, *empty, *self.cells):
            yield f"{text:{side}{self.width}}"


def table(columns: Sequence[TextColumn], keys: int = 1, indent: str = _INDENT) -> list[str]:
    """Return columns side by side.

    Columns that do not fit into a line follow in another table below, which repeats the first ones.

    Args:
        columns: of the same number of cells.
        keys: how many of the first columns are repeated.
        indent: what each line begins with.
    """
    lines: list[str] = []
    for block in _blocks(columns, keys, line_width() - len(indent)):
        if lines:
            lines.append("")
        heads = max(len(column.heads) for column in block)
        rows = zip(*(column.lines(heads) for column in block), strict=True)
        lines += [f"{indent}{_GAP.join(row)}".rstrip() for row in rows]
    return lines


def _blocks(columns: Sequence[TextColumn], keys: int, width: int) -> Iterator[list[TextColumn]]:
    """Yield the columns of each table that fits into a width; one has a column besides the keys at least."""
    key_columns = list(columns[:keys])
    block = key_columns
    for column in columns[keys:]:
        wider = [*block, column]
        needed = sum(one.width + len(_GAP) for one in wider) - len(_GAP)
        if needed > width and len(block) > keys:
            yield block
            wider = [*key_columns, column]
        block = wider
    yield block


def heading(text: str, *, wraps: bool = True) -> None:
    """Print a text in bold type on a terminal (unless NO_COLOR is set).

    Args:
        text: what to print.
        wraps: whether it may take several lines; a path with a word behind it is one line.
    """
    lines = "\n".join(paragraph(text, hanging=_INDENT)) if wraps else text
    terminal = terminal_of(sys.stdout)
    if not _shows_bold_type():
        typer.echo(lines)
        return
    terminal.write(_BOLD)
    typer.echo(lines)
    terminal.write(_USUAL)


def _shows_bold_type() -> bool:
    """Return whether stdout is a terminal that may be sent escape sequences."""
    return (
        terminal_of(sys.stdout).isatty()
        and not os.environ.get("NO_COLOR")
        and os.environ.get("TERM") != "dumb"
    )


def echo(lines: Iterable[str]) -> None:
    """Print lines."""
    for line in lines:
        typer.echo(line)
