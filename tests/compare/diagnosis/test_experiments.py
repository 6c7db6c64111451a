"""Experiments: programs in three languages whose one file does not tell their mistake, run again with other numbers."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from ambiguous import GIVEN, MISTAKES, Ambiguous, ambiguous, drawn, words_said
from places import MISTAKEN_C, ROOT

from compare.candidates.external import placeholders
from reference import load_scene

SCHEMA = json.loads(files("compare.report").joinpath("score.schema.json").read_text("utf-8"))
# of the programs: in JavaScript, in C with {setting}, and in Python
FEW = (17, 33, 40)
SEEDS = (101, 102, 103)
RTOL = 1e-6  # {setting} of programs that take a tolerance
SHORT = (
    "--t-end",
    "120",
    "--set",
    "run.grid_step=1",
    "--set",
    "run.transits=false",
    "--repeats",
    "0",
)
MOST_RUNS = 10  # of a program, beside the first
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="module", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FOUCAULT_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def mistaken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    compiler, target = shutil.which("cc"), tmp_path_factory.mktemp("programs") / "mistaken"
    if compiler is None:
        pytest.skip("no C compiler")
    subprocess.run([compiler, "-O2", "-o", str(target), str(MISTAKEN_C), "-lm"], check=True)
    return target


def measured(foucault: Run, made: Ambiguous) -> dict[str, Any] | None:
    """Return what experiments with a program measure; None if it agrees."""
    words = [
        "score",
        "paris",
        *made.settings,
        "--run",
        made.command,
        "--repeats",
        "0",
        "--timeout",
        "300",
    ]
    words += ["--setting", str(RTOL)] if "rtol" in made.command else []
    status, out, err = foucault(*words, "--experiments", "--json")
    assert status in (0, 1), err
    found: dict[str, Any] | None = json.loads(out).get("experiments")
    return found


def test_every_cause_of_ambiguous_programs_is_measured_and_none_is_wrong(
    foucault: Run, mistaken: Path, size: Callable[[Any, Any], Any], tally: Callable[[str], None]
) -> None:
    node = shutil.which("node")
    numbers = list(size(FEW, range(len(MISTAKES))))
    programs = {number: ambiguous(number, mistaken, node or "") for number in numbers}
    skipped = [
        number
        for number, made in programs.items()
        if made.language == "JavaScript" and node is None
    ]
    wrong, missed, runs, languages = {}, [], [], []
    before = sum(os.times()[:4])
    for number, made in programs.items():
        if number in skipped:
            continue
        found = measured(foucault, made)
        assert found is not None
        said = [words_said(set(ids)) for ids in found["measured"]]
        if any(words - made.true for words in said):
            wrong[number] = said
        if {frozenset(words) for words in said} != {made.true}:
            missed.append(number)
        runs.append(len(found["runs"]))
        languages.append(made.language)
    spent = sum(os.times()[:4]) - before
    counts = ", ".join(f"{languages.count(word)} in {word}" for word in sorted(set(languages)))
    tally(
        f"experiments: {len(runs) - len(missed)} of {len(runs)} programs named ({counts}), {len(wrong)} wrong, "
        f"{sum(runs) / len(runs):.1f} runs each, {max(runs)} at most, {spent:.0f} CPU s; no Node.js for {len(skipped)}"
    )
    assert (wrong, missed) == ({}, [])
    assert max(runs) <= MOST_RUNS


@pytest.mark.long
@pytest.mark.parametrize("seed", SEEDS)
def test_no_program_drawn_at_random_is_told_a_wrong_cause(
    foucault: Run, mistaken: Path, seed: int, tally: Callable[[str], None]
) -> None:
    node, wrong, named, judged = shutil.which("node"), {}, 0, 0
    mistakes = list(drawn(seed, len(MISTAKES)))
    for number in range(len(mistakes)):
        made = ambiguous(number, mistaken, node or "", mistakes)
        found = None if made.language == "JavaScript" and node is None else measured(foucault, made)
        if found is None:  # within the tolerance
            continue
        said = [words_said(set(ids)) for ids in found["measured"]]
        judged, named = judged + 1, named + ({frozenset(words) for words in said} == {made.true})
        # of several that cannot be told apart one has to be true: in a plane g and the length are one number
        if said and not any(words <= made.true for words in said):
            wrong[number] = mistakes[number], said
    tally(f"experiments of seed {seed}: {named} of {judged} programs named, {len(wrong)} wrong")
    assert wrong == {}


def command(program: list[str], *words: str) -> str:
    return " ".join(
        [shlex.join(program), *(f"{key}={value}" for key, value in GIVEN.items()), *words]
    )


def test_what_is_measured_is_told_and_kept(foucault: Run, mistaken: Path, tmp_path: Path) -> None:
    out = tmp_path / "runs"
    words = (
        "score",
        "paris",
        *SHORT,
        "--run",
        command([str(mistaken)], "lat=48.5"),
        "--experiments",
        "--out",
        out,
    )
    status, text, _ = foucault(*words)
    assert status == 1
    assert (
        "no rotation (site.rotation_rate = 0)" in text
        and "what is wrong is in what the rotation does" in text
    )
    assert "Measured: one explanation makes the 3 files" in text
    found = re.search(
        r"your program takes site.latitude to be (\S+) and not 48.846111 degrees: ", text
    )
    assert found is not None and float(found[1]) == pytest.approx(48.5, abs=1e-6)
    status, text, _ = foucault(*words, "--json")  # into the same folder
    document = json.loads(text)
    jsonschema.validate(document, SCHEMA)
    found = document["experiments"]
    assert json.loads((out / "experiments.json").read_text()) == found
    assert found["measured"] == [["site.latitude"]] == [[one["id"] for one in document["causes"]]]
    kept = {path.stem for path in out.glob("*.txt")}
    assert kept == {"as_given", *(run["id"] for run in found["runs"])}
    assert all((out / f"{word}.txt").read_text().startswith("t,x,y,z\n0,0.") for word in kept)


def test_a_number_in_proportion_is_told_from_one_that_is_typed(
    foucault: Run, mistaken: Path
) -> None:
    for words, said in (
        ("gtimes=1.001", "in proportion to what it is given"),
        ("g=9.8165", "whatever it is given"),
    ):
        text = foucault(
            "score", "paris", *SHORT, "--run", command([str(mistaken)], words), "--experiments"
        )[1]
        found = re.search(r"takes site.gravity to be (\S+) and not 9.80665 m/s², (.*): ", text)
        assert (
            found is not None
            and float(found[1]) == pytest.approx(9.8165, abs=1e-3)
            and found[2] == said
        )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("g=9.81",), "computes with g = 9.81 m/s²"),
        (("g=9.81", "l=20"), "computes with g = 9.81 m/s²"),
    ],
)
def test_a_typed_number_is_found_in_rows_that_are_half_a_swing_apart(
    foucault: Run, mistaken: Path, words: tuple[str, ...], said: str
) -> None:
    """With a quarter of g, which the program ignores, a slower swing would have the same phases in every row."""
    sparse = ("--set", "run.grid_step=5", "--set", "run.transits=false", "--t-end", "600")
    run = command([str(mistaken)], "reading=2", *words)
    text = foucault("score", "museum", *sparse, "--run", run, "--experiments", "--repeats", "0")[1]
    assert "Measured: one explanation makes the " in text
    assert f"It seems that your program {said}: off by " in text


def test_a_program_that_fails_or_is_killed_draws_no_conclusion(
    foucault: Run, tmp_path: Path
) -> None:
    source = tmp_path / "fails.py"
    inner = (ROOT / "tests/helpers/mistaken.py").read_text()
    source.write_text(
        inner.replace(
            "\nrows, h = ", "\nassert turn and given('lat', 0) < 90, 'no pole'\nrows, h = "
        )
    )
    run = command([sys.executable, str(source)], "lat=48.5")
    run = run.replace(" lat=48.5", " lat=48.5 lat={latitude} ratetimes=1.01").replace(
        "h=0.01", "h=0.05"
    )
    document = json.loads(
        foucault("score", "paris", *SHORT, "--run", run, "--experiments", "--json")[1]
    )
    runs = {one["id"]: one for one in document["experiments"]["runs"]}
    assert runs["no_rotation"]["max_error_m"] is None
    assert "nothing follows" in runs["no_rotation"]["conclusion"]


def test_a_mistake_that_nobody_knows_has_no_name(
    foucault: Run, tmp_path: Path, size: Callable[[Any, Any], Any]
) -> None:
    """A cord that pulls harder the farther the bob is out, which is no cause of the list.

    For ten rows fewer readings have to be tried.
    """
    t_end, grid_step = size(("18", "2"), ("120", "1"))
    fields = [f"run.t_end={t_end}", f"run.grid_step={grid_step}", "run.transits=false"]
    source = tmp_path / "hard.py"
    inner = (ROOT / "tests/helpers/mistaken.py").read_text()
    source.write_text(
        inner.replace(
            "    pull = (", "    fx, fy = fx - 0.02 * x**3, fy - 0.02 * y**3\n    pull = ("
        )
    )
    run = command([sys.executable, str(source)]).replace("h=0.01", "h=0.05")
    for word in ("length", "latitude", "x0", "y0", "vx0", "vy0", "t_end"):  # two runs are enough
        run = run.replace(f"{{{word}}}", placeholders(load_scene("paris", fields))[word])
    words = [
        "--t-end",
        t_end,
        *(part for field in fields for part in ("--set", field)),
        "--repeats",
        "0",
    ]
    document = json.loads(
        foucault("score", "paris", *words, "--run", run, "--experiments", "--json")[1]
    )
    assert document["experiments"]["runs"] and document["experiments"]["measured"] == []
    assert document["causes"] == [] and document["diagnosis"] is None


STUCK = """
import subprocess, sys
lines = subprocess.run(sys.argv[1:], capture_output=True, text=True).stdout.split()
rows = [line.split(",")[:3] for line in lines]
for row in rows[102:]:
    row[1] = rows[101][1]
print("\\n".join(map(",".join, rows)))
"""


def test_steps_of_which_only_the_first_rows_are_right_are_not_measured(
    foucault: Run, mistaken: Path, tmp_path: Path
) -> None:
    """A Runge-Kutta method in 30,000 steps, and an x that is stuck from the 20,000th on, in every run."""
    source = tmp_path / "stuck.py"
    source.write_text(STUCK)
    run = f"{sys.executable} {source} {mistaken} reading=2 x0={{x0}} y0={{y0}} l={{length}} lat={{latitude}}"
    run += " g={gravity} rate={rotation_rate} tend={t_end} out=10 h={setting}"
    words = ["--t-end", "1500", "--repeats", "0", "--setting", "0.05"]
    document = json.loads(
        foucault("score", "museum", *words, "--run", run, "--experiments", "--json")[1]
    )
    assert document["experiments"]["runs"] and document["experiments"]["measured"] == []
    assert document["causes"] == []


LINEAR = """
import math, sys
x, y, l, latitude, g, rate, end, h = map(float, sys.argv[1:])
f = 2 * rate * math.sin(math.radians(latitude))
vx = vy = 0.0
print("t,x,y")
for n in range(round(end / h) + 1):
    if n % round(1 / h) == 0:
        print(f"{n * h!r},{x!r},{y!r}")
    vx += h * (-g / l * x + f * vy)
    vy += h * (-g / l * y - f * vx)
    x += h * vx
    y += h * vy
"""


def test_an_integrator_is_not_at_fault_where_another_step_changes_little_of_the_error(
    foucault: Run, tmp_path: Path
) -> None:
    """A linear model without the centrifugal force, by Euler's method: the step is a hundredth of the error."""
    source = tmp_path / "linear.py"
    source.write_text(LINEAR)
    words = "{x0} {y0} {length} {latitude} {gravity} {rotation_rate} {t_end} {setting}"
    run = shlex.join([sys.executable, str(source)]) + " " + words
    fields = ("run.t_end=20", "run.grid_step=1", "run.transits=false")
    options = [word for field in fields for word in ("--set", field)]
    options += ["--setting", "0.01", "--repeats", "0", "--experiments"]
    _, out, _ = foucault("score", "paris", "--run", run, *options)
    assert "at fault" not in out and "Next: " not in out
    assert "- moves like one that takes g as the effective gravity" in out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--run", "./p {drag}", "--experiments"), "Add {rotation_rate}, {latitude}, {gravity}"),
        (("--run", "./p {x0} {t_end}", "--experiments", "--out", "."), "a new folder"),
        (("--run", "./p", "--setting", "0"), "a positive number of seconds"),
        (("--experiments",), "without --run"),
        (
            ("--run", "./p {length}", "--experiments", "--no-diagnosis"),
            "together with --no-diagnosis",
        ),
    ],
)
def test_experiments_that_cannot_be_made_are_refused(
    foucault: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: tuple[str, ...],
    said: str,
) -> None:
    (tmp_path / "mine.txt").write_text("not yours")
    monkeypatch.chdir(tmp_path)
    status, out, err = foucault("score", "paris", *words)
    assert (status, out) == (2, "") and said in err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_a_program_that_agrees_is_not_run_again(foucault: Run, mistaken: Path) -> None:
    run = command([str(mistaken)])
    status, text, _ = foucault("score", "paris", *SHORT, "--run", run, "--experiments")
    assert status == 0 and "Experiment" not in text


def test_the_usual_step_divides_the_grid(foucault: Run, tmp_path: Path) -> None:
    source, note = tmp_path / "mine.py", tmp_path / "step"
    source.write_text(
        "import sys\nopen(sys.argv[1], 'w').write(sys.argv[2])\nprint('t,x,y')\nprint('0,0.3,0.4')\n"
    )
    run = f"{shlex.join([sys.executable, str(source), str(note)])} {{setting}}"
    assert foucault("score", "paris", *SHORT, "--run", run, "--no-diagnosis")[0] == 1
    step_s = float(note.read_text())
    many = 1.0 / step_s  # steps from row to row
    assert many == pytest.approx(round(many), rel=1e-12) and 16.4 / step_s > 199
