"""foucPend's output as lines of text: comments, snapshots and transits, in the format that the package describes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from reference import InputError, Scene, solve
from reference.model.constants import constants
from reference.model.start import Start
from reference.numbers.precision import Array, context
from reference.scenes.scene import MAX_ROWS

from .options import METHOD_OF, Options

DIGITS = 17  # decimal digits that identify a double
PREC = 128  # bits in which the site's constants are computed before they become doubles
COLUMNS = "t/s x/m y/m z/m X/m Y/m Z/m phi/deg lambda/deg speed/(m/s)"
_SNAPSHOT = " ".join(["%.17g"] * 10)


def lines(options: Options) -> Iterator[str]:
    """Yield the output line by line, without newlines.

    Raises:
        InputError: a package that is needed is not installed, or --exact would print too many snapshots.
        IntegrationError, UnreachableError: the run failed.
    """
    yield from _comments(options)
    count = 0
    frame = SiteFrame(options.scene)
    for times, states, zeros in _exact(options) if options.exact else _integrated(options):
        snapshots = frame.snapshots(times, states)
        begin = 0
        for zero in zeros:
            end = int(np.searchsorted(times, zero, side="left"))
            yield from _texts(snapshots[begin:end])
            begin, count = end, count + 1
            yield f"# P {count} {zero:.17g} {count / (2 * zero):.17g}"
        yield from _texts(snapshots[begin:])


def _texts(rows: Array) -> Iterator[str]:
    for row in rows.tolist():
        yield _SNAPSHOT % tuple(row)


def _comments(options: Options) -> Iterator[str]:
    mode = "--exact" if options.exact else f"-R {_order(options.method)} -a {options.bits}"
    yield f"# foucault pend {options.printed}"
    yield f"# {mode}"
    yield f"# columns: {COLUMNS}"
    yield "# transits of xdot = 0: # P count t/s frequency/Hz"


def _order(method: str) -> str:
    return next(order for order, name in METHOD_OF.items() if name == method)


def _integrated(options: Options) -> Iterator[tuple[Array, Array, list[float]]]:
    """Yield the snapshots of each block and the transits in it."""
    from .fixed_steps import Transits, blocks

    transits, first = Transits(), 0
    for times, states in blocks(options):
        zeros = transits.of(times, states[:, 3])
        index = first + np.arange(len(times))
        printed = (index % options.skip == 0) & (index >= (first + 1 if first else 0))
        yield times[printed], states[printed], zeros
        first += len(times) - 1


def _exact(options: Options) -> Iterator[tuple[Array, Array, list[float]]]:
    """Yield all snapshots and transits at once, from the reference at the level `confirmed`."""
    rows, end = options.steps // options.skip, options.step * options.steps
    if rows > MAX_ROWS:
        raise InputError("-s", str(options.skip), f"at most {MAX_ROWS} snapshots with --exact", "Take a larger -s.")
    grid = options.step * options.skip if rows else end
    times = {"grid_step": grid, "t_end": end}
    solution = solve(
        options.scene.with_values(f"run.{key}={float(value)!r}" for key, value in times.items()),
        digits=DIGITS,
        level="confirmed",
    )
    states = np.array([getattr(solution, name) for name in ("x", "y", "z", "vx", "vy", "vz")]).T
    start = Start.of(options.scene.exact, PREC)
    states[0] = [float(part) for part in (*start.position, *start.velocity)]  # as given: the solver's has rounding
    zeros = [] if solution.transits is None else solution.transits.array("t").tolist()
    yield solution.t[: rows + 1], states[: rows + 1], zeros


class SiteFrame:
    """The suspension and its axes, seen from axes that do not turn, Mathar (1)-(9)."""

    def __init__(self, scene: Scene) -> None:
        ctx, exact = context(PREC), scene.exact
        k = constants(exact, ctx)
        flattening = ctx.mpf(exact.flattening.numerator) / exact.flattening.denominator
        altitude = ctx.mpf(exact.altitude.numerator) / exact.altitude.denominator
        radius = ctx.mpf(exact.equatorial_radius.numerator) / exact.equatorial_radius.denominator
        squared_eccentricity = flattening * (2 - flattening)
        normal = radius / ctx.sqrt(1 - squared_eccentricity * k.sin * k.sin)
        self.sin, self.cos, self.rate = float(k.sin), float(k.cos), float(k.rate)
        self.axis_distance = float(k.axis_distance * k.length)
        self.height = float((normal * (1 - squared_eccentricity) + altitude) * k.sin)

    def snapshots(self, times: Array, states: Array) -> Array:
        """Return the ten columns, shape (rows, 10), of states x, y, z, vx, vy, vz, shape (rows, 6)."""
        x, y, z = states[:, :3].T
        distance = self.axis_distance - self.sin * y + self.cos * z
        turn = self.rate * times
        inertial = (
            distance * np.cos(turn) - x * np.sin(turn),
            distance * np.sin(turn) + x * np.cos(turn),
            self.height + self.cos * y + self.sin * z,
        )
        angle = np.degrees(np.arctan2(np.hypot(x, y), -z))
        azimuth = np.degrees(np.arctan2(y, x))
        speed = np.sqrt((states[:, 3:] ** 2).sum(axis=1))
        return np.column_stack((times, x, y, z, *inertial, angle, azimuth, speed))
