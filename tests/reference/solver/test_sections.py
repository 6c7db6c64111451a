"""Sections: none lost, none doubled, all inside their bounds, against another code."""

import math
from fractions import Fraction
from random import Random

import pytest
from passages import found, outside
from random_scenes import random_scene

import reference
from reference.errors import InputError
from reference.scenes.fields import LEVELS
from reference.scenes.scene import parse_scene

# of a swing: doubles lose digits where the motion amplifies errors; 400 bits tell each time exactly
NEAR = 0.05
LASTS = 12  # a damped swing is followed while it is above exp(-LASTS) of itself


def drawn(seed):
    """A random scene of some swings, and sections at random azimuths."""
    document, rng = random_scene(seed), Random(seed)
    pace = (float(document["site"]["gravity"]) / float(document["pendulum"]["length"])) ** 0.5
    drag = float(document["pendulum"]["drag"])
    end = min(float(document["run"]["t_end"]), 6 * 6.2832 / pace, LASTS / drag if drag else 1e300)
    end /= 1 + (seed == 34)  # a pushed rod, where doubles leave the sphere after four swings
    document["run"] |= {"t_end": f"{end:.9g}", "grid_step": f"{end / 3:.6g}", "digits": 14}
    azimuths = [f"{rng.uniform(-180, 180):.6f}" for _ in range(3)]
    words = [
        "highest",
        "lowest",
        f"gate {azimuths[0]}",
        f"gate {azimuths[1]}@0",
        f"turn {azimuths[2]}",
    ]
    if seed in (2, 15):  # planets that turn so fast that the pull singles out no rest position
        del words[2]
    return parse_scene(document), words, 6.2832 / pace


def check(solution, words, swing):
    """The passages are those of DOP853, in number, direction and time, and truth lies within each bound."""
    inputs = solution.scene.exact
    expected = found(inputs, words, inputs.t_end)
    for word in words:
        passages = solution.sections[word]
        assert not passages.possible, (word, passages.possible)
        times = [float(t) for t in passages.table.exact("t")]
        told = list(zip(times, passages.directions, strict=True))
        assert [way for _, way in told] == [way for _, way in expected[word]], (
            word,
            told,
            expected[word],
        )
        assert all(
            abs(t - other) < NEAR * swing
            for (t, _), (other, _) in zip(told, expected[word], strict=True)
        ), word
    assert outside(inputs, {word: solution.sections[word].table for word in words}) == []


def test_what_the_end_of_a_steps_polynomial_lacks_counts_in_the_bounds():
    """A lowest point near the end of a step: the rate of a polynomial lacks one order more than the state there.

    Bounds that follow from the errors of the grid alone do not hold here.
    """
    words = "run.sections=highest; lowest; turn 30"
    scene = [
        "run.t_end=45",
        "run.digits=20",
        words,
        "release.vy=0.228",
        "release.x=0.802",
        "site.latitude=75.57",
    ]
    computed = reference.solve(
        reference.load_scene("paris", [*scene, "run.level=computed"]), engine="heyoka"
    )
    assert (
        outside(
            computed.scene.exact, {word: found.table for word, found in computed.sections.items()}
        )
        == []
    )


# in every run: a push with drag on the Earth
@pytest.mark.parametrize(
    "seed",
    [seed if seed == 8 else pytest.param(seed, marks=pytest.mark.long) for seed in range(40)],
)
def test_sections_of_random_scenes_are_those_of_another_code(seed):
    scene, words, swing = drawn(seed)
    check(reference.solve(scene, level="enclosed", sections=words), words, swing)


OWN_PLANE = {
    "id": "own_plane",
    "release": {"angle": "5", "azimuth": "30"},
    "run": {"t_end": "40", "grid_step": "20"},
}
TINY = {  # a swing of a nanometre, whose height changes by 1e-20 m
    "id": "tiny",
    "site": {"gravity_is": "effective", "latitude": "90"},
    "release": {"x": "1e-9", "y": "0"},
    "run": {"t_end": "40", "grid_step": "20", "digits": 15},
}


def test_a_release_at_rest_in_the_gates_own_plane_is_possible_next_to_0_and_nothing_is_lost():
    words = ["gate 30@0", "gate 30", "turn 120", "highest"]
    solution = reference.solve(OWN_PLANE, level="enclosed", digits=15, sections=words)
    ((low, high, parity),) = solution.sections["gate 30@0"].possible
    assert low == 0 < high < Fraction(1, 10**6)
    assert parity == "unknown"
    expected = found(solution.scene.exact, words, 40)
    for word in words:
        passages = solution.sections[word]
        later = [t for t, _ in expected[word] if t > 1e-3]
        assert [float(t) for t in passages.table.exact("t")] == pytest.approx(later, abs=1e-6), word
        assert word == words[0] or not passages.possible
    # the rest position lies beside the vertical, so that this gate is decided
    assert solution.sections["gate 30"].directions == [-1, 1, -1, 1, -1]


@pytest.mark.parametrize(
    "level", ["self_consistent", pytest.param("confirmed", marks=pytest.mark.long), "enclosed"]
)
def test_the_highest_points_of_a_nanometres_swing_are_found_once_each(level):
    solution = reference.solve(TINY, level=level, sections=["highest", "lowest"])
    half = math.pi * math.sqrt(67 / 9.80665)
    for word, first in (("highest", half), ("lowest", half / 2)):
        passages = solution.sections[word]
        times = [float(t) for t in passages.table.exact("t")]
        assert times == pytest.approx([first + k * half for k in range(len(times))], rel=1e-7)
        assert len(times) == int((40 - first) / half) + 1
        assert max(passages.table.bound("t")) < Fraction(1, 10**12)


def test_all_levels_find_the_same_passages():
    words = ["highest", "gate 53.130102354155978@0", "gate 30", "turn 90", "turn 0"]
    solutions = [
        reference.solve("paris", level=x, digits=15, t_end=60, sections=words) for x in LEVELS
    ]
    proof = solutions[-1]
    for solution in solutions[:-1]:
        for word in words:
            mine, proved = solution.sections[word], proof.sections[word]
            assert mine.directions == proved.directions
            apart = mine.table.distance(proved.table)
            for name in mine.table.columns:
                bounds = zip(
                    apart.exact(name), mine.table.bound(name), proved.table.bound(name), strict=True
                )
                assert all(gap <= a + b for gap, a, b in bounds), (word, name)
    # xdot = 0 is one of them
    assert proof.sections["turn 0"].table.exact("t") == pytest.approx(
        proof.transits.exact("t"), abs=1e-30
    )


@pytest.mark.parametrize(
    "words",
    [
        "gate",
        "gate 400",
        "turn north",
        "gate 1e2",
        "turn 30@0",
        "top",
        "gate 30,gate 30",
        ["highest", "highest"],
        "gate ٣",
    ],
)
def test_a_wrong_section_is_refused_with_what_was_expected(words):
    with pytest.raises(
        InputError, match=r"run\.sections.*(highest, lowest, gate AZIMUTH|different sections)"
    ):
        reference.solve("paris", sections=words)


V11 = {  # Ω²l is 27.7 m/s², gravity 0.57: nothing but the axis of rotation holds the bob
    "id": "v11",
    "pendulum": {"length": "362.83"},
    "site": {
        "latitude": "80.9",
        "gravity": "0.572",
        "rotation_rate": "0.27638",
        "equatorial_radius": "2.528",
    },
    "release": {"x": "22.59", "y": "13.88", "vx": "0.855", "vy": "-0.55"},
    "run": {"t_end": "754.7", "grid_step": "44.4", "digits": 15},
}
# Ω²l is 0.8 g: there is a rest position, but a proof does not single it out
LEANING = {
    "id": "leaning",
    "pendulum": {"length": "10"},
    "site": {"latitude": "45", "gravity": "10", "gravity_is": "effective", "rotation_rate": "0.9"},
    "release": {"x": "1", "y": "0.3"},
    "run": {"t_end": "5", "grid_step": "5", "digits": 12},
}
WEIGHTLESS = LEANING | {"id": "weightless", "site": {"gravity": "0", "rotation_rate": "0"}}


@pytest.mark.parametrize(
    "scene, levels, reason",
    [
        (V11, (*LEVELS, "uncertain"), "so fast a rotation, or weightlessness, leaves none"),
        (WEIGHTLESS, (*LEVELS, "uncertain"), "so fast a rotation, or weightlessness, leaves none"),
        (
            LEANING,
            ("enclosed", "uncertain"),
            "at so fast a rotation the proof finds no single rest position",
        ),
    ],
)
def test_a_gate_without_a_rest_position_is_refused_with_its_reason_at_every_level(
    scene, levels, reason
):
    for level in levels:
        words = ["highest", "gate 33.3"]
        with pytest.raises(InputError, match=r"run\.sections: got 'gate 33\.3'") as caught:
            if level == "uncertain":
                reference.prove_ranges(scene, {"pendulum.length": "0.001"}, sections=words)
            else:
                reference.solve(scene, sections=words, level=level)
        assert reason in str(caught.value)
        assert "Write gate 33.3@0 for the plane through the suspension's vertical" in str(
            caught.value
        )


def test_where_a_rest_position_is_known_the_gate_through_it_is_found():
    for level in ("self_consistent", "confirmed"):
        assert (
            len(
                reference.solve(LEANING, level=level, sections="gate 33.3")
                .sections["gate 33.3"]
                .table
            )
            == 1
        )
    beside = reference.solve(LEANING, level="enclosed", sections="gate 33.3@0").sections[
        "gate 33.3@0"
    ]
    assert not beside.possible
