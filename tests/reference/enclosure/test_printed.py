"""What is written from a proof is read back and held against it: a wrong digit, input or word anywhere is found."""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction

import pytest
from places import ROOT
from random_scenes import random_scene

pytest.importorskip("flint")

import reference
from reference.dataset.render import render
from reference.dataset.sheets import scene_inputs
from reference.enclosure.trusted.printed import asked, check_dataset, check_sections
from reference.errors import DatasetError, FoucaultError
from reference.scenes.scene import parse_scene
from reference.scenes.shipped import scene_ids


@pytest.fixture(scope="module")
def solution():
    return reference.solve(reference.load_scene("paris"), t_end="60", digits=18, level="enclosed")


@pytest.fixture(scope="module")
def texts(solution):
    return render(solution)


REFUSED = (ArithmeticError, ValueError, LookupError)


def refuse(solution, texts, **spoilt):
    """Demand that these texts are refused."""
    names = {
        "grid": "grid.csv",
        "transits": "transits.csv",
        "page": "certified.txt",
        "manifest": "manifest.json",
    }
    with pytest.raises(REFUSED):
        check_dataset(
            {**texts, **{names[name]: text for name, text in spoilt.items()}},
            solution.proof.enclosure.proved,
        )


@pytest.mark.parametrize("name", ["grid", "transits"])
def test_every_digit_that_is_changed_is_found(name, solution, texts):
    check_dataset(texts, solution.proof.enclosure.proved)
    header, *lines = texts[f"{name}.csv"].splitlines()
    found = 0
    for i in (0, len(lines) // 2, -1):
        cells = lines[i].split(",")
        for k in range(len(cells) - (name == "transits")):  # the bound may be larger
            for place in (0, len(cells[k]) // 2, -1):
                old = cells[k][place]
                if old.isdigit():
                    new = cells[k][:place] + str((int(old) + 1) % 10) + cells[k][place:][1:]
                    spoilt = [*lines]
                    spoilt[i] = ",".join([*cells[:k], new, *cells[k + 1 :]])
                    refuse(solution, texts, **{name: "\n".join([header, *spoilt, ""])})
                    found += 1
    assert found > 40


def test_a_release_between_two_decimals_may_be_either_of_them_and_no_other():
    changes = ["release.x=0.30000000005", "run.t_end=60", "run.digits=10"]
    solution = reference.solve(reference.load_scene("paris", changes), level="enclosed")
    texts = render(solution)
    for number in ("0.3000000000", "0.3000000001"):
        page = texts["certified.txt"].replace(" 0.3000000000\n", f" {number}\n")
        grid = texts["grid.csv"].replace("\n0,0.3000000000,", f"\n0,{number},")
        check_dataset(
            {**texts, "certified.txt": page, "grid.csv": grid}, solution.proof.enclosure.proved
        )
    for number in ("0.2999999999", "0.3000000002"):
        refuse(
            solution, texts, grid=texts["grid.csv"].replace("\n0,0.3000000000,", f"\n0,{number},")
        )


def swapped(lines):
    return [lines[0], lines[2], lines[1], *lines[3:]]


@pytest.mark.parametrize(
    "spoil",
    [
        swapped,
        lambda lines: lines[:-1],
        lambda lines: [*lines, lines[-1]],
        lambda lines: [lines[0].replace("x,y", "y,x"), *lines[1:]],
        lambda lines: [line.replace(",+1,", ",-1,") for line in lines],
        lambda lines: [
            ",".join([*line.split(",")[:-1], "1e-40"]) if k else line
            for k, line in enumerate(lines)
        ],
        lambda lines: [line.replace(",-0.", ",-0_0.") for line in lines],
    ],
)
def test_rows_columns_directions_bounds_and_spellings_that_are_wrong_are_found(
    spoil, solution, texts
):
    refuse(solution, texts, transits="\n".join([*spoil(texts["transits.csv"].splitlines()), ""]))


def spoilt_manifest(text, *path, value):
    """The manifest with one thing changed."""
    document = part = json.loads(text)
    for key in path[:-1]:
        part = part[key]
    part[path[-1]] = value
    return json.dumps(document)


WRONG = [
    *((("bounds", "grid", name), "1e-30") for name in ("x", "vz")),
    *((("bounds", "transits", name), "1e-30") for name in ("t", "ax")),
    *((("bounds", name), "1e-30") for name in ("position_m", "velocity_m_s", "transit_s")),
    *((("counts", name), 77) for name in ("grid", "transits", "possible")),
    *(
        (("transits",), word)
        for word in ("undecided intervals", "xdot is identically zero", "not asked for")
    ),
    *((("bounds", kind), {}) for kind in ("grid", "transits")),
    *(
        (("decimals", kind, name), 7)
        for kind, name in (("grid", "x"), ("grid", "t"), ("transits", "ax"))
    ),
    *(
        (("enclosure", f"{name}_radius_{unit}"), "1e-60")
        for name, unit in (("position", "m"), ("velocity", "m_s"))
    ),
    (("enclosure", "transit_radius_s"), "1e-60"),
    (("enclosure", "transit_radius_s"), None),
    (("level",), "confirmed"),
    (("units", "x, y, z"), "km"),
    (
        ("frame",),
        "topocentric, axes x west, y north, z up, origin at the suspension, z < 0 below it",
    ),
    (("possible",), [{"from_s": "1", "to_s": "2", "parity": "odd"}]),
    (("inputs",), "binary64"),
    (("scene", "pendulum", "length"), "67.000000000000000001"),
    (("scene", "pendulum", "drag"), "1e-18"),
    (("scene", "site", "latitude"), "48.8461110000000000001"),
    (("scene", "site", "gravity_is"), "effective"),
    (("scene", "site", "inverse_flattening"), "inf"),
    (("scene", "site", "wind"), "3"),
    (("scene", "release", "vx"), "1e-18"),
    (("scene", "release", "y"), "0.3"),
    (("scene", "run", "grid_step"), "30"),
    (("scene", "run", "t_end"), "61"),
]


@pytest.mark.parametrize(
    ("path", "value"), WRONG, ids=lambda x: ".".join(x) if isinstance(x, tuple) else ""
)
def test_a_manifest_of_other_inputs_bounds_counts_or_words_is_found(path, value, solution, texts):
    refuse(solution, texts, manifest=spoilt_manifest(texts["manifest.json"], *path, value=value))


def test_every_number_of_the_page_that_is_changed_is_found(solution, texts):
    page, found = texts["certified.txt"], 0
    begin, end = page.index("Inputs (SI"), page.index("How to score")
    for k in [k for k in range(begin, end) if page[k].isdigit() and not page[k + 1].isdigit()]:
        new = page[:k] + str((int(page[k]) + 1) % 10) + page[k + 1 :]
        refuse(solution, texts, page=new)
        found += 1
    assert found > 50
    refuse(solution, texts, page=page.replace("(complete)", "(undecided intervals)"))
    refuse(solution, texts, page=page.replace("  x  ", "  y  "))


def test_an_input_that_stands_twice_in_the_manifest_is_found(solution, texts):
    """A reader may take either of them."""
    text = texts["manifest.json"]
    refuse(
        solution, texts, manifest=text.replace('"length": "67"', '"length": "66", "length": "67"')
    )
    said = json.loads(text)
    said["scene"]["pendulum"]["length"] = "66"
    said["scene"]["run"]["length"] = "67"
    with pytest.raises(ArithmeticError, match="in two parts"):
        asked(said)


@pytest.mark.parametrize("name", ["grid", "transits"])
@pytest.mark.parametrize("spoil", [lambda text: text.replace("\n", "\r\n"), lambda text: text[:-1]])
def test_a_table_with_other_ends_of_lines_is_found(name, spoil, solution, texts):
    refuse(solution, texts, **{name: spoil(texts[f"{name}.csv"])})


@pytest.mark.parametrize("kind", ["grid", "transits"])
def test_a_double_that_is_not_the_nearest_is_found(kind, solution, texts):
    """Also where so few digits are printed that the decimal would allow it."""
    name = f"{kind}.binary64.csv"
    header, *lines = texts[name].splitlines()
    names = header.split(",")
    for column in ("t", "x", "vy"):
        cells = dict(zip(names, lines[-1].split(","), strict=True))
        other = math.nextafter(float(cells[column]), math.inf)
        for spoilt in (
            {column: f"{other:.16e}", f"{column}_hex": other.hex()},
            {f"{column}_hex": other.hex()},
            {column: f"{other:.16e}"},
        ):
            line = ",".join((cells | spoilt).values())
            with pytest.raises(REFUSED, match="double"):
                check_dataset(
                    {**texts, name: "\n".join([header, *lines[:-1], line, ""])},
                    solution.proof.enclosure.proved,
                )


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Level: enclosed. A proof", "Level: confirmed. A proof"),
        (
            "Level: enclosed. A proof encloses every printed",
            "Level: enclosed. Two runs agree to every printed",
        ),
        (" m, on every velocity", " km, on every velocity"),
        (" s, direction", " min, direction"),
        ("axes x east", "axes x west"),
        ("explicit.", "left out."),
    ],
)
def test_a_sentence_of_the_page_with_another_level_unit_or_axis_is_found(old, new, solution, texts):
    assert old in texts["certified.txt"]
    refuse(solution, texts, page=texts["certified.txt"].replace(old, new))


@pytest.mark.parametrize(
    "title", ["A Model pendulum (angles in degrees)", "State at rest", "How to score"]
)
def test_a_title_with_a_word_of_the_page_is_no_misprint(title, solution, tmp_path):
    titled = replace(solution, scene=solution.scene.with_values([f"title={title}"]))
    reference.write(titled, tmp_path / "titled")  # which reads the page back
    assert title in (tmp_path / "titled" / "certified.txt").read_text(encoding="utf-8")


def test_what_is_not_the_very_result_of_a_proof_is_not_written(solution, texts, tmp_path):
    """F5 of the audit: transits shifted between the proof and the tables were written."""
    proved, by = solution.proof.enclosure.proved, Fraction(1, 10**18)
    moved = [
        replace(z, t=replace(z.t, low=z.t.low + by, high=z.t.high + by))
        for z in proved.zeros["xdot"]
    ]
    for forged in (replace(proved), replace(proved, zeros={"xdot": tuple(moved)}), None):
        with pytest.raises(DatasetError, match="not what was proved"):
            proof = replace(
                solution.proof, enclosure=replace(solution.proof.enclosure, proved=forged)
            )
            reference.write(replace(solution, proof=proof), tmp_path / "forged")
    assert [*tmp_path.iterdir()] == []


@pytest.fixture(scope="module")
def with_sections():
    """A solution with sections, one of which has a zero that a proof cannot decide, and its texts."""
    release, run = {"angle": "5", "azimuth": "30"}, {"t_end": "40", "grid_step": "20"}
    scene = {"id": "own_plane", "release": release, "run": run}
    words = ["highest", "gate 30@0"]
    solution = reference.solve(scene, level="enclosed", digits=12, sections=words)
    return solution, {
        name: text for name, text in render(solution).items() if isinstance(text, str)
    }


def forged_sections(texts):
    """Yield texts whose sections are not what was proved, each with what is wrong with it."""
    table, manifest = texts["sections.csv"], json.loads(texts["manifest.json"])

    def said(change):
        document = json.loads(texts["manifest.json"])
        change(document["sections"])
        return texts | {"manifest.json": json.dumps(document)}

    row = table.splitlines()[2]
    cells = row.split(",")
    for i, cell in enumerate(cells[1:-1], 1):
        other = cell[:-1] + str((int(cell[-1]) + 5) % 10) if i != 3 else cell.replace("-", "+")
        yield (
            f"cell {i}",
            texts
            | {"sections.csv": table.replace(row, ",".join([*cells[:i], other, *cells[i + 1 :]]))},
        )
    other = table.replace(row, row.replace("highest", "gate 30@0"))
    yield "a word of a row", texts | {"sections.csv": other}
    yield "a row lost", texts | {"sections.csv": table.replace(row + "\n", "")}
    yield "the header", texts | {"sections.csv": table.replace("section,k", "sections,k")}
    yield (
        "a bound of a row",
        texts | {"sections.csv": table.replace(row, ",".join([*cells[:-1], "1e-30"]))},
    )
    yield "a possible zero lost", said(lambda s: s["possible"]["gate 30@0"].pop())
    for key, value in (("parity", "odd"), ("from_s", "0.001"), ("to_s", "0")):
        yield (
            key,
            said(
                lambda s, key=key, value=value: s["possible"]["gate 30@0"][0].update({key: value})
            ),
        )
    yield "a bound", said(lambda s: s["bounds"].update({"x": "1e-30"}))
    yield "decimals", said(lambda s: s["decimals"].update({"x": s["decimals"]["x"] + 1}))
    yield "a count", said(lambda s: s["counts"].update({"highest": s["counts"]["highest"] + 1}))
    yield (
        "the order of counts",
        said(lambda s: s.update(counts=dict(reversed(s["counts"].items())))),
    )
    yield (
        "the order of possible zeros",
        said(lambda s: s.update(possible=dict(reversed(s["possible"].items())))),
    )
    manifest["scene"]["run"]["sections"] = "highest"
    yield "the scene's sections", texts | {"manifest.json": json.dumps(manifest)}
    document = json.loads(texts["manifest.json"])
    del document["sections"]
    yield "no sections", texts | {"manifest.json": json.dumps(document)}


def test_passages_that_are_not_what_was_proved_are_found(with_sections):
    solution, texts = with_sections
    proved = solution.proof.enclosure.proved
    check_sections(texts, json.loads(texts["manifest.json"]), proved)
    check_dataset(texts, proved)
    for what, forged in forged_sections(texts):
        with pytest.raises(REFUSED):
            check_sections(forged, json.loads(forged["manifest.json"]), proved)
            pytest.fail(what)
        with pytest.raises(REFUSED):
            check_dataset(forged, proved)
            pytest.fail(what)
    for forgery in (replace(proved), replace(proved, zeros={"xdot": proved.zeros["xdot"]})):
        with pytest.raises(REFUSED):
            check_dataset(texts, forgery)


def test_sections_that_were_not_proved_are_found(with_sections, solution, texts):
    _, others = with_sections
    document = json.loads(texts["manifest.json"])
    document["sections"] = json.loads(others["manifest.json"])["sections"]
    refuse(
        solution, texts | {"sections.csv": others["sections.csv"]}, manifest=json.dumps(document)
    )


@pytest.mark.parametrize("sought", [True, False])
def test_no_transits_are_said_to_be_complete_only_where_a_proof_looked_for_them(sought):
    """A proof that was not asked for transits has none, as one that found none."""
    scene = reference.load_scene("paris")
    made = {
        word: reference.solve(scene, t_end="1", digits=12, level="enclosed", transits=word)
        for word in (True, False)
    }
    proved = made[sought].proof.enclosure.proved
    check_dataset(render(made[sought]), proved)
    with pytest.raises(ArithmeticError, match="all transits"):
        check_dataset(render(made[not sought]), proved)


def test_a_table_that_is_not_the_proof_is_a_misprint_and_not_written(solution, tmp_path):
    values = [*solution.grid.values]
    values[-1] = tuple(v + (1 << solution.grid.bits) // 10**17 for v in values[-1])
    wrong = replace(solution, grid=replace(solution.grid, values=values))
    with pytest.raises(ArithmeticError, match="misprint"):
        check_dataset(render(wrong), solution.proof.enclosure.proved)
    with pytest.raises(FoucaultError):
        reference.write(wrong, tmp_path / "wrong")
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize("reading", ["decimal", "binary64"])
def test_trusted_code_reads_the_same_inputs_and_times_as_the_solver(reading, size):
    scenes = [reference.load_scene(name, [f"inputs={reading}"]) for name in scene_ids()]
    scenes += [
        parse_scene({**random_scene(seed), "inputs": reading}) for seed in range(size(25, 100))
    ]
    for scene in scenes:
        assert asked({"scene": scene_inputs(scene), "inputs": reading}) == (
            scene.exact,
            tuple(scene.exact.grid),
        )


SHIPPING = """
from dataclasses import replace
from pathlib import Path
import reference
from reference.dataset.verify import verify

solution = reference.solve("paris", t_end="20", digits=12, level="enclosed", engine="heyoka")
place = Path("data/golden/paris")
try:
    reference.write(solution, place)
except reference.InputError as error:
    print(error.field, place.exists())
audited = replace(solution, proof=replace(solution.proof, audited=True))
reference.write(audited, place)
print(verify(place).problems)
reference.write(solution, "elsewhere/paris")
place.rename("older")
Path("elsewhere/paris").rename(place)
print(*verify(place).problems)
"""


def test_a_proof_ships_only_when_it_was_audited(tmp_path):
    """In a checkout of its own, where no dataset ships yet."""
    for part in ("reference", "data/scenes"):
        shutil.copytree(ROOT / part, tmp_path / part, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "data/flags.toml", tmp_path / "data")
    (tmp_path / "data/golden").mkdir()
    words = [sys.executable, "-c", SHIPPING]
    environment = os.environ | {"PYTHONPATH": str(tmp_path), "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(
        words, capture_output=True, text=True, check=False, cwd=tmp_path, env=environment
    )
    refused, passed, found = done.stdout.splitlines() or [done.stderr] * 3
    assert (refused, passed) == ("audit False", "[]")
    assert "audited" in found


def test_a_source_with_the_words_before_the_inputs_is_no_misprint():
    """`below_horizontal` could not be made again: its source ends in "degrees)", as the line above the inputs does."""
    solution = reference.solve(
        reference.load_scene("below_horizontal"), t_end="1", digits=12, level="enclosed"
    )
    assert "degrees)" in solution.scene.source
    check_dataset(render(solution), solution.proof.enclosure.proved)
