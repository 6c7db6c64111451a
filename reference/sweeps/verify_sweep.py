"""`foucault verify` of a sweep: parts by their seals, other files by their checksums."""

from __future__ import annotations

from pathlib import Path

from ..errors import InputError
from ..system.checksums import SUMS, check_sums
from ..system.documents import json_document
from .store import SUMMARY, Store
from .swept import Swept


def verify_sweep(folder: Path) -> tuple[list[str], list[str]]:
    """Return what is wrong with a sweep, and what cannot be decided.

    Raises:
        InputError: its plan is damaged, or pyarrow is not installed.
    """
    store = Store.opened(folder)
    problems = []
    undecided = []
    missing = store.missing()
    if missing:
        first = store.path(missing[0]).name
        problems.append(
            f"{len(missing)} of {store.request.parts} parts are missing or damaged, first {first}; "
            f"`foucault sweep --out {folder}` makes them again"
        )
    for name in store.foreign():
        problems.append(
            f"{name} is not a part of this sweep: remove it, programs that read the folder would include its rows"
        )
    try:
        problems += check_sums(folder)
    except FileNotFoundError:
        undecided.append(
            f"{SUMMARY}, because there is no {SUMS}; `foucault sweep --out {folder}` writes it"
        )
    if not problems:
        problems += _summary_problems(store)
    return problems, undecided


def _summary_problems(store: Store) -> list[str]:
    """Return where the summary differs from the parts."""
    try:
        summary = json_document(store.folder / SUMMARY, "PATH")
    except FileNotFoundError:
        return [f"{SUMMARY} is missing"]
    except InputError as error:
        return [str(error)]
    swept = Swept(store.request, store)
    stated = {"rows": summary.get("rows"), "counts": summary.get("counts")}
    counted = {"rows": len(swept), "counts": swept.counts}
    if stated == counted:
        return []
    return [f"{SUMMARY} says {stated}, but the parts contain {counted}"]
