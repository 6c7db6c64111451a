"""`foucault scenes` lists the scenes that come with the project."""

from __future__ import annotations

from collections.abc import Iterator

from ..scenes.scene import Scene, load_scene
from ..scenes.shipped import WITHOUT_FUNCTION, scene_ids
from .layout import echo, facts, paragraph
from .terminal import AsJson, emit

_NEXT = (
    "`foucault show SCENE` prints a scene's inputs, its motion, and why it is difficult; "
    "`foucault scenes --json` all fields and flags."
)


def scenes(as_json: AsJson = False) -> None:
    """List the scenes that come with the project."""
    every = [load_scene(name) for name in scene_ids()]
    if as_json:
        emit({"scenes": [scene.model_dump(exclude_none=True) for scene in every]})
        return
    echo(_lines(every))


def _lines(every: list[Scene]) -> Iterator[str]:
    """Yield the lines that list scenes: their ids and titles."""
    yield from facts((scene.id, _title(scene)) for scene in every)
    yield ""
    yield from paragraph(_NEXT)


def _title(scene: Scene) -> str:
    """Return a scene's title, and that it ships without its golden function where it does."""
    megabytes = WITHOUT_FUNCTION.get(scene.id)
    if megabytes is None:
        return scene.title
    return f"{scene.title} (without a golden function, which takes {megabytes} MB)"
