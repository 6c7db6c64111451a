"""Passages of sections: their errors are distances by which the motion is off, whatever the section."""

from functools import cache

import numpy as np
import pytest

from compare.candidates.candidate import Passages
from compare.score.passages import score_passages
from reference import InputError, load_scene, solve

WORDS = ["gate 30", "gate 127@0", "turn 45", "highest", "lowest"]
# planar at first, an ellipse, and a wide swing
RELEASES = {
    "planar": {},
    "ellipse": {"release.vx": "0.05", "release.vy": "-0.03"},
    "wide": {"pendulum.length": "1"},
}


def scored(name, times, scene, word):
    """Return the score of passages of a section."""
    return score_passages(Passages(name, times, word), scene)


@cache
def swung(name: str, gravity: str = "9.8"):
    """A scene of half a minute, and its solution."""
    changes = {"run.t_end": "30", "run.grid_step": "0.5", "site.gravity": gravity}
    scene = load_scene("paris").with_values(changes | RELEASES[name])
    return scene, solve(scene, digits=18, sections=WORDS)


@pytest.mark.parametrize(
    "name",
    ["planar", *(pytest.param(name, marks=pytest.mark.long) for name in ("ellipse", "wide"))],
)
def test_the_distance_of_a_passage_is_that_of_the_motion(name):
    scene, here = swung(name)
    _, there = swung(name, "9.8000001")
    apart = max(
        np.sqrt((here.x - there.x) ** 2 + (here.y - there.y) ** 2 + (here.z - there.z) ** 2)
    )
    for word in WORDS if name == "planar" else WORDS[2:4]:
        found = scored("other", there.sections[word].table["t"], scene, word)
        assert found.errors.matched == len(here.sections[word].table)
        assert 0.05 * apart < found.errors.max_conditioned_m < 2 * apart
        own = scored("own", here.sections[word].table["t"], scene, word)
        assert own.errors.max_error_s < 1e-13  # the rounding of doubles


def test_what_is_missed_extra_or_another_section_is_told():
    scene, here = swung("planar")
    times = here.sections["gate 30"].table["t"]
    lost = scored("lost", np.delete(times, 1), scene, "gate 30")
    assert lost.verdict == "disagrees" and lost.errors.missed == [
        pytest.approx(times[1], abs=1e-12)
    ]
    more = scored("more", np.sort([*times, times[0] + 1]), scene, "gate 30")
    assert more.verdict == "disagrees" and more.errors.extra == [times[0] + 1]
    highest, lowest = (here.sections[word].table["t"] for word in ("highest", "lowest"))
    both = scored("both", np.sort([*highest, lowest[0]]), scene, "highest")
    # though the height's rate is zero there
    assert both.verdict == "disagrees" and both.errors.extra == [lowest[0]]
    other = scored("other", lowest, scene, "highest")
    assert (
        other.verdict == "disagrees"
        and len(other.errors.shifted(other.allowed_m)) == other.errors.matched
    )
    with pytest.raises(InputError, match="no time within the scene's span"):
        scored("none", np.array([31.0]), scene, "gate 30")
