"""How far doubles can go: against closed forms, golden data, and a program in doubles that leaves the truth there."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from reference import load, load_scene, scene_ids
from reference.engines.trajectory import trajectory
from reference.solver.doubles import TOLERANCE, double_reach

PAGE = Path(__file__).parents[3] / "docs/doubles.md"
ROUNDING = 2.0**-53


def test_of_a_small_swing_the_phase_is_rounded() -> None:
    """Length and gravity are off by a part in 2^53 each, so the frequency by one, and the bob by A ω t of it."""
    scene = load_scene("paris", ["run.t_end=7200", "site.rotation_rate=0"])
    reach = double_reach(scene)
    frequency = math.sqrt(9.80665 / 67)
    assert reach.moved_m == pytest.approx(0.5 * frequency * 7200 * ROUNDING, rel=0.01)
    assert reach.until_s is None
    assert reach.costly == "constants"


def test_from_the_top_an_error_grows_exponentially() -> None:
    """At rest near the top of a pole of 1 m it grows like cosh(√g t), from a rounding of the angle, π/2^53."""
    scene = load_scene("inverted_rest", ["release.angle=179.9999999999", "run.t_end=5"])
    reach = double_reach(scene)
    growth = math.cosh(math.sqrt(9.80665) * 5)
    assert reach.moved_m == pytest.approx(math.pi * ROUNDING * growth, rel=0.02)
    assert reach.costly == "release"


def test_a_program_in_doubles_leaves_the_truth_about_there() -> None:
    golden = load("separatrix")
    states = trajectory("separatrix", golden.t)
    error_m = np.hypot(states[:, 0] - golden.x, states[:, 1] - golden.y)
    amplitude_m = np.hypot(golden.x, golden.y).max()
    left_s = golden.t[np.flatnonzero(error_m > TOLERANCE * amplitude_m)[0]]
    until_s = double_reach("separatrix").until_s
    assert until_s is not None
    assert 0.7 * until_s < left_s < 1.5 * until_s


@pytest.mark.parametrize("name", ["paris", "museum", "almost_inverted", "barely_over"])
def test_rounding_the_inputs_moves_the_bob_by_no_more(name: str) -> None:
    """The motions of the decimal inputs and of the nearest doubles, which ship, are closer than one rounding of all."""
    decimal = load(name)
    rounded = load(f"{name}.binary64")
    rows = min(len(decimal.t), len(rounded.t))
    moved_m = np.hypot(decimal.x - rounded.x[:rows], decimal.y - rounded.y[:rows]).max()
    assert moved_m <= 1.01 * double_reach(name).moved_m


def test_what_stays_at_an_unstable_rest_is_left_at_once() -> None:
    reach = double_reach("inverted_rest")
    assert reach.until_s == 0
    assert reach.digits is None


def test_the_page_says_it_of_every_scene() -> None:
    rows = re.findall(
        r"^\| (\w+) \| [^|]* \| \w+ \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE
    )
    assert rows == scene_ids()


@pytest.mark.parametrize(
    "name", ["separatrix", "paris", "inverted_rest", "almost_inverted", "weightless"]
)
def test_the_page_is_true(name: str) -> None:
    row = re.search(
        rf"^\| {name} \| (.*) \| (\w+) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE
    )
    assert row is not None
    words, costly = row.groups()
    reach = double_reach(name)
    assert costly == reach.costly
    if reach.digits is None:
        assert words == reach.in_words
        return
    printed = re.fullmatch(r"about (\d+) digits up to (.*) s", words)
    assert printed is not None
    assert abs(int(printed[1]) - reach.digits) < 0.6
    assert float(printed[2]) == reach.end_s
