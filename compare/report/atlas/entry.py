"""A scene of the atlas: its datasets in a folder, in both readings of the inputs, and results of methods on it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from reference import Golden, InputError, load, load_scene, scene_ids
from reference.dataset.manifest import MANIFEST
from reference.dataset.place import changes
from reference.errors import usable
from reference.plain_text import shortened
from reference.scenes.shipped import data_root, in_checkout
from reference.status import Status
from reference.system.documents import json_document

from ...studies.row import Row
from ...studies.stability import Cell
from ..pareto import rows_of

_LONGEST_REASON = 160  # characters of an error message: pydantic has one line for each row
# fields that a cell of docs/studies leaves out
_NOT_KEPT = {"digits": None, "cpu_s": None, "reason": ""}
# fields of a scene that make no difference to a score
_KEPT = {"run.digits", "run.level", "run.grid_step", "run.transits"}
# what a file that is not a study may raise
_UNREADABLE = (
    InputError,
    OSError,
    ValueError,
    KeyError,
    TypeError,
    AttributeError,
    OverflowError,
)


@dataclass
class StudyResults:
    """Results of the kept studies for one scene.

    Attributes:
        same_digits: runs that were asked for digits, by name.
        least: the most accurate run of each method over `span_s`.
        span_s: in s; 0 if there is no such study.
    """

    same_digits: dict[str, Cell] = field(default_factory=dict)
    least: Sequence[Row] = ()
    span_s: float = 0.0

    def sentence(self) -> str:
        """Return a summary; empty if nothing is known."""
        if self.same_digits:
            return self._summary_of_same_digits()
        if self.least:
            best = self.least[0]
            return (
                f"{len(self.least)} methods; the most accurate, {run_name(best)}, is "
                f"{best.error_m:.1e} m off."
            )
        return ""

    def _summary_of_same_digits(self) -> str:
        runs = self.same_digits
        right = sum(cell.status is Status.OK for cell in runs.values())
        wrong = [name for name, cell in runs.items() if cell.status is Status.SILENTLY_WRONG]
        ending = ", and none was silently wrong"
        if wrong:
            ending = f"; silently wrong: {', '.join(wrong)}"
        return f"{right} of {len(runs)} runs of methods are ok{ending}."


def run_name(run: Cell | Row) -> str:
    """Return the method of a run with its formulation, and its number type unless that is double."""
    variant = run.formulation if isinstance(run, Row) else run.precision.removeprefix("double, ")
    return f"{run.method} {variant}".strip()


@dataclass(frozen=True)
class Entry:
    """A scene of the atlas.

    Attributes:
        golden: its dataset; of two, the one whose inputs are decimals.
        judged: the dataset that a file is compared with; of two, the one whose inputs are doubles.
        studied: how methods fared on it.
    """

    golden: Golden
    judged: Golden
    studied: StudyResults

    @property
    def id(self) -> str:
        """The scene's id, which is also the name of its page."""
        return _name(self.golden)

    @property
    def datasets(self) -> list[Golden]:
        """The scene's one or two datasets."""
        return [self.golden] if self.golden is self.judged else [self.golden, self.judged]

    @property
    def flags(self) -> tuple[str, ...]:
        """Why the scene is difficult: its flags."""
        return tuple(self.golden.manifest.flags)

    def score_command(self) -> str:
        """Return the command that judges a file as the page does."""
        scene = self.judged.scene
        if scene.id in scene_ids():
            words = ["foucault score", scene.id, "mine.csv"]
            words += _options_of(changes(scene, load_scene(scene.id)))
        else:
            words = ["foucault score", f"{scene.id}.toml", "mine.csv"]
        if scene.inputs == "decimal":
            words.append("--inputs decimal")
        return " ".join(words)


def _options_of(assignments: Iterable[str]) -> Iterator[str]:
    """Yield the options by which `foucault score` changes a scene that ships."""
    for assignment in assignments:
        field, _, value = assignment.partition("=")
        if field == "run.t_end":
            yield f"--t-end {value}"
        elif field not in _KEPT:
            yield f"--set {assignment}"


def entries(folder: Path, studies: Path | None) -> list[Entry]:
    """Return the scenes that have a dataset in a folder, sorted by id.

    Args:
        folder: the folder of the datasets.
        studies: a folder of results of studies, or None.

    Raises:
        InputError: a folder cannot be read, or holds no dataset; a file is no study.
        DatasetError: a dataset is damaged.
    """
    kept = kept_studies(studies)
    with usable("--data", folder, "a folder of golden datasets"):
        paths = sorted(path.parent for path in folder.glob(f"*/{MANIFEST}"))
    if not paths:
        advice = "`foucault generate --all` makes those that ship."
        raise InputError(
            "--data",
            str(folder),
            "a folder of golden datasets, each in a folder of its own",
            advice,
        )
    readings: dict[str, dict[str, Golden]] = {}
    for path in paths:
        golden = load(path)
        readings.setdefault(_name(golden), {})[golden.manifest.inputs] = golden
    scenes = []
    for name, by_inputs in sorted(readings.items()):
        first = next(iter(by_inputs.values()))
        decimal = by_inputs.get("decimal", first)
        binary64 = by_inputs.get("binary64", first)
        scenes.append(Entry(decimal, binary64, kept.get(name, StudyResults())))
    return scenes


def _name(golden: Golden) -> str:
    """Return the id of a dataset without its reading, which `paris.binary64` ends in."""
    return golden.manifest.id.removesuffix(f".{golden.manifest.inputs}")


def studies_folder() -> Path | None:
    """Return the folder of the studies that are kept; None outside of a checkout."""
    return data_root().parent / "docs" / "studies" if in_checkout() else None


def kept_studies(folder: Path | None) -> dict[str, StudyResults]:
    """Return the results of the studies in a folder, by scene; none if there is no folder.

    Raises:
        InputError: there is no such folder, or a file is no study.
    """
    if folder is not None and not folder.is_dir():
        advice = "`foucault study … --out DIR` writes one."
        raise InputError("--studies", str(folder), "a folder of study results", advice)
    results: defaultdict[str, StudyResults] = defaultdict(StudyResults)
    paths = [] if folder is None else sorted(folder.glob("*.json"))
    for path in paths:
        try:
            _add_study(json_document(path, "--studies"), results)
        except _UNREADABLE as error:
            expected = "a study as `foucault study` writes it"
            raise InputError("--studies", str(path), expected, _reason(error)) from None
    return results


def _reason(error: Exception) -> str:
    if isinstance(error, InputError):
        return error.advice
    return f"{shortened(str(error), _LONGEST_REASON)}."


def _add_study(document: dict[str, Any], results: defaultdict[str, StudyResults]) -> None:
    """Add the results in a study's document: a study of one scene, or runs that were asked for digits."""
    scene = document.get("scene")
    if scene is None:
        rows = [_NOT_KEPT | row for row in document["rows"]]
        for cell in TypeAdapter(list[Cell]).validate_python(rows):
            results[cell.scene].same_digits.setdefault(run_name(cell), cell)
    elif document["t_end"] > results[scene].span_s:
        results[scene].least = _least(rows_of(document))
        results[scene].span_s = float(document["t_end"])


def _least(rows: Sequence[Row]) -> list[Row]:
    """Return the most accurate run of each method and formulation, the best first."""
    best: dict[str, Row] = {}
    right = (row for row in rows if row.measured and row.error_m is not None)
    for row in sorted(right, key=attrgetter("error_m")):
        best.setdefault(run_name(row), row)
    return list(best.values())
