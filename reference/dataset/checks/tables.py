"""Check the tables of a dataset against its scene: times, first row, doubles, digits, order and directions."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise

from ...model.algebra import dot
from ...model.start import Start
from ...numbers.columns import GRID, STATE
from ...numbers.precision import GUARD_BITS, bits_of, decimals_for, to_fraction
from ...solver.solution import exact_decimals
from ..files import Files
from ..manifest import MANIFEST
from ..sheets import NUMBERS, Sheet, exact

SLACK = Fraction(11, 10)  # bounds are rounded up to two digits
SIGNIFICANT = 8  # a column is noise, and has no digits of its own, if no number is this many times its bound


def problems(files: Files) -> Iterator[str]:
    """Yield what is wrong with the rows of the tables, taken by themselves and against the scene's inputs."""
    yield from _times(files)
    yield from _release(files)
    yield from _digits(files)
    for kind in ("grid", "transits"):
        yield from _doubles(files, kind)
    if files.manifest.counts.transits:
        yield from _order(files, files.tables["transits.csv"])
        yield from _bound_column(files, files.tables["transits.csv"])


def _times(files: Files) -> Iterator[str]:
    times = files.scene.exact.grid
    if [Fraction(row[0]) for row in files.tables["grid.csv"].rows] != times:
        yield "grid.csv: the times are not those of the scene"
    elif files.manifest.decimals["grid"]["t"] != exact_decimals(tuple(times)):
        yield f"{MANIFEST}: decimals of the grid's t do not follow from the scene"


def _release(files: Files) -> Iterator[str]:
    """Check that the first row is the scene's exact release."""
    start = Start.of(files.scene.exact, bits_of(2 * files.manifest.digits) + GUARD_BITS)
    released = [to_fraction(start.ctx.mpf(part)) for part in (*start.position, *start.velocity)]
    (printed,) = Sheet(files.tables["grid.csv"].header, files.tables["grid.csv"].rows[:1], {}).numbers(STATE)
    for name, value, number in zip(STATE, released, printed, strict=True):
        if abs(number - value) > files.manifest.bound("grid", name):
            yield f"grid.csv: {name} of the first row is not that of the scene's release"


def _digits(files: Files) -> Iterator[str]:
    """Check that the largest number of each column of the grid has the digits asked for."""
    sheet, manifest = files.tables["grid.csv"], files.manifest
    for name in GRID:
        largest, bound = max(abs(row[0]) for row in sheet.numbers((name,))), manifest.bound("grid", name)
        fewest = decimals_for(largest + bound, manifest.digits)
        if largest > SIGNIFICANT * bound and manifest.decimals["grid"][name] < fewest:
            yield f"{MANIFEST}: decimals: {name} of grid has fewer than {manifest.digits} digits"


def _doubles(files: Files, kind: str) -> Iterator[str]:
    """Check that each double is the nearest to some number that the bound on the printed decimal allows."""
    plain, doubles = files.tables.get(f"{kind}.csv"), files.tables.get(f"{kind}.binary64.csv")
    if plain is None or doubles is None or not plain.rows:
        return
    count = len(plain.header)
    for name in NUMBERS[kind]:
        i, j = plain.header.index(name), count + NUMBERS[kind].index(name)
        column = Fraction(0) if (kind, name) == ("grid", "t") else files.manifest.bound(kind, name)  # type: ignore[arg-type]
        for row, other in zip(plain.rows, doubles.rows, strict=True):
            bound = Fraction(row[-1]) if kind == "transits" and name == "t" else column
            value, double = exact(row[i]), float(other[i])
            if double.hex() != other[j] or not float(value - bound) <= double <= float(value + bound):
                yield f"{kind}.binary64.csv: {name} = {other[i]} is not the double nearest to {row[i]}"
            elif f"{double:.16e}" != other[i]:
                yield f"{kind}.binary64.csv: {name} = {other[i]} is not written with the digits of {double!r}"
    for row, other in zip(plain.rows, doubles.rows, strict=True):
        if any(row[i] != other[i] for i, name in enumerate(plain.header) if name not in NUMBERS[kind]):
            yield f"{kind}.binary64.csv: row {row[0]} has another direction, number or bound than {kind}.csv"


def _order(files: Files, transits: Sheet) -> Iterator[str]:
    """Check that transits count from 1, lie in (0, t_end] in order, alternate, and that the signs on the grid agree."""
    times, bounds, directions = zip(*transits.numbers(("t", "bound", "direction")), strict=True)
    if [row[0] for row in transits.rows] != [str(k) for k in range(1, len(times) + 1)]:
        yield "transits.csv: k does not count from 1"
    if times[0] <= -bounds[0] or times[-1] > files.scene.exact.t_end + bounds[-1]:
        yield "transits.csv: a transit lies outside (0, t_end]"
    for k, ((a, b), (p, q)) in enumerate(zip(pairwise(times), pairwise(bounds), strict=True), 1):
        if b - a < -(p + q):
            yield f"transits.csv: transits {k} and {k + 1} are not in order"
    if files.manifest.transits != "complete":
        return
    for k, (p, q) in enumerate(pairwise(directions), 1):
        if p == q:
            yield f"transits.csv: transits {k} and {k + 1} do not alternate"
    yield from _signs_on_grid(files, times, bounds, directions)


def _signs_on_grid(
    files: Files, times: tuple[Fraction, ...], bounds: tuple[Fraction, ...], directions: tuple[Fraction, ...]
) -> Iterator[str]:
    """Check the sign of vx between transits, in every grid row where the bounds leave it certain."""
    dv, passed = files.manifest.bound("grid", "vx"), 0
    for t, vx in list(files.tables["grid.csv"].numbers(("t", "vx")))[1:]:
        while passed < len(times) and times[passed] <= t:
            passed += 1
        near = (k for k in (passed - 1, passed) if 0 <= k < len(times))
        expected = directions[passed - 1] if passed else -directions[0]
        if abs(vx) > dv and vx * expected < 0 and not any(abs(times[k] - t) <= bounds[k] for k in near):
            yield f"grid.csv: t = {float(t):.17g}: the sign of vx contradicts the transits before it"


def _bound_column(files: Files, transits: Sheet) -> Iterator[str]:
    """Check each bound on a time: at least its rounding, at most what the runs or the proof leave open."""
    manifest = files.manifest
    half_unit = Fraction(1, 2 * 10 ** manifest.decimals["transits"]["t"])
    gaps = [check.transit_s for check in manifest.cross_checks]
    gaps += [manifest.enclosure.transit_radius_s] if manifest.enclosure else []
    apart = 2 * max((Fraction(gap) for gap in gaps if gap is not None), default=Fraction(0))
    error = 2 * manifest.bound("grid", "vx")  # of xdot, and over ax that of the time
    grazing = error * largest_jerk(files)
    for k, (bound, ax) in enumerate(transits.numbers(("bound", "ax")), 1):
        if bound < half_unit:
            yield f"transits.csv: transit {k}: bound {float(bound):.2g} s is less than half a unit of the last digit"
        elif ax * ax > grazing and bound > SLACK * (half_unit + max(apart, error / abs(ax))):
            yield f"transits.csv: transit {k}: bound {float(bound):.2g} s is more than the runs leave open"
    if max(transits.numbers(("bound",)))[0] != manifest.bound("transits", "t"):
        yield f"{MANIFEST}: bounds.transits.t is not the largest bound of transits.csv"


def largest_jerk(files: Files) -> Fraction:
    """Return a bound on the rate of xddot, in m/s³: where ax is small against it, a zero of xdot may graze.

    With p for the pull, w = 2 |Ω| + γ, and v for the largest speed over l, which follows from h at the release and drag
    can only lower, it is 8 l (p + v² + w²) (v + w).
    """
    start = Start.of(files.scene.exact, GUARD_BITS)
    ctx, k = start.ctx, start.k
    pull, w = ctx.norm(k.pull), 2 * abs(k.rate) + k.drag
    v = ctx.sqrt(ctx.norm(start.v) ** 2 + 2 * (pull - dot(start.n, k.pull) + k.rate**2))
    return to_fraction(8 * k.length * (pull + v**2 + w**2) * (v + w))
