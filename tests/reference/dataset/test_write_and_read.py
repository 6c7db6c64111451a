"""Golden datasets: the contents of their files, written whole or not at all, and read back."""

from __future__ import annotations

import json
import math
import os
from contextlib import contextmanager
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import schemas
from forgery import forge, moved
from small_scenes import make_scene

import reference
from reference.dataset.files import read_files
from reference.dataset.golden import load
from reference.dataset.making import Making, command
from reference.dataset.manifest import ALWAYS, FUNCTION, MANIFEST, OPTIONAL
from reference.dataset.place import dataset_id, default_folder, golden_folder
from reference.dataset.render import MOST, render
from reference.dataset.sheets import Sheet, nearest_doubles, scene_inputs
from reference.dataset.verify import problems_of, verify
from reference.dataset.write import check_target, write, write_texts
from reference.errors import DatasetError, InputError
from reference.numbers.table import Table

NAMES = {MANIFEST, *ALWAYS, *OPTIONAL} - {*FUNCTION}  # without a proof there is no golden function


@pytest.fixture(scope="module")
def solution():
    return reference.solve(reference.load_scene("paris"), t_end="300", digits=25, level="confirmed")


@pytest.fixture
def dataset(solution, tmp_path):
    return write(solution, tmp_path / "paris")


def test_a_dataset_has_the_files_of_the_contract(dataset):
    assert {path.name for path in dataset.iterdir()} == NAMES - {"sections.csv"}
    assert problems_of(dataset) == []
    for path in dataset.iterdir():
        data = path.read_bytes()
        assert b"\r" not in data
        assert data.endswith(b"\n")
        data.decode("utf-8")


def test_headers_and_digits_after_the_point_are_fixed(dataset):
    grid = (dataset / "grid.csv").read_text().splitlines()
    assert grid[0] == "t,x,y,z,vx,vy,vz"
    transits = (dataset / "transits.csv").read_text().splitlines()
    assert transits[0] == "k,t,direction,x,y,z,vy,ax,bound"
    for lines in (grid[1:], transits[1:]):
        shapes = {
            tuple(len(text.partition(".")[2]) for text in line.split(",")[1:-1]) for line in lines
        }
        assert len(shapes) == 1


def columns_of(dataset, name):
    sheet = read_files(dataset).tables[name]
    return dict(zip(sheet.header, zip(*sheet.rows, strict=True), strict=True))


def test_the_largest_number_of_a_column_has_the_digits_asked(dataset):
    columns = columns_of(dataset, "grid.csv")
    for name in ("x", "y", "z", "vx", "vy"):
        largest = max(columns[name], key=lambda text: abs(Fraction(text)))
        assert len(largest.lstrip("-0.").replace(".", "")) == 25


def test_doubles_are_given_with_seventeen_digits_and_as_hexfloats(dataset):
    grid, doubles = columns_of(dataset, "grid.csv"), columns_of(dataset, "grid.binary64.csv")
    for name in grid:
        for text, plain, hexadecimal in zip(
            grid[name], doubles[name], doubles[f"{name}_hex"], strict=True
        ):
            assert float(Fraction(text)) == float(plain) == float.fromhex(hexadecimal)
            assert len(plain.lstrip("-").partition("e")[0]) == 18


def test_doubles_are_nearest_to_the_truth_that_is_known_and_not_to_the_digits_that_are_printed(
    tmp_path,
):
    """Fifteen digits are printed and some twenty are known; the truth here is a run of forty."""
    scene = reference.load_scene("paris", ["run.t_end=600", "run.digits=15"])
    solution, truth = (
        reference.solve(scene),
        reference.solve(scene, digits=40, level="computed", engine="limbs"),
    )
    dataset = write(solution, tmp_path / "few")
    for kind, known, table in (
        ("grid", solution.grid, truth.grid),
        ("transits", solution.transits, truth.transits),
    ):
        printed, doubles = (
            columns_of(dataset, f"{kind}.csv"),
            columns_of(dataset, f"{kind}.binary64.csv"),
        )
        nearest = {"doubles": 0, "decimals": 0, "all": 0}
        for name in table.columns:
            cells = zip(
                printed[name],
                doubles[f"{name}_hex"],
                table.exact(name),
                known.bound(name),
                strict=True,
            )
            for text, hexfloat, exact, bound in cells:
                double = float.fromhex(hexfloat)
                assert abs(Fraction(double) - exact) <= Fraction(math.ulp(double)) / 2 + bound
                nearest["doubles"] += double == float(exact)
                nearest["decimals"] += float(text) == float(exact)
                nearest["all"] += 1
        assert nearest["doubles"] > 0.95 * nearest["all"] > nearest["decimals"]
    states = json.loads((dataset / "vectors.json").read_text())["states"]
    hexfloats = columns_of(dataset, "grid.binary64.csv")["x_hex"]
    assert [state["values"]["x"]["hexfloat"] for state in states] == [
        hexfloats[state["row"] - 1] for state in states
    ]


@pytest.mark.parametrize("name", ["manifest.json", "vectors.json", "function.json"])
def test_the_documents_follow_their_published_schemas(dataset, name):
    folder = load("paris.binary64").path if name == "function.json" else dataset
    document = json.loads((folder / name).read_text())
    schema = json.loads(schemas.path_of(name).read_text())
    jsonschema.validate(document, schema)
    assert schema == schemas.schema_of(name), "run: python tests/helpers/schemas.py"
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**document, "extra": 1}, schema)


def test_vectors_are_a_few_states_and_transits_with_bounds_taken_from_the_tables(tmp_path):
    scene = reference.load_scene(
        "paris", ["run.t_end=900", "run.grid_step=10", "run.digits=15", "run.level=computed"]
    )
    dataset = write(reference.solve(scene), tmp_path / "vectors")
    found, tables = json.loads((dataset / "vectors.json").read_text()), read_files(dataset).tables
    assert len(found["states"]) == MOST == 16
    few = len(found["transits"])  # the closest pair may be among those that are evenly spread
    assert MOST - 2 <= few <= MOST
    assert found["states"][0]["flags"] == ["release"] and found["states"][-1]["flags"] == ["end"]
    last = len(tables["transits.csv"].rows)
    assert (
        [t["k"] for t in found["transits"] if "end" in t["flags"]]
        == [found["transits"][-1]["k"]]
        == [last]
    )
    assert (found["states"][0]["row"], found["states"][-1]["row"]) == (1, 91)
    pair = [t["k"] for t in found["transits"] if "closest_pair" in t["flags"]]
    times = [Fraction(row[1]) for row in tables["transits.csv"].rows]
    gaps = [after - before for before, after in pairwise(times)]
    first = 1 + gaps.index(min(gaps))
    assert pair == [first, first + 1]
    assert set(found["notes"]) == {"release", "end", "closest_pair"}
    assert found["columns"] == {
        "t": "s",
        **dict.fromkeys("xyz", "m"),
        **dict.fromkeys(("vx", "vy", "vz"), "m/s"),
        "ax": "m/s^2",
    }
    for state in found["states"]:
        row = tables["grid.csv"].rows[state["row"] - 1]
        assert [value["decimal"] for value in state["values"].values()] == list(row)
        assert (
            Fraction(state["values"]["t"]["bound"])
            == 0
            < Fraction(state["values"]["x"]["bound"])
            < Fraction(1, 10**14)
        )
    for transit in found["transits"]:
        row = tables["transits.csv"].rows[transit["k"] - 1]
        assert (transit["direction"], transit["values"]["t"]["bound"]) == (int(row[2]), row[-1])
        assert float.fromhex(transit["values"]["t"]["hexfloat"]) == pytest.approx(
            float(row[1]), rel=1e-15
        )


def test_the_manifest_names_no_date_host_or_wall_time(dataset):
    text = (dataset / MANIFEST).read_text().lower()
    assert os.uname().nodename.lower() not in text
    assert not any(
        word in text for word in ("date", "wall", "cpu", "host", str(Path.home()).lower())
    )


def test_the_manifest_records_the_check_and_its_disagreement(dataset):
    manifest = load(dataset).manifest
    assert manifest.level == "confirmed"
    (check,) = manifest.cross_checks
    assert check.formulation == "space"
    assert check.number != manifest.run.number
    assert Fraction(check.position_m) < Fraction(manifest.bounds.position_m)
    assert manifest.counts.grid == 6
    assert manifest.counts.transits == 36


@pytest.mark.parametrize(("transits", "written"), [(True, "true"), (False, "false")])
def test_inputs_are_written_as_a_scenes_file_has_them(transits, written):
    inputs = scene_inputs(make_scene(run={"transits": transits}))
    assert (inputs["run"]["transits"], inputs["run"]["level"]) == (written, "confirmed")


def test_the_page_for_people_carries_the_certified_values(dataset):
    page = (dataset / "certified.txt").read_text()
    last = (dataset / "grid.csv").read_text().splitlines()[-1].split(",")
    assert all(text in page for text in last)
    assert "Certified" not in page  # it is confirmed, not proven
    assert "Transits (xdot = 0, t > 0): 36 (complete)" in page


def test_a_dataset_is_read_back_as_arrays_strings_and_fractions(dataset, solution):
    golden = load(dataset)
    assert np.array_equal(golden.t, solution.t)
    assert golden.x.dtype == np.float64
    assert golden.exact("x")[3] == Fraction(golden.decimals("x")[3])
    assert abs(golden.exact("x")[3] - solution.grid.exact("x")[3]) <= Fraction(1, 2 * 10**25)
    assert len(golden.transits["t"]) == 36
    assert golden.scene == solution.scene
    with pytest.raises(
        AttributeError, match=r"a Golden has no attribute 'transit'; it has transits, "
    ):
        _ = golden.transit
    assert golden.level == solution.level == "confirmed"
    assert golden.exact("t") == solution.exact("t") == list(golden.times)


def test_a_solution_and_its_dataset_have_the_same_columns(dataset, solution):
    golden = load(dataset)
    assert golden.times == solution.times
    assert golden.directions == solution.directions
    for table, printed in ((solution.grid, golden.grid), (solution.transits, golden.transits)):
        assert len(table) == len(printed)
        assert set(table.columns) <= set(printed.columns)
        for name in table.columns:
            unit = Fraction(1, 10 ** len(printed.decimals(name)[0].partition(".")[2]))
            exact = zip(table.exact(name), printed.exact(name), strict=True)
            assert all(abs(one - other) <= unit / 2 for one, other in exact)
            assert np.allclose(table[name], printed[name], rtol=1e-15, atol=float(unit))
            bounds = zip(table.bound(name), printed.bound(name), strict=True)
            own = (
                list(table.bound(name))
                if name == "t"
                else [table.largest_bounds()[name]] * len(table)
            )
            for (one, other), alone in zip(bounds, own, strict=True):
                assert one + unit / 2 <= other <= (alone + unit / 2) * Fraction(11, 10)
    with pytest.raises(KeyError, match="no column 'w'"):
        golden.grid["w"]
    assert golden.grid.bound("t") == [0] * 6
    with pytest.raises(
        KeyError, match="no bound for 'w'; there are bounds for t, x, y, z, vx, vy, vz"
    ):
        golden.grid.bound("w")
    assert golden.decimals("vx") == golden.grid.decimals("vx")
    assert golden.path.name == "paris"


def test_a_dataset_and_a_solution_say_in_a_line_what_they_hold(dataset, solution):
    held = "paris: confirmed, 25 digits, 6 grid times, 36 transits"
    assert repr(solution) == f"Solution({held})"
    assert repr(load(dataset)) == f"Golden({held})"
    assert repr(load(dataset).grid) == "PrintedTable(t, x, y, z, vx, vy, vz; rows: 6)"


def test_the_tables_of_a_dataset_are_frames(dataset):
    golden = load(dataset)
    for table in (golden.grid, golden.transits, load("museum_gate").sections["gate 127"]):
        frame = table.to_pandas()
        assert tuple(frame.columns) == table.columns and frame["t"].tolist() == table["t"].tolist()
        assert "<table" in table._repr_html_()


def test_a_dataset_of_a_function_alone_says_that_it_lists_no_sections():
    golden = load("museum_gate.binary64")
    assert golden.scene.run.sections == ("gate 127",) and not golden.sections
    with pytest.raises(InputError, match=r"got 'gate 127', .* has none.*sections=…\) finds"):
        golden.sections["gate 127"]


def test_a_table_without_rows_has_no_bounds_and_no_other_columns_for_that():
    transits = load("creeping").transits
    assert transits.bound("x") == transits.bound("t") == transits.exact("x") == []
    with pytest.raises(KeyError, match="no bound for 'w'; there are bounds for t"):
        transits.bound("w")


def test_what_has_no_transits_says_why(tmp_path):
    planar = make_scene(
        site={"rotation_rate": "0"},
        release={"x": "0", "y": "0.4"},
        run={"t_end": "60", "digits": 10},
    )
    path = write(reference.solve(planar), tmp_path / "planar")
    assert load(path).manifest.transits == "xdot is identically zero"
    off = write(reference.solve(planar, transits=False), tmp_path / "off")
    assert load(off).manifest.transits == "not asked for"
    assert load(off).manifest.bounds.transit_s is None


def test_a_missing_dataset_says_how_to_make_it(tmp_path):
    with pytest.raises(InputError, match="foucault generate"):
        load(tmp_path / "nothing")
    with pytest.raises(InputError, match="foucault generate"):
        load("atlantis")


def test_a_target_that_is_something_else_is_left_alone(tmp_path):
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(InputError, match="an older dataset"):
        check_target(tmp_path)
    with pytest.raises(InputError, match="file of that name"):
        check_target(tmp_path / "thesis.txt")
    with pytest.raises(InputError, match="a folder that can be written to, with room"):
        check_target(Path("/proc/nowhere/paris"))
    (tmp_path / "manifest.json").write_text("{}")
    with pytest.raises(InputError, match=r"contains 'thesis\.txt'"):
        check_target(tmp_path)
    assert (tmp_path / "thesis.txt").read_text() == "years of work"


@contextmanager
def left_as_it_was(dataset):
    before = {path.name: path.read_bytes() for path in dataset.iterdir()}
    yield
    assert {path.name: path.read_bytes() for path in dataset.iterdir()} == before
    assert [path.name for path in dataset.parent.iterdir()] == ["paris"]


def test_a_dataset_that_fails_its_own_checks_is_not_put_in_place(dataset, solution):
    broken = {**render(solution), "grid.csv": "t,x\n"}
    with left_as_it_was(dataset), pytest.raises(DatasetError):
        write_texts(broken, dataset, solution)


def test_an_older_dataset_is_replaced(dataset, solution):
    shorter = reference.solve(reference.load_scene("paris"), t_end="60", digits=8, level="computed")
    write(shorter, dataset)
    assert load(dataset).manifest.digits == 8
    write(solution, dataset)
    assert load(dataset).manifest.digits == 25
    assert [path.name for path in dataset.parent.iterdir()] == ["paris"]


def test_an_end_between_the_two_renames_loses_nothing(dataset, solution, monkeypatch):
    renames, rename = [], Path.rename

    def interrupted(self, target):
        renames.append(target)
        if len(renames) == 2:
            raise KeyboardInterrupt
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", interrupted)
    with left_as_it_was(dataset), pytest.raises(KeyboardInterrupt):
        write(solution, dataset)
    assert len(renames) == 3  # out of the way, in its place, and back again


def test_a_target_that_is_a_link_stays_one(dataset, solution):
    link = dataset.parent / "link"
    link.symlink_to("paris")
    shorter = reference.solve(reference.load_scene("paris"), t_end="60", digits=8, level="computed")
    write(shorter, link)
    assert link.is_symlink()
    assert load(dataset).manifest.digits == 8


def test_a_dataset_is_called_by_its_scene_and_by_what_was_changed(paris):
    assert dataset_id(paris) == "paris"
    assert dataset_id(paris.with_values(["inputs=binary64"])) == "paris.binary64"
    changed = paris.with_values(["site.latitude=0", "run.t_end=600"])
    assert dataset_id(changed) == "paris+site.latitude=0"
    assert dataset_id(changed, changed) == "paris"
    mine = make_scene("mine")
    assert dataset_id(mine.with_values(["site.latitude=1"]), mine) == "mine+site.latitude=1"


def test_only_a_scene_as_it_stands_goes_to_the_shipped_place(monkeypatch, tmp_path, paris):
    monkeypatch.chdir(tmp_path)

    def folder(scene):
        return default_folder(scene, dataset_id(scene))

    assert folder(paris).parts[-3:] == ("data", "golden", "paris")
    assert folder(paris.with_values(["inputs=binary64"])).parts[-3:] == (
        "data",
        "golden",
        "paris.binary64",
    )
    assert folder(paris.with_values(["run.t_end=60"])) == Path("golden/paris")
    assert folder(paris.with_values(["site.latitude=0"])) == Path("golden/paris+site.latitude=0")
    assert folder(make_scene("mine")) == Path("golden/mine")
    for words in (
        {"title": "mine"},
        {"source": "mine"},
        {"flags": ("stiff",)},
    ):  # a copy of its file that says another thing
        assert folder(paris.model_copy(update=words)) == Path("golden/paris")


def test_a_name_means_the_same_folder_to_those_who_write_and_those_who_read(
    monkeypatch, tmp_path, dataset, paris
):
    monkeypatch.chdir(tmp_path)
    assert golden_folder("paris") == Path("paris")  # a folder here
    dataset.rename(tmp_path / "elsewhere")
    assert golden_folder("paris") == default_folder(paris, "paris")
    (tmp_path / "golden/paris").mkdir(parents=True)
    assert golden_folder("paris") == default_folder(paris, "paris") == Path("golden/paris")
    assert golden_folder("./paris") == Path("paris")
    assert golden_folder("golden/hard") == Path("golden/hard")
    assert golden_folder("nothing") == Path("nothing")


def test_the_command_in_the_manifest_names_everything_that_was_set(paris):
    paris = paris.with_values(["run.level=confirmed"])
    plain = "foucault generate paris --t-end 86400 --digits 40 --level confirmed"
    assert command(paris, "paris", "--engine heyoka") == f"{plain} --engine heyoka"
    changed = paris.with_values(
        ["site.latitude=0", "release.vx=1", "run.grid_step=600", "inputs=binary64"]
    )
    sets = "--set site.latitude=0 --set release.vx=1 --set run.grid_step=600 --set inputs=binary64"
    text = command(changed, dataset_id(changed), "--engine heyoka")
    assert sets in text and text.startswith(plain)
    words = [word for word in text.split() if "=" in word]
    assert paris.with_values(words) == changed
    assert command(make_scene("mine"), "mine", Making().options).startswith(
        "foucault generate mine.toml --t-end"
    )
    assert command(make_scene("mine"), "mine+site.latitude=1", Making().options).endswith(
        "--set site.latitude=1"
    )


def test_what_is_printed_is_compared_with_what_was_proved_before_it_is_in_place(tmp_path):
    """A number that is off by a unit of its last digit passes every check of the files by themselves."""
    pytest.importorskip("flint")
    scene = reference.load_scene("paris", ["run.t_end=20", "run.grid_step=10", "run.digits=12"])
    proved = reference.solve(scene, confirm="none", audit=False)
    folder = write(proved, tmp_path / "paris")
    forge(
        folder, grid=lambda rows, _: rows[1].__setitem__(1, moved(rows[1][1], Fraction(1, 10**60)))
    )
    assert problems_of(folder) == []
    texts = {path.name: path.read_text() for path in folder.iterdir()}
    with pytest.raises(DatasetError, match="this is not what was proved"):
        write_texts(texts, tmp_path / "forged", proved)
    assert [path.name for path in tmp_path.iterdir()] == ["paris"]


def test_a_number_that_its_error_reaches_gets_the_double_of_the_printed_one():
    """In sixteenths: 16 within 16 is noise about zero, 17 within 16 is not."""
    table = Table(("x",), 4, [(16,), (17,), (-17,), (-16,)], [(16,)] * 4)
    sheet = Sheet(("t", "x"), [("0", text) for text in ("0.9", "1.1", "-1.1", "-0.9")], {})
    assert nearest_doubles(table, sheet) == {"x": [0.9, 17 / 16, -17 / 16, -0.9]}


# released near the horizontal: many transits with a level cord, where vz = -y vy/z means little
LEVEL_CORD = {
    "id": "level_cord",
    "pendulum": {"length": "0.196"},
    "site": {"latitude": "1.228134", "gravity": "0.740342943", "altitude": "1142.5"},
    "release": {
        "angle": "175",
        "azimuth": "-149.276",
        "angle_rate": "16",
        "azimuth_rate": "16.5758637",
    },
    "run": {"t_end": "80.72", "grid_step": "2.69"},
}


@pytest.mark.parametrize("name", ["two_radians", "level_cord"])
@pytest.mark.parametrize("digits", [2, 3, 4])
def test_a_level_cord_is_no_reason_to_refuse_few_digits(name, digits, tmp_path):
    scene = (
        reference.parse_scene(LEVEL_CORD) if name == "level_cord" else reference.load_scene(name)
    )
    written = write(reference.solve(scene, digits=digits, level="computed"), tmp_path / name)
    assert verify(written).problems == []
