"""A dataset of ranges: proven intervals for uncertain inputs, their ends rounded outward."""

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
from ..numbers.precision import endpoint_text, fixed_decimal, magnitude, rounded_up
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

_FORMAT = 1
_GRID = "grid.csv"
_TRANSITS = "transits.csv"
_SECTIONS = "sections.csv"
_DIGITS = 2  # that a width has in the tables: the ends widen it by a tenth at most
_WIDER = ("possible", "sections")  # intervals that may be wider than those that are proved


def ranges_id(ranges: Ranges) -> str:
    """Return the id of ranges: that of the scene's dataset, with the half-widths of the inputs.

    Example: paris+-pendulum.length=0.001.
    """
    box = ",".join(f"{key}={width}" for key, width in ranges.uncertain.items())
    return id_with(dataset_id(ranges.scene), "+-", box)


def write_ranges(ranges: Ranges, folder: str | Path) -> Path:
    """Write ranges, completely or not at all: `ranges.json` (scene, box and proof) and the tables.

    Args:
        ranges: what `prove_ranges` returned.
        folder: older ranges there are replaced.

    Raises:
        InputError: the folder cannot be written, or holds something else.
        DatasetError: a table does not hold what was proved; nothing is written then.
    """
    if not isinstance(ranges, Ranges):
        raise InputError(
            "ranges", ranges, "what prove_ranges returns", "To write a Solution, use write."
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
    """Read ranges by id or path, check seal and hashes, and return the intervals as printed.

    Raises:
        InputError: there are none.
        DatasetError: a file is missing, changed or malformed.
    """
    ranges, _ = _read(golden_folder(name))
    return ranges


def verify_ranges(folder: Path, report: Report | None = None, recompute: bool = False) -> list[str]:
    """Prove ranges again, and let trusted code compare their files with the new proof.

    Args:
        folder: their folder.
        report: called with the simulated time reached, in s.
        recompute: also compare every byte.

    Returns:
        A sentence for each problem; none if every printed interval holds what is proved.

    Raises:
        InputError: there are none at `folder`, or the engine that they were made with is not
            installed.
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
    """Return ranges and the texts of their files, by name."""
    try:
        manifest = json_document(folder / RANGES, "PATH")
    except FileNotFoundError:
        advice = "Make them by `foucault generate SCENE --uncertain …`."
        raise InputError("PATH", str(folder), f"ranges (a folder with {RANGES})", advice) from None
    try:
        texts = _checked_texts(folder, manifest)
        return _parsed(manifest, texts), texts
    except DatasetError:
        raise
    except (OSError, LookupError, ValueError, TypeError, AttributeError, FoucaultError) as error:
        problem = f"cannot be read: {type(error).__name__} {error}"
        raise DatasetError(str(folder), [problem]) from None


def _checked_texts(folder: Path, manifest: dict[str, Any]) -> dict[str, str]:
    """Return the texts of the files, by name.

    Raises:
        DatasetError: one cannot be read, or does not fit the seal or its hash.
    """
    names = [RANGES, _GRID, _TRANSITS]
    if "sections" in manifest:
        names.append(_SECTIONS)
    texts = {name: _text(folder / name) for name in names}

    sealed = text_of({**manifest, "seal": _seal(manifest)})
    if sealed != texts[RANGES]:
        hint = _hint(texts[RANGES], _hash(sealed))
        problem = f"{RANGES} does not fit its seal: a byte was changed{hint}"
        raise DatasetError(str(folder), [problem])
    for name, digest in manifest["sha256"].items():
        if _hash(texts[name]) != digest:
            hint = _hint(texts[name], digest)
            problem = f"{name}: a byte was changed (sha256 differs){hint}"
            raise DatasetError(str(folder), [problem])
    return texts


def _parsed(manifest: dict[str, Any], texts: dict[str, str]) -> Ranges:
    """Return ranges as their files print them."""
    inputs = manifest["inputs"]
    scene_id = manifest["id"].partition("+")[0].removesuffix(f".{inputs}")
    scene = parse_scene({"id": scene_id, "inputs": inputs, **manifest["scene"]})
    grid = _rows(texts[_GRID])
    zeros = {XDOT: _zeros(_rows(texts[_TRANSITS]), TRANSITS, manifest["possible"])}
    for word, possible in manifest.get("sections", {}).items():
        rows = [row[1:] for row in _rows(texts[_SECTIONS]) if row[0] == word]
        zeros[word] = _zeros(rows, SECTION, possible)
    return Ranges(
        scene,
        {name: width.removeprefix("±") for name, width in manifest["uncertain"].items()},
        tuple(Fraction(row[0]) for row in grid),
        Intervals(STATE, tuple(_intervals(row[1:]) for row in grid)),
        zeros,
        manifest["proof"]["engine"],
        derivatives=manifest["proof"].get("derivatives") is True,
    )


def _rows(text: str) -> list[list[str]]:
    """Return the cells of a table, row by row."""
    return [line.split(",") for line in text.splitlines()[1:]]


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
    """Return why a text does not fit its hash, if a copy changed its line ends; else nothing."""
    lines = text.replace("\r\n", "\n")
    return f": {LINE_ENDS}" if lines != text and _hash(lines) == digest else ""


def _zeros(
    rows: list[list[str]], columns: tuple[str, ...], possible: list[dict[str, str]]
) -> Zeros[Intervals]:
    """Return zeros from their rows (number, direction, ends) and intervals that may hold more."""
    return Zeros(
        Intervals(columns, tuple(_intervals(row[2:]) for row in rows)),
        [int(row[1]) for row in rows],
        tuple(
            (Fraction(part["from_s"]), Fraction(part["to_s"]), part["parity"]) for part in possible
        ),
    )


def _intervals(cells: Sequence[str]) -> tuple[Ends, ...]:
    """Return intervals from cells that alternate between their lower and upper ends."""
    numbers = [Fraction(text) for text in cells]
    return tuple(Ends(*pair) for pair in zip(numbers[::2], numbers[1::2], strict=True))


def _misprints(texts: dict[str, str], ranges: Ranges) -> list[str]:
    """Return a sentence if a table does not contain what was proved; trusted code decides that."""
    from ..enclosure.trusted.printed_box import check_ranges

    try:
        check_ranges(texts, ranges.proof.proved)
    except (ArithmeticError, LookupError, ValueError) as error:
        return [f"the printed intervals do not contain the proven ones: {error}"]
    return []


def _other_facts(texts: dict[str, str], again: Ranges) -> Iterator[str]:
    """Yield each field of `ranges.json` on box or proof that proving it again does not give."""
    printed = json.loads(texts[RANGES])
    tables = {name: text for name, text in texts.items() if name != RANGES}
    expected = _manifest(again, tables) | {"seal": printed["seal"]}
    for document in (printed, expected):
        for name in _WIDER:
            document.pop(name, None)
        document["period_s"] = document["period_s"] and "an interval"
    for place, old, new in differences(printed, expected):
        yield f"{RANGES}: {place} = {old}, proved again {new}"


def period_texts(ranges: Ranges) -> list[str] | None:
    """Return the ends of the period's interval as text, from transits.csv; None if it has no end."""
    period = with_fields(ranges, proof=None).period
    return period and list(ends(*period))


def ends(low: Fraction, high: Fraction, places: int | None = None) -> tuple[str, str]:
    """Return the ends of an interval as text, rounded outward.

    They have `places` digits after the point, or as many as the width supports.
    """
    if places is None:
        places = _places_of(low, high)
    return endpoint_text(low, -1, places), endpoint_text(high, 1, places)


def _places_of(low: Fraction, high: Fraction) -> int:
    """Return the digits after the point that an interval's ends have."""
    if high <= low:
        return 0
    return max(0, _DIGITS - 1 - magnitude(high - low))


def _cells(row: Sequence[Any]) -> list[str]:
    """Return the ends of the intervals of a row as text."""
    cells: list[str] = []
    for interval in row:
        cells += ends(interval.low, interval.high)
    return cells


def _grid_rows(ranges: Ranges) -> list[list[str]]:
    """Return the rows of grid.csv: the time, exactly, and the ends of the state's intervals."""
    decimals = exact_decimals(ranges.times)
    release, *later = ranges.grid.rows
    # the release may be known exactly, up to the rounding of the proof: it has the digits of the
    # next row
    release_cells: list[str] = []
    for interval, after in zip(release, later[0], strict=True):
        release_cells += ends(interval.low, interval.high, _places_of(after.low, after.high))

    states = [release_cells, *map(_cells, later)]
    return [
        [fixed_decimal(t, decimals), *cells] for t, cells in zip(ranges.times, states, strict=True)
    ]


def _zero_rows(table: Intervals, directions: Sequence[int]) -> list[list[str]]:
    """Return the rows of zeros: number, direction, and the ends of the intervals."""
    rows = zip(directions, table.rows, strict=True)
    return [[str(k), str(direction), *_cells(row)] for k, (direction, row) in enumerate(rows, 1)]


def _table(first: Sequence[str], columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table as text: its first columns, and two for each column of intervals."""
    header = [*first]
    for name in columns:
        header += [f"{name}_low", f"{name}_high"]
    return "".join(",".join(line) + "\n" for line in (header, *rows))


def _texts(ranges: Ranges) -> dict[str, str]:
    """Return the files of ranges, sealed."""
    transits = _zero_rows(ranges.transits, ranges.directions)
    tables = {
        _GRID: _table(["t"], STATE, _grid_rows(ranges)),
        _TRANSITS: _table(["k", "direction"], TRANSITS, transits),
    }
    if ranges.sections:
        passages = []
        for word, zeros in ranges.sections.items():
            rows = _zero_rows(zeros.table, zeros.directions)
            passages += [[word, *row] for row in rows]
        tables[_SECTIONS] = _table(["section", "k", "direction"], SECTION, passages)
    manifest = _manifest(ranges, tables)
    return {RANGES: text_of(manifest | {"seal": _seal(manifest)}), **tables}


def _seal(manifest: dict[str, Any]) -> str:
    """Return the sha256 of the text with an empty seal: it finds accidents."""
    return _hash(text_of({**manifest, "seal": ""}))


def _hash(text: str) -> str:
    """Return the sha256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


def _manifest(ranges: Ranges, tables: dict[str, str]) -> dict[str, Any]:
    """Return `ranges.json` with an empty seal."""
    scene = ranges.scene
    manifest: dict[str, Any] = {
        "format": _FORMAT,
        "seal": "",
        "id": ranges_id(ranges),
        "level": scene.run.level,
        "inputs": scene.inputs,
        "scene": _inputs(ranges),
        "uncertain": {name: f"±{width}" for name, width in ranges.uncertain.items()},
        "period_s": period_texts(ranges),
        "possible": open_intervals(ranges.possible),
    }
    if ranges.sections:
        manifest["sections"] = {
            word: open_intervals(zeros.possible) for word, zeros in ranges.sections.items()
        }
    manifest["counts"] = {
        "grid": len(ranges.times),
        "transits": len(ranges.transits),
        "possible": len(ranges.possible),
    }
    manifest["proof"] = _proof(ranges)
    manifest["sha256"] = {name: _hash(text) for name, text in tables.items()}
    return manifest


def _inputs(ranges: Ranges) -> dict[str, dict[str, str]]:
    """Return the inputs of the scene without `digits`, which the widths decide."""
    inputs = scene_inputs(ranges.scene)
    inputs["run"] = {name: text for name, text in inputs["run"].items() if name != "digits"}
    return inputs


def _proof(ranges: Ranges) -> dict[str, Any]:
    """Return what `ranges.json` says of the proof."""
    proof = ranges.proof
    record: dict[str, Any] = {"engine": ranges.engine, "bits": proof.bits, "steps": proof.steps}
    if ranges.derivatives:
        record["derivatives"] = True
    record["radius_m"] = rounded_up(proof.radius)
    return record
