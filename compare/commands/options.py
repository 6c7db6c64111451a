"""Shared parts of the commands: comma-separated options and their completion, folders of results, the final output."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from reference import InputError, Scene, load_scene
from reference.commands.terminal import emit, option


def completion_of_lists(names: Callable[[], Iterable[str]]) -> Callable[[str], list[str]]:
    """Return the completion function of a shell for the next name in a comma-separated list."""

    def lists(incomplete: str) -> list[str]:
        before, comma, last = incomplete.rpartition(",")
        used = before.split(",")
        return [
            f"{before}{comma}{name}"
            for name in names()
            if name.startswith(last) and name not in used
        ]

    return lists


def method_ids() -> list[str]:
    """Return the ids of the methods; their files are imported at the first call."""
    from ..methods import METHODS

    return list(METHODS)


METHODS = option(
    "--methods",
    "Ids of methods, as `foucault methods` lists them (default: all that apply).",
    "A,B,…",
    completion_of_lists(method_ids),
)
FOLDER = option(
    "--out", "Write CSV, JSON and an HTML page into this folder (default: none).", "DIR"
)
PROGRAM = option(
    "--run", "Study your program too; {setting} is its step. May be repeated.", "'COMMAND'"
)
PROGRAM_OF_STABILITY = option(
    "--run",
    "Study your program too; {setting} is its step: 2π/200 over a scene's fastest rate. May be repeated.",
    "'COMMAND'",
)
NAME = option(
    "--name", "Name of the program of --run, one for each (default: its file's name).", "WORD"
)

Methods = Annotated[str | None, METHODS]
Folder = Annotated[Path | None, FOLDER]
Commands = Annotated[list[str] | None, PROGRAM]
CommandsOfStability = Annotated[list[str] | None, PROGRAM_OF_STABILITY]
Names = Annotated[list[str] | None, NAME]


def listed(text: str | None, field: str) -> list[str] | None:
    """Split a comma-separated option into words."""
    if text is None:
        return None
    words = [word.strip() for word in text.split(",") if word.strip()]
    if not words:
        raise InputError(field, text, "at least one word", "Separate words by commas.")
    return words


def numbers(text: str, field: str) -> list[float]:
    """Split a comma-separated option into positive numbers."""
    from ..studies.study_plan import parsed

    values = parsed(text.split(","), float)
    if not values or not all(0 < value < float("inf") for value in values):
        raise InputError(field, text, "positive numbers", "Separate numbers by commas.")
    return values


def scene_named(word: str, values: Sequence[str]) -> Scene:
    """Return the scene of this id or TOML file, with fields replaced.

    Raises:
        InputError: there is no such scene, or a field is wrong. Of a dataset it names the scene.
    """
    from reference import load
    from reference.dataset.manifest import MANIFEST
    from reference.dataset.place import golden_folder

    try:
        return load_scene(word, values)
    except InputError as error:
        if error.field != "SCENE" or not (golden_folder(word) / MANIFEST).is_file():
            raise
        advice = f"It is a dataset. Name its scene: {scene_words(load(word).manifest.id)}"
        raise InputError(error.field, error.got, error.expected, advice) from None


def scene_words(dataset_id: str) -> str:
    """Return the words of a command that name the scene of a dataset, by the dataset's id."""
    from reference.dataset.place import changes_in

    name, _, _ = dataset_id.partition("+")
    scene_id, _, reading = name.partition(".")
    fields = changes_in(dataset_id)
    if reading:
        fields = [f"inputs={reading}", *fields]
    return " ".join([scene_id, *(f"--set {field}" for field in fields)])


def check_positive(option: str, value: float | None, unit: str = "seconds") -> None:
    """Raise InputError unless the value of an option is positive; None is allowed."""
    if value is not None and not 0 < value < float("inf"):
        raise InputError(option, f"{value:g}", f"a positive number of {unit}")


def programs_of(
    run: Sequence[str] | None, names: Sequence[str] | None, scene: Scene
) -> dict[str, str]:
    """Return the commands of --run by name; refuse any that cannot be run with a scene's values."""
    from ..candidates.external import SETTING, arguments
    from ..methods import named_programs

    for command in run or ():
        arguments(command.replace(SETTING, "0.1"), scene)
    return named_programs(run or (), names or ())


def resumes(folder: Path | None) -> str:
    """Return a sentence on what becomes of a stopped campaign whose results go into a folder (None: nowhere)."""
    if folder is None:
        return "nothing was kept; with --out DIR the same command could resume"
    return "the same command with the same --out resumes"


def announce(text: str) -> None:
    """Print a message on stderr before work that takes long."""
    typer.echo(text, err=True)


def finish(
    document: dict[str, Any],
    text: Callable[[dict[str, Any]], str],
    page: Path | None,
    as_json: bool,
) -> None:
    """Print a result as a JSON document, or as text with the path of the page that was written."""
    if as_json:
        emit(document)
        return
    typer.echo(text(document))
    if page is not None:
        typer.echo(f"{page}: the report")
