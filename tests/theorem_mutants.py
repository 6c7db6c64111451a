"""Change one statement of docs/theorem at a time: does Coq still accept the proof?

    python tests/theorem_mutants.py              about a quarter of an hour
    python tests/theorem_mutants.py "(4.3)"      only those with this in their reason

The changes are in docs/theorem/mutations.toml. One that is still proved shows slack in a statement; it is listed, and
the status is 1 unless the file says why it is there.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

THEOREM = Path(__file__).parents[1] / "docs/theorem"
PATIENCE_S = 600


@dataclass(frozen=True)
class Change:
    """A statement with one place changed; `slack` says why it is still proved, if it is known to be."""

    file: str
    why: str
    old: str
    new: str
    slack: str = ""

    def changed(self) -> str:
        """Return the text of the file with the change."""
        text = (THEOREM / f"{self.file}.v").read_text(encoding="utf-8")
        if text.count(self.old) != 1:
            raise ValueError(
                f"{self.file}.v has {text.count(self.old)} places for {self.why!r}: need 1"
            )
        return text.replace(self.old, self.new)


def changes() -> list[Change]:
    """Return the changes of mutations.toml."""
    text = (THEOREM / "mutations.toml").read_text(encoding="utf-8")
    return [Change(**entry) for entry in tomllib.loads(text)["change"]]


def order() -> list[str]:
    """Return the names of the files in the order in which `make` compiles them, without that of the assumptions."""
    text = (THEOREM / "Makefile").read_text(encoding="utf-8").replace("\\\n", "")
    line = next(line for line in text.splitlines() if line.startswith("FILES"))
    return line.split(":=")[1].split()[:-1]


def compiles(name: str, build: Path) -> bool:
    """Tell whether Coq accepts a file of `build`, all its proofs included."""
    command = ["coqc", "-w", "-ambiguous-paths", "-R", ".", "Foucault", f"{name}.v"]
    try:
        run = subprocess.run(
            command, cwd=build, capture_output=True, timeout=PATIENCE_S, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return run.returncode == 0


def refused_in(change: Change, base: Path, names: list[str]) -> str | None:
    """Return the file whose proofs fail with the change, None if all are still accepted."""
    with tempfile.TemporaryDirectory() as folder:
        build = Path(folder) / "theorem"
        shutil.copytree(base, build)
        (build / f"{change.file}.v").write_text(change.changed(), encoding="utf-8")
        for name in names[names.index(change.file) :]:
            if not compiles(name, build):
                return name
    return None


def main(part: str = "") -> int:
    """Try every change whose reason contains `part`; return the status."""
    with tempfile.TemporaryDirectory() as folder:
        base = Path(folder) / "base"
        base.mkdir()
        names = order()
        for name in names:
            shutil.copy(THEOREM / f"{name}.v", base)
            start = time.perf_counter()
            if not compiles(name, base):
                print(f"{name}.v does not compile as it is", file=sys.stderr)
                return 2
            print(f"{name}.v compiles, {time.perf_counter() - start:.1f} s", flush=True)

        unexplained = 0
        for change in [change for change in changes() if part in change.why]:
            failing = refused_in(change, base, names)
            if failing is None:
                unexplained += not change.slack
                verdict = f"STILL PROVED ({change.slack or 'slack that nobody explains'})"
            else:
                verdict = f"refused in {failing}.v"
            print(f"{change.file}: {change.why}: {verdict}", flush=True)
    return int(unexplained > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
