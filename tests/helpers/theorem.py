"""docs/theorem, the Coq development: its files in order, Coq on one of them, and changes of its statements."""

from __future__ import annotations

import re
import shutil
import subprocess
import tomllib
from dataclasses import dataclass
from pathlib import Path

THEOREM = Path(__file__).parents[2] / "docs/theorem"
INSTALL = "apt-get install -y coq libcoq-coquelicot libcoq-flocq"
LIBRARIES = ("Coquelicot", "Flocq")
PATIENCE_S = 600  # a proof that Coq does not finish is refused


@dataclass(frozen=True)
class Change:
    """A statement changed in one place; `slack` says why it is still proved, where that is known."""

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
                f"{self.file}.v has {text.count(self.old)} places for {self.why!r}, expected 1"
            )
        return text.replace(self.old, self.new)


def changes() -> list[Change]:
    """Return the changes of mutations.toml."""
    text = (THEOREM / "mutations.toml").read_text(encoding="utf-8")
    return [Change(**entry) for entry in tomllib.loads(text)["change"]]


def order() -> list[str]:
    """Return the names of the files in the order in which `make` compiles them."""
    text = (THEOREM / "Makefile").read_text(encoding="utf-8").replace("\\\n", "")
    (names,) = re.findall("^FILES := (.*)$", text, re.M)
    return names.split()


def missing() -> str | None:
    """Return what of Coq and its libraries is not installed, None if nothing is."""
    if shutil.which("coqc") is None:
        return "Coq"
    where = subprocess.run(["coqc", "-where"], capture_output=True, text=True, check=True)
    for library in LIBRARIES:
        if not (Path(where.stdout.strip()) / "user-contrib" / library).is_dir():
            return library
    return None


def compile_file(name: str, build: Path) -> subprocess.CompletedProcess[str]:
    """Let Coq read a file of the folder `build` and check its proofs."""
    command = ["coqc", "-w", "-ambiguous-paths", "-R", ".", "Foucault", f"{name}.v"]
    return subprocess.run(
        command, cwd=build, capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )


def refused_in(change: Change, base: Path, folder: Path) -> str | None:
    """Return the file whose proofs fail with the change, None if all are accepted; `base` has the compiled files."""
    build = folder / "changed"
    shutil.copytree(base, build, dirs_exist_ok=True)
    (build / f"{change.file}.v").write_text(change.changed(), encoding="utf-8")
    names = [name for name in order() if (base / f"{name}.vo").exists()]
    for name in names[names.index(change.file) :]:
        try:
            accepted = compile_file(name, build).returncode == 0
        except subprocess.TimeoutExpired:
            accepted = False
        if not accepted:
            return name
    return None
