"""Two lists of 250 random scenes: both engines give the same within their errors, and every number has an error.

The solver solves 52 of the 500 rows of angles in both engines, and 38 of those of positions; more would be a loss.
A row or two of each list are solved in every test run, and all under --long: they cost nearly all of the time.
"""

from __future__ import annotations

import numpy as np
import pytest
from places import ROOT
from swept_here import is_left, left, swept_here

from reference.scenes.scene import load_scene
from reference.sweeps.parquet import COLUMNS
from reference.sweeps.promote import promoted
from reference.sweeps.sweep import sweep

SCENES = {"angles": "two_radians", "positions": "paris"}
MOST_SOLVED = {"angles": 53, "positions": 39}
# whose multiples the solver solves: row 168, of the cheapest; 0 and 133
EVERY = {"angles": 84, "positions": 133}
SAME = ("status", "transits", "close_pairs")
ERRORS = {column.name: column.error for column in COLUMNS if column.error}


def solved(name, every):
    """Return the rows of a list by both engines; where `every` divides a row's number, the solver solves what is left.

    It solves such a row once, here, for both.
    """
    scene, rows = (
        load_scene(SCENES[name], ["run.t_end=60"]),
        ROOT / f"tests/helpers/random_{name}.csv",
    )
    kept = {}

    def some(request, row, *, doubtful):
        assert doubtful
        if row % every:
            return left()
        if row not in kept:
            kept[row] = promoted(request, row, doubtful=doubtful)
        return kept[row]

    return [
        list(swept_here(scene, [], some, rows, engine=engine).rows())
        for engine in ("heyoka", "octet")
    ]


def differences(one, other):
    """Return the columns of a row in which the engines differ, or that are numbers without an error."""
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
def test_the_engines_agree_over_a_list(name, size):
    lists = solved(name, size(EVERY[name], 1))
    pairs = [pair for pair in zip(*lists, strict=True) if not any(map(is_left, pair))]
    wrong = {one["row"]: differences(one, other) for one, other in pairs}
    assert {row: columns for row, columns in wrong.items() if columns} == {}
    by_solver = [
        [row for row in rows if is_left(row) or row["level"] != "computed"] for rows in lists
    ]
    assert 0 < sum(map(len, by_solver)) <= MOST_SOLVED[name]
    assert any(row["level"] != "computed" for pair in pairs for row in pair)
    assert len(pairs) >= 250 - size(MOST_SOLVED[name], 0)


@pytest.mark.parametrize("drag", ["0", "1e-300"])
def test_a_highest_point_soon_after_the_release_counts(drag):
    """Pushed outward, the bob rises for a moment: that is its first highest point, with and without drag."""
    scene = load_scene("paris", ["run.t_end=3600", f"pendulum.drag={drag}"])
    own = sweep(scene, ["release.vx=1e-9,1e-5,1e-4"], engine="heyoka")
    other = sweep(
        scene.with_values(["pendulum.drag=0"]), ["release.vx=1e-9,1e-5,1e-4"], engine="octet"
    )
    for column in ("swing_hz", "precession_deg_per_h", "max_angle_deg"):
        gap = np.abs(own[column] - other[column])
        assert (gap <= own[ERRORS[column]] + other[ERRORS[column]]).all(), column
