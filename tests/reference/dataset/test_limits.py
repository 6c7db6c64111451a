"""Limits of what `verify` reads, lists and lets pass, each tried on both sides."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import pytest
from forgery import forge, moved, seal
from pydantic import TypeAdapter, ValidationError
from small_scenes import make_scene

import reference
from reference.dataset.checks.scene_check import _bounds, _order, _sections, _signs_on_grid
from reference.dataset.files import read_files
from reference.dataset.manifest import ALWAYS, MANIFEST, Count, Decimals, Manifest, Name, Text, differences
from reference.dataset.place import MAX_ID, dataset_id
from reference.dataset.render import _closest_pair
from reference.dataset.sheets import Sheet
from reference.dataset.verify import problems_of, verify
from reference.dataset.write import write
from reference.errors import DatasetError


def problems(dataset):
    """All problems in one text."""
    return "\n".join(verify(dataset).problems)


def test_twenty_problems_are_listed_at_most(dataset):
    forge(dataset, transits=lambda rows, _: [row.__setitem__(3, moved(row[3], Fraction(1))) for row in rows])
    assert len(verify(dataset).problems) == len(problems_of(dataset)) == 20


@pytest.mark.parametrize("more", [-1, 0, 1, 2])
def test_twenty_foreign_files_are_named_and_the_others_counted(dataset, more):
    for k in range(20 + more):
        (dataset / f"{k}.txt").touch()
    notes = [note for note in verify(dataset).foreign if "not part of the dataset" in note or note.startswith("and ")]
    assert len(notes) == min(20, 20 + more) + (more > 0)
    assert (notes[-1] == f"and {more} more") is (more > 0)


def test_what_is_too_large_is_not_read(dataset, monkeypatch):
    read, names = Path.read_bytes, []
    monkeypatch.setattr(Path, "read_bytes", lambda path: names.append(path.name) or read(path))
    with (dataset / "grid.csv").open("r+b") as stream:
        stream.truncate(1 << 40)
    assert f"grid.csv: {1 << 40} bytes, the manifest says" in problems(dataset)
    for more in (1, 0):
        with (dataset / MANIFEST).open("r+b") as stream:
            stream.truncate((1 << 20) + more)
        names.clear()
        assert ("1048577 bytes, 1048576 are the most" in problems(dataset)) is (MANIFEST not in names) is bool(more)
    assert "grid.csv" not in names


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
    assert set(Manifest.model_validate({**document, "files": files}).files) == {*ALWAYS, "transits.csv"}
    for name in ALWAYS:
        with pytest.raises(ValidationError, match=f"files: {name} and transits.csv must be there"):
            Manifest.model_validate({**document, "files": {other: files[other] for other in ALWAYS if other != name}})


@pytest.mark.parametrize(
    ("first", "last", "outside"),
    [("-0.9", "9", False), ("-1", "9", True), ("1", "302", False), ("1", "302.1", True)],
)
def test_transits_lie_after_the_release_and_up_to_the_end_as_far_as_their_bounds_tell(dataset, first, last, outside):
    sheet = Sheet(("k", "t", "direction", "bound"), [("1", first, "1", "1"), ("2", last, "-1", "2")], {})
    assert any("outside (0, t_end]" in problem for problem in _order(read_files(dataset), sheet)) is outside


def test_transits_whose_bounds_touch_are_in_order_and_others_are_not(dataset):
    files = read_files(dataset)
    rows = [("1", "10.0", "1", "1"), ("2", "8.0", "-1", "1")]
    for second, found in (("8.0", False), ("7.9", True)):
        sheet = Sheet(("k", "t", "direction", "bound"), [rows[0], ("2", second, *rows[1][2:])], {})
        assert ("transits.csv: transits 1 and 2 are not in order" in _order(files, sheet)) is found


def test_transits_alternate_unless_some_may_be_undecided(dataset):
    files = read_files(dataset)
    unsure = replace(files, manifest=files.manifest.model_copy(update={"transits": "undecided intervals"}))
    sheet = Sheet(("k", "t", "direction", "bound"), [("1", "10", "1", "1"), ("2", "20", "1", "1")], {})
    for made, found in ((files, True), (unsure, False)):
        assert ("transits.csv: transits 1 and 2 do not alternate" in _order(made, sheet)) is found


def test_transits_at_which_the_cord_is_nearly_level_pass(tmp_path):
    """There vz = -(x vx + y vy)/z bends within |z|, a ten-millionth of the cord's length."""
    solution = reference.solve(reference.load_scene("over_top"), t_end="10", digits=10, level="computed")
    assert min(map(abs, solution.transits.exact("z"))) < 1e-7
    assert problems_of(write(solution, tmp_path / "over")) == []


def test_a_transit_at_which_the_cord_is_level_passes_and_its_place_is_checked(tmp_path):
    """There nothing in the table tells vz; a planar swing through a right angle has xdot = 0 just there."""
    solution = reference.solve(reference.load_scene("separatrix"), t_end="0.3", digits=10, level="computed")
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
        sealed(copy, "transits.binary64.csv", row, ",".join([*cells[:place], new, *cells[place + 1 :]]))
        assert "row 3 has another direction, number or bound" in problems(copy)


def test_a_double_in_other_digits_than_its_own_is_found(dataset):
    """The seventeenth digit of a double does not always change it, and then only the text is wrong."""
    row = read_files(dataset).texts["grid.binary64.csv"].splitlines()[1]
    x = row.split(",")[1]
    assert float(x) == 0.3
    sealed(dataset, "grid.binary64.csv", x, "3.0000000000000000e-01")
    assert "x = 3.0000000000000000e-01 is not written with the digits of 0.3" in problems(dataset)


def test_the_id_of_a_users_own_scene_names_changes_that_it_has(tmp_path):
    scene = make_scene("mine", site={"latitude": "1"}, run={"t_end": "60", "digits": 8, "level": "computed"})
    solution = reference.solve(scene)
    for name in ("mine", "mine+site.latitude=1", "mine+site.latitude=1,release.x=0.3"):
        assert problems_of(write(solution, tmp_path / name, name)) == []
    for name in ("yours", "mine+site.latitude=2", "mine+site.latitude=1,release.x=0.4", "mine.decimal"):
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


@pytest.mark.parametrize("times, pair", [("", []), ("12", []), ("124", [0, 1]), ("134", [1, 2]), ("1245", [0, 1])])
def test_the_closest_pair_is_the_first_of_the_least_distance_among_three_or_more(times, pair):
    assert _closest_pair(Sheet(("t",), [(t,) for t in times], {})) == pair


@pytest.mark.parametrize(
    ("t", "vx", "found"),
    [("5", "-1", False), ("5", "1", True), ("15", "1", False), ("15", "-1", True), ("25", "-1", False),
     ("25", "1", True), ("8.9", "1", True), ("9", "1", False), ("11", "-1", False), ("11.1", "-1", True),
     ("18.9", "-1", True), ("19", "-1", False), ("21", "1", False), ("21.1", "1", True), ("5", "0.5", False),
     ("5", "0.51", True)],
)  # fmt: skip
def test_between_transits_xdot_has_one_sign_but_within_the_bounds_of_a_time_or_of_itself(t, vx, found):
    """Transits at 10 and 20 s, known to 1 s, and xdot to 0.5 m/s."""
    manifest = SimpleNamespace(bound=lambda *_: Fraction(1, 2))
    grid = Sheet(("t", "vx"), [("0", "9"), (t, vx)], {})
    files = SimpleNamespace(manifest=manifest, tables={"grid.csv": grid})
    times, ones = (Fraction(10), Fraction(20)), (Fraction(1), Fraction(1))
    said = list(_signs_on_grid(files, times, ones, (Fraction(1), Fraction(-1))))
    assert bool(said) is found


@pytest.mark.parametrize(("change", "count"), [(lambda row: f"{row},0", 8), (lambda row: row.rpartition(",")[0], 6)])
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


@pytest.mark.parametrize(
    ("kind", "proved", "right", "wrong"),
    [
        ("grid", None, ["5e-4", "1e-3"], ["4.9e-4", "1.1e-3"]),
        ("transits", None, ["5e-4", "1e-3", "9"], ["4.9e-4"]),  # whose states two runs know less closely
        ("transits", "a proof", ["5e-4", "1e-3"], ["4.9e-4", "1.1e-3"]),
    ],
)
def test_a_bound_is_from_half_a_unit_to_one_of_the_last_digit(kind, proved, right, wrong):
    for bound in (*right, *wrong):
        bounds = {"grid": {}, "transits": {}} | {kind: {"x": bound}}
        claims = SimpleNamespace(bounds=SimpleNamespace(**bounds), decimals={kind: {"x": 3}}, enclosure=proved)
        assert bool([*_bounds(claims)]) is (bound in wrong), bound


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, ""),
        ({"words": None}, "sections are not those of the scene"),
        ({"words": ("lowest", "highest")}, "sections are not those of the scene: lowest, highest"),
        ({"possible": ("highest",)}, "sections are not those of the scene"),
        ({"rows": [("highest", "1"), ("lowest", "1")]}, "rows are not those"),
        ({"rows": [("highest", "0"), ("highest", "1"), ("lowest", "0")]}, "rows are not those"),
        ({"bound": "4.9e-4"}, "sections.bounds.x = 4.9e-4 is less than half a unit"),
    ],
)
def test_the_passages_of_a_dataset_are_those_of_its_words_counted_from_1_with_a_bound_of_half_a_unit(change, said):
    made = {"words": ("highest", "lowest"), "possible": ("highest", "lowest"), "bound": "5e-4"}
    made |= {"rows": [("highest", "1"), ("highest", "2"), ("lowest", "1")]} | change
    sections = SimpleNamespace(
        counts={"highest": 2, "lowest": 1}, possible=dict.fromkeys(made["possible"]), decimals={"x": 3},
        bounds={"x": made["bound"]},
    )  # fmt: skip
    files = SimpleNamespace(
        manifest=SimpleNamespace(sections=sections),
        scene=SimpleNamespace(run=SimpleNamespace(sections=made["words"])),
        tables={"sections.csv": Sheet(("section", "k"), made["rows"], {})},
    )
    found = [*_sections(files)]
    assert len(found) == bool(said) and said in "".join(found)
    files.manifest.sections = None
    assert [*_sections(files)] == []
