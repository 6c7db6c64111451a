"""The page's integrator: its motion against golden data and the reference, its own estimate of the error, its swing."""

from __future__ import annotations

import re
import shutil

import numpy as np
import pytest
from page_motion import code, motions, node, words
from random_scenes import random_scene

import reference
from compare.candidates.read import read
from compare.report.atlas.form import fields, texts_of
from compare.report.atlas.pendulum_page import pendulum_page
from reference import UnreachableError, load_scene
from reference.scenes.scene import as_scene
from reference.scenes.shipped import golden_root, scene_ids
from reference.sweeps.scene_swing import swing

pytestmark = pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not installed")

QUICK = (
    "museum_gate",
    "damped",
    "over_top",
    "near_inverted",
    "conical",
)
MOST_ROWS = 1500  # of a dataset, that are compared
LATE = 3  # times its estimate: an error that is larger is listed
MOST_LATE = 2  # of 200 random pendulums


_PRINT = """
const { texts, fields, words } = JSON.parse(require("fs").readFileSync(0, "utf8"));
const solution = solve(sceneOf(texts, fields), words);
const times = [0, 0.3, 0.6, 3 * 0.3, 1];
console.log(JSON.stringify({ csv: csvOf(solution, 0.3), states: times.map(solution.at) }));
"""


def golden(scene_id):
    """The dataset of a scene whose inputs are doubles, as the page reads them; else the one of decimals."""
    name = f"{scene_id}.binary64"
    return reference.load(name if (golden_root() / name).is_dir() else scene_id)


def errors(states, told):
    """Return the errors of positions in m, their estimates, and the largest ratio."""
    error = np.linalg.norm(np.array(told["states"])[:, :3] - states[:, :3], axis=1)
    estimate = np.array(told["errors"])
    return error.max(), estimate.max(), (error / estimate).max()


def test_motions_that_ship(size, tally):
    """All but the rows at the end of what doubles can follow; the list of errors is printed with --long."""
    wrong = []
    for scene_id in size(QUICK, scene_ids()):
        data = golden(scene_id)
        rows = slice(None, None, max(1, len(data.t) // MOST_ROWS))
        (told,) = motions([(data.scene, data.t[rows].tolist())])
        states = np.array([data.x, data.y, data.z]).T[rows]
        error, estimate, ratio = errors(states, told)
        tally(f"{scene_id}: error {error:.1e} m, estimated {estimate:.1e} m, ratio {ratio:.2f}")
        if ratio > LATE:
            wrong.append(scene_id)
        if told["transits"] is None or not data.scene.run.transits:
            continue
        times = data.transits["t"]
        assert len(told["transits"]) == len(times), scene_id
        late = np.abs(np.array(told["transits"]) - times)
        assert (late <= LATE * told["facts"]["transitError"] + np.spacing(data.t[-1])).all(), (
            scene_id
        )
    assert wrong == []


def test_random_pendulums(size, tally):
    """Against runs with 20 digits; the estimate is too small by more than a factor of 3 in at most two of 200."""
    scenes = []
    for seed in range(size(1, 200)):
        document = random_scene(seed) | {"inputs": "binary64"}
        document["run"] |= {"digits": 20, "level": "computed", "transits": False}
        scenes.append(as_scene(document))
    solutions = [reference.solve(scene) for scene in scenes]
    told = motions(
        [(scene, solution.t.tolist()) for scene, solution in zip(scenes, solutions, strict=True)]
    )
    late = []
    for scene, solution, one in zip(scenes, solutions, told, strict=True):
        states = np.array([solution.x, solution.y, solution.z]).T
        error, estimate, ratio = errors(states, one)
        if ratio > 1 or len(scenes) < 10:
            tally(f"{scene.id}: error {error:.1e} m, estimated {estimate:.1e} m, ratio {ratio:.2f}")
        if ratio > LATE:
            late.append(scene.id)
    assert len(late) <= MOST_LATE, late


def test_period_and_precession_are_those_that_show_prints(size):
    """Over the whole run, as `show` has them up to 10,000 swings; both say alike why there is none."""
    for scene_id in size(("museum_gate", "damped", "over_top", "conical"), scene_ids()):
        scene = load_scene(scene_id, ["inputs=binary64"])
        (told,) = motions([(scene, [0.0])])
        facts = told["facts"]
        try:
            known = swing(scene)
        except UnreachableError as error:
            if "not decided" in str(error):
                continue
            assert facts["period"] is None and facts["reason"] in str(error), scene_id
            continue
        if facts["period"] is None or known.over_s != scene.run.t_end:
            continue
        period = facts["period"]
        assert (
            abs(period["value"] - known.period_s) <= LATE * period["error"] + known.period_error_s
        ), scene_id
        precession = facts["precession"]
        assert (precession is None) == (known.precession_deg_per_h is None), scene_id
        if precession:
            error = LATE * precession["error"] + known.precession_error_deg_per_h
            assert abs(precession["value"] - known.precession_deg_per_h) <= error, scene_id


def test_estimated_errors_of_period_and_precession_hold(size):
    """Against 25 digits: both are right to the last digits of a double, and so say their estimates."""
    for scene_id in size(("museum_gate",), ("museum_gate", "two_radians", "pole")):
        scene = load_scene(scene_id, ["inputs=binary64", "run.t_end=100"])
        settings = {"run.sections": "highest", "run.digits": 25, "run.level": "computed"}
        known = reference.solve(scene.with_values(settings)).swing
        (told,) = motions([(scene, [0.0])])
        for name, (low, high) in (("period", known.period), ("precession", known.precession)):
            number = told["facts"][name]
            assert abs(number["value"] - float((low + high) / 2)) <= number["error"], scene_id
            assert number["error"] < 1e-8 * abs(number["value"]), scene_id


def test_a_motion_as_csv_is_read_to_the_last_bit(tmp_path):
    scene = load_scene("two_radians", ["run.t_end=1"])
    script = code() + _PRINT
    told = node(script, {"texts": texts_of(scene), "fields": fields(), "words": words()})
    path = tmp_path / "pendulum.csv"
    path.write_text(told["csv"])
    rows = read(path)
    assert rows.t.tolist() == [0, 0.3, 0.6, 0.3 * 3, 1]
    states = np.array(told["states"]).T
    for name, column in zip(("x", "y", "z", "vx", "vy", "vz"), states, strict=True):
        assert (rows.columns[name] == column).all()


def test_no_two_scripts_of_the_page_have_a_name_in_common():
    """They share one scope: the second function of a name would replace the first."""
    scripts = re.findall(r"<script class=.*?>(.*?)</script>", pendulum_page("scenes.html"), re.S)
    declared = re.compile(r"^(?:async )?(?:function|const|let|class) (\w+)", re.M)
    names = [name for script in scripts for name in declared.findall(script)]
    assert len(names) > 100 and sorted(names) == sorted(set(names))
