"""The parts of a report: tables as HTML, as text and as CSV; sections and figures; a self-contained page of them.

Text is escaped wherever it is inserted in HTML, unless its type `Html` says that it is HTML
already.
"""

from __future__ import annotations

import base64
import csv
import hashlib
import html
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from string import Template
from typing import Any

from reference.commands.layout import TextColumn, table
from reference.plain_text import plain_lines

from ..candidates.text import is_number

# in every page; shows that a folder was written by us
MARK = '<meta name="generator" content="foucault">'
_POLICY = (
    '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; style-src $styles; '
    "script-src 'self' $scripts; worker-src blob:; img-src data:\">"
)
# may begin a formula in a spreadsheet, as OWASP lists them
_FORMULA = ("=", "+", "-", "@", "\t", "\n")


class Html(str):
    """Text that is already HTML and is inserted without escaping."""

    __slots__ = ()


def text(value: str) -> Html:
    """Return a text as HTML, escaped unless it is HTML already."""
    return value if isinstance(value, Html) else Html(html.escape(str(value)))


def join(parts: Iterable[str]) -> Html:
    """Join parts with line breaks, each escaped unless it is HTML already."""
    return Html("\n".join(text(part) for part in parts))


def strong(value: str) -> Html:
    """Return emphasised text."""
    return Html(f"<strong>{text(value)}</strong>")


def faint(value: str) -> Html:
    """Return text in a fainter colour."""
    return Html(f'<span class="faint">{text(value)}</span>')


def paragraph(value: str) -> Html:
    """Return a paragraph."""
    return Html(f"<p>{text(value)}</p>")


def findings(sentences: Iterable[str]) -> Html:
    """Return a list of the most important sentences."""
    items = "\n".join(f"<li>{text(sentence)}</li>" for sentence in sentences)
    return Html(f'<ul class="findings">\n{items}\n</ul>')


def facts(pairs: Mapping[str, str]) -> Html:
    """Return a list of names and their descriptions."""
    return Html(
        "<dl>\n"
        + "\n".join(f"<dt>{text(k)}</dt><dd>{text(v)}</dd>" for k, v in pairs.items())
        + "\n</dl>"
    )


def figure(svg: str, caption: str) -> Html:
    """Return a picture (`svg` is one SVG element) with its caption.

    On a narrow screen it scrolls.
    """
    return Html(
        f'<figure>\n<div class="wide">\n{svg}</div>\n<figcaption>{text(caption)}</figcaption>\n</figure>'
    )


def plate(svg: str, number: int, printed: str, remark: str) -> Html:
    """Return a numbered picture in its own colours, as an image, with its printed title and a remark beside it."""
    image = f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}"
    caption_html = f"<p>{strong(f'FIG. {number}.')} {text(printed)}</p>\n<p>{text(remark)}</p>"
    return Html(
        f'<figure id="figure-{number}" class="plate">\n<img alt="Figure {number}" src="{image}">\n'
        f"<figcaption>\n{caption_html}\n</figcaption>\n</figure>"
    )


def choices(kinds: Mapping[str, str]) -> Html:
    """Return a check box for each kind of row.

    `page.css` hides the rows of a kind whose box is not checked.
    """
    boxes = (
        f'<label><input type="checkbox" id="show-{kind}" checked> {text(label)}</label>'
        for kind, label in kinds.items()
    )
    return Html('<p class="choices">\n' + "\n".join(boxes) + "\n</p>")


def section(heading: str, *parts: str) -> Html:
    """Return a section of the page with a heading that can be linked to."""
    return Html(
        f'<section id="{anchor(heading)}">\n<h2>{text(heading)}</h2>\n{join(parts)}\n</section>'
    )


def anchor(heading: str) -> str:
    """Return the id by which the section with this heading can be linked to."""
    return re.sub(r"[^a-z0-9]+", "-", heading.lower()).strip("-")


def page(
    title: str, sections: Sequence[str], *, lead: str = "", script: str = "", styles: str = ""
) -> str:
    """Return a whole page.

    Args:
        title: title of the page.
        sections: results of `section`; the page links to their headings at the top.
        lead: introduction below the title.
        script: elements with data and scripts; a page that has any may load nothing but scripts
            beside it.
        styles: further styles.
    """
    content = join(sections)
    own_styles = _source("page.css") + styles
    headings = re.findall(r'<section id="([^"]+)">\n<h2>(.*?)</h2>', content)
    links = [f'<a href="#{target}">{heading}</a>' for target, heading in headings]
    return Template(_source("page.html")).substitute(
        mark=MARK,
        policy=_policy(own_styles, script) if script else "",
        title=text(title),
        styles=own_styles,
        lead=text(lead),
        links="\n".join(links) if len(links) > 1 else "",
        sections=content,
        script=script,
    )


def _policy(styles: str, script: str) -> str:
    """Return the content security policy of a page: only its own scripts and styles are used, by their hashes."""
    hashes = [_hash(code) for code in re.findall(r"<script class=.*?>(.*?)</script>", script, re.S)]
    policy = Template(_POLICY).substitute(styles=_hash(f"\n{styles}"), scripts=" ".join(hashes))
    return f"{policy}\n"


def _hash(code: str) -> str:
    """Return what allows a script or a style in a content security policy."""
    digest = base64.b64encode(hashlib.sha256(code.encode()).digest()).decode()
    return f"'sha256-{digest}'"


@cache
def _source(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


@dataclass(frozen=True)
class PageTable:
    """Columns and rows.

    Attributes:
        columns: title and kind of each: "" for text, `number` (aligned right), `prose` (wrapped),
            `line` (wrapped, but wider), `wrapped` (wrapped anywhere; a table of only such columns
            is as wide as the page), or a CSS class.
        rows: cells, one for each column: text, HTML, a number, or None for an empty one.
        kinds: CSS classes of each row: `front`, `failed`, `first` (of a group), a verdict, several,
            or none.
        anchors: ids by which the rows can be linked to.
    """

    columns: Mapping[str, str]
    rows: Sequence[Sequence[Any]]
    kinds: Sequence[str] = ()
    anchors: Sequence[str] = ()

    @classmethod
    def of_records(cls, names: Iterable[str], records: Iterable[Mapping[str, Any]]) -> PageTable:
        """Return the rows of a JSON document, with these names as columns."""
        names = list(names)
        rows = []
        for record in records:
            rows.append([record.get(name) for name in names])
        return cls(dict.fromkeys(names, ""), rows)

    def html(self, caption: str = "") -> Html:
        """Return HTML: a wide table scrolls; on a telephone the rows of one with prose are cards."""
        kinds = set(self.columns.values())
        cards = not kinds.isdisjoint(("prose", "wrapped", "line"))
        classes = "whole" if kinds == {"wrapped"} else "wide"
        if cards:
            classes += " cards"
        lines = ["<figure>"]
        if caption:
            lines.append(f"<figcaption>{text(caption)}</figcaption>")
        lines += [
            f'<div class="{classes}">',
            "<table>",
            self._head(),
            "<tbody>",
            *self._body(cards),
            "</tbody>",
            "</table>",
            "</div>",
            "</figure>",
        ]
        return Html("\n".join(lines))

    def _head(self) -> str:
        """Return the row of titles."""
        cells = [
            f'<th scope="col"{_attribute("class", kind)}>{text(title)}</th>'
            for title, kind in self.columns.items()
        ]
        return f"<thead><tr>{''.join(cells)}</tr></thead>"

    def _body(self, cards: bool) -> Iterator[str]:
        """Yield the rows; on a card each cell but the first is shown with its title."""
        openings = []
        for i, (title, kind) in enumerate(self.columns.items()):
            name = _attribute("data-name", title) if cards and i else ""
            openings.append(f"<td{_attribute('class', kind)}{name}>")
        for i, row in enumerate(self._texts()):
            kind = _attribute("class", self.kinds[i]) if self.kinds else ""
            anchor = _attribute("id", self.anchors[i]) if self.anchors else ""
            cells = [
                f"{opening}{text(cell)}</td>" for opening, cell in zip(openings, row, strict=True)
            ]
            yield f"<tr{kind}{anchor}>{''.join(cells)}</tr>"

    def lines(self, keys: int = 1) -> list[str]:
        """Return lines of text, the titles first; numbers are aligned right.

        Columns that do not fit into a line follow below, after the first `keys` columns once more.
        """
        texts = self._texts()
        columns = []
        for place, (title, kind) in enumerate(self.columns.items()):
            cells = [row[place] for row in texts]
            columns.append(TextColumn([title], cells, is_number=kind == "number"))
        return table(columns, keys, indent="")

    def csv(self) -> str:
        """Return CSV: a header line, doubles with all their digits, an empty field where there is no value.

        Control characters are written out, and what a spreadsheet would run as a formula begins
        with an apostrophe.
        """
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(map(_harmless, row) for row in self.rows)
        return stream.getvalue()

    def _texts(self) -> list[list[str]]:
        return [list(map(_cell_text, row)) for row in self.rows]


def _cell_text(cell: Any) -> str:
    """Return a cell as text; HTML stays HTML."""
    if cell is None:
        return ""
    return cell if isinstance(cell, str) else str(cell)


def _attribute(name: str, value: str) -> str:
    """Return an attribute of an HTML element; nothing if it has no value."""
    if not value:
        return ""
    return f' {name}="{text(value)}"'


def _harmless(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    line = plain_lines(value)
    return f"'{line}" if line.startswith(_FORMULA) and not is_number(line) else line
