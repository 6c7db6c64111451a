"""A table: titles of columns and rows of cells, rendered as HTML for a page, as text for a terminal, or as CSV.

Its rows as JSON are the rows of the document that it is made from.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from reference.errors import plain_lines

from .page import Html, text

_FORMULA = ("=", "+", "-", "@", "\t", "\n")  # may begin a formula in a spreadsheet, as OWASP lists them


@dataclass(frozen=True)
class Table:
    """Columns and rows.

    Attributes:
        columns: title and kind of each: "" for text, `number` (aligned right), `prose` (wrapped), `line` (wrapped, but
            wider), `wrapped` (wrapped anywhere; a table of only such columns is as wide as the page), or a CSS class.
        rows: cells, one for each column: text, HTML, a number, or None for an empty one.
        kinds: CSS classes of each row: `front`, `failed`, `first` (of a group), a verdict, several, or none.
        anchors: ids by which the rows can be linked to.
    """

    columns: Mapping[str, str]
    rows: Sequence[Sequence[Any]]
    kinds: Sequence[str] = ()
    anchors: Sequence[str] = ()

    @classmethod
    def of_records(cls, names: Iterable[str], records: Iterable[Mapping[str, Any]]) -> Table:
        """Return the rows of a JSON document, with these names as columns."""
        names = list(names)
        return cls(dict.fromkeys(names, ""), [[row.get(name) for name in names] for row in records])

    def html(self, caption: str = "") -> Html:
        """Return HTML that scrolls where it is wider than the screen; with prose, rows are cards on a telephone."""
        kinds = list(self.columns.values())
        cards = any(kind in ("prose", "wrapped", "line") for kind in kinds)
        classes = [f' class="{kind}"' if kind else "" for kind in kinds]
        names = [f' data-name="{text(title)}"' if cards and i else "" for i, title in enumerate(self.columns)]
        head = "".join(
            f'<th scope="col"{own}>{text(title)}</th>' for own, title in zip(classes, self.columns, strict=True)
        )
        body = []
        for i, row in enumerate(self._texts()):
            cells = "".join(f"<td{a}{b}>{text(cell)}</td>" for a, b, cell in zip(classes, names, row, strict=True))
            kind = f' class="{self.kinds[i]}"' if self.kinds and self.kinds[i] else ""
            anchor = f' id="{text(self.anchors[i])}"' if self.anchors else ""
            body.append(f"<tr{kind}{anchor}>{cells}</tr>")
        title = [f"<figcaption>{text(caption)}</figcaption>"] if caption else []
        inside = [f"<thead><tr>{head}</tr></thead>", "<tbody>", *body, "</tbody>"]
        around = ("whole" if {*kinds} == {"wrapped"} else "wide") + (" cards" if cards else "")
        lines = ["<figure>", *title, f'<div class="{around}">', "<table>", *inside, "</table>", "</div>", "</figure>"]
        return Html("\n".join(lines))

    def lines(self) -> list[str]:
        """Return lines of text, the titles first: numbers stand to the right, all else to the left."""
        rows = [list(self.columns), *self._texts()]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        sides = [">" if kind == "number" else "<" for kind in self.columns.values()]
        return [
            "  ".join(f"{cell:{side}{width}}" for cell, side, width in zip(row, sides, widths, strict=True)).rstrip()
            for row in rows
        ]

    def csv(self) -> str:
        """Return CSV: a header line, doubles with all their digits, an empty field where there is no value.

        Control characters are written out, and what a spreadsheet would run as a formula begins with an apostrophe.
        """
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(map(_harmless, row) for row in self.rows)
        return stream.getvalue()

    def _texts(self) -> list[list[str]]:
        return [["" if one is None else one if isinstance(one, str) else str(one) for one in row] for row in self.rows]


def _harmless(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    line = plain_lines(value)
    if not line.startswith(_FORMULA):
        return line
    try:
        float(line)
    except ValueError:
        return f"'{line}"
    return line
