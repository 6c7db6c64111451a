"""Write a dataset: its files are checked in a temporary folder, then put in place together or not at all."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..errors import NOTHING, DatasetError, InputError, checked_path
from ..numbers.columns import POSITION
from ..scenes.shipped import keep_seal
from ..solver.solution import Solution, grid_decimals
from ..system.workspace import OLD, workspace
from .evidence import check_evidence
from .making import options_in
from .manifest import ALWAYS, FUNCTION, MANIFEST, OPTIONAL, Content
from .place import RANGES, ships
from .render import check_proved, render
from .sheets import column_bounds
from .verify import problems_of

_OLDER = {MANIFEST: "an older dataset", RANGES: "older ranges"}


def check_target(folder: Path, mark: str = MANIFEST) -> None:
    """Refuse a target that cannot be written, or holds anything but a result with the file `mark`.

    Raises:
        InputError: the target cannot be written, or something else is in its place.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(
            "--out", str(folder), "a folder", "There is a file of that name: choose another name."
        )
    names = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    foreign = names - {mark, *ALWAYS, *OPTIONAL}
    if foreign or (names and mark not in names):
        expected = f"a new or empty folder, or one with {_OLDER[mark]} and nothing else"
        advice = "Nothing was changed."
        if foreign:
            advice = f"The folder contains {min(foreign)!r}. Nothing was changed."
        raise InputError("--out", str(folder), expected, advice)
    with writable_place(folder):
        pass


@contextmanager
def writable_place(folder: Path) -> Iterator[tuple[Path, Path]]:
    """Provide a new folder beside the target, and the target; a symbolic link is followed.

    Raises:
        InputError: the disk is full or cannot be written, there or in what is done meanwhile.
    """
    try:
        target = folder.resolve()
        target.parent.mkdir(parents=True, exist_ok=True)
        with workspace(target.parent, target.name) as work:
            yield work, target
    # RuntimeError: links in a circle, on older versions of Python
    except (OSError, RuntimeError) as error:
        expected = "a folder that can be written to, with room for a dataset"
        advice = f"{getattr(error, 'strerror', None) or error}."
        raise InputError("--out", str(folder), expected, advice) from None


def write(
    solution: Solution, folder: str | Path, name: str | None = None, *, tables: bool = True
) -> Path:
    """Write a solution as a golden dataset, checked beside `folder` and then put in its place.

    Args:
        solution: what to write.
        folder: the dataset's folder; an older dataset there is replaced.
        name: the dataset's id, by default the scene's own with its changes (`place.dataset_id`).
        tables: whether to write more than the golden function and its manifest.

    Raises:
        InputError: the folder cannot be written, it ships and the proof is not audited, or nothing
            would be written.
        DatasetError: the new dataset does not pass its own checks; the old one, if any, is left as
            it is.
    """
    if not isinstance(solution, Solution):
        advice = "Solve the scene first. Ranges are written by write_ranges."
        raise InputError("solution", solution, "a Solution", advice)
    folder = checked_path("folder", folder, "the folder to write to")
    if not tables and solution.function is None:
        expected = "a golden function, or tables"
        raise InputError("tables", NOTHING, expected, "Solve the scene with function=True.")
    if ships(folder) and solution.proof is not None and not solution.proof.audited:
        advice = "Proofs in data/golden must not rely on compiled code: solve with audit=True."
        raise InputError("audit", NOTHING, "an audited proof", advice)
    write_texts(render(solution, name, tables=tables), folder, solution)
    return folder


def filled(work: Path, texts: Mapping[str, Content]) -> Path:
    """Return a new folder in `work` with these files, flushed to disk."""
    new = work / "new"
    new.mkdir()
    for file, text in texts.items():
        with (new / file).open("wb") as handle:
            handle.write(text if isinstance(text, bytes) else text.encode())
            handle.flush()
            os.fsync(handle.fileno())
    return new


def replace(target: Path, new: Path, work: Path) -> None:
    """Put a new folder in the place of a target."""
    if target.exists():
        target.rename(work / OLD)  # after an end between the two renames, `workspace` puts it back
    new.rename(target)


def write_texts(
    texts: Mapping[str, Content], folder: Path, solution: Solution | None = None
) -> None:
    """Write the rendered files of a dataset, after comparing them with the solution if it is given."""
    check_target(folder)
    with writable_place(folder) as (work, target):
        new = filled(work, texts)
        problems = problems_of(new)
        if problems:
            raise DatasetError(str(folder), problems)
        if solution is not None:
            written = {path.name: _content(path) for path in new.iterdir()}
            check_evidence(written, solution)
            check_proved(written, solution)
        replace(target, new, work)
        if ships(target):
            manifest = json.loads(texts[MANIFEST])
            keep_seal(target.name, manifest["seal"], str(options_in(manifest["command"])))


def _content(path: Path) -> Content:
    """Return the content of a file of a dataset: text, or the bytes of the golden function."""
    data = path.read_bytes()
    return data if path.name == FUNCTION[1] else data.decode()


def summary(solution: Solution, folder: Path) -> dict[str, Any]:
    """Return what `generate --json` prints about a dataset, including measurements that no file contains."""
    bounds = column_bounds(solution.grid, grid_decimals(solution))
    bound = max((bounds[column] for column in POSITION), key=Fraction)
    return {
        "scene": solution.scene.id,
        "out": str(folder),
        "level": solution.level,
        "digits": solution.scene.run.digits,
        "engine": solution.run.engine,
        "confirmed": solution.proof.confirmed if solution.proof else None,
        "transits": len(solution.directions),
        "possible": len(solution.possible),
        "bound_m": _as_double(bound),
        "cpu_s": solution.cpu_s,
        "run_cpu_s": solution.run.cpu_s,
        "check_cpu_s": solution.check_s,
        "pilot_cpu_s": solution.pilot_s,
        "discarded_cpu_s": solution.discarded_s,
        "compile_s": solution.run.compile_s,
        "number": solution.run.number,
        "steps": solution.run.steps,
        "guard": _guard(solution) or None,
        "not_checked": solution.not_checked or None,
    }


def _as_double(bound: str) -> float:
    """Return a bound as a double; the smallest one if it is less, but not 0."""
    double = float(bound)
    if double == 0 and bound != "0":
        return math.ulp(0.0)
    return double


def _guard(solution: Solution) -> dict[str, Any]:
    """Return what the pilot measured of the growth of errors, nothing without a pilot."""
    measured = vars(solution.guard) if solution.guard else {}
    return {
        name: float(value) if isinstance(value, Fraction) else value
        for name, value in measured.items()
    }
