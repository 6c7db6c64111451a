"""The page's script judges as `foucault score` does: the same file, the same numbers, the same refusals (Node.js)."""

from __future__ import annotations

import json
import re
import shutil
import subprocess

import numpy as np
import pytest
from dropped import csv, trajectories
from page_motion import node

import reference
from compare import judge
from compare.candidates.names import meaning
from compare.candidates.read import read, read_transits
from compare.diagnosis.conventions import AXES_SAID, LENGTHS_SAID, TIMES_SAID
from compare.report.atlas.parts import golden_function, page_data, plain, vocabulary
from compare.report.atlas.scripts import WORKERS, source
from reference import InputError

pytestmark = pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not installed")

RUN = """
const { truth, words, cases, headers } = JSON.parse(require("fs").readFileSync(0, "utf8"));
const known = unpacked(truth);
const told = cases.map(({ text, times, tolerance }) => {
  try {
    const candidate = text === null ? { columns: null, notes: [] } : readTrajectory(text, words);
    candidate.transits = times === null ? candidate.transits ?? null : readTransits(times, words).transits;
    const result = judge(candidate, known, tolerance);
    if (result.path) delete result.path.errors;
    return result;
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    return { refused: error.message };
  }
});
console.log(JSON.stringify({ told, meanings: headers.map((word) => meaning(word, words) ?? null) }));
"""


def run(golden, cases=(), headers=()):
    """Run the script on cases of (trajectory or None, transits or None, tolerance or None)."""
    script = "".join(map(source, WORKERS["judging"])) + RUN
    asked = [
        {"text": text, "times": times, "tolerance": tolerance} for text, times, tolerance in cases
    ]
    truth = page_data(golden, golden_function(golden))
    document = {"truth": truth, "words": truth["words"], "cases": asked, "headers": list(headers)}
    return node(script, document)


def printed(numbers):
    """Return numbers as the page prints them."""
    script = (
        source("drawing.js")
        + 'console.log(JSON.stringify(JSON.parse(require("fs").readFileSync(0)).map(small)));'
    )
    return node(script, numbers)


def test_a_number_of_the_page_is_its_value_to_three_digits():
    """A zero of an exponent or of a whole number stays."""
    assert printed([2.5649e-10, 1e-20, 0.3001, 0.0, 100.0, 250.0]) == [
        "2.56e-10",
        "1e-20",
        "0.3",
        "0",
        "100",
        "250",
    ]
    powers = [float(f"1e{k}") for k in range(-40, 7)]
    errors = [float(f"2.56e{k}") for k in range(-40, 7)]
    numbers = [*powers, *errors, *(-number for number in errors)]
    assert [float(text) for text in printed(numbers)] == numbers


def pictured(errors, tolerance=1e-6, bound=2e-14):
    """Return the texts in the picture of errors at whole seconds, and the heights of its points."""
    script = (
        source("drawing.js")
        + 'console.log(JSON.stringify(errorPicture(JSON.parse(require("fs").readFileSync(0)), 640, "bound")));'
    )
    points = [[float(t), error] for t, error in enumerate(errors)]
    path = {"covered_s": [0.0, points[-1][0]]}
    result = {"points": points, "path": path, "tolerance_m": tolerance, "bound_m": bound}
    svg = node(script, result)
    line = re.search(r'class="error" d="(.*?)"', svg)[1]
    heights = [float(place.split()[1]) for place in re.split("[ML]", line)[1:]]
    return re.findall(r"<text[^>]*>(.*?)</text>", svg), heights


def test_the_picture_of_errors_has_titles_with_units_and_begins_at_the_decade_of_its_data():
    # the release is right, and its error of rounding is no reason for a longer axis
    words, heights = pictured([1e-17, 4e-4, 3e-3, 2e-2])
    assert {"position error in m", "t in s", "tolerance"} <= {*words} and "bound" not in words
    assert {"10⁻⁶", "10⁻¹"} <= {*words} and "10⁻¹⁶" not in words
    assert heights == sorted(heights, reverse=True) and heights[0] > heights[1]
    # errors as small as the bound of the truth are shown beside it
    words, _ = pictured([0.0, 5e-15, 3e-14, 4e-10])
    assert {"10⁻¹⁴", "bound", "tolerance"} <= {*words} and "10⁻¹⁵" not in words


@pytest.fixture(scope="module")
def golden():
    return reference.load("paris.binary64")


SAME = ("max_error_m", "rms_error_m", "end_error_m", "covered")


@pytest.fixture(scope="module", params=["paris.binary64", "paris"], ids=["function", "rows"])
def reading(request):
    """Paris with its golden function, and the reading of it that has rows alone."""
    golden = reference.load(request.param)
    assert (golden.function is None) == (request.param == "paris")
    return golden


WITH_ROWS = {
    "right",
    "wrong",
    "minutes",
    "late",
    "clock_of_steps",
}  # of the files that the function judges in every run


def test_trajectories_are_judged_as_score_does(reading, tmp_path, size):
    golden = reading
    texts = trajectories(golden)
    if golden.function is None:
        texts = {name: texts[name] for name in size(WITH_ROWS, texts)}
    told = run(golden, [(text, None, None) for text in texts.values()])["told"]
    for (name, text), mine in zip(texts.items(), told, strict=True):
        path = tmp_path / f"{name}.csv"
        path.write_text(text)
        score = judge(path, "paris", inputs=golden.scene.inputs, explain=False)
        assert mine["verdict"] == score.verdict, name
        if name == "minutes" and not golden.function:
            continue  # most of its rows are not at golden times
        expected = (score.errors.max_m, score.errors.rms_m, score.errors.end_m, score.covered)
        assert [mine["path"][key] for key in SAME] == pytest.approx(
            expected, rel=1e-5, abs=3e-14
        ), name
        assert mine["amplitude_m"] == pytest.approx(score.errors.amplitude_m, rel=1e-12), name
        # at the rounding of doubles the bounds differ: score knows the truth to more
        if score.errors.max_m > 2e-14:
            assert mine["path"]["digits"] == pytest.approx(score.errors.digits, rel=1e-5), name
        assert mine["tolerance_m"] == pytest.approx(score.tolerance_m, rel=1e-12)
        if score.verdict == "disagrees":
            assert (mine["path"]["worst"]["t"], mine["path"]["worst"]["component"]) == score.worst[
                :2
            ], name
    verdicts = {name: mine["verdict"] for name, mine in zip(texts, told, strict=True)}
    found = {name: mine["notes"] for name, mine in zip(texts, told, strict=True)}
    assert {name for name, word in verdicts.items() if word == "disagrees"} == {"wrong", *SAID} & {
        *texts
    }
    for name, text in SAID.items():
        if name not in texts:
            continue
        *_, said = found[name]
        about, left = re.fullmatch(r"(.*): corrected, the error is (\S+) m\.", said).groups()
        assert about == text and float(left) <= most_left(golden, name), said
    assert found["wrong"] == [] == found["right"]


SAID = {  # of a wrong file, in the words of compare/diagnosis
    "exchanged": f"Your file {AXES_SAID[(1, 0), (1, 1)][1]}",
    "turned": f"Your file {AXES_SAID[(1, 0), (-1, 1)][1]}",
    "centimetres": f"Your file {LENGTHS_SAID['cm']}",
    "millimetres_west": f"Your file {LENGTHS_SAID['mm']}, and it {AXES_SAID[(0, 1), (-1, 1)][1]}",
    "minutes": f"Your file {TIMES_SAID['min']}",
    "late": "Your clock is 0.01000 s slow",
}
ROUNDINGS = {
    "exchanged": 0,
    "turned": 0,
    "centimetres": 3,
    "millimetres_west": 3,
    "minutes": 2,
    "late": 3,
}


def most_left(golden, name):
    """The most in m that a file put right is from what the page holds it against: each term is a known bound.

    The rows of the file are the golden doubles. Held against the same doubles nothing is left but the roundings of the
    file's own arithmetic (of a unit there and back, of a time that moves the bob by its speed). The golden function is
    within its proven bound of the truth, and a golden double within half a unit in the last place.
    """
    rounding = 2.0**-53
    size, speed = (
        float(np.hypot(*(golden.grid[one] for one in pair)).max())
        for pair in (("x", "y"), ("vx", "vy"))
    )
    own = ROUNDINGS[name] * rounding * (speed * golden.t[-1] if name == "minutes" else size)
    if golden.function is None:
        return own
    return own + np.hypot(golden.function.bound["x"], golden.function.bound["y"]) + rounding * size


def test_the_page_says_how_it_read_a_file_as_score_does(golden, tmp_path):
    t, x, y = (golden.grid[name][:3] for name in ("t", "x", "y"))
    more = {
        "german": csv(
            "Zeit [min]; x [cm]; Nord (mm); Bild", t / 60, 100 * x, 1000 * y, t, separator=";"
        ).replace(".", ","),
        "table": csv("t x y", t, x, y, separator="\t"),
        "quoted": csv('"time (ms)","position x","south","step","-"', 1000 * t, x, -y, t, t),
    }
    texts = trajectories(golden) | more
    for (name, text), mine in zip(
        texts.items(),
        run(golden, [(text, None, None) for text in texts.values()])["told"],
        strict=True,
    ):
        path = tmp_path / f"{name}.csv"
        path.write_text(text)
        wanted = [
            convention.text.partition(" (--columns")[0] for convention in read(path).conventions
        ]
        assert [note for note in mine["notes"] if note[:4] == "Read"] == [
            f"Reading: {text}." for text in wanted
        ], name
        assert not (name in more and name != "table") or len(wanted) >= 2


def test_transits_are_matched_as_score_does(golden, tmp_path):
    t = golden.transits["t"]
    near = t + 1e-9 * np.sin(t)
    cases = {
        "right": near,
        "missing": np.delete(near, 4711),
        "added": np.sort(np.append(near, [t[77] + 1.0, 3600.5])),
        "doubled": np.sort(np.append(near, near[9])),
        "shifted": near + 0.01,
        "one_late": np.sort(np.where(np.arange(len(t)) == 500, near + 1e-3, near)),
        "nearly_all_early": near[:-3],
    }
    wanted, questions = [], []
    for name, times in cases.items():
        path = tmp_path / f"{name}.csv"
        path.write_text(csv("t", times))
        wanted.append(judge(None, "paris", transits=read_transits(path), explain=False))
        questions.append((None, path.read_text(), None))
    for name, score, mine in zip(cases, wanted, run(golden, questions)["told"], strict=True):
        assert mine["verdict"] == score.verdict, name
        found, expected = mine["transits"], score.transits
        assert found["matched"] == expected.matched, name
        assert found["missed"] == expected.missed and found["extra"] == expected.extra, name
        sizes = expected.max_error_s, expected.max_conditioned_m
        assert [found["max_error_s"], found["max_conditioned_error_m"]] == pytest.approx(
            sizes, rel=1e-9
        ), name


ROW = "0,0.3,0.4\n"
REFUSED = {  # and what the page says
    "t,x,y\n0,0.3,0.4\n60,0.1\n": "Line 3 has 2 fields, and the first row has 3",
    "t,x,y\n0,0.3,0.4\n60,0.1,o.2\n": "Line 3: o.2 is no number (y)",
    "t,x,y\n0,0.3,0.4\n60,nan,0.1\n": "Line 3: x is nan",
    "t,x,y\n60,0.3,0.4\n0,0.1,0.1\n": "Times have to increase",
    "t,x,y\n-1,0.3,0.4\n": "times begin at 0",
    "t,x\n0,0.3\n": "There is no column y in t, x",
    "t,x,y,x\n0,0.3,0.4,1\n": "Two columns are x",
    "t (lightyears),x,y\n" + ROW: "The unit lightyears of t is not known",
    "t,x,y,z\n" + ROW: "The first row has 3 fields, and the header in line 1 has 4",
    "0,1,2,3,4\n": "No line names the columns",
    "t,x,y\n": "There are no rows",
    "": "There are no rows",
    "\0\1": "This is no text",
    "t,x,y\n0,0.3,0.4\n60000000,0.1,0.1\n": "They look like milliseconds",
}


def test_what_score_refuses_the_page_refuses(golden, tmp_path):
    told = run(golden, [(text, None, None) for text in REFUSED])["told"]
    for (text, said), mine in zip(REFUSED.items(), told, strict=True):
        assert said in mine.get("refused", ""), (text, mine)
        path = tmp_path / "mine.csv"
        path.write_text(text)
        with pytest.raises(InputError):
            judge(read(path), "paris", explain=False)


def between_golden_times(golden):
    t, x, y = (golden.grid[name][:50] for name in ("t", "x", "y"))
    return (
        csv("t,x,y", t + t[1] / 120, x, y),
        csv("t,x,y", t**1.01, x, y),
        csv("t,x,y", t / 2, x, y),
    )


@pytest.mark.parametrize(("name", "shift"), [("paris", "0.500"), ("creeping", "0.00333")])
def test_rows_between_the_golden_times_are_no_verdict_but_a_message(name, shift):
    """Of datasets that have no golden function: the page knows the truth at the golden times alone."""
    golden = reference.load(name)
    assert golden.function is None
    shifted, between, some = between_golden_times(golden)
    told = run(golden, [(shifted, None, None), (between, None, None), (some, None, 10.0)])["told"]
    assert f"All are {shift} s after one: is the clock shifted?" in told[0]["refused"]
    assert (
        "No row after t = 0 is at a golden time" in told[1]["refused"]
        and "clock" not in told[1]["refused"]
    )
    assert told[2]["path"]["rows"] == 25 and told[2]["notes"] == [
        "25 of 50 rows are not at golden times and were not judged."
    ]


def test_rows_between_the_golden_times_are_judged_by_the_shipped_function(golden, tmp_path):
    texts = between_golden_times(golden)
    asked = [
        (text, None, tolerance) for text, tolerance in zip(texts, (None, None, 10.0), strict=True)
    ]
    for (text, _, tolerance), mine in zip(asked, run(golden, asked)["told"], strict=True):
        path = tmp_path / "mine.csv"
        path.write_text(text)
        score = judge(path, "paris", tolerance=tolerance, explain=False)
        assert mine["verdict"] == score.verdict == ("agrees" if tolerance else "disagrees")
        assert mine["at_any_time"] and mine["path"]["rows"] == 50
        expected = (score.errors.max_m, score.errors.rms_m, score.errors.end_m, score.covered)
        assert [mine["path"][key] for key in SAME] == pytest.approx(expected, rel=1e-5)


HEADERS = """
t T time Time zeit t_s t[ms] time(ms) seconds ms time/h t_min elapsed_time x X x_m x/m "x" 'pos_x' x(t) X(cm) east west
north SOUTH up down nord_m vx v_x vX xdot x_dot dx/dt ẋ x' vx[cm/s] vx_mm_per_s speed_x v_east north_velocity mps
vx_kmh vx(m/s) vx[m*s^-1] x[furlong] phi lambda step e x_in y_ft z_um xx xy t_x x_t displacement_north r_x bob_y -
vz_ms x(µm) vy[µm/s] x..m x__cm (x) []
"""


def test_headers_mean_what_they_mean_to_score(golden):
    headers = [*HEADERS.split(), "position x", "time in ms", " x / cm ", "", f"x{' ' * 100}(m)"]
    found = run(golden, headers=headers)["meanings"]
    for word, mine in zip(headers, found, strict=True):
        one = meaning(word, {})
        assert (mine is None) == (one is None), word
        if one is not None:
            factor = mine.get("factor") and mine["factor"][0] / mine["factor"][1]
            assert (mine["column"], mine["rank"]) == (one.column, one.rank), word
            assert factor == (None if one.factor is None else float(one.factor)), word


@pytest.fixture(scope="module", params=["paris", "hard"])
def at_any_time(request, tmp_path_factory):
    """A scene and a dataset of it that has a golden function: z from the sphere, and z as a series."""
    pytest.importorskip("flint")
    scene = reference.load_scene(request.param, ["inputs=binary64", "run.t_end=600"])
    if scene.id == "hard":  # which ships as it is wanted; of paris a day does
        return scene, reference.load("hard.binary64")
    short = scene.with_values(["run.digits=12"])
    solution = reference.solve(short, level="enclosed", engine="limbs", function=True)
    return scene, reference.load(
        reference.write(solution, tmp_path_factory.mktemp("function") / scene.id)
    )


def odd_files(golden):
    """Files at times of no grid: right and wrong ones, and such as begin late, end early or have one row."""
    t = np.sort(np.random.default_rng(34).uniform(0, 600, 997))
    at = golden.at(t)
    x, y, z = at.x, at.y, at.z
    size = float(np.hypot(golden.x, golden.y).max())
    wave = np.sin(7 * t)
    return {
        "exact": csv("t,x,y,z,vx,vy,vz", t, x, y, z, at.vx, at.vy, at.vz),
        "in_order": csv("t,x,y,z", t, x + 3e-7 * size * wave, y, z),
        "just_within": csv("t,x,y", t, x + 0.999e-6 * size * np.sign(wave), y),
        "just_beyond": csv("t,x,y", t, x + 1.001e-6 * size * (0.5 + t / t[-1] / 2), y),
        "grows": csv("t,x,y", t, x, y + 1e-5 * size * t / 600),
        "height": csv("t,x,y,z", t, x, y, z + 2e-6 * size * t / 600),
        "exchanged": csv("t,x,y", t, y, x),
        "west": csv("t,x,y", t, -x, y),
        "centimetres": csv("t,x,y", t, 100 * x, 100 * y),
        "minutes": csv("t,x,y", t / 60, x, y),
        "units": csv("time (ms),x (mm),y (cm)", 1000 * t, 1000 * x, 100 * (y + 1e-7 * size)),
        "late": csv(
            "t,x,y", t, *(np.array(part) for part in (golden.at(t * (1 - 1e-9)).x, golden.at(t).y))
        ),
        "small": csv("t,x,y", t, 3e-3 * x, 3e-3 * y),
        "one_row": csv("t,x,y", t[500:501], x[500:501], y[500:501]),
        "late_begin": csv("t,x,y", t[900:], x[900:] + 1e-9, y[900:]),
        "early_end": csv("t,x,y", t[:90], x[:90] + 2e-6 * size * (1 + t[:90]), y[:90]),
    }


SAID_AT_ODD_TIMES = {"exchanged", "west", "centimetres", "minutes", "small"}


def test_rows_at_any_times_are_judged_as_score_does(at_any_time, tmp_path):
    """The truth of `score` comes from the rows that ship, that of the page from a golden function."""
    scene, golden = at_any_time
    texts = odd_files(golden)
    # paris ships with a day of rows, and so with another amplitude than ten minutes of it have
    tolerance = None if scene.id == "hard" else 1e-6 * float(np.hypot(golden.x, golden.y).max())
    told = run(golden, [(text, None, tolerance) for text in texts.values()])["told"]
    verdicts = {}
    for (name, text), mine in zip(texts.items(), told, strict=True):
        path = tmp_path / f"{name}.csv"
        path.write_text(text)
        score = judge(path, scene, tolerance=tolerance, explain=False)
        verdicts[name] = mine["verdict"]
        assert mine["verdict"] == score.verdict and mine["at_any_time"], name
        assert mine["path"]["rows"] == len(text.splitlines()) - 1
        expected = (score.errors.max_m, score.errors.rms_m, score.errors.end_m, score.covered)
        known = 1e-14 * float(golden.scene.exact.length)
        assert [mine["path"][key] for key in SAME] == pytest.approx(
            expected, rel=1e-5, abs=known
        ), name
        assert mine["tolerance_m"] == pytest.approx(score.tolerance_m, rel=1e-12), name
        if score.verdict == "disagrees":
            assert tolerance or mine["path"]["digits"] == pytest.approx(
                score.errors.digits, rel=1e-5
            ), name
            assert mine["path"]["worst"]["t"] == score.worst[0], name
            assert name == "exchanged" or mine["path"]["worst"]["component"] == score.worst[1], name
        said = [note for note in mine["notes"] if note.startswith("Your file")]
        assert bool(said) == (name in SAID_AT_ODD_TIMES), (name, said)
    right = {"exact", "in_order", "just_within", "units", "one_row", "late_begin"}
    assert {name for name, word in verdicts.items() if word == "agrees"} >= right
    assert {"just_beyond", "grows", "height", "early_end", *SAID_AT_ODD_TIMES} <= {
        name for name, word in verdicts.items() if word == "disagrees"
    }


def test_the_bound_is_that_of_the_columns_of_the_file(at_any_time):
    """The height of a 67 m pendulum is known to 2e-14 m, x and y to 2e-15: a nanometre's swing is judged by these."""
    _, golden = at_any_time
    t = np.linspace(0.5, 9.5, 20)
    at, bound = golden.at(t), golden.function.bound
    plane, sphere = csv("t,x,y", t, at.x, at.y), csv("t,x,y,z", t, at.x, at.y, at.z)
    told = run(golden, [(plane, None, None), (sphere, None, None)])["told"]
    flat = np.hypot(bound["x"], bound["y"])
    assert [one["bound_m"] for one in told] == pytest.approx(
        [flat, np.hypot(flat, bound["z"])], rel=1e-12
    )


def test_an_extra_transit_is_excused_by_xdot_as_score_does(at_any_time, tmp_path):
    scene, golden = at_any_time
    times = golden.transits["t"]
    size = float(np.hypot(golden.x, golden.y).max())
    # of the position, for an error of the time
    rate = np.abs(golden.transits["ax"]) / page_data(golden)["omega"]
    cases = {
        "two_within": np.sort([*times, times[3] + 0.5e-6 * size / rate[3]]),
        "two_beyond": np.sort([*times, times[3] + 2e-6 * size / rate[3]]),
    }
    texts = {name: csv("t", of) for name, of in cases.items()}
    told = run(golden, [(None, text, None) for text in texts.values()])["told"]
    for (name, text), mine in zip(texts.items(), told, strict=True):
        path = tmp_path / f"{name}.csv"
        path.write_text(text)
        score = judge(None, scene, transits=read_transits(path), explain=False)
        assert (
            mine["verdict"] == score.verdict == ("agrees" if name == "two_within" else "disagrees")
        ), name
        assert mine["transits"]["extra"] == score.transits.extra, name


def test_clocks_and_ends_of_runs_are_taken_as_score_takes_them(golden, tmp_path):
    """A clock that began in 1970 is counted from the release, if it is there; an event at the end of a run is extra."""
    t, x, y = (golden.grid[name][:6] for name in ("t", "x", "y"))
    zeros = golden.transits["t"][golden.transits["t"] < t[-1]]
    since_1970 = csv("t,x,y", t + 1760000000.0, x, y)
    late = csv("t,x,y", t[1:] + 1760000000.0, x[1:], y[1:])
    rows, ended = csv("t,x,y", t, x, y), csv("t", np.append(zeros, t[-1]))
    asked = [
        (since_1970, None, None),
        (late, None, None),
        (rows, ended, None),
        (rows, csv("t", zeros), None),
    ]
    counted, refused, extra, right = run(golden, asked)["told"]
    path, transits = tmp_path / "mine.csv", tmp_path / "zeros.csv"
    path.write_text(since_1970)
    score = judge(path, "paris", explain=False)
    assert counted["verdict"] == score.verdict == "agrees"
    assert [f"Reading: {one.text}." for one in score.candidate.conventions] == counted["notes"]
    path.write_text(late)
    with pytest.raises(InputError, match="Subtract what the clock showed at the release"):
        judge(path, "paris", explain=False)
    assert "Subtract what the clock showed at the release" in refused["refused"]
    path.write_text(rows)
    transits.write_text(ended)
    score = judge(path, "paris", transits=read_transits(transits), explain=False)
    assert extra["transits"]["extra"] == score.transits.extra == [t[-1]]
    assert extra["verdict"] == score.verdict == "disagrees" and right["verdict"] == "agrees"


@pytest.mark.parametrize(
    ("name", "text", "of_transits"),
    [
        ("mine.csv", "t,x,y\n0,0.3,0.4\n60,-0.1,-0.4\n", False),
        ("mine.csv", "0,0.3,0.4\n60,-0.1,-0.4\n", False),
        ("mine.csv", "t,x\n0,0.3\n60,-0.1\n", False),  # a trajectory that lacks y, and is told so
        ("mine.csv", "t\n8.2\n16.4\n", True),
        ("mine.csv", "t,k\n8.2,1\n16.4,2\n", True),
        ("my_transits.csv", "t,x,y\n8.2,0.3,0.4\n16.4,-0.1,-0.4\n", True),
    ],
)
def test_a_dropped_file_is_a_trajectory_if_it_has_positions_and_else_transits(
    name, text, of_transits
):
    script = "".join(map(source, ("reading.js", "answering.js")))
    script += """
const { file, words } = JSON.parse(require("fs").readFileSync(0, "utf8"));
console.log(isOfTransits(file, words));
"""
    document = {"file": {"name": name, "text": text}, "words": vocabulary()}
    done = subprocess.run(
        ["node", "-e", script],
        input=json.dumps(document, default=plain),
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == str(of_transits).lower()
