"""Runs that only the figures need."""

from __future__ import annotations

from functools import cache

import numpy as np

from reference import InputError, Scene, load_scene

from ..methods import METHODS, available
from ..rhs.problem import Problem
from .digits import MP, acos, dot, mpf, pi, sin, sqrt
from .mathar.frequency import slow_down
from .mathar.triangle import apparent_gravity
from .points import paris
from .runs import Array, frequency, path_in, solved
from .truth import rest

FIXED_STEP = ("rk4", "rkng56", "rkng67")  # -R 4, 5, 6
LATITUDES = tuple(range(-90, 91, 10))
SPAN = "600"  # s of a run that measures a frequency


def window(begin: float, span: float, scene: Scene | None = None, step: float = 0.05) -> tuple[Array, Array]:
    """Times of an interval, and the states of a scene there (Paris if none is given), shape (times, 6)."""
    times = np.asarray(begin + np.arange(round(span / step) + 1) * step, dtype=np.float64)
    asked: Array = times if begin == 0 else np.concatenate(([0.0], times))
    states = path_in(scene or load_scene("paris"), asked)
    return times, states[len(asked) - len(times) :]


@cache
def frequencies() -> dict[float, float]:
    """Hz by latitude in degrees, from runs of the reference."""
    words = [*map(str, LATITUDES), "48.846111"]
    return {float(word): float(frequency(solved([f"site.latitude={word}"], SPAN, 12))) for word in words}


def estimate_at(latitude: float) -> float:
    """Hz by the paper's last but one estimate: (51)-(52) with g' of (48), slowed down by 2K/π."""
    p = paris().but(latitude=mpf(latitude))
    amplitude = acos(dot((p.x, p.y, p.z), rest(p)) / p.length**2)
    rate = sqrt(apparent_gravity(p) / p.length + (p.rate * sin(p.phi)) ** 2)
    return float(rate / (2 * pi) / slow_down(amplitude) + MP.zero)


def orders_at(begin: float, span: float, step: float) -> dict[str, Array]:
    """States of the three fixed-step methods of the paper's program, every step of an interval.

    Raises:
        InputError: they are not installed.
    """
    check_methods()
    times = np.arange(round((begin + span) / step) + 1) * step
    problem = Problem.of(load_scene("paris", ["inputs=binary64"]), "plane", times)
    first = round(begin / step)
    return {word: METHODS[word].prepare(problem, step)().states[first:] for word in FIXED_STEP}


def check_methods() -> None:
    """Raise InputError if the methods of figure 9 cannot run here."""
    for word in FIXED_STEP:
        missing = available(METHODS[word])
        if missing is not None:
            raise InputError("--out", f"no {word}", "the extra methods, for figure 9", f"It is {missing}.")
