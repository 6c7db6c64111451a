"""Compare a manifest's runs, proof and scene with the solution that it was made from.

No number of a table depends on these, and no check of the files alone could find them wrong.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from importlib.metadata import version
from typing import Any

from ..errors import DatasetError
from ..numbers.precision import rounded_up
from ..scenes.shipped import DATA_VERSION
from ..solver.solution import Proof, Solution
from .making import Making
from .manifest import MANIFEST, Content
from .record import PACKAGES

# a number that is rounded up to two digits is larger by a tenth at most
_ROUNDED_UP = Fraction(11, 10)
_RUN = ("formulation", "number", "order", "steps")
_DISTANCES = ("position_m", "velocity_m_s", "transit_s")


@dataclass(frozen=True)
class _Field:
    """A field of a manifest: where it is, its value, and the solution's."""

    place: str
    recorded: Any
    actual: Any

    @property
    def is_right(self) -> bool:
        """Whether both values are the same; a fraction is recorded with two digits, rounded up."""
        if isinstance(self.actual, Fraction) and self.recorded is not None:
            return self.actual <= Fraction(self.recorded) <= self.actual * _ROUNDED_UP
        return bool(self.recorded == self.actual)

    @property
    def problem(self) -> str:
        """A sentence on a field that is wrong."""
        actual = self.actual
        if isinstance(actual, Fraction):
            actual = rounded_up(actual)
        return f"{MANIFEST}: {self.place} = {self.recorded}, the solution has {actual}"


def check_evidence(contents: Mapping[str, Content], solution: Solution) -> None:
    """Compare a manifest with the solution: title, versions, runs and their distances, radii.

    Raises:
        DatasetError: a field has another value.
    """
    manifest = json.loads(contents[MANIFEST])
    fields = [*_scene(manifest, solution), *_command(manifest, solution)]
    fields += [*_runs(manifest, solution), *_enclosure(manifest, solution.proof)]
    problems = [field.problem for field in fields if not field.is_right]
    if problems:
        raise DatasetError(solution.scene.id, problems)


def _scene(manifest: dict[str, Any], solution: Solution) -> Iterator[_Field]:
    """Yield the fields that the scene gives, and the versions of data and libraries."""
    scene = solution.scene
    yield _Field("title", manifest["title"], scene.title)
    yield _Field("source", manifest["source"], scene.source)
    yield _Field("flags", manifest["flags"], list(scene.flags))
    for name, recorded in manifest["generator"].items():
        installed = version(name) if name in PACKAGES else DATA_VERSION
        yield _Field(f"generator.{name}", recorded, installed)


def _command(manifest: dict[str, Any], solution: Solution) -> Iterator[_Field]:
    """Yield what the command says of how the dataset was made."""
    making = Making.of(manifest["command"])
    proof = solution.proof
    yield _Field("the engine of command", making.engine, solution.run.engine)
    if proof is not None:
        has_function = proof.enclosure.function is not None
        yield _Field("the audit of command", making.audit, proof.audited)
        yield _Field("the confirmation of command", making.confirm, proof.confirmed)
        yield _Field("the function of command", making.function, has_function)


def _runs(manifest: dict[str, Any], solution: Solution) -> Iterator[_Field]:
    """Yield the fields of the published run and of its cross-checks."""
    for name in _RUN:
        yield _Field(f"run.{name}", manifest["run"][name], getattr(solution.run, name))
    records = manifest["cross_checks"]
    checks = solution.checks
    yield _Field("the number of cross_checks", len(records), len(checks))
    for k, (record, check) in enumerate(zip(records, checks, strict=False)):
        for name in (*_RUN, *_DISTANCES):
            yield _Field(f"cross_checks[{k}].{name}", record[name], getattr(check, name))


def _enclosure(manifest: dict[str, Any], proof: Proof | None) -> Iterator[_Field]:
    """Yield the fields of the proof."""
    record = manifest["enclosure"] or {}
    facts = _facts(proof) if proof else {}
    for name in {**record, **facts}:
        yield _Field(f"enclosure.{name}", record.get(name), facts.get(name))


def _facts(proof: Proof) -> dict[str, Any]:
    """Return what a manifest should say of a proof."""
    enclosure = proof.enclosure
    return {
        "method": enclosure.method,
        "prec": enclosure.bits,
        "order": enclosure.order,
        "steps": enclosure.steps,
        "position_radius_m": enclosure.position_radius,
        "velocity_radius_m_s": enclosure.velocity_radius,
        "transit_radius_s": proof.transit_radius,
        "agreement_bits": proof.agreement_bits,
    }
