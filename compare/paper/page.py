"""The page: figures beside the paper's captions, and every row with its verdict, in one HTML file; and as data."""

from __future__ import annotations

import base64
import csv
import html
import io
import json
import os
import shutil
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from reference import InputError

from .captions import CAPTIONS, Caption
from .judge import VERDICTS, Row

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; color: #1a1a1a; }
h1 { font-size: 1.7rem; } h2 { margin-top: 3rem; }
figure { margin: 2rem 0; display: grid; grid-template-columns: minmax(0, 5fr) minmax(0, 2fr); gap: 1.5rem; }
figure img { width: 100%; border: 1px solid #ddd; } figcaption p { margin: 0 0 .7rem; font-size: .9rem; }
figcaption .ours { color: #555; }
table { border-collapse: collapse; width: 100%; font-size: .82rem; table-layout: fixed; }
th, td { text-align: left; vertical-align: top; padding: .35rem .5rem; border-bottom: 1px solid #ddd; }
td { overflow-wrap: anywhere; } th { position: sticky; top: 0; background: #fff; }
td.number { font-variant-numeric: tabular-nums; }
.exact b { color: #00664b; } .reproduced b { color: #005a8c; }
.approximation b { color: #7a5200; } .misprint b { color: #a33c00; } tr.misprint { background: #fdf3ec; }
.note { color: #555; } nav label { margin-right: 1.2rem; }
.counts { table-layout: auto; font-size: .9rem; margin: 1.5rem 0; }
.counts td:nth-child(2) { text-align: right; }
@media (max-width: 50rem) { figure { grid-template-columns: 1fr; } }
@media (prefers-color-scheme: dark) { img { background: #fff; } }
"""

FILTER = """
for (const box of document.querySelectorAll("nav input"))
  box.addEventListener("change", () => {
    for (const row of document.querySelectorAll("tr." + box.value)) row.hidden = !box.checked;
  });
"""

MEANING = {
    "exact": "both sides agree to 45 digits and more at every random point, or the number is the very same",
    "reproduced": "the recomputed value rounds, or is cut off, to what is printed; or a run shows what is said",
    "approximation": "an approximation; its error is measured, and with which power of what it shrinks",
    "misprint": "does not hold as printed; the correction was put to the same test and holds",
}


def document(row: Row) -> dict[str, str]:
    """A row for JSON and CSV."""
    return asdict(row)


def as_json(rows: Sequence[Row]) -> str:
    """All rows as one document."""
    return json.dumps({"rows": [document(row) for row in rows]}, indent=1, ensure_ascii=False) + "\n"


def as_csv(rows: Sequence[Row]) -> str:
    """All rows as a table with a header."""
    text = io.StringIO()
    writer = csv.DictWriter(text, [*document(rows[0])], lineterminator="\n")
    writer.writeheader()
    writer.writerows(map(document, rows))
    return text.getvalue()


def as_html(rows: Sequence[Row], figures: dict[int, str]) -> str:
    """The page.

    Args:
        rows: of the table.
        figures: SVG text by the paper's figure number.
    """
    counts = {verdict: sum(row.verdict == verdict for row in rows) for verdict in VERDICTS}
    summary = "".join(
        f"<tr class='{word}'><td><b>{word}</b></td><td>{count}</td><td>{MEANING[word]}</td></tr>"
        for word, count in counts.items()
    )
    boxes = " ".join(
        f"<label><input type='checkbox' value='{word}' checked> {word} ({count})</label>"
        for word, count in counts.items()
    )
    return "\n".join(
        [
            "<!doctype html>",
            "<html lang='en'><head><meta charset='utf-8'>",
            "<meta name='viewport' content='width=device-width, initial-scale=1'>",
            f"<title>The Foucault pendulum's papers, recomputed</title><style>{STYLE}</style></head><body>",
            "<h1>The papers' formulas, numbers and figures, recomputed</h1>",
            "<p>R. J. Mathar, <em>The Foucault Pendulum: Trajectories of the Full Lagrangian</em>; G. Gastebois, ",
            "<em>Le pendule de Foucault</em>; and a third text that solves the linear system by three methods. ",
            f"{len(rows)} lines of them were put to the test. Truth is the Lagrangian, differentiated; the reference ",
            "solver; or a closed form. None of the verdicts below was written by hand. What is shown as recomputed is ",
            "the true value to 18 digits: of a formula at the first of several random points whose numbers are all of ",
            "order one, of a number with the document's own inputs. In the first paper ϕ is the latitude, φ the angle ",
            "of the cord and λ its azimuth; in the second these are λ, θ and φ.</p>",
            f"<table class='counts'>{summary}</table>",
            "<h2>Figures of the first paper, drawn again from the reference</h2>",
            *(_figure(caption, figures[caption.number]) for caption in CAPTIONS),
            "<h2>Every line</h2>",
            f"<nav>{boxes}</nav>",
            "<table><colgroup><col style='width:15%'><col style='width:29%'><col style='width:27%'>",
            "<col style='width:29%'></colgroup>",
            "<thead><tr><th>place</th><th>printed</th><th>recomputed</th><th>verdict</th></tr></thead><tbody>",
            *map(_line, rows),
            f"</tbody></table><script>{FILTER}</script></body></html>\n",
        ]
    )


def _figure(caption: Caption, svg: str) -> str:
    image = base64.b64encode(svg.encode()).decode()
    return (
        f"<figure id='figure-{caption.number}'>"
        f"<img alt='Figure {caption.number}' src='data:image/svg+xml;base64,{image}'>"
        f"<figcaption><p><strong>FIG. {caption.number}.</strong> {html.escape(caption.printed)}</p>"
        f"<p class='ours'>{html.escape(caption.remark)}</p></figcaption></figure>"
    )


def _line(row: Row) -> str:
    notes = [row.error, f"right: {row.correction}" if row.correction else "", row.remark]
    note = "<br>".join(f"<span class='note'>{html.escape(text)}</span>" for text in notes if text)
    cells = f"<td>{html.escape(row.place)}</td><td>{html.escape(row.printed)}</td>"
    cells += f"<td class='number'>{html.escape(row.recomputed)}</td>"
    verdict = f"<td><b>{row.verdict}</b>{'<br>' if note else ''}{note}</td>"
    return f"<tr class='{row.verdict}' id='{row.id}'>{cells}{verdict}</tr>"


def write(out: Path, files: dict[str, str]) -> None:
    """Write a folder whole or not at all: into a temporary one beside it, which then takes its name.

    Raises:
        InputError: `out` is a file, or a folder that holds something else, or cannot be written.
    """
    if out.exists() and (not out.is_dir() or {path.name for path in out.iterdir()} - set(files)):
        raise InputError("--out", str(out), "a new folder, or one that an earlier run made", "Choose another name.")
    out = out.resolve()
    draft = old = None
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=f".{out.name}.", dir=out.parent))
        draft.chmod(0o755)
        for name, text in files.items():
            (draft / name).write_text(text, encoding="utf-8", newline="\n")
        if out.exists():
            old = Path(tempfile.mkdtemp(prefix=f".{out.name}.old.", dir=out.parent))
            os.replace(out, old / out.name)
        os.replace(draft, out)
    except OSError as error:
        if old is not None and not out.exists():
            with suppress(OSError):
                os.replace(old / out.name, out)
        raise InputError("--out", str(out), "a folder that can be written", f"{error.strerror}.") from None
    finally:
        for left in (draft, old):
            if left is not None:
                shutil.rmtree(left, ignore_errors=True)


def files_of(rows: Sequence[Row], figures: dict[int, str]) -> dict[str, Any]:
    """Every file of the page by name."""
    return {
        "index.html": as_html(rows, figures),
        **{f"figure_{number}.svg": text for number, text in figures.items()},
        "rows.csv": as_csv(rows),
        "rows.json": as_json(rows),
    }
