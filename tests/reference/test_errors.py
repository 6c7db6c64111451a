"""Nearest names: few, in any case, and never a whole list."""

from __future__ import annotations

import pytest

from reference import InputError, load_scene, scene_ids
from reference.errors import (
    NOTHING,
    Described,
    NoEffectError,
    counted,
    did_you_mean,
    in_words,
    nearest,
)
from reference.scenes.scene import field_names


@pytest.mark.parametrize(
    ("word", "names"),
    [
        ("pariss", ["paris"]),
        ("Paris", ["paris"]),
        ("PARIS_30D", ["paris_30d"]),
        ("vertical", ["vertical_picometre", "vertical_micrometre"]),
        ("atlantis", []),
        ("", []),
    ],
)
def test_the_nearest_names_are_those_alike_in_any_case_or_containing_the_word(word, names):
    assert sorted(nearest(word, scene_ids())) == sorted(names)


def test_there_are_at_most_five_names():
    assert (
        nearest("name", [f"name_{i}" for i in range(9)])
        and len(nearest("name", map("name_{}".format, range(9)))) == 5
    )


def test_of_names_that_contain_the_word_the_shortest_stand_first():
    assert nearest("dop853", ["numbalsoda_dop853", "rk4", "scipy_dop853"]) == [
        "scipy_dop853",
        "numbalsoda_dop853",
    ]


def test_one_of_a_kind_has_no_plural():
    assert [counted(number, "row") for number in (0, 1, 2)] == ["0 rows", "1 row", "2 rows"]


def test_names_are_joined_as_in_a_sentence():
    assert [in_words(names) for names in (["a"], ["a", "b"], ["a", "b", "c"])] == [
        "a",
        "a or b",
        "a, b or c",
    ]
    assert did_you_mean("pari", ["paris"], "") == "Did you mean paris?"
    assert did_you_mean("zzz", ["paris"], "Look.") == "Look."


@pytest.mark.parametrize(
    ("assignment", "advice"),
    [
        ("site.lattitude=3", "Did you mean site.latitude or site.altitude?"),
        ("lattitude=3", "site.latitude"),
        ("sight.latitude=3", "Did you mean site?"),
        ("run.Digits=3", "Did you mean run.digits?"),
        ("zzzz=3", "`foucault show SCENE` lists them."),
    ],
)
def test_an_unknown_field_is_answered_with_the_nearest_fields(assignment, advice):
    with pytest.raises(InputError, match="expected a field that scenes have") as refused:
        load_scene("paris", [assignment])
    assert advice in refused.value.advice


def test_every_field_of_a_scene_has_a_name_that_set_takes():
    names = field_names()
    assert {"inputs", "title", "site.latitude", "release.azimuth", "run.t_end"} < set(names)
    assert "site" not in names
    for name in names:
        with pytest.raises(InputError) as refused:
            load_scene("paris", [f"{name}=\0", "release.mistake=1"])
        assert (
            "mistake" in str(refused.value) or refused.value.expected != "a field that scenes have"
        )


@pytest.mark.parametrize("word", ["", "  "])
def test_an_empty_scene_is_told_what_a_scene_is(word):
    with pytest.raises(InputError, match="expected a scene's id or the path of a TOML file"):
        load_scene(word)


def test_what_a_user_gave_is_quoted_and_what_we_describe_is_not():
    assert str(InputError("SCENE", "pari", "a scene")) == "SCENE: got 'pari', expected a scene."
    assert str(InputError("SCENE", NOTHING, "a scene")) == "SCENE: got nothing, expected a scene."
    described = InputError("run.csv", Described("no rows\x1b[2J"), "at least one row")
    assert str(described) == "run.csv: got no rows\\x1b[2J, expected at least one row."
    assert described.got == "no rows\x1b[2J"


def test_an_option_without_effect_is_named_with_the_case_and_is_a_users_mistake():
    error = NoEffectError("--timeout", "3", "without --run")
    assert isinstance(error, InputError) and error.exit_status == 2
    assert str(error) == "--timeout: has no effect without --run. Leave it out."
