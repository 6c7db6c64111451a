"""A fault between a solution and its files is refused as they are written, or found by `verify`: no wrong file passes.

A fault changes the solution that is handed on, or what is laid out of it. Whatever is made from that has it too, with
the checksums and the seal, as if the program had erred.
"""

from __future__ import annotations

import json
import math
import shutil
from copy import copy
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from forgery import forge, seal
from formats import contents
from sampled import one_in
from small_scenes import make_scene

pytest.importorskip("flint")

import reference
from reference.dataset.manifest import FUNCTION, MANIFEST
from reference.dataset.ranges import verify_ranges
from reference.dataset.verify import recompute, verify
from reference.dataset.write import write_texts
from reference.enclosure import Interval
from reference.errors import FoucaultError
from reference.model.formulations import FORMULATIONS
from reference.numbers.precision import fixed_decimal
from reference.solver.swing import Ends

SITE = {"rotation_rate": "0.0123", "equatorial_radius": "6371.1", "altitude": "12.5"}
RUN = {
    "t_end": "12",
    "grid_step": "3",
    "digits": 14,
    "level": "enclosed",
    "sections": "highest; gate 30",
}
BASE = {"pendulum": {"length": "4.1"}, "site": SITE, "run": RUN}
POSITION = {"x": "0.3", "y": "0.41", "vx": "0.15", "vy": "0.02"}
TURNING = {"angle": "35.5", "azimuth": "12.7", "angle_rate": "3.3", "azimuth_rate": "20.1"}
PLAIN, ANGLES, GATE, LAST = "plain", "angles", "at rest in a gate", "ends at a transit"
TWO_RUNS, DAMPED, FEW_DIGITS = "two runs", "damped", "few digits"  # without a proof
UNPROVED = {"digits": 12, "level": "confirmed", "t_end": "20", "grid_step": "5"}
SCENES = {
    PLAIN: make_scene(title="A short swing", release=POSITION, **BASE),
    ANGLES: make_scene(release=TURNING, **BASE),
    # no digit tells whether it passes the gate as it begins to fall
    GATE: make_scene(
        release={"x": "0.3", "y": "0"}, **{**BASE, "run": {**RUN, "sections": "highest; gate 0@0"}}
    ),
    TWO_RUNS: make_scene(
        release=POSITION, **{**BASE, "run": {**RUN, "level": "confirmed", "sections": []}}
    ),
    DAMPED: make_scene(
        release=POSITION, pendulum={"length": "4.1", "drag": "0.05"}, site=SITE, run=UNPROVED
    ),
    FEW_DIGITS: make_scene(
        release=POSITION, **{**BASE, "run": {**UNPROVED, "digits": 5, "level": "self_consistent"}}
    ),
}
ERRORS = (ArithmeticError, AssertionError, AttributeError, LookupError, TypeError, ValueError)
TINY = Fraction(1, 10**25)

REFUSED, ERROR, SAME = "refused as it is written", "ended in an error", "the right files"
SAID = "said not to be decided"
FOUND, AGAIN, NOBODY = "found by verify", "found by --recompute alone", "found by nobody"


@dataclass(frozen=True)
class Fault:
    """A fault by its name: it changes a solution, or the folder that was written of one."""

    name: str
    solution: Any = None
    folder: Any = None
    scene: str = PLAIN


# ------------------------------------------------------------------------------- the scene that was solved is another


def of_scene(*changes, scene=PLAIN):
    """A solution of a scene that says something else than what was solved."""

    def changed(solved):
        return replace(solved, scene=solved.scene.with_values(list(changes)))

    return Fault(f"{scene} scene: {', '.join(changes)}", changed, scene=scene)


INPUTS = (
    "pendulum.length=4.1000000000000000000000001",
    "pendulum.drag=1e-25",
    "site.altitude=12.5000000000000000000000001",
    "site.gravity=9.8100000000000000000000001",
    "site.rotation_rate=0.0123000000000000000000001",
    "site.equatorial_radius=6371.1000000000000000000000001",
    "site.latitude=48.8461110000000000000001",
    "site.gravity_is=effective",
    "run.grid_step=3.000001",
    "run.level=confirmed",
    "run.transits=false",
    "run.sections=highest",
    "release.x=0.3000000000000000000000001",
    "release.vx=0.16",
    "inputs=binary64",
)
OF_SCENE = [
    *(of_scene(change) for change in INPUTS),
    of_scene("release.vx=0.02", "release.vy=0.15"),
    of_scene("release.angle=35.5000000000000000000001", scene=ANGLES),
    of_scene("release.azimuth=372.7", scene=ANGLES),
    # of two runs, which prove nothing: each moves a number by more than its bound
    of_scene("site.rotation_rate=0.0123000001", scene=TWO_RUNS),
    of_scene("site.latitude=48.8462", scene=TWO_RUNS),
    of_scene("pendulum.length=4.10000001", scene=TWO_RUNS),
    of_scene("pendulum.drag=1e-7", scene=TWO_RUNS),
    of_scene("site.gravity_is=effective", scene=TWO_RUNS),
]


# ------------------------------------------------------------------------------- numbers between proof and tables


def with_rows(table, change):
    """Return a table whose rows of whole numbers, and their errors, are changed."""
    rows = [list(row) for row in table.values]
    errors = [list(row) for row in table.errors]
    change(rows, errors, 1 << table.bits)
    return replace(table, values=[*map(tuple, rows)], errors=[*map(tuple, errors)])


def with_zeros(solved, word, **changes):
    """Return the zeros of a solution, or of ranges, with those of one word changed."""
    return {"zeros": {**solved.zeros, word: solved.zeros[word]._replace(**changes)}}


def of_table(where, name, change, scene=PLAIN):
    """A change of the grid, or of the zeros of a word."""

    def solution(solved):
        if where == "grid":
            return replace(solved, grid=with_rows(solved.grid, change))
        table = with_rows(solved.zeros[where].table, change)
        return replace(solved, **with_zeros(solved, where, table=table))

    return Fault(f"{scene} {where}: {name}", solution, scene=scene)


def both(change):
    """Rows and their errors are changed alike."""

    def changed(rows, errors, unit):
        change(rows)
        change(errors)

    return changed


def set_cell(k, i, value):
    def change(rows, errors, unit):
        rows[k][i] = int(value(rows[k], unit))

    return change


NUMBERS = {
    "a number off by a unit of its last digit": set_cell(
        -1, 1, lambda row, unit: row[1] + unit // 10**13
    ),
    "a number off by less than it": set_cell(-1, 1, lambda row, unit: row[1] + unit // 10**16),
    "a sign": set_cell(-1, 1, lambda row, unit: -row[1]),
    "ten times a number": set_cell(-1, 2, lambda row, unit: 10 * row[2]),
    "two columns in the other order": lambda rows, errors, unit: [
        row.insert(1, row.pop(2)) for row in rows
    ],
    "the last row lost": both(list.pop),
    "a row lost": both(lambda rows: rows.pop(1)),
    "a row twice": both(lambda rows: rows.insert(1, rows[1])),
    "the rows in the other order": both(list.reverse),
}


def transits(name, keep, way=lambda direction: direction, possible=lambda solved: ()):
    """Runs without a proof that list other transits than the motion has, and intervals that seem to excuse it."""

    def changed(solved):
        kept = [k for k in range(len(solved.directions)) for _ in range(keep(k))]
        table = solved.transits
        rows = replace(
            table, values=[table.values[k] for k in kept], errors=[table.errors[k] for k in kept]
        )
        directions = [way(solved.directions[k]) for k in kept]
        changes = {"table": rows, "directions": directions, "possible": possible(solved)}
        return replace(solved, **with_zeros(solved, "xdot", **changes))

    return [
        Fault(f"{scene} transits: {name}", changed, scene=scene)
        for scene in (TWO_RUNS, DAMPED, FEW_DIGITS)
    ]


def everywhere(solved):
    return ((Fraction(0), solved.scene.exact.t_end, "unknown"),)


def around_the_second(solved):
    at = solved.transits.exact("t")[1]
    return ((at - Fraction(1, 100), at + Fraction(1, 100), "odd"),)


OF_TRANSITS = [
    *transits("two lost", lambda k: k not in (1, 2)),
    *transits("the first lost", lambda k: k != 0),
    *transits("none", lambda k: False),
    *transits("each twice", lambda k: 2),
    *transits("turned", lambda k: 1, way=lambda direction: -direction),
    *transits("one lost in an interval", lambda k: k != 1, possible=around_the_second),
    *transits("all kept, and an interval about one", lambda k: 1, possible=around_the_second),
    *transits(
        "two lost, and an interval that holds all", lambda k: k not in (1, 2), possible=everywhere
    ),
]


def of_solution(name, change, scene=PLAIN):
    return Fault(
        f"{scene} solution: {name}", lambda solved: replace(solved, **change(solved)), scene=scene
    )


def turned(word):
    """The zeros of a word in the other direction."""
    return lambda solved: with_zeros(
        solved, word, directions=[-way for way in solved.zeros[word].directions]
    )


def undecided(*possible):
    """Intervals that may hold transits."""
    return lambda solved: with_zeros(solved, "xdot", possible=possible)


def shifted(solved):
    by = Fraction(1, 10**12)
    proved = solved.proof.enclosure.proved
    states = tuple(
        tuple(Interval(x.low + by, x.high + by) for x in state) for state in proved.states
    )
    enclosure = replace(solved.proof.enclosure, proved=replace(proved, states=states))
    return {"proof": replace(solved.proof, enclosure=enclosure)}


def measured(**changes):
    """A proof that says something else of how it was made."""

    def change(solved):
        return {
            "proof": replace(solved.proof, enclosure=replace(solved.proof.enclosure, **changes))
        }

    return change


def other_check(**changes):
    return lambda solved: {"checks": (replace(solved.checks[0], **changes), *solved.checks[1:])}


def without(word):
    return lambda solved: {
        "zeros": {other: zeros for other, zeros in solved.zeros.items() if other != word}
    }


def sections_exchanged(solved):
    exchanged = zip(solved.sections, reversed(solved.sections.values()), strict=True)
    return {"zeros": {**solved.zeros, **dict(exchanged)}}


OF_SOLUTION = [
    of_solution("directions", turned("xdot")),
    of_solution("directions of a section", turned("highest")),
    of_solution(
        "sections in the other order",
        lambda solved: {"zeros": dict(reversed(solved.zeros.items()))},
    ),
    of_solution("a section for another", sections_exchanged),
    of_solution("a section lost", without("gate 30")),
    of_solution("transits lost", without("xdot")),
    of_solution("a possible transit that is none", undecided((Fraction(1), Fraction(2), "even"))),
    of_solution(
        "the grid's times", lambda solved: {"times": (*solved.times[:-1], solved.times[-1] - TINY)}
    ),
    of_solution("states of another proof", shifted),
    of_solution("a proof that is none", lambda solved: {"proof": None}),
    of_solution("the radius of positions", measured(position_radius=Fraction(1, 10**60))),
    of_solution("the radius of velocities, larger", measured(velocity_radius=Fraction(1, 10))),
    of_solution("the steps of the proof", measured(steps=3)),
    of_solution("the gap of a cross-check", other_check(position_m=Fraction(1, 10**60))),
    of_solution("the steps of a cross-check", other_check(steps=3)),
    of_solution("a cross-check lost", lambda solved: {"checks": solved.checks[:1]}),
    of_solution(
        "a title", lambda solved: {"scene": solved.scene.with_values(["title=A long swing"])}
    ),
]


def coefficients(name, change):
    def changed(solved):
        function = solved.proof.enclosure.function
        return measured(function=replace(function, data=change(function.data)))(solved)

    return of_solution(f"coefficients, {name}", changed)


OF_SOLUTION += [
    coefficients("one by its last bit", lambda data: bytes([data[0] ^ 1]) + data[1:]),
    coefficients("in the other order", lambda data: data[::-1]),
    coefficients("a piece lost", lambda data: data[:-8]),
]


def possible(name, change):
    """A change of the first interval that nothing decides, of a transit and of a passage."""

    def of_word(word):
        return lambda solved: with_zeros(
            solved, word, possible=change(*solved.zeros[word].possible)
        )

    return [
        of_solution(f"possible transit {name}", of_word("xdot"), LAST),
        of_solution(f"passage {name}", of_word("gate 0@0"), GATE),
    ]


POSSIBLE = [
    *possible("lost", lambda found: ()),
    *possible("twice", lambda found: (found, found)),
    *possible("from later on", lambda found: (((found[0] + found[1]) / 2, *found[1:]),)),
    *possible(
        "up to an earlier time", lambda found: ((found[0], (found[0] + found[1]) / 2, found[2]),)
    ),
    *possible("with another parity", lambda found: ((*found[:2], "even"),)),
]


# ------------------------------------------------------------------------------- tables as they are laid out


def laid_out(which, name, change):
    """A change of the cells of a table: doubles, vectors and page are made from it."""
    return Fault(f"{which}: {name}", folder=lambda folder: forge(folder, **{which: change}))


def next_digit(text):
    """Return a number with another last digit."""
    return f"{text[:-1]}{(int(text[-1]) + 1) % 10}"


def cell(k, i, change):
    def changed(rows, header):
        rows[k][i] = change(rows[k][i])

    return changed


def exchanged(rows, header):
    row = rows[-1]
    row.insert(4, row.pop(5))


def all_cells(change):
    """Print all numbers of the table anew, but for the first columns."""

    def changed(rows, header):
        for row in rows[1:]:
            row[4:] = [change(text) for text in row[4:]]

    return changed


def places(text):
    return len(text.partition(".")[2])


def one_unit_more(text):
    return fixed_decimal(Fraction(text) + Fraction(1, 10 ** places(text)), places(text))


CELLS = {
    "a digit": cell(-1, 5, next_digit),
    "a digit of the first row": cell(0, 4, next_digit),
    "a digit more": cell(-1, 5, lambda text: text + "0"),
    "a sign lost": cell(-1, 4, lambda text: text.lstrip("-") if text.startswith("-") else f"-{text}"),
    "a row lost": lambda rows, header: rows.pop(2),
    "a row twice": lambda rows, header: rows.insert(2, rows[2]),
    "two rows swapped": lambda rows, header: rows.insert(1, rows.pop(2)),
    "two numbers swapped": exchanged,
    "a digit with a line under it": cell(-1, 5, lambda text: f"{text[:-1]}_{text[-1]}"),
    "one unit more in each": all_cells(one_unit_more),
    "of single precision": all_cells(lambda text: fixed_decimal(Fraction(f"{float(text):.7e}"), places(text))),
    "a digit fewer, and 0": all_cells(lambda text: f"{text[:-1]}0"),
    "with an exponent": all_cells(lambda text: f"{float(text):.13e}"),
}  # fmt: skip
TABLES = [
    laid_out(which, *case) for which in ("grid", "transits", "sections") for case in CELLS.items()
]
TABLES += [
    laid_out("transits", "a bound that is too small", cell(0, -1, lambda text: "1e-40")),
    laid_out("transits", "a bound that is too large", cell(0, -1, lambda text: "1e-3")),
    laid_out("transits", "a direction", cell(0, 2, lambda text: "-1" if text == "+1" else "+1")),
    laid_out("transits", "a number", cell(0, 0, lambda text: "7")),
    laid_out("sections", "a section's word", cell(0, 0, lambda text: "lowest")),
    laid_out("sections", "a direction", cell(0, 3, lambda text: "-1" if text == "+1" else "+1")),
]


# ------------------------------------------------------------------------------- other files as they are laid out


def of_file(file, name, change):
    """A change of a file's text or bytes, sealed."""

    def changed(folder):
        path = folder / file
        data = change(path.read_bytes() if file == FUNCTION[1] else path.read_text())
        seal(folder, json.loads((folder / MANIFEST).read_text()), {file: data})

    return Fault(f"{file}: {name}", folder=changed)


def doubles(file, name, change):
    """A change of the last row of a table of doubles, each a decimal with a hexfloat."""

    def changed(text):
        *lines, last = text.splitlines()
        row = dict(zip(lines[0].split(","), last.split(","), strict=True))
        change(row)
        return "".join(f"{line}\n" for line in [*lines, ",".join(row.values())])

    return of_file(file, name, changed)


def next_double(of, both_texts=True):
    """The double beside the right one; with its hexfloat or without."""

    def changed(row):
        other = math.nextafter(float(row[of]), math.inf)
        row[of] = f"{other:.16e}"
        if both_texts:
            row[f"{of}_hex"] = other.hex()

    return changed


DOUBLES = {
    "the double beside": next_double("x"),
    "a double without its hexfloat": next_double("y", both_texts=False),
    "a time": next_double("t"),
}
OTHER_FILES = [
    doubles(file, *case)
    for file in ("grid.binary64.csv", "transits.binary64.csv")
    for case in DOUBLES.items()
]
OTHER_FILES += [
    of_file(file, name, change)
    for file in ("grid.csv", "sections.csv", "vectors.json", "certified.txt")
    for name, change in {
        "CR LF": lambda text: text.replace("\n", "\r\n"),
        "no final line feed": lambda text: text[:-1],
        "a comment": lambda text: f"# by hand\n{text}",
        "two lines swapped": lambda text: "\n".join(
            [*text.split("\n")[:2][::-1], *text.split("\n")[2:]]
        ),
    }.items()
]

PAGE = (
    ("Level: enclosed.", "Level: confirmed."),
    ("A proof encloses", "Two runs agree to"),
    ("It is not audited.", "FLINT alone proves the same digits."),
    ("heyoka's run in another", "No run in another"),
    ("read as: decimal", "read as: binary64"),
    ("4.1", "4.2"),
    ("x east", "x west"),
    ("explicit", "left out"),
    (" m, on every", " km, on every"),
    (" s, direction", " min, direction"),
    (" m/s\n", " km/h\n"),
    ("angles in degrees", "angles in radians"),
    ("State at t = 0 s\n  x ", "State at t = 0 s\n  y "),
    ("by column: x ", "by column: x 1"),
    ("t > 0): ", "t > 0): 1"),
    ("(complete)", "(undecided intervals)"),
    ("direction +1", "direction -1"),
    ("of highest", "of lowest"),
    ("sections.csv: ", "sections.csv: 1"),
    ("read as binary64", "read as decimal"),
    ("Level", ""),
)


def words(old, new):
    def changed(text):
        assert old in text
        return text.replace(old, new)

    return changed


OTHER_FILES += [
    of_file("certified.txt", f"{new!r} for {old!r}", words(old, new)) for old, new in PAGE
]


def of_document(file, name, change):
    def changed(text):
        document = json.loads(text)
        change(document)
        return json.dumps(document, indent=1, ensure_ascii=False) + "\n"

    return of_file(file, name, changed)


def value_of(kind, k, column, name, change):
    def changed(document):
        value = document[kind][k]["values"][column]
        value[name] = change(value[name])

    return changed


VECTORS = {
    "a digit": value_of("states", -1, "x", "decimal", next_digit),
    "a digit of a transit": value_of("transits", 0, "t", "decimal", next_digit),
    "a hexfloat": value_of(
        "states", -1, "y", "hexfloat", lambda text: (float.fromhex(text) + 1).hex()
    ),
    "a bound": value_of("states", 1, "vz", "bound", lambda text: "1e-40"),
    "a bound of a transit": value_of("transits", -1, "t", "bound", lambda text: "1e-40"),
    "a row": lambda document: document["states"][-1].update(row=4),
    "a state lost": lambda document: document["states"].pop(2),
    "a transit twice": lambda document: document["transits"].insert(1, document["transits"][1]),
    "a direction": lambda document: document["transits"][0].update(direction=-7),
    "a flag": lambda document: document["states"][1]["flags"].append("release"),
    "a note": lambda document: document["notes"].pop("end"),
    "units": lambda document: document["columns"].update(x="km"),
    "scene": lambda document: document["scene"]["pendulum"].update(length="4.2"),
    "level": lambda document: document.update(level="confirmed"),
}
DESCRIPTION = {
    "a bound": lambda document: document["bounds"].update(x="1e-40"),
    "a time": lambda document: document["times"].__setitem__(1, (1.5).hex()),
    "degree": lambda document: document.update(degree=document["degree"] - 1),
    "components": lambda document: document.update(components=["y", "x"]),
    "units": lambda document: document["units"].update(t="h"),
    "frame": lambda document: document.update(frame="x west"),
}
OTHER_FILES += [of_document("vectors.json", *case) for case in VECTORS.items()]
OTHER_FILES += [of_document(FUNCTION[0], *case) for case in DESCRIPTION.items()]
OTHER_FILES += [of_file(FUNCTION[1], "a coefficient", lambda data: bytes([data[0] ^ 1]) + data[1:])]


# ------------------------------------------------------------------------------- the manifest as it is laid out


def manifest(place, value):
    """Another value of a field, given by its path: a function of the old one or the value itself. The page follows."""

    def changed(document):
        part = document
        *path, last = place.split("/")
        for name in path:
            part = part[int(name) if isinstance(part, list) else name]
        part[last] = value(part[last]) if callable(value) else value

    return Fault(f"manifest: {place}", folder=lambda folder: forge(folder, manifest=changed))


def another_formulation(text):
    return next(name for name in FORMULATIONS if name != text)


NOT_POSSIBLE = [{"from_s": "1", "to_s": "2", "parity": "even"}]
IN_MANIFEST = [
    manifest("id", "another"),
    manifest("title", "A long swing"),
    manifest("source", "Foucault 1851"),
    manifest("scene/pendulum/length", "4.2"),
    manifest("scene/pendulum/drag", "1e-25"),
    manifest("scene/site/latitude", lambda text: text + "0000000000001"),
    manifest("scene/site/gravity_is", "effective"),
    manifest("scene/release/vx", "0.16"),
    manifest("scene/run/t_end", "13"),
    manifest("scene/run/digits", "15"),
    manifest("scene/run/level", "confirmed"),
    manifest("scene/run/transits", "false"),
    manifest("scene/run/sections", "highest"),
    manifest("scene/run/length", "4.1"),
    manifest("inputs", "binary64"),
    manifest("frame", lambda text: text.replace("x east", "x west")),
    manifest("units/x, y, z", "km"),
    manifest("level", "confirmed"),
    manifest("digits", 15),
    manifest("decimals/grid/x", 12),
    manifest("decimals/transits/ax", 12),
    manifest("bounds/position_m", "1e-40"),
    manifest("bounds/velocity_m_s", "1e-3"),
    manifest("bounds/transit_s", "1e-40"),
    manifest("bounds/grid/x", "1e-40"),
    manifest("bounds/grid/vz", "1e-3"),
    manifest("bounds/transits/y", "1e-40"),
    manifest("counts/grid", 6),
    manifest("counts/transits", 2),
    manifest("counts/possible", 1),
    manifest("transits", "undecided intervals"),
    manifest("transits", "not asked for"),
    manifest("possible", NOT_POSSIBLE),
    manifest("invariant/h_m2_s2", "-4.0"),
    manifest("invariant/drift_m2_s2", "1e-40"),
    manifest("equations/formulation", another_formulation),
    manifest("run/formulation", another_formulation),
    manifest("equations/lines", ["x'' = 0"]),
    manifest("run/number", "binary64"),
    manifest("run/steps", 3),
    manifest("cross_checks/0/position_m", "1e-60"),
    manifest("cross_checks/0/steps", 3),
    manifest("enclosure/position_radius_m", "1e-60"),
    manifest("enclosure/velocity_radius_m_s", "1e-3"),
    manifest("enclosure/transit_radius_s", None),
    manifest("enclosure/prec", 3),
    manifest("enclosure/agreement_bits", 3000),
    manifest("generator/numpy", "0.1"),
    manifest("command", lambda text: text.replace("--t-end 12", "--t-end 13")),
    manifest("command", lambda text: text.replace("--no-audit", "--audit")),
    manifest("sections/decimals/x", 12),
    manifest("sections/bounds/x", "1e-40"),
    manifest("sections/counts/highest", 2),
    manifest("sections/possible/highest", NOT_POSSIBLE),
]

NUMERIC = [
    of_table(where, *case) for where in ("grid", "xdot", "gate 30") for case in NUMBERS.items()
]
NUMERIC += [
    of_table(where, *case, scene=TWO_RUNS)
    for where in ("grid", "xdot")
    for case in NUMBERS.items()
    if "less than it" not in case[0]  # which is within the bound of two runs
]
FAULTS = [
    *OF_SCENE,
    *NUMERIC,
    *OF_TRANSITS,
    *OF_SOLUTION,
    *POSSIBLE,
    *TABLES,
    *OTHER_FILES,
    *IN_MANIFEST,
]
# written as the solution has it, which is wrong there already: no other file knows them, and of a title nobody does
UNDECIDABLE = {
    "plain solution: a title": NOBODY,
    "plain solution: the steps of the proof": AGAIN,
    "plain solution: the gap of a cross-check": AGAIN,
    "plain solution: the steps of a cross-check": AGAIN,
}


def solved(scene):
    proof = (
        {"audit": False, "confirm": "whole", "function": True}
        if scene.run.level == "enclosed"
        else {}
    )
    return reference.solve(scene, **proof)


def ends_at_a_transit():
    """Return the plain scene up to a transit that its digits cannot tell from the end."""
    far = reference.solve(SCENES[PLAIN], digits=60, audit=False, confirm="none")
    late = -(-far.transits.exact("t")[-1] * 10**50 // 1)
    return SCENES[PLAIN].with_values([f"run.t_end={fixed_decimal(Fraction(late, 10**50), 50)}"])


@pytest.fixture(scope="module")
def honest(tmp_path_factory):
    """Return the solutions without a fault, and the folders that were written of them."""
    place = tmp_path_factory.mktemp("honest")
    made = {name: solved(scene) for name, scene in {**SCENES, LAST: ends_at_a_transit()}.items()}
    return {
        name: (solution, reference.write(solution, place / name)) for name, solution in made.items()
    }


def texts_of(folder: Path):
    return {
        name: data if name == FUNCTION[1] else data.decode()
        for name, data in contents(folder).items()
    }


def outcome(fault, solution, whole, place):
    """Return what becomes of files with a fault, and what was said."""
    try:
        if fault.folder is None:
            reference.write(fault.solution(solution), place / "out")
        else:
            changed = Path(shutil.copytree(whole, place / "changed"))
            fault.folder(changed)
            write_texts(texts_of(changed), place / "out", solution)
    except FoucaultError as error:
        return REFUSED, str(error)
    except ERRORS as error:
        return ERROR, repr(error)
    if contents(place / "out") == contents(whole):
        return SAME, ""
    found = verify(place / "out")
    if found.problems:
        return FOUND, found.problems[0]
    if fault in OF_TRANSITS and any(
        "transits" in line or "the motion" in line for line in found.undecided
    ):
        return SAID, found.undecided[0]
    problems, _ = recompute(place / "out")
    return (AGAIN, problems[0]) if problems else (NOBODY, str(found.undecided))


def test_the_right_files_pass(honest):
    for _, folder in honest.values():
        assert verify(folder).problems == []
    assert honest[LAST][0].possible
    assert honest[GATE][0].sections["gate 0@0"].possible


@pytest.mark.parametrize(
    "fault", one_in(8, [pytest.param(fault, id=fault.name) for fault in FAULTS])
)
def test_a_wrong_file_is_refused_or_found(fault, honest, tmp_path):
    became, said = outcome(fault, *honest[fault.scene], tmp_path)
    assert not (became in (REFUSED, ERROR) and (tmp_path / "out").exists())
    assert became == UNDECIDABLE.get(fault.name, became), said
    assert became not in (AGAIN, NOBODY) or fault.name in UNDECIDABLE, (became, said)


# ------------------------------------------------------------------------------- ranges


def of_ranges(name, change, scene=PLAIN):
    return Fault(f"ranges: {name}", lambda ranges: replace(ranges, **change(ranges)), scene=scene)


def intervals(which, name, change):
    """A change of the rows of intervals of the grid or the transits."""

    def changed(ranges):
        table = getattr(ranges, which)
        rows = [list(row) for row in table.rows]
        change(rows)
        table = replace(table, rows=tuple(map(tuple, rows)))
        return {"grid": table} if which == "grid" else with_zeros(ranges, "xdot", table=table)

    return of_ranges(f"{which}, {name}", changed)


def narrower(row):
    """The first interval without its lower half."""
    row[0] = Ends((row[0].low + row[0].high) / 2, row[0].high)


def other_inputs(change):
    return lambda ranges: {"scene": ranges.scene.with_values([change])}


BOX = {"pendulum.length": "±0.0001", "site.latitude": "±0.001"}
NOT_GRID = [change for change in INPUTS if not change.startswith("run.")]
RANGES = [
    *(of_ranges(f"scene, {change}", other_inputs(change)) for change in NOT_GRID),
    intervals("grid", "an interval that is too narrow", lambda rows: narrower(rows[-1])),
    intervals(
        "grid", "two columns swapped", lambda rows: [row.insert(0, row.pop(1)) for row in rows]
    ),
    intervals("grid", "a row lost", lambda rows: rows.pop(2)),
    intervals("grid", "a row twice", lambda rows: rows.insert(2, rows[2])),
    intervals("grid", "rows swapped", lambda rows: rows.reverse()),
    intervals("transits", "an interval that is too narrow", lambda rows: narrower(rows[0])),
    intervals("transits", "a row lost", lambda rows: rows.pop()),
    intervals("transits", "a row twice", lambda rows: rows.append(rows[-1])),
    of_ranges("directions", turned("xdot")),
    of_ranges(
        "a width halved",
        lambda ranges: {"uncertain": {**ranges.uncertain, "pendulum.length": "0.00005"}},
    ),
    of_ranges(
        "a width lost",
        lambda ranges: {"uncertain": {"pendulum.length": ranges.uncertain["pendulum.length"]}},
    ),
    of_ranges("times", lambda ranges: {"times": (*ranges.times[:-1], ranges.times[-1] - TINY)}),
    of_ranges("a section lost", without("gate 30")),
    of_ranges("transits lost", without("xdot")),
    of_ranges("a section's directions", turned("gate 30")),
    of_ranges(
        "a possible passage lost", lambda ranges: with_zeros(ranges, "gate 0@0", possible=()), GATE
    ),
    of_ranges("a possible transit that is none", undecided((Fraction(1), Fraction(2), "even"))),
    of_ranges(
        "a copy of the proof",
        lambda ranges: {"proof": replace(ranges.proof, proved=copy(ranges.proof.proved))},
    ),
    of_ranges(
        "radius of the proof",
        lambda ranges: {"proof": replace(ranges.proof, radius=Fraction(1, 10**30))},
    ),
    of_ranges("steps of the proof", lambda ranges: {"proof": replace(ranges.proof, steps=1)}),
    of_ranges("engine", lambda ranges: {"engine": "octet"}),
]


@pytest.fixture(scope="module")
def honest_ranges(tmp_path_factory):
    """Return ranges without a fault, and the folders that were written of them."""
    place = tmp_path_factory.mktemp("ranges")
    made = {
        name: reference.prove_ranges(SCENES[name], widths=BOX, engine="limbs")
        for name in (PLAIN, GATE)
    }
    return {
        name: (ranges, reference.write_ranges(ranges, place / name))
        for name, ranges in made.items()
    }


def outcome_of_ranges(fault, ranges, whole, out):
    """Return what becomes of ranges with a fault, and what was said."""
    try:
        reference.write_ranges(fault.solution(ranges), out)
    except FoucaultError as error:
        return REFUSED, str(error)
    except ERRORS as error:
        return ERROR, repr(error)
    if contents(out) == contents(whole):
        return SAME, ""
    try:
        problems = verify_ranges(out)
    except FoucaultError as error:
        return FOUND, str(error)
    return (FOUND, problems[0]) if problems else (NOBODY, "")


def test_the_right_ranges_pass(honest_ranges):
    for _, folder in honest_ranges.values():
        assert verify_ranges(folder, recompute=True) == []
    assert honest_ranges[GATE][0].sections["gate 0@0"].possible


@pytest.mark.parametrize(
    "fault", one_in(8, [pytest.param(fault, id=fault.name) for fault in RANGES])
)
def test_wrong_ranges_are_refused_or_found(fault, honest_ranges, tmp_path):
    became, said = outcome_of_ranges(fault, *honest_ranges[fault.scene], tmp_path / "out")
    assert not (became in (REFUSED, ERROR) and (tmp_path / "out").exists())
    assert became != NOBODY, said
