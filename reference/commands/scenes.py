"""`foucault scenes` lists the scenes that come with the project."""

from __future__ import annotations

import typer

from ..scenes.scene import load_scene
from ..scenes.shipped import WITHOUT_FUNCTION, scene_ids
from .terminal import AsJson, emit


def scenes(as_json: AsJson = False) -> None:
    """List the scenes that come with the project."""
    every = [load_scene(name) for name in scene_ids()]
    if as_json:
        emit({"scenes": [scene.model_dump(exclude_none=True) for scene in every]})
        return
    width = max((len(scene.id) for scene in every), default=0)
    for scene in every:
        flags = f"  [{', '.join(scene.flags)}]" if scene.flags else ""
        megabytes = WITHOUT_FUNCTION.get(scene.id)
        lacking = f"  (without a golden function, which takes {megabytes} MB)" if megabytes else ""
        typer.echo(f"{scene.id:{width}}  {scene.title}{flags}{lacking}")
