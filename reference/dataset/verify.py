"""Verify a golden dataset: files, scene, each row, the motion, the seal; or solve it again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, zip_longest
from pathlib import Path
from typing import Any

from ..engines.plan import Report
from ..errors import BeyondDoublesError, DatasetError, FoucaultError
from ..numbers.precision import DOUBLE, LONG_DOUBLE
from ..scenes.shipped import golden_root, seals
from ..solver.solve import solve
from .checks import function, motion, physics, read_back, scene_check
from .files import DatasetFiles, read_files, read_manifest
from .making import AUDIT, Making
from .manifest import MANIFEST, Content, Manifest, differences
from .record import generator
from .render import render

_MAX_PROBLEMS = 20  # sentences returned at most
_BEYOND = (
    "a number of the scene or of a table, or what follows from it, is beyond the range of binary64"
)
_FOLLOWING = {"seal", "files"}  # from everything else
# may differ with the machine or the libraries
_MEASURED = ("run", "cross_checks", "enclosure", "generator")
_HARDWARE = (DOUBLE.name, LONG_DOUBLE.name)


@dataclass(frozen=True)
class Verification:
    """The outcome of checking a dataset.

    Attributes:
        problems: a sentence for each; none if the dataset passes.
        foreign: a note on each file in the folder that does not belong to the dataset.
        undecided: a sentence on what only `recompute` decides; none if that is nothing.
    """

    problems: list[str]
    foreign: list[str]
    undecided: list[str]


def verify(folder: Path, report: motion.Progress | None = None) -> Verification:
    """Check a dataset, and integrate its scene again, which takes some seconds for a day of Paris.

    Args:
        folder: its folder.
        report: called with the simulated time reached and the whole span, in s.

    Raises:
        InputError: there is no dataset at `folder`.
    """
    try:
        files = read_files(folder)
    except DatasetError as error:
        return Verification(error.problems[:_MAX_PROBLEMS], [], [])
    foreign = _foreign(files)
    problems = [*islice(_seal_problems(files), _MAX_PROBLEMS), *_row_by_row(files)]
    undecided: list[str] = []
    if not problems:
        try:
            problems, undecided = motion.problems(files, report)
        except (ArithmeticError, BeyondDoublesError):
            problems = [_BEYOND]
    if problems:
        return Verification(problems[:_MAX_PROBLEMS], foreign, [])

    undecided = [*undecided, *scene_check.unchecked(), *_unconfirmed(files.manifest)]
    if undecided:
        undecided = [f"checked only by --recompute: {', '.join(undecided)}"]
    return Verification([], foreign, undecided)


def _foreign(files: DatasetFiles) -> list[str]:
    """Return a note on each file that does not belong to a dataset, at most 20 and a count."""
    notes = [f"{name}: not part of the dataset, ignored" for name in files.foreign[:_MAX_PROBLEMS]]
    more = len(files.foreign) - _MAX_PROBLEMS
    if more > 0:
        notes.append(f"and {more} more")
    return notes


def _unconfirmed(manifest: Manifest) -> list[str]:
    """Return the evidence, proof and cross-checks, that no seal in the index vouches for."""
    if seals().get(manifest.id) == manifest.seal:
        return []
    evidence = []
    if manifest.enclosure:
        evidence.append("the proof")
    if manifest.cross_checks:
        evidence.append("the cross-checks")
    return evidence


def problems_of(folder: Path) -> list[str]:
    """Return a sentence for each problem of a dataset that is found without integrating.

    Raises:
        InputError: there is no dataset at `folder`.
    """
    try:
        return _row_by_row(read_files(folder))
    except DatasetError as error:
        return error.problems[:_MAX_PROBLEMS]


def _row_by_row(files: DatasetFiles) -> list[str]:
    """Return what is wrong with the record and with each row by itself.

    The first check that finds a problem ends this: later ones rely on it.
    """
    if files.manifest.alone:
        checks = [scene_check.problems, function.problems]
    else:
        checks = [
            scene_check.table_problems,
            scene_check.problems,
            read_back.problems,
            physics.problems,
            function.problems,
        ]
    for check in checks:
        try:
            problems = list(islice(check(files), _MAX_PROBLEMS))
        except (ArithmeticError, BeyondDoublesError):
            problems = [_BEYOND]
        if problems:
            return problems
    return []


def _seal_problems(files: DatasetFiles) -> Iterator[str]:
    """Check the seal of a dataset that ships, in its place or copied from there."""
    manifest = files.manifest
    ships = golden_root() / manifest.id
    in_place = files.folder.resolve() == ships.resolve()
    if in_place and manifest.level == "enclosed" and AUDIT not in manifest.command.split():
        yield f"{MANIFEST}: a proof that ships must be audited: make it again with {AUDIT}"
    seal = seals().get(manifest.id)
    if seal in (None, manifest.seal):
        return
    if in_place or _is_copy(manifest, ships):
        text = f"its seal {manifest.seal[:12]}… is not that of the dataset that ships, {seal[:12]}…"
        yield f"{MANIFEST}: {text} (index.json)"


def _is_copy(manifest: Manifest, ships: Path) -> bool:
    """Return whether a dataset must be the one that ships.

    It was made by the same command, and not here with other versions.
    """
    try:
        shipped = read_manifest(ships)
    except FoucaultError:
        return False
    if manifest.scene != shipped.scene or manifest.command != shipped.command:
        return False
    made_here = manifest.generator == generator()
    return manifest.generator == shipped.generator or not made_here


def recompute(folder: Path, report: motion.Progress | None = None) -> tuple[list[str], list[str]]:
    """Solve the scene of a dataset again, and compare.

    Returns:
        A sentence for each field and file that differs, and a note where only figures differ that
        are measured: those of runs in double or long double, or of other versions of the libraries.

    Raises:
        InputError, DatasetError: as `read_files`.
        UnreachableError: the scene cannot be solved here.
    """
    files = read_files(folder)
    manifest = files.manifest
    contents = _made_again(files, report)
    again = Manifest.model_validate_json(contents.pop(MANIFEST))
    fields = [*differences(_without_following(manifest), _without_following(again))]
    lines = [f"{MANIFEST}: {place} = {old}, recomputed {new}" for place, old, new in fields]
    wrong = [
        f"{name}: {_how_it_differs(files.texts.get(name), contents[name])}"
        for name, record in again.files.items()
        if record != manifest.files.get(name)
    ]
    if wrong or not fields:
        return [*wrong, *lines], []

    only_measured = all(place.startswith(_MEASURED) for place, *_ in fields)
    if only_measured and _may_be_measured_otherwise(manifest, again):
        figures = _differ(len(fields), "measured figure")
        return [], [f"every digit and bound is the same; {figures}", *lines]
    return lines, []


def _made_again(files: DatasetFiles, report: motion.Progress | None) -> dict[str, Content]:
    """Return the files of a dataset as its command makes them.

    Raises:
        UnreachableError: the scene cannot be solved here.
    """
    manifest = files.manifest
    making = Making.of(manifest.command)
    t_end = float(files.scene.exact.t_end)
    tell: Report | None = report and (lambda t: report(t, t_end))
    solution = solve(files.scene, **making.solve_options(files.scene), report=tell)
    return render(solution, manifest.id, tables=making.tables)


def _without_following(manifest: Manifest) -> dict[str, Any]:
    """Return the fields of a manifest but for those that follow from everything else."""
    return manifest.model_dump(exclude=_FOLLOWING)


def _may_be_measured_otherwise(manifest: Manifest, again: Manifest) -> bool:
    """Return whether libraries differ in version, or a run was in the numbers of the processor."""
    runs = [manifest.run, again.run, *manifest.cross_checks, *again.cross_checks]
    in_hardware = any(run.number in _HARDWARE for run in runs)
    return in_hardware or manifest.generator != again.generator


def _how_it_differs(old: str | None, new: Content) -> str:
    """Return how a file differs: in how many lines, and the first of them."""
    if isinstance(new, bytes):
        return "recomputing gives other coefficients"
    if old is None:
        return "recomputing gives this file too"
    # with their ends, which may be all that differs
    old_lines = old.splitlines(keepends=True)
    new_lines = new.splitlines(keepends=True)
    pairs = enumerate(zip_longest(old_lines, new_lines, fillvalue="nothing"), 1)
    differing = [(number, before, after) for number, (before, after) in pairs if before != after]
    number, before, after = differing[0]
    only_ends_differ = before.rstrip() == after.rstrip()
    shown = repr if only_ends_differ else str.rstrip
    first = f"line {number} is {shown(before)}, recomputed {shown(after)}"
    return f"{_differ(len(differing), 'line')}; {first}"


def _differ(count: int, noun: str) -> str:
    """Return how many of something differ."""
    return f"{count} {noun}s differ" if count > 1 else f"1 {noun} differs"
