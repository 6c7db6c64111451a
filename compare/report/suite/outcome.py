"""The candidates of a suite, found by the names of their files, and the outcome of judging each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reference import FoucaultError, InputError
from reference.status import Status

from ...score.scored import Score
from ...score.verdict import document, lines

SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".out", ".npy", ".npz")
TRANSITS = ".transits"
REFUSED = Status.REFUSED.value  # the verdict on a candidate that could not be judged
ORDER = ("agrees", "disagrees", REFUSED)  # from best to worst


@dataclass(frozen=True)
class SuiteFiles:
    """The files of a suite for one scene, such as paris.csv, with paris.transits.csv beside it.

    Attributes:
        scene: id of a scene that ships, or the path of a TOML file of the same name beside the candidate.
        candidate: its file; None if there are transits alone.
        transits: the file of its transits, or None.
    """

    scene: str
    candidate: Path | None
    transits: Path | None

    @property
    def name(self) -> str:
        """The candidate's file, or that of its transits."""
        return str(self.candidate or self.transits)


def suite_files(folder: Path) -> list[SuiteFiles]:
    """List the candidates of a folder by their scenes, sorted.

    Raises:
        InputError: it is no folder, holds no candidates, or two for one scene.
    """
    if not folder.is_dir():
        raise InputError(
            "--suite", str(folder), "a folder", "Its files are named by their scenes: paris.csv, hard.npz."
        )
    by_scene: dict[str, dict[bool, Path]] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix.lower() not in SUFFIXES or not path.is_file():
            continue
        of_transits = path.stem.endswith(TRANSITS)
        others = by_scene.setdefault(path.stem.removesuffix(TRANSITS), {})
        if of_transits in others:
            raise InputError("--suite", f"{others[of_transits].name} and {path.name}", "one file for a scene")
        others[of_transits] = path
    if not by_scene:
        expected = f"files named by their scenes, with one of {', '.join(SUFFIXES)}"
        raise InputError("--suite", str(folder), expected, "For paris: paris.csv, and paris.transits.csv if you like.")
    suite = []
    for scene, paths in sorted(by_scene.items()):
        described = folder / f"{scene}.toml"
        suite.append(SuiteFiles(str(described) if described.is_file() else scene, paths.get(False), paths.get(True)))
    return suite


@dataclass(frozen=True)
class Outcome:
    """The result of judging one candidate: a score, or the reason why there is none.

    Attributes:
        name: of the candidate.
        scene: id of the scene.
        score: None if it could not be judged.
        error: why it could not.
    """

    name: str
    scene: str
    score: Score | None = None
    error: FoucaultError | None = None

    @property
    def verdict(self) -> str:
        """'agrees' (as a model too, where that is enough), 'disagrees' or 'refused'."""
        if self.score is None:
            return REFUSED
        return "agrees" if self.score.passes else self.score.verdict

    @property
    def exit_status(self) -> int:
        """0: agrees, 1: disagrees, 2 or 3: could not be judged."""
        return self.error.exit_status if self.error is not None else int(self.verdict != "agrees")

    @property
    def lines(self) -> list[str]:
        """The lines for people, the verdict first; details are indented."""
        if self.score is not None:
            return list(lines(self.score))
        return [f"{self.name} was not judged by {self.scene}: {self.error}"]

    @property
    def main_lines(self) -> list[str]:
        """The lines for people without details."""
        first, *others = self.lines
        return [first, *(line for line in others if not line.startswith("  "))]

    def document(self) -> dict[str, Any]:
        """Return it as a row of the JSON document."""
        if self.score is not None:
            return document(self.score)
        return {"scene": self.scene, "candidate": self.name, "verdict": REFUSED, "error": str(self.error)}
