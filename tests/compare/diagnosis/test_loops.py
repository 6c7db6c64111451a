"""Loops as people write them: what is said of their rows names the order of their statements, or says less."""

from __future__ import annotations

import math
import random
import shutil
from pathlib import Path

import pytest
from loops import LANGUAGES, LOOPS, drawn_loop
from mistakes import told

# in every run; the others under --long
USUAL = ("in_turn", "drift_in_turn", "leapfrog")
SAID = {"linear_g", "no_centrifugal", "uniform_gravity", "integrator_loose", "solar_day"}


@pytest.mark.parametrize(
    "name",
    [name if name in USUAL else pytest.param(name, marks=pytest.mark.long) for name in LOOPS],
)
@pytest.mark.parametrize(
    "language",
    [LANGUAGES[0], *(pytest.param(one, marks=pytest.mark.long) for one in LANGUAGES[1:])],
)
def test_the_order_of_the_statements_is_named_and_no_other(
    name: str, language: str, tmp_path: Path
) -> None:
    tool = {"JavaScript": "node", "C": "cc", "Perl": "perl"}.get(language)
    if tool and shutil.which(tool) is None:
        pytest.skip(f"no {tool}")
    draw = random.Random(f"{name} {language}")
    loop = next(one for one in iter(lambda: drawn_loop(draw, language), None) if one.name == name)
    times, columns = loop.rows(tmp_path)
    x, y = (float(place) for place in loop.scene.exact.position[:2])
    found = told(loop.scene, times, columns, 1e-6 * math.hypot(x, y))
    assert found.words <= loop.true | SAID
    if (
        "pendulum.drag" not in loop.true
    ):  # a factor on the velocities is not known beside every method
        assert found.words >= loop.needed, list(found.explanation.lines())
