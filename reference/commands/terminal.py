"""Parts shared by all commands: arguments, options, completion, refusals, JSON on stdout."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Annotated, Any

import typer

from ..errors import InputError, NoEffectError, Stopped, check_whole, did_you_mean, in_words
from ..plain_text import plain_json
from ..scenes.scene import Scene, field_names, full_name
from ..scenes.shipped import scene_ids


def completion(names: Callable[[], Iterable[str]]) -> Callable[[str], list[str]]:
    """Return the completion function of a shell, which lists the names that begin with the typed text."""
    return lambda incomplete: [name for name in names() if name.startswith(incomplete)]


def option(
    word: str,
    text: str,
    value: str | None = None,
    names: Callable[[str], list[str]] | None = None,
    **more: Any,
) -> Any:
    """Return an option: its word, its help, the word for its value, and its completion.

    More arguments are those of `typer.Option`.
    """
    return typer.Option(word, help=text, metavar=value, autocompletion=names, **more)


def scene_argument(
    text: str = "A scene's id, or the path of a TOML file.", value: str = "SCENE"
) -> Any:
    """Return the argument for a scene, with its help and its name; a shell completes the ids."""
    return typer.Argument(metavar=value, help=text, autocompletion=completion(scene_ids))


SceneWord = Annotated[str, scene_argument()]
Assignments = Annotated[
    list[str] | None,
    option(
        "--set",
        "Replace one field of the scene: site.latitude=0, or x0=0.1; may be repeated.",
        "KEY=VALUE",
        completion(lambda: (f"{name}=" for name in field_names())),
    ),
]
Uncertain = Annotated[
    list[str] | None,
    option(
        "--uncertain",
        "Prove intervals for an uncertain input: length=±0.001, or +-0.001; may be repeated; "
        "none takes all as exact (default: the scene's [uncertain]).",
        "KEY=±W",
    ),
]
# why an option is refused
BESIDE_RANGES = "while inputs are uncertain (--uncertain none takes them as exact)"
EndTime = Annotated[
    str | None, option("--t-end", "End at this time, in s (default: the scene's).", "S")
]
Workers = Annotated[int | None, option("--workers", "Use this many cores (default: all).", "N")]
Cluster = Annotated[
    str | None, option("--cluster", "Use dask.distributed: tcp://HOST:PORT, or local:N.", "ADDRESS")
]
Sections = Annotated[
    list[str] | None,
    option(
        "--section",
        "Also find other moments: highest, lowest, 'gate 30', 'gate 30@0', 'turn 90'; may be repeated.",
        "WORD",
    ),
]
AsJson = Annotated[bool, option("--json", "Print one JSON document on stdout and nothing else.")]


def emit(document: dict[str, Any]) -> None:
    """Print one JSON document."""
    typer.echo(plain_json(document))


@contextmanager
def stoppable(outcome: str) -> Iterator[None]:
    """Make Ctrl-C end the command with one line that says what became of its work, or how to resume.

    Raises:
        Stopped: it was interrupted.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise Stopped(outcome) from None


def chosen(option: str, word: str, names: Iterable[str]) -> str:
    """Return the word given to an option with a few choices.

    Raises:
        InputError: it is none of them.
    """
    choices = list(names)
    if word not in choices:
        raise InputError(option, word, in_words(choices), did_you_mean(word, choices, ""))
    return word


def replacements(
    assignments: Iterable[str] | None,
    options: Mapping[str, tuple[str, str | None]],
    unused: Mapping[str, str] | None = None,
    note: Callable[[str], None] | None = None,
) -> list[str]:
    """Return the replacements of a scene's fields, from `--set` and from options such as `--t-end`.

    Args:
        assignments: those of `--set`.
        options: the field that each option replaces, and its value; None if it was not given.
        unused: fields, or fields with a value, that make no difference to the command, and why.
        note: called with a sentence for each of these that is replaced; without it they are
            refused.

    Raises:
        InputError: a replacement would have no effect: the field is replaced by two values, or it
            is an unused one.
    """
    values = _assigned(assignments or (), unused or {}, note)
    for option, (field, text) in options.items():
        if text is None:
            continue
        value = f"{field}={text}"
        same_end = option == "--t-end" and values.get(field) == value
        if field in values and not same_end:
            expected = f"no value together with --set {values[field]}"
            raise InputError(option, text, expected, "Keep one of the two.")
        values[field] = value
    return list(values.values())


def _assigned(
    assignments: Iterable[str], unused: Mapping[str, str], note: Callable[[str], None] | None
) -> dict[str, str]:
    """Return the replacements by `--set`, by field; for the arguments see `replacements`.

    Raises:
        InputError: a field is replaced twice, or is an unused one.
    """
    values: dict[str, str] = {}
    for assignment in assignments:
        word, sign, value = assignment.partition("=")
        field = full_name(word)
        reason = unused.get(field) or unused.get(f"{field}{sign}{value.strip()}")
        if reason and note is None:
            raise InputError("--set", assignment, "a field that has an effect here", reason)
        if reason and note is not None:
            note(f"--set {assignment} has no effect here. {reason}")
        if field in values:
            advice = f"--set {values[field]} is given as well: keep one of the two."
            raise InputError("--set", assignment, f"one value of {field}", advice)
        values[field] = assignment
    return values


def widths_by_name(words: Iterable[str] | None, scene: Scene) -> dict[str, str] | None:
    """Return the widths from `--uncertain` and from the scene, by name; None if all inputs are exact.

    Raises:
        InputError: a word is not KEY=±WIDTH, or one key has two widths.
    """
    if list(words or ()) == ["none"]:
        return None
    typed: dict[str, str] = {}
    for word in words or ():
        key, sign, width = word.partition("=")
        name = key.strip()
        if not sign or not name:
            raise InputError("--uncertain", word, "KEY=±WIDTH, such as pendulum.length=±0.001")
        if name in typed:
            advice = f"{name}={typed[name]} is given as well: keep one of the two."
            raise InputError("--uncertain", word, f"one width of {name}", advice)
        typed[name] = width
    overridden = {full_name(name) for name in typed}
    widths = {name: width for name, width in scene.uncertain.items() if name not in overridden}
    widths |= typed
    return widths or None


def refuse(options: Mapping[str, object], why: str) -> None:
    """Refuse options that have no effect, such as those given "without --run".

    Raises:
        InputError: one of the options was given: its value is neither None, nor False, nor empty.
    """
    for option, value in options.items():
        if value is not None and value is not False and value != []:  # 0 was given
            raise NoEffectError(option, _as_typed(value), why)


def _as_typed(value: object) -> str:
    """Return the value of an option as it was typed; a switch is "set"."""
    if value is True:
        return "set"
    if isinstance(value, list):
        return " ".join(map(str, value))
    return str(value)


def check_workers(workers: int | None, cluster: str | None) -> None:
    """Refuse a wrong number of workers, or any number together with a cluster.

    Raises:
        InputError: one of the two.
    """
    if cluster is not None:
        refuse({"--workers": workers}, "together with --cluster")
    if workers is not None:
        check_whole("--workers", workers)
