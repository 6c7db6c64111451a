"""Recompute a dataset: solve its scene again as its command says, and compare every byte."""

from __future__ import annotations

from itertools import zip_longest
from pathlib import Path

from ..numbers.precision import DOUBLE, LONG_DOUBLE
from .checks.motion import Progress
from .files import read_files
from .manifest import MANIFEST, Manifest, differences
from .record import Making
from .render import render
from .shipping import solved

FOLLOWS = ("seal", "files")  # from everything else
MEASURED = ("run", "cross_checks", "enclosure", "generator")  # may differ with the machine or the libraries
HARDWARE = (DOUBLE.name, LONG_DOUBLE.name)


def recompute(folder: Path, report: Progress | None = None) -> tuple[list[str], list[str]]:
    """Solve the scene of a dataset again, and compare.

    Returns:
        A sentence for each field and file that differs, and a note where only figures differ that are measured: those
        of runs in double or long double, or of other versions of the libraries.

    Raises:
        InputError, DatasetError: as `read_files`.
        UnreachableError: the scene cannot be solved here.
    """
    files = read_files(folder)
    manifest, end = files.manifest, float(files.scene.exact.t_end)
    solution = solved(files.scene, Making.of(manifest.command), report and (lambda t: report(t, end)))
    texts = render(solution, manifest.id)
    made = Manifest.model_validate_json(texts.pop(MANIFEST))
    fields = [*differences(manifest.model_dump(exclude={*FOLLOWS}), made.model_dump(exclude={*FOLLOWS}))]
    lines = [f"{MANIFEST}: {place} = {old}, recomputed {new}" for place, old, new in fields]
    wrong = [line for name, text in texts.items() if (line := _first_line(name, files.texts.get(name), text))]
    if wrong or not fields:
        return [*wrong, *lines], []
    runs = [manifest.run, made.run, *manifest.cross_checks, *made.cross_checks]
    excused = manifest.generator != made.generator or any(run.number in HARDWARE for run in runs)
    if excused and all(place.startswith(MEASURED) for place, *_ in fields):
        said = f"every digit and bound is the same; {_differ(len(fields), 'measured figure')}"
        return [], [said, *lines]
    return lines, []


def _first_line(name: str, old: str | None, new: str) -> str:
    """Return how a file differs: in how many lines, and the first of them; empty if it does not."""
    if old is None:
        return f"{name}: recomputing gives this file too"
    pairs = enumerate(zip_longest(old.splitlines(), new.splitlines(), fillvalue="nothing"), 1)
    other = [(number, one, two) for number, (one, two) in pairs if one != two]
    if not other:
        return ""
    number, one, two = other[0]
    return f"{name}: {_differ(len(other), 'line')}; line {number} is {one}, recomputed {two}"


def _differ(count: int, what: str) -> str:
    return f"{count} {what}s differ" if count > 1 else f"1 {what} differs"
