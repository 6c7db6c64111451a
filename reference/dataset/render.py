"""Every file of a dataset as text: manifest, CSV tables and page; the same solution gives the same bytes."""

from __future__ import annotations

import hashlib
from fractions import Fraction
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from ..columns import POSITION, UNITS, VELOCITY
from ..engines.equations import lines_and_left_out
from ..precision import outward, rounded_up
from ..scene import Scene, load_scene
from ..shipped import scene_ids
from ..solver.solution import Solution
from .certified import certified_page
from .manifest import (
    Bounds,
    Counts,
    CrossCheckRecord,
    EnclosureRecord,
    Equations,
    FileRecord,
    Invariant,
    Manifest,
    Possible,
    RunRecord,
)
from .read import MANIFEST
from .sheets import binary64_sheet, grid_bound, grid_sheet, scene_inputs, transits_sheet
from .verify import invariant_drift

FRAME = "topocentric, axes x east, y north, z up, origin at the suspension, z < 0 below it"


def render(solution: Solution) -> dict[str, str]:
    """Return the text of every file of a dataset, by file name."""
    grid, transits = grid_sheet(solution), transits_sheet(solution)
    scene, run = solution.scene, solution.run
    bounds = Bounds(
        position_m=grid_bound(solution, POSITION),
        velocity_m_s=grid_bound(solution, VELOCITY),
        transit_s=max((row[-1] for row in transits.rows), key=Fraction, default=None),
    )
    completeness = _completeness(solution)
    files = {
        "grid.csv": grid.csv(),
        "transits.csv": transits.csv(),
        "grid.binary64.csv": binary64_sheet(grid).csv(),
        "transits.binary64.csv": binary64_sheet(transits).csv(),
        "certified.txt": certified_page(solution, grid, transits, bounds, completeness),
    }
    lines, left_out = lines_and_left_out(scene, run.formulation)
    initial, drift = invariant_drift(scene, grid)
    manifest = Manifest(
        schema_version=1,
        id=scene.id,
        title=scene.title,
        source=scene.source,
        flags=list(scene.flags),
        scene=scene_inputs(scene),
        inputs=scene.inputs,
        frame=FRAME,
        units={", ".join(kind): unit for kind, unit in UNITS.items()} | {"bound": "s", "angles": "degrees"},
        level=scene.run.level,
        digits=scene.run.digits,
        decimals={"grid": grid.decimals, "transits": transits.decimals},
        bounds=bounds,
        counts=Counts(grid=len(grid.rows), transits=len(transits.rows), possible=len(solution.possible)),
        transits=completeness,
        possible=[
            Possible(from_s=outward(a, -1), to_s=outward(b, 1), parity=parity) for a, b, parity in solution.possible
        ],
        invariant=Invariant(h_m2_s2=initial, drift_m2_s2=drift),
        equations=Equations(formulation=run.formulation, lines=lines, left_out=left_out),
        run=RunRecord(formulation=run.formulation, number=run.number, order=run.order, steps=run.steps),
        cross_checks=[
            CrossCheckRecord(
                formulation=check.formulation,
                number=check.number,
                order=check.order,
                steps=check.steps,
                position_m=rounded_up(check.position_m),
                velocity_m_s=rounded_up(check.velocity_m_s),
                transit_s=None if check.transit_s is None else rounded_up(check.transit_s),
            )
            for check in solution.checks
        ],
        enclosure=_enclosure_record(solution),
        generator={name: _version(name) for name in ("foucault-reference", "heyoka", "mpmath")},
        command=command(scene, run.engine),
        files={
            name: FileRecord(bytes=len(text.encode()), sha256=hashlib.sha256(text.encode()).hexdigest())
            for name, text in files.items()
        },
    )
    return {MANIFEST: manifest.text(), **files}


def _completeness(solution: Solution) -> Any:
    """Return the manifest's word on its transits: whether all are there, and otherwise why not."""
    if not solution.scene.run.transits:
        return "not asked for"
    if solution.transits is None:
        return "xdot is identically zero"
    return "undecided intervals" if solution.possible else "complete"


def _enclosure_record(solution: Solution) -> EnclosureRecord | None:
    proof = solution.proof
    if proof is None:
        return None
    return EnclosureRecord(
        method=proof.method,
        prec=proof.prec,
        order=proof.order,
        steps=proof.steps,
        position_radius_m=rounded_up(proof.position_radius),
        velocity_radius_m_s=rounded_up(proof.velocity_radius),
        transit_radius_s=None if proof.transit_radius is None else rounded_up(proof.transit_radius),
        agreement_bits=proof.agreement_bits,
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"


def command(scene: Scene, engine: str) -> str:
    """Return the command that makes the dataset: of a shipped scene with its changed fields, or of the scene's file."""
    run, shipped = scene.run, scene.id in scene_ids()
    parts = ["foucault", "generate", scene.id if shipped else f"{scene.id}.toml"]
    parts += ["--t-end", run.t_end, "--digits", str(run.digits), "--level", run.level]
    parts += ["--engine", engine]
    parts += [] if run.transits else ["--no-transits"]
    if shipped:
        parts += [word for change in _changes(scene, load_scene(scene.id)) for word in ("--set", change)]
    return " ".join(parts)


def _changes(scene: Scene, shipped: Scene) -> list[str]:
    """Return the changed fields of a shipped scene as section.key=value, without those that have their own option."""
    before, after = scene_inputs(shipped), scene_inputs(scene)
    changed = [
        f"{section}.{key}={value}"
        for section, table in after.items()
        for key, value in table.items()
        if before[section].get(key) != value and (section != "run" or key == "grid_step")
    ]
    return changed if scene.inputs == shipped.inputs else [*changed, f"inputs={scene.inputs}"]
