"""A command whose options are the fields of a class, and the table of options that exclude each other."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeVar, get_args, get_type_hints

from typer.models import OptionInfo

from .terminal import refuse

Chosen = TypeVar("Chosen")


@dataclass(frozen=True)
class Conflict:
    """Options that have no effect in a case; the error message names both.

    Attributes:
        options: as they are typed, separated by spaces.
        case: such as "without --run".
        applies: returns whether the chosen options are such a case. It may load the scene that they
            name, and raise InputError if that cannot be read.
    """

    options: str
    case: str
    applies: Callable[[Any], bool]


def as_command(options: type[Chosen], run: Callable[[Chosen], None]) -> Callable[..., None]:
    """Return a function for typer: one keyword for each field of a dataclass, and the docstring of `run`.

    Args:
        options: a dataclass; each field is annotated with its `typer.Option` or `typer.Argument`. A field without a
            default is required.
        run: called with the options that a user chose.
    """

    def command(**values: Any) -> None:
        run(options(**values))

    hints = get_type_hints(options, include_extras=True)
    parameters = []
    for field in dataclasses.fields(options):  # type: ignore[arg-type]
        required = field.default is dataclasses.MISSING
        parameter = inspect.Parameter(
            field.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if required else field.default,
            annotation=hints[field.name],
        )
        parameters.append(parameter)
    command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    command.__annotations__ = hints
    command.__doc__ = run.__doc__
    return command


def values_by_word(options: Any) -> dict[str, Any]:
    """Return what was chosen by the word that a user types: `--set`, or `SCENE` for an argument.

    An option at its default has None, whether or not it was typed: it changes nothing.
    A switch of two words, such as `--audit/--no-audit`, has both: the second holds True if it was
    switched off.
    """
    values: dict[str, Any] = {}
    hints = get_type_hints(type(options), include_extras=True)
    for field in dataclasses.fields(options):
        value = getattr(options, field.name)
        if value == field.default:
            value = None
        declared = get_args(hints[field.name])[1]
        if not isinstance(declared, OptionInfo):
            values[declared.metavar.strip("[]")] = value
            continue
        on, _, off = str(declared.default).partition("/")
        values[on] = value
        if off:
            values[on] = value or None
            values[off] = value is False
    return values


def refuse_conflicts(options: Any, conflicts: Iterable[Conflict]) -> None:
    """Refuse options that would have no effect beside the others.

    Raises:
        InputError: one was given that has no effect; the message names the option and the case. Or
            a case depends on a scene that cannot be read.
    """
    values = values_by_word(options)
    for conflict in conflicts:
        if conflict.applies(options):
            refuse({word: values[word] for word in conflict.options.split()}, conflict.case)
