"""When passages come if inputs are uncertain, and what to measure better: a technician's own calculation."""

from __future__ import annotations

from fractions import Fraction
from math import expm1, radians

import pytest

import reference
from reference.commands.estimated_passages import PassageEstimates
from reference.commands.passages import Asked
from reference.commands.passages_text import passage_lines
from reference.scenes.scene import parse_scene

NUMBER = 50
GATE = "gate 135"
MUSEUM = {
    "id": "museum",
    "pendulum": {"length": "12.3", "drag": "0.00115525"},
    "site": {"latitude": "51.48", "gravity": "9.81202", "gravity_is": "effective"},
    "release": {"angle": "5", "azimuth": "-135"},
    "run": {"t_end": "180", "grid_step": "180", "sections": [GATE]},
}
WIDTHS = {
    "pendulum.length": "0.005",
    "site.gravity": "0.001",
    "release.angle": "0.5",
    "release.azimuth": "1",
}
LONGEST_S = 7.041
# what he found with one input at a time at either end of its width, in s
HIS_TABLE_S = {
    "pendulum.length": 0.0354,
    "release.angle": 0.0150,
    "site.gravity": 0.0089,
    "release.azimuth": 1.4e-6,
}


def estimates_of(scene):
    return PassageEstimates(scene, WIDTHS, [Asked(NUMBER)], LONGEST_S)


@pytest.fixture(scope="module")
def estimates():
    return estimates_of(parse_scene(MUSEUM))


def enough_for(estimates, wanted_s):
    """Return which widths suffice for passage 50 to have half of a width, in s."""
    document = estimates.document(GATE, Asked(NUMBER, Fraction(wanted_s)))
    return document["enough_by_estimate"]


@pytest.fixture(scope="module")
def passage(estimates):
    return estimates.document(GATE, Asked(NUMBER))


def half_width_at_corners_s(widths):
    """Return half of how far passage 50 is apart between the slowest and the fastest pendulum."""
    times = []
    for sign in (1, -1):
        worst = {
            "pendulum.length": 12.3 + sign * float(widths["pendulum.length"]),
            "site.gravity": 9.81202 - sign * float(widths["site.gravity"]),
            "release.angle": 5 + sign * float(widths["release.angle"]),
            "release.azimuth": -135 - sign * float(widths["release.azimuth"]),
        }
        changes = {name: f"{value:.9f}" for name, value in worst.items()}
        solved = reference.solve(
            parse_scene(MUSEUM).with_values(changes), level="computed", digits=10
        )
        times.append(float(solved.sections[GATE].table.exact("t")[NUMBER - 1]))
    return (times[0] - times[1]) / 2


def narrower(widths):
    """Return all widths, some of them replaced by texts such as ±0.1."""
    return {**WIDTHS, **{name: text.removeprefix("±") for name, text in widths.items()}}


def test_each_input_moves_the_passage_as_the_technician_found(passage):
    limits = passage["limits"]
    assert {name: float(limit["moves_s"]) for name, limit in limits.items()} == {
        name: pytest.approx(size_s, rel=0.01) for name, size_s in HIS_TABLE_S.items()
    }
    shares = {name: limit["share"] for name, limit in limits.items()}
    assert sum(shares.values()) == pytest.approx(1)
    assert sorted(shares, key=shares.get, reverse=True) == list(HIS_TABLE_S)


def test_each_input_moves_the_passage_as_formulas_say(passage):
    t_s = passage["estimate_s"]
    decay = 0.00115525 * t_s
    mean_square = -expm1(-decay) / decay
    by_angle_s = t_s / 16 * (radians(5.5) ** 2 - radians(4.5) ** 2) / 2 * mean_square
    moved = {name: float(limit["moves_s"]) for name, limit in passage["limits"].items()}
    assert moved["pendulum.length"] == pytest.approx(t_s / 2 * 0.005 / 12.3, rel=0.01)
    assert moved["site.gravity"] == pytest.approx(t_s / 2 * 0.001 / 9.81202, rel=0.01)
    assert moved["release.angle"] == pytest.approx(by_angle_s, rel=0.01)


def test_the_range_is_the_worst_case(passage):
    assert passage["estimate_range_s"] == ["174.129", "174.248"]
    assert passage["estimate_plus_minus_s"] == ["174.188", "0.059"]
    assert half_width_at_corners_s(WIDTHS) == pytest.approx(0.0593, abs=1e-4)


def test_a_width_that_suffices_alone_does_and_a_little_more_does_not(estimates):
    enough = enough_for(estimates, "0.05")
    assert enough["is_within"] is False and enough["together"] is None
    alone = enough["alone"]
    assert alone["pendulum.length"]["width"] == "±0.0036"
    # he tried 0.18, with which it is ±0.0497 s
    assert 0.18 <= float(alone["release.angle"]["width"].removeprefix("±")) < 0.2
    for name, last_digit in (("pendulum.length", "0.0001"), ("release.angle", "0.01")):
        width = alone[name]["width"]
        assert half_width_at_corners_s(narrower({name: width})) <= 0.05
        wider = Fraction(width.removeprefix("±")) + Fraction(last_digit)
        assert half_width_at_corners_s(narrower({name: str(float(wider))})) > 0.05


def test_an_input_that_does_not_suffice_even_if_exact_is_not_advised(estimates):
    alone = enough_for(estimates, "0.05")["alone"]
    assert alone["site.gravity"] == {"width": None, "if_exact_half_width_s": "0.0504"}
    assert alone["release.azimuth"] == {"width": None, "if_exact_half_width_s": "0.0593"}


def test_a_passage_that_is_within_the_wanted_width_needs_nothing(estimates):
    enough = enough_for(estimates, "0.06")
    assert enough == {"is_within": True, "alone": {}, "together": None}


def test_if_no_input_suffices_alone_those_that_matter_are_divided_by_one_factor(estimates):
    enough = enough_for(estimates, "0.01")
    assert not any(one["width"] for one in enough["alone"].values())
    together = enough["together"]
    assert set(together) == {"pendulum.length", "site.gravity", "release.angle"}
    factors = [
        float(WIDTHS[name]) / float(width.removeprefix("±")) for name, width in together.items()
    ]
    # two digits each
    assert factors == [pytest.approx(5.93, rel=0.1)] * 3
    assert half_width_at_corners_s(narrower(together)) <= 0.01


def test_without_a_wanted_width_nothing_is_advised(passage):
    assert "enough_by_estimate" not in passage


def test_a_passage_that_may_come_after_the_end_of_the_run_has_its_range():
    scene = parse_scene(MUSEUM)
    document = {}
    for t_end in ("174.2", "174.1"):
        ending = scene.with_values({"run.t_end": t_end, "run.grid_step": t_end})
        document[t_end] = estimates_of(ending).document(GATE, Asked(NUMBER))
    assert document["174.2"]["estimate_range_s"] == ["174.129", "174.248"]
    assert document["174.1"] == {"reason": "none: the run has 49"}


def test_a_motion_that_cannot_be_solved_says_nothing_of_its_passages():
    """That there is no estimate is not that there is no passage."""
    stiff = parse_scene(MUSEUM).with_values({"pendulum.drag": "1e9"})
    document = estimates_of(stiff).document(GATE, Asked(NUMBER))
    assert set(document) == {"no_estimate"}
    assert document["no_estimate"].startswith("Stiff: ")
    passage = {"section": GATE, "number": NUMBER, "reason": "nothing is proved", **document}
    text = "\n".join(passage_lines({"passages": [passage]}))
    assert "no estimate: Stiff: " in text
    assert "not proved: nothing is proved" in text
