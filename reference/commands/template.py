"""`foucault show --template`: a scene as a TOML file to start from, each field explained."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from ..scenes.fields import SceneTable
from ..scenes.scene import Scene, parse_scene

_BEGIN = """\
# A scene of the Foucault pendulum. docs/scene.md explains each field, drag and the azimuth with an example.
# Numbers stand in quotes, so that they are taken exactly as written. A field that you leave out has its default.
"""
_COLUMN = 34  # where comments begin
_TEMPLATE = {
    "id": "mine",
    "title": "my pendulum",
    "site": {"gravity_is": "effective"},
    "release": {"angle": "5", "azimuth": "0"},
}


def scene_file(scene: Scene | None) -> str:
    """Return a scene as a TOML file with comments.

    Without a scene, it has the defaults, a measured g and a release.
    """
    if scene is None:
        scene = parse_scene(_TEMPLATE)
    lines = [_BEGIN, *_lines(scene)]
    for name in Scene.model_fields:
        table = getattr(scene, name)
        if isinstance(table, SceneTable):
            lines += ["", f"[{name}]  # {type(table).__doc__}", *_lines(table)]
    if scene.uncertain:
        meaning = Scene.model_fields["uncertain"].description
        lines += ["", f"[uncertain]  # {meaning}"]
        lines += [f"{_toml(name)} = {_toml(width)}" for name, width in scene.uncertain.items()]
    return "\n".join(lines) + "\n"


def _lines(table: SceneTable) -> Iterator[str]:
    """Yield a line for each field of a table, commented out where it has no value."""
    for name, info in type(table).model_fields.items():
        value = getattr(table, name)
        if isinstance(value, SceneTable | dict):
            continue
        if value is None:
            example = ["highest", "gate 30"] if name == "sections" else "0"
            assignment = f"# {name} = {_toml(example)}"
        else:
            assignment = f"{name} = {_toml(value)}"
        extra: Any = info.json_schema_extra or {}
        unit = f"{extra['unit']}; " if extra else ""
        yield f"{assignment:{_COLUMN}}  # {unit}{info.description}"


def _toml(value: Any) -> str:
    """Return a value as TOML; texts, lists, whole numbers and truth values are as in JSON."""
    return json.dumps(value, ensure_ascii=False)
