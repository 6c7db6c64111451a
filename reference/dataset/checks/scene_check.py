"""Check manifest and tables against the scene, and each with itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise

from ...errors import LONGEST_VALUE
from ...model.algebra import dot
from ...model.formulations import FORMULATIONS
from ...model.start import Start, xdot_vanishes
from ...numbers.columns import GRID, STATE
from ...numbers.precision import GUARD_BITS, bits_of, decimals_for, to_fraction
from ...plain_text import shortened
from ...solver.solution import exact_decimals
from ...system.imports import missing
from ..files import DatasetFiles
from ..making import ENGINE, Making, command, options_in
from ..manifest import FUNCTION, MANIFEST, CrossCheckRecord, Kind, Manifest, differences
from ..place import changes_in, dataset_id, shipped_scene
from ..record import bounds_of, completeness, equations_of, following
from ..render import derived_texts
from ..sheets import NUMBERS, Sheet, by_field

_PREC = 128  # bits; only exact zeros matter here
_SLACK = Fraction(11, 10)  # bounds are rounded up to two digits
# a column is noise, and has no digits of its own, if no number is this many times its bound
_SIGNIFICANT = 8
_BOUNDED = ("position_m", "velocity_m_s", "transit_s")  # what a run or a proof may be off in
_HALF = Fraction(1, 2)


def unchecked() -> list[str]:
    """Return what cannot be checked here: heyoka, which writes the equations, is not everywhere."""
    return ["the equations (they need heyoka)"] if missing(["heyoka"]) else []


def table_problems(files: DatasetFiles) -> Iterator[str]:
    """Yield a sentence for every problem of the tables, by themselves or with the scene."""
    yield from _times(files)
    yield from _release(files)
    yield from _digits(files)
    yield from _doubles(files, "grid")
    yield from _doubles(files, "transits")
    if files.manifest.counts.transits:
        yield from _order(files, files.tables["transits.csv"])
        yield from _bound_column(files, files.tables["transits.csv"])


def _times(files: DatasetFiles) -> Iterator[str]:
    """Check that the grid has the scene's times, exactly."""
    times = files.scene.exact.grid
    if [Fraction(row[0]) for row in files.tables["grid.csv"].rows] != times:
        yield "grid.csv: the times are not those of the scene"
    elif files.manifest.decimals["grid"]["t"] != exact_decimals(tuple(times)):
        yield f"{MANIFEST}: decimals of the grid's t do not follow from the scene"


def _release(files: DatasetFiles) -> Iterator[str]:
    """Check that the first row is the scene's exact release."""
    start = Start.of(files.scene.exact, bits_of(2 * files.manifest.digits) + GUARD_BITS)
    released = [to_fraction(start.ctx.mpf(part)) for part in (*start.position, *start.velocity)]
    printed = next(files.tables["grid.csv"].numbers(STATE))
    for name, value, number in zip(STATE, released, printed, strict=True):
        if abs(number - value) > files.manifest.bound("grid", name):
            yield f"grid.csv: {name} of the first row is not that of the scene's release"


def _digits(files: DatasetFiles) -> Iterator[str]:
    """Check that the largest number of each column of the grid has the digits asked for."""
    sheet = files.tables["grid.csv"]
    manifest = files.manifest
    for name in GRID:
        largest = max(abs(number) for (number,) in sheet.numbers((name,)))
        bound = manifest.bound("grid", name)
        fewest = decimals_for(largest + bound, manifest.digits)
        if largest > _SIGNIFICANT * bound and manifest.decimals["grid"][name] < fewest:
            yield f"{MANIFEST}: decimals: {name} of grid has fewer than {manifest.digits} digits"


def _doubles(files: DatasetFiles, kind: Kind) -> Iterator[str]:
    """Check that each double is the nearest to some number within the bound of the decimal."""
    plain = files.tables.get(f"{kind}.csv")
    doubles = files.tables.get(f"{kind}.binary64.csv")
    if plain is None or doubles is None or not plain.rows:
        return
    name_of_file = f"{kind}.binary64.csv"
    for name in NUMBERS[kind]:
        place = plain.header.index(name)
        hex_place = len(plain.header) + NUMBERS[kind].index(name)
        bounds = _bounds_by_row(files, kind, name, plain)
        for row, double_row, bound in zip(plain.rows, doubles.rows, bounds, strict=True):
            text = double_row[place]
            double = float(text)
            hexfloat = double_row[hex_place]
            if double.hex() != hexfloat or not _may_be_nearest(double, Fraction(row[place]), bound):
                yield f"{name_of_file}: {name} = {text} is not the double nearest to {row[place]}"
            elif f"{double:.16e}" != text:
                yield f"{name_of_file}: {name} = {text} is not written with the digits of {double!r}"

    exact_places = [i for i, name in enumerate(plain.header) if name not in NUMBERS[kind]]
    for row, double_row in zip(plain.rows, doubles.rows, strict=True):
        if any(row[i] != double_row[i] for i in exact_places):
            yield f"{name_of_file}: row {row[0]} has another direction, number or bound than {kind}.csv"


def _bounds_by_row(files: DatasetFiles, kind: Kind, name: str, sheet: Sheet) -> list[Fraction]:
    """Return the bound on a column's number in each row.

    Times of the grid are exact; the time of a transit has a bound of its own.
    """
    if name == "t" and kind == "transits":
        return [Fraction(row[-1]) for row in sheet.rows]
    bound = Fraction(0) if name == "t" else files.manifest.bound(kind, name)
    return [bound] * len(sheet.rows)


def _may_be_nearest(double: float, value: Fraction, bound: Fraction) -> bool:
    """Return whether a double is the nearest to some number within a bound of a value."""
    return float(value - bound) <= double <= float(value + bound)


def _order(files: DatasetFiles, transits: Sheet) -> Iterator[str]:
    """Check that transits count from 1, lie in (0, t_end] in order, and alternate.

    The signs of vx on the grid must agree.
    """
    times, bounds, directions = zip(*transits.numbers(("t", "bound", "direction")), strict=True)
    if [row[0] for row in transits.rows] != [str(k) for k in range(1, len(times) + 1)]:
        yield "transits.csv: k does not count from 1"
    if times[0] <= -bounds[0] or times[-1] > files.scene.exact.t_end + bounds[-1]:
        yield "transits.csv: a transit lies outside (0, t_end]"
    for k in range(1, len(times)):
        if times[k] - times[k - 1] < -(bounds[k - 1] + bounds[k]):
            yield f"transits.csv: transits {k} and {k + 1} are not in order"
    if files.manifest.transits != "complete":
        return
    for k, (before, after) in enumerate(pairwise(directions), 1):
        if before == after:
            yield f"transits.csv: transits {k} and {k + 1} do not alternate"
    yield from _signs_on_grid(files, times, bounds, directions)


def _signs_on_grid(
    files: DatasetFiles,
    times: Sequence[Fraction],
    bounds: Sequence[Fraction],
    directions: Sequence[Fraction],
) -> Iterator[str]:
    """Check the sign of vx between transits, in grid rows where the bounds leave it certain."""
    vx_bound = files.manifest.bound("grid", "vx")
    passed = 0
    _, *rows = files.tables["grid.csv"].numbers(("t", "vx"))
    for t, vx in rows:
        while passed < len(times) and times[passed] <= t:
            passed += 1
        expected = directions[passed - 1] if passed else -directions[0]
        if abs(vx) <= vx_bound or vx * expected >= 0:
            continue
        neighbours = [k for k in (passed - 1, passed) if 0 <= k < len(times)]
        if not any(abs(times[k] - t) <= bounds[k] for k in neighbours):
            yield f"grid.csv: t = {float(t):.17g}: the sign of vx contradicts the transits before it"


def _bound_column(files: DatasetFiles, transits: Sheet) -> Iterator[str]:
    """Check each bound on a time: at least its rounding, at most what runs or proof leave open."""
    manifest = files.manifest
    half_unit = Fraction(1, 2 * 10 ** manifest.decimals["transits"]["t"])
    gaps = [check.transit_s for check in manifest.cross_checks]
    if manifest.enclosure:
        gaps.append(manifest.enclosure.transit_radius_s)
    distance = 2 * max((Fraction(gap) for gap in gaps if gap is not None), default=Fraction(0))
    error = 2 * manifest.bound("grid", "vx")  # of xdot, and over ax that of the time
    grazing = error * largest_jerk(files)
    for k, (bound, ax) in enumerate(transits.numbers(("bound", "ax")), 1):
        place = f"transits.csv: transit {k}: bound {float(bound):.2g} s"
        if bound < half_unit:
            yield f"{place} is less than half a unit of the last digit"
        elif ax * ax > grazing and bound > _SLACK * (half_unit + max(distance, error / abs(ax))):
            yield f"{place} is more than the runs leave open"
    if max(transits.numbers(("bound",)))[0] != manifest.bound("transits", "t"):
        yield f"{MANIFEST}: bounds.transits.t is not the largest bound of transits.csv"


def largest_jerk(files: DatasetFiles) -> Fraction:
    """Return a bound on the rate of xddot in m/s³; where ax is small compared with it, xdot may only touch zero.

    With p for the pull, w = 2 |Ω| + γ, and v for the largest speed over l, which follows from h at
    the release and drag can only lower, it is 8 l (p + v² + w²) (v + w).
    """
    start = Start.of(files.scene.exact, GUARD_BITS)
    ctx = start.ctx
    k = start.k
    pull = ctx.norm(k.pull)
    w = 2 * abs(k.rate) + k.drag
    v = ctx.sqrt(ctx.norm(start.v) ** 2 + 2 * (pull - dot(start.n, k.pull) + k.rate**2))
    return to_fraction(8 * k.length * (pull + v**2 + w**2) * (v + w))


def problems(files: DatasetFiles) -> Iterator[str]:
    """Yield a sentence for everything in manifest, page and vectors that does not follow from scene and tables."""
    manifest = files.manifest
    formulation = manifest.run.formulation
    if formulation not in FORMULATIONS:
        yield f"{MANIFEST}: run.formulation = {formulation} is not a formulation"
        return
    expected = _expected(files)
    for place, *values in differences(manifest.model_dump(), expected.model_dump()):
        old, new = (shortened(str(value), LONGEST_VALUE) for value in values)
        yield f"{MANIFEST}: {place} = {old} does not follow from the scene and the tables, which give {new}"
    # what is checked below needs them whole
    if manifest.scene != expected.scene or manifest.notes != expected.notes:
        return
    if not _is_its_id(files):
        full_id = dataset_id(files.scene)
        yield f"{MANIFEST}: id = {manifest.id} does not follow from the scene, whose dataset is {full_id}"
    if not _command_follows(files):
        yield f"{MANIFEST}: command does not follow from the scene"
        return
    yield from _possible(files)
    yield from _sections(files)
    yield from _bounds(manifest)
    yield from _evidence(manifest)
    if not manifest.alone:
        yield from _derived(files)


def _expected(files: DatasetFiles) -> Manifest:
    """Return the manifest with everything that follows from scene and tables as it should be."""
    manifest = files.manifest
    scene = files.scene
    run = manifest.run
    vanishes = xdot_vanishes(Start.of(scene.exact, _PREC))
    are_sought = scene.run.transits and not vanishes
    possible = manifest.possible if are_sought else []
    counts = {
        "transits": manifest.counts.transits if are_sought else 0,
        "possible": len(manifest.possible),
    }
    grid = files.tables.get("grid.csv")
    equations = manifest.equations
    if not unchecked():
        equations = equations_of(scene, run.formulation, run.number)
    return manifest.model_copy(
        update={
            **following(scene, grid),
            "equations": equations,
            "level": scene.run.level,
            "digits": scene.run.digits,
            "counts": manifest.counts.model_copy(update=counts),
            "possible": possible,
            "bounds": bounds_of(manifest.bounds.grid, manifest.bounds.transits),
            "transits": completeness(scene, vanishes, bool(manifest.possible)),
        }
    )


def _command_follows(files: DatasetFiles) -> bool:
    """Return whether the command is that of the scene, and makes the files that there are."""
    manifest = files.manifest
    options = options_in(manifest.command)
    if options is None:
        return False
    if manifest.level != "enclosed":
        options = f"{ENGINE} {Making.of(options).engine}"
    making = Making.of(options)
    return (
        making.function == (FUNCTION[0] in manifest.files)
        and making.tables != manifest.alone
        and command(files.scene, manifest.id, options) == manifest.command
    )


def _is_its_id(files: DatasetFiles) -> bool:
    """Return whether an id names the scene's changes.

    Against a shipped scene it names all; for a user's own scene, some fields that it has.
    """
    name = files.manifest.id
    scene = files.scene
    full_id = dataset_id(scene)
    if name == full_id or shipped_scene(scene) is not scene:
        return name == full_id
    # of a user's own scene the fields before the changes are not known
    fields = {f"{field}={value}" for field, value in by_field(files.manifest.scene).items()}
    return name.startswith(f"{full_id}+") and fields.issuperset(changes_in(name))


def _possible(files: DatasetFiles) -> Iterator[str]:
    """Check that the possible transits lie in intervals in order."""
    last = Fraction(0)
    for interval in files.manifest.possible:
        low = Fraction(interval.from_s)
        high = Fraction(interval.to_s)
        if not last <= low < high <= files.scene.exact.t_end:
            yield f"{MANIFEST}: possible transits must be intervals in order within (0, t_end]"
        last = high


def _sections(files: DatasetFiles) -> Iterator[str]:
    """Check that `sections.csv` has the scene's sections in order, their rows counted.

    A bound is at least half a unit of the last digit.
    """
    record = files.manifest.sections
    if record is None:
        return
    words = files.scene.run.sections or ()
    if not tuple(record.counts) == tuple(record.possible) == words:
        yield f"{MANIFEST}: sections are not those of the scene: {', '.join(words)}"
    sheet = files.tables.get("sections.csv")
    if sheet is not None:
        numbered = [
            (word, str(k)) for word, count in record.counts.items() for k in range(1, count + 1)
        ]
        if [row[:2] for row in sheet.rows] != numbered:
            yield "sections.csv: its rows are not those that the manifest counts, each section's from 1 on"
    for name, bound in record.bounds.items():
        if Fraction(bound) * 10 ** record.decimals[name] < _HALF:
            yield f"{MANIFEST}: sections.bounds.{name} = {bound} is less than half a unit of the last digit"


def _bounds(manifest: Manifest) -> Iterator[str]:
    """Check that each bound covers the rounding to the printed digits.

    On the grid, and with a proof everywhere, it is at most a unit of the last digit.
    """
    yield from _bounds_in_units(manifest, "grid", manifest.bounds.grid, limited=True)
    is_proved = manifest.enclosure is not None
    yield from _bounds_in_units(manifest, "transits", manifest.bounds.transits, limited=is_proved)


def _bounds_in_units(
    manifest: Manifest, kind: Kind, bounds: dict[str, str], limited: bool
) -> Iterator[str]:
    """Check that bounds are from half a unit of the last digit, if `limited` up to one."""
    for name, bound in bounds.items():
        units = Fraction(bound) * 10 ** manifest.decimals[kind][name]
        if units < _HALF or (limited and units > 1):
            yield f"{MANIFEST}: bounds.{kind}.{name} = {bound} is not from half a unit to one of the last digit"


def _evidence(manifest: Manifest) -> Iterator[str]:
    """Check the level against its evidence: other runs, or a proof, as close as the bounds say."""
    checks = manifest.cross_checks
    run = manifest.run
    confirming = [check for check in checks if check.formulation != run.formulation]
    if manifest.level == "confirmed" and not confirming:
        yield f"{MANIFEST}: level = confirmed, and no cross-check is in another formulation"
    if manifest.level == "self_consistent" and all(
        (check.formulation, check.number) == (run.formulation, run.number) for check in checks
    ):
        yield f"{MANIFEST}: level = self_consistent, and no cross-check differs from the run"
    if manifest.enclosure is not None:
        yield from _confirmation(manifest, confirming)
        yield from _radii(manifest)
    for check in checks:
        if check.formulation not in FORMULATIONS:
            yield f"{MANIFEST}: cross_checks: {check.formulation} is no formulation"
        if manifest.enclosure is None:  # a proof needs no close second run
            yield from _too_far(check, manifest)


def _confirmation(manifest: Manifest, confirming: list[CrossCheckRecord]) -> Iterator[str]:
    """Check that the runs in another formulation confirm as much of a proof as the command says."""
    confirm = Making.of(manifest.command).confirm
    close = [check for check in confirming if not any(_too_far(check, manifest))]
    match confirm:
        case "whole":
            sees_transits = any(check.transit_s for check in close)
            shown = bool(close) and (sees_transits or manifest.transits != "complete")
        case "sampled":
            shown = any(not check.transit_s for check in close)  # a sample sees no transits
        case "none":
            shown = True
    if not shown:
        yield f"{MANIFEST}: the cross-checks do not show the confirmation that the command names: {confirm}"


def _radii(manifest: Manifest) -> Iterator[str]:
    """Check that the radii of a proof are within the bounds."""
    proof = manifest.enclosure
    if proof is None:
        return
    radii = (proof.position_radius_m, proof.velocity_radius_m_s, proof.transit_radius_s)
    for name, radius in zip(_BOUNDED, radii, strict=True):
        bound = getattr(manifest.bounds, name)
        if radius is not None and bound and Fraction(radius) > _SLACK * Fraction(bound):
            yield f"{MANIFEST}: enclosure: the radius {radius} is more than bounds.{name} = {bound}"


def _too_far(check: CrossCheckRecord, manifest: Manifest) -> Iterator[str]:
    """Yield where a run is further from the published one than the bounds allow."""
    for name in _BOUNDED:
        gap = getattr(check, name)
        bound = getattr(manifest.bounds, name)
        if gap is not None and bound and Fraction(gap) > Fraction(bound):
            yield f"{MANIFEST}: cross_checks: the runs differ by {gap}, more than bounds.{name} = {bound}"


def _derived(files: DatasetFiles) -> Iterator[str]:
    """Check the files that follow from manifest and tables, to the byte."""
    for name, text in derived_texts(files.manifest, files.tables).items():
        if name in files.texts and files.texts[name] != text:
            yield f"{name}: does not follow from the manifest and the tables"
