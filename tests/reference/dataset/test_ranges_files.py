"""Ranges on disk: what is printed holds what was proved; a folder is written whole or not at all."""

import csv
import hashlib
import json
import re
from fractions import Fraction

import pytest
from mutations import loaded, named
from typer.testing import CliRunner

import reference
from reference.commands import app
from reference.dataset.manifest import text_of
from reference.dataset.ranges import ends, ranges_id, verify_ranges, write_ranges
from reference.enclosure.trusted.printed_box import check_ranges, end_of

BOX = {"pendulum.length": "±0.001", "site.gravity": "±1e-5"}


@pytest.fixture(scope="module")
def ranges():
    return reference.prove_ranges("paris", t_end="150", widths=BOX)


def rows(path):
    with path.open(encoding="utf-8", newline="") as handle:
        return list(csv.DictReader(handle))


def test_every_printed_interval_holds_the_proven_one_and_is_not_much_wider(ranges, tmp_path):
    folder = write_ranges(ranges, tmp_path / "out")
    for file, table in (("grid.csv", ranges.grid), ("transits.csv", ranges.transits)):
        read = rows(folder / file)
        assert len(read) == len(table) > 3
        for name in table.columns:
            for k, (row, (low, high)) in enumerate(zip(read, table.exact(name), strict=True)):
                left, right = Fraction(row[f"{name}_low"]), Fraction(row[f"{name}_high"])
                assert left <= low <= high <= right
                if k:  # the release has the digits of the row after it
                    assert right - left <= Fraction(6, 5) * (high - low)
    assert [Fraction(row["t"]) for row in rows(folder / "grid.csv")] == list(ranges.times)
    assert [int(row["direction"]) for row in rows(folder / "transits.csv")] == ranges.directions


def test_the_manifest_says_the_box_and_what_holds_the_tables(ranges, tmp_path):
    folder = write_ranges(ranges, tmp_path / "out")
    said = json.loads((folder / "ranges.json").read_text(encoding="utf-8"))
    assert said["id"] == ranges_id(ranges) == "paris+-pendulum.length=0.001,site.gravity=0.00001"
    assert said["level"] == "enclosed"
    assert said["uncertain"] == {"pendulum.length": "±0.001", "site.gravity": "±0.00001"}
    assert said["counts"] == {"grid": 4, "transits": len(ranges.transits), "possible": 0}
    low, high = map(Fraction, said["period_s"])
    assert low <= ranges.period[0] <= ranges.period[1] <= high
    for name, digest in said["sha256"].items():
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest() == digest


@pytest.mark.parametrize(
    "low, high, texts",
    [
        ("0.123456", "0.123789", ("0.12345", "0.12379")),
        ("-0.02", "0.03", ("-0.020", "0.030")),
        ("99.5", "250.5", ("99", "251")),
        (
            "-1e-30",
            "2e-30",
            ("-0.0000000000000000000000000000010", "0.0000000000000000000000000000020"),
        ),
    ],
)
def test_ends_are_rounded_outward_to_the_digits_of_the_width(low, high, texts):
    assert ends(Fraction(low), Fraction(high)) == texts


def test_ranges_replace_ranges_and_nothing_else(ranges, tmp_path):
    folder = write_ranges(ranges, tmp_path / "out")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    write_ranges(ranges, folder)
    assert before == {path.name: path.read_bytes() for path in folder.iterdir()}
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "manifest.json").write_text("{}", encoding="utf-8")
    with pytest.raises(reference.InputError, match="with older ranges"):
        write_ranges(ranges, tmp_path / "other")
    point = reference.solve("paris", t_end="20", digits=6, level="computed")
    with pytest.raises(reference.InputError, match="with an older dataset"):
        reference.write(point, folder)
    assert before == {path.name: path.read_bytes() for path in folder.iterdir()}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other", "out"]


def test_an_end_that_is_rounded_inward_is_not_written(ranges, tmp_path):
    lying = loaded(named("reference/dataset/ranges.py ends, flip sign: -1"))
    with pytest.raises(reference.DatasetError, match="do not contain the proven ones"):
        lying.write_ranges(ranges, tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_ranges_are_read_back_as_printed(ranges, tmp_path):
    folder = write_ranges(ranges, tmp_path / "out")
    read = reference.load_ranges(folder)
    assert read.scene.with_values(["run.digits=30"]).exact == ranges.scene.exact
    assert (read.uncertain, read.times, read.directions) == (
        ranges.uncertain,
        ranges.times,
        ranges.directions,
    )
    assert (read.possible, read.engine, read.proof) == ((), ranges.engine, None)
    for name in ranges.grid.columns:
        assert (read.grid.low(name) <= ranges.grid.low(name)).all()
        assert (ranges.grid.high(name) <= read.grid.high(name)).all()
    assert read.period[0] <= ranges.period[0] <= ranges.period[1] <= read.period[1]
    with pytest.raises(reference.InputError, match="load_ranges reads them"):
        reference.load(folder)
    with pytest.raises(reference.InputError, match=r"a folder with ranges\.json"):
        reference.load_ranges("paris")


def seal_of(said):
    """Return the hash of ranges.json as it is written, without its seal."""
    return hashlib.sha256(text_of({**said, "seal": ""}).encode()).hexdigest()


def narrower(text):
    """A number raised by one in its last digit that allows it."""
    step, digits = (-1, "123456789") if text.startswith("-") else (1, "012345678")
    k = max(i for i, digit in enumerate(text) if digit in digits)
    return f"{text[:k]}{int(text[k]) + step}{text[k + 1 :]}"


CHANGES = {
    "a low end": ("grid.csv", lambda row: row.update(x_low=narrower(row["x_low"])) or row),
    "a high end that is no decimal": ("grid.csv", lambda row: row.update(x_high="1e3") or row),
    "a time": ("grid.csv", lambda row: row.update(t=narrower(row["t"])) or row),
    "a transit": ("transits.csv", lambda row: row.update(t_low=narrower(row["t_low"])) or row),
    "a direction": (
        "transits.csv",
        lambda row: row.update(direction=str(-int(row["direction"]))) or row,
    ),
    "a length": (
        "ranges.json",
        lambda said: said["scene"]["pendulum"].update(length="67.1") or said,
    ),
    "a width": (
        "ranges.json",
        lambda said: said["uncertain"].update({"pendulum.length": "±0.0011"}) or said,
    ),
    "a period": (
        "ranges.json",
        lambda said: said.update(period_s=[narrower(said["period_s"][0]), "16.44"]) or said,
    ),
    "a count": ("ranges.json", lambda said: said["counts"].update(transits=1) or said),
}


@pytest.mark.parametrize("sealed", [False, True])
@pytest.mark.parametrize("what", CHANGES)
def test_verify_finds_what_is_not_proved_even_if_it_is_sealed_anew(ranges, tmp_path, what, sealed):
    folder = write_ranges(ranges, tmp_path / "out")
    if not sealed and what == "a low end":
        assert verify_ranges(folder, recompute=True) == []
    file, change = CHANGES[what]
    if file == "ranges.json":
        said = change(json.loads((folder / file).read_text(encoding="utf-8")))
    else:
        said, lines = (
            json.loads((folder / "ranges.json").read_text(encoding="utf-8")),
            rows(folder / file),
        )
        change(lines[2])
        text = "".join(
            ",".join(line) + "\n"
            for line in [list(lines[0]), *(list(row.values()) for row in lines)]
        )
        (folder / file).write_text(text, encoding="utf-8")
        if sealed:
            said["sha256"][file] = hashlib.sha256(text.encode()).hexdigest()
    if sealed:
        said["seal"] = seal_of(said)
    (folder / "ranges.json").write_text(text_of(said), encoding="utf-8")
    problems = verify_ranges(folder)
    assert problems and ("do not contain the proven ones" in problems[0]) is sealed
    if not sealed:
        with pytest.raises(reference.DatasetError, match=r"seal|sha256"):
            reference.load_ranges(folder)


def test_verify_takes_ranges_beside_datasets(ranges, tmp_path):
    folder = write_ranges(ranges, tmp_path / "out")
    done = CliRunner().invoke(app, ["verify", str(folder)])
    assert (done.exit_code, done.output) == (0, f"{folder}: ok\n")
    (folder / "grid.csv").write_text("t\n", encoding="utf-8")
    done = CliRunner().invoke(app, ["verify", str(folder), "--json"])
    assert done.exit_code == 1
    assert "a byte was changed" in json.loads(done.stdout)["rows"][0]["problems"][0]


def sealed_anew(folder, change):
    """Change `ranges.json` by a function of its document, and seal it again."""
    said = json.loads((folder / "ranges.json").read_text(encoding="utf-8"))
    change(said)
    for name in said["sha256"]:
        said["sha256"][name] = hashlib.sha256((folder / name).read_bytes()).hexdigest()
    said["seal"] = seal_of(said)
    (folder / "ranges.json").write_text(text_of(said), encoding="utf-8")


def test_ranges_that_were_made_with_derivatives_are_proved_again_with_them(tmp_path):
    ranges = reference.prove_ranges("paris", t_end="20", widths=BOX, derivatives=True)
    folder = write_ranges(ranges, tmp_path / "out")
    assert verify_ranges(folder, recompute=True) == []
    assert reference.load_ranges(folder).derivatives


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda said: said.update(level="confirmed"), "the level"),
        (lambda said: said.update(format=2), r"format = 2, proved again 1"),
        (lambda said: said.update(id="paris"), "id = paris, proved again"),
        (lambda said: said.update(period_s=None), "period_s = None, proved again an interval"),
        (
            lambda said: said["proof"].update(radius_m="1e-30"),
            "proof.radius_m = 1e-30, proved again",
        ),
        (lambda said: said["proof"].update(bits=1000), "proof.bits = 1000, proved again"),
        (lambda said: said["proof"].update(steps=1), "proof.steps = 1, proved again"),
    ],
)
def test_verify_finds_what_ranges_say_wrongly_of_their_proof(ranges, tmp_path, change, message):
    folder = write_ranges(ranges, tmp_path / "out")
    sealed_anew(folder, change)
    assert re.search(message, "; ".join(verify_ranges(folder)))


@pytest.mark.parametrize("file", ["grid.csv", "transits.csv"])
@pytest.mark.parametrize("spoil", [lambda text: text.replace("\n", "\r\n"), lambda text: text[:-1]])
def test_verify_finds_tables_with_other_ends_of_lines(ranges, tmp_path, file, spoil):
    folder = write_ranges(ranges, tmp_path / "out")
    with (folder / file).open("rb+") as handle:
        text = spoil(handle.read().decode())
        handle.seek(0)
        handle.truncate()
        handle.write(text.encode())
    assert "a byte was changed" in verify_ranges(folder)[0]
    sealed_anew(folder, lambda said: None)
    assert "do not contain the proven ones" in verify_ranges(folder)[0]


@pytest.mark.parametrize("name", ["grid.csv", "transits.csv", "ranges.json"])
def test_line_ends_that_a_copy_changed_are_named(ranges, tmp_path, name):
    folder = write_ranges(ranges, tmp_path / "out")
    data = (folder / name).read_bytes()
    (folder / name).write_bytes(data.replace(b"\n", b"\r\n"))
    (problem,) = verify_ranges(folder)
    assert problem.startswith(name) and "its lines end with CR LF instead of LF" in problem


def test_ranges_of_a_proof_that_looked_for_no_transits_do_not_say_that_there_are_none(tmp_path):
    ranges = reference.prove_ranges("paris", BOX, t_end="5", transits=False)
    folder = write_ranges(ranges, tmp_path / "out")
    texts = {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()}
    check_ranges(texts, ranges.proof.proved)
    said = json.loads(texts["ranges.json"])
    said["scene"]["run"]["transits"] = "true"
    with pytest.raises(ArithmeticError, match="whether transits were looked for"):
        check_ranges({**texts, "ranges.json": json.dumps(said)}, ranges.proof.proved)


def test_the_ends_of_an_uncertain_flattening_are_those_of_its_inverse():
    """1/f = 298.257223564 ± 1: f between 1/299.257223564 and 1/297.257223564."""
    inputs = reference.load_scene("paris").exact
    low, high = (
        end_of(inputs, {"site.inverse_flattening": "±1"}, side).flattening for side in (1, -1)
    )
    assert (1 / low, 1 / high) == (Fraction("299.257223564"), Fraction("297.257223564"))
