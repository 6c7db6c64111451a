"""`foucault show`: lines that fit a terminal, passages by number, ranges that degrade, and warnings."""

from __future__ import annotations

import json

import lines
import pytest

import reference
from reference.scenes.shipped import scene_ids

WIDEST = 80

# the museum's pendulum of a technician: its release is known too badly for the whole run
MUSEUM = """
[pendulum]
length = "12.3"
[site]
latitude = "51.48"
gravity = "9.8119"
gravity_is = "effective"
[release]
angle = "5"
azimuth = "-135"
[run]
t_end = "90"
grid_step = "10"
sections = ["gate 135"]
[uncertain]
"pendulum.length" = "0.005"
"release.angle" = "0.5"
"release.azimuth" = "1"
"""


@pytest.fixture
def museum(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(MUSEUM)
    return path


def shown(foucault, *words):
    """Return the JSON document of `show`."""
    status, out, err = foucault("show", *words, "--json")
    assert status == 0, err
    return json.loads(out)


@pytest.mark.parametrize("columns", ["80", "200", "60"])
def test_no_line_is_wider_than_the_terminal_or_80_characters(foucault, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    most = min(WIDEST, int(columns))
    outputs = [foucault("scenes")[1]]
    names = scene_ids() if columns == "80" else ["paris", "museum_gate", "creeping"]
    for name in names:
        status, out, _ = foucault("show", name, "--set", "run.t_end=10", "--uncertain", "none")
        assert status == 0
        outputs.append(out)
    assert [line for out in outputs for line in out.splitlines() if len(line) > most] == []


def test_a_terminal_has_titles_in_bold_type_unless_no_color_is_set():
    words = ["show", "paris", "--set", "run.t_end=20"]
    out = lines.on_a_terminal(words, {})
    assert "\x1b[1mparis: " in out and "\x1b[1mMotion" in out
    out = lines.on_a_terminal(words, {"NO_COLOR": "1"})
    assert "\x1b" not in out and "paris: " in out


def test_scenes_wraps_each_title_beside_its_id_and_says_where_flags_are(foucault):
    out = foucault("scenes")[1]
    every = json.loads(foucault("scenes", "--json")[1])["scenes"]
    flat = lines.unwrapped(out)
    assert all(f"{scene['id']} {scene['title']}" in flat for scene in every)
    assert "`foucault show SCENE`" in flat


def test_show_gives_any_passage_of_an_exact_scene(foucault):
    words = ("paris", "--set", "run.t_end=600", "--section", "gate 30", "--section", "turn 0")
    passages = shown(foucault, *words, "--passage", "50", "--passage", "2")["passages"]
    solved = reference.solve("paris", t_end=600, digits=20, sections=["gate 30", "turn 0"])
    assert [(one["section"], one["number"]) for one in passages] == [
        ("gate 30", 50),
        ("gate 30", 2),
        ("turn 0", 50),
        ("turn 0", 2),
    ]
    for one in passages:
        truth = solved.sections[one["section"]].table.exact("t")[one["number"] - 1]
        assert abs(one["t_s"] - truth) <= one["t_error_s"] < 1e-9
    # a section alone: its first ones; numbers alone: transits
    first = shown(foucault, *words[:5])["passages"]
    assert [one["number"] for one in first] == [1, 2, 3]
    (transit,) = shown(foucault, *words[:3], "--passage", "3")["passages"]
    assert transit["t_s"] == pytest.approx(float(solved.transits.exact("t")[2]), abs=1e-9)
    (none,) = shown(foucault, *words[:3], "--passage", "80")["passages"]
    assert none["reason"] == "the run has 73"


def test_without_a_passage_asked_for_none_is_computed(foucault):
    assert "passages" not in shown(foucault, "paris", "--set", "run.t_end=600")


@pytest.mark.parametrize("word", ["0", "-1", "many", "3=", "3=±0", "3=wide", "1.5"])
def test_a_wrong_passage_is_refused_before_anything_is_shown(foucault, word):
    status, out, err = foucault("show", "museum_gate", "--passage", word)
    assert (status, out) == (2, "")
    assert err.startswith("foucault: --passage: got ")


def test_a_wanted_width_needs_uncertain_inputs(foucault):
    status, out, err = foucault("show", "paris", "--passage", "3=±0.1")
    assert (status, out) == (2, "") and "--uncertain" in err


def test_ranges_hold_as_far_as_they_go_and_say_which_input_to_narrow(foucault, museum):
    document = shown(foucault, museum, "--set", "run.t_end=300")
    ranges = document["ranges"]
    assert document["motion"]["over_s"] == ranges["asked_s"] == "300"
    reached_s = float(ranges["over_s"])
    assert 10 < reached_s < 300
    # what is proved is proved: pendulums at the corners of the box are inside
    low, high = map(float, ranges["first_transits_s"][2])
    for angle, length in (("4.5", "12.295"), ("5.5", "12.305")):
        corner = reference.load_scene(
            museum, [f"release.angle={angle}", f"pendulum.length={length}", "run.t_end=20"]
        )
        third = reference.solve(corner, level="computed", digits=10).transits.exact("t")[2]
        assert low <= third <= high

    narrowing = ranges["narrowing"]["run"]
    best = narrowing["alone"][0]
    assert best["input"] == "release.angle" and best["holds_s"] > 1.5 * reached_s
    # what is said to suffice does
    words = [
        word for pair in narrowing["enough"].items() for word in ("--uncertain", "=".join(pair))
    ]
    enough = shown(foucault, museum, "--set", "run.t_end=300", *words)["ranges"]
    assert enough["over_s"] == "300" and "narrowing" not in enough


def test_people_are_told_how_far_the_ranges_go(foucault, museum):
    status, out, _ = foucault("show", museum, "--set", "run.t_end=300")
    assert status == 0
    assert "period" in lines.part(out, "Motion over 300 s")
    told = lines.part(out, "Ranges, proved to ")
    assert "too uncertain for a proof over all 300 s" in told
    assert "To prove all 300 s, narrow " in told


def test_inputs_too_uncertain_for_any_proof_leave_scene_and_motion(foucault):
    changes = ("pendulum.length=0.2", "pendulum.drag=0.5", "site.gravity=9.81", "run.t_end=2")
    changes += ("release.angle=120", "release.azimuth=0", "site.rotation_rate=0")
    words = ("two_radians", *(word for change in changes for word in ("--set", change)))
    words += ("--uncertain", "angle=±2")
    ranges = shown(foucault, *words)["ranges"]
    assert ranges["over_s"] == "0" and "period_s" not in ranges
    status, out, _ = foucault("show", *words)
    assert status == 0
    assert "period" in lines.part(out, "Motion")
    assert "shorter (run.t_end)" in lines.part(out, "Ranges: nothing is proved")


def test_for_the_wanted_width_of_a_passage_it_says_which_input_to_narrow(foucault, museum):
    wanted_s = 0.05
    asked = ("--uncertain", "angle=±0.05", "--passage", f"20=±{wanted_s}", "--passage", "3=±1")
    ranges = shown(foucault, museum, *asked)["ranges"]
    passage, _ = ranges["passages"]
    low, high = map(float, passage["t_s"])
    assert high - low > 2 * wanted_s
    narrowing = ranges["narrowing"]["gate 135 20"]
    reached_s = [row["half_width_s"] for row in narrowing["alone"]]
    assert reached_s == sorted(reached_s) and reached_s[0] < narrowing["half_width_s"]
    assert ranges["narrowing"]["gate 135 3"]["enough"] == {}

    widths = {"release.angle": "±0.05", **narrowing["enough"]}
    typed = [word for pair in widths.items() for word in ("--uncertain", "=".join(pair))]
    again = shown(foucault, museum, *typed, "--passage", "20")["ranges"]["passages"]
    low, high = map(float, again[0]["t_s"])
    assert high - low <= 2 * wanted_s


def test_a_precession_that_says_nothing_is_called_useless_beside_its_first_order(foucault, museum):
    words = (museum, "--uncertain", "angle=±0.05", "--set", "run.t_end=60")
    document = shown(foucault, *words)
    ranges = document["ranges"]
    assert ranges["useless"] == ["precession_deg_per_h"]
    low, high = map(float, ranges["precession_deg_per_h"])
    assert low < -15.05 < 15.05 < high
    first_low, first_high = map(float, ranges["first_order"]["precession_deg_per_h"])
    assert first_low < document["motion"]["precession_deg_per_h"] < first_high < first_low + 0.1
    out = foucault("show", *words)[1]
    assert "precession useless: " in lines.part(out, "Ranges")
    # one that tells the way is not
    assert shown(foucault, "museum_gate")["ranges"]["useless"] == []


@pytest.mark.parametrize(
    ("words", "along"),
    [
        (("release.azimuth=-135", "run.sections=gate 45"), "gate 135"),
        (("release.azimuth=50", "run.sections=gate 45@0"), "gate 135"),
        (("release.azimuth=179", "run.sections=gate 0"), "gate 90"),
        (("release.azimuth=-135", "run.sections=gate 135"), None),
        (("release.azimuth=-135", "run.sections=turn 45,highest"), None),
        # a push across makes it round: it has no plane
        (("release.azimuth=45", "release.azimuth_rate=60", "run.sections=gate 45"), None),
    ],
)
def test_a_gate_along_the_swing_is_warned_of(foucault, museum, tmp_path, words, along):
    assigned = [word for change in words for word in ("--set", change)]
    exact = ("--uncertain", "none", "--set", "run.level=computed", "--set", "run.digits=8")
    commands = [
        ("show", museum, *assigned, *exact),
        ("generate", museum, *assigned, *exact, "--out", tmp_path / "out"),
        ("sweep", museum, *assigned, "--over", "pendulum.length=12,13", "--engine", "heyoka"),
    ]
    for command in commands:
        status, _, err = foucault(*command)
        assert status == 0, err
        warning = lines.unwrapped(err)
        assert ("swings along gate" in warning) == (along is not None), command
        if along:
            assert f"A beam across the swing has {along}." in warning


def test_the_g_of_somebodys_own_scene_is_warned_of_and_that_of_a_shipped_one_is_not(
    foucault, museum, tmp_path
):
    own = tmp_path / "own.toml"
    own.write_text('[release]\nx = "1"\ny = "0"\n[run]\nt_end = "20"\n')
    status, _, err = foucault("show", own)
    assert status == 0 and "site.gravity_is" in err and "effective" in err
    assert "site.gravity_is" in shown(foucault, own)["warnings"][0]
    assert "warning" not in foucault("show", own, "--set", "site.gravity_is=effective")[2]
    assert "warning" not in foucault("show", "paris", "--set", "run.t_end=20")[2]


def test_no_shipped_scene_is_warned_of():
    from reference.commands.cautions import cautions

    assert {
        name: texts for name in scene_ids() if (texts := cautions(reference.load_scene(name), name))
    } == {}


def test_ranges_that_a_motion_makes_unprovable_leave_scene_and_motion(foucault, tmp_path):
    """A wide swing over so long a time that no number of bits suffices."""
    wide = tmp_path / "wide.toml"
    wide.write_text(
        '[pendulum]\nlength = "1"\n[site]\ngravity_is = "effective"\n'
        '[release]\nangle = "80"\nazimuth = "0"\n[run]\nt_end = "1000"\ngrid_step = "1000"\n'
        '[uncertain]\n"release.angle" = "1.6"\n"pendulum.length" = "0.01"\n'
    )
    status, out, _ = foucault("show", wide)
    assert status == 0
    assert "period" in lines.part(out, "Motion")
    assert "bits" in lines.part(out, "Ranges")
    assert "bits" in shown(foucault, wide)["ranges"]["reason"]
