"""The papers' page: every row with its verdict, figures beside their captions, in one HTML file; rows as CSV, JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, fields

from ..report.folder import PAGE, json_text
from ..report.page import Html, Table, choices, faint, page, paragraph, plate, section, strong
from .checks import VERDICTS, JudgedRow
from .figures import FIGURES

MEANING = {
    "exact": "both sides agree to 45 digits or more at every random point, or the number is exactly as printed",
    "reproduced": "the recomputed value, rounded or cut off, is the printed one; or a run confirms the sentence",
    "approximation": "an approximation; its error is measured, and the power with which it shrinks",
    "misprint": "does not hold as printed; the correction was put to the same test and holds",
}
NOT_JUDGED = (
    ("Mathar II, after (19)", "the substitution that leads from [6, (22)] to (17)-(19)", "needs the text of [6]"),
    ("Mathar V, after (50)", "compatible with footnote 5 in [17]", "needs the text of [17]; (47) and (50) are judged"),
    ("Mathar, Fig. 3, 8 and 9", "what the figures show", "they claim nothing that a number could refute; drawn above"),
    ("Mathar, Fig. 9", "the main results were obtained with steps of 0.01 s", "what was done, not what is so"),
    (
        "Mathar, appendix A",
        "what the switches mean, their other defaults, the columns of the output",
        "they define the program; `foucault pend` follows them",
    ),
)


def files_of(rows: Sequence[JudgedRow], figures: dict[int, str]) -> dict[str, str]:
    """Return every file of the page by name; the page itself comes last, after the figures that it shows.

    Args:
        rows: rows of the table.
        figures: SVG text by the paper's figure number.
    """
    documents = list(map(asdict, rows))
    return {
        **{f"figure_{number}.svg": svg for number, svg in figures.items()},
        "rows.csv": Table.of_records((field.name for field in fields(JudgedRow)), documents).csv(),
        "rows.json": json_text({"rows": documents}),
        PAGE: page_text(rows, figures),
    }


def page_text(rows: Sequence[JudgedRow], figures: dict[int, str]) -> str:
    """Return the page as HTML."""
    counts: dict[str, int] = {verdict: sum(row.verdict == verdict for row in rows) for verdict in VERDICTS}
    plates = [plate(figures[n], n, FIGURES[n].printed, FIGURES[n].remark) for n in FIGURES]
    return page(
        "The papers' formulas, numbers and figures, recomputed",
        [
            section("Verdicts", _counted(counts)),
            section("Figures of the first paper, drawn again", *plates),
            section("Not judged", _not_judged()),
            section("Every line", choices({word: f"{word} ({count})" for word, count in counts.items()}), _lines(rows)),
        ],
        lead=_lead(len(rows)),
    )


def _lead(count: int) -> Html:
    return paragraph(
        Html(
            "R. J. Mathar, <em>The Foucault Pendulum: Trajectories of the Full Lagrangian</em>; G. Gastebois, "
            "<em>Le pendule de Foucault</em>; and a third text that solves the linear system by three methods. "
            f"{count} lines of them were put to the test. Truth is the Lagrangian, differentiated; the reference "
            "solver; or a closed form. None of the verdicts below was written by hand. The recomputed value is the "
            "true one to 18 digits: of a formula at the first of several random points whose numbers are all of order "
            "one, of a printed number with the paper's own inputs. In the first paper ϕ is the latitude, φ the angle "
            "of the cord and λ its azimuth; in the second these are λ, θ and φ."
        )
    )


def _counted(counts: dict[str, int]) -> Html:
    rows = [(strong(word), count, MEANING[word]) for word, count in counts.items()]
    return Table({"verdict": "", "lines": "number", "meaning": "prose"}, rows, list(counts)).html()


def _not_judged() -> Html:
    return Table({"place": "", "printed": "prose", "why there is no verdict": "prose"}, NOT_JUDGED).html()


def _lines(rows: Sequence[JudgedRow]) -> Html:
    columns = dict.fromkeys(("place", "printed", "recomputed", "verdict"), "wrapped")
    cells = [(row.place, row.printed, row.recomputed, _verdict(row)) for row in rows]
    return Table(columns, cells, [row.verdict for row in rows], [row.id for row in rows]).html()


def _verdict(row: JudgedRow) -> Html:
    notes = [row.error, f"right: {row.correction}" if row.correction else "", row.remark]
    return Html("<br>".join([strong(row.verdict), *(faint(note) for note in notes if note)]))
