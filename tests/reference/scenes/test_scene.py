"""Scenes: exact numbers, inputs read as decimal or binary64, and refusals that name the field."""

from __future__ import annotations

import json
import tomllib
from fractions import Fraction
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sampled import one_in
from schemas import path_of, schema_of
from small_scenes import make_scene

from reference.commands.template import scene_file
from reference.commands.terminal import replacements
from reference.errors import InputError
from reference.scenes.inputs import Inputs
from reference.scenes.scene import as_scene, field_names, is_scene_id, load_scene, parse_scene
from reference.scenes.shipped import scene_ids


def test_a_decimal_is_the_decimal_and_not_the_double_next_to_it(paris):
    assert paris.exact.latitude == Fraction(48846111, 1000000)
    assert paris.exact.latitude != Fraction(48.846111)


def test_binary64_rounds_each_input_to_the_nearest_double_first(paris):
    rounded = paris.with_values(["inputs=binary64"]).exact
    assert rounded.latitude == Fraction(48.846111)
    assert rounded.gravity == Fraction(9.80665)
    assert rounded.flattening == 1 / Fraction(298.257223564)
    assert rounded.position == (Fraction(0.3), Fraction(0.4), 0, 0)


@given(st.decimals(min_value=-(10**6), max_value=10**6, allow_nan=False, places=8))
def test_any_decimal_altitude_is_read_exactly(value):
    assert make_scene(site={"altitude": format(value, "f")}).exact.altitude == Fraction(value)


def test_every_shipped_scene_is_named_like_its_file():
    assert {"paris", "pantheon", "pole", "equator", "southern", "spherical"} <= set(scene_ids())
    for name in scene_ids():
        assert load_scene(name).id == name


def test_missing_fields_take_the_papers_values():
    scene = parse_scene({"id": "bare", "release": {"x": "0.3", "y": "0.4"}})
    assert scene.exact == load_scene("paris").exact
    assert scene.run.digits == 40
    assert scene.run.level == "confirmed"


def test_the_grid_ends_at_t_end_even_off_the_step():
    assert make_scene(run={"t_end": "100", "grid_step": "60"}).exact.grid == [0, 60, 100]
    assert make_scene(run={"t_end": "120", "grid_step": "60"}).exact.grid == [0, 60, 120]


def test_set_replaces_one_field_and_leaves_the_rest(paris):
    changed = paris.with_values(["site.latitude=0", "flags=a,b"])
    assert changed.exact.latitude == 0
    assert changed.flags == ("a", "b")
    assert changed.pendulum == paris.pendulum


def test_an_unquoted_whole_number_is_exact_and_allowed(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text('id = "s"\n[pendulum]\nlength = 67\n[release]\nx = "0.3"\ny = "0"\n')
    assert load_scene(path).exact.length == 67


def test_a_byte_order_mark_does_no_harm(tmp_path):
    path = tmp_path / "s.toml"
    path.write_bytes(
        b'\xef\xbb\xbfid = "s"\n[pendulum]\nlength = "67"\n[release]\nx = "0.3"\ny = "0"\n'
    )
    assert load_scene(path).exact.length == 67


REFUSED = [
    ("length of 0", {"pendulum": {"length": "0"}}, "pendulum.length", "above 0"),
    ("negative length", {"pendulum": {"length": "-1"}}, "pendulum.length", "above 0"),
    ("not a number", {"pendulum": {"length": "long"}}, "pendulum.length", "decimal number"),
    ("NaN", {"site": {"gravity": "nan"}}, "site.gravity", "decimal number"),
    ("infinity", {"site": {"gravity": "inf"}}, "site.gravity", "decimal number"),
    ("a bare float", {"site": {"gravity": 9.8}}, "site.gravity", "in quotes"),
    ("an absurd exponent", {"site": {"gravity": "1e999999999"}}, "site.gravity", "between"),
    ("latitude beyond 90", {"site": {"latitude": "90.0001"}}, "site.latitude", "at most 90"),
    ("latitude below -90", {"site": {"latitude": "-91"}}, "site.latitude", "at least -90"),
    (
        "a prolate Earth",
        {"site": {"inverse_flattening": "0.5"}},
        "site.inverse_flattening",
        "above 1",
    ),
    ("negative drag", {"pendulum": {"drag": "-1"}}, "pendulum.drag", "at least 0"),
    ("unknown key", {"site": {"lattitude": "1"}}, "site.lattitude", "a field that scenes have"),
    ("unknown table", {"planet": {}}, "planet", "a field that scenes have"),
    ("a number for a table", {"site": 3}, "site", "[site]"),
    ("off the sphere", {"release": {"x": "60", "y": "40"}}, "release", "x² + y² less than"),
    (
        "on the equator of the sphere",
        {"release": {"x": "67", "y": "0"}},
        "release",
        "x² + y² less than",
    ),
    ("no release", {"release": {}}, "release", "x and y"),
    ("half a release", {"release": {"x": "1"}}, "release.y", "a value"),
    ("two kinds of release", {"release": {"x": "1", "y": "1", "angle": "3"}}, "release", "either"),
    (
        "angle beyond the top",
        {"release": {"angle": "181", "azimuth": "0"}},
        "release.angle",
        "at most 180",
    ),
    ("digits 0", {"run": {"digits": 0}}, "run.digits", "from 1 to 1000"),
    ("digits absurd", {"run": {"digits": 10**9}}, "run.digits", "from 1 to 1000"),
    ("digits as a truth value", {"run": {"digits": True}}, "run.digits", "from 1 to 1000"),
    ("digits as a word", {"run": {"digits": "many"}}, "run.digits", "whole number"),
    ("half a digit", {"run": {"digits": 3.5}}, "run.digits", "whole number"),
    ("unknown level", {"run": {"level": "perfect"}}, "run.level", "computed"),
    ("transits as a word", {"run": {"transits": "perhaps"}}, "run.transits", "true or false"),
    ("no time", {"run": {"t_end": "0"}}, "run.t_end", "above 0"),
    ("grid too fine", {"run": {"grid_step": "1e-9"}}, "run.grid_step", "grid times"),
    ("digits huge", {"run": {"digits": 16**5000}}, "run.digits", "whole number"),
    (
        "an exponent no Decimal has",
        {"release": {"x": "1e99999999999999999999", "y": "0"}},
        "release.x",
        "between",
    ),
    (
        "a zero that costs a power of ten",
        {"site": {"gravity": "0e999999999"}},
        "site.gravity",
        "between",
    ),
    ("Arabic digits", {"site": {"gravity": "٩"}}, "site.gravity", "decimal number"),
    ("an Arabic exponent", {"site": {"gravity": "1e٣"}}, "site.gravity", "decimal number"),
    ("Arabic digits of digits", {"run": {"digits": "٤٠"}}, "run.digits", "whole number"),
    ("an escape in the title", {"title": "\x1b[31m"}, "title", "one line of text"),
    ("two lines of source", {"source": "a\nb"}, "source", "one line of text"),
    ("a flag that turns the line", {"flags": ["a", "\u202e"]}, "flags.1", "one line of text"),
    ("a title that is no text", {"title": 3}, "title", "text in quotes"),
    ("flags that are no list", {"flags": "polar"}, "flags", "a list of words"),
    ("id with a path", {"id": "../paris"}, "id", "lower-case"),
    ("unknown reading", {"inputs": "float"}, "inputs", "decimal"),
]


@pytest.mark.parametrize(
    ("sections", "field", "expected"), [row[1:] for row in REFUSED], ids=[row[0] for row in REFUSED]
)
def test_bad_input_names_the_field_and_what_was_expected(sections, field, expected):
    with pytest.raises(InputError) as caught:
        make_scene(
            **{"scene_id": sections.pop("id", "test")} if "id" in sections else {}, **sections
        )
    assert caught.value.field == field
    assert expected in str(caught.value)
    assert caught.value.exit_status == 2


# as decimals in range, as doubles not: too large, rounded to 0, rounded onto an end that is excluded
NOT_AS_DOUBLES = [
    ("site.gravity=1e400", "of absolute value at most 1.8e+308"),
    ("site.altitude=-1e309", "of absolute value at most 1.8e+308"),
    ("site.inverse_flattening=1e399", "of absolute value at most 1.8e+308"),
    ("site.inverse_flattening=1.0000000000000000000001", "above 1"),
    ("pendulum.length=1e-350", "above 0"),
    ("run.grid_step=1e-350", "above 0"),
]


@pytest.mark.parametrize(("assignment", "expected"), NOT_AS_DOUBLES)
def test_ranges_hold_for_the_numbers_as_they_are_read(paris, assignment, expected):
    with pytest.raises(InputError) as caught:
        paris.with_values(["inputs=binary64", assignment])
    assert caught.value.field == assignment.partition("=")[0]
    assert expected in str(caught.value)
    assert "read as binary64" in str(caught.value)


@pytest.mark.parametrize("command", [("score",), ("study", "--methods", "heyoka_double")])
def test_commands_that_read_doubles_name_the_field_too(foucault, tmp_path, command):
    path = tmp_path / "two.csv"
    path.write_text("t,x,y\n0,0.3,0.4\n60,0.1,0.2\n")
    name, *more = command
    status, _, err = foucault(name, "paris", *(more or [path]), "--set", "site.gravity=1e400")
    assert (status, err.partition(", expected")[0]) == (2, "foucault: site.gravity: got '1e400'")


def test_a_missing_id_is_asked_for():
    with pytest.raises(InputError, match="id: got nothing"):
        parse_scene({"release": {"x": "0", "y": "0"}})


@pytest.mark.parametrize("word", ["atlantis", "no/such/file.toml"])
def test_an_unknown_scene_is_told_which_command_lists_them(word):
    with pytest.raises(InputError, match="`foucault scenes` lists the ids"):
        load_scene(word)


@pytest.mark.parametrize("text", [b"id = ", b"\xff\xfe", b"[a\n"])
def test_broken_toml_is_refused_by_name(tmp_path, text):
    path = tmp_path / "broken.toml"
    path.write_bytes(text)
    with pytest.raises(InputError, match="a TOML file"):
        load_scene(path)


def test_a_folder_is_no_scene(tmp_path):
    with pytest.raises(InputError, match=r"a readable file\. It is a folder"):
        load_scene(Path(f"{tmp_path}/"))


@pytest.mark.parametrize("assignment", ["site.latitude", "=3", "a.b.c=1", "site..x=1", "id.x=2"])
def test_a_broken_assignment_is_refused(paris, assignment):
    with pytest.raises(InputError):
        paris.with_values([assignment])


EVERY_TYPE = [
    "true", "false", "0", "5", "1.5", "nan", "inf", "1979-05-27", "1979-05-27T07:32:00Z", "07:32:00", '""', '"x"',
    "[]", "[5]", "[true]", "[1.5]", "[[]]", "[{}]", '["highest", 5]', "{}", "{ a = 1 }", "{ a = { b = 1 } }",
]  # fmt: skip


FIELDS = [
    *field_names(),
    "pendulum",
    "site",
    "release",
    "run",
    "uncertain",
    "uncertain.pendulum.length",
]


@pytest.mark.parametrize("name", FIELDS)
def test_a_value_of_any_type_is_taken_or_refused_by_the_name_of_its_field(tmp_path, name):
    table = name.partition(".")[0]
    others = "" if table == "release" else 'release.x = "1"\nrelease.y = "0"\n'
    path = tmp_path / "typed.toml"
    for value in EVERY_TYPE:
        path.write_text(f"{name} = {value}\n{others}")
        try:
            load_scene(path)
        except InputError as error:
            assert error.field.partition(".")[0] == table


NO_SECTIONS = [
    "true",
    "false",
    "0",
    "5",
    "1.5",
    "1979-05-27",
    "[5]",
    "[[]]",
    "[{}]",
    '["highest", true]',
    "{ a = 1 }",
]


@pytest.mark.parametrize("value", NO_SECTIONS)
def test_sections_are_a_list_of_words(tmp_path, value):
    path = tmp_path / "mine.toml"
    path.write_text(f'[release]\nx = "1"\ny = "0"\n[run]\nsections = {value}\n')
    with pytest.raises(
        InputError, match=r"a list of words: highest, .* Write each in quotes: sections = "
    ) as caught:
        load_scene(path)
    assert caught.value.field == "run.sections"


@given(st.lists(st.sampled_from("ab_7-.A/ \n\0é٣"), max_size=9).map("".join))
def test_only_plain_words_are_ids(text):
    if is_scene_id(text):
        assert "/" not in text
        assert "." not in text
        assert text[0].islower()


def test_a_release_at_rest_is_known_as_such(paris):
    assert paris.exact.at_rest
    assert not paris.with_values(["release.vy=1e-30"]).exact.at_rest
    assert not make_scene(
        release={"angle": "10", "azimuth": "0", "azimuth_rate": "1"}
    ).exact.at_rest
    assert isinstance(paris.exact, Inputs)


def test_a_grid_read_as_binary64_does_not_come_to_its_end_twice():
    scene = make_scene(inputs="binary64", run={"t_end": "0.2", "grid_step": "0.0005"})
    grid = scene.exact.grid
    assert len(grid) == 401
    assert [float(t) for t in grid] == sorted({float(t) for t in grid})
    assert grid[-1] == Fraction(0.2)


def test_all_mistakes_of_a_file_are_told_at_once(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(
        'titel = "a"\n[pendulum]\nlenght = 3\ndrag = "-1"\n[site]\nlatitude = 95\n',
        encoding="utf-8",
    )
    with pytest.raises(InputError) as caught:
        load_scene(path)
    first, *lines = str(caught.value).splitlines()
    assert first == "5 mistakes:"
    fields = [line.strip().partition(":")[0] for line in lines]
    assert fields == ["pendulum.drag", "pendulum.lenght", "site.latitude", "release", "titel"]
    with pytest.raises(InputError, match=r"(?s)2 mistakes:.*release: .*run\.grid_step: "):
        load_scene("paris", ["release.angle=3", "run.grid_step=1e-9"])


@pytest.mark.parametrize(
    ("name", "own"),
    [("church.toml", "church"), ("My hall-2.toml", "my_hall_2"), ("2nd.toml", None)],
)
def test_a_file_without_an_id_is_named_after_itself(tmp_path, name, own):
    path = tmp_path / name
    path.write_text('[release]\nx = "0.3"\ny = "0"\n', encoding="utf-8")
    if own:
        assert load_scene(path).id == own
    else:
        with pytest.raises(InputError, match=r"id: got '2nd\.toml', expected an id in the file"):
            load_scene(path)


@pytest.mark.parametrize("name", one_in(5, scene_ids()))
def test_a_scene_as_a_template_is_the_same_scene_and_follows_the_schema(tmp_path, name):
    scene = load_scene(name)
    path = tmp_path / f"{name}.toml"
    path.write_text(scene_file(scene), encoding="utf-8")
    assert load_scene(path) == scene
    jsonschema.validate(tomllib.loads(path.read_text(encoding="utf-8")), schema_of("scene.json"))


def test_a_template_shows_how_to_write_what_is_uncertain(tmp_path):
    begin, sign, widths = scene_file(None).partition("# [uncertain]")
    path = tmp_path / "mine.toml"
    path.write_text(begin + (sign + widths).replace("# ", "", 1).replace("\n# ", "\n"))
    assert load_scene(path).uncertain["pendulum.length"] == "±0.001"


def test_the_schema_of_scenes_is_the_one_that_the_code_has():
    schema = json.loads(path_of("scene.json").read_text(encoding="utf-8"))
    assert schema == schema_of("scene.json"), "run: python tests/helpers/schemas.py"
    scene = {"id": "a", "release": {"x": "0.3", "y": 0}}
    jsonschema.validate(scene, schema)
    for wrong in ({"release": {"x": 0.3}}, {"site": {"gravity": "nan"}}, {"titel": "a"}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**scene, **wrong}, schema)


def test_a_trajectory_in_place_of_a_scene_is_told(tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_text("t,x,y\n0,1,0\n")
    with pytest.raises(InputError, match=r"foucault score SCENE mine\.csv"):
        load_scene(tmp_path / "mine.csv")


def test_a_number_as_numpy_prints_it_is_told() -> None:
    with pytest.raises(InputError, match=r"pendulum.length: got 'np.float64\(2.5\)'.* write 2.5,"):
        load_scene("paris", ["pendulum.length=np.float64(2.5)"])


def test_an_option_may_say_what_set_says() -> None:
    assert replacements(["run.t_end=600"], {"--t-end": ("run.t_end", "600")}) == ["run.t_end=600"]
    with pytest.raises(InputError, match=r"together with --set run\.t_end=600"):
        replacements(["run.t_end=600"], {"--t-end": ("run.t_end", "601")})


def test_floats_in_python_stand_for_the_decimals_that_python_prints() -> None:
    nested = {
        "id": "a",
        "pendulum": {"length": 12.3},
        "release": {"x": np.float64(0.1), "y": np.float32(0.5)},
    }
    scene = as_scene(nested)
    assert (scene.pendulum.length, scene.release.x, scene.release.y) == ("12.3", "0.1", "0.5")
    with pytest.raises(InputError, match="NaN and inf"):
        as_scene({**nested, "release": {"x": float("nan"), "y": 0}})


def test_widths_of_inputs_have_their_names_in_quotes_or_not_and_their_sign_or_not(
    tmp_path: Path,
) -> None:
    path = tmp_path / "hall.toml"
    path.write_text(
        '[release]\nx = "1"\ny = "0"\n'
        '[uncertain]\n"pendulum.length" = "0.001"\nsite.gravity = "±1e-4"\nsite.latitude = "0.01"\n'
    )
    widths = {"pendulum.length": "±0.001", "site.gravity": "±1e-4", "site.latitude": "±0.01"}
    scene = load_scene(path, ["site.latitude=50"])
    assert scene.uncertain == widths and not load_scene("paris").uncertain
    assert parse_scene(scene.model_dump(exclude_none=True)) == scene
    path.write_text(scene_file(scene), encoding="utf-8")
    assert load_scene(path) == scene
    jsonschema.validate(tomllib.loads(path.read_text(encoding="utf-8")), schema_of("scene.json"))
    path.write_text('[release]\nx = "1"\ny = "0"\n[uncertain]\n"pendulum.length" = "0"\n')
    with pytest.raises(
        InputError, match=r"uncertain\.pendulum\.length: got '0', expected a number above 0"
    ):
        load_scene(path)
