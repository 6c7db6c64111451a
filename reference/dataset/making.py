"""How a dataset is made: as options of `foucault generate`, from the index, or from a manifest."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..engines import AUTO, engine_names
from ..scenes.fields import Confirmation
from ..scenes.scene import Scene
from ..scenes.shipped import index, scene_ids
from .place import changes, changes_in, is_of_shipped_scene, shipped_scene, ships

ENGINE, AUDIT, CONFIRM, WITH_FUNCTION, BARE = (
    "--engine",
    "--audit",
    "--confirm",
    "--function",
    "--no-tables",
)
# How a dataset is made, in its command. What was made before there was --confirm says --no-confirm or, of a whole
# confirmation, nothing; and nothing of an audit that there was not.
OPTIONS = re.compile(
    rf"{ENGINE} ({'|'.join(engine_names())})( {AUDIT}| --no-audit|)"
    rf"(?: {CONFIRM} (whole|sampled|none)|( --no-confirm)|)( {WITH_FUNCTION}|)( {BARE}|)"
)


@dataclass(frozen=True)
class Making:
    """How a dataset is made: by which engine, whether audited, what is confirmed, with a function, with its tables."""

    engine: str = "limbs"
    audit: bool = True
    confirm: Confirmation = "whole"
    function: bool = False
    tables: bool = True

    @classmethod
    def of(cls, command: str) -> Making:
        """Read it off a dataset's command, or off the options in the index of what ships."""
        engine, audit, confirm, no_confirm, function, bare = OPTIONS.findall(command)[0]
        keywords: dict[str, Any] = {
            "confirm": "none" if no_confirm else confirm or "whole",
            "tables": not bare,
        }
        return cls(engine, audit.strip() == AUDIT, function=bool(function), **keywords)

    @property
    def options(self) -> str:
        """The options that say it, of a proof."""
        audit = AUDIT if self.audit else "--no-audit"
        last = [*[WITH_FUNCTION] * self.function, *[BARE] * (not self.tables)]
        return " ".join([ENGINE, self.engine, audit, CONFIRM, self.confirm, *last])

    def options_for(self, scene: Scene, name: str) -> str:
        """Return the options of a dataset's command: those in the index where a shipped scene is made as it says."""
        listed = index().get(name, {}).get("options", self.options)
        return (
            listed
            if is_of_shipped_scene(scene, name) and Making.of(listed) == self
            else self.options
        )

    def solve_options(self, scene: Scene) -> dict[str, Any]:
        """Return the options with which `solve` makes a scene's dataset in this way, or refuses it."""
        proof = {"audit": self.audit, "confirm": self.confirm, "function": self.function}
        return {"engine": self.engine} | (proof if scene.run.level == "enclosed" else {})


def making_of(scene: Scene, name: str, folder: Path) -> Making:
    """Return how a dataset is made if nothing else is asked for: what ships as the index says, wherever it is written.

    A new one that is to ship is made with limbs, so that it and heyoka's confirmation are of two codes.
    """
    if ships(folder) or is_of_shipped_scene(scene, name):
        entry = index().get(name)
        return Making.of(entry["options"]) if entry else Making()
    return Making(AUTO, confirm="sampled", function=True)


def command(scene: Scene, name: str, options: str) -> str:
    """Return the command that makes a dataset: of a shipped scene, or of the scene's own file, with what was changed.

    `name` is the dataset's id, which names the changes; `options` say how it is made.
    """
    run = scene.run
    parts = ["foucault", "generate", scene.id if scene.id in scene_ids() else f"{scene.id}.toml"]
    parts += ["--t-end", run.t_end, "--digits", str(run.digits), "--level", run.level, options]
    parts += [] if run.transits else ["--no-transits"]
    parts += [word for section in run.sections or () for word in ("--section", f"'{section}'")]
    option_fields = ("run.t_end=", "run.digits=", "run.level=", "run.transits=", "run.sections=")
    shipped = shipped_scene(scene)
    changed = changes_in(name) if shipped is scene else changes(scene, shipped)
    changed = [change for change in changed if not change.startswith(option_fields)]
    parts += ["--uncertain", "none"] if shipped is not scene and shipped.uncertain else []
    changed += [f"inputs={scene.inputs}"] if f".{scene.inputs}" in name else []
    return " ".join([*parts, *(word for change in changed for word in ("--set", change))])
