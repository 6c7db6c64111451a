"""Read files from untrusted sources: only regular files of bounded size, and TOML and JSON of bounded depth."""

from __future__ import annotations

import errno
import json
import os
import re
import stat
import sys
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO

from ..errors import InputError

MAX_BYTES = 1 << 16  # of a TOML file
MAX_JSON_BYTES = 1 << 30  # the plan of a sweep may list millions of rows
# words of a dotted key; a scene has two. The parser's time and memory grow with the square
MAX_DEPTH = 32
_QUOTED = 200  # characters of the parser's message that are quoted

_WORD = r"""(?:[\w-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')"""
_DEEP_KEY = re.compile(rf"(?<![\w\\-]){_WORD}(?:[ \t]*\.[ \t]*{_WORD}){{{MAX_DEPTH}}}", re.ASCII)

_LINE_NUMBER = re.compile(r"at line (\d+)")  # in a message of the parser
_ASSIGNED = rf"{_WORD}(?:\.{_WORD})*\s*=\s*"
_TYPOGRAPHIC = re.compile(rf"{_ASSIGNED}[“”„‟‘’‚«»]")
_UNQUOTED = re.compile(rf"{_ASSIGNED}[^\s\"'\[{{]")


def open_at_once(path: Path) -> BinaryIO:
    """Open a file for reading; a pipe is opened at once, whether or not anybody writes to it.

    Raises:
        OSError: it cannot be opened; also for a path that no file can have, such as one with a zero
            byte.
    """
    try:
        return open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK))
    except ValueError as error:
        raise OSError(errno.EINVAL, f"This cannot be the path of a file: {error}") from None


def toml_document(path: Path, field: str) -> dict[str, Any]:
    """Return the tables of a TOML file.

    Args:
        path: of the file.
        field: what the user gave it for, to be named in messages.

    Raises:
        FileNotFoundError: there is no such file.
        InputError: it is no regular file, cannot be read, is larger than `MAX_BYTES`, or is no
            TOML.
    """
    data = _read(path, field, MAX_BYTES, "a TOML file")
    text = ""
    try:
        text = data.decode("utf-8-sig")  # some editors write a byte order mark
        if _DEEP_KEY.search(text):
            raise InputError(
                field, str(path), f"a TOML file with keys of at most {MAX_DEPTH} parts"
            )
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        reason = f"{_reason(error)} {_wrong_line(str(error), text)}".rstrip()
        raise InputError(field, str(path), "a TOML file", reason) from None


def _wrong_line(message: str, text: str) -> str:
    """Return the line of a TOML file that the parser's message is about, and advice on it; "" if it names none."""
    found = _LINE_NUMBER.search(message)
    lines = text.split("\n")
    if found is None or int(found[1]) > len(lines):
        return ""
    line = lines[int(found[1]) - 1].strip()[:_QUOTED]
    return f"Line {found[1]}: `{line}`. {_how_to_correct(line)}".rstrip()


def _how_to_correct(line: str) -> str:
    """Return advice on a line that is no TOML; "" if there is none."""
    if _TYPOGRAPHIC.match(line):
        return 'Write straight quotation marks: "5".'
    if line.count('"') % 2:
        return "A quotation mark is missing."
    if _UNQUOTED.match(line):
        return "Put the value in quotes."
    return ""


def texts_of(module: str) -> dict[str, Any]:
    """Return the TOML document beside a module, of the same name; the module is given by its `__file__`."""
    return tomllib.loads(Path(module).with_suffix(".toml").read_text(encoding="utf-8"))


def json_document(path: Path, field: str) -> dict[str, Any]:
    """Return the dictionary of a JSON file; arguments and errors as of `toml_document`."""
    data = _read(path, field, MAX_JSON_BYTES, "a JSON document")
    try:
        document = json.loads(data.decode())
    except (ValueError, RecursionError) as error:
        raise InputError(field, str(path), "a JSON document", _reason(error)) from None
    if not isinstance(document, dict):
        raise InputError(field, str(path), "a JSON object of keys and values")
    return document


def json_lines(path: Path, field: str) -> Iterator[dict[str, Any]]:
    """Yield the dictionaries in a file of JSON lines; other lines, such as a truncated one, are skipped.

    Arguments and errors are those of `toml_document`.
    """
    for line in _read(path, field, MAX_JSON_BYTES, "a file of JSON lines").splitlines():
        document = None
        with suppress(ValueError, RecursionError):
            document = json.loads(line.decode())
        if isinstance(document, dict):
            yield document


@contextmanager
def regular(path: Path, field: str, most: int, expected: str) -> Iterator[BinaryIO]:
    """Open a regular file for reading.

    Args:
        path: of the file.
        field: what the user gave it for, to be named in messages.
        most: bytes that it has at most.
        expected: what it should be, such as "a TOML file".

    Raises:
        FileNotFoundError: there is no such file.
        InputError: it is none, is larger, or cannot be read.
    """
    try:
        with open_at_once(path) as stream:
            status = os.fstat(stream.fileno())
            if not stat.S_ISREG(status.st_mode):
                raise InputError(
                    field, str(path), "a regular file", "Pipes and devices are not read."
                )
            if status.st_size > most:
                raise InputError(field, str(path), f"{expected} of at most {most} bytes")
            yield stream
    except FileNotFoundError:
        raise
    except OSError as error:
        raise InputError(field, str(path), "a readable file", f"{error.strerror}.") from None


def _read(path: Path, field: str, most: int, expected: str) -> bytes:
    with regular(path, field, most, expected) as stream:
        return stream.read()


def _reason(error: Exception) -> str:
    """Return what a parser found wrong, in a sentence."""
    if isinstance(error, RecursionError):
        return "Its lists or tables are nested too deeply."
    if isinstance(error, UnicodeDecodeError | tomllib.TOMLDecodeError | json.JSONDecodeError):
        return f"{str(error)[:_QUOTED]}."
    return f"A whole number has at most {sys.get_int_max_str_digits()} digits."
