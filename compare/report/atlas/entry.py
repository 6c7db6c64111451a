"""A scene of the atlas: its datasets in a folder, in both readings of the inputs, and how methods fare on it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path

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

LONGEST_REASON = 160  # characters of what is wrong with a study: every row may lack the same
# of a cell in docs/studies, where there is none
NOT_KEPT = {"digits": None, "cpu_s": None, "reason": ""}
# they make no difference to a score
KEPT = {"run.digits", "run.level", "run.grid_step", "run.transits"}


@dataclass
class StudyResults:
    """Results of the kept studies for one scene: runs asked for the same digits, and the least error of each method.

    Attributes:
        same_digits: runs that were asked for the same digits, by name.
        least: the most accurate run of each method over `span_s`.
        span_s: in s; 0 if there is no such study.
    """

    same_digits: dict[str, Cell] = field(default_factory=dict)
    least: Sequence[Row] = ()
    span_s: float = 0.0

    def sentence(self) -> str:
        """Return it in short; empty if nothing is known."""
        if self.same_digits:
            right = sum(cell.status is Status.OK for cell in self.same_digits.values())
            wrong = [
                name
                for name, cell in self.same_digits.items()
                if cell.status is Status.SILENTLY_WRONG
            ]
            ending = (
                f"; silently wrong: {', '.join(wrong)}"
                if wrong
                else ", and none was silently wrong"
            )
            return f"{right} of {len(self.same_digits)} runs of methods kept what was asked for{ending}."
        if self.least:
            best = self.least[0]
            return f"{len(self.least)} methods; the most accurate, {run_name(best)}, is {best.error_m:.1e} m off."
        return ""


def run_name(run: Cell | Row) -> str:
    """Return the method of a run, with its formulation, and its number type where that is not double."""
    variant = run.formulation if isinstance(run, Row) else run.precision.removeprefix("double, ")
    return f"{run.method} {variant}".strip()


@dataclass(frozen=True)
class Entry:
    """A scene of the atlas.

    Attributes:
        golden: its dataset, the one whose inputs are decimals if there are two.
        judged: the dataset that a dropped file is held against: the one whose inputs are doubles if there are two.
        studied: how methods fared on it.
    """

    golden: Golden
    judged: Golden
    studied: StudyResults

    @property
    def id(self) -> str:
        """Its id, and the name of its page."""
        return _name(self.golden)

    @property
    def datasets(self) -> list[Golden]:
        """Its one or two datasets."""
        return [self.golden] if self.golden is self.judged else [self.golden, self.judged]

    @property
    def flags(self) -> tuple[str, ...]:
        """Why it is difficult."""
        return tuple(self.golden.manifest.flags)

    def score_command(self) -> str:
        """Return the command that judges a file as the page does."""
        scene, words = self.judged.scene, ["foucault score"]
        if scene.id in scene_ids():
            words += [scene.id, "mine.csv"]
            for change in changes(scene, load_scene(scene.id)):
                field, _, value = change.partition("=")
                if field == "run.t_end":
                    words.append(f"--t-end {value}")
                elif field not in KEPT:
                    words.append(f"--set {change}")
        else:
            words += [f"{scene.id}.toml", "mine.csv"]
        return " ".join([*words, *(["--inputs decimal"] if scene.inputs == "decimal" else [])])


def entries(folder: Path, studies: Path | None) -> list[Entry]:
    """Return the scenes whose datasets stand in a folder, sorted by id.

    Args:
        folder: of the datasets.
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
            "--data", str(folder), "a folder of golden datasets, each a folder in it", advice
        )
    readings: dict[str, dict[str, Golden]] = {}
    for path in paths:
        golden = load(path)
        readings.setdefault(_name(golden), {})[golden.manifest.inputs] = golden
    scenes = []
    for name, by_inputs in sorted(readings.items()):
        either = next(iter(by_inputs.values()))
        decimal, binary64 = by_inputs.get("decimal", either), by_inputs.get("binary64", either)
        scenes.append(Entry(decimal, binary64, kept.get(name, StudyResults())))
    return scenes


def _name(golden: Golden) -> str:
    """Return the id of a dataset without its reading, which `paris.binary64` ends in."""
    return golden.manifest.id.removesuffix(f".{golden.manifest.inputs}")


def studies_folder() -> Path | None:
    """Return the folder of the studies that are kept; None outside of a checkout."""
    return data_root().parent / "docs" / "studies" if in_checkout() else None


def kept_studies(folder: Path | None) -> dict[str, StudyResults]:
    """Return what the studies in a folder say, by scene; nothing if there is no folder.

    Raises:
        InputError: there is no such folder, or a file is no study.
    """
    if folder is not None and not folder.is_dir():
        raise InputError(
            "--studies",
            str(folder),
            "a folder of results",
            "`foucault study … --out DIR` writes one.",
        )
    results: dict[str, StudyResults] = defaultdict(StudyResults)
    cells = TypeAdapter(list[Cell])
    for path in sorted(folder.glob("*.json")) if folder is not None else ():
        try:
            document = json_document(path, "--studies")
            scene = document.get("scene")
            if scene is None:
                for cell in cells.validate_python([NOT_KEPT | row for row in document["rows"]]):
                    # the first study that has it
                    results[cell.scene].same_digits.setdefault(run_name(cell), cell)
            elif document["t_end"] > results[scene].span_s:
                results[scene].least, results[scene].span_s = (
                    _least(rows_of(document)),
                    float(document["t_end"]),
                )
        except (
            InputError,
            OSError,
            ValueError,
            KeyError,
            TypeError,
            AttributeError,
            OverflowError,
        ) as error:
            reason = (
                error.advice
                if isinstance(error, InputError)
                else f"{shortened(str(error), LONGEST_REASON)}."
            )
            raise InputError(
                "--studies", str(path), "a study as `foucault study` writes it", reason
            ) from None
    return results


def _least(rows: Sequence[Row]) -> list[Row]:
    """Return the most accurate run of each method and formulation, the best first."""
    best: dict[str, Row] = {}
    right = (row for row in rows if row.measured and row.error_m is not None)
    for row in sorted(right, key=attrgetter("error_m")):
        best.setdefault(run_name(row), row)
    return list(best.values())
