"""foucPend, the program of Mathar's appendix A, with the same switches: fixed steps, snapshots and transits as text.

>>> from compare.papers.foucpend import lines
>>> from compare.papers.foucpend_options import Options
>>> options = Options.parse({"x": "0.3", "y": "0.4", "T": "20", "s": "100"})
>>> for line in lines(options):                                       # doctest: +SKIP
...     print(line)

The output, which `compare.candidates.read` and any other program can read:

- lines of text, each ended by one newline, decimal point, no thousands separators;
- a line that starts with `#` is a comment. The first comments name the settings and the columns;
- a **snapshot** is a line of ten numbers separated by single blanks:

      t  x  y  z  X  Y  Z  φ  λ  speed

  time in s; position in the local frame, east, north, up from the suspension, in m; position in the
  frame of (9), origin at the Earth's centre, which does not turn, in m; angle of the cord from
  straight down and azimuth from east to north, both in degrees (-180 < λ <= 180, 0 where x = y =
  0); speed in the local frame in m/s. The first snapshot is that of t = 0, then one follows after
  every s-th step of t seconds, up to T;
- a **transit** is a comment `# P k t f`: it is the k-th zero of xdot after t = 0, at t seconds, and
  f = k/(2 t) Hz is the frequency if two such transits occur in a period. It stands between the
  snapshots before and after it. The zero is that of the parabola through xdot at the two steps
  around the change of sign and at the step before them (after them, where there is none before): an
  error of order t³;
- numbers are printed with 17 significant digits, so that reading them gives exactly the doubles of
  the run;
- T need not be a multiple of t: the run ends with the last whole step.

With `--exact` the same lines come from the reference: positions and velocities are the doubles
nearest to the truth, and transits are those that the reference finds, not the zeros of a parabola.

A run is made in blocks, so that a long one needs little memory.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from reference import InputError, IntegrationError, Scene, solve
from reference.errors import Described
from reference.model.constants import axis_distance, constants
from reference.model.start import Start
from reference.numbers.precision import Array, context, to_mpf
from reference.scenes.scene import MAX_ROWS
from reference.system.imports import needed

from ..approximations.mathar import VARIABLES, derivatives, truncated
from ..methods import METHODS
from ..methods.method import Method, available
from ..methods.rhs.problem import FirstOrderSystem, Problem
from .foucpend_options import METHOD_OF, Options

DIGITS = 17  # decimal digits that identify a double
PREC = 128  # bits in which the site's constants are computed before they become doubles
COLUMNS = "t/s x/m y/m z/m X/m Y/m Z/m phi/deg lambda/deg speed/(m/s)"
_SNAPSHOT = " ".join(["%.17g"] * 10)
BLOCK = 100_000  # steps whose states are in memory at a time
# the items of section VI that the two lowest bits of -a leave out
ITEMS = (frozenset[Any](), frozenset({2}), frozenset({1}), frozenset({1, 2}))


def lines(options: Options) -> Iterator[str]:
    """Yield the output line by line, without newlines.

    Raises:
        InputError: a package that is needed is not installed, or --exact would print too many
            snapshots.
        IntegrationError, UnreachableError: the run failed.
    """
    if not options.exact:
        _check_available(METHODS[METHOD_OF[options.order]], options.order)
    mode = "--exact" if options.exact else f"-R {options.order} -a {options.bits}"
    yield f"# foucault pend {options.printed}"
    yield f"# {mode}"
    yield f"# columns: {COLUMNS}"
    yield "# transits of xdot = 0: # P count t/s frequency/Hz"
    count = 0
    for times, states, zeros in _exact(options) if options.exact else _integrated(options):
        snapshots = snapshots_of(options.scene, times, states)
        begin = 0
        for zero in zeros:
            end = int(np.searchsorted(times, zero, side="left"))
            yield from _texts(snapshots[begin:end])
            begin, count = end, count + 1
            yield f"# P {count} {zero:.17g} {count / (2 * zero):.17g}"
        yield from _texts(snapshots[begin:])


def _check_available(method: Method, order: str) -> None:
    """Refuse a method that cannot run here.

    Raises:
        InputError: a package is missing, or may not compile.
    """
    word = f"the method {method.id} (-R {order})"
    for module in method.requires:
        instead = ", or print the same lines from the reference: --exact"
        needed(module, str(method.extra), "foucault pend", word, instead)
    obstacle = available(method)
    if obstacle is not None:
        raise InputError("foucault pend", Described(obstacle), f"{word}, ready to run")


def _texts(rows: Array) -> Iterator[str]:
    for row in rows.tolist():
        yield _SNAPSHOT % tuple(row)


def _integrated(options: Options) -> Iterator[tuple[Array, Array, list[float]]]:
    """Yield the snapshots of each block and the transits in it.

    A block begins where the one before it ends.
    """
    method = METHODS[METHOD_OF[options.order]]
    step, transits, first = float(options.step), Transits(), 0
    problem = _problem(options, step)
    while first < options.steps:
        count = min(BLOCK, options.steps - first)
        problem = replace(problem, times=np.arange(count + 1) * np.float64(step))
        outcome = method.prepare(problem, step)()
        states = outcome.states
        if len(states) <= count:
            raise IntegrationError(
                f"{method.title} at {step:g} s fails after t = {first * step + outcome.reached_t:g} s.",
                "The equations in x and y are valid below the suspension only; a shorter step (-t) may help.",
            )
        index = first + np.arange(count + 1)
        times, printed = (
            index * np.float64(step),
            (index % options.skip == 0) & ((index > first) | (index == 0)),
        )
        zeros = transits.of(times, states[:, 3])
        yield times[printed], states[printed], zeros
        problem = replace(problem, start=states[-1, [0, 1, 3, 4]] / problem.constants.length)
        first += count


def _exact(options: Options) -> Iterator[tuple[Array, Array, list[float]]]:
    """Yield all snapshots and transits at once, from the reference at the level `confirmed`."""
    rows, end = options.steps // options.skip, options.step * options.steps
    if rows > MAX_ROWS:
        raise InputError(
            "-s",
            str(options.skip),
            f"at most {MAX_ROWS} snapshots with --exact",
            "Take a larger -s.",
        )
    grid = options.step * options.skip if rows else end
    times = {"grid_step": grid, "t_end": end}
    solution = solve(
        options.scene.with_values(f"run.{key}={float(value)!r}" for key, value in times.items()),
        digits=DIGITS,
        level="confirmed",
    )
    states = np.array([getattr(solution, name) for name in ("x", "y", "z", "vx", "vy", "vz")]).T
    start = Start.of(options.scene.exact, PREC)
    # as given: the solver's has rounding
    states[0] = [float(part) for part in (*start.position, *start.velocity)]
    zeros = solution.transits["t"].tolist()
    yield solution.t[: rows + 1], states[: rows + 1], zeros


def snapshots_of(scene: Scene, times: Array, states: Array) -> Array:
    """Return the ten columns, shape (rows, 10), of states x, y, z, vx, vy, vz, shape (rows, 6); Mathar (1)-(9)."""
    ctx, exact = context(PREC), scene.exact
    k = constants(exact, ctx)
    numbers = (exact.equatorial_radius, exact.flattening, exact.altitude)
    radius, flattening, altitude = (to_mpf(number, ctx) for number in numbers)
    # N of (2), the normal down to the axis
    normal = axis_distance(radius, flattening, 0, k.sin, 1, ctx.sqrt)
    # of the suspension above the equator's plane
    height = float((normal * (1 - flattening) ** 2 + altitude) * k.sin)
    x, y, z = states[:, :3].T
    distance = float(k.axis_distance * k.length) - float(k.sin) * y + float(k.cos) * z
    turn = float(k.rate) * times
    inertial = (
        distance * np.cos(turn) - x * np.sin(turn),
        distance * np.sin(turn) + x * np.cos(turn),
        height + float(k.cos) * y + float(k.sin) * z,
    )
    angle = np.degrees(np.arctan2(np.hypot(x, y), -z))
    azimuth = np.degrees(np.arctan2(y, x))
    speed = np.sqrt((states[:, 3:] ** 2).sum(axis=1))
    return np.column_stack((times, x, y, z, *inertial, angle, azimuth, speed))


def parabola_zero(t: Array, v: Array) -> float:
    """Return the zero of the parabola through three values, between the two neighbours that differ in sign.

    Args:
        t: times, shape (3,), equally spaced.
        v: values, shape (3,).
    """
    middle, h = t[1], t[1] - t[0]
    c, b, a = v[1], (v[2] - v[0]) / 2, (v[2] - 2 * v[1] + v[0]) / 2
    spread = np.sqrt(max(b * b - 4 * a * c, 0.0))
    twice = -(b + np.copysign(spread, b))
    roots = [twice / (2 * a)] if a else []
    roots += [2 * c / twice] if twice else []
    low, high = (0.0, 1.0) if np.sign(v[1]) != np.sign(v[2]) else (-1.0, 0.0)
    inside = min(roots, key=lambda root: max(low - root, root - high))
    return float(middle + h * inside)


class Transits:
    """Zeros of xdot, found block by block; a release at rest does not count."""

    def __init__(self) -> None:
        # from the one before the last that is not zero on
        self._rows: tuple[Array, Array] = (np.empty(0), np.empty(0))

    def of(self, times: Array, v: Array) -> list[float]:
        """Return the times of the zeros after the block's first row, up to its last.

        Args:
            times: shape (rows,), the first row being the last one of the block before.
            v: xdot there.
        """
        before = len(self._rows[0])
        new = slice(min(before, 1), None)
        times, v = np.append(self._rows[0], times[new]), np.append(self._rows[1], v[new])
        signed = np.flatnonzero(v)
        changed = signed[1:][np.diff(np.sign(v[signed])) != 0]
        kept = slice(max(signed[-1] - 1, 0) if len(signed) else 0, None)
        self._rows = times[kept], v[kept]
        return [_zero(times, v, int(i)) for i in changed if i >= before]


def _zero(times: Array, v: Array, i: int) -> float:
    """Return the zero between rows i - 1 and i; v at i is the first value of the new sign."""
    if v[i - 1] == 0:
        return float(times[i - 1])
    if len(v) == 2:
        return float(times[0] + (times[1] - times[0]) * v[0] / (v[0] - v[1]))
    three = slice(max(0, i - 2), max(0, i - 2) + 3)
    return parabola_zero(times[three], v[three])


def _problem(options: Options, step: float) -> Problem:
    problem = Problem.of(options.scene, "plane", [0.0, step])
    items = ITEMS[options.bits % len(ITEMS)]
    if not items:
        return problem
    k = truncated(problem.constants, items)
    return replace(
        problem, system=FirstOrderSystem.of(VARIABLES, partial(derivatives, items=items), k)
    )
