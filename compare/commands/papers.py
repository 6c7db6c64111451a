"""`foucault paper` and `foucault pend`: the source papers recomputed, with verdicts, and the program of one of them."""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import asdict
from inspect import Parameter, Signature
from pathlib import Path
from typing import Annotated, Any

import typer

from reference.commands.progress import progress
from reference.commands.terminal import AsJson, option, stoppable

from ..papers.foucpend_options import SWITCHES, Options, Switch
from .options import finish

OUT = option(
    "--out", "Write a page with figures, CSV and JSON into this folder (extra plot).", "DIR"
)
ALSO = {"O": "-0", "l": "-1"}  # the letters may be read as digits where they are printed


def paper(
    out: Annotated[Path | None, OUT] = None,
    as_json: AsJson = False,
) -> None:
    """Judge every formula of the source papers.

    Every formula and number is recomputed; with --out the figures are redrawn too.
    """
    from ..papers import build, rows
    from ..report.folder import PAGE

    with stoppable("nothing half was written"), progress() as show:
        report = show("judging", unit="rows and figures")
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


def pend(*, exact: bool = False, **typed: str | None) -> None:
    """Run the paper's program foucPend.

    It integrates at a fixed step and prints snapshots and transits.
    """
    from ..papers.foucpend import lines

    options = Options.parse(
        {letter: text for letter, text in typed.items() if text is not None}, exact
    )
    output = lines(options)
    while block := [line for _, line in zip(range(4096), output, strict=False)]:
        sys.stdout.write("\n".join(block) + "\n")


def _parameter(letter: str, switch: Switch) -> Parameter:
    """Return the parameter of `pend` for a switch."""
    names = [f"-{letter}", *([ALSO[letter]] if letter in ALSO else [])]
    option = typer.Option(*names, metavar=switch.unit, help=f"{switch.help} [{switch.default}].")
    return Parameter(
        letter, Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[str | None, option]
    )


_EXACT = Annotated[
    bool, typer.Option("--exact", help="Print the same lines with the reference's numbers.")
]

# what typer reads: one keyword for each switch of the table, then --exact
pend.__signature__ = Signature([  # type: ignore[attr-defined]
    *(_parameter(letter, switch) for letter, switch in SWITCHES.items()),
    Parameter("exact", Parameter.KEYWORD_ONLY, default=False, annotation=_EXACT),
])  # fmt: skip
