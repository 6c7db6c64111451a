"""Verification of datasets: every kind of damage must be found, and every number that is off by a few bounds."""

from __future__ import annotations

import json
import re
import shutil
import sys
from fractions import Fraction
from importlib.metadata import version
from pathlib import Path

import pytest
from forgery import bound_of, forge, moved, seal
from lines import unwrapped
from sampled import one_in
from small_scenes import make_scene

import reference
from reference.dataset.files import read_files
from reference.dataset.manifest import MANIFEST
from reference.dataset.sheets import GRID_HEADER
from reference.dataset.verify import problems_of, recompute, verify
from reference.dataset.write import write
from reference.errors import DatasetError
from reference.numbers.columns import TRANSITS


def problems(dataset: Path) -> str:
    """All problems in one text."""
    return "\n".join(verify(dataset).problems)


def test_an_untouched_dataset_passes(dataset):
    found = verify(dataset)
    assert (found.problems, found.foreign) == ([], [])


def test_what_nothing_here_can_vouch_for_is_said_in_the_verdict(dataset, foucault):
    """The cross-checks and the proof of a dataset that is not in the index; of one that is, nothing is left to say."""
    words = "checked only by --recompute: "
    status, out, _ = foucault("verify", dataset)
    assert (status, unwrapped(out)) == (0, f"{dataset}: ok {words}the cross-checks")
    assert foucault("verify", dataset, "--recompute")[:2] == (0, f"{dataset}: ok\n")
    copy = Path(shutil.copytree(reference.load("separatrix").path, dataset.parent / "separatrix"))
    assert verify(copy).undecided == []


def test_a_missing_file_is_found_and_a_foreign_one_is_mentioned(dataset):
    (dataset / "notes.txt").write_text("mine")
    assert verify(dataset).foreign == ["notes.txt: not part of the dataset, ignored"]
    assert problems(dataset) == ""
    (dataset / "transits.csv").unlink()
    assert "transits.csv: No such file" in problems(dataset)


def test_a_dataset_that_counts_transits_and_has_no_table_of_them_is_refused(dataset):
    forge(dataset, without=("transits.csv", "transits.binary64.csv"))
    assert "files: transits.csv must be there" in problems(dataset)
    with pytest.raises(DatasetError, match=r"transits\.csv must be there"):
        reference.load(dataset)


def test_a_dataset_that_counts_no_transits_must_have_none(dataset):
    def none(document):
        document["counts"]["transits"] = 0
        document["bounds"].update(transit_s=None, transits={})

    forge(dataset, without=("transits.csv", "transits.binary64.csv"), manifest=none)
    assert problems(dataset) == "manifest.json: 0 transits are not the motion's, which are 36"


@pytest.mark.parametrize(
    "text", ["{", "[]", '{"schema_version": 3}', "nonsense", "", "\ufeff{}", '{"a":' * 100_000]
)
def test_a_broken_manifest_is_found(dataset, text):
    (dataset / MANIFEST).write_text(text)
    assert problems(dataset).startswith("manifest.json")


def test_an_older_format_says_what_to_do(dataset):
    document = json.loads((dataset / MANIFEST).read_text())
    for older in (1, 2):
        (dataset / MANIFEST).write_text(json.dumps({**document, "schema_version": older}))
        assert f"format {older}: make the dataset again" in problems(dataset)


def test_the_same_content_in_another_form_is_refused(dataset):
    text = (dataset / MANIFEST).read_text()
    for other in (
        text + "\n",
        text.replace('"digits": 20', '"digits": 20,\n "digits": 20', 1),
    ):
        (dataset / MANIFEST).write_text(other, newline="")
        assert "not in the form in which it is written" in problems(dataset)


def level(document, word):
    document["level"] = document["scene"]["run"]["level"] = word
    document["command"] = document["command"].replace("--level confirmed", f"--level {word}")


def possible(document, *intervals):
    document["possible"] = [
        {"from_s": str(a), "to_s": str(b), "parity": "even"} for a, b in intervals
    ]
    document["counts"]["possible"], document["transits"] = len(intervals), "undecided intervals"


def proved(document, kind, part):
    """A proof whose radii are a part of the bounds: a tenth, but of one kind."""
    level(document, "enclosed")
    names = {
        "position_m": "position_radius_m",
        "velocity_m_s": "velocity_radius_m_s",
        "transit_s": "transit_radius_s",
    }
    radii = {
        name: f"{float(Fraction(document['bounds'][of]) * Fraction(part if of == kind else '0.1')):.3e}"
        for of, name in names.items()
    }
    document["enclosure"] = {
        "method": "m",
        "prec": 1,
        "order": 1,
        "steps": 1,
        **radii,
        "agreement_bits": 1,
    }


def one_run_twice(document):
    level(document, "self_consistent")
    for check in document["cross_checks"]:
        check |= {name: document["run"][name] for name in ("formulation", "number")}


def far_too_wide(document):
    for name in document["bounds"]["grid"]:
        document["bounds"]["grid"][name] = "1.0e+300"
    document["bounds"].update(position_m="1.0e+300", velocity_m_s="1.0e+300")


# what a forger may write into a manifest, with everything else made to fit, and a word of what verify says of it
WORDS = {
    "a proof that is none": (lambda m: level(m, "enclosed"), "a proof and the level enclosed belong together"),
    "checks that are left out": (lambda m: m.update(cross_checks=[]), "no run agrees"),
    "a level with more than it has": (lambda m: level(m, "computed"), "a single run has no cross-checks"),
    "more digits": (lambda m: m.update(digits=19), "digits = 19 does not follow"),
    "another frame": (lambda m: m.update(frame="z down"), "frame = z down does not follow"),
    "other units": (
        lambda m: m["units"].update(t="h"), "units.t = h does not follow from the scene and the tables, which give s"),
    "other equations": (lambda m: m["equations"]["lines"].pop(), "equations.lines = "),
    "another command": (lambda m: m.update(command="rm -rf /"), "command does not follow"),
    "another command of a proof": (
        lambda m: (proved(m, "position_m", "0.1"), m.update(command="rm -rf /")), "command does not follow"),
    "an id with a change that is none": (lambda m: m.update(id="paris+release.x=0.3"), "id = paris+release.x=0.3 does"),
    "a scene without its site": (lambda m: m["scene"].pop("site"), "scene.site = None does not follow"),
    "another id": (lambda m: m.update(id="paris+site.latitude=0"), "id = paris+site.latitude=0 does not follow"),
    "another formulation": (lambda m: m["run"].update(formulation="guess"), "guess is not a formulation"),
    "a check in no formulation": (
        lambda m: m["cross_checks"][0].update(formulation="guess"), "guess is no formulation"),
    "a check in the same formulation": (
        lambda m: m["cross_checks"][0].update(formulation=m["run"]["formulation"]), "no cross-check is in another"),
    "runs that do not agree": (
        lambda m: m["cross_checks"][0].update(position_m="1.0e-10"), "the runs differ by 1.0e-10"),
    "a smaller bound": (lambda m: m["bounds"]["grid"].update(x="1.0e-25"), "is not from half a unit to one"),
    "a smaller largest bound": (
        lambda m: m["bounds"].update(position_m=m["bounds"]["grid"]["x"]), "bounds.position_m = "),
    "a larger bound on times": (lambda m: m["bounds"]["transits"].update(t="1.0e-03"), "is not the largest"),
    "another invariant": (
        lambda m: m["invariant"].update(drift_m2_s2="0"), "invariant.drift_m2_s2 = 0 does not follow"),
    "an unfinished list": (
        lambda m: m.update(transits="undecided intervals"), "transits = undecided intervals does not follow"),
    "nothing to find": (
        lambda m: m.update(transits="xdot is identically zero"), "transits = xdot is identically zero does not follow"),
    "another release": (lambda m: m["scene"]["release"].update(x="0.4"), "x of the first row"),
    "another gravity": (lambda m: m["scene"]["site"].update(gravity="9.80666"), "does not follow from the scene"),
    "another time": (lambda m: m["scene"]["run"].update(t_end="600"), "times are not those of the scene"),
    "a scene that is none": (lambda m: m["scene"]["pendulum"].update(length="0"), "the manifest's scene is refused"),
    "an extra key": (lambda m: m.update(comment="hello"), "breaks the schema at comment"),
    "a strange file": (
        lambda m: m["files"].update({"/dev/zero": m["files"]["grid.csv"]}), "breaks the schema at files"),
    "a huge number": (lambda m: m["bounds"].update(position_m="1e+999999999"), "breaks the schema at bounds"),
    "bounds that no double can square": (far_too_wide, "is not from half a unit to one"),
    "bounds wider than a digit": (lambda m: m["bounds"]["grid"].update(vz="1.1e-22"), "is not from half a unit to one"),
    "transits of a scene that asks for none": (
        lambda m: (m["scene"]["run"].update(transits="false"), m.update(transits="not asked for")),
        "counts.transits = 36 does not follow from the scene and the tables, which give 0"),
    "a wrong count": (lambda m: m["counts"].update(transits=35), "36 rows, but the manifest says 35"),
    "intervals that overlap": (lambda m: possible(m, (10, 20), (19, 30)), "must be intervals in order"),
    "an interval that ends before it begins": (lambda m: possible(m, (20, 10)), "must be intervals in order"),
    "an interval without length": (lambda m: possible(m, (20, 20)), "must be intervals in order"),
    "an interval beyond the end": (lambda m: possible(m, (299, "300.1")), "must be intervals in order"),
    "an interval before the start": (lambda m: possible(m, ("-0.1", 1)), "must be intervals in order"),
    "a proof wider than the bounds": (lambda m: proved(m, "position_m", "1.2"), "more than bounds.position_m"),
    "a proof of wider velocities": (lambda m: proved(m, "velocity_m_s", "1.11"), "more than bounds.velocity_m_s"),
    "a proof of wider times": (lambda m: proved(m, "transit_s", "1.2"), "more than bounds.transit_s"),
    "digits of no column": (lambda m: m["decimals"]["grid"].update(w=3), "decimals.grid: must name the columns"),
    "a number without digits": (lambda m: m["decimals"]["transits"].pop("x"), "decimals.transits: must name the"),
    "a grid of one time": (lambda m: m["counts"].update(grid=1), "a grid has two times at least"),
    "an audit of no proof": (lambda m: m.update(command=f"{m['command']} --audit"), "command does not follow"),
    "a run that checks itself": (one_run_twice, "level = self_consistent, and no cross-check differs from the run"),
    "a flag without a note": (lambda m: m.update(flags=["stiff"]), "notes: one for each flag"),
    "another note": (lambda m: m.update(flags=["stiff"], notes={"stiff": "x"}), "notes.stiff = x does not follow"),
}  # fmt: skip


@pytest.mark.parametrize("name", WORDS)
def test_a_forged_word_in_the_manifest_is_found_although_the_seal_fits(dataset, name):
    change, said = WORDS[name]
    forge(dataset, manifest=change)
    assert said in problems(dataset)


@pytest.mark.parametrize(
    "change",
    [
        lambda m: possible(m, (0, 10), (10, 20), (299, 300)),
        lambda m: proved(m, "position_m", "1.1"),  # bounds are rounded up to two digits
        lambda m: proved(m, "velocity_m_s", "1.1"),
        lambda m: proved(m, "transit_s", "1.1"),
        lambda m: m["cross_checks"][0].update(position_m=m["bounds"]["position_m"]),
    ],
)
def test_what_keeps_to_the_same_rules_passes(dataset, change):
    forge(dataset, manifest=change)
    rules = ("possible transits", "enclosure: the radius", "the runs are")
    assert not any(rule in problem for problem in problems_of(dataset) for rule in rules)


COLUMNS = [
    *(("grid", name) for name in GRID_HEADER[1:]),
    *(("transits", name) for name in TRANSITS),
]


# where the bob turns, h hardly depends on its speed
ONLY_MOTION = [("transits", "t"), ("transits", "vy")]


# of 30 and a million bounds one in each column, the other under --long
@pytest.mark.parametrize("kind, column, bounds", [
    *((*pair, 3) for pair in COLUMNS),
    *one_in(2, ((*pair, bounds) for i, pair in enumerate(COLUMNS) for bounds in ((30, 10**6), (10**6, 30))[i % 2])),
])  # fmt: skip
def test_a_number_that_is_off_by_three_bounds_or_more_is_found_in_every_column(
    dataset, kind, column, bounds
):
    files = read_files(dataset)
    row, side = (3, 1) if kind == "grid" else (7, -1)
    by = side * bounds * bound_of(files, kind, column, row)

    def change(rows, header):
        place = header.index(column)
        rows[row][place] = moved(rows[row][place], by)

    forge(dataset, **{kind: change})
    assert problems(dataset)


def test_without_numba_what_was_left_out_is_said(dataset, monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    found = verify(dataset)
    assert found.problems == []
    assert "numba" in found.undecided[0]


@pytest.mark.parametrize("kind, column", [pair for pair in COLUMNS if pair not in ONLY_MOTION])
def test_without_numba_thirty_bounds_are_found_row_by_row(dataset, monkeypatch, kind, column):
    monkeypatch.setitem(sys.modules, "numba", None)
    files = read_files(dataset)

    def change(rows, header):
        place = header.index(column)
        rows[3][place] = moved(rows[3][place], 30 * bound_of(files, kind, column, 3))

    forge(dataset, **{kind: change})
    assert problems(dataset)


def test_a_time_with_more_digits_than_it_needs_is_found(dataset):
    forge(
        dataset,
        grid=lambda rows, _: [row.__setitem__(0, f"{row[0]}.0") for row in rows],
        manifest=lambda document: document["decimals"]["grid"].update(t=1),
    )
    assert (
        problems(dataset) == "manifest.json: decimals of the grid's t do not follow from the scene"
    )


@pytest.mark.parametrize("column", range(1, 7))
def test_the_first_row_is_the_release(dataset, column):
    def change(rows, _):
        rows[0][column] = moved(rows[0][column], Fraction(1, 10**18))

    forge(dataset, grid=change)
    assert "is not that of the scene's release" in problems(dataset)


@pytest.mark.parametrize("column", [0, 1])
def test_doubles_that_are_not_the_nearest_are_found(dataset, column):
    files = read_files(dataset)
    lines = files.texts["grid.binary64.csv"].splitlines(keepends=True)
    cells = lines[3].rstrip("\n").split(",")
    double = float.fromhex(cells[7 + column]) * (1 + 2**-52)
    cells[column], cells[7 + column] = f"{double:.16e}", double.hex()
    lines[3] = ",".join(cells) + "\n"
    document = json.loads((dataset / MANIFEST).read_text())
    seal(dataset, document, {**files.texts, "grid.binary64.csv": "".join(lines)})
    assert "is not the double nearest to" in problems(dataset)


def test_a_page_or_vectors_that_tell_another_story_are_found(dataset):
    files = read_files(dataset)
    for name, old, new in (
        ("certified.txt", "State at", "Certified state at"),
        ("vectors.json", '"row": 2', '"row": 3'),
    ):
        document = json.loads((dataset / MANIFEST).read_text())
        seal(dataset, document, {**files.texts, name: files.texts[name].replace(old, new, 1)})
        assert f"{name}: does not follow from" in problems(dataset)


MALFORMED = {
    "another header": lambda rows, header: rows.insert(0, ["X"] * len(header)),
    "a lost digit": lambda rows, _: rows[2].__setitem__(1, rows[2][1][:-1]),
    "a long row": lambda rows, _: rows[2].append("1"),
    "a short row": lambda rows, _: rows[2].pop(),
    "a word": lambda rows, _: rows[2].__setitem__(1, "nan"),
    "a quote": lambda rows, _: rows[2].__setitem__(1, '"' + rows[2][1] + '"'),
    "other digits": lambda rows, _: rows[2].__setitem__(1, rows[2][1].replace("0", "\u0660")),
    "a blank line": lambda rows, _: rows.__setitem__(2, [""]),
}


@pytest.mark.parametrize("name", MALFORMED)
@pytest.mark.parametrize("table", ["grid.csv", "transits.csv", "grid.binary64.csv"])
def test_a_malformed_table_is_found_and_not_read_although_its_hash_fits(dataset, name, table):
    files = read_files(dataset)
    rows = [line.split(",") for line in files.texts[table].splitlines()]
    MALFORMED[name](rows, rows[0])
    document = json.loads((dataset / MANIFEST).read_text())
    seal(dataset, document, {**files.texts, table: "".join(",".join(row) + "\n" for row in rows)})
    assert table in problems(dataset)
    with pytest.raises(DatasetError, match=table):
        reference.load(dataset)


def drop(*which: int):
    def change(rows, _):
        for row in sorted(which, reverse=True):
            del rows[row]
        for k, row in enumerate(rows, 1):
            row[0] = str(k)

    return change


@pytest.mark.parametrize(
    "rows, said",
    [
        ((4,), "transits 4 and 5 do not alternate"),
        ((6, 7), "contradicts"),
        ((3, 4), "are not the motion's"),
    ],
)
def test_transits_left_out_are_found_by_their_neighbours_by_the_grid_or_by_the_motion(
    dataset, rows, said
):
    """Transits 7 and 8 of Paris lie on both sides of t = 60 s, 4 and 5 between two grid times."""
    forge(dataset, transits=drop(*rows))
    assert said in problems(dataset)


def swap(rows, _):
    rows[4][1], rows[6][1] = rows[6][1], rows[4][1]


ORDER = {
    "not in order": swap,
    "outside": lambda rows, _: rows[-1].__setitem__(1, "3" + rows[-1][1]),
    "does not count from 1": lambda rows, _: rows[2].__setitem__(0, "9"),
    "do not alternate": lambda rows, _: rows[4].__setitem__(
        2, "-1" if rows[4][2] == "+1" else "+1"
    ),
}


@pytest.mark.parametrize("said", ORDER)
def test_transits_out_of_order_are_found(dataset, said):
    forge(dataset, transits=ORDER[said])
    assert said in problems(dataset)


@pytest.mark.parametrize("direction", ["0", "+2", "-2", "2", "1", "+1.0", ""])
def test_a_direction_is_plus_or_minus_one_and_nothing_else(dataset, direction):
    forge(dataset, transits=lambda rows, _: rows[4].__setitem__(2, direction))
    assert f"row 5: direction = {direction!r} is not a number of this column's form" in problems(
        dataset
    )


def test_two_transits_at_one_time_are_found(dataset):
    forge(dataset, transits=lambda rows, _: rows[4].__setitem__(1, rows[3][1]))
    assert "transit 5: t is off by" in problems(dataset)


@pytest.mark.parametrize(
    ("digits", "span"),
    one_in(3, [(1, "600"), (2, "600"), (3, "600"), (2, "3600"), (4, "600"), (8, "3600")]),
)
def test_few_digits_pass_their_own_checks(tmp_path, digits, span):
    solution = reference.solve(
        reference.load_scene("paris"), t_end=span, digits=digits, level="confirmed"
    )
    assert problems(write(solution, tmp_path / "paris")) == ""


def test_a_dataset_with_drag_may_lose_energy(tmp_path):
    scene = make_scene(pendulum={"drag": "0.01"}, run={"t_end": "120", "digits": 15})
    assert problems(write(reference.solve(scene), tmp_path / "drag")) == ""


@pytest.fixture(scope="module", params=["confirmed", "enclosed"])
def swing(request):
    scene = {
        "id": "swing",
        "release": {"angle": "5", "azimuth": "30"},
        "run": {"t_end": "40", "grid_step": "20"},
    }
    return reference.solve(scene, level=request.param, digits=15, sections=["highest", "gate 30"])


@pytest.fixture(scope="module")
def written(swing, tmp_path_factory):
    return write(swing, tmp_path_factory.mktemp("sections") / "swing")


def test_a_dataset_with_sections_is_written_read_and_verified(swing, written):
    golden = reference.load(written)
    assert verify(written).problems == []
    assert list(golden.sections) == list(swing.sections)
    for word, passages in swing.sections.items():
        assert golden.sections[word].exact("t") == pytest.approx(
            passages.table.exact("t"), abs=1e-13
        )
        assert golden.sections[word].exact("vy") == pytest.approx(
            passages.table.exact("vy"), abs=1e-13
        )
        ways = [f"{way:+d}" for way in passages.directions]
        assert golden.sections[word].decimals("direction") == ways
        assert golden.sections[word].decimals("k") == [str(k) for k in range(1, len(ways) + 1)]


@pytest.mark.parametrize(
    ("said", "section", "columns", "part"),
    [
        ("passage of highest: t is off by", "highest", ["t"], "1e-10"),
        ("passage gate 30 2: the bob is not at the distance", "gate 30", ["x"], "1e-8"),
        ("passage gate 30 2: the velocity is not along the sphere", "gate 30", ["vx"], "1e-8"),
        ("passage gate 30 2: the invariant h differs", "gate 30", ["vx", "vy", "vz"], "1e-8"),
        ("passages are not the motion's", "gate 30", ["direction"], "-2"),
        ("rows are not those that the manifest counts", "gate 30", ["k"], "1"),
    ],
)
def test_a_forged_passage_is_found(written, tmp_path, said, section, columns, part):
    """The second of a section, with numbers that are off by a part of themselves."""
    folder, name = Path(shutil.copytree(written, tmp_path / "swing")), "sections.csv"
    sheet = read_files(folder).tables[name]
    rows = [list(row) for row in sheet.rows]
    row = next(row for row in rows if row[:2] == [section, "2"])
    for i in map(sheet.header.index, columns):
        changed = moved(row[i], Fraction(row[i]) * Fraction(part))
        row[i] = f"{int(changed):+d}" if columns == ["direction"] else changed
    text = "".join(",".join(row) + "\n" for row in (sheet.header, *rows))
    seal(
        folder, json.loads((folder / MANIFEST).read_text()), read_files(folder).texts | {name: text}
    )
    assert said in problems(folder)


def test_a_long_motion_in_a_small_file_is_not_integrated_and_that_is_said(tmp_path, foucault):
    """Two rows and no transits, of a million seconds."""
    scene = reference.load_scene(
        "paris", ["run.t_end=1000000", "run.grid_step=1000000", "run.digits=4"]
    )
    folder = write(reference.solve(scene, level="computed", transits=False), tmp_path / "paris")
    status, out, _ = foucault("verify", folder)
    ok = f"{folder}: ok "
    note = unwrapped(out).removeprefix(ok)
    assert status == 0 and unwrapped(out).startswith(ok)
    assert note.startswith(
        "checked only by --recompute: the motion (each row was checked by itself; "
    )
    assert re.search(r"integrating it again would take about [0-9]+ s\)$", note)
    (row,) = json.loads(foucault("verify", folder, "--json")[1])["rows"]
    assert row == {"path": str(folder), "ok": True, "problems": [], "notes": [note]}


def test_where_two_runs_do_not_decide_the_motion_finer_ones_follow(tmp_path):
    """This swing loses more than ten digits, and the manifest names a run of too few bits for them."""
    scene = reference.load_scene(
        "near_inverted", ["id=inverted", "run.transits=false", "run.level=confirmed"]
    )
    folder = write(reference.solve(scene), tmp_path / "inverted")
    forge(folder, manifest=lambda document: document["run"].update(number="real(64)"))
    found = verify(folder)
    assert (found.problems, found.undecided) == (
        [],
        ["checked only by --recompute: the cross-checks"],
    )


def test_recomputing_finds_what_no_physics_can_see_and_names_it_with_both_values(dataset, foucault):
    steps = read_files(dataset).manifest.run.steps
    forge(dataset, manifest=lambda document: document["run"].update(steps=steps + 1))
    assert problems(dataset) == ""
    line = f"manifest.json: run.steps = {steps + 1}, recomputed {steps}"
    assert recompute(dataset) == ([line], [])
    status, out, _ = foucault("verify", dataset, "--recompute")
    assert status == 1 and "WRONG" in out and line in unwrapped(out)
    forge(dataset, manifest=lambda document: document["generator"].update(numpy="0"))
    assert recompute(dataset)[0] == []  # another version may take other steps


def test_recomputing_names_the_first_line_of_a_table_that_differs(dataset):
    text = read_files(dataset).texts["grid.csv"].splitlines()
    last = text[2][-1]
    forge(
        dataset, grid=lambda rows, _: rows[1].__setitem__(-1, rows[1][-1][:-1] + str(int(last) ^ 1))
    )
    wrong, _ = recompute(dataset)
    assert wrong[0].startswith("grid.csv: 1 line differs; line 3 is ") and wrong[0].endswith(
        f"recomputed {text[2]}"
    )
    document = json.loads((dataset / MANIFEST).read_text())
    del document["files"]["vectors.json"]
    seal(dataset, document, {})
    assert "vectors.json: recomputing gives this file too" in recompute(dataset)[0]


def measured_otherwise(document):
    document["run"].update(steps=document["run"]["steps"] + 1)
    document["generator"].update(numpy="0")


@pytest.mark.parametrize("level", ["computed", "confirmed"])
def test_figures_that_another_machine_measures_otherwise_are_told_and_not_wrong(
    tmp_path, foucault, level
):
    """Those of runs in double or long double, and of other versions of the libraries; a digit or a bound is neither."""
    solution = reference.solve(reference.load_scene("paris"), t_end="60", digits=8, level=level)
    dataset = write(solution, tmp_path / "paris")
    assert solution.run.number in ("double", "long_double")
    forge(dataset, manifest=measured_otherwise)
    status, out, _ = foucault("verify", dataset, "--recompute")
    assert status == 0, out
    out = unwrapped(out)
    assert "every digit and bound is the same; 2 measured figures differ" in out
    assert f"generator.numpy = 0, recomputed {version('numpy')}" in out
    forge(dataset, manifest=lambda document: document["generator"].update(numpy=version("numpy")))
    assert "1 measured figure differs" in recompute(dataset)[1][0]  # and so may the hardware
    forge(dataset, manifest=lambda document: document["invariant"].update(drift_m2_s2="1.0e-3"))
    assert any("invariant.drift_m2_s2 = 1.0e-3" in line for line in recompute(dataset)[0])


@pytest.mark.parametrize("name", ["grid.csv", "certified.txt", MANIFEST])
def test_line_ends_that_a_copy_changed_are_named(dataset, name):
    data = (dataset / name).read_bytes()
    (dataset / name).write_bytes(data.replace(b"\n", b"\r\n"))
    with pytest.raises(DatasetError, match=rf"{name}: its lines end with CR LF instead of LF"):
        reference.load(dataset)
    (dataset / name).write_bytes(data.replace(b"\n", b"\r\n", 1) + b"x")
    assert "CR LF" not in problems(dataset)
