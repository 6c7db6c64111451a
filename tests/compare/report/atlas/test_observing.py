"""The page for any pendulum judges as the command does, and names an observation in the same words (Node.js)."""

from __future__ import annotations

import re
import shutil

import numpy as np
import pytest
from dropped import csv, trajectories
from page_motion import code, node, words

import reference
from compare import judge
from compare.diagnosis.causes import CLOCK
from compare.report.atlas.form import fields, texts_of
from reference import load_scene
from reference.model.constants import constants_in_double

pytestmark = pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not installed")

_ANSWER = """
const { texts, files, fields, words } = JSON.parse(require("fs").readFileSync(0, "utf8"));
const solution = solve(sceneOf(texts, fields), words);
const told = files.map((text) => {
  const { points, mine, ...verdict } = answerBy(solution, [{ name: "mine.csv", text }], "");
  return verdict;
});
console.log(JSON.stringify(told));
"""


def answers(scene, files):
    """Return what the page answers to each file."""
    document = {"texts": texts_of(scene), "files": [*files], "fields": fields(), "words": words()}
    return node(code() + _ANSWER, document)


def test_files_are_judged_as_by_score(size, tmp_path):
    """Right and wrong files of Paris in all spellings, by the page's own motion and by the golden data."""
    golden = reference.load("paris.binary64")
    texts = trajectories(golden)
    texts = {
        name: texts[name] for name in size(("right", "wrong", "millimetres_west", "fortran"), texts)
    }
    for (name, text), mine in zip(
        texts.items(), answers(golden.scene, texts.values()), strict=True
    ):
        path = tmp_path / "mine.csv"
        path.write_text(text)
        score = judge(path, "paris", explain=False)
        assert mine["verdict"] == score.verdict, name
        assert mine["path"]["max_error_m"] == pytest.approx(score.errors.max_m, rel=1e-3, abs=2e-11)
        assert mine["amplitude_m"] == pytest.approx(score.errors.amplitude_m, rel=1e-9), name
        if score.verdict == "disagrees" and score.errors.max_m > 1e-6:
            assert mine["path"]["worst"]["component"] == score.worst[1], name


SCENE = load_scene("museum", ["run.t_end=120", "run.grid_step=0.5", "inputs=binary64"])


@pytest.fixture(scope="module")
def motion():
    """Rows of the museum's pendulum each half second, as a right program prints them."""
    solution = reference.solve(SCENE.with_values({"run.digits": 18, "run.level": "computed"}))
    return {name: np.array(getattr(solution, name)) for name in ("t", "x", "y", "z")}


def turned(x, y, degrees):
    angle = np.radians(degrees)
    return np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y


# what a program makes of t, x, y, z
MAPS = {
    "x_copied": lambda t, x, y, z: (t, x, x, z),
    "plane_times": lambda t, x, y, z: (t, 0.5 * x, 0.5 * y, None),
    "heights": lambda t, x, y, z: (t, x, y, z + 3),
    "y_mirrored_and_moved": lambda t, x, y, z: (t, x + 0.25, y, None),
    "plane_turned": lambda t, x, y, z: (t, *turned(x, y, 30), None),
    "plane_moved": lambda t, x, y, z: (t, x + 0.5, y + 0.25, None),
    "times_and_turned": lambda t, x, y, z: (t, *turned(2 * x, 2 * y, 45), None),
    "y_times": lambda t, x, y, z: (t, x, 1.25 * y, None),
    "y_late": lambda t, x, y, z: (t, x, np.concatenate([y[:1], y[:-1]]), None),
    "pixels": lambda t, x, y, z: (t, np.round(400 * x), np.round(400 * y), None),
    "z_down": lambda t, x, y, z: (t, x, y, -z),
    "lowest": lambda t, x, y, z: (t, x, y, z + 20),
}


def file_of(columns):
    names = [name for name, column in zip("txyz", columns, strict=True) if column is not None]
    return csv(",".join(names), *(column for column in columns if column is not None))


def test_an_observation_has_the_words_of_the_package(motion, size, tmp_path):
    names = size(("heights",), MAPS)
    files = {name: file_of(MAPS[name](*(motion[column] for column in "txyz"))) for name in names}
    for (name, text), mine in zip(files.items(), answers(SCENE, files.values()), strict=True):
        path = tmp_path / "mine.csv"
        path.write_text(text)
        explanation = judge(path, SCENE).explanation
        assert mine["verdict"] == "disagrees"
        said = " ".join(mine["notes"])
        assert explanation.conventions and not explanation.causes, name
        for convention in explanation.conventions:
            assert convention.text in said, (name, mine["notes"])


def test_a_clock_has_the_words_of_the_package(motion, tmp_path):
    t, x, y = (motion[name] for name in "txy")
    text = csv("t,x,y", (1.0001 * t)[:-1], x[:-1], y[:-1])
    path = tmp_path / "mine.csv"
    path.write_text(text)
    (cause,) = judge(path, SCENE).explanation.causes
    (mine,) = answers(SCENE, [text])
    words = CLOCK.format(value="1.0001")
    assert words in cause.text and words in mine["notes"][-1]


def test_a_wrong_program_is_no_observation(motion):
    """Another length, and one without rotation: no map of columns makes them; the page leaves them to the command."""
    wrong = []
    for change in ("pendulum.length=20.5", "site.rotation_rate=0", "site.latitude=-50"):
        settings = {"run.digits": 18, "run.level": "computed"}
        solution = reference.solve(SCENE.with_values([change]).with_values(settings))
        wrong.append(csv("t,x,y", *(np.array(getattr(solution, name)) for name in "txy")))
    for mine in answers(SCENE, wrong):
        assert mine["verdict"] == "disagrees" and mine["notes"] == []


def rows_of(scene):
    """The rows of a right program for a scene."""
    solution = reference.solve(scene.with_values({"run.digits": 18, "run.level": "computed"}))
    return csv("t,x,y", *(np.array(getattr(solution, name)) for name in "txy"))


@pytest.mark.parametrize(
    ("form", "program", "advice"),
    [
        ("ellipsoid", "effective", "choose effective under Place; else add −Ω² q sin φ along y"),
        ("effective", "ellipsoid", "choose ellipsoid under Place."),
    ],
)
def test_a_g_of_the_other_meaning_has_the_words_of_the_package(form, program, advice, tmp_path):
    asked = SCENE.with_values([f"site.gravity_is={form}"])
    text = rows_of(SCENE.with_values([f"site.gravity_is={program}"]))
    path = tmp_path / "mine.csv"
    path.write_text(text)
    (cause,) = judge(path, asked).explanation.causes
    (mine,) = answers(asked, [text])
    said, told = mine["notes"]
    words = cause.text.partition(" (--set")[0]
    assert said.startswith(f"Your program {words}: corrected, the error is ")
    assert advice in told
    assert mine["explained"]


def motion_without(scene, term, axis_m=0.0, step_s=0.025):
    """Rows t, x, y, z by steps of Runge and Kutta, as docs/pendulum.c, each half second.

    `term` is left out: sphere (for small angles), coriolis (its horizontal Ω), centrifugal (its change along the
    swing), or nothing.
    """
    length, gravity = float(scene.exact.length), float(scene.exact.gravity)
    rate, latitude = float(scene.exact.rotation_rate), np.radians(float(scene.exact.latitude))
    sin, cos = np.sin(latitude), np.cos(latitude)
    turn = rate * np.array([0, 0 if term in ("coriolis", "sphere") else cos, sin])

    def rates(state):
        r, v = state
        if term == "sphere":
            flat = -2 * np.cross(turn, v) - gravity / length * r
            return np.array([v, flat]) * np.array([1, 1, 0])
        along_x, along_y, along_z = r * (term != "centrifugal")
        p = axis_m - along_y * sin + along_z * cos
        centrifugal = rate**2 * np.array([along_x, -p * sin, p * cos])
        force = centrifugal - 2 * np.cross(turn, v) - gravity * np.array([0, 0, 1])
        return np.array([v, force - r * (v @ v + r @ force) / length**2])

    x, y = float(scene.release.x), float(scene.release.y)
    state = np.array([[x, y, -np.sqrt(length**2 - x**2 - y**2)], [0, 0, 0]])
    rows = []
    for count in range(round(float(scene.exact.t_end) / step_s) + 1):
        rows.append((count * step_s, *state[0]))
        first = rates(state)
        second = rates(state + step_s / 2 * first)
        third = rates(state + step_s / 2 * second)
        fourth = rates(state + step_s * third)
        state = state + step_s / 6 * (first + 2 * second + 2 * third + fourth)
    return np.array(rows[:: round(0.5 / step_s)])


def with_force(scene, axis_m):
    """Rows of a right program that takes this distance from the Earth's axis."""
    return csv("t,x,y,z", *motion_without(scene, "", axis_m).T)


def test_the_force_that_the_page_says_to_add_makes_a_program_right():
    """With g as the effective one the program disagrees; with the force from the page's own number it agrees."""
    scene = SCENE.with_values(["site.gravity_is=ellipsoid"])
    (mine,) = answers(scene, [with_force(scene, 0)])
    said = " ".join(mine["notes"])
    axis = re.search(r"where q = (\S+) m is the suspension's distance from the Earth's axis", said)[
        1
    ]
    known = constants_in_double(scene.exact)
    assert float(axis) == pytest.approx(float(known.axis_distance * known.length), rel=1e-9)
    assert said.count("Add ") + said.count("add ") == 1
    right, round_earth = answers(
        scene, [with_force(scene, float(axis)), with_force(scene, 6371000)]
    )
    assert right["verdict"] == "agrees" and round_earth["verdict"] == "disagrees"


def test_how_far_the_bob_is_off_without_a_term():
    """As another integrator has it. Nothing is said of a wide swing, and where nothing is left to explain."""
    full = motion_without(SCENE, "")
    wrong = csv("t,x,y", *motion_without(SCENE.with_values(["pendulum.length=20.5"]), "").T[:3])
    mine, right = answers(SCENE, [wrong, csv("t,x,y,z", *full.T)])
    assert mine["leftOut"]["sizes"].keys() == {"sphere", "coriolis", "centrifugal"}
    for term, size_m in mine["leftOut"]["sizes"].items():
        apart = (motion_without(SCENE, term) - full)[:, 1:3]
        assert size_m == pytest.approx(np.hypot(*apart.T).max(), rel=0.05), term
    assert mine["leftOut"]["until"] == 120 and right["leftOut"] is None
    wide = SCENE.with_values(["release.x=16"])
    (mine,) = answers(wide, [wrong])
    assert mine["verdict"] == "disagrees" and mine["leftOut"] is None


def test_the_meaning_of_g_is_likelier_than_a_clock_if_it_explains_as_much():
    """At the equator the centrifugal force makes g smaller and nothing else: a clock of another rate fits as well.

    A g that is about as much too large is no other meaning: a clock leaves far less.
    """
    equator = SCENE.with_values(["site.latitude=0"])
    shorter = equator.with_values(["site.gravity_is=effective", "run.t_end=110"])
    text = rows_of(shorter)
    other = rows_of(equator.with_values(["site.gravity_is=ellipsoid", "site.gravity=9.8447"]))
    mine, another = answers(equator.with_values(["site.gravity_is=ellipsoid"]), [text, other])
    assert "takes g as the effective gravity" in mine["notes"][0]
    assert not any("clock" in note for note in mine["notes"])
    assert "has a clock" in another["notes"][0]
    assert not any("effective" in note for note in another["notes"])


def by_steps(step_s):
    """Rows of a flat small-angle pendulum near Paris, whose g is effective, by steps of Euler and Cromer."""
    length, gravity = 67, 9.80665
    coriolis = 2 * 7.292115e-5 * np.sin(np.radians(48.846111))
    x, y, vx, vy = 0.3, 0.4, 0.0, 0.0
    rows = []
    for count in range(round(600 / step_s) + 1):
        rows.append((count * step_s, x, y))
        along_x = -gravity / length * x + coriolis * vy
        along_y = -gravity / length * y - coriolis * vx
        vx += step_s * along_x
        vy += step_s * along_y
        x += step_s * vx
        y += step_s * vy
    each = round(1 / step_s)
    return csv("t,x,y", *np.array(rows[::each]).T)


def test_beside_a_step_error_the_meaning_of_g_is_named_if_it_makes_most_of_the_error():
    """A fine step leaves a hundredth of the error, which is stated. A coarse one leaves more: nothing is named."""
    scene = load_scene("paris", ["run.t_end=600", "inputs=binary64"])
    fine, coarse = answers(scene, [by_steps(0.01), by_steps(0.1)])
    assert "takes g as the effective gravity" in fine["notes"][0] and not fine["explained"]
    assert fine["gravity"]["isNamed"] and not fine["gravity"]["explains"]
    left = re.fullmatch(
        r"Your .*, the error is (\S+) m, (\S+) tolerances: something else .*", fine["notes"][0]
    )
    error_m, tolerances = map(float, left.groups())
    assert tolerances == pytest.approx(error_m / fine["tolerance_m"], rel=0.1)
    assert coarse["notes"] == [] and coarse["gravity"]["helps"] and not coarse["explained"]
