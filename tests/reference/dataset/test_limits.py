"""Limits of what `verify` reads, lists and lets pass, each tried on both sides."""

from __future__ import annotations

import json
import shutil
from fractions import Fraction
from pathlib import Path

import pytest
from forgery import forge, moved, seal
from pydantic import TypeAdapter, ValidationError
from small_scenes import make_scene

import reference
from reference.dataset.files import read_files
from reference.dataset.manifest import (
    ALWAYS,
    MANIFEST,
    Count,
    Decimals,
    Manifest,
    Name,
    Text,
    differences,
)
from reference.dataset.place import MAX_ID, dataset_id
from reference.dataset.record import bounds_of
from reference.dataset.verify import problems_of, verify
from reference.dataset.write import write
from reference.errors import DatasetError
from reference.numbers.precision import fixed_decimal


def problems(dataset):
    """All problems in one text."""
    return "\n".join(verify(dataset).problems)


def test_twenty_problems_are_listed_at_most(dataset):
    forge(
        dataset,
        transits=lambda rows, _: [row.__setitem__(3, moved(row[3], Fraction(1))) for row in rows],
    )
    assert len(verify(dataset).problems) == len(problems_of(dataset)) == 20


@pytest.mark.parametrize("more", [-1, 0, 1, 2])
def test_twenty_foreign_files_are_named_and_the_others_counted(dataset, more):
    for k in range(20 + more):
        (dataset / f"{k}.txt").touch()
    notes = [
        note
        for note in verify(dataset).foreign
        if "not part of the dataset" in note or note.startswith("and ")
    ]
    assert len(notes) == min(20, 20 + more) + (more > 0)
    assert (notes[-1] == f"and {more} more") is (more > 0)


def test_what_is_too_large_is_not_read(dataset):
    """No machine has the memory for this grid.csv."""
    with (dataset / "grid.csv").open("r+b") as stream:
        stream.truncate(1 << 40)
    assert f"grid.csv: {1 << 40} bytes, the manifest says" in problems(dataset)
    for more in (1, 0):
        with (dataset / MANIFEST).open("r+b") as stream:
            stream.truncate((1 << 20) + more)
        assert ("1048577 bytes, 1048576 are the most" in problems(dataset)) is bool(more)


@pytest.mark.parametrize(
    ("kind", "least", "most"),
    [(Count, 0, 10**10), (Decimals, 0, 2000), (Name, "", "x" * 400), (Text, "", "x" * 20_000)],
)
def test_what_a_manifest_counts_and_says_has_a_least_and_a_most(kind, least, most):
    check = TypeAdapter(kind).validate_python
    assert (check(least), check(most)) == (least, most)
    for beyond in (most + "x",) if isinstance(most, str) else (least - 1, most + 1):
        with pytest.raises(ValidationError):
            check(beyond)


def sealed(dataset, name, old, new):
    """Write a file with a text in it replaced, and a seal that fits."""
    files = read_files(dataset)
    assert old in files.texts[name]
    text = files.texts[name].replace(old, new, 1)
    seal(dataset, json.loads((dataset / MANIFEST).read_text()), {**files.texts, name: text})


def test_a_dataset_needs_the_files_of_every_one_and_no_others(dataset):
    document = json.loads((dataset / MANIFEST).read_text())
    files = {name: document["files"][name] for name in (*ALWAYS, "transits.csv")}
    assert set(Manifest.model_validate({**document, "files": files}).files) == {
        *ALWAYS,
        "transits.csv",
    }
    for name in ALWAYS:
        with pytest.raises(ValidationError, match=f"files: {name} and transits.csv must be there"):
            Manifest.model_validate(
                {**document, "files": {other: files[other] for other in ALWAYS if other != name}}
            )


def placed(**cells):
    """Return a change of a table: texts by column and row, each row known by its number."""

    def change(rows, header):
        for column, texts in cells.items():
            for row, text in texts.items():
                cell = rows[row][header.index(column)]
                places = len(cell.partition(".")[2])
                rows[row][header.index(column)] = (
                    fixed_decimal(Fraction(text), places) if column != "bound" else text
                )

    return change


@pytest.mark.parametrize(
    ("row", "t", "bound", "outside"),
    [
        (0, "-0.9", "1", False),
        (0, "-1", "1", True),
        (-1, "302", "2", False),
        (-1, "302.1", "2", True),
    ],
)
def test_transits_lie_after_the_release_and_up_to_the_end_as_far_as_their_bounds_tell(
    dataset, row, t, bound, outside
):
    """The run ends at 300 s."""
    forge(dataset, transits=placed(t={row: t}, bound={row: f"{bound}.0e+00"}))
    assert ("outside (0, t_end]" in problems(dataset)) is outside


@pytest.mark.parametrize(("second", "found"), [("8.0", False), ("7.9", True)])
def test_transits_whose_bounds_touch_are_in_order_and_others_are_not(dataset, second, found):
    forge(dataset, transits=placed(t={0: "10", 1: second}, bound={0: "1.0e+00", 1: "1.0e+00"}))
    assert ("transits.csv: transits 1 and 2 are not in order" in problems(dataset)) is found


@pytest.mark.parametrize(("word", "found"), [("complete", True), ("undecided intervals", False)])
def test_transits_alternate_unless_some_may_be_undecided(dataset, word, found):
    def turn(rows, _):
        rows[1][2] = rows[0][2]

    forge(dataset, transits=turn, manifest=lambda document: document.update(transits=word))
    assert ("transits.csv: transits 1 and 2 do not alternate" in problems(dataset)) is found


def test_transits_at_which_the_cord_is_nearly_level_pass(tmp_path):
    """There vz = -(x vx + y vy)/z bends within |z|, a ten-millionth of the cord's length."""
    solution = reference.solve(
        reference.load_scene("over_top"), t_end="10", digits=10, level="computed"
    )
    assert min(map(abs, solution.transits.exact("z"))) < 1e-7
    assert problems_of(write(solution, tmp_path / "over")) == []


def test_a_transit_at_which_the_cord_is_level_passes_and_its_place_is_checked(tmp_path):
    """There nothing in the table tells vz; a planar swing through a right angle has xdot = 0 just there."""
    solution = reference.solve(
        reference.load_scene("separatrix"), t_end="0.3", digits=10, level="computed"
    )
    assert max(map(abs, solution.transits.exact("z"))) < 1e-15
    folder = write(solution, tmp_path / "level")
    assert problems_of(folder) == []

    def lift(rows, header):
        rows[0][header.index("z")] = "0.010000000"

    forge(folder, transits=lift)
    found = problems(folder)
    assert "distance 1 m from the pivot" in found and "ax = -18" in found


def test_the_doubles_have_the_words_of_the_decimals(dataset):
    files = read_files(dataset)
    row = files.texts["transits.binary64.csv"].splitlines()[3]
    cells = row.split(",")
    for place, new in ((0, "9"), (2, "-1" if cells[2] == "+1" else "+1"), (8, "1.0e-05")):
        copy = Path(shutil.copytree(dataset, dataset.with_name(f"other {place}")))
        sealed(
            copy, "transits.binary64.csv", row, ",".join([*cells[:place], new, *cells[place + 1 :]])
        )
        assert "row 3 has another direction, number or bound" in problems(copy)


def test_a_double_in_other_digits_than_its_own_is_found(dataset):
    """The seventeenth digit of a double does not always change it, and then only the text is wrong."""
    row = read_files(dataset).texts["grid.binary64.csv"].splitlines()[1]
    x = row.split(",")[1]
    assert float(x) == 0.3
    sealed(dataset, "grid.binary64.csv", x, "3.0000000000000000e-01")
    assert "x = 3.0000000000000000e-01 is not written with the digits of 0.3" in problems(dataset)


def test_the_id_of_a_users_own_scene_names_changes_that_it_has(tmp_path):
    scene = make_scene(
        "mine", site={"latitude": "1"}, run={"t_end": "60", "digits": 8, "level": "computed"}
    )
    solution = reference.solve(scene)
    for name in ("mine", "mine+site.latitude=1", "mine+site.latitude=1,release.x=0.3"):
        assert problems_of(write(solution, tmp_path / name, name)) == []
    for name in (
        "yours",
        "mine+site.latitude=2",
        "mine+site.latitude=1,release.x=0.4",
        "mine.decimal",
    ):
        with pytest.raises(DatasetError, match="does not follow from the scene"):
            write(solution, tmp_path / name, name)


@pytest.mark.parametrize("length, whole", [(MAX_ID, True), (MAX_ID + 1, False)])
def test_an_id_of_more_than_160_characters_is_a_hash(paris, length, whole):
    change = "pendulum.length=67."
    number = "67." + "1" * (length - len("paris+") - len(change))
    found = dataset_id(paris.with_values([f"pendulum.length={number}"]))
    assert MAX_ID == 160
    assert (found == f"paris+pendulum.length={number}") is whole
    assert len(found) == (length if whole else len("paris+sha256=") + 16)


@pytest.mark.parametrize(
    ("t", "bound", "vx", "found"),
    [
        ("57.5", "1.0e-01", "1", False),
        ("57.5", "1.0e-01", "-1", True),
        ("60.1", "1.0e-01", "-1", False),
        ("60.1", "9.9e-02", "-1", False),
        ("59.9", "1.0e-01", "-1", False),
        ("59.9", "9.9e-02", "-1", True),
        ("57.5", "1.0e-01", "0", False),
    ],
)
def test_between_transits_xdot_has_one_sign_but_within_the_bound_of_a_time(
    dataset, t, bound, vx, found
):
    """The seventh transit of Paris, after which xdot is positive, may be where the grid has a row, at 60 s."""
    forge(dataset, grid=placed(vx={1: vx}), transits=placed(t={6: t}, bound={6: bound}))
    assert (
        "grid.csv: t = 60: the sign of vx contradicts the transits before it" in problems(dataset)
    ) is found


@pytest.mark.parametrize(
    ("change", "count"), [(lambda row: f"{row},0", 8), (lambda row: row.rpartition(",")[0], 6)]
)
def test_a_row_with_a_number_too_many_or_too_few_is_told_with_both_counts(dataset, change, count):
    row = (dataset / "grid.csv").read_text().splitlines()[2]
    sealed(dataset, "grid.csv", row, change(row))
    assert f"row 2: {count} numbers, not 7" in problems(dataset)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ({"a": {"b": 1, "c": 2}}, {"a": {"b": 1, "c": 3}}, [("a.c", 2, 3)]),
        ({"a": {"b": 1}}, {"a": None}, [("a", {"b": 1}, None)]),
        ({"a": None}, {"a": {"b": 1}}, [("a", None, {"b": 1})]),
        ({"a": [1, {"b": 2}]}, {"a": [1, {"b": 3}]}, [("a[1].b", 2, 3)]),
        ({"a": [1]}, {"a": [1, 2]}, [("a", [1], [1, 2])]),
        ({"a": [1]}, {"a": 1}, [("a", [1], 1)]),
        ({"a": 1, "b": 2}, {"b": 2}, [("a", 1, None)]),
    ],
)
def test_where_two_documents_differ_is_told_with_both_values(old, new, told):
    """A whole section or list stands there where the other document has none, or has a longer one."""
    assert [*differences(old, new)] == told
    assert [*differences(new, old)] == [(place, two, one) for place, one, two in told]


@pytest.fixture(scope="module")
def proved(tmp_path_factory):
    pytest.importorskip("flint")
    solution = reference.solve(
        "paris", t_end="20", digits=12, level="enclosed", confirm="none", audit=False
    )
    return write(solution, tmp_path_factory.mktemp("proved") / "paris")


@pytest.mark.parametrize(
    ("kind", "proof", "right", "wrong"),
    [
        ("grid", False, ["0.50", "1.0"], ["0.49", "1.1"]),
        # whose states two runs know less closely
        ("transits", False, ["0.50", "1.0", "9.0"], ["0.49"]),
        ("transits", True, ["0.50", "1.0"], ["0.49", "1.1"]),
    ],
)
def test_a_bound_is_from_half_a_unit_to_one_of_the_last_digit(
    original, request, tmp_path, kind, proof, right, wrong
):
    source = request.getfixturevalue("proved") if proof else original
    for units in (*right, *wrong):
        folder = Path(shutil.copytree(source, tmp_path / units / "paris"))

        def change(document, units=units):
            bounds = document["bounds"]
            unit = Fraction(1, 10 ** document["decimals"][kind]["y"])
            bounds[kind]["y"] = f"{float(Fraction(units) * unit):.1e}"
            document["bounds"] = bounds_of(bounds["grid"], bounds["transits"]).model_dump()

        forge(folder, manifest=change)
        said = f"bounds.{kind}.y = "
        assert any(
            said in problem and "half a unit" in problem for problem in problems_of(folder)
        ) is (units in wrong)


def other_sections(document, *words):
    """Have a scene with other sections, and all but the record of its passages say so."""
    document["scene"]["run"]["sections"] = "; ".join(words)
    command = document["command"].partition(" --section")[0]
    document["command"] = " ".join([command, *(f"--section '{word}'" for word in words)])


PASSAGES = {  # what is changed, and what verify says
    "one section less": (
        {"manifest": lambda m: other_sections(m, "highest")}, "sections are not those of the scene: highest"),
    "another order": (
        {"manifest": lambda m: other_sections(m, "gate 30", "highest")},
        "sections are not those of the scene: gate 30, highest"),
    "no undecided passages of one": (
        {"manifest": lambda m: m["sections"]["possible"].pop("highest")}, "sections are not those of the scene"),
    "passages that do not count from 1": (
        {"sections": lambda rows, _: rows[0].__setitem__(1, "2")}, "rows are not those that the manifest counts"),
    "passages in another order": (
        {"sections": lambda rows, _: rows.reverse()}, "rows are not those that the manifest counts"),
    "a bound of less than half a unit": (
        {"manifest": lambda m: m["sections"]["bounds"].update(y="4.9e-15")},
        "sections.bounds.y = 4.9e-15 is less than half a unit"),
    "a bound of half a unit": ({"manifest": lambda m: m["sections"]["bounds"].update(y="5.0e-15")}, ""),
}  # fmt: skip


@pytest.mark.parametrize("change", PASSAGES)
def test_passages_are_those_of_the_scenes_sections_counted_from_1_with_bounds_of_half_a_unit(
    passing, tmp_path, change
):
    changes, said = PASSAGES[change]
    folder = Path(shutil.copytree(passing, tmp_path / passing.name))
    forge(folder, **changes)
    found = problems_of(folder)
    assert bool(found) == bool(said) and said in "".join(found)
