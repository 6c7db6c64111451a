"""`foucault verify`: check golden datasets, or solve them again; check sweeps and reports."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import NOTHING, InputError
from ..scenes.shipped import golden_root, seals
from .layout import echo, heading, paragraph
from .progress import Show, progress
from .terminal import AsJson, completion, emit, option, refuse

_PATHS = typer.Argument(
    metavar="PATH",
    help="Ids or folders of datasets (default: all that come with the project), sweeps or reports.",
    autocompletion=completion(seals),
)
_RECOMPUTE = option("--recompute", "Also solve each scene again and compare every byte.")


def command(
    paths: Annotated[list[str] | None, _PATHS] = None,
    recompute: Annotated[bool, _RECOMPUTE] = False,
    as_json: AsJson = False,
) -> None:
    """Check golden datasets, ranges, sweeps and reports.

    The motion of a dataset is integrated again; ranges are proved again. A sweep, a study and every other report is
    checked for changes since it was written, by seals and checksums.
    """
    from ..dataset.place import golden_folder

    folders = [golden_folder(path) for path in paths or ()]
    if not paths:
        folders = [golden_root() / name for name in seals()]
    if not folders:
        advice = "Make one with `foucault generate`."
        raise InputError("PATH", NOTHING, "a golden dataset", advice)
    checks = []
    for folder in folders:
        with progress() as show:
            check = _checked(folder, recompute, show)
        checks.append(check)
        if not as_json:
            _print(folder, check)
    if as_json:
        rows = [_row(folder, check) for folder, check in zip(folders, checks, strict=True)]
        emit({"rows": rows})
    if any(check.problems for check in checks):
        raise typer.Exit(1)


@dataclass(frozen=True)
class _Check:
    """What was found in a folder: what is wrong, what was not decided, and notes."""

    problems: list[str]
    undecided: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def _checked(folder: Path, recompute: bool, show: Show) -> _Check:
    """Check a dataset, ranges, a sweep or a report.

    Raises:
        InputError: the folder is none of these, or --recompute does not apply to it.
        UnreachableError: the proof of ranges fails here, or a scene cannot be solved again.
    """
    from ..dataset.place import RANGES
    from ..dataset.ranges import verify_ranges

    if (folder / RANGES).is_file():
        return _Check(verify_ranges(folder, show(folder.name), recompute))
    results = _written_results(folder)
    if results is not None:
        refuse({"--recompute": recompute}, "with a sweep or a report")
        return _Check(*results)
    _check_manifest(folder)
    return _checked_dataset(folder, recompute, show)


def _checked_dataset(folder: Path, recompute: bool, show: Show) -> _Check:
    """Check a golden dataset, and solve it again if asked to."""
    from ..dataset.verify import recompute as recomputed
    from ..dataset.verify import verify
    from ..solver.choice import need_heyoka

    if recompute:
        need_heyoka("--recompute")
    outcome = verify(folder, show(folder.name))
    if not recompute or outcome.problems:
        return _Check(outcome.problems, outcome.undecided, outcome.foreign)
    problems, measured = recomputed(folder, show(folder.name))
    return _Check(problems, notes=[*outcome.foreign, *measured])


def _print(folder: Path, check: _Check) -> None:
    """Print the verdict on a folder, then its problems, what was not decided, and notes."""
    verdict = "WRONG" if check.problems else "ok"
    heading(f"{folder}: {verdict}", wraps=False)
    for line in [*check.problems, *check.undecided, *check.notes]:
        echo(paragraph(line, "  ", hanging="  "))


def _row(folder: Path, check: _Check) -> dict[str, Any]:
    """Return what --json prints on a folder."""
    return {
        "path": str(folder),
        "ok": not check.problems,
        "problems": check.problems,
        "notes": [*check.undecided, *check.notes],
    }


def _written_results(folder: Path) -> tuple[list[str], list[str]] | None:
    """Return problems and undecided points of a sweep or a report; None if it is neither."""
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
    """Refuse a folder without any of the files that mark a result: one may have been lost.

    Raises:
        InputError: it is such a folder.
    """
    from ..dataset.manifest import MANIFEST
    from ..dataset.place import RANGES
    from ..sweeps.store import PLAN
    from ..system.checksums import SUMS

    if folder.is_dir() and not (folder / MANIFEST).exists():
        dataset = f"a golden dataset (a folder with {MANIFEST})"
        expected = f"{dataset}, ranges ({RANGES}), a sweep ({PLAN}) or a report ({SUMS})"
        raise InputError("PATH", str(folder), expected, "Make it with `foucault generate`.")
