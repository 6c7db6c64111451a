"""A dataset of ranges: proven intervals for uncertain inputs, in tables whose ends are rounded outward."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import replace as with_fields
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..engines.plan import Report
from ..errors import DatasetError, FoucaultError, InputError, checked_path
from ..numbers.columns import SECTION, STATE, TRANSITS
from ..numbers.precision import fixed_decimal, magnitude, outward, rounded_up
from ..numbers.zeros import XDOT, Zeros
from ..scenes.scene import parse_scene
from ..solver.ranges import Intervals, Ranges
from ..solver.solution import exact_decimals
from ..solver.swing import Ends
from ..solver.uncertain import prove_ranges
from ..system.documents import json_document
from .files import LINE_ENDS
from .manifest import differences, text_of
from .place import RANGES, dataset_id, golden_folder, id_with
from .sheets import open_intervals, scene_inputs
from .write import check_target, filled, replace, writable_place

FORMAT = 1
GRID_FILE, TRANSITS_FILE, SECTIONS_FILE = "grid.csv", "transits.csv", "sections.csv"
DIGITS = 2  # that a width has in the tables: the ends widen it by a tenth at most
WIDER = ("possible", "sections")  # intervals that may be wider than those that are proved


def ranges_id(ranges: Ranges) -> str:
    """Return the id: that of the scene's dataset, with the half-widths, such as paris+-pendulum.length=0.001."""
    box = ",".join(f"{key}={width}" for key, width in ranges.uncertain.items())
    return id_with(dataset_id(ranges.scene), "+-", box)


def write_ranges(ranges: Ranges, folder: str | Path) -> Path:
    """Write ranges: `ranges.json`, which says the scene, the box and the proof, and the tables; whole or not at all.

    Args:
        ranges: what `prove_ranges` returned.
        folder: older ranges there are replaced.

    Raises:
        InputError: the folder cannot be written, or holds something else.
        DatasetError: a table does not hold what was proved; nothing is written then.
    """
    if not isinstance(ranges, Ranges):
        raise InputError(
            "ranges", ranges, "what prove_ranges returns", "A Solution is written by write."
        )
    folder = checked_path("folder", folder, "the folder to write to")
    check_target(folder, RANGES)
    texts = _texts(ranges)
    if problems := _misprints(texts, ranges):
        raise DatasetError(str(folder), problems)
    with writable_place(folder) as (work, target):
        replace(target, filled(work, texts), work)
    return folder


def load_ranges(name: str | Path) -> Ranges:
    """Read ranges by id or path, after checking their seal and hashes: the intervals as printed, `proof` None.

    Raises:
        InputError: there are none.
        DatasetError: a file is missing, changed or malformed.
    """
    return _read(golden_folder(name))[0]


def verify_ranges(folder: Path, report: Report | None = None, recompute: bool = False) -> list[str]:
    """Prove ranges again, and have trusted code hold their files against that.

    Args:
        folder: where they stand.
        report: called with the simulated time reached, in s.
        recompute: also compare every byte.

    Returns:
        A sentence for each problem; none if every printed interval holds what is proved.

    Raises:
        InputError: there are none at `folder`, or the engine that they were made with is not installed.
        UnreachableError: the proof fails here.
    """
    try:
        printed, texts = _read(folder)
    except DatasetError as error:
        return error.problems
    again = prove_ranges(
        printed.scene,
        printed.uncertain,
        engine=printed.engine,
        derivatives=printed.derivatives,
        report=report,
    )
    problems = [*_misprints(texts, again), *_other_facts(texts, again)]
    if recompute and not problems:
        files = _texts(again)
        problems = [
            f"{name}: recomputing gives another text"
            for name in files
            if files[name] != texts[name]
        ]
    return problems


def _read(folder: Path) -> tuple[Ranges, dict[str, str]]:
    """Return ranges and the texts of their files."""
    try:
        manifest = json_document(folder / RANGES, "PATH")
    except FileNotFoundError:
        advice = "`foucault generate SCENE --uncertain …` makes them."
        raise InputError("PATH", str(folder), f"ranges (a folder with {RANGES})", advice) from None
    try:
        names = (GRID_FILE, TRANSITS_FILE, *([SECTIONS_FILE] if "sections" in manifest else []))
        texts = {name: _text(folder / name) for name in (RANGES, *names)}
        if text_of({**manifest, "seal": _seal(manifest)}) != texts[RANGES]:
            hint = _hint(texts[RANGES], _hash(text_of({**manifest, "seal": _seal(manifest)})))
            raise DatasetError(
                str(folder), [f"{RANGES} does not fit its seal: a byte was changed{hint}"]
            )
        for name, digest in manifest["sha256"].items():
            if _hash(texts[name]) != digest:
                hint = _hint(texts[name], digest)
                raise DatasetError(
                    str(folder), [f"{name}: a byte was changed (sha256 differs){hint}"]
                )
        scene_id = manifest["id"].partition("+")[0].removesuffix(f".{manifest['inputs']}")
        scene = parse_scene({"id": scene_id, "inputs": manifest["inputs"], **manifest["scene"]})
        tables = {
            name: [line.split(",") for line in texts[name].splitlines()[1:]] for name in names
        }
        passages = {
            word: _zeros(
                [row[1:] for row in tables[SECTIONS_FILE] if row[0] == word], SECTION, possible
            )
            for word, possible in manifest.get("sections", {}).items()
        }
        transits = _zeros(tables[TRANSITS_FILE], TRANSITS, manifest["possible"])
        zeros = {XDOT: transits, **passages}
        ranges = Ranges(
            scene,
            {name: width.removeprefix("±") for name, width in manifest["uncertain"].items()},
            tuple(Fraction(row[0]) for row in tables[GRID_FILE]),
            Intervals(STATE, tuple(_intervals(row[1:]) for row in tables[GRID_FILE])),
            zeros,
            manifest["proof"]["engine"],
            derivatives=manifest["proof"].get("derivatives") is True,
        )
    except (OSError, LookupError, ValueError, TypeError, AttributeError, FoucaultError) as error:
        if isinstance(error, DatasetError):
            raise
        raise DatasetError(
            str(folder), [f"cannot be read: {type(error).__name__} {error}"]
        ) from None
    return ranges, texts


def _text(path: Path) -> str:
    """Return the text of a file.

    Raises:
        DatasetError: it is missing, cannot be read, or is not UTF-8.
    """
    try:
        return path.read_bytes().decode()
    except OSError as error:
        raise DatasetError(str(path.parent), [f"{path.name}: {error.strerror}"]) from None
    except UnicodeDecodeError as error:
        raise DatasetError(str(path.parent), [f"{path.name} is not UTF-8: {error}"]) from None


def _hint(text: str, digest: str) -> str:
    """Return what to say of a text that does not fit its hash: that a copy changed its line ends, or nothing."""
    lines = text.replace("\r\n", "\n")
    return f": {LINE_ENDS}" if lines != text and _hash(lines) == digest else ""


def _zeros(
    rows: list[list[str]], columns: tuple[str, ...], possible: list[dict[str, str]]
) -> Zeros[Intervals]:
    return Zeros(
        Intervals(columns, tuple(_intervals(row[2:]) for row in rows)),
        [int(row[1]) for row in rows],
        tuple((Fraction(z["from_s"]), Fraction(z["to_s"]), z["parity"]) for z in possible),
    )


def _intervals(cells: Sequence[str]) -> tuple[Ends, ...]:
    ends = [Fraction(text) for text in cells]
    return tuple(Ends(*pair) for pair in zip(ends[::2], ends[1::2], strict=True))


def _misprints(texts: dict[str, str], ranges: Ranges) -> list[str]:
    """Return in a sentence what does not hold what was proved, found by trusted code."""
    from ..enclosure.trusted.printed_box import check_ranges

    try:
        check_ranges(texts, ranges.proof.proved)
    except (ArithmeticError, LookupError, ValueError) as error:
        return [f"what is printed does not hold what is proved: {error}"]
    return []


def _other_facts(texts: dict[str, str], again: Ranges) -> Iterator[str]:
    """Yield where `ranges.json` says something of the box or of its proof that proving it again does not give."""
    said = json.loads(texts[RANGES])
    tables = {name: text for name, text in texts.items() if name != RANGES}
    expected = _manifest(again, tables) | {"seal": said["seal"]}
    for document in (said, expected):
        for name in WIDER:
            document.pop(name, None)
        document["period_s"] = document["period_s"] and "an interval"
    for place, old, new in differences(said, expected):
        yield f"{RANGES}: {place} = {old}, proved again {new}"


def period_texts(ranges: Ranges) -> list[str] | None:
    """Return the ends of the period's interval as text, or None: what follows from transits.csv."""
    period = with_fields(ranges, proof=None).period
    return period and list(ends(*period))


def ends(low: Fraction, high: Fraction, places: int | None = None) -> tuple[str, str]:
    """Return the ends of an interval as text, rounded outward to `places`, or to the digits that its width supports."""
    if places is None:
        places = places_of(low, high)
    return outward(low, -1, places), outward(high, 1, places)


def places_of(low: Fraction, high: Fraction) -> int:
    """Return the digits after the point that an interval's ends have."""
    return max(0, DIGITS - 1 - magnitude(high - low)) if high > low else 0


def _cells(rows: Sequence[Sequence[Any]]) -> list[list[str]]:
    """Return the ends of all intervals as text, row by row."""
    return [[text for x in row for text in ends(x.low, x.high)] for row in rows]


def _grid_rows(ranges: Ranges) -> list[list[str]]:
    decimals = exact_decimals(ranges.times)
    first, *later = ranges.grid.rows
    # the release may be known exactly, up to the rounding of the proof: it has the digits of the next row
    pairs = zip(first, later[0], strict=True)
    release = [
        text for x, after in pairs for text in ends(x.low, x.high, places_of(after.low, after.high))
    ]
    rows = zip(ranges.times, [release, *_cells(later)], strict=True)
    return [[fixed_decimal(t, decimals), *row] for t, row in rows]


def _zero_rows(table: Intervals, directions: Sequence[int]) -> list[list[str]]:
    rows = zip(directions, _cells(table.rows), strict=True)
    return [[str(k), str(direction), *row] for k, (direction, row) in enumerate(rows, 1)]


def _table(first: Sequence[str], columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table as text: its first columns, and two for each column of intervals."""
    header = [*first, *(f"{name}_{word}" for name in columns for word in ("low", "high"))]
    return "".join(",".join(line) + "\n" for line in (header, *rows))


def _texts(ranges: Ranges) -> dict[str, str]:
    """Return the files of ranges, sealed."""
    tables = {GRID_FILE: _table(["t"], STATE, _grid_rows(ranges))}
    tables[TRANSITS_FILE] = _table(
        ["k", "direction"], TRANSITS, _zero_rows(ranges.transits, ranges.directions)
    )
    if sections := ranges.sections.items():
        rows = [
            [word, *row]
            for word, zeros in sections
            for row in _zero_rows(zeros.table, zeros.directions)
        ]
        tables[SECTIONS_FILE] = _table(["section", "k", "direction"], SECTION, rows)
    manifest = _manifest(ranges, tables)
    return {RANGES: text_of(manifest | {"seal": _seal(manifest)}), **tables}


def _seal(manifest: dict[str, Any]) -> str:
    """Return the sha256 of the text with an empty seal: it finds accidents."""
    return _hash(text_of({**manifest, "seal": ""}))


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _manifest(ranges: Ranges, tables: dict[str, str]) -> dict[str, Any]:
    proof, scene = ranges.proof, ranges.scene
    inputs = scene_inputs(scene)
    # as widths support
    inputs["run"] = {name: text for name, text in inputs["run"].items() if name != "digits"}
    run: dict[str, Any] = {"engine": ranges.engine, "bits": proof.bits, "steps": proof.steps}
    run |= {"derivatives": True} if ranges.derivatives else {}
    sections = {word: open_intervals(zeros.possible) for word, zeros in ranges.sections.items()}
    return {
        "format": FORMAT,
        "seal": "",
        "id": ranges_id(ranges),
        "level": scene.run.level,
        "inputs": scene.inputs,
        "scene": inputs,
        "uncertain": {name: f"±{width}" for name, width in ranges.uncertain.items()},
        "period_s": period_texts(ranges),
        "possible": open_intervals(ranges.possible),
        **({"sections": sections} if sections else {}),
        "counts": {
            "grid": len(ranges.times),
            "transits": len(ranges.transits),
            "possible": len(ranges.possible),
        },
        "proof": run | {"radius_m": rounded_up(proof.radius)},
        "sha256": {name: _hash(text) for name, text in tables.items()},
    }
