"""docs/checker refuses what is malformed or forged, without a memory error (AddressSanitizer and UBSan)."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

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
        # the package does not know such a parity, and left the page as it was
        if "possible transit" not in page:
            line = f"  possible transit in [{from_s}, {to_s}] s ({parity} number of zeros): not decided\n"
            page = page.replace("(complete)", "(undecided intervals)")
            page = page.replace("\nHow to score", line + "\nHow to score")
            (folder / "certified.txt").write_text(page)

    return with_page


def lax_bound_and_a_double_within_it(folder: Path) -> None:
    """State a true bound of a thousandth of a second, and a double that is off by less, consistently."""
    row = 1

    def change(rows: list[list[str]], header: list[str]) -> None:
        rows[row][header.index("bound")] = "1.0e-3"

    forge(folder, transits=change)
    lines = (folder / "transits.binary64.csv").read_text().splitlines()
    names = lines[0].split(",")
    cells = lines[row + 1].split(",")
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
    replaced("certified.txt", "Transits (xdot = 0, t > 0): 13", "Transits (xdot = 0, t > 0): 0")(
        folder
    )
    vectors = json.loads((folder / "vectors.json").read_text())
    vectors["scene"]["run"]["transits"] = "false"
    vectors["transits"] = []
    (folder / "vectors.json").write_text(json.dumps(vectors, indent=1, ensure_ascii=False) + "\n")


class Refusal(NamedTuple):
    """A dataset that is changed, the exit status of the checker, and what it says."""

    name: str
    change: Change
    status: int
    says: str
    dataset: str = PLAIN


ALL_TABLES = (
    "grid.csv",
    "transits.csv",
    "sections.csv",
    "grid.binary64.csv",
    "transits.binary64.csv",
)
LARGEST = str(2**63 - 1)
LEAST = str(-(2**63))
X = '"x": "0.3"'
LENGTH = '"length": "1"'
X_OF_ROW_1 = ",0.300000000000000000000000000000"

TABLES = [
    *(
        Refusal(
            f"no last newline: {file}",
            without_last_newline(file),
            2,
            "the last line has no end",
            WITH_SECTIONS,
        )
        for file in ALL_TABLES
    ),
    *(
        Refusal(
            f"{more!r} after the last row: {file}",
            appended(file, more),
            2,
            "the last line has no end",
            WITH_SECTIONS,
        )
        for file in ALL_TABLES
        for more in ("5", "5,", "5,1,2,3,4,5,")
    ),
    Refusal(
        "a cell too many",
        replaced("grid.csv", X_OF_ROW_1, f"{X_OF_ROW_1},1"),
        2,
        "grid.csv, line 2: ",
    ),
    Refusal("a cell too few", replaced("grid.csv", X_OF_ROW_1, ""), 2, "grid.csv, line 2: "),
    Refusal("an empty table", written("grid.csv", ""), 2, "is empty"),
    Refusal("a header alone", written("grid.csv", "t,x,y,z,vx,vy,vz\n"), 1, "0 rows"),
    Refusal("another header", replaced("grid.csv", "vz\n", "vzz\n"), 2, "the first line must be"),
    Refusal("a byte 0", replaced("grid.csv", "0.3000", "0.3\0000"), 2, "byte 0"),
    Refusal(
        "carriage returns", replaced("grid.csv", "vz\n", "vz\r\n"), 2, "the first line must be"
    ),
    Refusal("a table that is a folder", a_folder("grid.csv"), 2, "cannot be read"),
    Refusal(
        "a table that is listed, but not there", removed("grid.binary64.csv"), 2, "cannot be opened"
    ),
    Refusal(
        "vectors that are listed, but not there", removed("vectors.json"), 2, "cannot be opened"
    ),
    Refusal(
        "a table that was not asked for",
        written("sections.csv", "section\n"),
        1,
        "does not ask for it",
    ),
    Refusal("transits that were not asked for", asks_for_no_transits, 1, "does not ask for it"),
]

NUMBERS = [
    *(
        Refusal(
            f"a number {text[:40]!r}, {len(text)} characters",
            replaced("grid.csv", X_OF_ROW_1, f",{text}"),
            status,
            says,
        )
        for text, status, says in [
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
    Refusal(
        "a row with the number 1x",
        replaced("transits.csv", "\n1,", "\n1x,"),
        1,
        "its number is wrong",
    ),
    Refusal("decimals 30x", value("decimals", "grid", "x", to="30x"), 2, "not a whole number"),
]

DOCUMENTS = [
    *(
        Refusal(f"{file} of {text[:9]!r}, {len(text)} characters", written(file, text), 2, says)
        for file in (MANIFEST, "vectors.json")
        for text, says in [
            ("[" * 100_000, "brackets in one another"),
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
    Refusal("a manifest that is a folder", a_folder(MANIFEST), 2, "cannot be read"),
    Refusal("an unknown input", replaced(MANIFEST, LENGTH, f'{LENGTH}, "mass": "28"'), 1, "mass"),
    Refusal(
        "an unknown key", replaced(MANIFEST, '"digits": 30', '"digits": 30, "mass": 28'), 1, "mass"
    ),
    Refusal(
        "a vector without its row",
        replaced("vectors.json", '"row": 1,', '"now": 1,'),
        1,
        "states.0.now",
    ),
    Refusal(
        "a vector with more",
        replaced("vectors.json", '"row": 1,', '"row": 1, "t": "7",'),
        1,
        "states.0.t",
    ),
    Refusal(
        "a vector of row 0", replaced("vectors.json", '"row": 1,', '"row": 0,'), 2, "has no row 0"
    ),
    *(
        Refusal(
            f"a vector of row {row}",
            replaced("vectors.json", '"row": 1,', f'"row": {row},'),
            2,
            "whole number",
        )
        for row in (LARGEST, LEAST, "302", "1e0")
    ),
    *(
        Refusal(
            f"digits {text}",
            replaced(MANIFEST, '"digits": 30', f'"digits": {text}'),
            2,
            "whole number",
        )
        for text in (LARGEST, LEAST, "-1", "1e1", "1001")
    ),
]

INPUTS = [
    *(
        Refusal(
            f"a length {text[:30]!r}", replaced(MANIFEST, LENGTH, f'"length": "{text}"'), 2, says
        )
        for text, says in [
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
    Refusal(
        "a negative drag",
        value("scene", "pendulum", "drag", to="-1e-60"),
        2,
        "drag must be at least 0",
    ),
    Refusal("no drag", without_input, 2, "has no scene.pendulum.drag"),
    Refusal(
        "a flattening of 1",
        value("scene", "site", "inverse_flattening", to="1"),
        2,
        "must be above 1",
    ),
    Refusal("a cord that is too short", replaced(MANIFEST, X, '"x": "2"'), 1, "not proved"),
    Refusal("too much gravity", value("scene", "site", "gravity", to="1e499"), 1, "not proved"),
    Refusal(
        "too many steps",
        value("scene", "pendulum", "drag", to="1e40"),
        1,
        "more than 1e+07 steps",
        AT_REST,
    ),
    Refusal(
        "two kinds of release",
        replaced(MANIFEST, X, f'{X}, "angle": "30", "azimuth": "0"'),
        1,
        "WRONG",
    ),
    Refusal("transits: yes", value("scene", "run", "transits", to="yes"), 2, "true or false"),
    Refusal(
        "inputs: binary32", replaced(MANIFEST, '"decimal"', '"binary32"'), 2, "binary64 or decimal"
    ),
    Refusal("level: certain", value("level", to="certain"), 2, "level is certain"),
    Refusal(
        "a level below that of the scene", value("level", to="confirmed"), 1, "should be enclosed"
    ),
    Refusal("another format", value("schema_version", to=4), 2, "format 3"),
]

MEANING = [
    Refusal(
        "units",
        replaced(MANIFEST, '"m/s"', '"km/h"'),
        1,
        "units.vx, vy, vz is km/h, and should be m/s",
    ),
    Refusal(
        "axes",
        value("frame", to="topocentric, axes x west"),
        1,
        "frame is topocentric, axes x west",
    ),
    Refusal(
        "axes of the vectors",
        replaced("vectors.json", "x east", "x west"),
        1,
        "vectors.json: frame",
    ),
    Refusal(
        "units of the vectors",
        replaced("vectors.json", '"vx": "m/s"', '"vx": "km/h"'),
        1,
        "columns.vx",
    ),
    Refusal(
        "another reading on the page",
        replaced("certified.txt", "as: decimal", "as: binary64"),
        1,
        "Inputs are read",
    ),
    Refusal(
        "a bound twice on the page",
        replaced("certified.txt", "vx 5.1", "vx 6.1e-33, vx 5.1"),
        1,
        "by column",
    ),
    Refusal(
        "a second number in a line",
        replaced("certified.txt", "by column: ", "by column: x 1, "),
        1,
        "by column",
    ),
    Refusal(
        "the scene of the vectors", replaced("vectors.json", X, '"x": "0.2"'), 1, "scene.release.x"
    ),
]

DOUBLES = [
    *(
        Refusal(f"a hexfloat {text!r} in {file}", replaced(file, "0x0.0p+0", text), 2, says)
        for file in ("grid.binary64.csv", "vectors.json")
        for text, says in [
            ("0", "is not a hexfloat"),
            ("1e-99999", "is not a hexfloat"),
            ("0x0p+0", "is not a hexfloat"),
            (" 0x0.0p+0", "is not a hexfloat"),
            ("0x0.0p+-0", "is not a hexfloat"),
            ("0x0.0p+0 ", "is not a hexfloat"),
            ("0x0.0p-99999", "is not a hexfloat"),
            ("nan", "is not a hexfloat"),
            ("inf", "is not a hexfloat"),
            ("0x1.0p-9999", "no double is written"),
            ("0x1.8p-1074", "no double is written"),
            ("0x1.0p+9999", "no double is written"),
            ("0x0.8p+0", "no double is written"),
        ]
    ),
    Refusal(
        "a double within a lax bound",
        lax_bound_and_a_double_within_it,
        1,
        "is not the nearest double",
    ),
    Refusal(
        "a direction beside doubles",
        in_a_doubles_row("direction", "+1"),
        1,
        "direction is not that of",
    ),
    Refusal("a number beside doubles", in_a_doubles_row("k", "2"), 1, "k is not that of"),
    Refusal(
        "a bound beside doubles", in_a_doubles_row("bound", "5.1e-28"), 1, "bound is not that of"
    ),
]

INTERVALS = [
    Refusal("an unknown parity", possible("1", "2", "banana"), 1, "not odd, even or unknown"),
    Refusal(
        "an interval after the end", possible("3000.5", "3000.6", "even"), 1, "ends after the run"
    ),
    Refusal(
        "an interval over the end", possible("2999.9", "3000.1", "even"), 1, "ends after the run"
    ),
]

SECTIONS = [
    *(
        Refusal(
            f"sections {words[:30]!r}",
            replaced(MANIFEST, '"gate 127"', f'"{words}"'),
            status,
            says,
            WITH_SECTIONS,
        )
        for words, status, says in [
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
    *(
        Refusal(
            f"{count} rows of a section", section_count(count), 2, "whole number", WITH_SECTIONS
        )
        for count in (-1, -5001, -100_000, 10**18)
    ),
    Refusal("fewer rows of a section", section_count(100), 1, "the manifest 100", WITH_SECTIONS),
    Refusal(
        "rows of another section",
        replaced(MANIFEST, ": 107\n", ': 107, "lowest": 3\n'),
        1,
        "lowest",
        WITH_SECTIONS,
    ),
]

CASES = [*TABLES, *NUMBERS, *DOCUMENTS, *INPUTS, *MEANING, *DOUBLES, *INTERVALS, *SECTIONS]


def test_the_datasets_that_are_changed_are_proved(sanitized_check):
    for name in (PLAIN, WITH_SECTIONS, AT_REST):
        done = sanitized_check(GOLDEN / name)
        assert (done.returncode, done.stderr) == (0, ""), done.stdout


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_what_is_malformed_or_forged_is_refused(sanitized_check, tmp_path, case):
    folder = shutil.copytree(GOLDEN / case.dataset, tmp_path / case.dataset)
    case.change(folder)
    done = sanitized_check(folder)
    assert (done.returncode, done.stderr) == (case.status, "")
    assert case.says in done.stdout
    assert "is proved" not in done.stdout
