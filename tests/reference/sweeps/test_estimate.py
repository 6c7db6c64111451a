"""Errors of rows: never below what limbs finds at 110 bits, also where the bob goes over the top."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from against_limbs import compare
from random_rows import KINDS, random_kinds, rows_of
from scipy.integrate import solve_ivp

from reference.engines.batch_interface import CLOSE_PAIR, PlumbAxes, RunOptions
from reference.engines.registry import batches
from reference.engines.row_zeros import MODEL, RowMotion
from reference.model.constants import Constants
from reference.scenes.scene import load_scene
from reference.sweeps.estimate import bend_of_pairs, errors_by_moved_runs

ENGINES = [name for name, engine in batches().items() if engine.installed]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kind", KINDS)
def test_every_error_is_at_most_its_estimate(engine, kind, size, tally):
    many = list(random_kinds(f"estimates {kind}", size(4, 15), Fraction(100), (kind,)))
    found = compare(batches()[engine], many)
    tally(f"estimates, {engine}, {kind}: {found}")
    assert set(found.worst) >= {
        "position",
        "velocity",
        "transit",
        "frequency",
        "swing",
        "precession",
        "angle",
    }
    assert found.miscounted == []
    assert found.underestimated == []


@pytest.mark.parametrize("engine", ENGINES)
def test_highest_points_near_the_top_are_as_late_as_estimated(engine, tally):
    # thrown from beyond the horizontal: the sine of the largest angle is small, or the bob passes it fast
    many = list(random_kinds(20261123, 40, kinds=("over",)))[30:]
    found = compare(batches()[engine], many)
    tally(f"estimates near the top, {engine}: {found}")
    assert found.underestimated == []


@pytest.mark.parametrize("engine", ENGINES)
def test_highest_points_of_a_swing_of_micrometres_are_as_late_as_estimated(engine, tally):
    """The height's rate is a product, and its Taylor series in a long step worse than that of the motion."""
    site = {
        "latitude": 90,
        "gravity": "9.49556",
        "rotation_rate": "9.787124403e-06",
        "equatorial_radius": "6903.44",
    }
    site |= {"length": "19.9867777777646", "t_end": "183.29", "grid_step": "183.29"}
    site = {name: Fraction(value) for name, value in site.items()}
    release = [
        Fraction(words)
        for words in ("4.586892676e-06", "2.511938486e-06", "3.51197e-06", "1.14e-06")
    ]
    paris = load_scene("paris").exact
    many = [
        replace(paris, **site, position=tuple(size * part for part in release))
        for size in (1, Fraction(1, 4), 5)
    ]
    found = compare(batches()[engine], many)
    tally(f"estimates of micrometres, {engine}: {found}")
    assert found.doubtful == 0
    assert found.underestimated == []


@pytest.mark.parametrize("engine", ENGINES)
def test_an_angle_next_to_the_top_is_as_uncertain_as_its_cosine(engine, paris):
    angles = [
        Fraction(words) for words in ("179.9", "179.97", "179.99", "179.993", "179.997", "179.9991")
    ]
    upright = replace(
        paris.exact, latitude=Fraction(90), rotation_rate=Fraction(0), t_end=Fraction(1, 2)
    )
    rows = rows_of(
        [replace(upright, position=None, angles=(angle, *[Fraction(0)] * 3)) for angle in angles]
    )
    run = batches()[engine].solve(rows, RunOptions())
    error = np.abs(np.degrees(run.largest_angle) - [float(angle) for angle in angles])
    assert (error <= errors_by_moved_runs(batches()[engine], rows, run)[0].angle).all()


def test_between_close_transits_xdot_bends_no_more_than_is_taken(paris, size, tally):
    generator, close, worst = random.Random(20261126), 0, 0.0
    for _ in range(size(15, 60)):
        length, latitude = generator.uniform(1, 100), generator.uniform(-90, 90)
        rate, turn = (9.8 / length) ** 0.5, generator.uniform(0, 1) ** 3 / 31
        site = {
            "length": length,
            "latitude": latitude,
            "equatorial_radius": 0,
            "rotation_rate": turn * rate,
        }
        site = {name: Fraction(value) for name, value in site.items()}
        y = length * np.sin(np.radians(generator.uniform(1, 27)))
        # the plane is in the meridian then
        past = -turn * np.sin(np.radians(latitude)) * np.pi * np.array([1, 3, 5])
        pushed = generator.choice([0, 0, 0.3]) * turn * y * rate
        position = (generator.choice(past) * y, y, generator.uniform(-1, 1) * pushed, 0)
        inputs = replace(paris.exact, **site, position=tuple(map(Fraction, position)))
        rows = rows_of([inputs])
        axes = PlumbAxes.of(rows)
        k = Constants(
            turn=(0, *(part.high[0] for part in axes.turn)),
            pull=(0, 0, -axes.size.high[0]),
            drag=0.0,
        )
        n, V = ([part.high[0] for part in vector] for vector in (axes.n, axes.V))
        t = np.linspace(0, 8 * np.pi / rate, 20_001)
        states = solve_ivp(
            lambda _, state, k=k: MODEL.derivatives(state, k, np), t[[0, -1]], [*n, *np.cross(n, V)], "DOP853", t,
            rtol=1e-11, atol=1e-14,
        ).y  # fmt: skip
        motion = RowMotion.of(states, k)
        angle = np.arccos(-motion.n[2].max())
        taken = bend_of_pairs(rows, np.array([angle]))[0]
        bend = np.abs(np.gradient(motion.a[0], t)) * length
        zeros = np.flatnonzero(np.diff(np.sign(motion.v[0])))
        for first, second in pairwise(zeros):
            if t[second] - t[first] < CLOSE_PAIR * 2 * np.pi / rows.rate[0]:
                close += 1
                worst = max(worst, bend[first + 1 : second + 1].max(initial=0) / taken)
    tally(f"bend between close transits: {close} pairs, at most {worst:.2g} of its bound")
    assert close > size(6, 30)
    assert worst < 1
