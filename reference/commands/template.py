"""`foucault show --template`: a scene as a TOML file to start from, each field explained."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from ..scenes.fields import SceneTable
from ..scenes.scene import Scene, parse_scene, unit_of

_BEGIN = """\
# A scene of the Foucault pendulum. docs/scene.md explains each field, drag and the azimuth with an example.
# Numbers stand in quotes, so that they are taken exactly as written. A field that you leave out has its default.
"""
_COLUMN = 34  # where comments begin
_WIDTH = 120  # of a line; a longer comment has a line for each of its parts
_TEMPLATE = {
    "id": "mine",
    "title": "my pendulum",
    "site": {"gravity_is": "effective"},
    "release": {"angle": "5", "azimuth": "0"},
}
_WIDTHS = {"pendulum.length": "0.001", "site.gravity": "0.0001", "release.angle": "0.1"}


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
    lines += _uncertain_lines(scene)
    return "\n".join(lines) + "\n"


def _uncertain_lines(scene: Scene) -> Iterator[str]:
    """Yield the table of the widths of a scene; an example in comments if there are none."""
    comment = "" if scene.uncertain else "# "
    yield ""
    yield f"{comment}[uncertain]  # {Scene.model_fields['uncertain'].description}"
    for name, width in (scene.uncertain or _WIDTHS).items():
        assignment = f"{comment}{_toml(name)} = {_toml(width)}"
        yield f"{assignment:{_COLUMN}}  # {unit_of(name)}".rstrip(" #")


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
        yield from _commented(assignment, unit, str(info.description))


def _commented(assignment: str, unit: str, meaning: str) -> Iterator[str]:
    """Yield an assignment and its comment on one line; a long meaning goes on below, a part on each line."""
    line = f"{assignment:{_COLUMN}}  # {unit}{meaning}"
    if len(line) <= _WIDTH:
        yield line
        return
    first, *others = meaning.split("; ")
    yield f"{assignment:{_COLUMN}}  # {unit}{first}"
    for part in others:
        yield f"{'':{_COLUMN}}  # {part}"


def _toml(value: Any) -> str:
    """Return a value as TOML; texts, lists, whole numbers and truth values are as in JSON."""
    return json.dumps(value, ensure_ascii=False)
