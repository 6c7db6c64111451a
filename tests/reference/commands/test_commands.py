"""The commands that compute datasets: exit statuses, messages, JSON, nothing half written."""

from __future__ import annotations

import json
import os
import pty
import subprocess
import sys
from pathlib import Path

import lines
import pytest
from interruption import gone_within, interrupted, members
from lines import unwrapped
from own_project import foucault_of, own_project
from places import ROOT

SHORT = ("--t-end", "60", "--digits", "10", "--level", "computed")


def test_scenes_lists_every_scene(foucault):
    status, out, _ = foucault("scenes")
    assert status == 0
    assert all(
        name in out for name in ("paris", "pantheon", "pole", "equator", "southern", "spherical")
    )
    assert {scene["id"] for scene in json.loads(foucault("scenes", "--json")[1])["scenes"]} >= {
        "paris"
    }


def test_show_says_what_the_flags_of_a_scene_mean(foucault):
    status, out, _ = foucault("show", "creeping")
    assert status == 0
    shown = unwrapped(out)
    assert "stiff: Drag makes rates differ" in shown and "damped: Drag takes energy away" in shown
    status, out, _ = foucault("show", "paris", "--set", "flags=mine,stiff", "--json")
    assert json.loads(out)["flag_meanings"]["mine"] == "not a flag of the scenes that ship"


def test_show_gives_inputs_and_what_follows_from_them(foucault):
    status, out, _ = foucault("show", "paris")
    assert status == 0
    shown = unwrapped(out)
    assert "48.846111° north" in shown
    gravity = "9.80665 m/s², gravity alone, to which the centrifugal force is added (ellipsoid)"
    assert gravity in shown
    assert "pull 9.7919" in shown
    assert "hangs 0.1152 m south of the vertical" in shown


def test_show_says_period_precession_and_the_time_of_a_full_turn_or_why_there_is_none(foucault):
    motion = json.loads(foucault("show", "paris", "--json")[1])["motion"]
    assert motion["period_s"] == pytest.approx(1 / 0.060843634, rel=2e-8)  # Mathar
    assert motion["full_turn_h"] == pytest.approx(360 / 11.3418, rel=1e-5)
    assert all(0 < motion[name] < 1e-6 for name in motion if "error" in name)
    for scene in ("conical", "weightless"):
        status, out, _ = foucault("show", scene)
        assert (status, "no period" in out) == (0, True)
    motion = json.loads(foucault("show", "paris", "--set", "site.rotation_rate=0", "--json")[1])[
        "motion"
    ]
    assert motion["precession_error_deg_per_h"] > abs(motion["precession_deg_per_h"])
    assert "full_turn_h" not in motion
    # its last highest points were 157° an hour
    motion = json.loads(foucault("show", "damped", "--json")[1])["motion"]
    assert motion == {
        "reason": "its last swing is less than 16 times as wide as the rest position is off the plumb line"
    }
    short = foucault("show", "paris", "--set", "run.t_end=10")[1]
    assert "or the run is too short" in unwrapped(short)
    motion = json.loads(foucault("show", "damped", "--set", "run.t_end=120", "--json")[1])["motion"]
    assert motion["full_turn_h"] == pytest.approx(31.7, rel=0.05)
    assert {"period_s", "period_error_s", "over_s", "left_out"} == {
        *json.loads(foucault("show", "fast_pole", "--json")[1])["motion"]
    }


@pytest.mark.parametrize(
    ("scene", "changes", "left_out"),
    [
        (
            "fast_pole",
            ("run.t_end=10",),
            dict.fromkeys(("precession_deg_per_h", "full_turn_h"), "right angle"),
        ),
        (
            "paris",
            ("run.t_end=20", "site.gravity_is=effective", "release.x=0.005", "release.y=0"),
            dict.fromkeys(("precession_deg_per_h", "full_turn_h"), "off the plumb line"),
        ),
        ("paris", ("run.t_end=60", "site.rotation_rate=0"), {"full_turn_h": "may not turn"}),
        ("paris", ("run.t_end=60",), {}),
    ],
)
def test_every_number_of_a_swing_that_is_left_out_has_its_reason(
    foucault, scene, changes, left_out
):
    words = ["show", scene, "--proved", *(word for change in changes for word in ("--set", change))]
    document, out = json.loads(foucault(*words, "--json")[1]), foucault(*words)[1]
    for part in ("motion", "proved"):
        reasons = document[part]["left_out"]
        assert reasons.keys() == left_out.keys()
        assert all(text in reasons[name] for name, text in left_out.items())
        shown = lines.part(out, part.capitalize())
        assert ("no precession" in shown) == ("precession_deg_per_h" in reasons)
        assert ("no full turn" in shown) == ("full_turn_h" in reasons)
        assert all(reason in shown for reason in reasons.values())


# swings that go over the top, and the same bobs with too little energy for it, or a wide swing's
ROUND = {
    ("over_top", "run.t_end=10"): True,
    ("barely_over", "run.t_end=20"): True,
    ("over_top", "run.t_end=10", "pendulum.drag=0.001"): True,
    ("over_top", "run.t_end=10", "site.gravity_is=effective", "release.vy=0.5"): True,
    ("over_top", "run.t_end=10", "release.vx=5"): False,
    ("barely_over", "run.t_end=20", "release.vx=6.2"): False,
    ("two_radians", "run.t_end=20"): False,
}


@pytest.mark.parametrize("words", ROUND)
def test_a_bob_that_goes_over_the_top_has_no_period_and_the_proof_says_the_same(foucault, words):
    scene, *changes = words
    assigned = [word for change in changes for word in ("--set", change)]
    document = json.loads(foucault("show", scene, *assigned, "--proved", "--json")[1])
    for part in ("motion", "proved"):
        assert ("lie on the same side" in document[part].get("reason", "")) == ROUND[words], (
            document[part]
        )
        assert (document[part].get("period_s") is None) == ROUND[words]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("paris", "--set", "run.t_end=10"), "the run is too short"),
        (("nanometre_paris", "--set", "run.t_end=60"), "less than 16 times as wide"),
        (("conical", "--set", "run.t_end=10"), "not decided which of its points are the highest"),
    ],
)
def test_a_proof_without_a_swing_says_why(foucault, words, reason):
    shown = lines.part(foucault("show", *words, "--proved")[1], "Proved over")
    assert "no period" in shown and reason in shown


def test_uncertain_inputs_that_leave_the_swing_open_say_so(foucault):
    out = foucault("show", "paris", "--set", "run.t_end=20", "--uncertain", "y0=0.1")[1]
    assert "no proved period the intervals of these inputs leave it open" in lines.part(
        out, "Ranges"
    )


def test_show_of_a_folder_says_what_reads_it(foucault, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hall").mkdir()  # as an id
    (tmp_path / "paris+-length=0.001").mkdir()
    for word in ("hall", "paris+-length=0.001"):
        status, _, err = foucault("show", word)
        assert (status, "`foucault verify` checks datasets and ranges" in err) == (2, True)


def test_show_begins_a_scene(foucault):
    status, out, _ = foucault("show", "laboratory", "--template")
    assert status == 0 and 'drag = "0.0023"' in out
    meanings = [line for line in out.splitlines() if "centrifugal force" in line]
    assert len(meanings) == 2, "a line for each of the two"
    for words, field in (
        ((), "SCENE"),
        (("--template", "--json"), "--json"),
        (("--template", "--set", "id=a"), "--set"),
    ):
        status, _, err = foucault("show", *words)
        assert (status, err.startswith(f"foucault: {field}: ")) == (2, True), err


def test_show_ends_with_commands_for_the_same_scene(foucault):
    changes = ("--set", "pendulum.length=20", "--set", "title=my hall")
    out = unwrapped(foucault("show", "paris", *changes)[1])
    words = "paris --set pendulum.length=20 --set 'title=my hall'"
    assert f"`foucault generate {words}` solves it" in out
    assert f"`foucault score {words} FILE` judges a program by it" in out


def test_a_motion_whose_first_step_is_too_short_for_doubles_has_no_period(foucault):
    status, out, _ = foucault("show", "paris", "--set", "site.rotation_rate=1e15")
    assert (status, "no period The engine stopped" in unwrapped(out)) == (0, True)


def test_show_of_numbers_beyond_the_range_of_doubles_ends_without_a_traceback(foucault):
    changes = (
        "site.equatorial_radius=1e309",
        "site.rotation_rate=1e309",
        "pendulum.drag=1e-320",
        "pendulum.drag=1e-350",
    )
    for change in changes:
        status, out, err = foucault("show", "paris", "--set", change)
        assert status in (0, 2), (out, err)


def test_show_equations_says_what_was_left_out_and_why(foucault):
    out = unwrapped(foucault("show", "pole", "--equations")[1])
    assert "the latitude is a pole" in out
    equations = json.loads(foucault("show", "pole", "--equations", "--json")[1])["equations"]
    assert equations and not any("Omega_y" in line for line in equations)
    out = unwrapped(foucault("show", "spherical", "--equations")[1])
    assert "rotation_rate is 0" in out
    changes = ("--set", "pendulum.drag=0.1", "--set", "site.gravity=0")
    out = unwrapped(foucault("show", "equator", "--equations", *changes)[1])
    assert "gamma" in out
    assert "gravity: it is 0" in out
    minute = ("--set", "run.t_end=60")
    document = json.loads(foucault("show", "paris", "--equations", "--json", *minute)[1])
    assert len(document["equations"]) == 6
    without = ("--set", "run.transits=false", "--set", "run.level=enclosed")
    text = unwrapped(foucault("show", "paris", "--equations", *without, *minute)[1])
    assert "transits are off" in text
    assert "the enclosure" not in text
    changes = ("--set", "release.x=0", "--set", "release.vx=0")
    planar = foucault("show", "spherical", "--equations", *changes)[1]
    assert "xdot is identically zero" in unwrapped(planar)


@pytest.mark.parametrize(
    ("changes", "left_out"),
    [
        (("run.level=computed", "run.digits=6"), "extended precision: double serves 6 digits."),
        (
            ("run.level=computed", "run.digits=10"),
            "precision beyond long double: it serves 10 digits.",
        ),
        (("run.level=computed", "run.digits=30"), None),
        (
            ("run.level=confirmed", "run.digits=6"),
            "precision beyond long double: it serves 6 digits.",
        ),
        (("run.level=enclosed", "run.digits=12"), None),
    ],
    ids=lambda one: one[0] + one[1] if isinstance(one, tuple) else "",
)
def test_show_equations_shows_what_generate_compiles(foucault, tmp_path, changes, left_out):
    words = [word for change in ("run.t_end=60", *changes) for word in ("--set", change)]
    shown = json.loads(foucault("show", "pole", "--equations", "--json", *words)[1])
    status, _, err = foucault("generate", "pole", "--out", str(tmp_path / "pole"), *words)
    assert status == 0, err
    manifest = json.loads((tmp_path / "pole" / "manifest.json").read_text())
    made = manifest["equations"]
    assert (shown["formulation"], shown["equations"]) == (made["formulation"], made["lines"])
    assert shown["left_out"] == made["left_out"]
    assert shown["number"].partition("(")[0] == manifest["run"]["number"].partition("(")[0]
    precision = [line for line in shown["left_out"] if "precision" in line]
    assert precision == ([] if left_out is None else [left_out])
    constant = "the rate of Hz: it is constant." in shown["left_out"]
    assert constant == (shown["formulation"] == "momentum")
    assert not any(line.startswith("Hz'") for line in made["lines"])
    assert foucault("verify", str(tmp_path / "pole"))[0] == 0


def test_generate_writes_a_dataset_that_verify_accepts(foucault, tmp_path):
    target = tmp_path / "paris"
    status, out, err = foucault("generate", "paris", *SHORT, "--out", str(target))
    assert (status, err) == (0, "")
    assert "transits 7" in unwrapped(out)
    status, out, _ = foucault("verify", str(target), "--recompute")
    assert (status, out) == (0, f"{target}: ok\n")


def test_generate_json_has_the_keys_of_the_contract_and_nothing_else_on_stdout(foucault, tmp_path):
    status, out, _ = foucault("generate", "paris", *SHORT, "--json", "--out", str(tmp_path / "p"))
    document = json.loads(out)
    assert status == 0
    assert {
        "scene",
        "out",
        "level",
        "digits",
        "engine",
        "transits",
        "bound_m",
        "cpu_s",
        "compile_s",
    } <= set(document)
    assert (document["scene"], document["level"], document["digits"]) == ("paris", "computed", 10)
    assert (document["engine"], document["transits"]) == ("heyoka", 7)
    assert 0 < document["bound_m"] < 1e-8
    assert document["cpu_s"] > 0


def test_a_changed_scene_does_not_replace_the_shipped_golden(foucault, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, out, _ = foucault("generate", "paris", *SHORT, "--json")
    assert status == 0
    assert json.loads(out)["out"] == "golden/paris"
    assert (tmp_path / "golden/paris/manifest.json").is_file()


def test_verify_reports_damage_with_exit_1(foucault, tmp_path):
    target = tmp_path / "paris"
    foucault("generate", "paris", *SHORT, "--out", str(target))
    page = target / "certified.txt"
    page.write_text(page.read_text() + "x")
    status, out, _ = foucault("verify", str(target))
    assert status == 1
    assert "certified.txt" in out
    status, out, _ = foucault("verify", str(target), "--json")
    assert status == 1
    (row,) = json.loads(out)["rows"]
    assert (row["path"], row["ok"]) == (str(target), False)
    assert row["problems"]


BAD = [
    (("generate", "atlantis"), "SCENE", "`foucault scenes` lists the ids"),
    (("generate", "../paris"), "SCENE", "TOML file"),
    (("generate", "paris", "--digits", "0"), "run.digits", "from 1 to 1000"),
    (("generate", "paris", "--digits", "99999"), "run.digits", "from 1 to 1000"),
    (("generate", "paris", "--digits", "many"), "run.digits", "whole number"),
    (("generate", "paris", "--t-end", "soon"), "run.t_end", "decimal number"),
    (("generate", "paris", "--t-end", "nan"), "run.t_end", "decimal number"),
    (("generate", "paris", "--t-end", "-5"), "run.t_end", "above 0"),
    (("generate", "paris", "--t-end", "1e399"), "run.t_end", "at most 1e15"),
    (("generate", "paris", "--set", "site.latitude=91"), "site.latitude", "at most 90"),
    (("generate", "paris", "--set", "pendulum.length=0"), "pendulum.length", "above 0"),
    (("generate", "paris", "--set", "release.x=70"), "release", "below the suspension"),
    (("generate", "paris", "--set", "site.colour=blue"), "site.colour", "a field that scenes have"),
    (("generate", "paris", "--set", "id=a/b"), "id", "lower-case"),
    (("generate", "paris", "--set", "nonsense"), "--set", "SECTION.KEY=VALUE"),
    (("generate", "paris", "--out", "/proc/nowhere/x"), "--out", "can be written to"),
    (("show", "/nowhere/at/all.toml"), "SCENE", "TOML file"),
    (("verify", "/nowhere/at/all"), "PATH", "golden dataset"),
]


@pytest.mark.parametrize(
    ("words", "field", "expected"), BAD, ids=[" ".join(row[0][1:]) for row in BAD]
)
def test_a_users_mistake_ends_with_exit_2_a_message_and_nothing_written(
    foucault, words, field, expected, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    status, out, err = foucault(*words)
    assert status == 2
    assert out == ""
    assert err.startswith(f"foucault: {field}: got ")
    assert expected in err
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_level_or_command_is_wrong_usage(foucault):
    assert foucault("generate", "paris", "--level", "perfect")[0] == 2
    assert foucault("dance")[0] == 2
    assert foucault("generate", "paris", "--engine", "steam")[0] == 2


def test_an_engine_that_so_few_digits_do_not_need_is_refused(foucault, tmp_path):
    pytest.importorskip("numba")
    status, out, err = foucault(
        "generate", "paris", *SHORT, "--engine", "limbs", "--out", tmp_path / "p"
    )
    assert (status, out) == (2, "")
    assert "--engine: got 'limbs', expected auto or heyoka. So few digits need only " in err
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_reached_ends_with_exit_3_and_no_file(foucault, tmp_path):
    ages = ("--t-end", "1e13", "--set", "run.grid_step=1e10", "--level", "computed")
    status, out, err = foucault("generate", "paris", *ages, "--out", tmp_path / "p")
    assert (status, out) == (3, "")
    assert "steps" in err and "Ask for a shorter run (run.t_end up to about" in err
    assert list(tmp_path.iterdir()) == []


def test_verify_without_any_dataset_says_so(tmp_path):
    done = foucault_of(own_project(tmp_path / "own", ["paris"]), "verify")
    assert (done.returncode, "foucault generate" in done.stderr) == (2, True)


@pytest.mark.parametrize("installed", [False, True])
def test_a_scene_as_it_stands_is_written_where_it_ships_in_a_checkout_and_never_into_an_installed_package(
    tmp_path, installed
):
    project = own_project(tmp_path / "own", ["conical"])
    scene = project / "data/scenes/conical.toml"
    short = {"t_end": 't_end = "6"', "digits": "digits = 9", "level": 'level = "computed"'}
    lines = [short.get(line.partition(" ")[0], line) for line in scene.read_text().splitlines()]
    scene.write_text("\n".join(lines) + "\n")
    if installed:
        (project / "data").rename(project / "reference/data")
    done = foucault_of(project, "generate", "conical", "--json")
    assert done.returncode == 0, done.stderr
    place = Path(json.loads(done.stdout)["out"])
    assert project / place == project / ("golden/conical" if installed else "data/golden/conical")
    assert (project / place / "manifest.json").is_file()


def test_help_loads_neither_heyoka_nor_flint_nor_numpy():
    heavy = ("heyoka", "flint", "numpy", "mpmath", "scipy", "matplotlib")
    code = (
        "import sys, runpy; sys.argv = ['foucault', '--help']\n"
        "try: runpy.run_module('foucault', run_name='__main__')\n"
        f"except SystemExit: print([name for name in {heavy} if name in sys.modules])"
    )
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert process.stdout.strip().endswith("[]")


def test_a_terminal_sees_a_progress_bar_with_simulated_time(tmp_path):
    master, slave = pty.openpty()
    words = [
        sys.executable,
        "-m",
        "foucault",
        "generate",
        "paris",
        "--t-end",
        "1200",
        "--level",
        "computed",
    ]
    slow = ["--digits", "30", "--engine", "heyoka"]  # so long that the bar is drawn
    with subprocess.Popen(
        [*words, *slow, "--out", str(tmp_path / "p")],
        stdout=subprocess.DEVNULL,
        stderr=slave,
        cwd=ROOT,
    ) as process:
        os.close(slave)
        output = b""
        while True:
            try:
                piece = os.read(master, 4096)
            except OSError:
                break
            if not piece:
                break
            output += piece
    os.close(master)
    assert process.returncode == 0
    assert b"% of the simulated 1,200 s" in output


def test_interrupted_it_leaves_no_dataset_and_no_child(tmp_path):
    words = [
        "generate",
        "paris",
        "--t-end",
        "14400",
        "--engine",
        "heyoka",
        "--out",
        str(tmp_path / "p"),
    ]
    # the confirming run has begun
    status, err, group = interrupted(words, lambda group, _: members(group) > 1)
    assert status == 130
    assert b"Traceback" not in err
    assert list(tmp_path.iterdir()) == []
    assert gone_within(group, 10)


def test_interrupted_a_command_that_keeps_nothing_says_that_it_stopped():
    words = ["show", "paris", "--sensitivity"]
    status, err, _ = interrupted(
        words, lambda group, _: "heyoka" in Path(f"/proc/{group}/maps").read_text()
    )
    assert (status, err) == (130, b"foucault: stopped\n")


def test_show_says_how_many_digits_the_flow_costs(foucault):
    document = json.loads(foucault("show", "two_radians", "--sensitivity", "--json")[1])
    assert 2 < document["digits_lost"] < 4
    assert (
        f"The flow costs {document['digits_lost']:.1f} digits"
        in foucault("show", "two_radians", "--sensitivity")[1]
    )
