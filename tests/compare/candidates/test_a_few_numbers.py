"""Five numbers of files that hold the Paris pendulum."""

from __future__ import annotations

import io

import numpy as np
import pytest

from compare.candidates.external import arguments
from compare.candidates.read import read, read_stream, read_transits
from reference import load, load_scene


def test_paris_as_it_is_read():
    folder = load("paris").path
    golden, zeros = read(folder / "grid.csv"), read_transits(folder / "transits.csv")
    assert len(golden.t) == 1441  # a row a minute for a day, and the release
    # m: 3, 4, 5
    assert np.hypot(golden.columns["x"][0], golden.columns["y"][0]) == pytest.approx(0.5)
    assert golden.columns["z"][0] == pytest.approx(
        -66.998, abs=1e-3
    )  # m: 0.5² / (2 * 67) = 0.002 above the lowest point
    # s: from one end of a swing in x to the other
    assert zeros[0] == pytest.approx(16.42 / 2, abs=0.02)
    assert len(zeros) == pytest.approx(86400 / 8.218, abs=2)


def test_a_row_in_other_units_and_a_command():
    row = read_stream(io.BytesIO(b"time [ms];x [cm];y\n1500;30;0,4\n"), "mine")
    assert (row.t[0], row.columns["x"][0], row.columns["y"][0]) == (1.5, 0.3, 0.4)
    clock = read_stream(io.BytesIO(b"t,x,y\n12:34:56,0.3,0.4\n12:35:56,0.1,0.1\n"), "mine")
    assert clock.clock_s == 45296 and clock.t[1] == 60  # 12 * 3600 + 34 * 60 + 56 at the first row
    assert arguments("./mine {length} {x0}", load_scene("paris")) == ["./mine", "67", "0.3"]
