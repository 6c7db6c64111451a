"""Make docs/studies.md again: run the studies, keep what they found in docs/studies/, and write the page from that.

    python tests/bench/studies.py [NAME…] [--page]     or: make studies

Without names all studies are run, most of an hour on a quiet machine; one that was stopped goes
on where it was. `--page` runs none and writes the page from the kept files alone. A test holds the page against them.
"""

from __future__ import annotations

import argparse
import json
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import studies_page

from compare.studies.campaign import JUDGED

ROOT = Path(__file__).resolve().parents[2]
KEPT, PAGE, WORK = ROOT / "docs/studies", ROOT / "docs/studies.md", ROOT / "build/studies"
LEFT_OUT = {
    *(
        "compile_s",
        "steps",
        "rhs_evaluations",
        "h_drift",
        "reached_t",
        "end_error_m",
        "wrong_from_s",
        "t",
    ),
    *("reason", "transit_error_s", "transit_floor_s"),
}  # of kept rows
DIGITS = 4  # significant ones of kept numbers


def main() -> None:
    """Run what was asked for, keep the results, write the page."""
    commands = studies_page.COMMANDS
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"of {', '.join(commands)}; all if none is given"
    )
    parser.add_argument(
        "--page", action="store_true", help="only write the page, from the kept files"
    )
    chosen = parser.parse_args()
    unknown = set(chosen.names) - set(commands)
    if unknown or (chosen.page and chosen.names):
        parser.error(
            f"{', '.join(unknown) or '--page'}: expected names of {', '.join(commands)}, or --page alone"
        )
    for name in [] if chosen.page else chosen.names or commands:
        keep(name, run(name, commands[name]))
    PAGE.write_text(studies_page.page(kept()), encoding="utf-8")
    sys.path.append(str(ROOT / "tests/helpers"))
    import pictures

    pictures.write()  # README's chart is drawn from the study of paris
    print(f"{PAGE}: written from {KEPT}")


def run(name: str, command: str) -> dict[str, Any]:
    """Run a command of the page, and return its JSON document; with the same folder it goes on where it stopped."""
    print(command, flush=True)
    words = [sys.executable, "-m", *shlex.split(command), "--json", "--out", str(WORK / name)]
    return dict(
        json.loads(subprocess.run(words, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)
    )


def keep(name: str, document: dict[str, Any]) -> None:
    """Write what the page needs of a document: rounded numbers, one row a line."""
    short = {
        key: _short(value) for key, value in document.items() if key not in ("rows", "long_runs")
    }
    short["judged"] = JUDGED
    for part in ("rows", "long_runs"):
        short[part] = [_row(row) for row in document.get(part, [])]
    lines = [f"{json.dumps(key)}: {_lines(value)}" for key, value in short.items()]
    KEPT.mkdir(exist_ok=True)
    (KEPT / f"{name}.json").write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def kept() -> dict[str, dict[str, Any]]:
    """Return the kept documents by their names."""
    return {
        name: json.loads((KEPT / f"{name}.json").read_text(encoding="utf-8"))
        for name in studies_page.COMMANDS
    }


def _row(row: dict[str, Any]) -> dict[str, Any]:
    # a long run's error at its end
    row = row | ({"error_m": row["error_m"][-1]} if row.get("t") else {})
    return {
        key: _short(value)
        for key, value in row.items()
        if key not in LEFT_OUT and value not in (None, "", [])
    }


def _short(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _short(one) for key, one in value.items()}
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def _lines(value: Any) -> str:
    if not isinstance(value, list) or not value:
        return json.dumps(value)
    return "[\n" + ",\n".join(f" {json.dumps(row, separators=(',', ':'))}" for row in value) + "\n]"


if __name__ == "__main__":
    main()
