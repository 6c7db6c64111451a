"""Ranges on disk: what is printed holds what was proved; a folder is written whole or not at all."""

import csv
import hashlib
import json
from fractions import Fraction

import pytest

import reference
from reference.dataset import ranges as written
from reference.dataset.ranges import ends, ranges_id, write_ranges

BOX = {"pendulum.length": "±0.001", "site.gravity": "±1e-5"}


@pytest.fixture(scope="module")
def ranges():
    return reference.solve("paris", t_end="150", uncertain=BOX)


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
        ("-1e-30", "2e-30", ("-0.0000000000000000000000000000010", "0.0000000000000000000000000000020")),
    ],
)
def test_ends_are_rounded_outward_to_the_digits_of_the_width(low, high, texts):
    assert ends(Fraction(low), Fraction(high)) == texts


def test_ranges_replace_ranges_and_nothing_else(ranges, tmp_path, monkeypatch):
    folder = write_ranges(ranges, tmp_path / "out")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    write_ranges(ranges, folder)
    assert before == {path.name: path.read_bytes() for path in folder.iterdir()}
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "manifest.json").write_text("{}", encoding="utf-8")
    with pytest.raises(reference.InputError, match="or older ranges"):
        write_ranges(ranges, tmp_path / "other")
    point = reference.solve("paris", t_end="20", digits=6, level="computed")
    with pytest.raises(reference.InputError, match="or an older dataset"):
        reference.write(point, folder)
    monkeypatch.setattr(written, "outward", lambda value, side, places: written.fixed_decimal(value, places))
    with pytest.raises(reference.DatasetError, match="does not hold the proven one"):
        write_ranges(ranges, folder)
    assert before == {path.name: path.read_bytes() for path in folder.iterdir()}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other", "out"]
