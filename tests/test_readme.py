"""README: every command and every line of output in it is true, and it is short."""

from __future__ import annotations

import doctest
import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.S)


def commands() -> list[tuple[str, str]]:
    """Each `$ command` of the console blocks with the output printed below it."""
    found = []
    for block in blocks("console"):
        for part in re.split(r"^\$ ", block, flags=re.M)[1:]:
            command, _, output = part.partition("\n")
            found.append((command, output))
    return found


def test_it_fits_on_150_lines_and_has_commands():
    assert len(README.splitlines()) <= 150
    assert len(commands()) >= 5


def test_every_command_in_its_turn_prints_what_the_readme_shows(tmp_path):
    path = {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "FOUCAULT_CACHE": str(tmp_path / "cache"),
    }
    for command, shown in commands():
        here = command.replace("/tmp/", f"{tmp_path}/")
        done = subprocess.run(
            here, shell=True, capture_output=True, text=True, check=False, cwd=ROOT, env={**os.environ, **path}
        )
        got = (done.stdout + done.stderr).replace(f"{tmp_path}/", "/tmp/")
        lines = shown.splitlines(keepends=True)
        pattern = "".join("(?:.*\n)*?" if line == "…\n" else re.escape(line) for line in lines)
        assert re.fullmatch(pattern, got), f"{command}\n{got}"


def test_the_python_in_the_readme_runs_and_prints_what_it_shows():
    (block,) = blocks("pycon")
    parser, runner = doctest.DocTestParser(), doctest.DocTestRunner()
    runner.run(parser.get_doctest(block, {}, "README", "README.md", 0))
    assert runner.summarize(verbose=False).failed == 0


@pytest.mark.parametrize(
    "module", ["reference", "compare", "compare.testing", "compare.methods", "compare.approximations"]
)
def test_the_packages_own_examples_are_true(module):
    result = doctest.testmod(import_module(module))
    assert result.attempted and not result.failed


def test_every_module_the_readme_names_exists():
    for name in re.findall(r"`([\w/]+\.py)`", README):
        assert (ROOT / name).exists() or [*ROOT.glob(f"reference/**/{name}"), *ROOT.glob(f"compare/**/{name}")], name
