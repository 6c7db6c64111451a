"""The parts that pages are made of: one self-contained HTML file, styles and pictures inside, no script.

Text is escaped wherever it is put in; what is HTML already says so by its type.
"""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

MARK = '<meta name="generator" content="foucault">'  # of every page: by it a folder of ours is known


class Html(str):
    """Text that is HTML and is put in as it stands."""

    __slots__ = ()


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        title: over it.
        kind: `text`, `number` (to the right), `prose` (may be broken into lines), `line` (the same, for long ones), or
            `wrapped` (broken anywhere: a table of nothing else is as wide as the page).
    """

    title: str
    kind: str = "text"


@dataclass(frozen=True)
class TableRow:
    """A row of a table.

    Attributes:
        cells: one for each column.
        kind: how it looks: `front`, `failed`, `first` (of a group), a verdict, several words, or nothing.
        anchor: the word by which it is linked to, or nothing.
    """

    cells: Sequence[str]
    kind: str = ""
    anchor: str = ""


def text(value: str) -> Html:
    """Escaped, unless it is HTML already."""
    return value if isinstance(value, Html) else Html(html.escape(str(value)))


def join(parts: Iterable[str]) -> Html:
    """Parts one after the other, each escaped unless it is HTML already."""
    return Html("\n".join(text(part) for part in parts))


def strong(value: str) -> Html:
    """Set off from its neighbours."""
    return Html(f"<strong>{text(value)}</strong>")


def faint(value: str) -> Html:
    """Set back behind its neighbours."""
    return Html(f'<span class="faint">{text(value)}</span>')


def paragraph(value: str) -> Html:
    """A paragraph."""
    return Html(f"<p>{text(value)}</p>")


def findings(sentences: Iterable[str]) -> Html:
    """A list of sentences that matter."""
    return Html('<ul class="findings">\n' + "\n".join(f"<li>{text(one)}</li>" for one in sentences) + "\n</ul>")


def facts(pairs: Mapping[str, str]) -> Html:
    """Names and what they stand for."""
    return Html("<dl>\n" + "\n".join(f"<dt>{text(k)}</dt><dd>{text(v)}</dd>" for k, v in pairs.items()) + "\n</dl>")


def figure(svg: str, caption: str) -> Html:
    """A picture with its caption; `svg` is one SVG element. On a narrow screen it moves inside itself."""
    return Html(f'<figure>\n<div class="wide">\n{svg}</div>\n<figcaption>{text(caption)}</figcaption>\n</figure>')


def plate(svg: str, number: int, title: str, remark: str) -> Html:
    """A numbered picture in its own colours, as an image, with its printed title and a remark beside it."""
    image = f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}"
    words = f"<p>{strong(f'FIG. {number}.')} {text(title)}</p>\n<p>{text(remark)}</p>"
    return Html(
        f'<figure id="figure-{number}" class="plate">\n<img alt="Figure {number}" src="{image}">\n'
        f"<figcaption>\n{words}\n</figcaption>\n</figure>"
    )


def choices(kinds: Mapping[str, str]) -> Html:
    """A box for each kind of row, with its label; page.css hides the rows of a kind whose box is not checked."""
    boxes = (
        f'<label><input type="checkbox" id="show-{kind}" checked> {text(label)}</label>'
        for kind, label in kinds.items()
    )
    return Html('<p class="choices">\n' + "\n".join(boxes) + "\n</p>")


def table(columns: Sequence[Column], rows: Iterable[TableRow], caption: str = "") -> Html:
    """A table that moves inside itself where it is wider than the screen."""
    head = "".join(f'<th scope="col"{_class(one)}>{text(one.title)}</th>' for one in columns)
    body = []
    for row in rows:
        cells = "".join(f"<td{_class(one)}>{text(cell)}</td>" for one, cell in zip(columns, row.cells, strict=True))
        kind = f' class="{row.kind}"' if row.kind else ""
        named = f' id="{text(row.anchor)}"' if row.anchor else ""
        body.append(f"<tr{kind}{named}>{cells}</tr>")
    title = [f"<figcaption>{text(caption)}</figcaption>"] if caption else []
    inside = [f"<thead><tr>{head}</tr></thead>", "<tbody>", *body, "</tbody>"]
    around = "whole" if all(one.kind == "wrapped" for one in columns) else "wide"
    return Html(
        "\n".join(
            ["<figure>", *title, f'<div class="{around}">', "<table>", *inside, "</table>", "</div>", "</figure>"]
        )
    )


def section(heading: str, *parts: str) -> Html:
    """A part of the page with a heading that can be linked to."""
    return Html(f'<section id="{anchor(heading)}">\n<h2>{text(heading)}</h2>\n{join(parts)}\n</section>')


def anchor(heading: str) -> str:
    """The word by which a section is linked to."""
    return re.sub(r"[^a-z0-9]+", "-", heading.lower()).strip("-")


def page(title: str, sections: Sequence[str], *, lead: str = "") -> str:
    """A whole page.

    Args:
        title: of the page.
        sections: made by `section`; their headings are linked at the top.
        lead: below the title.
    """
    headings = re.findall(r'<section id="([^"]+)">\n<h2>(.*?)</h2>', "\n".join(sections))
    links = "\n".join(f'<a href="#{where}">{heading}</a>' for where, heading in headings)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n{MARK}\n'
        f"<title>{text(title)}</title>\n<style>\n{_styles()}</style>\n</head>\n<body>\n<header>\n<h1>{text(title)}</h1>\n"
        f"{text(lead)}\n</header>\n<nav>\n{links}\n</nav>\n<main>\n{join(sections)}\n</main>\n</body>\n</html>\n"
    )


def _class(column: Column) -> str:
    return "" if column.kind == "text" else f' class="{column.kind}"'


@cache
def _styles() -> str:
    return files(__package__).joinpath("page.css").read_text(encoding="utf-8")
