"""Verify a golden dataset: files, what follows from its scene, each row, the motion, the seal; or solve it again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, zip_longest
from pathlib import Path

from ..engines.plan import Report
from ..errors import BeyondDoublesError, DatasetError, FoucaultError
from ..numbers.precision import DOUBLE, LONG_DOUBLE
from ..scenes.shipped import golden_root, seals
from ..solver.solve import solve
from .checks import function, motion, physics, read_back, scene_check
from .files import Files, read_files, read_manifest
from .making import AUDIT, Making
from .manifest import MANIFEST, Content, Manifest, differences
from .record import generator
from .render import render

MAX_PROBLEMS = 20  # sentences returned at most
BEYOND = (
    "a number of the scene or of a table, or what follows from it, is beyond the range of binary64"
)
FOLLOWS = ("seal", "files")  # from everything else
# may differ with the machine or the libraries
MEASURED = ("run", "cross_checks", "enclosure", "generator")
HARDWARE = (DOUBLE.name, LONG_DOUBLE.name)


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
        folder: where it stands.
        report: called with the simulated time reached and the whole span, in s.

    Raises:
        InputError: there is no dataset at `folder`.
    """
    try:
        files = read_files(folder)
    except DatasetError as error:
        return Verification(error.problems[:MAX_PROBLEMS], [], [])
    foreign = [f"{name}: not part of the dataset, ignored" for name in files.foreign[:MAX_PROBLEMS]]
    foreign += [f"and {more} more"] if (more := len(files.foreign) - MAX_PROBLEMS) > 0 else []
    problems = [*islice(seal_problems(files), MAX_PROBLEMS), *_row_by_row(files)]
    undecided: list[str] = []
    if not problems:
        try:
            problems, undecided = motion.problems(files, report)
        except (ArithmeticError, BeyondDoublesError):
            problems = [BEYOND]
    if problems:
        return Verification(problems[:MAX_PROBLEMS], foreign, [])
    words = ", ".join([*undecided, *_claims(files.manifest)])
    return Verification([], foreign, [f"not decided without --recompute: {words}"] if words else [])


def _claims(manifest: Manifest) -> list[str]:
    """Return what a manifest says of its proof and its cross-checks, for which nothing but the index can vouch."""
    confirmed = (
        f" (confirmation: {Making.of(manifest.command).confirm})" if manifest.enclosure else ""
    )
    claims = {
        "the proof": manifest.enclosure,
        f"the cross-checks{confirmed}": manifest.cross_checks,
    }
    return [
        name
        for name, evidence in claims.items()
        if evidence and seals().get(manifest.id) != manifest.seal
    ]


def problems_of(folder: Path) -> list[str]:
    """Return a sentence for each problem of a dataset that shows without integrating.

    Raises:
        InputError: there is no dataset at `folder`.
    """
    try:
        return _row_by_row(read_files(folder))
    except DatasetError as error:
        return error.problems[:MAX_PROBLEMS]


def _row_by_row(files: Files) -> list[str]:
    """Return what is wrong with the record and with each row by itself; later checks need what earlier ones passed."""
    of_tables = [
        scene_check.table_problems,
        scene_check.problems,
        read_back.problems,
        physics.problems,
    ]
    checks = [scene_check.problems] if files.manifest.alone else of_tables
    for check in (*checks, function.problems):
        try:
            problems = list(islice(check(files), MAX_PROBLEMS))
        except (ArithmeticError, BeyondDoublesError):
            problems = [BEYOND]
        if problems:
            return problems
    return []


def seal_problems(files: Files) -> Iterator[str]:
    """Check the seal of a dataset that ships, in its place or copied from there."""
    manifest, ships = files.manifest, golden_root() / files.manifest.id
    in_place = files.folder.resolve() == ships.resolve()
    if in_place and manifest.level == "enclosed" and AUDIT not in manifest.command.split():
        yield f"{MANIFEST}: a proof that ships must be audited: make it again with {AUDIT}"
    seal = seals().get(manifest.id)
    if seal in (None, manifest.seal):
        return
    if in_place or _is_copy(manifest, ships):
        ours, theirs = manifest.seal[:12], seal[:12]
        yield f"{MANIFEST}: its seal {ours}… is not that of the dataset that ships, {theirs}… (index.json)"


def _is_copy(manifest: Manifest, ships: Path) -> bool:
    """Return whether a dataset must be that which ships: made by the same command, not here with other versions."""
    try:
        shipped = read_manifest(ships)
    except FoucaultError:
        return False
    made_otherwise = shipped.generator != manifest.generator == generator()
    same = manifest.scene == shipped.scene and manifest.command == shipped.command
    return same and not made_otherwise


def recompute(folder: Path, report: motion.Progress | None = None) -> tuple[list[str], list[str]]:
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
    making = Making.of(manifest.command)
    tell: Report | None = report and (lambda t: report(t, end))
    solution = solve(files.scene, **making.solve_options(files.scene), report=tell)
    texts = render(solution, manifest.id, tables=making.tables)
    again = Manifest.model_validate_json(texts.pop(MANIFEST))
    fields = [
        *differences(manifest.model_dump(exclude={*FOLLOWS}), again.model_dump(exclude={*FOLLOWS}))
    ]
    lines = [f"{MANIFEST}: {place} = {old}, recomputed {new}" for place, old, new in fields]
    changed = [name for name, record in again.files.items() if record != manifest.files.get(name)]
    wrong = [f"{name}: {_how_it_differs(files.texts.get(name), texts[name])}" for name in changed]
    if wrong or not fields:
        return [*wrong, *lines], []
    runs = [manifest.run, again.run, *manifest.cross_checks, *again.cross_checks]
    excused = manifest.generator != again.generator or any(run.number in HARDWARE for run in runs)
    if excused and all(place.startswith(MEASURED) for place, *_ in fields):
        return [], [
            f"every digit and bound is the same; {_differ(len(fields), 'measured figure')}",
            *lines,
        ]
    return lines, []


def _how_it_differs(old: str | None, new: Content) -> str:
    """Return how a file differs: in how many lines, and the first of them."""
    if isinstance(new, bytes):
        return "recomputing gives other coefficients"
    if old is None:
        return "recomputing gives this file too"
    # with their ends, which may be all that differs
    old_lines, new_lines = (text.splitlines(keepends=True) for text in (old, new))
    pairs = enumerate(zip_longest(old_lines, new_lines, fillvalue="nothing"), 1)
    differing = [(number, *pair) for number, pair in pairs if pair[0] != pair[1]]
    number, before, after = differing[0]
    shown = repr if before.rstrip() == after.rstrip() else str.rstrip
    return f"{_differ(len(differing), 'line')}; line {number} is {shown(before)}, recomputed {shown(after)}"


def _differ(count: int, what: str) -> str:
    return f"{count} {what}s differ" if count > 1 else f"1 {what} differs"
