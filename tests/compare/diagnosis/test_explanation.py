"""Explanations: programs with chosen mistakes, as a user would run them."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from mistakes import Case, case, one_word_for_one_motion, told
from places import MISTAKEN_C, PENDULUM_C
from sampled import one_in
from small_scenes import make_scene
from typer.testing import CliRunner

from compare import APPROXIMATIONS, Candidate, Score, judge
from compare.score.document import document
from foucault import commands
from reference import Scene, load_scene, trajectory
from reference.model.constants import constants_in_double

COMPILER = shutil.which("cc")
WORDS = "{x0} {y0} {length} {latitude} {gravity} {rotation_rate} {equatorial_radius} {inverse_flattening} {t_end}"
SPAN = "run.t_end=3600"  # an hour shows what a day shows, for a part of the work
LONGER = "run.t_end=21600"


@pytest.fixture(scope="module", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FOUCAULT_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


def compiled(source: Path, folder: Path) -> Path:
    if COMPILER is None:
        pytest.skip("no C compiler")
    subprocess.run(
        [COMPILER, "-O2", "-o", str(folder / source.stem), str(source), "-lm"], check=True
    )
    return folder / source.stem


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compiled(PENDULUM_C, tmp_path_factory.mktemp("programs"))


@pytest.fixture(scope="session")
def mistaken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compiled(MISTAKEN_C, tmp_path_factory.mktemp("programs"))


def scored(
    program: Path, fault: str, *options: str, span: str = SPAN
) -> tuple[int, dict[str, Any]]:
    run = [
        "--run",
        f"{shlex.quote(str(program))} {fault} {WORDS} 0.01 3000",
        "--repeats",
        "0",
        "--set",
        span,
    ]
    result = CliRunner().invoke(commands(), ["score", "paris", *run, "--json", *options])
    return result.exit_code, json.loads(result.stdout)


def test_the_full_equations_agree_and_need_no_diagnosis(program: Path) -> None:
    status, said = scored(program, "none")
    assert (status, said["verdict"], said["diagnosis"]) == (0, "agrees", None)
    assert 1e-9 < said["max_error_m"] < 1e-6  # 6e-9 m for RK4 at 0.01 s
    assert said["timing"]["cpu_s"] > 0


LONG = pytest.mark.long


@pytest.mark.parametrize(
    "fault",
    [
        "mean_sphere",
        "geocentric",
        pytest.param("vertical_only", marks=LONG),  # the table of drawn mistakes has the others
        pytest.param("swapped", marks=LONG),
    ],
)
def test_a_named_mistake_is_recognised(program: Path, fault: str) -> None:
    status, said = scored(program, fault)
    assert (status, said["verdict"]) == (1, "disagrees")
    assert said["diagnosis"]["id"] == fault
    assert said["diagnosis"]["explained"] > 0.99


@pytest.mark.parametrize(
    ("fault", "name", "shift"),
    [
        ("gravity", "site.gravity", 2e-5),
        pytest.param("length", "pendulum.length", 1e-3, marks=LONG),
        ("release", "release.x", 1e-3),
    ],
)
def test_a_wrong_input_is_named_with_its_shift(
    program: Path, fault: str, name: str, shift: float
) -> None:
    status, said = scored(program, fault)
    assert (status, said["diagnosis"]["id"]) == (1, name)
    assert said["diagnosis"]["shift"] == pytest.approx(shift, rel=1e-3)


@pytest.mark.long  # a smooth random error gets none in every run, and takes less
def test_a_random_fault_gets_no_diagnosis(program: Path) -> None:
    status, said = scored(program, "random", "--tolerance", "1e-7")
    assert (status, said["verdict"], said["diagnosis"]) == (1, "disagrees", None)


def synthetic(scene: Scene, name: str, value: str, decimals: int = 17, rows: int = 361) -> Score:
    """Score a candidate that solves the scene with another input and prints `decimals` decimals."""
    read_as = scene.with_values(["inputs=binary64"])
    times = np.linspace(0.0, float(scene.run.t_end), rows)
    states = trajectory(read_as.with_values([f"{name}={value}"]), times).round(decimals)
    columns = {word: np.ascontiguousarray(states[:, i]) for i, word in enumerate("xyz")}
    return judge(Candidate.of("made", times, columns), scene, inputs="binary64")


@pytest.mark.parametrize(
    ("name", "value", "decimals", "rows", "span"),
    [
        # the first half minute shows nothing but the rounding of the output
        ("site.gravity", "9.8068", 6, 361, SPAN),
        # and here the first minutes
        pytest.param("site.gravity", "9.80667", 7, 361, LONGER, marks=LONG),
        pytest.param("site.latitude", "30", 17, 361, LONGER, marks=LONG),
        ("pendulum.length", "70", 17, 400, SPAN),
        pytest.param("pendulum.drag", "1e-6", 17, 361, SPAN, marks=LONG),
        pytest.param("pendulum.length", "67.05", 17, 361, LONGER, marks=LONG),
    ],
)
def test_an_input_is_found_whether_its_shift_is_small_or_large(
    name: str, value: str, decimals: int, rows: int, span: str
) -> None:
    paris = load_scene("paris", [span])
    made = synthetic(paris, name, value, decimals, rows)
    said = document(made)["diagnosis"]
    assert said is not None and said["id"] == name
    true = paris.exact.by_name[name]
    assert said["shift"] == pytest.approx(float(Fraction(value) - true), rel=1e-3)


def test_a_simplification_is_a_grade_of_its_own(program: Path) -> None:
    status, said = scored(program, "linear", span=LONGER)
    assert (status, said["verdict"]) == (1, "disagrees")
    assert said["grade"].startswith("agrees as the model")
    assert said["model"]["exact_to_m"] < 1e-6 < 1 < said["model"]["costs_m"]
    assert {one["id"] for one in said["causes"]} == {"linear_g", "no_centrifugal"}
    assert said["corrected"]["max_error_m"] < 1e-6 < said["max_error_m"]
    assert scored(program, "linear", "--as-model")[0] == 0
    assert scored(program, "solar_day", "--as-model")[0] == 1


def test_no_word_is_wrong_of_programs_with_one_to_three_mistakes(
    mistaken: Path, size: Callable[[Any, Any], Any], tally: Callable[[str], None]
) -> None:
    numbers, right, whole, agree, wrong = size(DRAWN, range(300)), 0, 0, 0, {}
    begun = time.process_time()
    for number in numbers:
        made = case(number)
        found = made.told(*made.rows(mistaken))
        words = found.words
        if made.wrong(words):
            wrong[number] = made.wrong(words)
        elif one_word_for_one_motion(made.true) & one_word_for_one_motion(
            words | found.alternatives
        ):
            right += 1
            whole += one_word_for_one_motion(made.true) <= one_word_for_one_motion(words)
        else:
            agree += found.agrees
    spent = time.process_time() - begun
    named = f"{whole} named whole, {right} in part, {agree} that agree, {len(wrong)} wrong"
    tally(f"mistakes drawn at random: of {len(numbers)} {named}, {spent:.0f} CPU s")
    assert not wrong
    assert right >= SHARE * (len(numbers) - agree)


SHARE = 0.95
# of an input, a model, a force; the tests below have clocks, axes and integrators
DRAWN = (0, 2, 3, 6)


@pytest.mark.parametrize(
    ("number", "words"),
    [
        # position first, 25 steps a row, on a swing of 45 degrees; one of 69 degrees is below
        pytest.param(49, {"integrator_semi_implicit_euler_drift", "z_down"}, marks=LONG),
        (39, {"integrator_rk4"}),  # on a swing of 60 degrees
    ],
)
def test_steps_on_a_wide_swing_are_named_beside_a_wrong_length(
    mistaken: Path, number: int, words: set[str]
) -> None:
    made = case(number)
    assert made.told(*made.rows(mistaken)).words >= words


@pytest.mark.parametrize(
    ("seed", "number", "words"),
    [
        # 1.4 swings from row to row, and another g
        pytest.param(4711, 9, {"integrator_semi_implicit_euler"}, marks=LONG),
        (4711, 54, {"integrator_explicit_euler"}),
        (4711, 72, {"rows_reversed", "unit_of_length"}),
        pytest.param(4711, 183, {"integrator_semi_implicit_euler"}, marks=LONG),
        (4713, 124, {"integrator_semi_implicit_euler_drift"}),  # on a swing of 69 degrees
        (5001, 13, {"unit_of_time"}),  # of a swing of 66 degrees
        pytest.param(17, 169, {"integrator_leapfrog"}, marks=LONG),  # in single precision
        # its clock seemed to be off
        pytest.param(
            90001, 71, {"integrator_explicit_euler", "release.x", "site.gravity"}, marks=LONG
        ),
        # beside a clock, which g and the rate stand for
        pytest.param(20, 78, {"integrator_semi_implicit_euler_drift"}, marks=LONG),
        # whose rate is that of the Earth, but for its sign
        (70007, 146, {"coriolis_sign", "radians"}),
        # a latitude of the other sign, which was fitted; and a frame turned by 180° with Ω of the other sign
        (77818, 244, {"hemisphere", "vertical_only", "x_west"}),
        (57039, 228, {"hemisphere", "ellipsoid_gravity", "xy_swapped"}),
        # in single precision, times too; so is the next
        pytest.param(61126, 110, {"linear_in_angle"}, marks=LONG),
        (61126, 153, {"pendulum.length", "solar_day"}),
        pytest.param(61126, 193, {"integrator_rk4"}, marks=LONG),  # on a wide swing, beside a model
        # of whose rows the steps are run for a third
        pytest.param(83003, 50, {"linspace_clock", "integrator_explicit_euler"}, marks=LONG),
        # a step a row, on a swing of half a cord
        pytest.param(81001, 43, {"integrator_rk4", "pendulum.length"}, marks=LONG),
    ],
)
def test_what_was_once_not_found(mistaken: Path, seed: int, number: int, words: set[str]) -> None:
    made = case(number, seed)
    found = made.told(*made.rows(mistaken))
    assert found.words | found.alternatives >= words


@pytest.mark.parametrize(
    ("seed", "number"),
    [
        # three readings within the tolerance, each of them contradicted below it
        pytest.param(90001, 198, marks=LONG),
        (70007, 70),  # a g and a step's error that look like another g
        (70007, 263),  # a linear model beside the same without its gravity
        # vertical alone, Ω of the other hemisphere is Ω of the other sign
        pytest.param(61126, 264, marks=LONG),
        # a clock and drag, which a step and three arbitrary numbers make as well
        (70007, 154),
        # no rotation, which is neither of its forces as well; the next test has the two readings alone
        pytest.param(85005, 148, marks=LONG),
        # x and y in each other's place, which a swapped release and Ω's sign make as well, and leave less
        pytest.param(81001, 94, marks=LONG),
        (81001, 270),
        (12582, 141),
        # a named g beside an arbitrary clock, latitude and rate
        (83855, 231),
        # a rate that is rounded, without which the file agrees as well
        pytest.param(84004, 152, marks=LONG),
        # beside a step error of no name, another g looks like a height of the site or a rotation rate
        (71203, 131),
        # beside steps of a known method, a second step error and what it leaves: a clock, a sphere and a rate
        (17, 232),
        # after a shift of its clock by part of a row, a clock that starts late, and a release that is off
        pytest.param(22776, 28, marks=LONG),
        # minutes read as seconds: an Earth that turns 60 times too fast, and an arbitrary g
        (16993, 177),
    ],
)
def test_what_was_once_told_wrongly(mistaken: Path, seed: int, number: int) -> None:
    made = case(number, seed)
    assert not made.wrong(made.told(*made.rows(mistaken)).words)


@pytest.mark.parametrize(
    ("seed", "number"),
    [
        *((17, n) for n in (204, 224, 288)),
        (23, 102),
        *(
            pytest.param(*one, marks=LONG)
            for one in (
                *((17, 55), (17, 94), (17, 100), (17, 118), (23, 70), (4711, 133), (4711, 138)),
                *((4713, 207), (4713, 289), (5001, 24)),
            )
        ),
    ],
)
def test_what_was_once_named_and_was_not_there(mistaken: Path, seed: int, number: int) -> None:
    """Mirrored releases, methods in single precision, other units of reversed rows, rates for a clock.

    Times in single precision of sparse rows, a g for a leapfrog, a g for what is not known of a step.
    """
    made = case(number, seed)
    assert not made.wrong(made.told(*made.rows(mistaken)).words)


def test_an_either_names_each_alternative_once(mistaken: Path) -> None:
    """A linear model with another g: two readings of the centrifugal force fit nearly the same g."""
    made = case(13, seed=20)
    explanation = made.told(*made.rows(mistaken)).explanation
    (either,) = [cause.id.split("|") for cause in explanation.causes if "|" in cause.id]
    # z shows that the length is right
    assert sorted(either) == ["integrator_loose", "site.gravity"]


def test_mistakes_corrected_as_told_end_at_agreement(
    mistaken: Path, size: Callable[[Any, Any], Any], tally: Callable[[str], None]
) -> None:
    """Two or three mistakes; one that is told is mended, whichever, and what is left is told again."""
    ends: Counter[str] = Counter()
    for number in size((3, 5, 7), count()):
        made = case(number, seed=20)
        if len(made.parts) > 1:
            ends[corrected(made, mistaken)] += 1
        if ends.total() == 60:
            break
    tally(f"programs corrected as told: {dict(ends)}")
    assert ends["agrees"] + ends["agrees as a model"] == ends.total()


def corrected(made: Case, program: Path) -> str:
    """Return where corrections end: at agreement, or with nothing told that would mend a mistake.

    Of an "either … or …" the true one is mended.
    """
    for _ in range(len(made.parts) + 1):
        times, columns = made.rows(program)
        found = made.told(times, columns)
        explanation = found.explanation
        if explanation is not None and explanation.model is not None:
            return "agrees as a model"
        words = found.words | found.alternatives
        if explanation is not None:
            words |= {one.id.removeprefix("as_if.") for one in explanation.causes}
        if not made.parts or not made.matters(program):
            within = found.agrees or (
                explanation is not None and explanation.corrected_m <= made.allowed_m
            )
            return "agrees" if within else "disagrees"
        words |= {"no_coriolis", "no_centrifugal"} if "no_rotation" in words else set()
        steps = {
            word
            for word in made.true
            if word.startswith("integrator") and "integrator_loose" in words
        }
        mended = [made.without({word}) for word in made.rng.permutation(sorted(words | steps))]
        fewer = [one for one in mended if len(one.parts) < len(made.parts)]
        if not fewer:
            return "untold"
        made = fewer[0]
    return "disagrees"


def test_nothing_is_said_of_right_programs(mistaken: Path, size: Callable[[int, int], int]) -> None:
    for number in range(size(4, 200)):
        made = case(number, seed=18, most=0)
        found = made.told(*made.rows(mistaken))
        assert not made.wrong(found.words), number
        assert found.agrees or not found.explanation.causes, number


def test_nothing_is_named_of_a_smooth_random_error(
    mistaken: Path, size: Callable[[int, int], int]
) -> None:
    for number in range(size(1, 100)):
        made = case(number, seed=19, most=0)
        times, columns = made.rows(mistaken)
        scale = 10 ** made.rng.uniform(-5, -1) * made.allowed_m * 1e6
        for name in columns:
            rates = made.rng.uniform(0.05, 3, 6) * 2 * np.pi / made.period
            waves = np.sin(times[:, None] * rates + made.rng.uniform(0, 6, 6)).sum(axis=1)
            columns[name] = columns[name] + scale * waves / 6
        assert not made.wrong(made.told(times, columns).words), number


# the test above has a random error
@pytest.mark.parametrize("noise_m", [0.0, pytest.param(1e-3, marks=LONG)])
def test_nothing_is_named_where_nothing_is_known_or_wrong(noise_m: float) -> None:
    scene = make_scene("smooth", run={"t_end": "600", "grid_step": "2", "digits": 20})
    times, rng = np.linspace(0, 600, 301), np.random.default_rng(4)
    waves = [
        rng.normal(0, noise_m, 3) * np.sin(times[:, None] * rng.uniform(1e-3, 1, 3))
        for _ in range(6)
    ]
    positions = trajectory(scene, times)[:, :3] + sum(waves)
    found = told(scene, times, dict(zip("xyz", positions.T, strict=True)), 1e-6)
    assert found.agrees is (not noise_m)
    assert found.agrees or found.explanation.causes == ()


def stepped(scene: Scene, h: float, every: int, leapfrog: bool) -> np.ndarray:
    """Return x + iy of rows of a linear program whose first step does not move the bob."""
    k = constants_in_double(scene.exact)
    pull, turn = float(k.gravity), 2j * float(k.turn[2])
    before = here = complex(float(scene.release.x), float(scene.release.y))
    rows = [here]
    for n in range(1, 400 * every + 1):
        if n > 1 and leapfrog:  # by central differences
            after = (2 * here - before - h * h * pull * here + h * turn / 2 * before) / (
                1 + h * turn / 2
            )
        else:  # position first
            after = here + (here - before) * (1 - h * turn) - h * h * pull * here if n > 1 else here
        before, here = here, after
        rows += [here] * (n % every == 0)
    return np.array(rows)


@pytest.mark.parametrize(
    ("length", "latitude", "every", "leapfrog"),
    [
        ("1", "60", 1, False),
        ("2.5", "-40", 3, True),
        pytest.param("12", "48", 10, False, marks=LONG),
        pytest.param("1", "60", 1, True, marks=LONG),
        pytest.param("2.5", "-40", 3, False, marks=LONG),
        pytest.param("12", "48", 10, True, marks=LONG),
    ],
)
def test_two_equal_rows_are_of_a_leapfrog_or_of_a_position_that_goes_first(
    length: str, latitude: str, every: int, leapfrog: bool
) -> None:
    fields = [
        f"pendulum.length={length}",
        f"site.latitude={latitude}",
        "release.x=0.01",
        "release.y=0.02",
    ]
    scene, h = load_scene("paris", [*fields, "inputs=binary64"]), 0.1 * float(length) ** 0.5 / every
    rows = stepped(scene, h, every, leapfrog)
    times = h * every * np.arange(401)
    scene = scene.with_values([f"run.t_end={times[-1]}", "run.transits=false"])
    found = told(scene, times, {"x": rows.real.copy(), "y": rows.imag.copy()}, 2.2e-8)
    assert found.explanation.corrected_m < 1e-10
    said = one_word_for_one_motion(found.words)
    assert said == {
        "linear_g",
        "no_centrifugal",
        f"integrator_{'leapfrog_late' if leapfrog else DRIFT}",
    }


DRIFT = "semi_implicit_euler_drift"


FEW = [(0.0,), (60.0,), (0.0, 60.0), (30.0, 60.0), (0.0, 60.0, 120.0)]


@pytest.mark.parametrize("times", one_in(4, map(pytest.param, FEW)))
def test_of_a_few_rows_nothing_is_named_but_what_makes_them_exactly(
    times: tuple[float, ...],
) -> None:
    """A family of models fits a few rows whatever they are, and so do as many fitted numbers as the rows have."""
    scene = load_scene("paris", ["inputs=binary64"])
    still = trajectory(scene.with_values(["site.rotation_rate=0"]), np.unique([0.0, *times]))[
        -len(times) :
    ]
    found = told(scene, np.array(times), dict(zip("xy", still.T, strict=False)), 7e-7)
    assert found.words == ({"no_rotation"} if times[-1] > 0 else set())
    for rows in ([[0.3, 0.4], [0.1, 0.2], [0.2, -0.3]], [[-0.1, 0.2], [0.3, 0.4], [0.1, 0.1]]):
        columns = dict(zip("xy", np.array(rows)[: len(times)].T, strict=True))
        assert told(scene, np.array(times), columns, 7e-7).words == set(), rows


@pytest.mark.parametrize("pull", [1.0, pytest.param(2.0, marks=LONG)])
def test_a_bob_that_nothing_holds_falls(pull: float) -> None:
    times = np.linspace(0, 20, 401)
    # by no round number, so that x has all its decimals
    columns = {"x": 0.3 + 0.01 / 3 * times, "y": 0.4 - pull * 4.9 * times**2}
    found = told(load_scene("paris", ["inputs=binary64"]), times, columns, 7e-7)
    assert found.words == set()
    assert found.explanation.slip.startswith("Its y falls by")


@pytest.mark.parametrize(
    ("changes", "words", "either"),
    [
        ({}, set(), set()),
        ({"site.gravity": "9.80669"}, {"site.gravity"}, set()),
        ({"pendulum.drag": "1e-6"}, {"pendulum.drag"}, set()),
        ({"site.gravity": "9.80669", "pendulum.drag": "1e-6"}, {"site.gravity", "pendulum.drag"}, set()),
        # a step has the same effect as arbitrary numbers
        ({"site.gravity": "9.806691234567"}, set(), {"site.gravity", "pendulum.length", "integrator_loose"}),
        (
            {"site.gravity": "9.806691234567", "pendulum.drag": "1.0123456e-6", "site.latitude": "48.5"},
            {"site.latitude"},
            {"pendulum.drag+site.gravity", "pendulum.drag+pendulum.length", "integrator_loose"},
        ),
    ],
)  # fmt: skip
def test_numbers_that_people_type_are_named_and_others_may_be_a_step(
    changes: dict[str, str], words: set[str], either: set[str]
) -> None:
    fields = ["run.t_end=300", "run.transits=false", "inputs=binary64"]
    scene, times = load_scene("paris", fields), np.linspace(0.0, 300.0, 240)
    other = scene.with_values([f"{name}={value}" for name, value in changes.items()])
    rows = trajectory(other, times)
    found = told(scene, times, dict(zip("xy", rows.T, strict=False)), 1e-7)
    assert found.agrees is (changes == {})
    assert {word for word in found.words if "|" not in word} == words
    told_as_one_of = (
        [part.id for part in found.explanation.causes if "|" in part.id] if changes else []
    )
    assert {word for ids in told_as_one_of for word in ids.split("|")} == either


@pytest.mark.parametrize(("interpreter", "name"), [("python3", "small.py"), ("node", "small.js")])
def test_programs_in_other_languages_are_explained(
    interpreter: str, name: str, tmp_path: Path
) -> None:
    """Two phasors in closed form, with a rotation in radians per hour: no project of ours in them."""
    where = sys.executable if interpreter == "python3" else shutil.which(interpreter)
    if where is None:
        pytest.skip(f"no {interpreter}")
    source = tmp_path / name
    source.write_text(PYTHON if interpreter == "python3" else JAVASCRIPT)
    words = f"{shlex.join([where, str(source)])} {{x0}} {{y0}} {{length}} {{latitude}} {{gravity}}"
    options = ["--t-end", "600"]
    run = ["score", "paris", "--run", words, "--repeats", "0", "--json", *options]
    result = CliRunner().invoke(commands(), run)
    said = json.loads(result.stdout)
    assert {"linear_g", "no_centrifugal", "rate_per_hour"} == {one["id"] for one in said["causes"]}


PYTHON = """
import sys, cmath, math
x, y, l, lat, g = map(float, sys.argv[1:])
b = 2 * math.pi / 24 * math.sin(math.radians(lat))
w = math.sqrt(g / l + b * b)
z = complex(x, y)
print("t,x,y")
for i in range(301):
    t = 2.0 * i
    r = z * cmath.exp(-1j * b * t) * (math.cos(w * t) + 1j * b / w * math.sin(w * t))
    print(t, repr(r.real), repr(r.imag), sep=",")
"""
JAVASCRIPT = """
const [x, y, l, lat, g] = process.argv.slice(2).map(Number)
const b = 2 * Math.PI / 24 * Math.sin(lat * Math.PI / 180), w = Math.sqrt(g / l + b * b)
console.log("t,x,y")
for (let i = 0; i <= 300; i++) {
  const t = 2 * i, c = Math.cos(b * t), s = -Math.sin(b * t), p = Math.cos(w * t), q = b / w * Math.sin(w * t)
  const re = c * p - s * q, im = c * q + s * p
  console.log(`${t},${x * re - y * im},${x * im + y * re}`)
}
"""


@pytest.mark.parametrize(
    "word",
    [
        "linear_recentred",
        *(
            pytest.param(word, marks=LONG)
            for word in ("mathar_item_5", "gastebois_6_2", "mathar_items_1_2", "linear_3d")
        ),
    ],
)
def test_an_approximation_of_the_papers_is_named(word: str) -> None:
    scene, times = load_scene("paris", ["run.t_end=3600"]), np.linspace(0, 3600, 61)
    positions = APPROXIMATIONS[word].trajectory(scene, times)  # type: ignore[attr-defined]
    found = told(scene, times, {"x": positions[:, 0], "y": positions[:, 1]}, 5e-7).explanation
    assert [cause.id for cause in found.causes] == [word]
    assert found.model is not None and found.model.id == word and found.corrected_m < 1e-9


def slipped(
    term: tuple[int, int], value: float, count: int
) -> tuple[dict[str, np.ndarray], list[Any]]:
    """Return rows of a linear program with one coefficient changed, and its place, what it is and what is right."""
    k = constants_in_double(load_scene("paris").exact)
    doubled, swing = 2 * float(k.turn[2]), float(k.gravity)
    right = np.array([[-swing, 0, 0, doubled], [0, -swing, -doubled, 0]])
    place = (term[0], 2) if term == (1, 3) else term
    wrong = right.copy()
    wrong[place] *= value if term == (0, 0) else -value
    system = np.vstack([np.eye(4)[2:], wrong])
    step, state = scipy.linalg.expm(0.2 * system), np.array([0.3, 0.4, 0.0, 0.0])
    rows = [state := step @ state if i else state for i in range(count)]
    return dict(zip("xy", np.array(rows).T, strict=False)), [place, wrong[place], right[place]]


@pytest.mark.parametrize("count", [300, pytest.param(3000, marks=LONG)])
@pytest.mark.parametrize(
    ("term", "value"), [((0, 0), 1.001), ((1, 3), 1.0), pytest.param((1, 3), 0.0, marks=LONG)]
)
def test_a_slip_in_a_formula_is_found_in_the_accelerations(
    term: tuple[int, int], value: float, count: int
) -> None:
    """It is told where no combination of causes describes the rows."""
    columns, (place, wrong, right) = slipped(term, value, count)
    found = told(load_scene("paris"), 0.2 * np.arange(float(count)), columns, 5e-7)
    assert found.words == set() and not found.explanation.causes
    said = found.explanation.slip
    slip = re.search(
        r"in the equation of ([xy]), the term with (\w+) is (\S+) .* the model has (\S+)\.", said
    )
    assert slip is not None
    assert slip[1] == "xy"[place[0]] and slip[2] == ("x", "y", "vx", "vy")[place[1]]
    assert float(slip[3]) == pytest.approx(wrong, rel=2e-3, abs=1e-7)
    assert float(slip[4].removesuffix("/s²").removesuffix("1/s")) == pytest.approx(right, rel=2e-3)
    assert ("does work" in said) is (place != (0, 0))


def test_a_slip_in_a_closed_formula_is_found_in_its_coefficients() -> None:
    """Of a linear motion released at rest against the stars, x has a sine where its formula has a cosine."""
    scene, times = load_scene("paris", ["inputs=binary64"]), 3.0 * np.arange(400.0)
    day = 2 * np.pi / 86400
    beta = day * np.sin(np.radians(float(scene.exact.latitude)))
    omega = np.sqrt(float(scene.exact.gravity) / float(scene.exact.length) + beta**2)
    cos, sin = np.cos(omega * times), np.sin(omega * times)
    turned = np.exp(-1j * beta * times)
    x, y = (
        0.3 * cos * turned.real - 0.4 * sin * turned.imag,
        0.3 * cos * turned.imag + 0.4 * cos * turned.real,
    )
    found = told(scene, times, {"x": x, "y": y}, 5e-7)
    assert found.words == {"linear_g", "no_centrifugal", "solar_day", "inertial_rest"}
    said = found.explanation.slip
    assert said.startswith("It follows a closed formula with a slip: ")
    assert "in the formula of x, sin ωt sin βt has 0.4 m where the model has 0 m" in said


def test_rows_too_far_apart_for_their_own_motion_tell_no_slip() -> None:
    """Ten seconds from row to row, which the clock counts as a sixth of a second: a bob that turns back each time."""
    scene, seconds = load_scene("paris", ["inputs=binary64"]), 10.0 * np.arange(361)
    columns = dict(zip("xy", trajectory(scene, seconds).T, strict=False))
    found = told(scene, seconds / 60, columns, 7e-7)
    assert not found.agrees and found.explanation.slip == ""


def test_in_a_straight_swing_no_term_is_named_that_another_one_replaces() -> None:
    """Where y = 1.5 x, a term with x in the equation of y does what one with y does: the length alone is wrong."""
    scene = load_scene(
        "paris",
        ["pendulum.length=1", "site.rotation_rate=0", "release.x=0.01", "release.y=0.015"],
    )
    times = 0.1 * np.arange(300)
    swing = np.cos(np.sqrt(9.80665 / 1.006) * times)
    found = told(scene, times, {"x": 0.01 * swing, "y": 0.015 * swing}, 2e-8)
    assert not found.agrees and found.explanation.slip == ""


def test_a_term_that_no_other_one_replaces_is_named() -> None:
    """An ellipse whose y swings too slowly: the term with y in its equation, and no other."""
    right = float(np.sqrt(9.80665))
    pushed = f"release.vy={0.004 * 0.99 * right!r}"
    scene = load_scene(
        "paris",
        ["pendulum.length=1", "site.rotation_rate=0", "release.x=0.01", "release.y=0", pushed],
    )
    times = 0.1 * np.arange(300)
    columns = [0.01 * np.cos(right * times), 0.004 * np.sin(0.99 * right * times)]
    found = told(scene, times, dict(zip("xy", columns, strict=True)), 1e-8)
    assert "in the equation of y, the term with y" in found.explanation.slip
    assert "equation of x" not in found.explanation.slip
