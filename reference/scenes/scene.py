"""Scenes: the inputs of a run, read from TOML files, checked, and kept as exact decimals.

Numbers stay strings until they are needed, and then become exact fractions: "48.846111" is the
decimal 48.846111 and not the double nearest to it, unless the scene says `inputs = "binary64"`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from functools import cache
from html import escape
from numbers import Integral, Real
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import TypeAdapter, ValidationError

from ..errors import NOTHING, Described, InputError, all_of, unknown
from ..system.documents import toml_document
from .fields import Pendulum, Release, RunTable, SceneTable, Site, field
from .inputs import RELEASES, SITE, UNCERTAIN, Inputs, as_read
from .shipped import data_root, scene_ids
from .texts import Line, Widths, by_full_name, checked, explained

MAX_ROWS = 2_000_000
_LEAST_T_END = Fraction(1, 10**300)

_LISTS = ("flags", "run.sections")  # fields that hold several words

Reading = Literal["decimal", "binary64"]


def is_scene_id(word: str) -> bool:
    """Return whether a word can be a scene's id, and so a folder and a command-line argument."""
    return re.fullmatch("[a-z][a-z0-9_]{0,63}", word) is not None


Id = Annotated[
    str, checked(is_scene_id, "a lower-case letter followed by letters, digits or _ (at most 64)")
]


class Scene(SceneTable):
    """A pendulum, its site, its release and its run; frozen.

    `exact` gives the numbers as fractions, in the reading that `inputs` names.
    """

    id: Id = field(..., "", "name of the scene and of its folder")
    title: Line = field("", "", "what it is, in one line")
    source: Line = field("", "", "where its numbers come from")
    flags: tuple[Line, ...] = field((), "", "words for what is difficult in it")
    inputs: Reading = field(
        "decimal", "", "decimal: each number is exact; binary64: the double nearest to it"
    )
    pendulum: Pendulum = Pendulum()
    site: Site = Site()
    release: Release
    run: RunTable = RunTable()
    uncertain: Widths = field({}, "", "half of the width of each input that is not known exactly")

    @property
    def exact(self) -> Inputs:
        """The scene's numbers as exact fractions, each rounded to binary64 first if `inputs` says so."""

        def read(text: str | None) -> Fraction:
            return as_read(text or "0", self.inputs)

        inverse = self.site.inverse_flattening
        kind = "position" if self.release.angle is None else "angles"
        numbers: dict[str, Any] = {name: read(getattr(self.site, name)) for name in SITE}
        numbers |= dict.fromkeys(RELEASES)
        numbers[kind] = tuple(read(getattr(self.release, name)) for name in RELEASES[kind])
        return Inputs(
            length=read(self.pendulum.length),
            drag=read(self.pendulum.drag),
            flattening=Fraction(0) if inverse == "inf" else 1 / read(inverse),
            t_end=read(self.run.t_end),
            grid_step=read(self.run.grid_step),
            gravity_is=self.site.gravity_is,
            **numbers,
        )

    def with_values(self, values: Words) -> Scene:
        """Return the scene with fields replaced, by words `section.key=value` or `x0=value`, or a mapping of keys."""
        return _with_values(self.model_dump(exclude_none=True), values)

    def __repr__(self) -> str:
        """Return id and title."""
        return f"Scene({self.id}: {self.title})"

    def _repr_html_(self) -> str:
        """Return its fields, a line for each table, as a notebook shows them."""
        lines = [f"{self.id}: {self.title}"]
        for name, table in self.model_dump(exclude_none=True).items():
            if isinstance(table, dict) and table:
                lines.append(
                    f"[{name}] " + ", ".join(f"{key} = {value}" for key, value in table.items())
                )
        return f"<pre>{escape(chr(10).join(lines))}</pre>"


# one word `key=value`, several, or a mapping from keys to values
Words = str | Iterable[str] | Mapping[str, Any]


def words_of(values: Words) -> list[str]:
    """Return values of fields as words `key=value`.

    A list, range or array is written as values between commas.
    """
    if isinstance(values, Mapping):
        return [f"{key}={_word(str(key), value)}" for key, value in values.items()]
    return [*map(str, values)] if _is_listed(values) else [str(values)]


def _word(key: str, value: Any) -> str:
    """Return a value, or several with commas between them.

    Raises:
        InputError: a list holds lists.
    """
    if not _is_listed(value):
        return str(value)
    items = list(value)
    if any(map(_is_listed, items)):
        raise InputError(full_name(key), value, "a list of numbers or words")
    return ",".join(map(str, items))


def _is_listed(value: Any) -> bool:
    # an array of one number, without axes
    single = isinstance(value, str) or getattr(value, "shape", None) == ()
    return isinstance(value, Iterable) and not single


def _check_single(values: Words) -> None:
    """Refuse several values for a field that holds one.

    Raises:
        InputError: there are.
    """
    pairs = values.items() if isinstance(values, Mapping) else ()
    for key, value in pairs:
        name = full_name(str(key))
        if _is_listed(value) and name not in _LISTS:
            raise InputError(name, value, "a single value")


def _with_values(document: dict[str, Any], values: Words) -> Scene:
    """Return a scene that is given as nested mappings, with fields replaced."""
    _check_single(values)
    for assignment in words_of(values):
        key, sign, value = assignment.partition("=")
        section, _, name = full_name(key).rpartition(".")
        if not sign or not name or "." in section:
            raise InputError("--set", assignment, "SECTION.KEY=VALUE, such as site.latitude=0")
        table = document.setdefault(section, {}) if section else document
        if not isinstance(table, dict):
            raise InputError(
                "--set",
                assignment,
                f"the name of a section before the point; {section} is a single field",
            )
        flags = (section, name) == ("", "flags")
        table[name] = [flag for flag in value.split(",") if flag] if flags else value.strip()
    return parse_scene(document)


def field_names() -> list[str]:
    """Return the names of a scene's fields, as `--set` takes them: inputs, site.latitude and so on."""
    names = []
    for top, info in Scene.model_fields.items():
        if top == "uncertain":  # `--uncertain` says these
            continue
        inside = getattr(info.annotation, "model_fields", ())
        names += [f"{top}.{key}" for key in inside] or [top]
    return names


@cache
def _short_names() -> dict[str, str]:
    """Return the fields by the words that `foucault score --run` fills in: x0 for release.x, latitude, t_end."""
    names = {}
    for name in field_names():
        section, _, key = name.partition(".")
        names[f"{key}0" if key in ("x", "y", "vx", "vy") else key or section] = name
    return names


def full_name(word: str) -> str:
    """Return the name of a field as `section.key` from that name or a short one.

    Other words come back as they are.
    """
    return _short_names().get(word.strip(), word.strip())


def checked_value(name: str, value: str, reading: Reading) -> str:
    """Return the value of one field, checked as it is in a scene whose numbers are read like this.

    Args:
        name: the field, one of `field_names`.
        value: as text.
        reading: how the scene reads numbers.

    Raises:
        InputError: the value is wrong, whatever the other fields are.
    """
    try:
        _check_of(name).validate_python(value, context={"inputs": reading})
    except ValidationError as error:
        # the error names no field, because only one was checked
        wrong = explained(error, {"": unit_of(name)})[0]
        raise InputError(name, value, wrong.expected, wrong.advice) from None
    return value


@cache
def _check_of(name: str) -> TypeAdapter[Any]:
    """Return what checks one field."""
    return TypeAdapter(_declared(name).rebuild_annotation())


def _declared(name: str) -> Any:
    table, _, key = name.rpartition(".")
    model: Any = Scene.model_fields[table].annotation if table else Scene
    return model.model_fields[key]


def unit_of(name: str) -> str:
    """Return the unit of a field, one of `field_names`; "" for none."""
    return str((_declared(name).json_schema_extra or {}).get("unit", ""))


def parse_scene(document: Mapping[str, Any]) -> Scene:
    """Check a scene given as nested mappings.

    Raises:
        InputError: names each wrong field, what it got and what was expected; the first one is its
            `field`.
    """
    if not isinstance(document, Mapping):
        raise InputError(
            "scene", document, "nested mappings: {'id': 'mine', 'release': {'x': '1', 'y': '0'}}"
        )
    unknown_inputs = [*_unknown_inputs(document.get("uncertain"))]
    try:
        scene = Scene.model_validate(dict(document), context={"inputs": document.get("inputs")})
    except ValidationError as error:
        units = {name: unit_of(name) for name in (*Scene.model_fields, *field_names())}
        raise all_of([*explained(error, units), *unknown_inputs]) from None
    if unknown_inputs:
        raise all_of(unknown_inputs)
    if wrong := [*_wrong_in_release(scene, scene.exact), *_wrong_in_run(scene, scene.exact)]:
        raise all_of(wrong)
    return scene


def _unknown_inputs(widths: object) -> Iterator[InputError]:
    """Yield what is wrong with the names under [uncertain]."""
    named = by_full_name(widths)
    for word in named if isinstance(named, Mapping) else ():
        if full_name(str(word)) not in UNCERTAIN:
            expected = "an input on which the motion depends"
            there_are = f"Inputs are {', '.join(UNCERTAIN)}."
            yield unknown(f"uncertain.{word}", word, expected, UNCERTAIN, there_are)


def _wrong_in_release(scene: Scene, exact: Inputs) -> Iterator[InputError]:
    release = scene.release
    fields = set(release.model_dump(exclude_none=True))
    kinds = [names for names in RELEASES.values() if fields & {*names}]
    if not kinds:
        yield InputError("release", NOTHING, "x and y, or angle and azimuth")
        return
    if len(kinds) > 1:
        got = Described(f"both {', '.join(sorted(fields))}")
        expected = "either x, y (and vx, vy) or angle, azimuth (and their rates)"
        yield InputError("release", got, expected, "Keep one kind.")
        return
    needed = kinds[0][:2]
    missing = [name for name in needed if name not in fields]
    for name in missing:
        yield InputError(
            f"release.{name}", NOTHING, "a value", f"Give both {' and '.join(needed)}."
        )
    position = exact.position
    length = exact.length
    if not missing and position and position[0] ** 2 + position[1] ** 2 >= length**2:
        got = Described(f"x = {release.x}, y = {release.y}")
        expected = (
            f"a point below the suspension: x² + y² less than length² = {scene.pendulum.length}²"
        )
        yield InputError(
            "release",
            got,
            expected,
            "To release at or above the horizontal, give angle and azimuth.",
        )


def _wrong_in_run(scene: Scene, exact: Inputs) -> Iterator[InputError]:
    run = scene.run
    if exact.t_end < _LEAST_T_END:
        yield InputError(
            "run.t_end",
            run.t_end,
            f"at least {float(_LEAST_T_END):g} s, so that doubles can divide it",
        )
    elif exact.t_end / exact.grid_step > MAX_ROWS:
        expected = f"at most {MAX_ROWS} grid times up to t_end"
        yield InputError("run.grid_step", run.grid_step, expected, "Take a longer step.")


def load_scene(name: str | Path, values: Words = ()) -> Scene:
    """Read a scene by id, or from the path of a TOML file, with fields replaced as by `Scene.with_values`.

    A file without an id is named after itself: `My hall.toml` is `my_hall`.

    Raises:
        InputError: no such scene, broken TOML, or a wrong field.
    """
    word = str(name)
    if not word.strip():
        raise _no_scene(word)
    path = data_root() / "scenes" / f"{word}.toml" if is_scene_id(word) else Path(word)
    try:
        document = toml_document(path, "SCENE")
    except FileNotFoundError:
        raise _no_scene(word) from None
    except InputError as error:
        if path.suffix == ".toml":
            raise
        advice = f"`foucault show --template` prints one. Before a trajectory: `foucault score SCENE {path.name}`."
        raise InputError(
            error.field, error.got, error.expected, _FOLDER if os.path.isdir(path) else advice
        ) from None
    file_id = re.sub(r"[^a-z0-9]+", "_", path.stem.lower()).strip("_")
    if "id" not in document:
        if not is_scene_id(file_id):
            expected = "an id in the file, or a file name of letters and digits"
            raise InputError("id", path.name, expected, 'Add a line such as id = "mine" to it.')
        document["id"] = file_id
    return _with_values(document, values)


AnyScene = Scene | str | Path | Mapping[str, Any]


def as_scene(scene: AnyScene) -> Scene:
    """Return a scene that is given as one, by its id or the path of a TOML file, or as nested mappings.

    A float in the mappings stands for the decimal that Python prints for it: 0.1 is the decimal
    0.1.

    Raises:
        InputError: it is none of these, or a field is wrong.
    """
    if isinstance(scene, Mapping):
        return parse_scene(_floats_as_text(scene))
    if isinstance(scene, str | Path):
        return load_scene(scene)
    if not isinstance(scene, Scene):
        raise InputError(
            "scene", scene, "a Scene, an id, the path of a TOML file, or nested mappings"
        )
    return scene


def _floats_as_text(document: Mapping[str, Any]) -> dict[str, Any]:
    def text(value: Any) -> Any:
        if isinstance(value, Mapping):
            return _floats_as_text(value)
        return str(value) if isinstance(value, Real) and not isinstance(value, Integral) else value

    return {key: text(value) for key, value in document.items()}


_FOLDER = "It is a folder. `foucault verify` checks datasets and ranges; reference.load and load_ranges read them."


def _no_scene(word: str) -> InputError:
    expected = "a scene's id or the path of a TOML file"
    if os.path.isdir(word):
        return InputError("SCENE", word, expected, _FOLDER)
    return unknown("SCENE", word, expected, scene_ids(), "`foucault scenes` lists the ids.")
