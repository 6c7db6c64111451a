"""`foucault paper`: recompute the source papers' formulas, numbers and figures, with a verdict on each."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

from reference.commands.progress import progress
from reference.commands.terminal import AsJson, option, stoppable

from .options import finish

OUT = option("--out", "Write a page with figures, CSV and JSON into this folder (extra plot).", "DIR")


def command(
    out: Annotated[Path | None, OUT] = None,
    as_json: AsJson = False,
) -> None:
    """Judge every formula of the source papers.

    Every formula and number is computed again; with --out the figures are drawn again too.
    """
    from ..papers import build, rows
    from ..report.folder import PAGE

    with stoppable("nothing half was written"), progress() as show:
        judging = show("judging", unit="rows and figures")

        def report(place: str, completed: int, total: int) -> None:
            judging(completed, total, place)

        judged = rows(report) if out is None else build(out, report)
    result = {"out": None if out is None else str(out), "rows": list(map(asdict, judged))}
    finish(result, _text, None if out is None else out / PAGE, as_json)


def _text(result: dict[str, Any]) -> str:
    lines = []
    for row in result["rows"]:
        detail = row["error"] or row["correction"]
        lines.append(f"{row['verdict']:13}  {row['place']}: {row['printed']}")
        lines.append(f"{'':13}  {row['recomputed']}{f'  ({detail})' if detail else ''}")
    counts = Counter(row["verdict"] for row in result["rows"])
    return "\n".join([*lines, "", *(f"{verdict:13}  {count}" for verdict, count in counts.items())])
