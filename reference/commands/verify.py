"""`foucault verify`: check golden datasets, or solve them again and compare every byte; check sweeps and reports."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from ..scenes.shipped import golden_root, seals
from .progress import progress
from .terminal import AsJson, completion, emit, option, refuse

PATHS = typer.Argument(
    metavar="PATH",
    help="Ids or folders of datasets (default: all that come with the project), sweeps or reports.",
    autocompletion=completion(seals),
)
RECOMPUTE = option("--recompute", "Also solve each scene again and compare every byte.")


def command(
    paths: Annotated[list[str] | None, PATHS] = None,
    recompute: Annotated[bool, RECOMPUTE] = False,
    as_json: AsJson = False,
) -> None:
    """Check golden datasets, ranges, sweeps and reports.

    The motion of a dataset is integrated again; ranges are proved again. A sweep, a study and every other report is
    checked for changes since it was written, by seals and checksums.
    """
    from ..dataset.place import RANGES, golden_folder
    from ..dataset.ranges import verify_ranges
    from ..dataset.verify import recompute as recomputed
    from ..dataset.verify import verify

    folders = [golden_folder(path) for path in paths or ()] or [
        golden_root() / name for name in seals()
    ]
    if not folders:
        raise InputError(
            "PATH", "nothing", "a golden dataset", "Make one with `foucault generate`."
        )
    rows = []
    notes: list[str]
    for folder in folders:
        with progress() as show:
            if (folder / RANGES).is_file():
                problems, undecided, notes = (
                    verify_ranges(folder, show(folder.name), recompute),
                    [],
                    [],
                )
            elif (results := _written_results(folder)) is not None:
                refuse({"--recompute": recompute}, "with a sweep or a report")
                problems, undecided, notes = *results, []
            else:
                _check_manifest(folder)
                outcome = verify(folder, show(folder.name))
                problems, undecided, notes = outcome.problems, outcome.undecided, outcome.foreign
                if recompute and not problems:
                    problems, measured = recomputed(folder, show(folder.name))
                    undecided, notes = [], [*notes, *measured]
        rows.append(
            {
                "path": str(folder),
                "ok": not problems,
                "problems": problems,
                "notes": [*undecided, *notes],
            }
        )
        if not as_json:
            typer.echo(f"{folder}: {'WRONG' if problems else '; '.join(['ok', *undecided])}")
            for line in [*problems, *notes]:
                typer.echo(f"  {line}")
    if as_json:
        emit({"rows": rows})
    if not all(row["ok"] for row in rows):
        raise typer.Exit(1)


def _written_results(folder: Path) -> tuple[list[str], list[str]] | None:
    """Return what is wrong with a sweep or a report, and what cannot be told; None where the folder is neither."""
    from ..dataset.manifest import MANIFEST
    from ..sweeps.store import PLAN
    from ..sweeps.verify_sweep import verify_sweep
    from ..system.checksums import JOURNALS, SUMS, verify_report

    if (folder / MANIFEST).is_file():
        return None
    if (folder / PLAN).is_file():
        return verify_sweep(folder)
    if (folder / SUMS).is_file() or any(folder.glob(JOURNALS)):
        return verify_report(folder)
    return None


def _check_manifest(folder: Path) -> None:
    """Refuse a folder that has none of the files by which a result is known: one may have been lost.

    Raises:
        InputError: it is such a folder.
    """
    from ..dataset.manifest import MANIFEST
    from ..dataset.place import RANGES
    from ..sweeps.store import PLAN
    from ..system.checksums import SUMS

    if folder.is_dir() and not (folder / MANIFEST).exists():
        expected = f"a golden dataset (a folder with {MANIFEST}), or a folder with {RANGES}, {PLAN} or {SUMS}"
        raise InputError("PATH", str(folder), expected, "Make it with `foucault generate`.")
