"""How a dataset is made, and its manifest: what was solved, how, to which bounds, what agrees; without its files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from fractions import Fraction
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from ..engines.heyoka.system import lines_and_left_out
from ..model.constants import constants
from ..model.force import invariant
from ..numbers.columns import POSITION, STATE, UNITS, VELOCITY
from ..numbers.precision import bits_of, context, fixed_decimal, rounded_up
from ..numbers.table import FixedPoint
from ..numbers.zeros import XDOT
from ..scenes.scene import Scene
from ..scenes.shipped import DATA_VERSION, flag_meanings
from ..solver.solution import Proof, Solution, exact_decimals
from .making import ENGINE, Making, command
from .manifest import (
    Bounds,
    Counts,
    CrossCheckRecord,
    EnclosureRecord,
    Equations,
    Invariant,
    Manifest,
    Possible,
    RunRecord,
    SectionsRecord,
)
from .place import dataset_id
from .sheets import Sheet, column_bounds, open_intervals, scene_inputs

_UP = {"ellipsoid": "z up", "effective": "z up along the plumb line"}
UNIT_OF = {", ".join(kind): unit for kind, unit in UNITS.items()} | {
    "bound": "s",
    "angles": "degrees",
}
PACKAGES = ("heyoka", "mpmath", "numba", "numpy", "python-flint")
INVARIANT_BITS = 96  # beyond the digits: (R Ω)²/2 is about 5e4 m²/s², h of a small swing far less


def manifest_of(
    solution: Solution, sheets: Mapping[str, Sheet], name: str | None, tables: bool
) -> Manifest:
    """Return the manifest of a solution, still without files and seal.

    Args:
        solution: what is described.
        sheets: its tables, by file name.
        name: the dataset's id, by default the scene's own.
        tables: whether they are written; else the command says that they are left out.
    """
    grid, transits = sheets["grid.csv"], sheets.get("transits.csv", Sheet((), [], {}))
    scene, run, proof = solution.scene, solution.run, solution.proof
    name = name or dataset_id(scene)
    options = f"{ENGINE} {run.engine}"
    if proof is not None:
        making = Making(
            run.engine, proof.audited, proof.confirmed, proof.enclosure.function is not None, tables
        )
        options = making.options_for(scene, name)
    of_transits = column_bounds(solution.transits, transits.decimals) if transits.rows else {}
    end = grid.rows[-1][0]
    return Manifest.model_construct(
        schema_version=3,
        seal="",
        id=name,
        title=scene.title,
        source=scene.source,
        flags=list(scene.flags),
        inputs=scene.inputs,
        level=scene.run.level,
        digits=scene.run.digits,
        decimals={"grid": grid.decimals, "transits": transits.decimals},
        bounds=bounds_of(column_bounds(solution.grid, grid.decimals), of_transits),
        counts=Counts(
            grid=len(grid.rows), transits=len(transits.rows), possible=len(solution.possible)
        ),
        transits=completeness(scene, XDOT not in solution.zeros, bool(solution.possible)),
        possible=_possible(solution.possible, end),
        run=RunRecord.model_validate(run),
        cross_checks=[CrossCheckRecord.model_validate(check) for check in solution.checks],
        enclosure=None if proof is None else _enclosure(proof),
        generator=generator(),
        command=command(scene, name, options),
        files={},
        sections=_sections(solution, sheets["sections.csv"]) if "sections.csv" in sheets else None,
        **following(scene, run.formulation, run.number, grid),
    )


def _possible(intervals: Iterable[tuple[Fraction, Fraction, str]], end: str) -> list[Possible]:
    """Return intervals rounded outwards, but not beyond the end of the run, which the last row prints exactly."""
    texts = open_intervals(intervals)
    return [
        Possible.model_validate(part | {"to_s": min(part["to_s"], end, key=Fraction)})
        for part in texts
    ]


def _sections(solution: Solution, sheet: Sheet) -> SectionsRecord:
    """Return what a manifest says of `sections.csv`."""
    named, bounds = solution.sections.items(), dict[str, str]()
    end = fixed_decimal(solution.times[-1], exact_decimals(solution.times[-1:]))
    for _, passages in named if sheet.rows else ():
        of_section = column_bounds(passages.table, sheet.decimals)
        bounds = {
            column: max(bounds.get(column, "0"), bound, key=Fraction)
            for column, bound in of_section.items()
        }
    return SectionsRecord(
        decimals=sheet.decimals,
        bounds=bounds,
        counts={word: len(passages.table) for word, passages in named},
        possible={word: _possible(passages.possible, end) for word, passages in named},
    )


def following(scene: Scene, formulation: str, number: str, grid: Sheet | None) -> dict[str, Any]:
    """Return the fields of a manifest that follow from its scene, its run's formulation and number, and its grid."""
    lines, left_out = lines_and_left_out(scene, formulation, number)
    up = _UP[scene.site.gravity_is]
    return {
        "notes": flag_meanings(scene.flags),
        "scene": scene_inputs(scene),
        "frame": f"topocentric, axes x east, y north, {up}, origin at the suspension, z < 0 below it",
        "units": UNIT_OF,
        "equations": Equations(formulation=formulation, lines=lines, left_out=left_out),
        **({"invariant": invariant_drift(scene, grid)} if grid is not None else {}),
    }


def generator() -> dict[str, str]:
    """Return the version of the data, and those of the installed libraries that the bytes depend on.

    The version of the code is not among them: a release that changes no digit changes no dataset.
    """
    versions = {"foucault-data": DATA_VERSION}
    for name in PACKAGES:
        with suppress(PackageNotFoundError):
            versions[name] = version(name)
    return versions


def bounds_of(grid: dict[str, str], transits: dict[str, str]) -> Bounds:
    """Return the bounds of columns, and the largest of each kind."""
    return Bounds(
        position_m=max((grid[name] for name in POSITION), key=Fraction),
        velocity_m_s=max((grid[name] for name in VELOCITY), key=Fraction),
        transit_s=transits.get("t"),
        grid=grid,
        transits=transits,
    )


def completeness(scene: Scene, vanishes: bool, undecided: bool) -> Any:
    """Return a manifest's word on its transits: whether all are there, and otherwise why not."""
    if not scene.run.transits:
        return "not asked for"
    if vanishes:
        return "xdot is identically zero"
    return "undecided intervals" if undecided else "complete"


def _enclosure(proof: Proof) -> EnclosureRecord:
    enclosure = proof.enclosure
    record = {
        "method": enclosure.method,
        "prec": enclosure.bits,
        "order": enclosure.order,
        "steps": enclosure.steps,
    }
    record |= {
        "position_radius_m": enclosure.position_radius,
        "velocity_radius_m_s": enclosure.velocity_radius,
    }
    record |= {"transit_radius_s": proof.transit_radius, "agreement_bits": proof.agreement_bits}
    return EnclosureRecord.model_validate(record)


def invariant_drift(scene: Scene, grid: Sheet) -> Invariant:
    """Return h of the first printed row in m²/s², and its largest change over the rows (rounded up)."""
    bits = bits_of(scene.run.digits) + INVARIANT_BITS
    k = constants(scene.exact, context(bits)).converted(lambda number: FixedPoint.of(number, bits))
    states, unit = grid.integers(STATE)
    x, y, z, vx, vy, vz = (FixedPoint.column(column, unit, bits) / k.length for column in states)
    h: FixedPoint = invariant((x, y, z), (vx, vy, vz), k)
    values = h.fractions()
    drift = rounded_up(max(abs(value - values[0]) for value in values))
    return Invariant.model_construct(
        h_m2_s2=fixed_decimal(values[0], scene.run.digits), drift_m2_s2=drift
    )
