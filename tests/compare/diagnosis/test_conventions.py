"""What is said of a file's conventions, of right and wrong files alike."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from mistakes import told
from scipy.special import ellipj, ellipk
from small_scenes import make_scene

from compare.diagnosis.case import FileRows
from compare.diagnosis.conventions import heights
from reference import load_scene, trajectory


def test_no_wide_swing_counts_time_in_another_unit(size):
    """100 exact pendulums of 30° to 85° in a plane (Jacobi's elliptic functions), rows 0.02 s to 1 s apart.

    Their g is 9.81 m/s² where the scene has 9.8, and nothing else is wrong. In every run each thirteenth of them.
    """
    length, rate = 67.0, math.sqrt(9.81 / 67.0)
    site = {"gravity": "9.8", "gravity_is": "effective", "rotation_rate": "0"}
    swings = product(
        (30, 40, 50, 55, 60, 65, 70, 75, 80, 85),
        (0.02, 0.033333, 0.05, 0.1, 0.14, 0.2, 0.25, 0.3, 0.5, 1.0),
    )
    for degrees, step in list(swings)[:: size(13, 1)]:
        modulus = math.sin(math.radians(degrees) / 2)
        span = 20 * 4 * ellipk(modulus**2) / rate
        times = np.arange(0, min(span, 60) if step < 0.3 else span, step)
        _, cosine, delta, _ = ellipj(rate * times, modulus**2)
        half = modulus * cosine / delta  # sin(θ/2), greatest at t = 0
        x = 2 * length * half * np.sqrt(1 - half**2)
        release, run = (
            {"angle": str(degrees), "azimuth": "0"},
            {"t_end": repr(float(times[-1])), "transits": False},
        )
        scene = make_scene("wide", pendulum={"length": "67"}, site=site, release=release, run=run)
        found = told(scene, times, {"x": x, "y": 0 * x}, 1e-6)
        assert not found.agrees
        assert found.words == {"gravity_9.81"}, (degrees, step)


def test_a_bob_that_leaves_the_sphere_keeps_its_horizontal_columns_in_order():
    """Columns x, height, north of a cord of 10 m that stretches: without heights, x and north are left."""
    times = 0.1 * np.arange(100)
    cord = 10 + 1e-4 * np.sin(3 * times)
    east, north = 0.5 * np.cos(times), 0.3 * np.sin(times)
    down = -np.sqrt(cord**2 - east**2 - north**2)
    read = heights(FileRows(times, np.column_stack([east, down, north]), 0.0, 0.0), 10.0)
    assert [part.id for part in read.conventions] == ["vertical_is_not_z", "off_the_sphere"]
    np.testing.assert_array_equal(
        np.sort(np.abs(read.plane).max(axis=0)), [0.3 * np.abs(np.sin(times)).max(), 0.5]
    )


@pytest.mark.parametrize(("cut_rows", "spacing_s"), [(14, 0.5), (3, 2.0), (33, 0.5), (50, 2.0)])
@pytest.mark.parametrize("rate", [7.292115e-5, 2 * math.pi / 86400])
def test_first_rows_may_be_left_out_and_the_clock_set_to_0(cut_rows, spacing_s, rate):
    """A swing later the bob is nearly where it was: that is no release elsewhere, and no row that is late."""
    scene = load_scene("paris", ["run.t_end=900", "run.transits=false", "inputs=binary64"])
    times = np.arange(0, 600, spacing_s)
    made = scene.with_values([f"site.rotation_rate={rate!r}"])
    positions = trajectory(made, times)[cut_rows:, :2]
    columns = {"x": positions[:, 0].copy(), "y": positions[:, 1].copy()}
    found = told(scene, times[: len(positions)], columns, 7e-7)
    right = rate == 7.292115e-5
    assert found.words == ({"rows_late"} if right else {"rows_late", "solar_day"})
    (convention,) = found.explanation.conventions
    shift_s = f"{cut_rows * spacing_s:.6g} s"
    assert convention.text.endswith(f"behind its rows by {cut_rows} rows ({shift_s})")


def test_a_swapped_release_is_no_turned_plane():
    """The plane turned by the angle between the two leaves less than the tolerance."""
    scene = load_scene("museum", ["inputs=binary64", "run.transits=false"])
    times = np.arange(0, 900, 1.0)
    x, y = scene.release.x, scene.release.y
    swapped = scene.with_values([f"release.x={y}", f"release.y={x}"])
    columns = dict(zip("xy", trajectory(swapped, times)[:, :2].T.copy(), strict=True))
    found = told(scene, times, columns, 1e-6)
    assert found.words == {"swapped"}


@pytest.mark.parametrize(
    ("axis", "other"), [("x", "coriolis_sign"), ("y", "hemisphere")], ids=["x", "y"]
)
def test_a_mirrored_release_may_be_a_mirrored_axis_and_a_force_of_the_wrong_sign(axis, other):
    scene = load_scene("paris", ["run.t_end=900", "run.transits=false", "inputs=binary64"])
    times = np.arange(0, 600, 1.0)
    mirrored = scene.with_values([f"release.{axis}=-{getattr(scene.release, axis)}"])
    columns = dict(zip("xy", trajectory(mirrored, times)[:, :2].T.copy(), strict=True))
    found = told(scene, times, columns, 7e-7)
    assert not found.words - {f"release.{axis}|{other}+{'x_west' if axis == 'x' else 'y_south'}"}
    assert {f"release.{axis}", other} <= found.alternatives


def test_both_signs_of_a_release_are_no_axes():
    scene = load_scene("museum", ["run.transits=false", "inputs=binary64"])
    times = np.arange(0, 900, 1.0)
    mirrored = scene.with_values(
        [f"release.{axis}=-{getattr(scene.release, axis)}" for axis in "xy"]
    )
    columns = dict(zip("xy", trajectory(mirrored, times)[:, :2].T.copy(), strict=True))
    assert told(scene, times, columns, 1e-6).words == {"release.x", "release.y"}
