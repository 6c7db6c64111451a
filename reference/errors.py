r"""Messages to users: the exceptions of this project, each with an exit status; names near a wrong one; plain text.

Titles, file names and what programs print come from strangers; an escape sequence among them could rewrite a verdict
on the screen, so control characters are written out, as in \x1b, and never obeyed: in messages, in documents, and in
all that a command prints.
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from numbers import Integral
from os import PathLike
from pathlib import Path
from typing import Any, TextIO, cast

LONGEST_VALUE = 120  # characters of a value that a message repeats
MOST = 5  # names in a message at most
VERY_ALIKE = 0.8  # of difflib, from 0 to 1: names that are as alike as this leave no room for others
MOST_WHOLE = 2**62  # of a number that is counted: what libraries in C take
LEAST_PART = 3  # characters of a word that is looked for inside the names as well

# controls, invisible and direction-changing characters, separators of lines, bytes that are not UTF-8 (surrogates),
# and the last two, which XML forbids
_UNSAFE = (
    r"\x00-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\ud800-\udfff"
    r"\ufffe\uffff\U000e0000-\U000e007f"
)
_CONTROL = re.compile(f"[{_UNSAFE}]")
_CONTROL_BUT_LINES = re.compile(rf"(?![\n\t])[{_UNSAFE}]")


class FoucaultError(Exception):
    """Base of every error that this project raises on purpose."""

    exit_status = 1

    def __init__(self, text: str) -> None:
        super().__init__(plain_lines(text))


class InputError(FoucaultError):
    """A user's mistake: the field, the value it got, what was expected, and advice."""

    exit_status = 2

    def __init__(self, field: str, got: object, expected: str, advice: str = "") -> None:
        self.field, self.got, self.expected, self.advice = field, got, expected, advice
        text = f"{plain(field)}: got {_shown(got)!r}, expected {expected}."
        super().__init__(f"{text} {advice}".rstrip())


class NotInstalledError(InputError):
    """A package is missing: the field that asks for it, what needs it, and the extra that installs it."""

    def __init__(self, field: str, purpose: str, package: str, extra: str, instead: str = "") -> None:
        expected = f"the package {package}"
        advice = f"Install it with pip install 'foucault-reference[{extra}]'{instead}."
        super().__init__(field, "not installed", expected, advice)
        self.args = (plain_lines(f"{plain(field)}: {purpose} needs {expected}, which is not installed. {advice}"),)


@contextmanager
def usable(field: str, path: Path, expected: str = "a folder that can be written to") -> Iterator[None]:
    """Make an InputError of what the disk refuses; `field` is the option or variable that names the path."""
    try:
        yield
    except OSError as error:
        raise InputError(field, str(path), expected, f"{error.strerror}.") from None


def checked_path(field: str, path: object, expected: str, advice: str = "") -> Path:
    """Return a path that a caller gave; anything but text or a path is an InputError, whose arguments these are."""
    if not isinstance(path, str | PathLike):
        raise InputError(field, path, expected, advice)
    return Path(path)


def check_whole(field: str, number: object, least: int = 1, words: str = "a whole number from 1") -> None:
    """Raise InputError for what is no whole number from `least` on; `words` say what was expected."""
    if not isinstance(number, Integral) or isinstance(number, bool) or not least <= int(number) <= MOST_WHOLE:
        raise InputError(field, number, words)


def all_of(mistakes: Sequence[InputError]) -> InputError:
    """Return the first of some mistakes; where there are several, its text tells all of them, one a line."""
    first = mistakes[0]
    if len(mistakes) > 1:
        first.args = (plain_lines("\n  ".join((f"{len(mistakes)} mistakes:", *map(str, mistakes)))),)
    return first


def _shown(value: object) -> str:
    """Return the beginning of a value as text."""
    try:
        text = value if isinstance(value, str) else repr(value)
    except (ValueError, RecursionError):  # an integer of more than 4300 digits, or lists in lists without end
        text = f"too large a value to print, {type(value).__name__}"
    return shortened(text, LONGEST_VALUE)


class UnreachableError(FoucaultError):
    """The requested level or digits cannot be reached; the reason says how far the solver came."""

    exit_status = 3

    def __init__(self, reason: str, advice: str = "") -> None:
        self.reason, self.advice = reason, advice
        super().__init__(f"{reason} {advice}".rstrip())


class IntegrationError(UnreachableError):
    """The integrator stopped, warned, or contradicted itself; a failed run returns no numbers."""


class BeyondDoublesError(UnreachableError):
    """A number of a scene is too large for what is computed in binary64, such as steps and sizes."""

    def __init__(self) -> None:
        super().__init__("A length, force, rate or time of the scene is beyond the range of binary64.")


class DatasetError(FoucaultError):
    """A golden dataset is damaged or contradicts itself; `problems` lists how."""

    def __init__(self, path: str, problems: list[str]) -> None:
        self.path, self.problems = path, problems
        super().__init__(f"{path}: " + "; ".join(problems))


class Stopped(FoucaultError):
    """The user stopped a command (Ctrl-C); the message says what became of its work."""

    exit_status = 130

    def __init__(self, outcome: str) -> None:
        super().__init__(f"stopped; {outcome}")


def nearest(word: object, known: Iterable[str]) -> list[str]:
    """Return at most five names: a word's own or what it shortens (site.g), very like it, containing it, or like it."""
    names = {name.lower(): name for name in known}
    typed = str(word).lower()  # callers in Python give anything
    section, _, key = typed.rpartition(".")
    short = [name for name in names if key and name.startswith(section) and f".{key}" in name]
    for alike in ([typed] if typed in names else short, get_close_matches(typed, names, n=MOST, cutoff=VERY_ALIKE)):
        if alike:
            return [names[name] for name in alike[:MOST]]
    containing = sorted((name for name in names if len(typed) >= LEAST_PART and typed in name), key=len)
    return [names[name] for name in (containing or get_close_matches(typed, names, n=MOST))][:MOST]


def did_you_mean(word: object, known: Iterable[str], otherwise: str) -> str:
    """Return the question whether one of the nearest names was meant; `otherwise` if no name is near."""
    names = nearest(word, known)
    return f"Did you mean {in_words(names)}?" if names else otherwise


def in_words(names: Sequence[str]) -> str:
    """Return names as a phrase: a, b or c."""
    return " or ".join(part for part in (", ".join(names[:-1]), names[-1]) if part)


def counted(count: int, word: str) -> str:
    """Return how many there are of something."""
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def unknown(field: str, word: object, expected: str, known: Iterable[str], otherwise: str) -> InputError:
    """Return the error for a word that is none of the known ones.

    Args:
        field: what the word was given for.
        word: as typed.
        expected: what it should have been.
        known: the names that exist.
        otherwise: advice if no name is near, such as the command that lists them.
    """
    return InputError(field, word, expected, did_you_mean(word, known, otherwise))


def no_attribute(owner: str, name: str, names: Iterable[str]) -> AttributeError:
    """Return the error for an unknown attribute, which says what there is, the nearest names first."""
    text = f"{owner} has no attribute {name!r}"
    if name.startswith("_"):  # Python itself asks for such names, and wants no advice
        return AttributeError(text)
    every = sorted(names)
    near = nearest(name, every)
    return AttributeError(f"{text}; it has {', '.join([*near, *(other for other in every if other not in near)])}")


def is_plain(text: str) -> bool:
    """Return whether a text is one line without control characters."""
    return _CONTROL.search(text) is None


def plain(text: str) -> str:
    """Return a text in one line, its control characters written out."""
    return _CONTROL.sub(_written_out, text)


def plain_lines(text: str) -> str:
    """Return a text of several lines, all control characters but newline and tab written out."""
    return _CONTROL_BUT_LINES.sub(_written_out, text)


def plain_json(document: Any) -> str:
    """Return a document as JSON, control characters as JSON writes them; NaN and infinity, which it lacks, as null."""
    text = json.dumps(finite(document), indent=1, ensure_ascii=False, allow_nan=False)
    return _CONTROL_BUT_LINES.sub(lambda match: json.dumps(match[0])[1:-1], text)


def finite(value: Any) -> Any:
    """Return a document of dictionaries, lists and values with None for each NaN and infinity."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _written_out(match: re.Match[str]) -> str:
    code = ord(match[0])
    if 0xDC80 <= code <= 0xDCFF:  # how Python holds a byte that is not UTF-8
        return f"\\x{code - 0xDC00:02x}"
    return match[0].encode("unicode_escape").decode()


def shortened(text: str, most: int) -> str:
    """Return a text of at most `most` characters, which ends in … if it was longer."""
    return text if len(text) <= most else f"{text[: most - 1]}…"


class PlainStream:
    """A stream of text that writes control characters out, and characters that its encoding lacks."""

    encoding = "utf-8"  # every text can be written

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write a text, and return its length."""
        encoding = self._stream.encoding or "utf-8"
        self._stream.write(plain_lines(text).encode(encoding, "backslashreplace").decode(encoding))
        return len(text)

    def writelines(self, texts: Iterable[str]) -> None:
        """Write texts one after the other."""
        for text in texts:
            self.write(text)


@contextmanager
def plain_output() -> Iterator[None]:
    """Write control characters out, in all that this process prints on stdout and stderr."""
    before = {name: getattr(sys, name) for name in ("stdout", "stderr")}
    during = {name: PlainStream(stream) for name, stream in before.items()}
    for name, stream in during.items():
        setattr(sys, name, stream)
    try:
        yield
    finally:
        for name, stream in during.items():
            if getattr(sys, name) is stream:  # a command line puts another in place when its reader has gone
                setattr(sys, name, before[name])


def terminal_of(stream: TextIO) -> TextIO:
    """Return the stream behind a `PlainStream`, for those who write their own escape sequences, such as bars."""
    return cast("TextIO", getattr(stream, "_stream", stream))
