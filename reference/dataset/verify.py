"""Verify a golden dataset without integrating: files and hashes, tables, sphere, invariant h and transits."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

from ..columns import STATE, VELOCITY
from ..errors import DatasetError, FoucaultError
from ..model.constants import constants
from ..model.force import invariant
from ..precision import bits_of, context, fixed_decimal, rounded_up, to_fraction, to_mpf
from ..scene import Scene
from .manifest import Manifest
from .read import changed_files, read_manifest, read_table, scene_of
from .sheets import GRID_HEADER, TRANSITS_HEADER, WORDS, Sheet, binary64_sheet

MAX_PROBLEMS = 20  # sentences returned at most
INVARIANT_BITS = 96  # beyond the digits: (R Ω)²/2 is about 5e4 m²/s², h of a small swing far less
TOLERANCE_PREC = 64  # bits of the allowed drift of h, which has one per cent in hand
_NUMBER = re.compile(r"-?\d+(\.\d+)?")


def problems_of(folder: Path) -> list[str]:
    """Return a sentence for each problem of a dataset; empty if it passes every check.

    Raises:
        InputError: there is no dataset at `folder`.
    """
    try:
        manifest = read_manifest(folder)
    except DatasetError as error:
        return error.problems
    problems = changed_files(folder, manifest)
    if problems:
        return problems
    try:
        scene = scene_of(manifest)
    except FoucaultError as error:
        return [f"the manifest's scene is refused: {error}"]
    tables = {name: _sheet(folder / name) for name in manifest.files if name.endswith(".csv")}
    problems = [problem for check in (_shape, _doubles) for problem in check(manifest, tables)]
    if problems:
        return problems[:MAX_PROBLEMS]
    physics: tuple[Callable[[Scene, Manifest, Sheet, Sheet], Iterator[str]], ...] = (_grid, _sphere, _invariant, _zeros)
    grid, transits = tables["grid.csv"], tables["transits.csv"]
    return [p for check in physics for p in check(scene, manifest, grid, transits)][:MAX_PROBLEMS]


def _sheet(path: Path) -> Sheet:
    columns = read_table(path)
    return Sheet(tuple(columns), list(zip(*columns.values(), strict=True)), {})


def _shape(manifest: Manifest, tables: dict[str, Sheet]) -> Iterator[str]:
    """Check headers, counts, and the number of digits after the point."""
    for name, header, count, decimals in (
        ("grid.csv", GRID_HEADER, manifest.counts.grid, manifest.decimals.get("grid", {})),
        ("transits.csv", TRANSITS_HEADER, manifest.counts.transits, manifest.decimals.get("transits", {})),
    ):
        sheet = tables.get(name)
        if sheet is None or sheet.header != header:
            yield f"{name}: the header must be {','.join(header)}"
            continue
        if len(sheet.rows) != count:
            yield f"{name}: {len(sheet.rows)} rows, the manifest counts {count}"
        for number, row in enumerate(sheet.rows, 1):
            for column, text in zip(header, row, strict=True):
                if column not in WORDS and (
                    not _NUMBER.fullmatch(text) or len(text.partition(".")[2]) != decimals.get(column)
                ):
                    yield f"{name}: row {number}, {column} = {text} is not a number of {decimals.get(column)} decimals"


def _doubles(manifest: Manifest, tables: dict[str, Sheet]) -> Iterator[str]:
    """Check that the binary64 tables hold the nearest doubles."""
    for name in ("grid", "transits"):
        if f"{name}.csv" in tables and binary64_sheet(tables[f"{name}.csv"]) != tables.get(f"{name}.binary64.csv"):
            yield f"{name}.binary64.csv: does not hold the nearest doubles of {name}.csv"


def _grid(scene: Scene, manifest: Manifest, grid: Sheet, transits: Sheet) -> Iterator[str]:
    """Check that the grid times are those of the scene."""
    if [Fraction(row[0]) for row in grid.rows] != scene.exact.grid:
        yield "grid.csv: the times are not those of the scene"


def _bounds(manifest: Manifest) -> tuple[Fraction, Fraction]:
    """Return the bounds on position (m) and velocity (m/s)."""
    return Fraction(manifest.bounds.position_m), Fraction(manifest.bounds.velocity_m_s)


def _sphere(scene: Scene, manifest: Manifest, grid: Sheet, transits: Sheet) -> Iterator[str]:
    """Check |r| = l and r·v = 0 to within the bounds."""
    length = scene.exact.length
    dr, dv = _bounds(manifest)
    for row, (x, y, z, vx, vy, vz) in zip(grid.rows, grid.numbers(STATE), strict=True):
        if abs(x * x + y * y + z * z - length**2) > 4 * length * dr + 3 * dr**2:
            yield f"grid.csv: t = {row[0]}: the bob is not at the distance {float(length)} m from the pivot"
        speed = abs(vx) + abs(vy) + abs(vz)
        if abs(x * vx + y * vy + z * vz) > 2 * (speed * dr + 2 * length * dv + 3 * dr * dv):
            yield f"grid.csv: t = {row[0]}: the velocity is not along the sphere"


def _invariant(scene: Scene, manifest: Manifest, grid: Sheet, transits: Sheet) -> Iterator[str]:
    """Check that h and its drift are those of the manifest and, without drag, that h is constant within the bounds."""
    initial, drift = invariant_drift(scene, grid)
    if (initial, drift) != (manifest.invariant.h_m2_s2, manifest.invariant.drift_m2_s2):
        yield f"manifest.json: the invariant of grid.csv is {initial}, drift {drift}; the manifest says otherwise"
    if Fraction(drift) > invariant_tolerance(scene, manifest, grid) and scene.exact.drag == 0:
        yield f"grid.csv: the invariant h drifts by {drift} m²/s², more than the bounds allow"


def invariant_drift(scene: Scene, grid: Sheet) -> tuple[str, str]:
    """Return h of the first printed row in m²/s², and its largest change over the rows (rounded up)."""
    ctx = context(bits_of(scene.run.digits) + INVARIANT_BITS)
    k = constants(scene.exact, ctx)

    def h_of(row: list[Fraction]) -> Fraction:
        x, y, z, vx, vy, vz = (to_mpf(value, ctx) / k.length for value in row)
        return to_fraction(invariant((x, y, z), (vx, vy, vz), k) + ctx.mpf(0))

    values = [h_of(row) for row in grid.numbers(STATE)]
    digits = scene.run.digits
    return fixed_decimal(values[0], digits), rounded_up(max(abs(value - values[0]) for value in values))


def invariant_tolerance(scene: Scene, manifest: Manifest, grid: Sheet) -> Fraction:
    """Return the largest change of h between two rows that the bounds on position and velocity allow, in m²/s²."""
    ctx = context(TOLERANCE_PREC)
    k = constants(scene.exact, ctx)
    length = scene.exact.length
    dr, dv = _bounds(manifest)
    fastest = max(abs(number) for row in grid.numbers(VELOCITY) for number in row)
    reach = length * (to_fraction(k.axis_distance + ctx.mpf(0)) + 3) + 3 * dr
    slope = scene.exact.gravity + 4 * scene.exact.rotation_rate**2 * reach
    return Fraction(101, 100) * 2 * (slope * dr + 3 * (fastest + dv) * dv)


def _zeros(scene: Scene, manifest: Manifest, grid: Sheet, transits: Sheet) -> Iterator[str]:
    """Check that transits are in order and alternate, and that ax and the sign of vx on the grid agree with them."""
    times, slopes, directions = (
        [numbers[0] for numbers in transits.numbers((name,))] for name in ("t", "ax", "direction")
    )
    if [row[0] for row in transits.rows] != [str(k + 1) for k in range(len(times))]:
        yield "transits.csv: k does not count from 1"
    if times and not (times[0] > 0 and times[-1] <= scene.exact.t_end):
        yield "transits.csv: a transit lies outside (0, t_end]"
    for k, (a, b) in enumerate(pairwise(times), 1):
        if not a < b:
            yield f"transits.csv: transits {k} and {k + 1} are not in order"
    for k, (p, q) in enumerate(pairwise(directions), 1):
        if p == q and manifest.transits == "complete":
            yield f"transits.csv: transits {k} and {k + 1} do not alternate"
    for k, (direction, ax) in enumerate(zip(directions, slopes, strict=True), 1):
        if abs(direction) != 1 or ax * direction < 0:
            yield f"transits.csv: transit {k}: direction {direction} contradicts ax = {float(ax):.17g}"
    if manifest.transits == "complete":
        yield from _signs_on_grid(grid, times, directions, _bounds(manifest)[1])


def _signs_on_grid(grid: Sheet, times: list[Fraction], directions: list[Fraction], dv: Fraction) -> Iterator[str]:
    """Check the sign of vx between transits, in every grid row where the bound leaves it certain."""
    passed = 0
    for t, vx in list(grid.numbers(("t", "vx")))[1:]:
        while passed < len(times) and times[passed] <= t:
            passed += 1
        expected = directions[passed - 1] if passed else -directions[0] if directions else 0
        if expected and abs(vx) > dv and vx * expected < 0:
            yield f"grid.csv: t = {float(t):.17g}: the sign of vx contradicts the transits before it"
