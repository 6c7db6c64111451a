"""`foucault sweep`: table, JSON, folder, pictures, exit statuses."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time

import pytest
from lines import unwrapped
from places import ROOT

from reference import load_scene
from reference.engines.octet.rows import SOURCES
from reference.sweeps.request import Settings, request, worth_compiling
from reference.sweeps.sweep import checked_request
from reference.system.machine_code import folder_of, kept_variants

pytest.importorskip("pyarrow")
SMALL = ["paris", "--t-end", "60", "--engine", "heyoka"]


def test_a_small_sweep_prints_a_table(foucault):
    status, out, err = foucault("sweep", *SMALL, "--over", "site.latitude=0:20:10")
    assert status == 0, err
    names, units, *rows = out.splitlines()
    assert names.split()[:2] == ["latitude", "frequency"]
    assert units.split()[:2] == ["degrees", "Hz"]
    assert [line.split()[0] for line in rows[:3]] == ["0", "10", "20"]
    assert "3 rows: 3 ok" in rows
    out = foucault("sweep", *SMALL, "--over", "site.latitude=48")[1]
    assert "1 row: 1 ok" in out.splitlines()


def test_a_wide_table_goes_on_below_and_no_line_is_wider_than_80_characters(foucault, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    words = ("--section", "gate 30", "--section", "turn 90")
    status, out, err = foucault("sweep", *SMALL, "--over", "site.latitude=0,10", *words)
    assert status == 0, err
    assert [line for line in out.splitlines() if len(line) > 80] == []
    # the field that varies begins each part
    parts = [part for part in out.split("\n\n") if part.split()[0] == "latitude"]
    assert len(parts) > 1
    for head in ("gate 30", "turn 90", "passages", "first", "interval"):
        assert any(head in part for part in parts)


def test_a_row_without_results_has_its_reason_below_the_table(foucault):
    status, out, _ = foucault("sweep", *SMALL, "--over", "release.x=0.1,70")
    assert status == 1
    told = unwrapped(out)
    assert "release.x = 70: invalid: " in told and "a point below the suspension" in told
    assert [line for line in out.splitlines() if len(line) > 80] == []


def test_a_table_shows_no_digit_beyond_its_error(foucault):
    words = ("sweep", *SMALL, "--over", "site.latitude=10,48")
    rows = json.loads(foucault(*words, "--json")[1])["rows"]
    for line, row in zip(foucault(*words)[1].splitlines()[2:], rows, strict=False):
        _, frequency, precession, _, angle, _ = line.split()
        for cell, quantity, unit in (
            (frequency, "swing", "hz"), (precession, "precession", "deg_per_h"), (angle, "max_angle", "deg")
        ):  # fmt: skip
            last_digit = 0.1 ** len(cell.partition(".")[2])
            error = row[f"{quantity}_error_{unit}"]
            assert error <= last_digit, (cell, error)
            assert float(cell) == pytest.approx(row[f"{quantity}_{unit}"], abs=10 * error)


LATITUDES = ["site.latitude=-90:90:1"]


@pytest.fixture
def cold(tmp_path, monkeypatch):
    """A machine that has compiled nothing yet: the folder of its machine code."""
    pytest.importorskip("numba")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    folder = folder_of(SOURCES)
    assert folder is not None
    return folder


def chosen(over, **values):
    """Return the engine of a sweep of Paris, and the one that is worth compiling for the next."""
    scene = load_scene("paris", {"run.t_end": 12000, **values})
    request = checked_request(scene, over, None, None, Settings(audit=0))
    other = worth_compiling(request)
    return request.engine, other and other.name


def test_auto_takes_octet_wherever_its_code_is_kept_and_else_where_compiling_it_pays(cold):
    many = ["pendulum.length=67:68:0.0001"]
    assert chosen(LATITUDES) == ("heyoka", "octet")
    assert chosen(many) == ("octet", None)
    assert chosen(["site.latitude=0,90"]) == ("heyoka", None)  # too few to gain by it
    assert chosen(LATITUDES, **{"pendulum.drag": "0.001"}) == ("heyoka", None)  # not in octet
    cold.mkdir()
    (cold / "march.march-1.py311.1.nbc").touch()
    assert chosen(LATITUDES) == ("octet", None)
    # what sections need is compiled apart
    gate = {"run.sections": ["gate 30"]}
    assert chosen(LATITUDES, **gate) == ("heyoka", "octet")
    (cold / "march.march-1.py311.2.nbc").touch()
    assert chosen(["site.latitude=-90:90:3"], **gate) == ("octet", None)
    assert chosen(LATITUDES, **{"pendulum.drag": "0.001"})[0] == "heyoka"


@pytest.mark.long
def test_the_first_sweep_compiles_octet_for_the_next_in_the_background(cold):
    words = [sys.executable, str(ROOT / "foucault.py"), "sweep", "paris"]
    words += ["--over", "site.latitude=-90:90:1", "--t-end", "12000"]

    def last_line_and_messages():
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        return done.stdout.splitlines()[-1], done.stderr

    first, messages = last_line_and_messages()
    assert "octet is compiled in the background, once" in messages
    assert "heyoka" in first
    until = time.monotonic() + 300
    while not kept_variants("march", cold) and time.monotonic() < until:
        time.sleep(0.2)
    second, messages = last_line_and_messages()
    assert "octet" in second and messages == ""


def test_parts_of_rows_with_sections_are_smaller_and_the_same_whatever_is_compiled(
    tmp_path, monkeypatch
):
    pytest.importorskip("numba")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    paris, rows = load_scene("paris", {"run.t_end": 12000}), ["pendulum.length=60:70:0.00001"]
    plain, gate, high = (
        request(
            paris.with_values({"run.sections": words}), rows, settings=Settings(engine="octet")
        ).rows_per_part
        for words in ([], ["gate 30"], ["highest"])
    )
    assert (plain // gate, plain // high) == (2, 8)  # 1 + 1.2, and 1 + 6, as powers of two
    for number in (1, 2):
        folder = folder_of(SOURCES)
        assert folder is not None
        folder.mkdir(exist_ok=True)
        (folder / f"march.march-1.py311.{number}.nbc").touch()
        assert request(paris, rows, settings=Settings(engine="octet")).rows_per_part == plain


def test_json_holds_every_row_and_the_costs(foucault):
    status, out, _ = foucault(
        "sweep", *SMALL, "--over", "site.latitude=0,90", "--json", "--workers", "1"
    )
    document = json.loads(out)
    assert status == 0
    assert document["over"] == {"site.latitude": "0,90"}
    assert (document["lanes"], document["workers"], document["rows_total"]) == (1, 1, 2)
    assert document["counts"] == {"ok": 2}
    rows = document["rows"]
    assert [row["value"] for row in rows] == ["0", "90"]
    assert rows[0]["values"] == {"site.latitude": "0"}
    assert rows[0]["precession_ratio"] is None
    assert len(rows[0]["state"]) == 6
    assert rows[1]["frequency_hz"] == pytest.approx(0.0608894, abs=1e-6)
    assert {"cpu_s", "compile_s", "fold_s", "wall_s", "rows_per_core_s", "audit"} <= set(document)


def test_a_sweep_says_what_the_solver_took_of_it(foucault):
    _, out, _ = foucault(
        "sweep", *SMALL, "--over", "site.latitude=0,90", "--tolerance", "1e-14", "--workers", "1"
    )
    told = re.search(
        r"CPU ([\d.]+) s, ([\d.]+) s of them for 2 rows that went to the solver", unwrapped(out)
    )
    every, solver = map(float, told.groups())
    assert 0 < solver <= every


@pytest.mark.parametrize(("level", "head"), [("enclosed", "proved"), ("confirmed", "estimated")])
def test_where_every_row_goes_through_the_solver_no_engine_is_named(foucault, level, head):
    if level == "enclosed":
        pytest.importorskip("flint")
    out = foucault("sweep", "paris", "--t-end", "20", "--over", "latitude=45", "--level", level)[1]
    assert head in out.split() and "error, m" in out
    assert unwrapped(out).endswith("; the solver")


def test_a_row_that_fails_is_named_and_the_others_stand(foucault):
    status, out, err = foucault("sweep", *SMALL, "--over", "pendulum.length=0.4,67")
    assert status == 1
    assert "foucault: 1 of 2 rows failed: 1 invalid (first: row 0, pendulum.length=0.4)" in err
    assert "invalid: release: got" in out
    status, _, _ = foucault("sweep", *SMALL, "--over", "pendulum.length=67,1e390")
    assert status == 3


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["paris", "--over", "site.latitude=0:91:1"],
            "site.latitude: got '91', expected a number at least -90",
        ),
        (["paris"], "--over: got nothing"),
        (["paris", "--over", "site.latitude=1", "--rows", "x.csv"], "Give one of the two"),
        (
            ["paris", "--rows", "/no/such.csv"],
            "--rows: got '/no/such.csv', expected a readable file",
        ),
        ([], "SCENE: got nothing"),
        (["--over", "site.latitude=1"], "--over: has no effect without SCENE"),
        (["paris", "--over", "site.latitude=1", "--workers", "0"], "--workers"),
        (["paris", "--over", "site.latitude=1", "--digits", "0"], "run.digits: got '0'"),
        (
            ["paris", "--over", "site.latitude=1", "--digits", "2000"],
            "expected a whole number from 1 to 1000",
        ),
        (
            ["paris", "--over", "site.latitude=1", "--tolerance", "-1"],
            "expected a number of metres, 0 or more",
        ),
        (
            ["paris", "--over", "run.t_end=6,7", "--t-end", "5"],
            "--t-end: has no effect together with --over run.t_end",
        ),
        (
            ["paris", "--over", "site.latitude=1", "--audit", "-1"],
            "--audit: got '-1', expected a number of rows, 0 or more",
        ),
        (
            ["paris", "--over", "site.latitude=1", "--workers", "2", "--cluster", "local:2"],
            "together with --cluster",
        ),
        (
            ["paris", "--over", "site.latitude=1", "--set", "run.digits=3"],
            "a field that has an effect here",
        ),
        (["paris", "--over", "site.latitude=1", "--plot", "a.gif"], "a path that ends in"),
        (["paris", "--over", "inputs=decimal", "--plot", "a.png"], "one or two numerical fields"),
        (
            ["paris", "--over", "site.latitude=1", "--want", "state", "--plot", "a.png"],
            "frequency or precession",
        ),
        (["--out", "/no/such"], "the folder of a sweep"),
    ],
)
def test_mistakes_end_with_2_before_any_work(foucault, words, said):
    status, out, err = foucault("sweep", *words)
    assert (status, out) == (2, "")
    assert said in err


def test_a_folder_is_gone_on_with_by_the_same_command_or_by_itself(foucault, tmp_path):
    folder = tmp_path / "lat"
    words = ["sweep", *SMALL, "--over", "site.latitude=0:20:10", "--audit", "0", "--out", folder]
    assert foucault(*words)[0] == 0
    part = folder / "rows/part-00000000.parquet"
    before = part.read_bytes()
    part.unlink()
    status, out, _ = foucault("sweep", "--out", folder)
    assert (status, out.splitlines()[:2]) == (0, [f"{folder}: 1 part in Parquet", "3 rows: 3 ok"])
    assert part.read_bytes() == before
    status, out, _ = foucault(*words, "--json")
    assert json.loads(out)["rows_done"] == 0
    assert len(json.loads(out)["rows"]) == 3


@pytest.mark.parametrize(
    "over", [["site.latitude=-90:90:90"], ["release.x=0.1,0.2", "site.latitude=0,90"]]
)
def test_one_or_two_fields_make_a_picture(foucault, tmp_path, over):
    pytest.importorskip("matplotlib")
    words = [word for axis in over for word in ("--over", axis)]
    for name in ("a.svg", "b.svg"):
        assert foucault("sweep", *SMALL, *words, "--plot", tmp_path / name)[0] == 0
    text = (tmp_path / "a.svg").read_text()
    assert "latitude in °" in text
    assert "precession in °/h" in text
    assert text == (tmp_path / "b.svg").read_text()
