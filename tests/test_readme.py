"""README: every command and every line of output in it is true, and it is short."""

from __future__ import annotations

import doctest
import os
import re
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from places import ROOT

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
    path = {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    without_compiler = shutil.which("cc") is None  # a machine without a C compiler checks the rest
    for command, shown in commands():
        if without_compiler and "/tmp/pendulum" in command:
            continue
        here = command.replace("/tmp/", f"{tmp_path}/")
        done = subprocess.run(
            here, shell=True, capture_output=True, text=True, check=False, cwd=ROOT, env={**os.environ, **path}
        )
        said = re.sub(r"^.*: about .* after \d+ s\n", "", done.stderr, flags=re.M)  # on a slow machine
        got = (done.stdout + said).replace(f"{tmp_path}/", "/tmp/")
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


def test_the_readme_counts_nothing_that_a_new_file_would_change():
    counted = re.findall(r"\d+ (?:\w+ )?(?:integrators|methods|approximations|scenes)", README)
    assert counted == []


PAGES = (
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    *sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md")),
)


@pytest.mark.parametrize("page", PAGES)
def test_every_file_and_folder_that_a_page_names_exists(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    links = [target for target in re.findall(r"\]\(([^)#]+)\)", text) if "://" not in target]
    assert all(((ROOT / page).parent / target).exists() for target in links), links
    paths = re.findall(r"`((?:reference|compare|tests|docs|data)/[\w./]*)`", text)
    assert all((ROOT / path).exists() for path in paths), [path for path in paths if not (ROOT / path).exists()]
