"""Write a dataset: its files are checked in a temporary folder and put in place together, or not at all; tell of it."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..errors import DatasetError, InputError, checked_path
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
    """Refuse a target that cannot be written, or that holds something other than what has the file `mark`.

    Raises:
        InputError: the target cannot be written, or something else is in its place.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError("--out", str(folder), "a folder", "A file of that name is in the way.")
    names = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    foreign = names - {mark, *ALWAYS, *OPTIONAL}
    if foreign or (names and mark not in names):
        expected = f"a new or empty folder, or {_OLDER[mark]} and nothing else"
        advice = f"Nothing was changed{f': {min(foreign)!r} is there' if foreign else ''}."
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
    except (
        OSError,
        RuntimeError,
    ) as error:  # the latter: links in a circle, on older versions of Python
        advice = f"{getattr(error, 'strerror', None) or error}."
        raise InputError(
            "--out", str(folder), "a writable place with room for a dataset", advice
        ) from None


def write(
    solution: Solution, folder: str | Path, name: str | None = None, *, tables: bool = True
) -> Path:
    """Write a solution as a golden dataset: beside `folder`, where it is checked, and then put in its place.

    Args:
        solution: what to write.
        folder: the dataset's folder; an older dataset there is replaced.
        name: the dataset's id, by default the scene's own with its changes (`place.dataset_id`).
        tables: whether to write more than the golden function and its manifest.

    Raises:
        InputError: the folder cannot be written, it ships and the proof is not audited, or nothing would be written.
        DatasetError: the new dataset does not pass its own checks; the old one, if any, is left as it is.
    """
    if not isinstance(solution, Solution):
        raise InputError(
            "solution",
            solution,
            "a Solution",
            "Solve the scene first. Ranges are written by write_ranges.",
        )
    folder = checked_path("folder", folder, "the folder to write to")
    if not tables and solution.function is None:
        raise InputError(
            "tables", "none", "a golden function, or tables", "Solve it with function=True."
        )
    if ships(folder) and solution.proof is not None and not solution.proof.audited:
        advice = "What ships in data/golden is proved by FLINT alone, too."
        raise InputError("audit", "no audit", "an audited proof", advice)
    write_texts(render(solution, name, tables=tables), folder, solution)
    return folder


def filled(work: Path, texts: Mapping[str, Content]) -> Path:
    """Return a new folder in `work` with these files, which are on the disk."""
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
    """Write the files of a dataset that was rendered, as `write` does; without its solution, they were checked."""
    check_target(folder)
    with writable_place(folder) as (work, target):
        new = filled(work, texts)
        if problems := problems_of(new):
            raise DatasetError(str(folder), problems)
        if solution is not None:
            contents = {path.name: path.read_bytes() for path in new.iterdir()}
            kept = {
                name: data if name == FUNCTION[1] else data.decode()
                for name, data in contents.items()
            }
            check_evidence(kept, solution)
            check_proved(kept, solution)
        replace(target, new, work)
        if ships(target):
            manifest = json.loads(texts[MANIFEST])
            keep_seal(target.name, manifest["seal"], str(options_in(manifest["command"])))


def summary(solution: Solution, folder: Path) -> dict[str, Any]:
    """Return what `generate --json` says of a dataset, also what was measured on the way and stands in no file."""
    bounds = column_bounds(solution.grid, grid_decimals(solution))
    bound = max((bounds[column] for column in POSITION), key=Fraction)
    measured = vars(solution.guard).items() if solution.guard else ()
    guard = {
        name: float(value) if isinstance(value, Fraction) else value for name, value in measured
    }
    return {
        "scene": solution.scene.id,
        "out": str(folder),
        "level": solution.level,
        "digits": solution.scene.run.digits,
        "engine": solution.run.engine,
        "confirmed": solution.proof.confirmed if solution.proof else None,
        "transits": len(solution.directions),
        "possible": len(solution.possible),
        # the least double, where it is less
        "bound_m": float(bound) or math.ulp(0.0) * (bound != "0"),
        "cpu_s": solution.cpu_s,
        "run_cpu_s": solution.run.cpu_s,
        "check_cpu_s": solution.check_s,
        "pilot_cpu_s": solution.pilot_s,
        "discarded_cpu_s": solution.discarded_s,
        "compile_s": solution.run.compile_s,
        "number": solution.run.number,
        "steps": solution.run.steps,
        "guard": guard or None,
        "not_checked": solution.not_checked or None,
    }
