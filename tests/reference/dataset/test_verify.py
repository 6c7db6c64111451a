"""Verification of datasets: every kind of damage must be found."""

from __future__ import annotations

import hashlib
import json
import random
import shutil
from pathlib import Path

import pytest
from small_scenes import make_scene

import reference
from reference.dataset.read import MANIFEST
from reference.dataset.recompute import recompute
from reference.dataset.sheets import Sheet, binary64_sheet
from reference.dataset.verify import problems_of
from reference.dataset.write import write


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    solution = reference.solve(reference.load_scene("paris"), t_end="300", digits=20)
    return write(solution, tmp_path_factory.mktemp("golden") / "paris")


@pytest.fixture
def dataset(original, tmp_path) -> Path:
    return Path(shutil.copytree(original, tmp_path / "paris"))


def rewrite(dataset: Path, name: str, change, manifest_change=lambda _: None) -> None:
    """Change a table as a careful forger would: doubles, sizes and hashes are brought into line."""
    lines = (dataset / name).read_text().splitlines()
    rows = [line.split(",") for line in lines]
    change(rows)
    (dataset / name).write_text("".join(",".join(row) + "\n" for row in rows))
    if "binary64" not in name:
        sheet = Sheet(tuple(rows[0]), [tuple(row) for row in rows[1:]], {})
        try:
            text = binary64_sheet(sheet).csv()
        except ValueError:
            text = ""
        (dataset / name.replace(".csv", ".binary64.csv")).write_text(text)
    document = json.loads((dataset / MANIFEST).read_text())
    manifest_change(document)
    for file, record in document["files"].items():
        data = (dataset / file).read_bytes()
        record.update(bytes=len(data), sha256=hashlib.sha256(data).hexdigest())
    (dataset / MANIFEST).write_text(json.dumps(document))


def test_an_untouched_dataset_passes(dataset):
    assert problems_of(dataset) == []


@pytest.mark.parametrize("seed", range(25))
def test_any_changed_byte_in_any_file_is_found(dataset, seed):
    draw = random.Random(seed)
    path = sorted(dataset.iterdir())[seed % 6]
    data = bytearray(path.read_bytes())
    where = draw.randrange(len(data))
    if path.name == MANIFEST:  # in the manifest a changed title is only a changed title: take a digit of a hash
        where = data.index(b'"sha256": "') + 11 + draw.randrange(64)
    data[where] = data[where] ^ 1
    path.write_bytes(data)
    assert problems_of(dataset)


def test_a_missing_and_a_strange_file_are_found(dataset):
    (dataset / "transits.csv").unlink()
    (dataset / "notes.txt").write_text("mine")
    problems = problems_of(dataset)
    assert any(problem.startswith("transits.csv: No such file") for problem in problems)
    assert "notes.txt: not in the manifest" in problems


def test_a_wrong_count_is_found(dataset):
    rewrite(dataset, "grid.csv", lambda rows: None, lambda m: m["counts"].update(transits=35))
    assert any("35" in problem for problem in problems_of(dataset))


@pytest.mark.parametrize("text", ["{", "[]", '{"schema_version": 1}', "nonsense"])
def test_a_broken_manifest_is_found(dataset, text):
    (dataset / MANIFEST).write_text(text)
    assert problems_of(dataset)[0].startswith("manifest.json")


def test_an_extra_key_breaks_the_schema(dataset):
    document = json.loads((dataset / MANIFEST).read_text())
    (dataset / MANIFEST).write_text(json.dumps({**document, "comment": "hello"}))
    assert "comment" in problems_of(dataset)[0]


def test_a_wrong_header_is_found(dataset):
    rewrite(dataset, "grid.csv", lambda rows: rows[0].__setitem__(1, "X"))
    assert any("header" in problem for problem in problems_of(dataset))


def test_a_lost_digit_is_found(dataset):
    rewrite(dataset, "grid.csv", lambda rows: rows[2].__setitem__(1, rows[2][1][:-1]))
    assert any("is not a number of" in problem for problem in problems_of(dataset))


def test_doubles_that_are_not_the_nearest_are_found(dataset):
    def nudge(rows):
        rows[3][1] = f"{float(rows[3][1]) * (1 + 2**-52):.16e}"

    rewrite(dataset, "grid.binary64.csv", nudge)
    assert any("nearest doubles" in problem for problem in problems_of(dataset))


def bump(row: int, column: int):
    """Change the tenth digit of a number."""

    def change(rows):
        text = rows[row][column]
        point = text.index(".") + 10
        rows[row][column] = text[:point] + str((int(text[point]) + 5) % 10) + text[point + 1 :]

    return change


@pytest.mark.parametrize("column", range(1, 7))
def test_a_forged_state_is_found_by_the_physics_even_with_right_hashes(dataset, column):
    rewrite(dataset, "grid.csv", bump(3, column))
    assert problems_of(dataset)


def test_an_h_that_drifts_is_found(dataset):
    """A bob on the sphere with a velocity along it, but faster: only the invariant can tell."""

    def faster(rows):
        for column in (4, 5, 6):
            places = len(rows[3][column].partition(".")[2])
            rows[3][column] = f"{float(rows[3][column]) * 1.001:.{places}f}"

    rewrite(dataset, "grid.csv", faster)
    assert any("invariant" in problem for problem in problems_of(dataset))


def test_a_drift_that_the_manifest_admits_is_still_too_large(dataset):
    from reference.dataset.read import read_manifest, scene_of
    from reference.dataset.verify import _sheet, invariant_drift

    def faster(rows):
        for column in (4, 5, 6):
            places = len(rows[3][column].partition(".")[2])
            rows[3][column] = f"{float(rows[3][column]) * 1.001:.{places}f}"

    rewrite(dataset, "grid.csv", faster)
    initial, drift = invariant_drift(scene_of(read_manifest(dataset)), _sheet(dataset / "grid.csv"))
    rewrite(
        dataset,
        "grid.csv",
        lambda rows: None,
        lambda m: m.update(invariant={"h_m2_s2": initial, "drift_m2_s2": drift}),
    )
    assert any("drifts by" in problem for problem in problems_of(dataset))


def test_times_off_the_grid_are_found(dataset):
    rewrite(dataset, "grid.csv", lambda rows: rows[2].__setitem__(0, "61"))
    assert any("times are not those" in problem for problem in problems_of(dataset))


def test_transits_that_do_not_alternate_are_found(dataset):
    rewrite(dataset, "transits.csv", lambda rows: rows[5].__setitem__(2, "-1" if rows[5][2] == "+1" else "+1"))
    assert any("do not alternate" in problem for problem in problems_of(dataset))


def test_transits_out_of_order_are_found(dataset):
    def swap(rows):
        rows[5][1], rows[7][1] = rows[7][1], rows[5][1]

    rewrite(dataset, "transits.csv", swap)
    assert any("not in order" in problem for problem in problems_of(dataset))


def drop(*which: int):
    def change(rows):
        for row in sorted(which, reverse=True):
            del rows[row]
        for k, row in enumerate(rows[1:], 1):
            row[0] = str(k)

    return change


def test_a_transit_left_out_is_found_by_its_neighbours(dataset):
    rewrite(dataset, "transits.csv", drop(5), lambda m: m["counts"].update(transits=35))
    assert any("do not alternate" in problem for problem in problems_of(dataset))


def test_a_pair_of_transits_left_out_is_found_by_the_signs_on_the_grid(dataset):
    """Rows 7 and 8 of Paris lie on both sides of t = 60 s."""
    rewrite(dataset, "transits.csv", drop(7, 8), lambda m: m["counts"].update(transits=34))
    assert any("contradicts the transits" in problem for problem in problems_of(dataset))


def test_a_transit_outside_the_run_is_found(dataset):
    rewrite(dataset, "transits.csv", lambda rows: rows[-1].__setitem__(1, "3" + rows[-1][1]))
    assert any("outside" in problem for problem in problems_of(dataset))


def test_a_wrong_number_of_a_transit_is_found(dataset):
    rewrite(dataset, "transits.csv", lambda rows: rows[3].__setitem__(0, "9"))
    assert any("does not count from 1" in problem for problem in problems_of(dataset))


def test_a_scene_that_is_refused_is_found(dataset):
    rewrite(dataset, "grid.csv", lambda rows: None, lambda m: m["scene"]["pendulum"].update(length="0"))
    assert any("the manifest's scene is refused" in problem for problem in problems_of(dataset))


def test_a_dataset_with_drag_may_lose_energy(tmp_path):
    scene = make_scene(pendulum={"drag": "0.01"}, run={"t_end": "120", "digits": 15})
    assert problems_of(write(reference.solve(scene), tmp_path / "drag")) == []


def test_recomputing_gives_the_same_bytes(dataset):
    assert recompute(dataset) == []


def test_recomputing_finds_what_no_physics_can_see(dataset):
    document = json.loads((dataset / MANIFEST).read_text())
    document["title"] = "another title"
    (dataset / MANIFEST).write_text(json.dumps(document, indent=1) + "\n")
    assert problems_of(dataset) == []
    page = (dataset / "certified.txt").read_text()
    rewrite(dataset, "grid.csv", lambda rows: None)
    (dataset / "certified.txt").write_text(page.replace("Certified", "Uncertified"))
    rewrite(dataset, "grid.csv", lambda rows: None)
    assert any("certified.txt" in problem for problem in recompute(dataset))
