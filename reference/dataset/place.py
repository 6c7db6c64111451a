"""The id of a dataset, the folder it is written to, and the folder that a name stands for."""

from __future__ import annotations

import hashlib
from pathlib import Path

from ..errors import checked_path
from ..scenes.scene import Scene, load_scene
from ..scenes.shipped import golden_root, in_checkout, scene_ids
from .sheets import by_field, scene_inputs

GOLDEN = "golden"
RANGES = "ranges.json"  # what a folder of ranges has, and a dataset has not
MAX_ID = 160  # characters; more changes than fit are named by their hash


def changes(scene: Scene, base: Scene) -> list[str]:
    """Return the fields in which a scene differs from another, each as section.key=value."""
    before = by_field(scene_inputs(base))
    after = by_field(scene_inputs(scene))
    return [f"{field}={value}" for field, value in after.items() if before.get(field) != value]


def shipped_scene(scene: Scene) -> Scene:
    """Return the scene of that id that ships, or the scene itself if there is none."""
    return load_scene(scene.id) if scene.id in scene_ids() else scene


def dataset_id(scene: Scene, base: Scene | None = None) -> str:
    """Return the id of a scene's dataset: the scene's own, with its reading and its changes.

    Span, digits and level are not named: a folder has one dataset of a scene. Examples: `paris`,
    `paris.binary64`, `paris+site.latitude=0`.

    Args:
        scene: the scene that is solved.
        base: the scene before its changes; by default the one of that id that comes with the
            project.
    """
    name = scene.id if scene.inputs == "decimal" else f"{scene.id}.{scene.inputs}"
    every = changes(scene, base or shipped_scene(scene))
    changed = ",".join(change for change in every if not change.startswith("run."))
    return id_with(name, "+", changed) if changed else name


def id_with(name: str, sign: str, words: str) -> str:
    """Return an id with its changes appended after a sign, as words, or as a hash if they are too long."""
    if len(name) + len(words) >= MAX_ID:
        words = f"sha256={hashlib.sha256(words.encode()).hexdigest()[:16]}"
    return f"{name}{sign}{words}"


def changes_in(name: str) -> list[str]:
    """Return the changes in an id, each as section.key=value; none if the id has a hash."""
    _, _, changed = name.partition("+")
    if changed.startswith("sha256="):
        return []
    return [change for change in changed.split(",") if change]


def is_of_shipped_scene(scene: Scene, name: str) -> bool:
    """Return whether a dataset is that of a scene that ships, unchanged but for its reading."""
    shipped = shipped_scene(scene)
    if shipped is scene:
        return False
    same_reading = shipped.model_copy(update={"inputs": scene.inputs, "uncertain": scene.uncertain})
    return scene == same_reading and name == dataset_id(scene)


def default_folder(scene: Scene, name: str) -> Path:
    """Return the folder that a dataset of this id is written to.

    It is in ./golden, or in the checkout's data if it ships.
    """
    local = Path(GOLDEN) / name
    if is_of_shipped_scene(scene, name) and in_checkout() and not local.is_dir():
        return golden_root() / name
    return local


def ships(folder: Path) -> bool:
    """Return whether a dataset in this folder comes with the project."""
    return folder.resolve().parent == golden_root().resolve()


def golden_folder(name: str | Path) -> Path:
    """Return the folder that a name stands for: a path, or an id in ./golden, data/golden or the package.

    Raises:
        InputError: it is neither text nor a path.
    """
    folder = checked_path("PATH", name, "the id of a dataset, or the path of its folder")
    if isinstance(name, Path) or folder.name != name or folder.is_dir():
        return folder
    roots = (Path(GOLDEN), Path("data") / GOLDEN, golden_root())
    return next((root / name for root in roots if (root / name).is_dir()), folder)
