"""The manifest of a solution, before its files are known: scene, run, bounds, checks and proof."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from fractions import Fraction
from importlib.metadata import PackageNotFoundError, version
from typing import Any

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
_UNIT_OF = {", ".join(kind): unit for kind, unit in UNITS.items()}
_UNIT_OF |= {"bound": "s", "angles": "degrees"}
PACKAGES = ("heyoka", "mpmath", "numba", "numpy", "python-flint")
INVARIANT_BITS = 96  # beyond the digits: (R Ω)²/2 is about 5e4 m²/s², h of a small swing far less


def manifest_of(
    solution: Solution, sheets: Mapping[str, Sheet], name: str | None, tables: bool
) -> Manifest:
    """Return the manifest of a solution, without the records of its files and without its seal.

    Args:
        solution: what is described.
        sheets: its tables, by file name.
        name: the dataset's id, by default the scene's own.
        tables: whether they are written; else the command says that they are left out.
    """
    scene = solution.scene
    run = solution.run
    name = name or dataset_id(scene)
    grid = sheets["grid.csv"]
    transits = sheets.get("transits.csv", Sheet((), [], {}))
    transits_bounds = {}
    if transits.rows:
        transits_bounds = column_bounds(solution.transits, transits.decimals)
    counts = Counts(
        grid=len(grid.rows), transits=len(transits.rows), possible=len(solution.possible)
    )
    sections = None
    if "sections.csv" in sheets:
        sections = _sections(solution, sheets["sections.csv"])
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
        bounds=bounds_of(column_bounds(solution.grid, grid.decimals), transits_bounds),
        counts=counts,
        transits=completeness(scene, XDOT not in solution.zeros, bool(solution.possible)),
        possible=_possible(solution.possible, grid.rows[-1][0]),
        run=RunRecord.model_validate(run),
        cross_checks=[CrossCheckRecord.model_validate(check) for check in solution.checks],
        enclosure=_enclosure(solution.proof) if solution.proof else None,
        generator=generator(),
        command=command(scene, name, _options(solution, name, tables)),
        files={},
        sections=sections,
        equations=equations_of(scene, run.formulation, run.number),
        **following(scene, grid),
    )


def _options(solution: Solution, name: str, tables: bool) -> str:
    """Return the options in the dataset's command that say how it is made."""
    engine = solution.run.engine
    proof = solution.proof
    if proof is None:
        return f"{ENGINE} {engine}"
    making = Making(
        engine=engine,
        audit=proof.audited,
        confirm=proof.confirmed,
        function=proof.enclosure.function is not None,
        tables=tables,
    )
    return making.options_for(solution.scene, name)


def _possible(intervals: Iterable[tuple[Fraction, Fraction, str]], end: str) -> list[Possible]:
    """Return intervals rounded outwards, but not beyond the end of the run, `end`."""
    records = []
    for interval in open_intervals(intervals):
        to_s = min(interval["to_s"], end, key=Fraction)
        records.append(Possible.model_validate({**interval, "to_s": to_s}))
    return records


def _sections(solution: Solution, sheet: Sheet) -> SectionsRecord:
    """Return what a manifest says of `sections.csv`."""
    end = fixed_decimal(solution.times[-1], exact_decimals(solution.times[-1:]))
    bounds: dict[str, str] = {}
    counts = {}
    possible = {}
    for word, passages in solution.sections.items():
        counts[word] = len(passages.table)
        possible[word] = _possible(passages.possible, end)
        if sheet.rows:
            for column, bound in column_bounds(passages.table, sheet.decimals).items():
                bounds[column] = max(bounds.get(column, "0"), bound, key=Fraction)
    return SectionsRecord(decimals=sheet.decimals, bounds=bounds, counts=counts, possible=possible)


def equations_of(scene: Scene, formulation: str, number: str) -> Equations:
    """Return the equations that heyoka compiles for a scene, and what it leaves out of them."""
    from ..engines.heyoka.system import lines_and_left_out

    lines, left_out = lines_and_left_out(scene, formulation, number)
    return Equations(formulation=formulation, lines=lines, left_out=left_out)


def following(scene: Scene, grid: Sheet | None) -> dict[str, Any]:
    """Return the fields of a manifest that follow from scene and grid."""
    up = _UP[scene.site.gravity_is]
    fields: dict[str, Any] = {
        "notes": flag_meanings(scene.flags),
        "scene": scene_inputs(scene),
        "frame": f"topocentric, axes x east, y north, {up}, origin at the suspension, z < 0 below it",
        "units": _UNIT_OF,
    }
    if grid is not None:
        fields["invariant"] = invariant_drift(scene, grid)
    return fields


def generator() -> dict[str, str]:
    """Return the versions of the data and of the libraries that the bytes depend on.

    The version of the code is not among them: a release that changes no digit changes no dataset.
    """
    versions = {"foucault-data": DATA_VERSION}
    for name in PACKAGES:
        with suppress(PackageNotFoundError):
            versions[name] = version(name)
    return versions


def bounds_of(grid: dict[str, str], transits: dict[str, str]) -> Bounds:
    """Return the bounds of columns, and the largest of each kind."""
    positions = [grid[name] for name in POSITION]
    velocities = [grid[name] for name in VELOCITY]
    return Bounds(
        position_m=max(positions, key=Fraction),
        velocity_m_s=max(velocities, key=Fraction),
        transit_s=transits.get("t"),
        grid=grid,
        transits=transits,
    )


def completeness(scene: Scene, vanishes: bool, undecided: bool) -> Any:
    """Return what a manifest says of its transits: "complete", or why they are not."""
    if not scene.run.transits:
        return "not asked for"
    if vanishes:
        return "xdot is identically zero"
    return "undecided intervals" if undecided else "complete"


def _enclosure(proof: Proof) -> EnclosureRecord:
    """Return what a manifest says of a proof."""
    enclosure = proof.enclosure
    return EnclosureRecord.model_validate(
        {
            "method": enclosure.method,
            "prec": enclosure.bits,
            "order": enclosure.order,
            "steps": enclosure.steps,
            "position_radius_m": enclosure.position_radius,
            "velocity_radius_m_s": enclosure.velocity_radius,
            "transit_radius_s": proof.transit_radius,
            "agreement_bits": proof.agreement_bits,
        }
    )


def invariant_drift(scene: Scene, grid: Sheet) -> Invariant:
    """Return h of the first row in m²/s², and its largest change over the rows, rounded up."""
    # many names, as each is a quantity of one formula
    bits = bits_of(scene.run.digits) + INVARIANT_BITS
    k = constants(scene.exact, context(bits)).converted(lambda number: FixedPoint.of(number, bits))
    states, unit = grid.scaled_integers(STATE)
    x, y, z, vx, vy, vz = (FixedPoint.column(column, unit, bits) / k.length for column in states)
    h: FixedPoint = invariant((x, y, z), (vx, vy, vz), k)
    values = h.fractions()
    first = values[0]
    drift = max(abs(value - first) for value in values)
    return Invariant.model_construct(
        h_m2_s2=fixed_decimal(first, scene.run.digits), drift_m2_s2=rounded_up(drift)
    )
