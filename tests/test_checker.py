"""docs/checker: compiled where cc and FLINT's headers are, it proves shipped datasets, and finds every forgery."""

from __future__ import annotations

import json
import random
import re
import shutil
from decimal import Decimal, localcontext

import pytest
from forgery import forge, seal
from places import ROOT

import reference
from reference.dataset.files import read_files
from reference.dataset.manifest import MANIFEST

GOLDEN = ROOT / "data/golden"
WITH_SECTIONS = ("laboratory_drag", "museum_gate")
QUICK = (
    "conical",
    "damped",
    "inverted_rest",
    "nanometre",
    "over_top",
    "separatrix",
    "two_radians.binary64",
)
FORGED = ("barely_over", "damped", "nanometre_paris", "vertical_picometre", "weightless")
GENERIC = ("barely_over", "damped", "nanometre_paris")  # their motion depends on every input


@pytest.mark.parametrize("name", QUICK + WITH_SECTIONS)
def test_shipped_datasets_are_proved(check, name):
    done = check(GOLDEN / name)
    assert done.returncode == 0, done.stdout
    assert "every printed number is proved" in done.stdout


def test_sections_of_every_kind_are_proved(check, tmp_path):
    words = "highest; lowest; turn 0; turn 30; gate 12.5; gate -30@0"
    scene = reference.load_scene(
        "paris", ["run.t_end=30", "run.digits=25", f"run.sections={words}", "release.vy=0.05"]
    )
    done = check(reference.write(reference.solve(scene), tmp_path / "paris"))
    assert done.returncode == 0, done.stdout
    rows = (tmp_path / "paris/sections.csv").read_text().splitlines()
    assert {row.split(",")[0] for row in rows[1:]} == set(words.split("; "))


@pytest.mark.parametrize("number", ["0.3000000000", "0.3000000001", "0.2999999999", "0.3000000002"])
def test_a_release_between_two_decimals_may_be_either_of_them(check, tmp_path, number):
    scene = reference.load_scene(
        "paris", ["release.x=0.30000000005", "run.t_end=30", "run.digits=10"]
    )
    tie = reference.write(reference.solve(scene, level="enclosed"), tmp_path / "tie")
    forge(tie, grid=lambda rows, header: rows[0].__setitem__(header.index("x"), number))
    seen = "is off by" in check(tie).stdout
    assert seen == (number not in ("0.3000000000", "0.3000000001"))


@pytest.mark.parametrize("last", ["", "0" * 60 + "1"])
def test_how_a_bob_begins_is_decided_where_it_is_pushed_exactly_sideways_alone(
    check, tmp_path, last
):
    push = ["release.vx=-0.04", f"release.vy=0.03{last}", "site.gravity_is=effective"]
    scene = reference.load_scene(
        "paris", [*push, "run.t_end=30", "run.digits=15", "run.sections=highest"]
    )
    aside = reference.write(reference.solve(scene, level="enclosed"), tmp_path / "aside")
    assert check(aside).returncode == 0
    forge(aside, manifest=lambda document: document["sections"]["possible"].update(highest=[]))
    assert check(aside).returncode == bool(last)


def test_what_is_not_a_dataset_is_refused(check, tmp_path):
    assert check(tmp_path).returncode == 2
    copy = shutil.copytree(GOLDEN / "weightless", tmp_path / "copy")
    text = (copy / MANIFEST).read_text()
    (copy / MANIFEST).write_text(text.replace('"length": "1"', '"length": "1" "2"'))
    assert check(copy).returncode == 2


@pytest.mark.parametrize("table", ["grid", "transits"])
def test_a_row_too_many_among_the_doubles_is_found(check, tmp_path, table):
    copy = shutil.copytree(GOLDEN / "weightless", tmp_path / "copy")
    doubles = copy / f"{table}.binary64.csv"
    doubles.write_text(doubles.read_text() + doubles.read_text().splitlines()[-1] + "\n")
    assert check(copy).returncode == 1


def test_with_too_few_bits_the_run_begins_again(check, tmp_path):
    copy = shutil.copytree(GOLDEN / "weightless", tmp_path / "copy")
    text = (copy / MANIFEST).read_text()
    # by which the bits are guessed
    (copy / MANIFEST).write_text(text.replace('"digits": 30', '"digits": 1'))
    done = check(copy)
    assert done.returncode == 1
    assert "digits is 1, and should be 30" in done.stdout


def by_one_unit(text: str, draw: random.Random) -> str:
    """Return a decimal changed by one unit of its last digit."""
    with localcontext() as context:
        context.prec = 200
        unit = Decimal(1).scaleb(-len(text.partition(".")[2]))
        changed = Decimal(text) + draw.choice((-1, 1)) * unit
    return f"{changed if changed else abs(changed):f}"


def grid_digit(folder, draw):
    def change(rows, header):
        row, column = draw.choice(rows), draw.randrange(len(header))
        row[column] = by_one_unit(row[column], draw)

    forge(folder, grid=change)


def transit_digit(folder, draw):
    def change(rows, header):
        row, column = draw.choice(rows), header.index(draw.choice(("t", "x", "y", "z", "vy", "ax")))
        row[column] = by_one_unit(row[column], draw)

    forge(folder, transits=change)


def direction(folder, draw):
    def change(rows, header):
        row, column = draw.choice(rows), header.index("direction")
        row[column] = "-1" if row[column] == "+1" else "+1"

    forge(folder, transits=change)


def numbered(rows):
    for k, row in enumerate(rows, 1):
        row[0] = str(k)


def order(folder, draw):
    def change(rows, header):
        i = draw.randrange(len(rows) - 1)
        rows[i], rows[i + 1] = rows[i + 1], rows[i]
        numbered(rows)

    forge(folder, transits=change)


def missing(folder, draw):
    def change(rows, header):
        del rows[draw.randrange(len(rows))]
        numbered(rows)

    forge(folder, transits=change)


def missing_pair(folder, draw):
    def change(rows, header):
        i = draw.randrange(len(rows) - 1)
        del rows[i : i + 2]
        numbered(rows)

    forge(folder, transits=change)


def doubled(folder, draw):
    def change(rows, header):
        i = draw.randrange(len(rows))
        rows.insert(i, list(rows[i]))
        numbered(rows)

    forge(folder, transits=change)


def missing_row(folder, draw):
    forge(folder, grid=lambda rows, header: rows.pop(draw.randrange(len(rows))))


def inputs_of(scene):
    """Yield the inputs that the motion depends on, section by section."""
    for section, fields in scene.items():
        for name, text in fields.items():
            if name not in ("gravity_is", "digits", "level", "transits") and text != "inf":
                yield section, name


def an_input(folder, draw):
    def change(document):
        section, name = draw.choice(list(inputs_of(document["scene"])))
        with localcontext() as context:
            context.prec = 200
            document["scene"][section][name] = (
                f"{Decimal(document['scene'][section][name]) + Decimal('1e-18'):f}"
            )

    forge(folder, manifest=change)


def meaning_of_gravity(folder, draw):
    def change(document):
        site = document["scene"]["site"]
        site["gravity_is"] = "effective" if site["gravity_is"] == "ellipsoid" else "ellipsoid"

    forge(folder, manifest=change)


def reading_of_inputs(folder, draw):
    forge(folder, manifest=lambda document: document.update(inputs="binary64"))


def another_file(folder, draw):
    """Change one digit in a file that follows from the tables, or a number of the manifest that does."""
    texts = dict(read_files(folder).texts)
    name = draw.choice(
        [name for name in texts if name not in ("grid.csv", "transits.csv", MANIFEST)]
    )
    pattern = (
        r"State at .*\n  x .*\n  y .*"
        if name.endswith(".txt")
        else r"0x[01]\.[0-9a-f]{13}|\d\.\d{15,}"
    )
    found = draw.choice(list(re.finditer(pattern, texts[name])))
    place = found.end() - 1
    text = texts[name]
    texts[name] = text[:place] + ("1" if text[place] == "0" else "0") + text[place + 1 :]
    seal(
        folder,
        json.loads((folder / MANIFEST).read_text()),
        {k: v for k, v in texts.items() if k != MANIFEST},
    )


def section_digit(folder, draw):
    def change(rows, header):
        row, column = (
            draw.choice(rows),
            header.index(draw.choice(("t", "x", "y", "z", "vx", "vy", "vz"))),
        )
        row[column] = by_one_unit(row[column], draw)

    forge(folder, sections=change)


def section_direction(folder, draw):
    def change(rows, header):
        row = draw.choice(rows)
        row[3] = "-1" if row[3] == "+1" else "+1"

    forge(folder, sections=change)


def passage_missing(folder, draw):
    def change(rows, header):
        word = rows.pop(draw.randrange(len(rows)))[0]
        for k, row in enumerate((row for row in rows if row[0] == word), 1):
            row[1] = str(k)

    forge(folder, sections=change)


def passage_of_another(folder, draw):
    """Say that the rows of a section are those of a gate a hundredth of a degree away, or of lowest points."""

    def change(document):
        old = draw.choice(list(document["sections"]["counts"]))
        new = "lowest" if old == "highest" else f"{old}.01"
        said = document["sections"]
        for key in ("counts", "possible"):
            said[key] = {new if word == old else word: value for word, value in said[key].items()}
        run = document["scene"]["run"]
        run["sections"] = run["sections"].replace(old, new)
        renamed.update({old: new})

    renamed: dict[str, str] = {}
    forge(folder, manifest=change)
    forge(
        folder,
        sections=lambda rows, header: [
            row.__setitem__(0, renamed.get(row[0], row[0])) for row in rows
        ],
    )


KINDS = (
    grid_digit,
    transit_digit,
    direction,
    order,
    missing,
    missing_pair,
    doubled,
    missing_row,
    an_input,
    meaning_of_gravity,
    reading_of_inputs,
    another_file,
    section_digit,
    section_direction,
    passage_missing,
    passage_of_another,
)
OF_SECTIONS = (section_digit, section_direction, passage_missing, passage_of_another)
OF_MOTION = (an_input, meaning_of_gravity, reading_of_inputs)


def forgery(draw, number):
    """Return a kind of forgery, each in turn, and a dataset that it fits."""
    kind = KINDS[number % len(KINDS)]
    return kind, draw.choice(
        WITH_SECTIONS if kind in OF_SECTIONS else GENERIC if kind in OF_MOTION else FORGED
    )


@pytest.mark.parametrize(("parity", "status"), [("odd", 0), ("even", 1), ("unknown", 0)])
def test_an_interval_that_may_hold_a_transit_is_left_out_and_its_parity_is_proved(
    check, tmp_path, parity, status
):
    folder = shutil.copytree(GOLDEN / "damped", tmp_path / "forged")

    def change(document):
        document["transits"], document["counts"]["possible"] = "undecided intervals", 1
        document["possible"] = [{"from_s": "24.7", "to_s": "24.8", "parity": parity}]

    def without_third(rows, header):
        assert rows.pop(2)[1].startswith("24.7")
        numbered(rows)

    forge(folder, transits=without_third, manifest=change)
    done = check(folder)
    assert done.returncode == status, done.stdout


def test_forgeries_are_found(check, tmp_path, size, tally):
    draw, missed, tried = random.Random(32), [], size(len(KINDS), 300)
    for number in range(tried):
        kind, name = forgery(draw, number)
        folder = shutil.copytree(GOLDEN / name, tmp_path / "forged")
        kind(folder, draw)
        done = check(folder)
        where = (
            r"sections\.csv"
            if kind in OF_SECTIONS
            else r"(grid|transits)\.csv"
            if kind in OF_MOTION
            else ""
        )
        if done.returncode != 1 or not re.search(where, done.stdout):
            missed.append((number, kind.__name__, name, done.returncode, done.stdout))
        shutil.rmtree(folder)
    assert not missed, missed
    tally(f"checker: {tried} forgeries, all found")
