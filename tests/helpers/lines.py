"""Printed text for people: in one line, whatever it was wrapped to; and as a terminal gets it."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from contextlib import suppress

from places import ROOT


def unwrapped(text: str) -> str:
    """Return a text with single spaces in place of line ends and indents."""
    return " ".join(text.split())


def part(text: str, title: str) -> str:
    """Return a part of what `foucault show` prints, by the beginning of its title, unwrapped."""
    lines = text.splitlines()
    begin = next(number for number, line in enumerate(lines) if line.startswith(title))
    end = begin + 1
    # what belongs to a title is indented
    while end < len(lines) and (not lines[end] or lines[end].startswith(" ")):
        end += 1
    return unwrapped("\n".join(lines[begin:end]))


def on_a_terminal(words: list[str], environment: dict[str, str]) -> str:
    """Return what the command prints on stdout if that is a terminal."""
    master, slave = pty.openpty()
    usual = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    output = b""
    with subprocess.Popen(
        [sys.executable, "-m", "foucault", *words],
        stdout=slave,
        stderr=subprocess.DEVNULL,
        cwd=ROOT,
        env={**usual, "TERM": "xterm", **environment},
    ):
        os.close(slave)
        with suppress(OSError):  # how a terminal ends
            while piece := os.read(master, 4096):
                output += piece
    os.close(master)
    return output.decode()
