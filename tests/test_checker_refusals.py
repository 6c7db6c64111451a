"""docs/checker refuses what is malformed or forged, and reads it without a memory error (AddressSanitizer and UBSan)."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from forgery import forge
from places import ROOT

from reference.dataset.manifest import MANIFEST

GOLDEN = ROOT / "data/golden"
PLAIN = "weightless"  # 0.1 s; it has all files but sections.csv
WITH_SECTIONS = "museum_gate"
AT_REST = "at_rest"  # without transits

Change = Callable[[Path], object]


def replaced(file: str, old: str, new: str) -> Change:
    """Return the change of a text in a file, where it first occurs."""

    def change(folder: Path) -> None:
        text = (folder / file).read_text()
        assert old in text
        (folder / file).write_text(text.replace(old, new, 1))

    return change


def appended(file: str, more: str) -> Change:
    return lambda folder: (folder / file).write_text((folder / file).read_text() + more)


def written(file: str, text: str | bytes) -> Change:
    data = text if isinstance(text, bytes) else text.encode()
    return lambda folder: (folder / file).write_bytes(data)


def without_last_newline(file: str) -> Change:
    return lambda folder: (folder / file).write_text((folder / file).read_text().removesuffix("\n"))


def a_folder(file: str) -> Change:
    def change(folder: Path) -> None:
        (folder / file).unlink()
        (folder / file).mkdir()

    return change


def removed(file: str) -> Change:
    return lambda folder: (folder / file).unlink()


def value(*path: str | int, to: object) -> Change:
    """Return the change of a value in the manifest; all that depends on it is made to fit."""

    def change(document: Any) -> None:
        for key in path[:-1]:
            document = document[key]
        document[path[-1]] = to

    return lambda folder: forge(folder, manifest=change)


def possible(from_s: str, to_s: str, parity: str) -> Change:
    """Return the addition of an interval that may hold transits."""

    def change(document: Any) -> None:
        document["transits"] = "undecided intervals"
        document["counts"]["possible"] = 1
        document["possible"] = [{"from_s": from_s, "to_s": to_s, "parity": parity}]
        assert Fraction(from_s) < Fraction(to_s)

    def with_page(folder: Path) -> None:
        forge(folder, manifest=change)
        page = (folder / "certified.txt").read_text()
        if "possible transit" not in page:  # the package does not know such a parity, and left the page as it was
            line = f"  possible transit in [{from_s}, {to_s}] s ({parity} number of zeros): not decided\n"
            page = page.replace("(complete)", "(undecided intervals)").replace("\nHow to score", line + "\nHow to score")
            (folder / "certified.txt").write_text(page)

    return with_page


def lax_bound_and_a_double_within_it(folder: Path) -> None:
    """State a true bound of a thousandth of a second, and a double that is off by less, consistently."""
    old, row = "1.", 1

    def change(rows: list[list[str]], header: list[str]) -> None:
        rows[row][header.index("bound")] = "1.0e-3"

    forge(folder, transits=change)
    lines = (folder / "transits.binary64.csv").read_text().splitlines()
    names, cells = lines[0].split(","), lines[row + 1].split(",")
    double = float(cells[names.index("t")]) + 2e-4
    cells[names.index("t")] = f"{double:.16e}"
    old = cells[names.index("t_hex")]
    cells[names.index("t_hex")] = double.hex()
    lines[row + 1] = ",".join(cells)
    (folder / "transits.binary64.csv").write_text("\n".join(lines) + "\n")
    vectors = (folder / "vectors.json").read_text()
    (folder / "vectors.json").write_text(vectors.replace(f'"{old}"', f'"{double.hex()}"'))


def in_a_doubles_row(column: str, to: str) -> Change:
    def change(folder: Path) -> None:
        file = folder / "transits.binary64.csv"
        lines = file.read_text().splitlines()
        cells = lines[1].split(",")
        cells[lines[0].split(",").index(column)] = to
        lines[1] = ",".join(cells)
        file.write_text("\n".join(lines) + "\n")

    return change


def section_count(count: int) -> Change:
    return value("sections", "counts", "gate 127", to=count)


def without_input(folder: Path) -> None:
    """Leave out an input that is 0."""
    forge(folder, manifest=lambda document: document["scene"]["pendulum"].pop("drag"))


def asks_for_no_transits(folder: Path) -> None:
    """Say that no transits were asked for; their tables are still there."""

    def change(document: Any) -> None:
        document["scene"]["run"]["transits"] = "false"
        document["transits"] = "not asked for"
        document["counts"]["transits"] = 0
        document["bounds"].update(transit_s=None, transits={})
        document["decimals"]["transits"] = {}

    forge(folder, manifest=change)
    page = (folder / "certified.txt").read_text()
    (folder / "certified.txt").write_text(page.replace("Transits (xdot = 0, t > 0): 13", "Transits (xdot = 0, t > 0): 0"))
    vectors = json.loads((folder / "vectors.json").read_text())
    vectors["scene"]["run"]["transits"] = "false"
    vectors["transits"] = []
    (folder / "vectors.json").write_text(json.dumps(vectors, indent=1, ensure_ascii=False) + "\n")


X = '"x": "0.3"'
LENGTH = '"length": "1"'
DEEP = "[" * 100_000
LARGEST, LEAST = str(2**63 - 1), str(-(2**63))
FIRST_ROW = "0.300000000000000000000000000000,0.400000000000000000000000000000"

# name, dataset, change, exit status, what is said
CASES: list[tuple[str, str, Change, int, str]] = [
    # tables
    *(
        (f"no last newline: {file}", WITH_SECTIONS, without_last_newline(file), 2, "the last line has no end")
        for file in ("grid.csv", "transits.csv", "sections.csv", "grid.binary64.csv", "transits.binary64.csv")
    ),
    *(
        (f"{more!r} after the last row: {file}", WITH_SECTIONS, appended(file, more), 2, "the last line has no end")
        for file in ("grid.csv", "transits.csv", "sections.csv", "grid.binary64.csv", "transits.binary64.csv")
        for more in ("5", "5,", "5,1,2,3,4,5,")
    ),
    ("a cell too many", PLAIN, replaced("grid.csv", FIRST_ROW, FIRST_ROW + ",1"), 2, "grid.csv, line 2: the end of the line should be here"),
    ("a cell too few", PLAIN, replaced("grid.csv", FIRST_ROW, "0.3"), 2, "grid.csv, line 2: , should be here"),
    ("an empty table", PLAIN, written("grid.csv", ""), 2, "is empty"),
    ("a header alone", PLAIN, written("grid.csv", "t,x,y,z,vx,vy,vz\n"), 1, "0 rows"),
    ("another header", PLAIN, replaced("grid.csv", "vz\n", "vzz\n"), 2, "the first line must be"),
    ("a byte 0", PLAIN, replaced("grid.csv", "0.3000", "0.3\0000"), 2, "byte 0"),
    ("carriage returns", PLAIN, replaced("grid.csv", "vz\n", "vz\r\n"), 2, "the first line must be"),
    ("a table that is a folder", PLAIN, a_folder("grid.csv"), 2, "cannot be read"),
    ("a table that is listed, but not there", PLAIN, removed("grid.binary64.csv"), 2, "cannot be opened"),
    ("vectors that are listed, but not there", PLAIN, removed("vectors.json"), 2, "cannot be opened"),
    ("a table that was not asked for", PLAIN, written("sections.csv", "section\n"), 1, "does not ask for it"),
    ("transits that were not asked for", PLAIN, asks_for_no_transits, 1, "does not ask for it"),
    # numbers of tables
    *(
        (f"a number {text[:40]!r}, {len(text)} characters", PLAIN, replaced("grid.csv", ",0.300000000000000000000000000000", f",{text}"), status, said)
        for text, status, said in [
            ("+0.300000000000000000000000000000", 2, "is not a number"),
            ("00.300000000000000000000000000000", 2, "is not a number"),
            (".300000000000000000000000000000", 2, "is not a number"),
            ("-0.000000000000000000000000000000", 2, "is not a number"),
            ("3.00000000000000000000000000e-1", 1, "another number of decimals"),
            ("3.000000000000000000000000000e-1", 2, "is not a number"),
            ("0.3" + "0" * 4000, 1, "another number of decimals"),
            ("0.3" + "0" * 6000, 1, "another number of decimals"),
            ("", 1, "another number of decimals"),
            ("nan", 1, "another number of decimals"),
        ]
    ),
    ("a number of a row 1x", PLAIN, replaced("transits.csv", "\n1,", "\n1x,"), 1, "its number is wrong"),
    ("decimals 30x", PLAIN, value("decimals", "grid", "x", to="30x"), 2, "not a whole number"),
    # JSON
    *(
        (f"{file} of {text[:9]!r}, {len(text)} characters", PLAIN, written(file, text), 2, said)
        for file in (MANIFEST, "vectors.json")
        for text, said in [
            (DEEP, "brackets in one another"),
            ('{"a": ' * 100_000, "brackets in one another"),
            ("{", "should be here"),
            ("[", "no value"),
            ('{"', "should be here"),
            ('{"a', "should be here"),
            ('{"a"', "should be here"),
            ('{"a": ', "no value"),
            ('{"a": "', "should be here"),
            ('{"a": "b"', "should be here"),
            ('{"a": "b",', "should be here"),
            ('{"a": "b"}', "should be here"),
            ('{"a": "b"}\n\n', "goes on"),
            ('{"a": 1, "a": 2}\n', "comes twice"),
            ('{"' + "k" * 6000 + '": 1}\n', "too long"),
            ("[" + "1, " * 6000 + "1]\n", "more than 5000 keys"),
            ('{"a": b}\n', "no value"),
            ('{"a": "\\u0062"}\n', "has a \\"),
            ("\0", "byte 0"),
        ]
    ),
    ("a manifest that is a folder", PLAIN, a_folder(MANIFEST), 2, "cannot be read"),
    ("an unknown key of the scene", PLAIN, replaced(MANIFEST, LENGTH, f'{LENGTH}, "mass": "28"'), 1, "mass"),
    ("an unknown key", PLAIN, replaced(MANIFEST, '"digits": 30', '"digits": 30,\n "mass": 28'), 1, "does not belong there"),
    ("the number of a vector under another key", PLAIN, replaced("vectors.json", '"row": 1,', '"now": 1,'), 1, "states.0.now"),
    ("a false number in a vector's extra key", PLAIN, replaced("vectors.json", '"row": 1,', '"row": 1, "t": "7",'), 1, "states.0.t"),
    # inputs
    *(
        (f"a length {text[:20]}", PLAIN, replaced(MANIFEST, LENGTH, f'"length": "{text}"'), 2, said)
        for text, said in [
            (f"1e{LEAST}", "is not a number"),
            (f"1e{LARGEST}", "is not a number"),
            ("1e-99999", "is not a number"),
            ("1e2000", "above 1e500"),
            ("1e-501", "below 1e-500"),
            ("1" * 3000, "is not a number"),
            ("1e", "is not a number"),
            ("1e5e5", "is not a number"),
            ("1e+-5", "is not a number"),
            ("1 ", "is not a number"),
            ("0x1", "is not a number"),
            ("nan", "is not a number"),
            ("inf", "is not a number"),
            ("", "is not a number"),
            (".", "is not a number"),
            ("0", "must be above 0"),
            ("-1", "must be above 0"),
        ]
    ),
    ("a negative drag", PLAIN, value("scene", "pendulum", "drag", to="-1e-60"), 2, "drag must be at least 0"),
    ("no drag", PLAIN, without_input, 2, "has no scene.pendulum.drag"),
    ("a flattening of 1", PLAIN, value("scene", "site", "inverse_flattening", to="1"), 2, "must be above 1"),
    ("a cord that is too short", PLAIN, replaced(MANIFEST, X, '"x": "2"'), 1, "no size that a double holds"),
    ("forces that no double holds", PLAIN, value("scene", "site", "gravity", to="1e499"), 1, "not proved"),
    ("a drag that takes too many steps", AT_REST, value("scene", "pendulum", "drag", to="1e40"), 1, "more than 1e+07 steps"),
    ("release.angle beside release.x", PLAIN, replaced(MANIFEST, X, f'{X}, "angle": "30", "azimuth": "0"'), 1, ""),
    *((f"digits {text}", PLAIN, replaced(MANIFEST, '"digits": 30', f'"digits": {text}'), 2, "whole number") for text in (LARGEST, LEAST, "-1", "1e1", "1001")),
    ("transits asked for with another word", PLAIN, value("scene", "run", "transits", to="yes"), 2, "true or false"),
    ("inputs read in another way", PLAIN, replaced(MANIFEST, '"inputs": "decimal"', '"inputs": "binary32"'), 2, "binary64 or decimal"),
    ("another level", PLAIN, replaced(MANIFEST, '"level": "enclosed",\n "digits"', '"level": "certain",\n "digits"'), 2, "level is certain"),
    ("a level below that of the scene", PLAIN, value("level", to="confirmed"), 1, "should be enclosed"),
    ("another format", PLAIN, replaced(MANIFEST, '"schema_version": 3', '"schema_version": 4'), 2, "format 3"),
    # what the numbers mean
    ("units", PLAIN, replaced(MANIFEST, '"m/s"', '"km/h"'), 1, "units.vx, vy, vz is km/h, and should be m/s"),
    ("axes", PLAIN, value("frame", to="topocentric, axes x west"), 1, "frame is topocentric, axes x west"),
    ("axes of the vectors", PLAIN, replaced("vectors.json", "x east", "x west"), 1, "vectors.json: frame"),
    ("units of the vectors", PLAIN, replaced("vectors.json", '"vx": "m/s"', '"vx": "km/h"'), 1, "columns.vx"),
    ("the scene of the vectors", PLAIN, replaced("vectors.json", X, '"x": "0.2"'), 1, "scene.release.x"),
    # rows and vectors
    *((f"a vector of row {row}", PLAIN, replaced("vectors.json", '"row": 1,', f'"row": {row},'), 2, "whole number") for row in (LARGEST, LEAST, "302", "1e0")),
    ("a vector of row 0", PLAIN, replaced("vectors.json", '"row": 1,', '"row": 0,'), 2, "has no row 0"),
    # doubles
    *(
        (f"a hexfloat {text} in {file}", PLAIN, replaced(file, "0x0.0p+0", text), 2, said)
        for file in ("grid.binary64.csv", "vectors.json")
        for text, said in [
            ("0", "is not a hexfloat"),
            ("1e-99999", "is not a hexfloat"),
            ("0x0p+0", "is not a hexfloat"),
            (" 0x0.0p+0", "is not a hexfloat"),
            ("0x0.0p+-0", "is not a hexfloat"),
            ("0x0.0p+0 ", "is not a hexfloat"),
            ("0x1.0p-9999", "no double is written"),
            ("0x1.8p-1074", "no double is written"),
            ("0x1.0p+9999", "no double is written"),
            ("0x0.8p+0", "no double is written"),
            ("0x0.0p-99999", "is not a hexfloat"),
            ("nan", "is not a hexfloat"),
            ("inf", "is not a hexfloat"),
        ]
    ),
    ("a double within a lax bound", PLAIN, lax_bound_and_a_double_within_it, 1, "is not the nearest double"),
    ("a direction beside doubles", PLAIN, in_a_doubles_row("direction", "+1"), 1, "direction is not that of transits.csv"),
    ("a number beside doubles", PLAIN, in_a_doubles_row("k", "2"), 1, "k is not that of transits.csv"),
    ("a bound beside doubles", PLAIN, in_a_doubles_row("bound", "5.1e-28"), 1, "bound is not that of transits.csv"),
    # intervals
    ("an unknown parity", PLAIN, possible("1", "2", "banana"), 1, "and not odd, even or unknown"),
    ("an interval after the end", PLAIN, possible("3000.5", "3000.6", "even"), 1, "ends after the run"),
    ("an interval over the end", PLAIN, possible("2999.9", "3000.1", "even"), 1, "ends after the run"),
    # sections
    *(
        (f"sections {words!r}", WITH_SECTIONS, replaced(MANIFEST, '"sections": "gate 127"', f'"sections": "{words}"'), status, said)
        for words, status, said in [
            ("gate 127;", 2, "no space after a semicolon"),
            ("gate 127; ", 2, "is no section"),
            (";", 2, "is no section"),
            ("", 2, "is no section"),
            ("gate 127@1", 2, "is no section"),
            ("gate 1e2", 2, "is no section"),
            ("xdot", 2, "is no section"),
            ("gate 127; gate 127", 1, "row 108"),
            ("; ".join(["gate 127"] * 1000), 1, "row 108"),
        ]
    ),
    *((f"{count} rows of a section", WITH_SECTIONS, section_count(count), 2, "whole number") for count in (-1, -5001, -100_000, 10**18)),
    ("fewer rows of a section", WITH_SECTIONS, section_count(100), 1, "has 107 rows, the manifest 100"),
    ("a count of another section", WITH_SECTIONS, replaced(MANIFEST, '"gate 127": 107', '"gate 127": 107, "lowest": 3'), 1, "lowest"),
]  # fmt: skip


def test_the_datasets_that_are_changed_are_proved(sanitized_check):
    for name in (PLAIN, WITH_SECTIONS):
        done = sanitized_check(GOLDEN / name)
        assert (done.returncode, done.stderr) == (0, ""), done.stdout


@pytest.mark.parametrize(("name", "change", "status", "said"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_what_is_malformed_or_forged_is_refused(sanitized_check, tmp_path, name, change, status, said):
    folder = shutil.copytree(GOLDEN / name, tmp_path / name)
    change(folder)
    done = sanitized_check(folder)
    assert (done.returncode, done.stderr) == (status, "")
    assert said in done.stdout
    assert "is proved" not in done.stdout
