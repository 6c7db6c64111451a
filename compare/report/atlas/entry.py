"""A scene of the atlas: its datasets in a folder, in both readings of the inputs, and how methods fare on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path
from typing import Any

from pydantic.dataclasses import dataclass as checked

from reference import Golden, InputError, load, load_scene, scene_ids
from reference.dataset.manifest import MANIFEST
from reference.dataset.place import changes
from reference.scenes.shipped import data_root, in_checkout
from reference.status import Status
from reference.system.documents import json_document

KEPT = {"run.digits", "run.level", "run.grid_step", "run.transits"}  # they make no difference to a score


@checked(frozen=True)
class MethodResult:
    """The result of one method on a scene.

    Attributes:
        method: its name, with its number type and formulation where they are told.
        status: the outcome of its run.
        digits: that it kept; None if they were not measured.
        asked: the digits that it was asked for; None in a study of costs, where the least error counts.
        error_m: its least error in m; None where digits were measured.
        cpu_s: CPU seconds of the run.
    """

    method: str
    status: Status
    digits: float | None = None
    asked: float | None = None
    error_m: float | None = None
    cpu_s: float | None = None


@checked(frozen=True)
class StudyResults:
    """Results of the kept studies for one scene: runs asked for the same digits, and the least error of each method.

    Attributes:
        asked: runs that were asked for the same digits.
        least: the most accurate run of each method over `span_s`.
        span_s: in s; 0 if there is no such study.
    """

    asked: Sequence[MethodResult] = ()
    least: Sequence[MethodResult] = ()
    span_s: float = 0.0

    def sentence(self) -> str:
        """Return it in short; empty if nothing is known."""
        if self.asked:
            right = sum(result.status is Status.OK for result in self.asked)
            wrong = [result.method for result in self.asked if result.status is Status.SILENTLY_WRONG]
            return f"{right} of {len(self.asked)} runs of methods kept what was asked for" + (
                f"; silently wrong: {', '.join(dict.fromkeys(wrong))}." if wrong else ", and none was silently wrong."
            )
        if self.least:
            best = self.least[0]
            return f"{len(self.least)} methods; the most accurate, {best.method}, is {best.error_m:.1e} m off."
        return ""


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
    try:
        paths = sorted(path.parent for path in folder.glob(f"*/{MANIFEST}"))
    except OSError as error:
        raise InputError("--data", str(folder), "a folder of golden datasets", f"{error.strerror}.") from None
    if not paths:
        advice = "`foucault generate --all` makes those that ship."
        raise InputError("--data", str(folder), "a folder of golden datasets, each a folder in it", advice)
    readings: dict[str, dict[str, Golden]] = {}
    for path in paths:
        golden = load(path)
        readings.setdefault(_name(golden), {})[golden.manifest.inputs] = golden
    kept = kept_studies(studies)
    scenes = []
    for name, of in sorted(readings.items()):
        either = next(iter(of.values()))
        scenes.append(Entry(of.get("decimal", either), of.get("binary64", either), kept.get(name, StudyResults())))
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
        InputError: a file is no study.
    """
    asked: dict[str, dict[str, MethodResult]] = {}
    least: dict[str, tuple[float, list[MethodResult]]] = {}
    for path in sorted(folder.glob("*.json")) if folder is not None else ():
        try:
            document = json_document(path, "--studies")
            scene = document.get("scene")
            if scene is None:
                for row in document["rows"]:
                    result = _asked(row)  # which another study may hold as well
                    asked.setdefault(str(row["scene"]), {}).setdefault(result.method, result)
            elif document["t_end"] > least.get(scene, (0.0, []))[0]:
                least[scene] = (float(document["t_end"]), _least(document["rows"]))
        except (InputError, OSError, ValueError, KeyError, TypeError, AttributeError, OverflowError) as error:
            reason = error.advice if isinstance(error, InputError) else f"{error}."
            raise InputError("--studies", str(path), "a study as `foucault study` writes it", reason) from None
    results = {}
    for name in {*asked, *least}:
        span_s, best = least.get(name, (0.0, []))
        results[name] = StudyResults(tuple(asked.get(name, {}).values()), best, span_s)
    return results


def _asked(row: dict[str, Any]) -> MethodResult:
    name = f"{row['method']} {row['precision'].removeprefix('double, ')}".strip()
    return MethodResult(name, Status(row["status"]), row.get("digits"), row.get("asked"), cpu_s=row.get("cpu_s"))


def _least(rows: Sequence[dict[str, Any]]) -> list[MethodResult]:
    """Return the most accurate run of each method and formulation, the best first."""
    best: dict[str, MethodResult] = {}
    right = (row for row in rows if row["status"] == Status.OK and row.get("error_m") is not None)
    for row in sorted(right, key=itemgetter("error_m")):
        name = f"{row['method']} {row.get('formulation', '')}".strip()
        best.setdefault(name, MethodResult(name, Status.OK, error_m=row["error_m"], cpu_s=row.get("cpu_s")))
    return list(best.values())
