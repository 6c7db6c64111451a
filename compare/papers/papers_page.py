"""The papers' page: every row with its verdict, figures beside their captions, in one HTML file; rows as CSV, JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, fields

from reference.system.documents import texts_of

from ..report.folder import PAGE, json_text
from ..report.page import Html, PageTable, choices, faint, page, paragraph, plate, section, strong
from .checks import VERDICTS, JudgedRow
from .figures import CAPTIONS, FIGURES

TEXTS = texts_of(__file__)


def files_of(rows: Sequence[JudgedRow], figures: dict[int, str]) -> dict[str, str]:
    """Return every file of the page by name.

    The page itself comes last, after the figures that it shows.

    Args:
        rows: rows of the table.
        figures: SVG text by the paper's figure number.
    """
    documents = list(map(asdict, rows))
    return {
        **{f"figure_{number}.svg": svg for number, svg in figures.items()},
        "rows.csv": PageTable.of_records(
            (field.name for field in fields(JudgedRow)), documents
        ).csv(),
        "rows.json": json_text({"rows": documents}),
        PAGE: page_text(rows, figures),
    }


def page_text(rows: Sequence[JudgedRow], figures: dict[int, str]) -> str:
    """Return the page as HTML."""
    counts: dict[str, int] = {
        verdict: sum(row.verdict == verdict for row in rows) for verdict in VERDICTS
    }
    plates = [plate(figures[n], n, **CAPTIONS[str(n)]) for n in FIGURES]
    return page(
        "The papers' formulas, numbers and figures, recomputed",
        [
            section("Verdicts", _counted(counts)),
            section("Figures of the first paper, drawn again", *plates),
            section("Not judged", _not_judged()),
            section(
                "Every line",
                choices({word: f"{word} ({count})" for word, count in counts.items()}),
                _lines(rows),
            ),
        ],
        lead=paragraph(Html(TEXTS["lead"].format(count=len(rows)))),
    )


def _counted(counts: dict[str, int]) -> Html:
    rows = [(strong(word), count, TEXTS["meaning"][word]) for word, count in counts.items()]
    return PageTable(
        {"verdict": "", "lines": "number", "meaning": "prose"}, rows, list(counts)
    ).html()


def _not_judged() -> Html:
    rows = [tuple(line.values()) for line in TEXTS["not_judged"]]
    return PageTable(
        {"place": "", "printed": "prose", "why there is no verdict": "prose"}, rows
    ).html()


def _lines(rows: Sequence[JudgedRow]) -> Html:
    columns = dict.fromkeys(("place", "printed", "recomputed", "verdict"), "wrapped")
    cells = [(row.place, row.printed, row.recomputed, _verdict(row)) for row in rows]
    return PageTable(columns, cells, [row.verdict for row in rows], [row.id for row in rows]).html()


def _verdict(row: JudgedRow) -> Html:
    notes = [row.error, f"right: {row.correction}" if row.correction else "", row.remark]
    return Html("<br>".join([strong(row.verdict), *(faint(note) for note in notes if note)]))
