"""README: every command and every line of output in it is true."""

from __future__ import annotations

import doctest
import re
import shutil
from importlib import import_module

import pictures
import pytest
from pages import commands, of_language, output_here, shows
from places import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_every_command_in_its_turn_prints_what_the_readme_shows(tmp_path, foucault, capfd):
    assert len(commands("README.md")) >= 5
    without_compiler = shutil.which("cc") is None  # a machine without a C compiler checks the rest
    for command, shown in commands("README.md"):
        if without_compiler and "/tmp/pendulum" in command:
            continue
        got = output_here(command.replace("/tmp/", f"{tmp_path}/"), ROOT, foucault, capfd)
        got = got.replace(f"{tmp_path}/", "/tmp/")
        assert shows(shown, got), f"{command}\n{got}"


def test_the_python_in_the_readme_runs_and_prints_what_it_shows():
    (block,) = of_language("README.md", "pycon")
    parser, runner = doctest.DocTestParser(), doctest.DocTestRunner()
    runner.run(parser.get_doctest(block, {}, "README", "README.md", 0))
    assert runner.summarize(verbose=False).failed == 0


@pytest.mark.parametrize(
    "module",
    ["reference", "compare", "compare.testing", "compare.methods", "compare.approximations"],
)
def test_the_packages_own_examples_are_true(module):
    result = doctest.testmod(import_module(module))
    assert result.attempted and not result.failed


def test_the_readme_takes_three_minutes():
    assert len(README.split()) <= 900
    prose = re.sub(r"```.*?```|^[|>].*?$|\]\(.*?\)", "", README, flags=re.S | re.M)
    sentences = re.split(r"(?<=[.:;?!\]])\s+|\n\n", prose)
    assert [sentence for sentence in sentences if len(sentence.split()) > 25] == []


def test_the_pictures_of_the_readme_are_drawn_from_the_numbers():
    for name, text in pictures.pictures().items():
        assert (ROOT / name).read_text(encoding="utf-8") == text, (
            "run: python tests/helpers/pictures.py"
        )


def test_the_readme_counts_nothing_that_a_new_file_would_change():
    counted = re.findall(r"\d+ (?:\w+ )?(?:integrators|methods|approximations|scenes)", README)
    assert counted == []
