"""Studies: rows of measurements, failures as rows, and the same ranking twice."""

from __future__ import annotations

import doctest
import itertools
import json
import re
import time
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from interruption import interrupted
from sampled import one_in

from compare.methods import METHODS
from compare.methods.rhs.problem import Problem
from compare.report.pareto import front, rows_of
from compare.report.study_tables import transit_error
from compare.studies import users_program
from compare.studies.measure import Bench
from compare.studies.row import GridTruth
from compare.studies.study import plan, study
from compare.studies.study_plan import bits_of, precision_items, precision_scene
from compare.truth import golden_of
from reference import Scene, load_scene, trajectory
from reference.engines.registry import engines

T_END = "600"


@pytest.fixture(scope="module")
def short() -> Scene:
    return load_scene("paris", [f"run.t_end={T_END}", "inputs=binary64"])


@pytest.fixture(scope="module")
def bench(short: Scene) -> Bench:
    return Bench(short, GridTruth(golden_of(short), float(T_END)), 8.0, repeats=1)


def test_the_error_of_rk4_falls_with_the_fourth_power_of_its_step(bench: Bench) -> None:
    rows = [bench.row(METHODS["rk4"], "plane", step) for step in (0.2, 0.1)]
    assert [row.status for row in rows] == ["ok", "ok"]
    assert rows[0].error_m is not None and rows[1].error_m is not None
    assert rows[0].error_m / rows[1].error_m == pytest.approx(16, rel=0.1)
    assert rows[1].rhs_evaluations == 4 * 6000


def test_extended_precision_is_not_measured_in_double(bench: Bench) -> None:
    row = bench.row(METHODS["heyoka_real128"], "momentum", METHODS["heyoka_real128"].ladder[-1])
    assert row.error_m is not None and row.error_m < 1e-27 + float(
        bench.truth.golden.manifest.bounds.position_m
    )
    assert row.h_drift is not None and row.h_drift < 1e-25
    assert (
        row.transit_floor_s is not None
        and max(row.transit_error_s or 0.0, row.transit_floor_s) < 1e-18
    )


def test_a_transit_that_is_missed_makes_a_failed_row(bench: Bench) -> None:
    row = bench.row(METHODS["rk4"], "plane", 4.0)
    assert row.status == "missed_transits"
    assert "transits are missed, the first at t = " in row.reason


def test_a_run_beyond_the_limit_is_extrapolated_and_says_so(short: Scene) -> None:
    slow = Bench(short, GridTruth(golden_of(short), float(T_END)), 1e-3)
    row = slow.row(METHODS["rk4"], "plane", 0.001)
    assert row.status == "extrapolated"
    assert row.reached_t is not None and row.reached_t < 600
    assert row.error_m is None and row.end_error_m is not None
    assert row.reason.startswith("measured to t = ")


@pytest.mark.usefixtures("here")
def test_a_study_is_one_call_and_says_in_a_line_what_it_holds(bench: Bench) -> None:
    assert doctest.testmod(import_module("compare.studies.study")).failed == 0
    row = bench.row(METHODS["rk4"], "plane", 4.0)
    assert repr(row).startswith("Row(rk4 in plane at 4: missed_transits, ")


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("t_end", one_in(2, [10.0, 59.0, 100.1, 90.0]))
def test_a_span_that_is_no_multiple_of_the_grid_step_is_measured_to_its_end(t_end: float) -> None:
    result = study("paris", items=[("rk4", "plane", 0.1), ("rk4", "plane", 0.05)], t_end=t_end)
    assert result.t_end == t_end == result.golden.t[-1]
    for row in result.rows:
        assert (row.status, row.reached_t) == ("ok", t_end)
        assert row.steps is not None and row.steps * row.setting == pytest.approx(
            t_end, abs=2 * row.setting
        )
    coarse, fine = (row.error_m for row in result.rows)
    assert coarse is not None and fine is not None and coarse / fine == pytest.approx(16, rel=0.3)


@pytest.mark.usefixtures("here")
def test_the_grid_that_is_asked_for_is_the_one_that_is_measured_on() -> None:
    result = study("paris", items=[("rk4", "plane", 0.1)], t_end=60.0)
    finer = study(
        load_scene("paris", ["run.grid_step=20"]), items=[("rk4", "plane", 0.1)], t_end=60.0
    )
    assert (len(result.golden.t[result.golden.t <= 60]), len(finer.golden.t)) == (2, 4)


@pytest.mark.long
def test_transits_finer_than_two_doubles_are_not_resolved_and_coarser_ones_are(
    bench: Bench,
) -> None:
    fine, coarse = (
        bench.row(METHODS["limbs"], "inertial", 160),
        bench.row(METHODS["heyoka_real128"], "momentum", 1e-20),
    )
    assert (fine.status, fine.transit_error_s) == ("ok", None)
    assert fine.transit_floor_s is not None and 0 < fine.transit_floor_s < 1e-27
    assert transit_error(fine).startswith("<")
    assert coarse.transit_error_s is not None and coarse.transit_error_s > 10 * fine.transit_floor_s


def test_the_floor_of_transits_lies_above_what_many_digits_make_of_it(
    short: Scene, bench: Bench
) -> None:
    """With 200 bits all that is left is the measuring itself, so that it is the floor that is tested."""
    times = np.concatenate([[0.0], bench.truth.transits])
    outcome = METHODS["limbs"].prepare(Problem.of(short, "inertial", times), 200)()
    errors_s, floor_s = bench.truth.transit_errors(short, outcome)
    assert floor_s / 1000 < errors_s.max() <= floor_s


def test_limbs_are_measured_in_the_form_that_the_reference_runs() -> None:
    assert METHODS["limbs"].formulations == (engines()["limbs"].formulation,)
    assert {formulation for formulation, _ in METHODS["limbs"].precision_runs([113])} == {
        engines()["limbs"].formulation
    }


def no_such_number(word: str) -> float:
    raise AssertionError(f"{word} in JSON")


@pytest.mark.usefixtures("here")
def test_json_of_the_shortest_span_has_no_nan(foucault) -> None:
    words = ("study", "paris", "--t-end", "10", "--methods", "rk4", "--no-formulations", "--json")
    status, out, _ = foucault(*words)
    assert status == 0
    rows = json.loads(out, parse_constant=no_such_number)["rows"]
    assert all(row["error_m"] > 0 and row["cpu_s"] > 0 for row in rows)


def test_what_cannot_run_is_a_row_with_its_reason(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    upright = load_scene("two_radians", ["inputs=binary64", "run.t_end=1"])
    over = Bench(upright, GridTruth(golden_of(upright), 1.0), 8.0)
    assert over.row(METHODS["rk4"], "plane", 0.1).status == "refused"
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    row = bench.row(METHODS["rk4"], "plane", 0.1)
    assert (row.status, row.reason, row.cpu_s) == (
        "not_installed",
        "NUMBA_DISABLE_JIT is set: unset it",
        None,
    )


@pytest.mark.usefixtures("here")
def test_a_study_goes_on_where_it_stopped_and_gives_the_same_rows(tmp_path: Path) -> None:
    short = load_scene("paris", ["run.t_end=20", "inputs=binary64"])
    planned = plan(short, ["rk4", "heyoka_double"], False)
    items = [*planned[:2], planned[-1]]
    reports: list[str] = []
    journal_path = tmp_path / "rows.jsonl"
    first = study(short, items=items[:2], journal_path=journal_path)
    again = study(
        short,
        items=items,
        journal_path=journal_path,
        report=lambda finished, total, now: reports.append(now),
    )
    assert again.rows[:2] == first.rows
    assert len(reports) == len(items) - 2
    other = study(short, items=items)
    measured = [
        [(*row.key, row.status, row.error_m, row.steps) for row in one.rows]
        for one in (again, other)
    ]
    assert measured[0] == measured[1]  # all but what they cost
    best = min(row.error_m for row in again.rows)
    assert front(again.rows)[-1].error_m == best  # how many are on it depends on what they cost
    assert rows_of(json.loads(json.dumps(again.document()))) == again.rows


@pytest.mark.usefixtures("here")
def test_the_command_writes_a_report_and_one_json_document(foucault, tmp_path: Path) -> None:
    words = ("study", "paris", "--methods", "rk4", "--no-formulations", "--t-end", "60", "--json")
    status, out, _ = foucault(*words, "--out", tmp_path / "out")
    assert status == 0
    document = json.loads(out)
    assert {"scene", "t_end", "reference", "rows"} <= document.keys()
    keys = {
        "method",
        "setting",
        "inputs",
        "status",
        "error_m",
        "end_error_m",
        "transit_error_s",
        "h_drift",
        "cpu_s",
    }
    assert keys | {"compile_s", "rhs_evaluations", "steps"} <= document["rows"][0].keys()
    assert (tmp_path / "out" / "index.html").read_text().startswith("<!doctype html>")


@pytest.mark.skipif(
    not Path("/proc/self/maps").exists(), reason="it is seen in /proc when an engine is loaded"
)
def test_a_study_of_approximations_that_is_stopped_says_that_nothing_was_kept() -> None:
    def solving(group: int, _: bytes) -> bool:
        """Return whether an engine was loaded half a second ago: a signal while Python loads it ends the loading."""
        loaded = "heyoka" in Path(f"/proc/{group}/maps").read_text()
        time.sleep(0.5 * loaded)
        return loaded

    status, err, _ = interrupted(["study", "paris", "--approximations"], solving)
    assert (status, b"nothing was kept" in err) == (130, True)


@pytest.mark.usefixtures("here")
def test_somebody_elses_program_is_a_row_of_the_study(foucault, tmp_path: Path) -> None:
    script = tmp_path / "still.py"
    script.write_text(
        "import sys\nend, step = float(sys.argv[1]), float(sys.argv[2])\nprint('t,x,y')\n"
        "for i in range(round(end / step) + 1):\n    print(f'{i * step!r},0.3,0.4')\n"
    )
    command = f"python3 {script} {{t_end}} {{grid_step}}"
    words = (
        "study",
        "paris",
        "--methods",
        "rk4",
        "--t-end",
        "120",
        "--run",
        command,
        "--out",
        tmp_path / "out",
    )
    status, out, _ = foucault(*words, "--json")
    assert status == 0
    (row,) = (row for row in json.loads(out)["rows"] if row["method"] != "rk4")
    assert row["method"] == "still.py"
    assert row["error_m"] > 0.5
    text = foucault(*words)[1]
    assert re.search(r"^Your still\.py: \S+ m at best\.$", text, re.M)
    (line,) = (line for line in text.splitlines() if line.lstrip().startswith("still.py"))
    # it has no {setting}, and so no step
    assert line.split()[:3] == ["still.py", "–", f"{row['error_m']:.2e}"]


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """The truth to 1e-9 m at times of its own, and the bob at rest."""
    t = np.linspace(0, 120, 33)
    x, y = (trajectory(load_scene("paris", ["inputs=binary64"]), t)[:, :2] + 1e-9).T
    good, still = tmp_path / "good.csv", tmp_path / "still.csv"
    good.write_text(
        "t,x,y\n"
        + "".join(
            f"{a!r},{b!r},{c!r}\n"
            for a, b, c in zip(t.tolist(), x.tolist(), y.tolist(), strict=True)
        )
    )
    still.write_text("t,x,y\n0,0.3,0.4\n120,0.3,0.4\n")
    return good, still


@pytest.mark.usefixtures("here")
def test_somebodys_files_are_rows_of_the_study_with_the_time_that_is_stated(
    foucault, files, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    words = (
        "study",
        "paris",
        "--methods",
        "rkmk4",
        "--t-end",
        "120",
        "--out",
        out,
        "--cpu",
        "0.25,-",
    )
    status, text, _ = foucault(*words, *(word for file in files for word in ("--candidates", file)))
    assert status == 0
    (good,) = (line for line in text.splitlines() if line.lstrip("* ").startswith("good.csv"))
    (still,) = (line for line in text.splitlines() if line.lstrip("* ").startswith("still.csv"))
    assert re.search(r"good\.csv +– +1\.41e-09 +0\.250", good)
    assert re.search(r"still\.csv +– +\d\.\d\de-01$", still.rstrip())
    document = json.loads((out / "study.json").read_text())
    stated, unknown = document["rows"][-2:]
    assert (stated["kind"], stated["cpu_s"], stated["reason"]) == (
        "file",
        0.25,
        users_program.STATED,
    )
    assert (unknown["status"], unknown["cpu_s"]) == ("ok", None)
    assert document["candidates"] == ["good.csv", "still.csv"]
    page = (out / "index.html").read_text()
    assert "--candidates" in page and "still.csv" in page


def test_a_file_that_ends_early_or_has_nothing_after_the_start_is_a_row_with_its_reason(
    files: tuple[Path, Path],
) -> None:
    scene = load_scene("paris", ["inputs=binary64", "run.t_end=600"])
    golden, (candidate, _) = (
        golden_of(scene),
        users_program.files_of([str(files[0])], None, ())["good.csv"],
    )
    row = users_program.file_row("short", candidate, 1.0, scene, golden)
    assert (row.status, row.reached_t) == ("gave_up", 120)
    assert "ends at t = 120 s of 600 s" in row.reason
    files[1].write_text("t,x,y\n0,0.3,0.4\n")
    (candidate, _) = users_program.files_of([str(files[1])], None, ())["still.csv"]
    assert (
        "no row after t = 0"
        in users_program.file_row("short", candidate, None, scene, golden).reason
    )


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--cpu", "1"], "2 positive numbers"),
        (["--cpu", "1,0"], "2 positive numbers"),
        (["--cpu", "1,x"], "2 positive numbers"),
        (["--candidates", "GOOD"], "another row has this name"),
        (["--candidates", "missing.csv"], "No such file"),
        (["--approximations"], "--approximations"),
    ],
)
def test_files_that_cannot_be_rows_are_refused_before_any_work(
    foucault, files, more: list[str], message: str
) -> None:
    good, still = map(str, files)
    more = [word.replace("GOOD", good) for word in more]
    status, out, err = foucault(
        "study", "paris", "--candidates", good, "--candidates", still, *more
    )
    assert (status, out) == (2, "")
    assert message in err


@pytest.mark.usefixtures("here")
def test_a_truth_that_has_to_be_solved_for_tells_how_far_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path))
    times: list[float] = []
    elsewhere = load_scene("paris", ["site.latitude=12.5", "run.t_end=600"])
    study(elsewhere, items=[("rk4", "plane", 0.5)], digits=40, solving=times.append)
    assert times == sorted(times) and 0 < times[0] <= times[-1] <= 600


@pytest.mark.usefixtures("here")
def test_the_precision_ladder_gains_digits_with_bits() -> None:
    bits = bits_of("53,64,113,160")
    scene, digits = precision_scene(load_scene("paris"), bits, whole=False)
    assert (scene.run.t_end, digits) == ("14400", 57)
    processor = [
        ("heyoka_double", "momentum", 2.0**-52),
        ("heyoka_long_double", "momentum", 2.0**-63),
    ]
    mpfr = [("heyoka_real", "momentum", 113), ("heyoka_real", "momentum", 160)]
    limbs = [("limbs", "inertial", 113), ("limbs", "inertial", 160)]
    assert precision_items(bits) == [*processor, *mpfr, *limbs]
    items = [item for item in precision_items(bits) if item[0] != "limbs"]
    result = study(scene.with_values(["run.t_end=20"]), items=items, digits=digits)
    errors = [row.error_m for row in result.rows]
    assert all(
        later is not None and earlier is not None and later < earlier
        for earlier, later in itertools.pairwise(errors)
    )
