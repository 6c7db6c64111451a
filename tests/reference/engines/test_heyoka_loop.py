"""heyoka's loop over rows: zeros that heyoka loses show, and no row knows its neighbours."""

from __future__ import annotations

import numpy as np
import pytest
from mutations import with_names
from random_rows import random_kinds, rows_of
from small_scenes import make_scene

from reference.engines.batch_interface import DOUBTFUL, OK, STOPPED, RunOptions
from reference.engines.heyoka import loop
from reference.engines.heyoka.batch import BATCH
from reference.engines.octet.batch import BATCH as OCTET
from reference.engines.row_zeros import HEIGHT, TRANSIT, RowZeros

SITE = {
    "pendulum": {"length": "1"},
    "site": {"latitude": "0", "rotation_rate": "0.05", "equatorial_radius": "1"},
    "run": {"t_end": "60"},
}
RELEASES = {
    "a close pair": {"y": "0.5", "vx": "-0.00775"},
    "three together": {"y": "0.5235", "vx": "-0.02275"},
}
TOLERANCE = 2.0**-52


class Losing:
    """The loop over rows, with an integrator that loses zeros of a kind: those at the places that `lost` returns."""

    def __init__(self, kind):
        self.lost = lambda found: []
        losing = self

        class Loses(loop.Integrator):
            def zeros(self, sought):
                found = super().zeros(sought)
                if sought != kind or not len(found.times):
                    return found
                lost = losing.lost(found)
                return RowZeros(
                    *(np.delete(part, lost) for part in (found.times, found.directions))
                )

        self.module = with_names("reference/engines/heyoka/loop.py", Integrator=Loses)

    def fate(self, rows, options):
        return self.module.solve(rows, options, TOLERANCE).fate.tolist()


@pytest.mark.parametrize("kind", [TRANSIT, HEIGHT], ids=["transit", "highest point"])
@pytest.mark.parametrize("place", [0, 3, -1])
def test_a_zero_that_is_lost_leaves_a_doubt(paris, kind, place):
    rows, losing = rows_of([paris.with_values(["run.t_end=120"]).exact]), Losing(kind)
    assert losing.fate(rows, RunOptions()) == [OK]
    losing.lost = lambda found: [np.flatnonzero(found.times > 1e-3)[place]]
    assert losing.fate(rows, RunOptions()) == [DOUBTFUL]


@pytest.mark.parametrize("kind", [TRANSIT, HEIGHT], ids=["transit", "highest point"])
@pytest.mark.parametrize("name", RELEASES)
def test_any_two_that_are_lost_together_leave_a_doubt(name, kind):
    """Far apart or close, with samples between them or another zero beside them."""
    rows = rows_of([make_scene(**SITE, release={"x": "0", **RELEASES[name]}).exact])
    run = BATCH.solve(rows, RunOptions(times=True))
    assert run.fate.tolist() == [OK]
    gaps = np.diff(run.transit_t)
    closest = (gaps[1:] + gaps[:-1] if name == "three together" else gaps).min()
    assert closest < {"a close pair": 0.03, "three together": 0.125}[name]
    assert len(run.transit_t) > 40
    losing = Losing(kind)
    for first in range(40):
        losing.lost = lambda _, first=first: [first, first + 1]
        assert losing.fate(rows, RunOptions(times=True)) == [DOUBTFUL], first


@pytest.mark.parametrize(
    "options", [RunOptions(times=True), RunOptions(False, False, moved=1)], ids=["run", "moved"]
)
def test_a_row_is_the_same_alone_and_after_others(options):
    rows = rows_of(list(random_kinds(20261124, 10)))
    together = BATCH.solve(rows, options)
    for row in range(len(rows)):
        alone = BATCH.solve(rows[row : row + 1], options)
        for name in ("state", "t_first", "t_last", "turn", "largest_angle", "least_ax", "steps"):
            assert np.array_equal(
                getattr(alone, name)[0], getattr(together, name)[row], equal_nan=True
            ), name
        own = together.transit_row == row
        assert np.array_equal(alone.transit_t, together.transit_t[own])


def test_a_plane_that_passes_north_south_leaves_no_doubt(paris):
    words = (["run.t_end=20000", f"site.latitude={latitude}"] for latitude in (-87, -66))
    rows = rows_of([paris.with_values(two).exact for two in words])
    own, other = (engine.solve(rows, RunOptions()) for engine in (BATCH, OCTET))
    assert own.fate.tolist() == [OK, OK]
    assert own.transits.tolist() == other.transits.tolist()


def test_steps_without_end_stop_a_row_alone(paris):
    """A bob whirls round a hundred thousand times while a swing would take: more steps than a row may have."""
    whirling = {"angle": "90", "azimuth": "0", "azimuth_rate": "1e6"}
    row = make_scene(
        pendulum={"length": "1"}, release=whirling, run={"t_end": "10", "grid_step": "10"}
    ).exact
    usual = paris.with_values(["run.t_end=60"]).exact
    assert BATCH.solve(rows_of([usual, row, usual]), RunOptions()).fate.tolist() == [
        OK,
        STOPPED,
        OK,
    ]


def test_octet_says_the_same_of_every_row():
    rows = rows_of(list(random_kinds(20261124, 20)))
    options = RunOptions(times=True)
    own, other = BATCH.solve(rows, options), OCTET.solve(rows, options)
    for name in (
        "fate",
        "transits",
        "close_pairs",
        "apsides",
        "same_side",
        "transit_row",
        "transit_direction",
    ):
        assert np.array_equal(getattr(own, name), getattr(other, name)), name
    for name in (
        "state",
        "t_first",
        "t_last",
        "apsis_first",
        "apsis_last",
        "turn",
        "largest_angle",
        "transit_t",
    ):
        assert np.allclose(
            getattr(own, name), getattr(other, name), rtol=1e-8, atol=1e-8, equal_nan=True
        ), name
    for name in ("least_ax", "least_bend"):
        assert np.allclose(
            getattr(own, name), getattr(other, name), rtol=1e-5, atol=0, equal_nan=True
        ), name
