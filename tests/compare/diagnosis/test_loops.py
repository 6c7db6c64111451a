"""Loops as people write them: what is said of their rows names the order of their statements, or says less."""

from __future__ import annotations

import math
import random
import shutil
from pathlib import Path

import numpy as np
import pytest
from loops import LANGUAGES, LOOPS, Loop, drawn_loop, source_of
from mistakes import told

from reference import load_scene

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
    if "damped_steps" not in loop.true:
        assert found.words >= loop.needed, list(found.explanation.lines())


@pytest.mark.parametrize(
    "name", ["kick_drift", "explicit", "drift_kick", "axis_by_axis", "verlet", "midpoint"]
)
def test_a_factor_on_the_velocities_is_known_beside_a_method(name: str, tmp_path: Path) -> None:
    """`vx *= 0.9999` after each step; two orders of statements may make the same rows."""
    draw = random.Random(f"damped {name}")
    loops = (drawn_loop(draw, "Python") for _ in range(1000))
    loop = next(one for one in loops if one.name == name and "damped_steps" in one.true)
    times, columns = loop.rows(tmp_path)
    x, y = (float(place) for place in loop.scene.exact.position[:2])
    found = told(loop.scene, times, columns, 1e-6 * math.hypot(x, y))
    assert found.words <= loop.true | SAID
    # the factor changes the phase beside explicit Euler, which takes an arbitrary clock: then its step is not certain
    needed = loop.needed - ({"integrator_explicit_euler"} if name == "explicit" else set())
    assert found.words | found.alternatives >= needed, list(found.explanation.lines())


@pytest.mark.parametrize("name", ["in_turn", "kick_drift"])
def test_a_loop_is_known_where_the_earth_turns_fast(name: str, tmp_path: Path) -> None:
    """Ω = 0.01 rad/s: what one axis does to the other grows for minutes, and no two phasors make the rows."""
    draw = random.Random(f"fast {name}")
    loops = (drawn_loop(draw, "Python") for _ in range(1000))
    loop = next(
        one
        for one in loops
        if one.name == name and "damped_steps" not in one.true
        if float(one.scene.exact.rotation_rate) == 0.01 and one.scene.exact.t_end > 250
    )
    times, columns = loop.rows(tmp_path)
    x, y = (float(place) for place in loop.scene.exact.position[:2])
    found = told(loop.scene, times, columns, 1e-6 * math.hypot(x, y))
    assert loop.needed <= found.words <= loop.true | SAID, list(found.explanation.lines())


def test_a_loop_that_a_named_method_explains_nearly_as_well_is_not_called_that_method(
    tmp_path: Path,
) -> None:
    """Steps of 4 ms for a minute: what the new velocity in the other line does is a thousandth of the tolerance."""
    body, word = LOOPS["in_turn_y_first"]
    step_s = 0.0938 / 23
    values = {
        "x": 0.01,
        "y": 0.0,
        "vx": 0.0,
        "vy": 0.0,
        "h": step_s,
        "q": 9.81,
        "f": 1.1e-4,
        "d": 0.0,
        "c": 1.0,
    }
    sine = values["f"] / 2 / 7.292115e-5
    scene = load_scene(
        "paris",
        [
            "pendulum.length=1",
            f"site.latitude={math.degrees(math.asin(sine))!r}",
            "site.gravity=9.81",
            "site.gravity_is=effective",
            "release.x=0.01",
            "release.y=0",
            f"run.t_end={0.0938 * 568!r}",
            "run.transits=false",
            "inputs=binary64",
        ],
    )
    source = source_of("Python", body, values, 0.0938, 23, 568)
    loop = Loop("in_turn_y_first", "Python", source, scene, set(), set())
    times, columns = loop.rows(tmp_path)
    found = told(scene, times, columns, 1e-8)
    assert "integrator_semi_implicit_euler" not in found.words, list(found.explanation.lines())
    assert any(f"integrator_{word}" in cause.id for cause in found.explanation.causes)


@pytest.mark.parametrize("step_s", [0.01, 0.05])
def test_a_step_is_not_known_beside_a_number_that_is_not_round(step_s: float) -> None:
    """Velocity Verlet that keeps its acceleration: its velocities lag by a step, as those of no named method do.

    Another method of twice the step comes near it, with another g to make up for its phase.
    """
    scene = load_scene("paris", ["site.gravity_is=effective", "run.t_end=400", "inputs=binary64"])
    square = float(scene.exact.gravity) / float(scene.exact.length)
    turn = 2j * 7.292115e-5 * math.sin(math.radians(float(scene.exact.latitude)))
    every = round(0.5 / step_s)
    place = complex(0.3, 0.4)
    velocity = 0j
    acceleration = -square * place
    rows = []
    for count in range(600 * every + 1):
        if count % every == 0:
            rows.append(place)
        place += velocity * step_s + acceleration * step_s**2 / 2
        following = -square * place - turn * velocity
        velocity += step_s * (acceleration + following) / 2
        acceleration = following
    printed = np.array(rows)
    x, y = printed.real.copy(), printed.imag.copy()
    found = told(scene, 0.5 * np.arange(601.0), {"x": x, "y": y}, 5e-7)
    assert not [word for word in found.words if word.startswith("integrator_")]
