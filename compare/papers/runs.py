"""Runs of the reference that judged numbers and sentences rest on, such as the day of the Paris pendulum; cached."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from reference import Golden, Scene, Solution, load, load_scene, solve, trajectory
from reference.numbers.precision import LONG_DOUBLE, Array

from ..observed.swing_plane import Gauge
from .digits import mpf


@cache
def paris_day() -> Golden:
    """Return the golden dataset of the Paris pendulum: 24 h, 40 digits, every transit."""
    return load("paris")


@cache
def transits(column: str) -> list[Any]:
    """Return a column of its transits."""
    return [mpf(text) for text in paris_day().transits.decimals(column)]


@cache
def paris_path() -> tuple[Array, Array]:
    """Return times every 30 s for 24 h and x, y, z, vx, vy, vz there, shape (times, 6), by a long double run."""
    times = np.arange(0.0, 86430.0, 30.0)
    return times, path_in(load_scene("paris"), times)


def path_in(scene: Scene, times: Array) -> Array:
    """Return x, y, z, vx, vy, vz of any scene, shape (times, 6), to about the last digit of a double."""
    return trajectory(scene, times, number=LONG_DOUBLE)


def window(begin: float, span: float, scene: Scene | None = None, step: float = 0.05) -> tuple[Array, Array]:
    """Return the times of an interval and the states of a scene there, shape (times, 6); the default is Paris."""
    times = np.asarray(begin + np.arange(round(span / step) + 1) * step, dtype=np.float64)
    output_times: Array = times if begin == 0 else np.concatenate(([0.0], times))
    states = path_in(scene or load_scene("paris"), output_times)
    return times, states[len(output_times) - len(times) :]


def rotation(scene: Scene, t_end: float) -> float:
    """Return the rotation of the swing plane in degrees an hour, by a line fitted to its azimuths every 10 s."""
    times = np.arange(0.0, t_end + 5.0, 10.0)
    return float(np.polyfit(times / 3600, np.degrees(swing_plane(scene, path_in(scene, times))), 1)[0])


@cache
def solved(changes: tuple[str, ...], t_end: str, digits: int = 20) -> Solution:
    """Solve the scene `paris` with some values changed, up to t_end, with its transits."""
    scene = load_scene("paris", [*changes, f"run.grid_step={t_end}"])
    return solve(scene, t_end=t_end, digits=digits, level="computed")


def frequency(solution: Solution) -> Any:
    """Return the swings a second, from the release to the last transit that ends a whole swing."""
    times = solution.transits.exact("t")
    half = times[1] / 2
    swings = [(round(t / half), t) for t in times]
    halves, last = max((count, t) for count, t in swings if count % 2 == 0)
    return mpf(halves) / 2 / mpf(last)


@cache
def frequencies() -> dict[float, float]:
    """Return the frequency in Hz by latitude in degrees, from runs of ten minutes."""
    latitudes = [*map(str, range(-90, 91, 10)), "48.846111"]
    return {float(text): float(frequency(solved((f"site.latitude={text}",), "600", 12))) for text in latitudes}


def swing_plane(scene: Scene, states: Array) -> Array:
    """Return the azimuth of the swing plane in rad, east to north, without jumps."""
    return np.unwrap(Gauge.of(scene).swing_plane(states), period=np.pi)


@cache
def paris_swing_plane() -> Array:
    """Return the azimuth of the Paris pendulum's swing plane in rad, every 30 s for 24 h."""
    return swing_plane(load_scene("paris"), paris_path()[1])


@cache
def paris_passage() -> tuple[Array, Array]:
    """Return the states near the vertical, and how near a straight line through each passes it, in m.

    The rest position lies south of the vertical, so that the swing passes nearest while its plane lies north and south.
    Ten minutes before and after, the plane has turned by 1.9° and misses the vertical by 4 mm.
    """
    passage = paris_path()[0][np.abs(np.cos(paris_swing_plane())).argmin()]
    states = window(passage - 600, 1200, step=0.25)[1]
    near = states[np.hypot(states[:, 0], states[:, 1]) < 0.06]
    return near, np.abs(near[:, 0] * near[:, 4] - near[:, 1] * near[:, 3]) / np.hypot(near[:, 3], near[:, 4])


def lead(ahead: Array, behind: Array) -> float:
    """Return the time in s by which a state x, y, z, vx, vy, vz is ahead of another, along the other's velocity."""
    gap, speed = ahead[:2] - behind[:2], behind[3:5]
    return float(gap @ speed / (speed @ speed))
