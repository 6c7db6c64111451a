"""The files of a suite: a folder whose files are named after scenes, such as paris.csv."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from reference import InputError
from reference.errors import Described, in_words

_SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".out", ".npy", ".npz")
_TRANSITS = ".transits"


@dataclass(frozen=True)
class SuiteFiles:
    """The files of one scene.

    Attributes:
        scene: id of a scene that ships, or path of the TOML file of the same name beside the files.
        rows: the file of a trajectory, or None.
        transits: the file of its transits, such as paris.transits.csv, or None.
    """

    scene: str
    rows: Path | None
    transits: Path | None

    @property
    def name(self) -> str:
        """The name that the files have in common."""
        return Path(self.scene).stem


def suite_files(folder: Path, option: str = "--suite") -> list[SuiteFiles]:
    """Return the files of a folder, sorted by scene.

    Raises:
        InputError: it is no folder, holds no candidates, or two for one scene.
    """
    if not folder.is_dir():
        advice = "Name its files after the scenes: paris.csv, hard.npz."
        raise InputError(option, str(folder), "a folder", advice)

    rows: dict[str, Path] = {}
    transits: dict[str, Path] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix.lower() not in _SUFFIXES or not path.is_file():
            continue
        files = transits if path.stem.endswith(_TRANSITS) else rows
        name = path.stem.removesuffix(_TRANSITS)
        if name in files:
            got = Described(f"both {files[name].name} and {path.name}")
            raise InputError(option, got, "one file for each scene", "Remove one of them.")
        files[name] = path

    names = sorted(rows.keys() | transits.keys())
    if not names:
        expected = f"files named after scenes, ending in {in_words(_SUFFIXES)}"
        advice = "For paris: paris.csv, and paris.transits.csv for its transits, if you have them."
        raise InputError(option, str(folder), expected, advice)
    return [
        SuiteFiles(_scene_word(folder, name), rows.get(name), transits.get(name)) for name in names
    ]


def _scene_word(folder: Path, name: str) -> str:
    """Return the path of the scene that a folder describes under a name, or the name as an id."""
    described = folder / f"{name}.toml"
    return str(described) if described.is_file() else name
