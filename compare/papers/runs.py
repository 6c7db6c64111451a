"""Runs of the reference that judged numbers and sentences rest on, such as the day of the Paris pendulum; cached."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from reference import Golden, Scene, Solution, load, load_scene, solve
from reference.engines.trajectory import trajectory
from reference.model.constants import constants
from reference.model.force import rest_position
from reference.precision import LONG_DOUBLE, context

from .digits import mpf

Array = npt.NDArray[np.float64]

PREC = 128  # bits in which the rest position is computed before it becomes doubles


@cache
def paris_day() -> Golden:
    """Return the golden dataset of the Paris pendulum: 24 h, 40 digits, every transit."""
    return load("paris")


@cache
def transit_times() -> list[Any]:
    """Return the times of its transits in s."""
    return [mpf(text) for text in paris_day().transits_text["t"]]


@cache
def paris_path() -> tuple[Array, Array]:
    """Return times every 0.25 s for 24 h and x, y, z, vx, vy, vz there, shape (times, 6), by a long double run."""
    times = np.arange(4 * 86400 + 1) / 4
    return times, trajectory(load_scene("paris"), times, number=LONG_DOUBLE)


def path_in(scene: Scene, times: Array) -> Array:
    """Return x, y, z, vx, vy, vz of any scene, shape (times, 6), to about the last digit of a double."""
    return trajectory(scene, times, number=LONG_DOUBLE)


def rotation(scene: Scene, t_end: float, swing_hz: float) -> float:
    """Return the rotation of the swing plane in degrees an hour, by a line fitted to its directions every 10 s."""
    times = np.arange(0.0, t_end + 5.0, 10.0)
    turned = swing_direction(path_in(scene, times), rest_in_metres(scene), 2 * np.pi * swing_hz)
    return float(np.polyfit(times / 3600, np.degrees(turned), 1)[0])


def solved(assignments: Sequence[str], t_end: str, digits: int = 20) -> Solution:
    """Solve the scene `paris` with some values changed, up to t_end, with its transits."""
    return _solved(tuple(assignments), t_end, digits)


@cache
def _solved(assignments: tuple[str, ...], t_end: str, digits: int) -> Solution:
    grid = f"run.grid_step={t_end}"
    return solve(load_scene("paris", [*assignments, grid]), t_end=t_end, digits=digits, level="computed")


def frequency(solution: Solution) -> Any:
    """Return the swings a second, from the release to the last transit that ends a whole swing."""
    assert solution.transits is not None
    times = solution.transits.exact("t")
    half = times[1] / 2
    swings = [(round(t / half), t) for t in times]
    halves, last = max((count, t) for count, t in swings if count % 2 == 0)
    return mpf(halves) / 2 / mpf(last)


def rest_in_metres(scene: Scene) -> Array:
    """Return the rest position in m, shape (3,)."""
    ctx = context(PREC)
    k = constants(scene.exact, ctx)
    return np.array([float(part * k.length) for part in rest_position(k, ctx)])


def swing_direction(states: Array, rest: Array, rate: float) -> Array:
    """Return the direction of the ellipse's major axis in rad, east to north, continuous; `rate` is the swing's, rad/s.

    With Z = x + i y seen from the rest position, Z = p exp(i rate t) + q exp(-i rate t): p = (Z - i Z'/rate) / 2,
    q = (Z + i Z'/rate) / 2, and the axis lies at (arg p + arg q) / 2.
    """
    z = states[:, 0] - rest[0] + 1j * (states[:, 1] - rest[1])
    turned = 1j * (states[:, 3] + 1j * states[:, 4]) / rate
    return np.asarray(np.unwrap(np.angle((z - turned) * (z + turned))) / 2)


@cache
def mean_direction() -> Array:
    """Return the direction of the Paris pendulum's swing plane in rad, every 0.25 s for 24 h."""
    times = transit_times()
    hertz = float(1 / times[1])
    return swing_direction(paris_path()[1], rest_in_metres(load_scene("paris")), 2 * np.pi * hertz)


def lead(ahead: Array, behind: Array) -> float:
    """Return the time in s by which a state x, y, z, vx, vy, vz is ahead of another, along the other's velocity."""
    gap, speed = ahead[:2] - behind[:2], behind[3:5]
    return float(gap @ speed / (speed @ speed))
