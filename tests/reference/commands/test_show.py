"""`foucault show`: lines that fit a terminal, passages by number, ranges that degrade, and warnings."""

from __future__ import annotations

import json
import re

import lines
import pytest
from sampled import one_in
from typer.testing import CliRunner

import reference
from foucault import commands
from reference.commands.proved_text import ranges_lines, ranges_title
from reference.commands.scene_text import input_facts
from reference.scenes.inputs import GRAVITY_MEANINGS
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


@pytest.fixture(scope="module")
def museum(tmp_path_factory):
    path = tmp_path_factory.mktemp("museum") / "mine.toml"
    path.write_text(MUSEUM)
    return path


def shown(*words):
    """Return the JSON document of `show`."""
    result = CliRunner().invoke(commands(), ["show", *map(str, words), "--json"])
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def text_of(ranges):
    """Return what people read of the ranges of a JSON document."""
    return lines.unwrapped("\n".join(ranges_lines(ranges)))


@pytest.fixture(scope="module")
def too_long(museum):
    """The document of a run for which the inputs are too uncertain."""
    return shown(museum, "--set", "run.t_end=120")


@pytest.fixture(scope="module")
def long_enough(museum, too_long):
    """The document of the same run, its inputs as uncertain as was said to suffice."""
    enough = too_long["ranges"]["narrowing"]["run"]["enough"]
    return shown(museum, "--set", "run.t_end=120", *_typed(enough))


@pytest.fixture(scope="module")
def with_passages(museum):
    """The document of a short run with a passage that is not proved, and one that is."""
    words = ("--passage", "12=±0.1", "--passage", "3=±1")
    return shown(museum, "--set", "run.t_end=50", *words)


def _typed(widths):
    return [word for pair in widths.items() for word in ("--uncertain", "=".join(pair))]


@pytest.mark.parametrize("columns", ["200", "80", "60"])
def test_no_line_is_wider_than_the_terminal_or_80_characters(foucault, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    out = foucault("scenes")[1]
    for name in ("paris", "museum_gate", "creeping"):
        out += _short(foucault, name)
    assert _too_wide(out, min(WIDEST, int(columns))) == []


@pytest.mark.parametrize("name", one_in(3, scene_ids()))
def test_no_line_of_a_scene_is_wider_than_80_characters(foucault, monkeypatch, name):
    monkeypatch.setenv("COLUMNS", str(WIDEST))
    assert _too_wide(_short(foucault, name), WIDEST) == []


def _short(foucault, name):
    """Return what is shown of a scene over ten seconds."""
    status, out, _ = foucault("show", name, "--set", "run.t_end=10", "--uncertain", "none")
    assert status == 0
    return out


def _too_wide(text, most):
    return [line for line in text.splitlines() if len(line) > most]


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


def test_show_gives_any_passage_of_an_exact_scene():
    words = ("paris", "--set", "run.t_end=600", "--section", "gate 30", "--section", "turn 0")
    passages = shown(*words, "--passage", "50", "--passage", "2")["passages"]
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
    first = shown(*words[:5])["passages"]
    assert [one["number"] for one in first] == [1, 2, 3]
    (transit,) = shown(*words[:3], "--passage", "3")["passages"]
    assert transit["t_s"] == pytest.approx(float(solved.transits.exact("t")[2]), abs=1e-9)
    (none,) = shown(*words[:3], "--passage", "80")["passages"]
    assert none["reason"] == "the run has 73"


def test_the_passages_of_a_motion_that_cannot_be_solved_are_not_computed(foucault):
    """That is not the same as that there are none."""
    stiff = ("--set", "pendulum.drag=1e9", "--set", "run.t_end=20")
    _, out, _ = foucault("show", "paris", *stiff, "--passage", "3")
    assert "not computed: Stiff: " in out and "no passages" not in out


def test_without_a_passage_asked_for_none_is_computed():
    assert "passages" not in shown("paris", "--set", "run.t_end=600")


@pytest.mark.parametrize("word", ["0", "-1", "many", "3=", "3=±0", "3=wide", "1.5"])
def test_a_wrong_passage_is_refused_before_anything_is_shown(foucault, word):
    status, out, err = foucault("show", "museum_gate", "--passage", word)
    assert (status, out) == (2, "")
    assert err.startswith("foucault: --passage: got ")


def test_a_wanted_width_needs_uncertain_inputs(foucault):
    status, out, err = foucault("show", "paris", "--passage", "3=±0.1")
    assert (status, out) == (2, "") and "--uncertain" in err


def test_ranges_hold_as_far_as_they_go(museum, too_long):
    ranges = too_long["ranges"]
    assert too_long["motion"]["over_s"] == ranges["asked_s"] == "120"
    assert 10 < float(ranges["over_s"]) < 120
    # what is proved is proved: pendulums at the corners of the box are inside
    low, high = map(float, ranges["first_transits_s"][2])
    for angle, length in (("4.5", "12.295"), ("5.5", "12.305")):
        corner = reference.load_scene(
            museum, [f"release.angle={angle}", f"pendulum.length={length}", "run.t_end=20"]
        )
        third = reference.solve(corner, level="computed", digits=10).transits.exact("t")[2]
        assert low <= third <= high


def test_ranges_that_end_early_say_which_input_to_narrow(too_long, long_enough):
    ranges = too_long["ranges"]
    best = ranges["narrowing"]["run"]["alone"][0]
    assert best["input"] == "release.angle"
    assert best["holds_s"] > 1.2 * float(ranges["over_s"])
    # what is said to suffice does
    assert long_enough["ranges"]["over_s"] == "120"
    assert "narrowing" not in long_enough["ranges"]


def test_people_are_told_how_far_the_ranges_go_and_which_run_is_proved(too_long):
    ranges = too_long["ranges"]
    assert f"proved to {ranges['over_s']} s only" in ranges_title(ranges)
    told = text_of(ranges)
    assert f"do not depend on the proof, which ends at {ranges['over_s']} s" in told
    assert "too uncertain for a proof over all 120 s" in told
    assert "To prove all 120 s, narrow release.angle to " in told
    assert f"With the widths as they are, choose run.t_end = {ranges['over_s']}." in told


def test_derivatives_are_those_of_the_part_that_is_proved(too_long):
    """Over a run that ends before them they would be lost."""
    ranges = too_long["ranges"]
    assert ranges["derivatives_over_s"] == ranges["over_s"]
    for limit in ranges["limits"].values():
        low, high = map(float, limit["s_per_unit"])
        assert low < high < low + 1e-6


def test_inputs_too_uncertain_for_any_proof_leave_scene_and_motion(foucault):
    changes = ("pendulum.length=0.2", "pendulum.drag=0.5", "site.gravity=9.81", "run.t_end=2")
    changes += ("release.angle=120", "release.azimuth=0", "site.rotation_rate=0")
    words = ("two_radians", *(word for change in changes for word in ("--set", change)))
    words += ("--uncertain", "angle=±2")
    ranges = shown(*words)["ranges"]
    assert ranges["over_s"] == "0" and "period_s" not in ranges
    status, out, _ = foucault("show", *words)
    assert status == 0
    assert "period" in lines.part(out, "Motion")
    told = lines.part(out, "Ranges: nothing is proved")
    assert "Even with all widths divided by 100 the proof ends at " in told
    assert "The estimates still hold." in told
    assert "run.t_end" not in told  # no run would do


def test_a_passage_that_is_not_proved_has_an_estimate_and_the_input_to_narrow(
    museum, with_passages
):
    ranges = with_passages["ranges"]
    passage, near = ranges["passages"]
    own = shown(museum, "--uncertain", "none", "--passage", "12")["passages"][0]
    assert "t_s" not in passage and "t_s" in near
    assert passage["estimate_s"] == pytest.approx(own["t_s"], abs=1e-9)

    narrowing = ranges["narrowing"]["gate 135 12"]
    assert narrowing["half_width_s"] is None
    best = narrowing["alone"][0]
    assert best["input"] == "release.angle" and best["half_width_s"] < 0.1
    # what is said to suffice does
    again = shown(museum, "--set", "run.t_end=50", *_typed(narrowing["enough"]), "--passage", "12")
    low, high = map(float, again["ranges"]["passages"][0]["t_s"])
    assert low < own["t_s"] < high < low + 0.2

    told = text_of(ranges)
    middle, half_width = passage["estimate_plus_minus_s"]
    low, high = passage["estimate_range_s"]
    assert float(low) < own["t_s"] < float(high)
    estimate = f"estimate {low} to {high} s ({middle} ±{half_width})"
    assert f"passage 12 of gate 135 {estimate} not proved: " in told
    assert "passage 12 of gate 135 is not proved." in told
    assert "To prove it to ±0.1 s, narrow release.angle to " in told


def test_what_to_measure_stands_before_what_a_proof_needs(with_passages):
    """Two questions, which nobody is to take for one."""
    ranges = with_passages["ranges"]
    assert _too_wide("\n".join(ranges_lines(ranges)), WIDEST) == []
    told = text_of(ranges)
    assert "Use the estimates to decide what to measure." in told
    # the tables are those of what was asked for
    assert "Which input limits passage 12 of gate 135, by estimate:" in told
    assert "limits the period" not in told and "Derivatives" not in told
    # by estimate ±0.014 s, and yet not proved
    assert float(ranges["passages"][0]["estimate_plus_minus_s"][1]) < 0.1
    advice = told.index("By estimate it is within ±0.1 s already: no input has to be measured")
    assert advice < told.index("Only if you need a proof") < told.index("To prove it to ±0.1 s")


def test_a_proved_passage_has_its_estimate_inside(with_passages):
    near = with_passages["ranges"]["passages"][1]
    (low, high), (least, most) = (map(float, near[key]) for key in ("t_s", "estimate_range_s"))
    assert low <= least < most <= high
    assert set(near["limits"]) == set(with_passages["ranges"]["uncertain"])


def test_the_lowest_point_is_advised_against_where_its_proof_fails(museum):
    words = ("--set", "run.sections=lowest", "--set", "run.t_end=80", "--passage", "20")
    ranges = shown(museum, *words)["ranges"]
    (passage,) = ranges["passages"]
    # the motion is proved over the whole run, but its lowest points are not decided
    assert ranges["over_s"] == "80" and "t_s" not in passage
    assert "decided, though the motion is proved up to" in passage["reason"]
    assert 'usually reaches further for --section "gate 135"' in text_of(ranges)
    # and so is what a narrower input lacks
    for row in ranges["narrowing"]["lowest 20"]["alone"]:
        assert (row["half_width_s"] is None) == bool(row["reason"])


def test_no_gate_is_advised_in_place_of_a_gate(with_passages):
    assert "gate_across" not in with_passages["ranges"]
    assert "usually reaches further" not in text_of(with_passages["ranges"])


def test_a_passage_within_the_wanted_width_needs_no_narrower_input(with_passages):
    narrowing = with_passages["ranges"]["narrowing"]["gate 135 3"]
    reached_s = [row["half_width_s"] for row in narrowing["alone"]]
    assert reached_s == sorted(reached_s)
    assert reached_s[0] < narrowing["half_width_s"] < 1
    assert narrowing["enough"] == {}


def test_a_precession_that_says_nothing_is_called_useless_beside_its_estimate(long_enough):
    ranges = long_enough["ranges"]
    assert ranges["useless"] == ["precession_deg_per_h"]
    low, high = map(float, ranges["precession_deg_per_h"])
    assert low < -15.05 < 15.05 < high
    first_low, first_high = map(float, ranges["first_order"]["precession_deg_per_h"])
    own = long_enough["motion"]["precession_deg_per_h"]
    assert first_low < own < first_high < first_low + 0.1
    assert re.search(r"precession \S+ to \S+ °/h useless: ", text_of(ranges))


def test_a_precession_that_tells_the_way_is_not_called_useless():
    words = ("paris", "--uncertain", "length=±0.001", "--set", "run.t_end=60")
    assert shown(*words)["ranges"]["useless"] == []


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
    warning = lines.unwrapped(err)
    assert all(meaning in warning for meaning in GRAVITY_MEANINGS.values())
    assert "site.gravity_is" in shown(own)["warnings"][0]
    assert "warning" not in foucault("show", own, "--set", "site.gravity_is=effective")[2]
    assert "warning" not in foucault("show", "paris", "--set", "run.t_end=20")[2]


def test_a_bob_that_creeps_is_said_to_and_its_drag_is_warned_of(foucault, museum):
    words = ("show", museum, "--uncertain", "none", "--set", "run.t_end=20")
    _, out, err = foucault(*words, "--set", "pendulum.drag=20")
    assert "no period The bob creeps back to rest" in lines.part(out, "Motion")
    assert "drag 20 1/s is at least 2 sqrt(g/l) = 1.79 1/s" in lines.unwrapped(out)
    assert "halves" not in out
    assert "for a swing that halves in 20 min write 2 ln 2/1200" in lines.unwrapped(err)
    # a time of 20 minutes, as a rate
    _, out, err = foucault(*words, "--set", "pendulum.drag=0.0011552")
    assert "drag 0.0011552 1/s (the swing halves in 20 minutes)" in lines.unwrapped(out)
    assert "drag" not in err


def test_the_ranges_of_a_bob_that_creeps_say_so_too(museum):
    changes = ("--set", "pendulum.drag=20", "--set", "run.t_end=10")
    ranges = shown(museum, *changes)["ranges"]
    told = text_of(ranges)
    assert "no estimate The bob creeps back to rest" in told
    assert "no period" not in told and "Derivatives" not in told
    assert "Use the estimates" not in told


def test_of_uncertain_inputs_only_the_digits_that_they_leave_are_shown(foucault, museum):
    words = ("show", museum, "--set", "run.t_end=20")
    out = foucault(*words)[1]
    told = lines.unwrapped(out)
    assert re.search(r"period 7\.038\d* ±0\.0\d+ s", told)
    # below what they allow
    assert "hangs" not in told and "double precision" not in told
    document = json.loads(foucault(*words, "--json")[1])
    assert "doubles" in document and "rest_y_m" in document["derived"]
    # which inputs have a width, and which of those that people measure have none
    assert "uncertain pendulum.length ±0.005 m release.angle ±0.5 degrees" in told
    exact = (
        "pendulum.drag, site.latitude, site.gravity, release.angle_rate and release.azimuth_rate"
    )
    assert f"without width {exact}: taken as exact" in told


def test_exact_inputs_have_no_widths_and_all_their_digits(foucault, museum):
    """Even if the scene has widths."""
    words = ("show", museum, "--set", "run.t_end=20", "--uncertain", "none")
    told = lines.unwrapped(foucault(*words)[1])
    assert "±" not in told and "uncertain" not in told and "without width" not in told
    assert re.search(r"period 7\.038\d{7,} s", told)
    assert "hangs" in told and "double precision" in told


def test_the_width_of_the_option_is_the_one_that_is_shown(foucault, museum):
    words = ("show", museum, "--set", "run.t_end=20", "--uncertain", "length=±0.002")
    told = lines.unwrapped(foucault(*words)[1])
    assert "pendulum.length ±0.002 m" in told and "±0.005 m" not in told


def test_a_transit_is_said_to_be_a_turning_point(foucault):
    out = foucault("show", "paris", "--set", "run.t_end=60", "--passage", "3")[1]
    assert "transit 3 (turning point in x) 24.653" in lines.unwrapped(out)


@pytest.mark.parametrize(
    ("azimuth", "bearing"),
    [
        ("-135", "225°, south-west"),
        ("0", "90°, east"),
        ("90", "0°, north"),
        ("101.5", "348.5°, north-north-west"),
        ("102", "348°, north-north-west"),
        ("79", "11°, north"),
        ("360", "90°, east"),
    ],
)
def test_an_azimuth_has_its_compass_bearing_beside_it(azimuth, bearing):
    changes = [f"release.azimuth={azimuth}", "release.angle=5"]
    scene = reference.load_scene("two_radians", changes)
    pairs = dict(input_facts(scene, {}, {}))
    assert f"azimuth {azimuth}° (bearing {bearing})" in pairs["release"]


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
    assert "bits" in shown(wide)["ranges"]["reason"]
