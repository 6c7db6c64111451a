"""Errors of rows: never below what limbs finds at 110 bits, also where the bob goes over the top."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from against_limbs import compare
from random_rows import KINDS, random_kinds, rows_of

from reference.engines.batch_interface import Wanted
from reference.engines.registry import batches
from reference.scenes.scene import load_scene
from reference.sweeps.estimate import judged

ENGINES = [name for name, engine in batches().items() if engine.installed]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kind", KINDS)
def test_every_error_is_at_most_its_estimate(engine, kind, tally):
    found = compare(batches()[engine], list(random_kinds(f"estimates {kind}", 15, Fraction(100), (kind,))))
    tally(f"estimates, {engine}, {kind}: {found}")
    assert set(found.worst) >= {"position", "velocity", "transit", "frequency", "swing", "precession", "angle"}
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
    site = {"latitude": 90, "gravity": "9.49556", "rotation_rate": "9.787124403e-06", "equatorial_radius": "6903.44"}
    site |= {"length": "19.9867777777646", "t_end": "183.29", "grid_step": "183.29"}
    site = {name: Fraction(value) for name, value in site.items()}
    release = [Fraction(words) for words in ("4.586892676e-06", "2.511938486e-06", "3.51197e-06", "1.14e-06")]
    paris = load_scene("paris").exact
    many = [replace(paris, **site, position=tuple(size * part for part in release)) for size in (1, Fraction(1, 4), 5)]
    found = compare(batches()[engine], many)
    tally(f"estimates of micrometres, {engine}: {found}")
    assert found.doubtful == 0
    assert found.underestimated == []


@pytest.mark.parametrize("engine", ENGINES)
def test_an_angle_next_to_the_top_is_as_uncertain_as_its_cosine(engine, paris):
    angles = [Fraction(words) for words in ("179.9", "179.97", "179.99", "179.993", "179.997", "179.9991")]
    upright = replace(paris.exact, latitude=Fraction(90), rotation_rate=Fraction(0), t_end=Fraction(1, 2))
    rows = rows_of([replace(upright, position=None, angles=(angle, *[Fraction(0)] * 3)) for angle in angles])
    run = batches()[engine].solve(rows, Wanted())
    error = np.abs(np.degrees(run.largest_angle) - [float(angle) for angle in angles])
    assert (error <= judged(batches()[engine], rows, run)[0].angle).all()
