"""Two lists of 250 random scenes: both engines give the same within their errors, and every number has an error.

The solver solves 46 of the 500 rows of angles in both engines, and 37 of those of positions; more would be a loss.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from places import ROOT

from reference.scenes.scene import load_scene
from reference.sweeps.parquet import COLUMNS
from reference.sweeps.sweep import sweep

SCENES = {"angles": "two_radians", "positions": "paris"}
MOST_SOLVED = {"angles": 48, "positions": 39}
SAME = ("status", "transits", "close_pairs")
ERRORS = {column.name: column.error for column in COLUMNS if column.error}


@cache
def solved(name, engine):
    scene = load_scene(SCENES[name], ["run.t_end=60"])
    return list(sweep(scene, rows=ROOT / f"tests/helpers/random_{name}.csv", engine=engine, audit_rows=0).rows())


def differences(name, row):
    """Return the columns of a row in which the engines differ, or that are numbers without an error."""
    one, other = (solved(name, engine)[row] for engine in ("heyoka", "octet"))
    found = [column for column in SAME if one[column] != other[column]]
    for column, error in ERRORS.items():
        sides = [np.array([side[column], side[error]], dtype=float) for side in (one, other)]
        if np.isnan(sides).all():
            continue
        (value, own), (another, its) = sides
        rounding = np.spacing(abs(value))
        if not abs(value - another) <= own + its + 2 * rounding:
            found.append(column)
    return found


@pytest.mark.parametrize("name", SCENES)
def test_the_engines_agree_over_a_list(name):
    wrong = {row: differences(name, row) for row in range(250)}
    assert {row: columns for row, columns in wrong.items() if columns} == {}
    assert (
        sum(row["level"] != "computed" for engine in ("heyoka", "octet") for row in solved(name, engine))
        <= MOST_SOLVED[name]
    )


@pytest.mark.parametrize("drag", ["0", "1e-300"])
def test_a_highest_point_soon_after_the_release_counts(drag):
    """Pushed outward, the bob rises for a moment: that is its first highest point, with and without drag."""
    scene = load_scene("paris", ["run.t_end=3600", f"pendulum.drag={drag}"])
    own = sweep(scene, ["release.vx=1e-9,1e-5,1e-4"], engine="heyoka")
    other = sweep(scene.with_values(["pendulum.drag=0"]), ["release.vx=1e-9,1e-5,1e-4"], engine="octet")
    for column in ("swing_hz", "precession_deg_per_h", "max_angle_deg"):
        gap = np.abs(own[column] - other[column])
        assert (gap <= own[ERRORS[column]] + other[ERRORS[column]]).all(), column
