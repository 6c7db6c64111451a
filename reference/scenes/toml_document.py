"""Read a TOML file that a stranger may have written: bounded in size and depth, and so in time and memory."""

from __future__ import annotations

import os
import re
import stat
import sys
import tomllib
from pathlib import Path
from typing import Any

from ..system.opening import open_at_once
from .fields import Refused

MAX_BYTES = 1 << 16
MAX_DEPTH = 32  # words of a dotted key; a scene has two. The parser's time and memory grow with the square
_SAID = 200  # characters of the parser's message that are quoted

_WORD = r"""(?:[\w-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')"""
_DEEP_KEY = re.compile(rf"(?<![\w\\-]){_WORD}(?:[ \t]*\.[ \t]*{_WORD}){{{MAX_DEPTH}}}", re.ASCII)


def toml_document(path: Path) -> dict[str, Any]:
    """Return the tables of a TOML file.

    Raises:
        OSError: the file cannot be opened or read.
        Refused: it is no regular file, larger than `MAX_BYTES`, or no TOML.
    """
    with open_at_once(path) as stream:
        if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
            raise Refused("a regular file", "Pipes and devices are not read.")
        data = stream.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise Refused(f"a TOML file of at most {MAX_BYTES} bytes")
    try:
        return _parsed(data.decode())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Refused("a TOML file", f"{str(error)[:_SAID]}.") from None


def _parsed(text: str) -> dict[str, Any]:
    if _DEEP_KEY.search(text):
        raise Refused(f"a TOML file with keys of at most {MAX_DEPTH} words")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise Refused("a TOML file", "Its lists or tables are nested too deeply.") from None
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:
        raise Refused("a TOML file", f"A whole number has at most {sys.get_int_max_str_digits()} digits.") from None
