"""Hold what a manifest says of its runs, its proof and its scene against the solution that it was made from.

No number of a table depends on these, and no check of the files alone could find them wrong.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
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
ROUNDED_UP = Fraction(11, 10)
RUN = ("formulation", "number", "order", "steps")
GAPS = ("position_m", "velocity_m_s", "transit_s")


def check_evidence(contents: Mapping[str, Content], solution: Solution) -> None:
    """Compare a manifest with the solution: title, versions, runs, how far they are apart, radii of the proof.

    Raises:
        DatasetError: it says something else.
    """
    manifest = json.loads(contents[MANIFEST])
    problems = [
        f"{MANIFEST}: {place} = {said}, the solution has {_text(value)}"
        for place, said, value in _pairs(manifest, solution)
        if not _says(said, value)
    ]
    if problems:
        raise DatasetError(solution.scene.id, problems)


def _pairs(manifest: dict[str, Any], solution: Solution) -> Iterator[tuple[str, Any, Any]]:
    """Yield each field, what the manifest says there, and what it is."""
    scene, proof = solution.scene, solution.proof
    for name, value in (
        ("title", scene.title),
        ("source", scene.source),
        ("flags", list(scene.flags)),
    ):
        yield name, manifest[name], value
    for name, said in manifest["generator"].items():
        yield f"generator.{name}", said, version(name) if name in PACKAGES else DATA_VERSION

    making = Making.of(manifest["command"])
    yield "the engine of command", making.engine, solution.run.engine
    if proof is not None:
        yield "the audit of command", making.audit, proof.audited
        yield "the confirmation of command", making.confirm, proof.confirmed
        yield "the function of command", making.function, proof.enclosure.function is not None

    for name in RUN:
        yield f"run.{name}", manifest["run"][name], getattr(solution.run, name)
    records = manifest["cross_checks"]
    yield "the number of cross_checks", len(records), len(solution.checks)
    for k, (record, check) in enumerate(zip(records, solution.checks, strict=False)):
        for name in (*RUN, *GAPS):
            yield f"cross_checks[{k}].{name}", record[name], getattr(check, name)

    facts = {} if proof is None else _facts(proof)
    record = manifest["enclosure"] or {}
    for name in {**record, **facts}:
        yield f"enclosure.{name}", record.get(name), facts.get(name)


def _facts(proof: Proof) -> dict[str, Any]:
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


def _text(value: Any) -> str:
    return rounded_up(value) if isinstance(value, Fraction) else str(value)


def _says(said: Any, value: Any) -> bool:
    """Return whether a field says a value; of a fraction it says two digits, rounded up."""
    if isinstance(value, Fraction) and said is not None:
        return value <= Fraction(said) <= value * ROUNDED_UP
    return bool(said == value)
