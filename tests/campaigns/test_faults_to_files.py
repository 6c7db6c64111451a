"""Faults between a solution and the files of its dataset: each wrong file is refused by `write`, or found by `verify`.

Nothing is switched off here. A fault lies in one place of the code that makes the files, and so also where `write`
checks with the same code; `verify` runs without it, as it does in a later process.
"""

from __future__ import annotations

import json
import math
from copy import copy
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import pytest
from pydantic import TypeAdapter
from sampled import one_in
from small_scenes import make_scene

pytest.importorskip("flint")

import reference
from reference.dataset import ranges as ranges_files
from reference.dataset import record, sheets
from reference.dataset import render as rendering
from reference.dataset import write as writer
from reference.dataset.checks import scene_check
from reference.dataset.manifest import Manifest
from reference.dataset.ranges import verify_ranges
from reference.dataset.verify import recompute, verify
from reference.enclosure import Interval
from reference.errors import FoucaultError
from reference.model.formulations import FORMULATIONS
from reference.numbers.precision import outward
from reference.numbers.table import Table
from reference.scenes.scene import Scene
from reference.solver.ranges import Ends

SITE = {"rotation_rate": "0.0123", "equatorial_radius": "6371.1", "altitude": "12.5"}
RUN = {"t_end": "12", "grid_step": "3", "digits": 14, "level": "enclosed", "sections": "highest; gate 30"}
BASE = {"pendulum": {"length": "4.1"}, "site": SITE, "run": RUN}
POSITION = {"x": "0.3", "y": "0.41", "vx": "0.15", "vy": "0.02"}
TURNING = {"angle": "35.5", "azimuth": "12.7", "angle_rate": "3.3", "azimuth_rate": "20.1"}
PLAIN, ANGLES, GATE, LAST = "plain", "angles", "at rest in a gate", "ends at a transit"
SCENES = {
    PLAIN: make_scene(title="A short swing", release=POSITION, **BASE),
    ANGLES: make_scene(release=TURNING, **BASE),
    # no digit tells whether it passes the gate as it begins to fall
    GATE: make_scene(release={"x": "0.3", "y": "0"}, **{**BASE, "run": {**RUN, "sections": "highest; gate 0@0"}}),
}

ERRORS = (ArithmeticError, AssertionError, AttributeError, LookupError, TypeError, ValueError)
TINY = Fraction(1, 10**25)


@dataclass(frozen=True)
class Fault:
    """A fault by its name: it patches what makes the files, and changes the solution that they are made from."""

    name: str
    patch: Any = None
    solution: Any = None
    scene: str = PLAIN


# inputs, as a wrong reader would take them


def inputs(name, change, scene=PLAIN):
    def patch(mp):
        honest = Scene.exact.fget
        mp.setattr(Scene, "exact", property(lambda self: change(honest(self))))

    return Fault(f"inputs: {name}", patch, scene=scene)


def plus(name, by=TINY):
    return inputs(f"{name} off by {float(by):.0e}", lambda exact: replace(exact, **{name: getattr(exact, name) + by}))


def release(name, change, kind="position", scene=PLAIN):
    def changed(exact):
        start = list(getattr(exact, kind))
        change(start)
        return replace(exact, **{kind: tuple(start)})

    return inputs(name, changed, scene)


def moved(i, by):
    return lambda start: start.__setitem__(i, start[i] + by)


INPUTS = [
    *(plus(name) for name in ("length", "drag", "altitude", "gravity", "rotation_rate", "equatorial_radius")),
    plus("latitude", Fraction(1, 10**22)),
    plus("flattening", Fraction(1, 10**22)),
    plus("t_end", Fraction(1, 10**6)),
    plus("grid_step", Fraction(1, 10**6)),
    inputs("gravity_is", lambda exact: replace(exact, gravity_is="effective")),
    inputs("doubles for decimals", lambda exact: replace(exact, length=Fraction(float(exact.length)))),
    release("x off by 1e-25", moved(0, TINY)),
    release("velocities swapped", lambda start: start.reverse()),
    release("azimuth + 360", moved(1, 360), "angles", ANGLES),
    release("angle off by 1e-22", moved(0, Fraction(1, 10**22)), "angles", ANGLES),
]


# numbers of a solution, between the proof and the tables


def of_table(where, name, change):
    """A change of a table's rows of integers; `where` is the grid, the transits, or a section."""

    def changed(table):
        rows = [list(row) for row in table.values]
        errors = [list(row) for row in table.errors]
        change(rows, errors, 1 << table.bits)
        return replace(table, values=[*map(tuple, rows)], errors=[*map(tuple, errors)])

    def solution(solved):
        if where in ("grid", "zeros"):
            return replace(solved, **{where: changed(getattr(solved, where))})
        passages = solved.sections[where]
        return replace(solved, sections={**solved.sections, where: passages._replace(table=changed(passages.table))})

    return Fault(f"{where}: {name}", solution=solution)


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
    "a number off by a unit of its last digit": set_cell(-1, 1, lambda row, unit: row[1] + unit // 10**13),
    "a number off by less than it": set_cell(-1, 1, lambda row, unit: row[1] + unit // 10**16),
    "a sign": set_cell(-1, 1, lambda row, unit: -row[1]),
    "ten times a number": set_cell(-1, 2, lambda row, unit: 10 * row[2]),
    "two columns in the other order": lambda rows, errors, unit: [row.insert(1, row.pop(2)) for row in rows],
    "the last row lost": both(list.pop),
    "a row lost": both(lambda rows: rows.pop(1)),
    "a row twice": both(lambda rows: rows.insert(1, rows[1])),
    "the rows in the other order": both(list.reverse),
}
SOLUTIONS = [of_table(where, *case) for where in ("grid", "zeros", "gate 30") for case in NUMBERS.items()]


def words_of(name, change):
    return Fault(f"solution: {name}", solution=lambda solved: replace(solved, **change(solved)))


def other_way(passages):
    return passages._replace(directions=[-way for way in passages.directions])


def shifted(solved):
    by = Fraction(1, 10**12)
    proved = solved.proof.enclosure.proved
    states = tuple(tuple(Interval(x.low + by, x.high + by) for x in state) for state in proved.states)
    enclosure = replace(solved.proof.enclosure, proved=replace(proved, states=states))
    return {"proof": replace(solved.proof, enclosure=enclosure)}


def measured(**changes):
    """A proof that says something else of how it was made."""

    def change(solved):
        enclosure = replace(solved.proof.enclosure, **changes)
        return {"proof": replace(solved.proof, enclosure=enclosure)}

    return change


def other_check(**changes):
    return lambda solved: {"checks": (replace(solved.checks[0], **changes), *solved.checks[1:])}


SOLUTIONS += [
    words_of("directions", lambda solved: {"directions": [-way for way in solved.directions]}),
    words_of("directions of a section", lambda solved: {
        "sections": {**solved.sections, "highest": other_way(solved.sections["highest"])}
    }),
    words_of("sections in the other order", lambda solved: {"sections": dict(reversed(solved.sections.items()))}),
    words_of("a section for another", lambda solved: {
        "sections": dict(zip(solved.sections, reversed(solved.sections.values()), strict=True))
    }),
    words_of("a section lost", lambda solved: {"sections": {"highest": solved.sections["highest"]}}),
    words_of("a possible transit that is none", lambda solved: {"possible": ((Fraction(1), Fraction(2), "even"),)}),
    words_of("the grid's times", lambda solved: {"times": (*solved.times[:-1], solved.times[-1] - TINY)}),
    words_of("states of another proof", shifted),
    words_of("a proof that is none", lambda solved: {"proof": None}),
    words_of("the radius of positions", measured(position_radius=Fraction(1, 10**60))),
    words_of("the radius of velocities, larger", measured(velocity_radius=Fraction(1, 10))),
    words_of("the steps of the proof", measured(steps=3)),
    words_of("the gap of a cross-check", other_check(position_m=Fraction(1, 10**60))),
    words_of("the steps of a cross-check", other_check(steps=3)),
    words_of("a cross-check lost", lambda solved: {"checks": solved.checks[:1]}),
]  # fmt: skip


def possible(name, change):
    """A change of the first interval that nothing decides, of a transit and of a passage."""

    def of_transit(solved):
        return replace(solved, possible=change(*solved.possible))

    def of_passage(solved):
        word, passages = list(solved.sections.items())[-1]
        changed = passages._replace(possible=change(*passages.possible))
        return replace(solved, sections={**solved.sections, word: changed})

    faults = {"transit": (LAST, of_transit), "passage": (GATE, of_passage)}
    return [Fault(f"possible {zero}: {name}", None, made, scene) for zero, (scene, made) in faults.items()]


# printing


def printing(name, rounded):
    def patch(mp):
        def printed(self, decimals):
            columns = [decimals[name] for name in self.columns]
            return [
                tuple(rounded(Fraction(n, 1 << self.bits), places) for n, places in zip(row, columns, strict=True))
                for row in self.values
            ]

        mp.setattr(Table, "printed", printed)

    return Fault(f"printing: {name}", patch)


def text_of(whole, places):
    return sheets.fixed_decimal(Fraction(whole, 10**places), places)


PRINTING = [
    printing("rounded down", lambda x, places: text_of(math.floor(x * 10**places), places)),
    printing("rounded up", lambda x, places: text_of(math.ceil(x * 10**places), places)),
    printing("truncated", lambda x, places: text_of(math.trunc(x * 10**places), places)),
    printing("of doubles", lambda x, places: text_of(round(Fraction(float(x)) * 10**places), places)),
    printing("a digit fewer, and 0", lambda x, places: text_of(round(x * 10 ** (places - 1)) * 10, places)),
    printing("with an exponent", lambda x, places: f"{float(x):.{places}e}"),
]


# the cells of tables


def sheet(which, name, change):
    """A change of a table's cells, where it is laid out; `which` says which of all."""

    def patch(mp):
        maker = "binary64_sheet" if which.endswith("doubles") else f"{which}_sheet"
        honest = getattr(rendering, maker)

        def changed(*words):
            made = honest(*words)
            of_transits = "k" in made.header
            if which.endswith("doubles") and of_transits != (which == "transits doubles"):
                return made
            rows, header = [list(row) for row in made.rows], list(made.header)
            change(rows, header)
            return replace(made, rows=[*map(tuple, rows)], header=tuple(header))

        mp.setattr(rendering, maker, changed)

    return Fault(f"{which}: {name}", patch)


def next_digit(text):
    """A number with another last digit."""
    return f"{text[:-1]}{(int(text[-1]) + 1) % 10}"


def cell(k, i, change):
    def changed(rows, header):
        rows[k][i] = change(rows[k][i])

    return changed


def swapped_columns(rows, header):
    for row in (*rows, header):
        row.insert(3, row.pop(4))


CELLS = {
    "a digit": cell(-1, 5, next_digit),
    "a digit of the first row": cell(0, 4, next_digit),
    "a digit more": cell(-1, 5, lambda text: text + "0"),
    "a sign lost": cell(-1, 4, lambda text: text.lstrip("-") if text.startswith("-") else f"-{text}"),
    "a row lost": lambda rows, header: rows.pop(2),
    "a row twice": lambda rows, header: rows.insert(2, rows[2]),
    "two rows swapped": lambda rows, header: rows.insert(1, rows.pop(2)),
    "two numbers swapped": lambda rows, header: rows[-1].insert(4, rows[-1].pop(5)),
    "two names swapped": lambda rows, header: header.insert(4, header.pop(5)),
    "two columns swapped": swapped_columns,
    "a digit with a line under it": cell(-1, 5, lambda text: f"{text[:-1]}_{text[-1]}"),
}
TABLES = [sheet(which, *case) for which in ("grid", "transits", "sections") for case in CELLS.items()]


def next_double(of, both_texts=True):
    """The double beside the right one; with its hexfloat or without."""

    def changed(rows, header):
        i, j = header.index(of), header.index(f"{of}_hex")
        other = math.nextafter(float(rows[-1][i]), math.inf)
        rows[-1][i] = f"{other:.16e}"
        if both_texts:
            rows[-1][j] = other.hex()

    return changed


def in_single_precision(rows, header):
    i = header.index("z")
    near = float(f"{float(rows[-1][i]):.7e}")
    rows[-1][i], rows[-1][header.index("z_hex")] = f"{near:.16e}", near.hex()


DOUBLES = {
    "the double beside": next_double("x"),
    "a double without its hexfloat": next_double("y", both_texts=False),
    "single precision": in_single_precision,
    "a time": next_double("t"),
    **{name: CELLS[name] for name in ("a row lost", "two numbers swapped", "two names swapped")},
}
TABLES += [sheet(which, *case) for which in ("grid doubles", "transits doubles") for case in DOUBLES.items()]
TABLES += [
    sheet("transits", "a bound that is too small", cell(0, -1, lambda text: "1e-40")),
    sheet("transits", "a bound that is too large", cell(0, -1, lambda text: "1e-3")),
    sheet("transits", "a direction", cell(0, 2, lambda text: "-1" if text == "+1" else "+1")),
    sheet("transits", "a number", cell(0, 0, lambda text: "7")),
    sheet("sections", "a section's word", cell(0, 0, lambda text: "lowest")),
    sheet("sections", "a direction", cell(0, 3, lambda text: "-1" if text == "+1" else "+1")),
]


def ends_of_lines(name, change):
    def patch(mp):
        honest = sheets.Sheet.csv
        mp.setattr(sheets.Sheet, "csv", lambda self: change(honest(self)))

    return Fault(f"tables: {name}", patch)


TABLES += [
    ends_of_lines("CRLF", lambda text: text.replace("\n", "\r\n")),
    ends_of_lines("no final line feed", lambda text: text[:-1]),
    ends_of_lines("a comment", lambda text: f"# by hand\n{text}"),
]


# the manifest


def manifest(place, value):
    """Another value of a field, given by its path; a function of the old one or the value itself."""

    def patch(mp):
        honest = rendering.manifest_of

        def changed(*words, **named):
            made = honest(*words, **named)
            document = part = made.model_dump()
            *path, last = place.split("/")
            for name in path:
                part = part[int(name) if isinstance(part, list) else name]
            last = int(last) if isinstance(part, list) else last
            part[last] = value(part[last]) if callable(value) else value
            field = place.partition("/")[0]
            kind = TypeAdapter(Manifest.model_fields[field].annotation)
            return made.model_copy(update={field: kind.validate_python(document[field])})

        mp.setattr(rendering, "manifest_of", changed)

    return Fault(f"manifest: {place}", patch)


MANIFEST = [
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
    manifest("possible", [{"from_s": "1", "to_s": "2", "parity": "even"}]),
    manifest("invariant/h_m2_s2", lambda text: f"{text[:2]}.{text[2:].replace('.', '')}"),
    manifest("invariant/drift_m2_s2", "1e-40"),
    manifest("equations/formulation", lambda text: next(name for name in FORMULATIONS if name != text)),
    manifest("run/formulation", lambda text: next(name for name in FORMULATIONS if name != text)),
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
    manifest("sections/possible/highest", [{"from_s": "1", "to_s": "2", "parity": "even"}]),
]  # fmt: skip


def shared(name, function, change):
    """A fault in what both the writing and the check of a manifest call."""

    def patch(mp):
        honest = getattr(record, function)

        def changed(*words):
            return change(honest(*words))

        mp.setattr(record, function, changed)
        mp.setattr(scene_check, function, changed)

    return Fault(f"manifest, made and checked alike: {name}", patch)


MANIFEST += [
    shared("units", "following", lambda fields: fields | {"units": {**fields["units"], "x, y, z": "km"}}),
    shared("frame", "following", lambda fields: fields | {"frame": fields["frame"].replace("x east", "x north")}),
    shared("an input", "following", lambda fields: fields | {
        "scene": {**fields["scene"], "pendulum": {**fields["scene"]["pendulum"], "length": "4.2"}}
    }),
    shared("an input in two parts", "following", lambda fields: fields | {
        "scene": fields["scene"] | {"run": {**fields["scene"]["run"], "altitude": fields["scene"]["site"]["altitude"]}}
    }),
    shared("invariant", "following", lambda fields: fields | {
        "invariant": fields["invariant"].model_copy(update={"h_m2_s2": "-4.0"})
    }),
    shared("bounds", "bounds_of", lambda bounds: bounds.model_copy(update={"position_m": "1e-40"})),
    shared("completeness", "completeness", lambda word: "not asked for"),
    shared("command", "command", lambda text: text.replace("--digits 14", "--digits 15")),
]  # fmt: skip


# page and vectors, which `write` makes again by the same code


def page(name, old, new):
    def patch(mp):
        honest = rendering.certified_page

        def changed(*words):
            text = honest(*words)
            assert old in text
            return text.replace(old, new)

        mp.setattr(rendering, "certified_page", changed)

    return Fault(f"page: {name}", patch)


PAGE = [
    page("level", "Level: enclosed.", "Level: confirmed."),
    page("the sentence on the level", "A proof encloses", "Two runs agree to"),
    page("the sentence on the audit", "It is not audited.", "FLINT alone proves the same digits."),
    page("the sentence on the confirmation", "heyoka's run in another", "No run in another"),
    page("reading", "read as: decimal", "read as: binary64"),
    page("an input", "4.1", "4.2"),
    page("the model", "x east", "x west"),
    page("gravity", "explicit", "left out"),
    page("a unit of positions", " m, on every", " km, on every"),
    page("a unit of times", " s, direction", " min, direction"),
    page("a unit of velocities", " m/s\n", " km/h\n"),
    page("the unit of angles", "angles in degrees", "angles in radians"),
    page("the first state", "State at t = 0 s\n  x ", "State at t = 0 s\n  y "),
    page("a bound", "by column: x ", "by column: x 1"),
    page("the count of transits", "t > 0): ", "t > 0): 1"),
    page("completeness", "(complete)", "(undecided intervals)"),
    page("a direction", "direction +1", "direction -1"),
    page("the count of passages", "of highest", "of lowest"),
    page("the count of passages, a digit", "sections.csv: ", "sections.csv: 1"),
    page("how to score", "read as binary64", "read as decimal"),
    page("nothing", "Level", ""),
]


def vectors(name, change):
    def patch(mp):
        honest = rendering.vectors

        def changed(*words):
            made = honest(*words)
            document = made.model_dump()
            change(document)
            return type(made).model_validate(document)

        mp.setattr(rendering, "vectors", changed)

    return Fault(f"vectors: {name}", patch)


def value_of(kind, k, column, **changes):
    return lambda document: document[kind][k]["values"][column].update(
        {name: change(document[kind][k]["values"][column][name]) for name, change in changes.items()}
    )


VECTORS = [
    vectors("a digit", value_of("states", -1, "x", decimal=next_digit)),
    vectors("a digit of a transit", value_of("transits", 0, "t", decimal=next_digit)),
    vectors("a hexfloat", value_of("states", -1, "y", hexfloat=lambda text: float.fromhex(text).__add__(1).hex())),
    vectors("a bound", value_of("states", 1, "vz", bound=lambda text: "1e-40")),
    vectors("a bound of a transit", value_of("transits", -1, "t", bound=lambda text: "1e-40")),
    vectors("a row", lambda document: document["states"][-1].update(row=4)),
    vectors("a state lost", lambda document: document["states"].pop(2)),
    vectors("a transit twice", lambda document: document["transits"].insert(1, document["transits"][1])),
    vectors("a direction", lambda document: document["transits"][0].update(direction=-7)),
    vectors("a flag", lambda document: document["states"][1]["flags"].append("release")),
    vectors("a note", lambda document: document["notes"].pop("end")),
    vectors("units", lambda document: document["columns"].update(x="km")),
    vectors("scene", lambda document: document["scene"]["pendulum"].update(length="4.2")),
    vectors("level", lambda document: document.update(level="confirmed")),
]


# the golden function


def function(name, change):
    def patch(mp):
        honest = rendering.FunctionRecord.text
        mp.setattr(rendering.FunctionRecord, "text", lambda self: reworded(honest(self), change))

    return Fault(f"function: {name}", patch)


def reworded(text, change):
    document = json.loads(text)
    change(document)
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def data(name, change):
    def solution(solved):
        enclosure = solved.proof.enclosure
        made = replace(enclosure.function, data=change(enclosure.function.data))
        return replace(solved, proof=replace(solved.proof, enclosure=replace(enclosure, function=made)))

    return Fault(f"function: {name}", solution=solution)


FUNCTION = [
    function("a bound", lambda document: document["bounds"].update(x="1e-40")),
    function("a time", lambda document: document["times"].__setitem__(1, (1.5).hex())),
    function("degree", lambda document: document.update(degree=document["degree"] - 1)),
    function("components", lambda document: document.update(components=["y", "x"])),
    function("units", lambda document: document["units"].update(t="h")),
    function("frame", lambda document: document.update(frame="x west")),
    data("a coefficient, by its last bit", lambda text: bytes([text[0] ^ 1]) + text[1:]),
    data("bytes in the other order", lambda text: text[::-1]),
    data("a piece lost", lambda text: text[:-8]),
]


# after the check


def late(name, file, change):
    def patch(mp):
        honest = writer.replace

        def changed(target, new, work):
            path = new / file
            path.write_bytes(change(path.read_bytes()))
            honest(target, new, work)

        mp.setattr(writer, "replace", changed)

    return Fault(f"after the check: {name}", patch)


LATE = [
    late("a digit of the grid", "grid.csv", lambda text: text[:-2] + bytes([text[-2] ^ 1]) + text[-1:]),
    late("an input", "manifest.json", lambda text: text.replace(b'"4.1"', b'"4.2"')),
    late("the page", "certified.txt", lambda text: text.replace(b"Level", b"level")),
    late("a coefficient", "function.f64", lambda text: bytes([text[0] ^ 1]) + text[1:]),
    late("CRLF", "transits.csv", lambda text: text.replace(b"\n", b"\r\n")),
    late("a table cut short", "sections.csv", lambda text: text[: len(text) // 2]),
]

POSSIBLE = [
    *possible("lost", lambda found: ()),
    *possible("twice", lambda found: (found, found)),
    *possible("from later on", lambda found: (((found[0] + found[1]) / 2, *found[1:]),)),
    *possible("up to an earlier time", lambda found: ((found[0], (found[0] + found[1]) / 2, found[2]),)),
    *possible("with another parity", lambda found: ((*found[:2], "even"),)),
]

TITLE = Fault("title, in the scene itself", lambda mp: None, lambda solved: replace(
    solved, scene=solved.scene.with_values(["title=A long swing"])
))  # fmt: skip

FAULTS = [*INPUTS, *SOLUTIONS, *PRINTING, *TABLES, *MANIFEST, *PAGE, *VECTORS, *FUNCTION, *LATE, *POSSIBLE, TITLE]
REFUSED, ERROR, SAME = "refused by write", "ended in an error", "the right files"
FOUND, AGAIN, NOBODY = "found by verify", "found by --recompute alone", "found by nobody"
# written as the solution has it, which is wrong there already: no other file knows them, and of a title nobody does
UNDECIDABLE = {TITLE.name: NOBODY} | dict.fromkeys(
    (f"solution: the {what}" for what in ("steps of the proof", "gap of a cross-check", "steps of a cross-check")),
    AGAIN,
)


def solved(scene):
    return reference.solve(scene, audit=False, confirm="whole", function=True)


def ends_at_a_transit():
    """The plain scene up to a transit that its digits cannot tell from the end."""
    far = reference.solve(SCENES[PLAIN], digits=60, audit=False, confirm="none")
    late = -(-far.transits.exact("t")[-1] * 10**50 // 1)
    return SCENES[PLAIN].with_values([f"run.t_end={text_of(late, 50)}"])


@pytest.fixture(scope="module")
def honest():
    """The solutions without a fault, and their files."""
    return made_without_a_fault()


def made_without_a_fault():
    scenes = {PLAIN: SCENES[PLAIN], GATE: SCENES[GATE], LAST: ends_at_a_transit()}
    made = {name: solved(scene) for name, scene in scenes.items()}
    return {name: (solution, rendering.render(solution)) for name, solution in made.items()}


def in_bytes(contents):
    return {name: text.encode() if isinstance(text, str) else text for name, text in contents.items()}


def outcome(fault, honest, folder):
    """Return what becomes of files with a fault, and what was said."""
    with pytest.MonkeyPatch.context() as mp:
        if fault.patch:
            fault.patch(mp)
        try:
            solution = solved(SCENES[fault.scene]) if fault in INPUTS else honest[fault.scene][0]
            reference.write(fault.solution(solution) if fault.solution else solution, folder)
        except FoucaultError as error:
            return REFUSED, str(error)
        except ERRORS as error:
            return ERROR, repr(error)
    written = {path.name: path.read_bytes() for path in folder.iterdir()}
    if fault.scene in honest and written == in_bytes(honest[fault.scene][1]):
        return SAME, ""
    if problems := verify(folder).problems:
        return FOUND, problems[0]
    if problems := recompute(folder)[0]:
        return AGAIN, problems[0]
    return NOBODY, ""


def test_the_right_files_pass(honest, tmp_path):
    for k, (solution, _) in enumerate(honest.values()):
        assert verify(reference.write(solution, tmp_path / str(k))).problems == []
    assert honest[LAST][0].possible
    assert honest[GATE][0].sections["gate 0@0"].possible


@pytest.mark.parametrize("fault", one_in(8, [pytest.param(fault, id=fault.name) for fault in FAULTS]))
def test_a_wrong_file_is_refused_or_found(fault, honest, tmp_path):
    became, said = outcome(fault, honest, tmp_path / "out")
    assert not (became in (REFUSED, ERROR) and (tmp_path / "out").exists())
    assert became == UNDECIDABLE.get(fault.name, became), said
    assert became not in (AGAIN, NOBODY) or fault.name in UNDECIDABLE, (became, said)


# ranges


def of_ranges(name, change, scene=PLAIN):
    return Fault(f"ranges: {name}", None, lambda ranges: replace(ranges, **change(ranges)), scene)


def intervals(which, name, change):
    """A change of the rows of intervals of the grid or the transits."""

    def changed(ranges):
        rows = [list(row) for row in getattr(ranges, which).rows]
        change(rows)
        return {which: replace(getattr(ranges, which), rows=tuple(map(tuple, rows)))}

    return of_ranges(f"{which}: {name}", changed)


def nearest(value, places):
    return sheets.fixed_decimal(value, places)


def narrower(row):
    """The first interval without its lower half."""
    row[0] = Ends((row[0].low + row[0].high) / 2, row[0].high)


def written_by(name, function, change):
    """A fault in a function that makes the texts of ranges."""

    def patch(mp):
        honest = getattr(ranges_files, function)
        mp.setattr(ranges_files, function, lambda *words: change(honest(*words), *words))

    return Fault(f"ranges: {name}", patch)


def late_in_ranges(name, file, change):
    def patch(mp):
        honest = ranges_files.replace

        def changed(target, new, work):
            path = new / file
            path.write_bytes(change(path.read_bytes()))
            honest(target, new, work)

        mp.setattr(ranges_files, "replace", changed)

    return Fault(f"ranges, after the check: {name}", patch)


def text_with(name, **changes):
    """A fault in the text of ranges.json, before it is sealed."""

    def patch(mp):
        honest = ranges_files.text_of

        def changed(document):
            document = {**document, **changes}
            if name == "radius":
                document["proof"] = {**document["proof"], "radius_m": "1e-30"}
            return honest(document)

        mp.setattr(ranges_files, "text_of", changed)

    return Fault(f"ranges: {name}", patch)


def of_last_section(change):
    def changed(ranges):
        word, passages = list(ranges.sections.items())[-1]
        return {"sections": {**ranges.sections, word: passages._replace(**change(passages))}}

    return changed


def without(inputs, part, name):
    return {**inputs, part: {key: text for key, text in inputs[part].items() if key != name}}


BOX = {"pendulum.length": "±0.0001", "site.latitude": "±0.001"}
RANGES = [
    replace(fault, name=f"ranges, {fault.name}")
    for fault in INPUTS
    if fault.scene == PLAIN and "grid_step" not in fault.name
][:8]
RANGES += [
    intervals("grid", "an interval that is too narrow", lambda rows: narrower(rows[-1])),
    intervals("grid", "two columns swapped", lambda rows: [row.insert(0, row.pop(1)) for row in rows]),
    intervals("grid", "a row lost", lambda rows: rows.pop(2)),
    intervals("grid", "a row twice", lambda rows: rows.insert(2, rows[2])),
    intervals("grid", "rows swapped", lambda rows: rows.reverse()),
    intervals("transits", "an interval that is too narrow", lambda rows: narrower(rows[0])),
    intervals("transits", "a row lost", lambda rows: rows.pop()),
    intervals("transits", "a row twice", lambda rows: rows.append(rows[-1])),
    of_ranges("directions", lambda ranges: {"directions": [-way for way in ranges.directions]}),
    of_ranges("a width halved", lambda ranges: {"uncertain": {**ranges.uncertain, "pendulum.length": "0.00005"}}),
    of_ranges("a width lost", lambda ranges: {"uncertain": {"pendulum.length": ranges.uncertain["pendulum.length"]}}),
    of_ranges("times", lambda ranges: {"times": (*ranges.times[:-1], ranges.times[-1] - TINY)}),
    of_ranges("a section lost", lambda ranges: {"sections": {"highest": ranges.sections["highest"]}}),
    of_ranges("a section's directions", of_last_section(lambda part: other_way(part)._asdict())),
    of_ranges("a possible passage lost", of_last_section(lambda part: {"possible": ()}), GATE),
    of_ranges("a possible transit that is none", lambda ranges: {"possible": ((Fraction(1), Fraction(2), "even"),)}),
    of_ranges("a copy of the proof", lambda ranges: {"proof": replace(ranges.proof, proved=copy(ranges.proof.proved))}),
    of_ranges("radius of the proof", lambda ranges: {"proof": replace(ranges.proof, radius=Fraction(1, 10**30))}),
    of_ranges("steps of the proof", lambda ranges: {"proof": replace(ranges.proof, steps=1)}),
    of_ranges("engine", lambda ranges: {"engine": "octet"}),
    written_by("ends rounded to nearest", "outward", lambda _, value, side, places: nearest(value, places)),
    written_by("ends rounded inward", "outward", lambda _, value, side, places: outward(value, -side, places)),
    written_by("ends swapped", "ends", lambda pair, *words: pair[::-1]),
    written_by("a digit fewer", "places_of", lambda places, *words: max(places - 1, 0)),
    written_by("a period that is too narrow", "period_texts", lambda pair, *words: [pair[1], pair[1]]),
    written_by("a period lost", "period_texts", lambda pair, *words: None),
    written_by("id", "ranges_id", lambda name, *words: "another"),
    written_by("an input", "scene_inputs", lambda inputs, *words: inputs | {"pendulum": {"length": "4.2"}}),
    written_by("drag lost", "scene_inputs", lambda inputs, *words: without(inputs, "pendulum", "drag")),
    written_by("an input in two parts", "scene_inputs", lambda inputs, *words: inputs | {
        "run": inputs["run"] | {"length": inputs["pendulum"]["length"]}
    }),
    text_with("level", level="confirmed"),
    text_with("format", format=2),
    text_with("radius"),
    late_in_ranges("a digit", "grid.csv", lambda text: text[:-2] + bytes([text[-2] ^ 1]) + text[-1:]),
    late_in_ranges("CRLF", "transits.csv", lambda text: text.replace(b"\n", b"\r\n")),
    late_in_ranges("a width", "ranges.json", lambda text: text.replace(b"0.0001", b"0.0002")),
]  # fmt: skip
TRUE_BUT_WIDER = {"ranges: a digit fewer": AGAIN}


def ranges_of(scene):
    return reference.prove_ranges(SCENES[scene], widths=BOX, engine="limbs")


@pytest.fixture(scope="module")
def honest_ranges(tmp_path_factory):
    return right_ranges(tmp_path_factory.mktemp("ranges"))


def right_ranges(place):
    """Ranges without a fault, and their files."""
    made = {}
    for name in (PLAIN, GATE):
        ranges = ranges_of(name)
        folder = reference.write_ranges(ranges, place / name)
        made[name] = ranges, {path.name: path.read_bytes() for path in folder.iterdir()}
    return made


def outcome_of_ranges(fault, honest, folder):
    """Return what becomes of ranges with a fault, and what was said."""
    with pytest.MonkeyPatch.context() as mp:
        if fault.patch:
            fault.patch(mp)
        try:
            ranges = ranges_of(fault.scene) if "inputs" in fault.name else honest[fault.scene][0]
            reference.write_ranges(fault.solution(ranges) if fault.solution else ranges, folder)
        except FoucaultError as error:
            return REFUSED, str(error)
        except ERRORS as error:
            return ERROR, repr(error)
    if {path.name: path.read_bytes() for path in folder.iterdir()} == honest[fault.scene][1]:
        return SAME, ""
    try:
        if problems := verify_ranges(folder):
            return FOUND, problems[0]
    except FoucaultError as error:
        return FOUND, str(error)
    if problems := verify_ranges(folder, recompute=True):
        return AGAIN, problems[0]
    return NOBODY, ""


def test_the_right_ranges_pass(honest_ranges, tmp_path):
    for k, (ranges, _) in enumerate(honest_ranges.values()):
        assert verify_ranges(reference.write_ranges(ranges, tmp_path / str(k)), recompute=True) == []
    assert honest_ranges[GATE][0].sections["gate 0@0"].possible


@pytest.mark.parametrize("fault", one_in(8, [pytest.param(fault, id=fault.name) for fault in RANGES]))
def test_wrong_ranges_are_refused_or_found(fault, honest_ranges, tmp_path):
    became, said = outcome_of_ranges(fault, honest_ranges, tmp_path / "out")
    assert not (became in (REFUSED, ERROR) and (tmp_path / "out").exists())
    assert became == TRUE_BUT_WIDER.get(fault.name, became), said
    assert became not in (AGAIN, NOBODY) or fault.name in TRUE_BUT_WIDER, (became, said)
