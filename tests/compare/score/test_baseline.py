"""What changed between two versions of a program: pairs of which it is known, and what a document must be."""

from __future__ import annotations

import itertools
import math
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from loops import LOOPS, Loop, source_of
from mistakes import Case, case
from places import MISTAKEN_C
from scipy.integrate import solve_ivp
from small_scenes import make_scene

from compare.candidates.candidate import Candidate
from compare.score.judge import judge
from reference import load_scene, trajectory

COMPILER = shutil.which("cc")
FINE = {"swing": 900.0}
NO_REST = {"reading": 1.0}  # without the centrifugal force
DAY = {"rate": 2 * math.pi / 86400}
STEP, WORSE, BETTER, SAME = "the step", "worse", "better", "same"
Options = dict[str, float]

# what both have, what the new version has besides or instead, what is told, and what became of the error
PAIRS: list[tuple[str, Options, Options, Options, set[str], str]] = [
    ("nothing", {}, {}, {}, set(), SAME),
    ("nothing", {"g": 9.81}, {}, {}, set(), SAME),
    ("nothing", {"model": 1, "reading": 1}, {}, {}, set(), SAME),
    ("nothing", {"method": 3, "swing": 100}, {}, {}, set(), SAME),
    ("nothing", NO_REST | DAY, {}, {}, set(), SAME),
    ("step", {}, FINE, {"swing": 200}, {STEP}, ""),
    ("step", {}, FINE, {"swing": 40}, {STEP}, WORSE),
    ("step", {}, {"swing": 40}, FINE, {STEP}, BETTER),
    ("step", NO_REST, FINE, {"swing": 60}, {STEP}, ""),
    ("step", {}, FINE, {"swing": 200, "method": 2}, {STEP}, WORSE),
    ("step", {}, FINE, {"swing": 200, "method": 3}, {STEP}, WORSE),
    ("constant", {}, {}, {"g": 9.81}, {"9.81"}, WORSE),
    ("constant", {}, {"g": 9.81}, {}, {"9.81"}, BETTER),
    ("constant", {}, {"g": 9.81}, {"g": 9.8}, {"9.8 "}, ""),
    ("constant", {"g": 9.81}, {}, DAY, {"solar day"}, ""),
    ("constant", NO_REST, {}, {"rate": 7.29e-5}, {"7.29e-05"}, ""),
    ("constant", {}, {}, {"drag": 1e-5}, {"drag"}, WORSE),
    ("unit", {}, {}, {"scale": 100}, {"centimetres"}, WORSE),
    ("unit", {}, {"scale": 1000}, {}, {"millimetres"}, BETTER),
    ("unit", {}, {}, {"swap": 1}, {"writes north as x"}, WORSE),
    ("unit", {}, {}, {"tscale": 60}, {"minutes"}, WORSE),
    ("model", {}, {}, NO_REST, {"centrifugal"}, ""),
    ("model", {}, NO_REST, {}, {"centrifugal"}, ""),
    ("model", {"g": 9.81}, {}, {"half": -1}, {"Coriolis"}, ""),
    ("model", {}, {}, {"half": 0.5}, {"Coriolis"}, WORSE),
    ("model", {}, {}, {"invf": 1e9}, {"sphere of the equatorial radius"}, WORSE),
]


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """One program, compiled twice: its numbers differ by rounding alone."""
    if COMPILER is None:
        pytest.skip("no C compiler")
    made = tuple(tmp_path_factory.mktemp("programs") / name for name in ("plain", "fast"))
    for target, option in zip(made, ("-O0", "-O3"), strict=True):
        more = ["-ffast-math"] if option == "-O3" else []
        subprocess.run(
            [COMPILER, option, *more, "-o", str(target), str(MISTAKEN_C), "-lm"], check=True
        )
    return made[0], made[1]


def small(number: int) -> Case:
    """Return a scene of many swings that are not wide, where a step is known from its error; in one of four g is
    measured."""
    reading = 2 if number % 4 == 3 else 0
    for made in (case(i, seed=29, most=0) for i in itertools.count(100 * number)):
        swing = math.hypot(made.arguments["x0"], made.arguments["y0"])
        many = made.arguments["tend"] > 25 * made.period
        if swing < 0.1 * made.arguments["l"] and many and made.arguments["reading"] == reading:
            return made
    raise AssertionError


def printed(program: Path, made: Case, options: Options, name: str) -> Candidate:
    """Return what a version of a program writes."""
    before = made.arguments
    if "swing" in options:  # about so many steps in a swing, a whole number from row to row
        steps = math.ceil(before["out"] / made.period * options["swing"])
        options = {key: value for key, value in options.items() if key != "swing"} | {
            "h": before["out"] / steps
        }
    made.arguments = before | options
    try:
        times, columns = made.rows(program)
    finally:
        made.arguments = before
    return Candidate.of(name, times, columns)


def compared(made: Case, old: Candidate, new: Candidate, **options: Any) -> Any:
    found = judge(new, made.scene, baseline=old, **options).since
    assert found is not None and found.name == "old"
    return found


def check(found: Any, words: set[str], outcome: str) -> None:
    """Check that exactly these things are told, and what became of the error."""
    assert len(found.changes) == len(words), found.text
    assert all(any(word in change for change in found.changes) for word in words), found.text
    assert (
        found.complete is bool(words)
        or words == {STEP}
        or (found.left_m or 0.0) < 0.1 * found.apart_m
    ), found.text
    assert ("nothing else" in found.text) is (bool(words) and found.complete), found.text
    assert (bool(found.worse), found.better) == (
        outcome == WORSE,
        outcome == BETTER,
    ) or not outcome, found.text


QUICK = (1, 5, 13, 17, 21)  # one of each kind
NUMBERED = [
    pytest.param(i, pair, id=f"{i}-{pair[0]}", marks=() if i in QUICK else pytest.mark.long)
    for i, pair in enumerate(PAIRS)
]


@pytest.mark.parametrize(("number", "pair"), NUMBERED)
def test_what_changed_between_two_versions(
    programs: tuple[Path, Path], number: int, pair: tuple[Any, ...]
) -> None:
    _, both, before, after, words, outcome = pair
    made = small(number)
    old, new = (
        printed(programs[0], made, both | options, name)
        for options, name in ((before, "old"), (after, "new"))
    )
    check(compared(made, old, new), words, outcome)


@pytest.mark.long
def test_rounding_is_no_change(programs: tuple[Path, Path]) -> None:
    for number in range(2):
        made = small(number)
        old, new = (
            printed(program, made, NO_REST, name)
            for program, name in zip(programs, ("old", "new"), strict=True)
        )
        assert max(abs(old.columns["x"] - new.columns["x"])) > 0
        check(compared(made, old, new), set(), SAME)


def solved(made: Case, tolerance: float, method: str) -> Candidate:
    """Return what SciPy's integrators make of the pendulum, with g effective: no centrifugal force."""
    a = made.arguments
    latitude, rate = math.radians(a["lat"]), 7.292115e-5
    north, up, square = 2 * rate * math.cos(latitude), 2 * rate * math.sin(latitude), a["l"] ** 2

    def right(_: float, state: np.ndarray) -> tuple[float, ...]:
        # in floats: NumPy takes ten times as long for three numbers
        x, y, z, vx, vy, vz = state.tolist()
        fx, fy, fz = up * vy - north * vz, -up * vx, north * vx - 9.80665
        pull = (vx * vx + vy * vy + vz * vz + x * fx + y * fy + z * fz) / square
        return vx, vy, vz, fx - pull * x, fy - pull * y, fz - pull * z

    start = [a["x0"], a["y0"], -math.sqrt(square - a["x0"] ** 2 - a["y0"] ** 2), 0, 0, 0]
    times = a["out"] * np.arange(101.0)
    states = solve_ivp(
        right, (0, times[-1]), start, method, times, rtol=tolerance, atol=tolerance
    ).y
    return Candidate.of("old", times, dict(zip("xyz", states, strict=False)))


@pytest.mark.parametrize(
    ("method", "old", "new", "outcome"),
    [
        pytest.param("RK45", 1e-10, 1e-6, "", marks=pytest.mark.long),
        pytest.param("RK45", 1e-6, 1e-9, "", marks=pytest.mark.long),
        ("DOP853", 1e-12, 1e-5, ""),
        ("DOP853", 1e-11, 1e-11, SAME),
    ],
)
def test_a_tolerance_is_the_step(method: str, old: float, new: float, outcome: str) -> None:
    made = small(5)
    first = solved(made, old, method)
    found = compared(made, first, first if old == new else solved(made, new, method))
    if old == new:
        check(found, set(), outcome)
        return
    # a step of no name moves a bob as several numbers do: silence is right as well
    assert all(STEP in one or "leaves the sphere" in one for one in found.changes), found.text


def test_a_clock_is_told_as_what_changed_and_no_g() -> None:
    """A fast clock moves like another g, but for what the rotation does."""
    scene, times = (
        load_scene("paris", ["run.t_end=3600", "inputs=binary64"]),
        np.linspace(0, 3600, 121),
    )

    def version(pace: float, rate: str) -> Candidate:
        run = trajectory(
            scene.with_values([f"site.rotation_rate={rate}", "run.t_end=4000"]), times * pace
        )
        return Candidate.of("old", times, dict(zip("xyz", run.T, strict=False)))

    same = judge(version(1.0, "7.3e-5"), scene, baseline=version(1.0, "7.292115e-5")).since
    assert same is not None and same.complete and "7.3e-05" in same.text
    # where the rotation shows, a clock is no g
    old = version(1.0001, "7.292115e-5")
    found = judge(version(1.0, "7.3e-5"), scene, baseline=old).since
    assert found is not None and found.complete and len(found.changes) == 2
    assert any("clock" in change for change in found.changes)


LEAVES_OUT = "leaves out the centrifugal force's change along the swing"
EFFECTIVE = {"reading": 2.0}
LATE = {"toffset": 0.01}
# what the old version has, what the new one has, and the words on what changed, or on the reason that none is named
PAIRS_IN_PARIS: list[tuple[Options, Options, str]] = [
    ({}, LATE, "its file now starts its clock at 0.01 s and not at 0: "),
    ({"g": 9.8}, {"g": 9.8} | LATE, "its file now starts its clock at 0.01 s and not at 0: "),
    (EFFECTIVE, NO_REST, f"it now {LEAVES_OUT}: "),
    (NO_REST, EFFECTIVE, f"it no longer {LEAVES_OUT}: "),
    ({}, NO_REST, f"contains the centrifugal force, and {LEAVES_OUT}: "),
    ({"gtimes": 1 / 1.001}, {"ltimes": 1.001}, "its cause is not certain"),
    ({"decimals": 6}, {"decimals": 4}, "no more than the rounding of the printed numbers"),
    ({}, {"decimals": 6}, "no more than the rounding of the printed numbers"),
]


@pytest.mark.parametrize(("before", "after", "words"), PAIRS_IN_PARIS)
def test_what_both_explanations_know_is_what_changed(
    programs: tuple[Path, Path], before: Options, after: Options, words: str
) -> None:
    """Both files are explained, whatever the size of a cause beside that of the change, or it is said why none is."""
    run = {"t_end": "600", "grid_step": "5"}
    scene = make_scene("known", run=run).with_values(["inputs=binary64"])
    values = {"lat": 48.846111, "x0": 0.3, "y0": 0.4, "out": 5.0, "tend": 600.0}
    made = Case(0, scene, 16.4, np.random.default_rng(0), values)
    old = printed(programs[0], made, before, "old")
    new = printed(programs[0], made, after, "new")
    found = compared(made, old, new)
    assert words in found.text, found.text
    assert found.complete is words.endswith(": "), found.text


def test_a_change_that_few_digits_show_is_more_than_their_rounding() -> None:
    """Six digits round z, which is 67 m, by 5e-5 m, and x of a tenth of a metre by 5e-7 m."""
    release = {"x": "0.3", "y": "0"}
    scene = make_scene("digits", release=release, run={"t_end": "100", "grid_step": "0.5"})
    # at once after the release y is so small that six digits of it are many decimals
    times = np.concatenate([[0.0, 0.01, 0.02, 0.05, 0.1, 0.2], np.linspace(0.5, 100, 200)])
    x, y, z = trajectory(scene, times)[:, :3].T
    jitter = np.random.default_rng(0).uniform(-1, 1, len(times))

    def version(name: str, relative: float) -> Candidate:
        columns = {"x": x * (1 + relative * jitter), "y": y, "z": z}
        for key, column in columns.items():
            columns[key] = np.array([float(f"{number:.6g}") for number in column])
        return Candidate.of(name, times, columns)

    def change(relative: float) -> str:
        found = judge(version("new", relative), scene, baseline=version("old", 0.0)).since
        assert found is not None
        return found.text

    words = "no more than the rounding of the printed numbers"
    assert words in change(1e-7)
    assert words not in change(1e-4)


def test_the_rounding_of_z_is_none_of_x() -> None:
    """z has two decimals in both versions, x and y have all."""
    scene = make_scene("coarse_z", run={"t_end": "100", "grid_step": "0.5"})
    times = np.linspace(0, 100, 201)
    x, y, z = trajectory(scene, times)[:, :3].T
    jitter = np.random.default_rng(0).uniform(-1e-4, 1e-4, len(times))
    old = Candidate.of("old", times, {"x": x, "y": y, "z": z.round(2)})
    new = Candidate.of("new", times, {"x": x + jitter, "y": y, "z": z.round(2)})
    since = judge(new, scene, baseline=old).since
    assert since is not None and "rounding" not in since.text


def test_a_loop_of_another_name_is_a_change_of_the_step(tmp_path: Path) -> None:
    """Two loops with the same step of 0.05 s, whose errors differ by half a percent."""
    scene = make_scene("loops", run={"t_end": "100", "grid_step": "0.25"})
    values = {"x": 0.3, "y": 0.4, "vx": 0.0, "vy": 0.0, "h": 0.05, "q": 9.80665 / 67, "d": 0.0}
    values["f"] = 2 * 7.292115e-5 * math.sin(math.radians(48.846111))

    def version(name: str, loop: str) -> Candidate:
        source = source_of("Python", LOOPS[loop][0], values, 0.25, 5, 400)
        times, columns = Loop(name, "Python", source, scene, set(), set()).rows(tmp_path)
        return Candidate.of(name, times, columns)

    old = version("old", "kick_drift")
    found = judge(version("new", "in_turn"), scene, baseline=old).since
    assert found is not None
    (change,) = found.changes
    assert change.startswith("the step (it now integrates with semi-implicit Euler, its velocities")
    assert found.complete
