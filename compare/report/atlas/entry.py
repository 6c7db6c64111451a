"""A scene of the atlas: its datasets, in both readings of the inputs, found in a folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from reference import Golden, InputError, load, load_scene, scene_ids
from reference.dataset.manifest import MANIFEST
from reference.dataset.place import changes

KEPT = {"run.digits", "run.level", "run.grid_step", "run.transits"}  # they make no difference to a score


@dataclass(frozen=True)
class Entry:
    """A scene of the atlas.

    Attributes:
        golden: its dataset, the one whose inputs are decimals if there are two.
        judged: the dataset that a dropped file is held against: the one whose inputs are doubles if there are two.
    """

    golden: Golden
    judged: Golden

    @property
    def id(self) -> str:
        """Its id, and the name of its page."""
        return _name(self.golden)

    @property
    def datasets(self) -> list[Golden]:
        """Its one or two datasets."""
        return [self.golden] if self.golden is self.judged else [self.golden, self.judged]

    @property
    def flags(self) -> tuple[str, ...]:
        """Why it is difficult."""
        return tuple(self.golden.manifest.flags)

    def score_command(self) -> str:
        """Return the command that judges a file as the page does."""
        scene, words = self.judged.scene, ["foucault score"]
        if scene.id in scene_ids():
            words += [scene.id, "mine.csv"]
            for change in changes(scene, load_scene(scene.id)):
                field, _, value = change.partition("=")
                if field == "run.t_end":
                    words.append(f"--t-end {value}")
                elif field not in KEPT:
                    words.append(f"--set {change}")
        else:
            words += [f"{scene.id}.toml", "mine.csv"]
        return " ".join([*words, *(["--inputs decimal"] if scene.inputs == "decimal" else [])])


def entries(folder: Path) -> list[Entry]:
    """Return the scenes whose datasets stand in a folder, sorted by id.

    Raises:
        InputError: the folder cannot be read, or holds no dataset.
        DatasetError: a dataset is damaged.
    """
    try:
        found = sorted(path.parent for path in folder.glob(f"*/{MANIFEST}"))
    except OSError as error:
        raise InputError("--data", str(folder), "a folder of golden datasets", f"{error.strerror}.") from None
    if not found:
        advice = "`foucault generate --all` makes those that ship."
        raise InputError("--data", str(folder), "a folder of golden datasets, each a folder in it", advice)
    readings: dict[str, dict[str, Golden]] = {}
    for path in found:
        golden = load(path)
        readings.setdefault(_name(golden), {})[golden.manifest.inputs] = golden
    return [
        Entry(of.get("decimal", of.get("binary64")), of.get("binary64", of.get("decimal")))  # type: ignore[arg-type]
        for _, of in sorted(readings.items())
    ]


def _name(golden: Golden) -> str:
    """Return the id of a dataset without its reading, which `paris.binary64` ends in."""
    return golden.manifest.id.removesuffix(f".{golden.manifest.inputs}")
