"""The files of a suite: candidates named by their scene, such as paris.csv, with paris.transits.csv beside it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from reference import InputError

SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".out", ".npy", ".npz")
TRANSITS = ".transits"


@dataclass(frozen=True)
class Entry:
    """A candidate of a suite.

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


def entries(folder: Path) -> list[Entry]:
    """List the candidates of a folder by their scenes, sorted.

    Raises:
        InputError: it is no folder, holds no candidates, or two for one scene.
    """
    if not folder.is_dir():
        raise InputError(
            "--suite", str(folder), "a folder", "Its files are named by their scenes: paris.csv, hard.npz."
        )
    found: dict[str, dict[bool, Path]] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix.lower() not in SUFFIXES or not path.is_file():
            continue
        of_transits = path.stem.endswith(TRANSITS)
        scene = path.stem.removesuffix(TRANSITS)
        others = found.setdefault(scene, {})
        if of_transits in others:
            raise InputError("--suite", f"{others[of_transits].name} and {path.name}", "one file for a scene")
        others[of_transits] = path
    if not found:
        expected = f"files named by their scenes, with one of {', '.join(SUFFIXES)}"
        raise InputError("--suite", str(folder), expected, "For paris: paris.csv, and paris.transits.csv if you like.")
    return [Entry(_scene(folder, name), files.get(False), files.get(True)) for name, files in sorted(found.items())]


def _scene(folder: Path, name: str) -> str:
    """Return the scene that a file's name means: a TOML file beside it, or the id of one that ships."""
    own = folder / f"{name}.toml"
    return str(own) if own.is_file() else name
