"""The form of a pendulum: its fields, as the page checks them, and as HTML; the scenes that ship, as texts by field."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple, get_args

from reference import Scene, load_scene, scene_ids
from reference.scenes.inputs import GRAVITY_MEANINGS, GravityIs
from reference.scenes.scene import MAX_ROWS, field_names, unit_of
from reference.solver.swing import FAST, LEAN, NO_SWING, ONE_SIDE, SMALL, UNDECIDED, left_out

from ..page import Html, text

_TABLES = ("pendulum", "site", "release", "run")
_RUN = ("run.t_end", "run.grid_step")  # of the table [run]; the others say nothing of the motion
_RARE = ("site.altitude", "site.rotation_rate", "site.equatorial_radius", "site.inverse_flattening")
LEGENDS = {"pendulum": "Cord", "site": "Place", "release": "Release", "run": "Run"}
# what a field is called beside its name, where that is not a word
_LABELS = {
    "site.gravity": "gravity g",
    "site.rotation_rate": "rotation rate",
    "site.equatorial_radius": "equatorial radius",
    "site.inverse_flattening": "inverse flattening",
    "release.angle_rate": "angle rate",
    "release.azimuth_rate": "azimuth rate",
    "run.t_end": "end",
    "run.grid_step": "step of rows",
}
# where a g of each meaning usually comes from
_SOURCES_OF_G: dict[GravityIs, str] = {
    "ellipsoid": "G M/r²",
    "effective": "a gravimeter, a book (9.81), or a table or formula for your latitude",
}
_INFINITE = "site.inverse_flattening"  # may be "inf"


class _Range(NamedTuple):
    """The numbers that a field takes, as texts: at least (or `above`) the least, at most the most; None for any."""

    least: str | None = None
    most: str | None = None
    above: bool = False


# as the validators of reference/scenes/fields.py
_RANGES = {
    "pendulum.length": _Range("0", above=True),
    "pendulum.drag": _Range("0"),
    "site.latitude": _Range("-90", "90"),
    "site.gravity": _Range("0"),
    "site.equatorial_radius": _Range("0"),
    "site.inverse_flattening": _Range("1", above=True),
    "release.angle": _Range("0", "180"),
    "release.azimuth": _Range("-360", "360"),
    "run.t_end": _Range("0", "1e15", above=True),
    "run.grid_step": _Range("0", above=True),
}


def fields() -> list[dict[str, Any]]:
    """Return the fields of the form in order, as `describing.js` takes them."""
    names = [name for name in field_names() if name.partition(".")[0] in _TABLES]
    names = [name for name in names if not name.startswith("run.") or name in _RUN]
    return [_field(name) for name in names]


def _field(name: str) -> dict[str, Any]:
    info = _info(name)
    limits = _RANGES.get(name, _Range())
    choices = list(get_args(GravityIs)) if name == "site.gravity_is" else None
    document = {"name": name, "unit": unit_of(name), "default": info.default, "choices": choices}
    return document | limits._asdict() | {"or_inf": name == _INFINITE}


def _info(name: str) -> Any:
    table, _, key = name.partition(".")
    model: Any = Scene.model_fields[table].annotation
    return model.model_fields[key]


def presets() -> list[dict[str, Any]]:
    """Return the scenes that ship: id, title, and the texts of the fields that they give."""
    return [_preset(load_scene(scene_id)) for scene_id in scene_ids()]


def _preset(scene: Scene) -> dict[str, Any]:
    return {"id": scene.id, "title": scene.title, "texts": texts_of(scene)}


def texts_of(scene: Scene) -> dict[str, str]:
    """Return the texts of a scene's fields that are not their defaults."""
    document = scene.model_dump(exclude_none=True)
    texts = {}
    for field in fields():
        table, _, key = field["name"].partition(".")
        value = document[table].get(key)
        if value is not None and value != field["default"]:
            texts[field["name"]] = value
    return texts


def form_words() -> dict[str, Any]:
    """Return the words and limits that the form and the motion need."""
    schema = Scene.model_json_schema()["$defs"]["Pendulum"]["properties"]["length"]
    return {
        "DECIMAL": schema["pattern"].removeprefix("^(inf|").removesuffix(")$"),
        "NUMBER_EXPECTED": "a decimal number such as 67 or 7.292115e-5",
        "MAX_ROWS": MAX_ROWS,
        "REASONS": {
            "NO_SWING": NO_SWING,
            "LEAN": LEAN,
            "ONE_SIDE": ONE_SIDE,
            "FAST": FAST,
            "SMALL": SMALL,
            "UNDECIDED": UNDECIDED,
            "STILL": left_out("", still=True)["full_turn_h"],
        },
        "UNDECIDED_TRANSITS": "double precision does not decide how many transits there are",
    }


def form() -> Html:
    """Return the form's fields as HTML, a set for each table."""
    return Html("\n".join(_fieldset(table) for table in _TABLES))


def _fieldset(table: str) -> Html:
    described = [field for field in fields() if field["name"].startswith(f"{table}.")]
    common = [field for field in described if field["name"] not in _RARE]
    rare = [field for field in described if field["name"] in _RARE]
    parts = [f"<legend>{LEGENDS[table]}</legend>"]
    if table == "release":
        parts.append(_KINDS)
    parts += map(_input, common)
    if rare:
        parts.append("<details><summary>The Earth</summary>")
        parts += [*map(_input, rare), "</details>"]
    return Html("\n".join(["<fieldset>", *parts, "</fieldset>"]))


_KINDS = """<label class="line"><span>given by</span> <select id="kind">
<option value="position">x and y</option><option value="angles">angle and azimuth</option></select></label>
<label class="line" id="direction-line"><span>direction</span> <select id="direction">
<option value="azimuth">azimuth: from east to north</option>
<option value="bearing">bearing: from north to east</option>
</select></label>"""


def _input(field: Mapping[str, Any]) -> Html:
    name = field["name"]
    meaning = str(_info(name).description)
    if field["choices"]:
        return _choice(name, field["choices"])
    label = _LABELS.get(name, name.partition(".")[2])
    unit = f' <span class="unit">{text(field["unit"])}</span>' if field["unit"] else ""
    return Html(
        f'<div class="field"><label for="{name}">{text(label)}{unit}</label>\n'
        f'<input id="{name}" inputmode="text" autocomplete="off" spellcheck="false" '
        f'placeholder="{text(field["default"] or "0")}" aria-describedby="{name}.meaning {name}.wrong">\n'
        f'<p class="meaning" id="{name}.meaning">{text(meaning)}</p>'
        f'<p class="wrong" id="{name}.wrong" role="status"></p></div>'
    )


def _choice(name: str, choices: Iterable[GravityIs]) -> Html:
    """Return radio buttons for the meanings of g."""
    buttons = "".join(_button(name, choice) for choice in choices)
    return Html(
        f'<div class="field meanings" role="radiogroup" id="{name}" aria-label="what g means">{buttons}</div>'
    )


def _button(name: str, choice: GravityIs) -> str:
    meaning = f"{GRAVITY_MEANINGS[choice]}. Such a g comes from {_SOURCES_OF_G[choice]}."
    return (
        f'<label><input type="radio" name="{name}" value="{text(choice)}"> '
        f"<span><b>{text(choice)}</b>: {text(meaning)}</span></label>\n"
    )


def options(scenes: Iterable[Mapping[str, Any]]) -> Html:
    """Return the scenes as options of a choice."""
    names = [scene["id"] for scene in scenes]
    lines = (
        f'<option value="{text(name)}">{text(name.replace("_", " "))}</option>' for name in names
    )
    return Html("\n".join(lines))
