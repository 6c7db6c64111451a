"""Runs for the papers' figures only: intervals of a motion, frequency by latitude, foucPend's fixed-step methods."""

from __future__ import annotations

from functools import cache

import numpy as np

from reference import InputError, load_scene
from reference.precision import Array

from ..methods import METHODS, available
from ..rhs.problem import Problem
from .digits import mpf
from .mathar.paris import estimate
from .points import paris
from .runs import frequency, solved

FIXED_STEP = ("rk4", "rkng56", "rkng67")  # -R 4, 5, 6
LATITUDES = tuple(range(-90, 91, 10))
SPAN = "600"  # s of a run that measures a frequency


@cache
def frequencies() -> dict[float, float]:
    """Return the frequency in Hz by latitude in degrees, from runs of the reference."""
    latitudes = [*map(str, LATITUDES), "48.846111"]
    return {float(text): float(frequency(solved([f"site.latitude={text}"], SPAN, 12))) for text in latitudes}


def estimate_at(latitude: float) -> float:
    """Return the paper's last but one estimate of the frequency in Hz: (51)-(52) with g' of (48), slowed by 2K/π."""
    return float(estimate(paris().but(latitude=mpf(latitude))))


def orders_at(begin: float, span: float, step: float) -> dict[str, Array]:
    """Return the states of the three fixed-step methods of the paper's program at every step of an interval.

    Raises:
        InputError: one of them is not installed.
    """
    check_methods()
    times = np.arange(round((begin + span) / step) + 1) * step
    problem = Problem.of(load_scene("paris", ["inputs=binary64"]), "plane", times)
    first = round(begin / step)
    return {name: METHODS[name].prepare(problem, step)().states[first:] for name in FIXED_STEP}


def check_methods() -> None:
    """Raise InputError if the methods of figure 9 cannot run here."""
    for name in FIXED_STEP:
        missing = available(METHODS[name])
        if missing is not None:
            raise InputError("--out", f"no {name}", "the methods of figure 9 (extra `methods`)", f"It is {missing}.")
