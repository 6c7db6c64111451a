"""How methods fare on each scene: from the results of studies that are kept, docs/studies in a checkout."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic.dataclasses import dataclass

from reference import InputError
from reference.scenes.shipped import data_root, in_checkout
from reference.status import Status
from reference.system.documents import json_document


@dataclass(frozen=True)
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


@dataclass(frozen=True)
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
            right = sum(one.status is Status.OK for one in self.asked)
            wrong = [one.method for one in self.asked if one.status is Status.SILENTLY_WRONG]
            return f"{right} of {len(self.asked)} runs of methods kept what was asked for" + (
                f"; silently wrong: {', '.join(dict.fromkeys(wrong))}." if wrong else ", and none was silently wrong."
            )
        if self.least:
            best = self.least[0]
            return f"{len(self.least)} methods; the most accurate, {best.method}, is {best.error_m:.1e} m off."
        return ""


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
                    one = _asked(row)  # which another study may hold as well
                    asked.setdefault(str(row["scene"]), {}).setdefault(one.method, one)
            elif document["t_end"] > least.get(scene, (0.0, []))[0]:
                least[scene] = (float(document["t_end"]), _least(document["rows"]))
        except InputError as error:
            raise _no_study(path, error.advice) from None
        except (OSError, ValueError, KeyError, TypeError, AttributeError, OverflowError) as error:
            raise _no_study(path, f"{error}.") from None
    results = {}
    for name in {*asked, *least}:
        span_s, best = least.get(name, (0.0, []))
        results[name] = StudyResults(tuple(asked.get(name, {}).values()), best, span_s)
    return results


def _no_study(path: Path, reason: str) -> InputError:
    return InputError("--studies", str(path), "a study as `foucault study` writes it", reason)


def _asked(row: dict[str, Any]) -> MethodResult:
    name = " ".join(part for part in (row["method"], row["precision"].removeprefix("double, ")) if part)
    return MethodResult(name, Status(row["status"]), row.get("digits"), row.get("asked"), cpu_s=row.get("cpu_s"))


def _least(rows: Sequence[dict[str, Any]]) -> list[MethodResult]:
    """Return the most accurate run of each method and formulation, the best first."""
    best: dict[str, MethodResult] = {}
    for row in rows:
        name = " ".join(part for part in (row["method"], row.get("formulation", "")) if part)
        error = row.get("error_m")
        if row["status"] == Status.OK and error is not None and error < (best[name].error_m if name in best else 1e300):
            best[name] = MethodResult(name, Status.OK, error_m=error, cpu_s=row.get("cpu_s"))
    return sorted(best.values(), key=lambda one: one.error_m or 0.0)
