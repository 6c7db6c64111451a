"""Write a dataset: its files are checked in a temporary folder and put in place at once, whole or not at all."""

from __future__ import annotations

import ctypes
import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import DatasetError, InputError
from ..shipped import golden_root, keep_seal
from ..solver.solution import Solution
from .manifest import MANIFEST
from .render import render
from .verify import problems_of

_AT_FDCWD, _RENAME_EXCHANGE = -100, 2


def check_target(folder: Path) -> None:
    """Refuse a target that cannot be written, or that holds something other than a dataset.

    Raises:
        InputError: the target cannot be written, or something else is in its place.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError("--out", str(folder), "a folder", "A file of that name is in the way.")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / MANIFEST).is_file():
        raise InputError("--out", str(folder), "a new or empty folder, or an older dataset", "Nothing was changed.")
    parent = folder.absolute().parent
    try:
        parent.mkdir(parents=True, exist_ok=True)
        with _workspace(folder):
            pass
    except OSError as error:
        raise InputError("--out", str(folder), "a writable place", f"{error.strerror}.") from None


@contextmanager
def _workspace(folder: Path) -> Iterator[Path]:
    """Provide a new folder beside the target; remove it afterwards, and any that killed processes left behind."""
    target = folder.absolute()
    for stale in target.parent.glob(f".{target.name}.partial-*"):
        with suppress(ValueError, PermissionError, ProcessLookupError):
            try:
                os.kill(int(stale.name.rpartition("-")[2]), 0)
            except ProcessLookupError:
                shutil.rmtree(stale, ignore_errors=True)
    work = target.parent / f".{target.name}.partial-{os.getpid()}"
    work.mkdir()
    try:
        yield work
    finally:
        shutil.rmtree(work, ignore_errors=True)


def write(solution: Solution, folder: str | Path, name: str | None = None) -> Path:
    """Write a solution as a golden dataset: beside `folder`, where it is checked, and then put in place at once.

    Args:
        solution: what to write.
        folder: the dataset's folder; an older dataset there is replaced.
        name: the dataset's id, by default the scene's own with its changes (`place.dataset_id`).

    Raises:
        InputError: the folder cannot be written.
        DatasetError: the new dataset does not pass its own checks; the old one, if any, is left as it is.
    """
    folder = Path(folder)
    check_target(folder)
    with _workspace(folder) as work:
        texts = render(solution, name)
        for file, text in texts.items():
            with (work / file).open("w", encoding="utf-8", newline="\n") as handle:
                handle.write(text)
                handle.flush()
                os.fsync(handle.fileno())
        problems = problems_of(work)
        if problems:
            raise DatasetError(str(folder), problems)
        _put_in_place(work, folder.absolute())
    if folder.resolve().parent == golden_root().resolve():
        keep_seal(folder.name, json.loads(texts[MANIFEST])["seal"])
    return folder


def _put_in_place(work: Path, target: Path) -> None:
    """Replace `target` by `work`, in one step where the system can."""
    if not target.exists():
        work.rename(target)
    elif not _exchange(work, target):
        older = work.with_name(work.name + ".old")  # no atomic exchange on this system: two renames
        target.rename(older)
        work.rename(target)
        shutil.rmtree(older)


def _exchange(a: Path, b: Path) -> bool:
    """Swap two folders in one step (Linux); return False where the system cannot."""
    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError):
        return False
    status: int = renameat2(_AT_FDCWD, os.fsencode(a), _AT_FDCWD, os.fsencode(b), _RENAME_EXCHANGE)
    return status == 0
