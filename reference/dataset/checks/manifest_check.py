"""Check a manifest against its scene: all that follows from the scene is made again and compared."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ...errors import LONGEST_VALUE, shortened
from ...model.formulations import FORMULATIONS
from ...model.start import Start, xdot_vanishes
from ..files import Files
from ..manifest import FUNCTION, MANIFEST, CrossCheckRecord, Manifest, differences
from ..place import changes_in, dataset_id, shipped_scene
from ..record import ENGINE, OPTIONS, Making, bounds_of, command, completeness, following
from ..render import derived_texts
from ..sheets import by_field
from .tables import SLACK

PREC = 128  # bits; only exact zeros matter here


def problems(files: Files) -> Iterator[str]:
    """Yield what of a manifest, of the page and of the vectors does not follow from the scene and the tables."""
    manifest, scene, run = files.manifest, files.scene, files.manifest.run
    if run.formulation not in FORMULATIONS:
        yield f"{MANIFEST}: run.formulation = {run.formulation} is none"
        return
    vanishes = xdot_vanishes(Start.of(scene.exact, PREC))
    counts, possible, sought = manifest.counts, manifest.possible, scene.run.transits and not vanishes
    made = manifest.model_copy(
        update={
            **following(scene, run.formulation, run.number, files.tables.get("grid.csv")),
            "level": scene.run.level,
            "digits": scene.run.digits,
            "counts": counts.model_copy(update={"transits": counts.transits * sought, "possible": len(possible)}),
            "possible": possible * sought,
            "bounds": bounds_of(manifest.bounds.grid, manifest.bounds.transits),
            "transits": completeness(scene, vanishes, bool(possible)),
        }
    )
    for place, *both in differences(manifest.model_dump(), made.model_dump()):
        old, new = (shortened(str(value), LONGEST_VALUE) for value in both)
        yield f"{MANIFEST}: {place} = {old} does not follow from the scene and the tables, which give {new}"
    if (manifest.scene, manifest.notes) != (made.scene, made.notes):  # what is checked below needs them whole
        return
    if not _is_its_id(files):
        yield f"{MANIFEST}: id = {manifest.id} does not follow from the scene, whose dataset is {dataset_id(scene)}"
    said = OPTIONS.search(manifest.command)
    options = said and (said[0] if manifest.level == "enclosed" else f"{ENGINE} {said[1]}")
    if (
        not options
        or (FUNCTION[0] in manifest.files) != Making.of(options).function
        or manifest.alone == Making.of(options).tables
        or command(scene, manifest.id, options) != manifest.command
    ):
        yield f"{MANIFEST}: command does not follow from the scene"
        return
    yield from _possible(files)
    yield from _sections(files)
    yield from _bounds(manifest)
    yield from _evidence(manifest)
    if not manifest.alone:
        yield from _derived(files)


def _is_its_id(files: Files) -> bool:
    """Return whether an id names the scene's changes: all against a shipped scene, else some that the scene has."""
    name, scene, full_id = files.manifest.id, files.scene, dataset_id(files.scene)
    if name == full_id or shipped_scene(scene) is not scene:
        return name == full_id
    # of a user's own scene the fields before the changes are not known
    fields = {f"{field}={value}" for field, value in by_field(files.manifest.scene).items()}
    return name.startswith(f"{full_id}+") and fields.issuperset(changes_in(name))


def _possible(files: Files) -> Iterator[str]:
    last = Fraction(0)
    for interval in files.manifest.possible:
        low, high = Fraction(interval.from_s), Fraction(interval.to_s)
        if not last <= low < high <= files.scene.exact.t_end:
            yield f"{MANIFEST}: possible transits must be intervals in order within (0, t_end]"
        last = high


def _sections(files: Files) -> Iterator[str]:
    """Check that `sections.csv` has the scene's sections in order, their rows counted, with bounds of their digits."""
    said, sheet = files.manifest.sections, files.tables.get("sections.csv")
    if said is None:
        return
    words = files.scene.run.sections or ()
    if not tuple(said.counts) == tuple(said.possible) == words:
        yield f"{MANIFEST}: sections are not those of the scene: {', '.join(words)}"
    if sheet and [row[:2] for row in sheet.rows] != [
        (w, str(k)) for w, n in said.counts.items() for k in range(1, n + 1)
    ]:
        yield "sections.csv: its rows are not those that the manifest counts, each section's from 1 on"
    for name, bound in said.bounds.items():
        if Fraction(bound) * 10 ** said.decimals[name] < Fraction(1, 2):
            yield f"{MANIFEST}: sections.bounds.{name} = {bound} is less than half a unit of the last digit"


def _bounds(manifest: Manifest) -> Iterator[str]:
    """Check that each bound covers the rounding to the printed digits, and leaves only the last of them open."""
    for kind in ("grid", "transits"):
        for name, bound in getattr(manifest.bounds, kind).items():
            units = Fraction(bound) * 10 ** manifest.decimals[kind][name]
            if units < Fraction(1, 2) or (units > 1 and (kind == "grid" or manifest.enclosure)):
                yield f"{MANIFEST}: bounds.{kind}.{name} = {bound} is not from half a unit to one of the last digit"


def _evidence(manifest: Manifest) -> Iterator[str]:
    """Check the level against what stands behind it: other runs, or a proof, as close as the bounds say."""
    checks, bounds, run, proof = manifest.cross_checks, manifest.bounds, manifest.run, manifest.enclosure
    if manifest.level == "confirmed" and all(check.formulation == run.formulation for check in checks):
        yield f"{MANIFEST}: level = confirmed, and no cross-check is in another formulation"
    same_run = [(check.formulation, check.number) == (run.formulation, run.number) for check in checks]
    if manifest.level == "self_consistent" and all(same_run):
        yield f"{MANIFEST}: level = self_consistent, and no cross-check differs from the run"
    others = [check for check in checks if check.formulation != run.formulation]
    if proof is not None:
        close = [check for check in others if not any(_too_far(check, manifest))]
        seen = manifest.transits != "complete" or any(check.transit_s for check in close)  # a sample sees no transits
        said = Making.of(manifest.command).confirm
        if not {"whole": close and seen, "sampled": any(not check.transit_s for check in close), "none": True}[said]:
            yield f"{MANIFEST}: the cross-checks do not show the confirmation that the command names: {said}"
    for check in checks:
        if check.formulation not in FORMULATIONS:
            yield f"{MANIFEST}: cross_checks: {check.formulation} is no formulation"
        if proof is None:  # a proof needs no close second run
            yield from _too_far(check, manifest)
    if proof is not None:
        radii = {
            "position_m": proof.position_radius_m,
            "velocity_m_s": proof.velocity_radius_m_s,
            "transit_s": proof.transit_radius_s,
        }
        for name, radius in radii.items():
            if radius is not None and (bound := getattr(bounds, name)) and Fraction(radius) > SLACK * Fraction(bound):
                yield f"{MANIFEST}: enclosure: the radius {radius} is more than bounds.{name} = {bound}"


def _too_far(check: CrossCheckRecord, manifest: Manifest) -> Iterator[str]:
    """Yield where a run is further from the published one than the bounds allow."""
    for name in ("position_m", "velocity_m_s", "transit_s"):
        gap, bound = getattr(check, name), getattr(manifest.bounds, name)
        if gap is not None and bound and Fraction(gap) > Fraction(bound):
            yield f"{MANIFEST}: cross_checks: the runs are {gap} apart, more than bounds.{name} = {bound}"


def _derived(files: Files) -> Iterator[str]:
    """Check the files that follow from manifest and tables, to the byte."""
    for name, text in derived_texts(files.manifest, files.tables).items():
        if name in files.texts and files.texts[name] != text:
            yield f"{name}: does not follow from the manifest and the tables"
