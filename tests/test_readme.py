"""README: every command and every line of output in it is true."""

from __future__ import annotations

import doctest
import itertools
import json
import math
import re
import shutil
import xml.etree.ElementTree as ET
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


def test_the_readme_takes_a_few_minutes():
    assert len(README.split()) <= 1000
    prose = re.sub(r"```.*?```|^[|>].*?$|\]\(.*?\)", "", README, flags=re.S | re.M)
    sentences = re.split(r"(?<=[.:;?!\]])\s+|\n\n", prose)
    assert [sentence for sentence in sentences if len(sentence.split()) > 25] == []


def test_the_pictures_of_the_readme_are_drawn_from_the_numbers():
    for name, text in pictures.pictures().items():
        assert (ROOT / name).read_text(encoding="utf-8") == text, (
            "run: python tests/helpers/pictures.py"
        )


DRAWN = pictures.pictures()
SVG = "{http://www.w3.org/2000/svg}"
SIZES = {True: 14, False: 16}  # of text that is small, and of other text, in pixels
CHARACTER = (
    0.6  # width of a character in DejaVu Sans over the size of the text, at the most over a line
)


def written(name):
    """Return each text of a picture with its class, its left and right end, and its baseline."""
    for one in ET.fromstring(DRAWN[name]).iter(f"{SVG}text"):
        if one.get("transform"):
            continue
        kind = one.get("class", "")
        width = CHARACTER * SIZES["small" in kind] * len(one.text)
        before = {"middle": width / 2, "end": width}.get(one.get("text-anchor"), 0.0)
        left = float(one.get("x")) - before
        yield one.text, kind, left, left + width, float(one.get("y"))


@pytest.mark.parametrize("name", DRAWN)
def test_no_text_of_a_picture_leaves_it(name):
    root = ET.fromstring(DRAWN[name])
    for text, _, left, right, baseline in written(name):
        assert left >= 0 and right <= float(root.get("width")), text
        assert 14 <= baseline <= float(root.get("height")) - 4, text


@pytest.mark.parametrize("path", sorted((ROOT / "docs").glob("*.svg")), ids=lambda path: path.name)
def test_a_picture_has_colours_that_every_renderer_knows_and_others_on_a_dark_page(path):
    text = path.read_text(encoding="utf-8")
    assert "@media (prefers-color-scheme: dark)" in text
    # of #rgba and #rrggbbaa older renderers draw the opaque colour, or black
    assert {len(digits) for digits in re.findall(r"#([0-9a-f]+)\b[^(\w]", text)} <= {3, 6}


def test_the_chart_joins_the_settings_in_their_order_and_dots_what_gets_worse():
    study = json.loads((ROOT / pictures.STUDY).read_text(encoding="utf-8"))
    root = ET.fromstring(DRAWN[pictures.CHART])
    for shown, colour in zip(pictures.SHOWN, pictures.COLOURS, strict=True):
        measured = [
            row
            for row in study["rows"]
            if (row["method"], row["formulation"]) == shown and row["status"] == "ok"
        ]
        measured.sort(key=lambda row: -row["setting"])
        points = [
            f"{pictures.TIMES(row['cpu_s']):.1f} {pictures.ERRORS(row['error_m']):.1f}"
            for row in measured
        ]
        joined = [one for one in root.iter(f"{SVG}path") if colour in one.get("class").split()]
        joined = [one for one in joined if "L" in one.get("d")]
        expected = [f"M{before}L{after}" for before, after in itertools.pairwise(points)]
        assert [one.get("d") for one in joined] == expected, shown
        errors = [row["error_m"] for row in measured]
        is_worse = [after > before for before, after in itertools.pairwise(errors)]
        assert ["worse" in one.get("class") for one in joined] == is_worse, shown


def test_the_chart_names_each_line_inside_the_frame_and_off_the_grid():
    grid = [pictures.ERRORS(error) for error in pictures.ERRORS.ticks]
    names = [one for one in written(pictures.CHART) if one[0] in pictures.SHOWN.values()]
    assert {one[1] for one in names} == {f"small {colour}" for colour in pictures.COLOURS}
    for name, _, _, right, baseline in names:
        assert right <= pictures.TIMES.pixels[1], name
        assert not any(baseline - 12 < y < baseline + 2 for y in grid), name


def test_the_chart_shows_the_equations_that_the_studies_recommend():
    advice = (ROOT / "docs/studies.md").read_text(encoding="utf-8").split("\n\n")[1]
    recommended = set(re.findall(r"`(\w+)` \((\w+)\)", advice))
    assert len(recommended) == 4
    assert recommended <= set(pictures.SHOWN)


def test_the_wrong_rate_follows_from_the_sine_that_the_picture_shows():
    texts = " ".join(one[0] for one in written(pictures.TURNING))
    shown = re.search(r"([\d.]+)° an hour, anticlockwise sin\(([\d.]+)\), in radians", texts)
    rate = pictures.SIDEREAL * abs(math.sin(float(shown[2])))
    assert f"{rate:.1f}" == shown[1]


def test_the_readme_counts_nothing_that_a_new_file_would_change():
    counted = re.findall(r"\d+ (?:\w+ )?(?:integrators|methods|approximations|scenes)", README)
    assert counted == []
