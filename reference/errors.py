"""Messages to users: exceptions, each with an exit status, and the names near a wrong one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from numbers import Integral
from os import PathLike
from pathlib import Path

from .plain_text import plain, plain_lines, shortened

LONGEST_VALUE = 120  # characters of a value that a message repeats
_MOST = 5  # names in a message at most
# of difflib, from 0 to 1: names that are as alike as this leave no room for others
_VERY_ALIKE = 0.8
_MOST_WHOLE = 2**62  # of a number that is counted: what libraries in C take
_LEAST_PART = 3  # characters of a word that is looked for inside the names as well


class FoucaultError(Exception):
    """Base of every error that this project raises on purpose."""

    exit_status = 1

    def __init__(self, text: str) -> None:
        super().__init__(plain_lines(text))


class Described(str):
    """What a field got, described rather than quoted: a message shows it without quotation marks."""

    __slots__ = ()


NOTHING = Described("nothing")


class InputError(FoucaultError):
    """A user's mistake: the field, the value it got, what was expected, and advice."""

    exit_status = 2

    def __init__(self, field: str, got: object, expected: str, advice: str = "") -> None:
        self.field = field
        self.got = got
        self.expected = expected
        self.advice = advice
        text = f"{plain(field)}: got {_shown(got)}, expected {expected}."
        super().__init__(f"{text} {advice}".rstrip())


class NotInstalledError(InputError):
    """A package is missing: the field that needs it, its purpose, and the command that installs it."""

    def __init__(
        self, field: str, purpose: str, package: str, command: str, instead: str = ""
    ) -> None:
        expected = f"the package {package}"
        advice = f"Install it with {command}{instead}."
        super().__init__(field, NOTHING, expected, advice)
        text = f"{plain(field)}: {purpose} needs {expected}, which is not installed. {advice}"
        self.args = (plain_lines(text),)


class NoEffectError(InputError):
    """An option has no effect in this case, such as "without --run"."""

    def __init__(self, option: str, value: str, case: str) -> None:
        advice = "Leave it out."
        super().__init__(option, value, f"no value {case}", advice)
        self.args = (plain_lines(f"{plain(option)}: has no effect {case}. {advice}"),)


@contextmanager
def usable(
    field: str, path: Path, expected: str = "a folder that can be written to"
) -> Iterator[None]:
    """Turn an OSError into an InputError; `field` is the option or variable that names the path."""
    try:
        yield
    except OSError as error:
        raise InputError(field, str(path), expected, f"{error.strerror}.") from None


def checked_path(field: str, path: object, expected: str, advice: str = "") -> Path:
    """Return a path that a caller gave; anything but text or a path is an InputError."""
    if not isinstance(path, str | PathLike):
        raise InputError(field, path, expected, advice)
    return Path(path)


def check_whole(
    field: str, number: object, least: int = 1, words: str = "a whole number, 1 or more"
) -> None:
    """Raise InputError unless a number is whole and at least `least`, as `words` say."""
    if not _is_whole(number, least):
        raise InputError(field, number, words)


def _is_whole(number: object, least: int) -> bool:
    """Return whether a number is whole, at least `least`, and small enough for libraries in C."""
    if not isinstance(number, Integral) or isinstance(number, bool):
        return False
    return least <= int(number) <= _MOST_WHOLE


def all_of(mistakes: Sequence[InputError]) -> InputError:
    """Return the first of some mistakes; its text lists all of them, one a line."""
    first = mistakes[0]
    if len(mistakes) > 1:
        lines = [f"{len(mistakes)} mistakes:", *map(str, mistakes)]
        first.args = (plain_lines("\n  ".join(lines)),)
    return first


def _shown(value: object) -> str:
    """Return the beginning of a value in quotation marks, or a description without them."""
    if isinstance(value, Described):
        return shortened(plain(value), LONGEST_VALUE)
    try:
        text = value if isinstance(value, str) else repr(value)
    # an integer of more than 4300 digits, or lists in lists without end
    except (ValueError, RecursionError):
        return f"a value too large to print, of type {type(value).__name__}"
    return repr(shortened(text, LONGEST_VALUE))


class UnreachableError(FoucaultError):
    """The requested level or digits cannot be reached; the reason says how far the solver came."""

    exit_status = 3

    def __init__(self, reason: str, advice: str = "") -> None:
        self.reason = reason
        self.advice = advice
        super().__init__(f"{reason} {advice}".rstrip())


class IntegrationError(UnreachableError):
    """The integrator stopped, warned, or contradicted itself; a failed run returns no numbers."""


class BoxTooWideError(UnreachableError):
    """Inputs are too uncertain for a proof of the whole run; it holds up to `holds_s`, in s."""

    def __init__(self, holds_s: float, advice: str) -> None:
        self.holds_s = holds_s
        super().__init__(
            f"The inputs are too uncertain: the proof reaches only t = {holds_s:.4g} s.", advice
        )


class BeyondDoublesError(UnreachableError):
    """A number of a scene is too large for computations in binary64, such as steps and sizes."""

    def __init__(self) -> None:
        super().__init__(
            "A length, force, rate or time of the scene is beyond the range of binary64."
        )


class DatasetError(FoucaultError):
    """A golden dataset is damaged or contradicts itself; `problems` lists how."""

    def __init__(self, path: str, problems: list[str]) -> None:
        self.path = path
        self.problems = problems
        super().__init__(f"{path}: " + "; ".join(problems))


class Stopped(FoucaultError):
    """The user stopped a command (Ctrl-C); the message says what became of its work."""

    exit_status = 130

    def __init__(self, outcome: str) -> None:
        super().__init__(f"stopped; {outcome}")


def nearest(word: object, known: Iterable[str]) -> list[str]:
    """Return at most five names like a word.

    The first kind that exists: the word itself, names that it shortens (site.g), very similar
    names, names that contain it, similar names.
    """
    names = {name.lower(): name for name in known}
    typed = str(word).lower()  # callers in Python give anything
    if typed in names:
        return [names[typed]]
    matches = (
        _shortened_by(typed, names)
        or get_close_matches(typed, names, n=_MOST, cutoff=_VERY_ALIKE)
        or _containing(typed, names)
        or get_close_matches(typed, names, n=_MOST)
    )
    return [names[name] for name in matches[:_MOST]]


def _shortened_by(typed: str, names: Iterable[str]) -> list[str]:
    """Return the names in the section of a word whose key begins with the word's, as in site.g."""
    section, _, key = typed.rpartition(".")
    if not key:
        return []
    return [name for name in names if name.startswith(section) and f".{key}" in name]


def _containing(typed: str, names: Iterable[str]) -> list[str]:
    """Return the names that contain a word, the shortest first."""
    if len(typed) < _LEAST_PART:
        return []
    return sorted((name for name in names if typed in name), key=len)


def did_you_mean(word: object, known: Iterable[str], otherwise: str) -> str:
    """Return the question if one of the nearest names was meant; `otherwise` if none is near."""
    names = nearest(word, known)
    return f"Did you mean {in_words(names)}?" if names else otherwise


def in_words(names: Sequence[str]) -> str:
    """Return names as a phrase: a, b or c."""
    *first, last = names
    return f"{', '.join(first)} or {last}" if first else last


def counted(count: int, word: str) -> str:
    """Return how many there are of something."""
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def unknown(
    field: str, word: object, expected: str, known: Iterable[str], otherwise: str
) -> InputError:
    """Return the error for an unknown word.

    Args:
        field: what the word was given for.
        word: as typed.
        expected: what it should have been.
        known: the names that exist.
        otherwise: advice if no name is near, such as the command that lists them.
    """
    return InputError(field, word, expected, did_you_mean(word, known, otherwise))


def no_attribute(owner: str, name: str, names: Iterable[str]) -> AttributeError:
    """Return the error for an unknown attribute; it lists the names, the nearest first."""
    text = f"{owner} has no attribute {name!r}"
    if name.startswith("_"):  # Python itself asks for such names, and wants no advice
        return AttributeError(text)
    every = sorted(names)
    near = nearest(name, every)
    others = [known for known in every if known not in near]
    return AttributeError(f"{text}; it has {', '.join([*near, *others])}")
