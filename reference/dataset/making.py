"""How a dataset is made: as options of `foucault generate`, from the index, or from a manifest."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from ..engines import AUTO, engine_names
from ..scenes.fields import Confirmation
from ..scenes.scene import Scene
from ..scenes.shipped import index, scene_ids
from .place import changes, changes_in, is_of_shipped_scene, shipped_scene, ships

ENGINE = "--engine"
AUDIT = "--audit"
CONFIRM = "--confirm"
_WITH_FUNCTION = "--function"
_WITHOUT_TABLES = "--no-tables"
# The options in a dataset's command that say how it is made. Two older forms are in manifests that
# ship: `--no-confirm`, and nothing at all for a whole confirmation. A command that names
# no audit had none.
_OPTIONS = re.compile(
    rf"{ENGINE} (?P<engine>{'|'.join(engine_names())})"
    rf"(?P<audit> {AUDIT}| --no-audit|)"
    rf"(?: {CONFIRM} (?P<confirm>whole|sampled|none)|(?P<no_confirm> --no-confirm)|)"
    rf"(?P<function> {_WITH_FUNCTION}|)"
    rf"(?P<no_tables> {_WITHOUT_TABLES}|)"
)
# the fields of a scene that have options of their own
_OPTION_FIELDS = ("run.t_end=", "run.digits=", "run.level=", "run.transits=", "run.sections=")


def options_in(command: str) -> str | None:
    """Return the options in a dataset's command that say how it is made; None if there are none."""
    match = _OPTIONS.search(command)
    return match and match[0]


@dataclass(frozen=True)
class Making:
    """How a dataset is made: engine, audit, confirmation, with or without function and tables."""

    engine: str = "limbs"
    audit: bool = True
    confirm: Confirmation = "whole"
    function: bool = False
    tables: bool = True

    @classmethod
    def of(cls, command: str) -> Making:
        """Parse the options in a dataset's command, or in the index of shipped datasets.

        Raises:
            ValueError: the command has no such options.
        """
        match = _OPTIONS.search(command)
        if match is None:
            raise ValueError(f"the command {command!r} has no options for making a dataset")
        confirm = "none" if match["no_confirm"] else match["confirm"] or "whole"
        return cls(
            engine=match["engine"],
            audit=match["audit"].strip() == AUDIT,
            confirm=cast("Confirmation", confirm),
            function=bool(match["function"]),
            tables=not match["no_tables"],
        )

    @property
    def options(self) -> str:
        """The options of `foucault generate` that make the dataset of a proof in this way."""
        words = [ENGINE, self.engine]
        words.append(AUDIT if self.audit else "--no-audit")
        words += [CONFIRM, self.confirm]
        if self.function:
            words.append(_WITH_FUNCTION)
        if not self.tables:
            words.append(_WITHOUT_TABLES)
        return " ".join(words)

    def options_for(self, scene: Scene, name: str) -> str:
        """Return the options of a dataset's command, as the index has them if it says the same."""
        listed = index().get(name, {}).get("options")
        if listed and is_of_shipped_scene(scene, name) and Making.of(listed) == self:
            return listed
        return self.options

    def solve_options(self, scene: Scene) -> dict[str, Any]:
        """Return the options with which `solve` makes a scene's dataset in this way."""
        options: dict[str, Any] = {"engine": self.engine}
        if scene.run.level == "enclosed":
            options["audit"] = self.audit
            options["confirm"] = self.confirm
            options["function"] = self.function
        return options


def making_of(scene: Scene, name: str, folder: Path) -> Making:
    """Return how a dataset is made by default.

    A shipped dataset is made as the index says, wherever it is written. A new one that is to ship
    is made with limbs, so that heyoka's confirmation is an independent code.
    """
    if ships(folder) or is_of_shipped_scene(scene, name):
        entry = index().get(name)
        return Making.of(entry["options"]) if entry else Making()
    return Making(AUTO, confirm="sampled", function=True)


def command(scene: Scene, name: str, options: str) -> str:
    """Return the command that makes a dataset of a shipped scene, or of a user's own file.

    `name` is the dataset's id, which names the changes; `options` say how it is made.
    """
    run = scene.run
    words = ["foucault", "generate"]
    words.append(scene.id if scene.id in scene_ids() else f"{scene.id}.toml")
    words += ["--t-end", run.t_end, "--digits", str(run.digits), "--level", run.level, options]
    if not run.transits:
        words.append("--no-transits")
    for section in run.sections or ():
        words += ["--section", f"'{section}'"]

    shipped = shipped_scene(scene)
    is_own_scene = shipped is scene
    if shipped.uncertain and not is_own_scene:
        words += ["--uncertain", "none"]
    changed = changes_in(name) if is_own_scene else changes(scene, shipped)
    for change in changed:
        if not change.startswith(_OPTION_FIELDS):
            words += ["--set", change]
    id_with_reading = f"{scene.id}.{scene.inputs}"
    if name.partition("+")[0] == id_with_reading:
        words += ["--set", f"inputs={scene.inputs}"]
    return " ".join(words)
