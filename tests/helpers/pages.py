"""The pages of the documentation: their blocks of code, and their commands, run as a reader runs them."""

from __future__ import annotations

import os
import re
import runpy
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
from markdown_it import MarkdownIt
from places import ROOT

PAGES = (
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    *sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md")),
    "reference/enclosure/THEOREM.md",
)


class Block(NamedTuple):
    """A block of code: the word behind its fence, None for one that is only indented; its text."""

    language: str | None
    text: str


def blocks(page: str) -> list[Block]:
    """Return every block of code of a page, in order."""
    tokens = MarkdownIt("commonmark").parse((ROOT / page).read_text(encoding="utf-8"))
    kinds = {
        "fence": lambda token: Block(token.info, token.content),
        "code_block": lambda one: Block(None, one.content),
    }
    return [kinds[token.type](token) for token in tokens if token.type in kinds]


def code_spans(page: str) -> list[str]:
    """Return what stands between backticks in the text of a page, in order."""
    tokens = MarkdownIt("commonmark").parse((ROOT / page).read_text(encoding="utf-8"))
    return [
        part.content
        for token in tokens
        for part in token.children or ()
        if part.type == "code_inline"
    ]


def of_language(page: str, language: str) -> list[str]:
    """Return the texts of a page's blocks in a language."""
    return [block.text for block in blocks(page) if block.language == language]


def commands(page: str) -> list[tuple[str, str]]:
    """Return each `$ command` of the console blocks with the output printed below it."""
    found = []
    for block in of_language(page, "console"):
        for part in re.split(r"^\$ ", block, flags=re.M)[1:]:
            command, _, output = part.partition("\n")
            found.append((command, output))
    return found


def write_files(page: str, folder: Path) -> list[str]:
    """Write the blocks that begin with a comment of nothing but a file's name; return the names."""
    names = []
    for block in blocks(page):
        named = re.match(r"# ([\w.]+)\n", block.text)
        if named:
            (folder / named[1]).write_text(block.text, encoding="utf-8")
            names.append(named[1])
    return names


def _path() -> str:
    """Return the PATH by which `foucault` and `python` are those of the tests."""
    return f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"


def _both(out: str, err: str) -> str:
    """Return stdout and then stderr, without what depends on the machine."""
    once = r"First use on this machine: .*"  # where nothing has compiled the engines yet
    slow = r".*: about .* after \d+ s"
    return out + re.sub(rf"^(?:{once}|{slow})\n", "", err, flags=re.M)


def output(command: str, folder: Path) -> str:
    """Return what a command prints in a folder, stdout first; `foucault` and `python` are those of the tests."""
    done = subprocess.run(
        command,
        shell=True,
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
        env={**os.environ, "PATH": _path()},
    )
    return _both(done.stdout, done.stderr)


def output_here(
    command: str,
    folder: Path,
    foucault: Callable[..., tuple[int, str, str]],
    capfd: pytest.CaptureFixture[str],
) -> str:
    """Return the same; `foucault`, programs in Python and pytest run in this process, but for lines for a shell.

    Args:
        command: the line.
        folder: where it is typed.
        foucault: the fixture of that name.
        capfd: pytest's.
    """
    plain = re.fullmatch(r'(foucault|python) ([^|<>;$]+)(; echo "exit status \$\?")?', command)
    tests = (
        command.removeprefix("python -m pytest ")
        if command.startswith("python -m pytest ")
        else None
    )
    if plain is None or (plain[2].startswith("-") and tests is None):
        return output(command, folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("PATH", _path())
        if plain[1] == "python":
            capfd.readouterr()
            if tests is None:
                runpy.run_path(plain[2], run_name="__main__")
            else:
                _pytest(shlex.split(tests), folder, patch)
            return _both(*capfd.readouterr())
        status, out, err = foucault(*shlex.split(plain[2]))
    return _both(out, err) + (f"exit status {status}\n" if plain[3] else "")


def _pytest(words: list[str], folder: Path, patch: pytest.MonkeyPatch) -> None:
    """Run the tests of a page in its folder; what they import from there is forgotten."""
    patch.syspath_prepend(str(folder))
    pytest.main([*words, "-p", "no:cacheprovider"])
    for path in folder.glob("*.py"):
        sys.modules.pop(path.stem, None)


def shows(shown: str, got: str) -> bool:
    """Whether a page shows what a command printed; a line … stands for any number of lines."""
    lines = shown.splitlines(keepends=True)
    return bool(
        re.fullmatch(
            "".join("(?:.*\n)*?" if line == "…\n" else re.escape(line) for line in lines), got
        )
    )
