"""`foucault score --t-end`: the comparison ends there, and what comes later is ignored and counted."""

from __future__ import annotations

import json

import numpy as np
import pytest

from reference import load


@pytest.fixture
def late(tmp_path):
    """Write a candidate that is right for ten minutes and wrong afterwards, and the times of its transits."""
    golden = load("paris.binary64")
    rows = np.column_stack([golden.t, golden.x, golden.y])[:31]
    rows[11:, 1] += 1e-3
    (tmp_path / "mine.csv").write_text("t,x,y\n" + "".join(f"{t!r},{x!r},{y!r}\n" for t, x, y in rows.tolist()))
    times = golden.transits["t"][:200].tolist()
    (tmp_path / "zeros.csv").write_text("t\n" + "".join(f"{t!r}\n" for t in times))
    return tmp_path, times


def test_later_rows_and_transits_are_ignored_and_a_note_says_how_many(foucault, late):
    folder, times = late
    words = ("score", "paris", folder / "mine.csv", "--transits", folder / "zeros.csv", "--no-diagnosis")
    assert foucault(*words)[0] == 1
    status, out, _ = foucault(*words, "--t-end", "600")
    assert status == 0
    assert "11 rows, t = 0 to 600 of 600 s" in out
    assert "Note: 20 rows after t = 600 s ignored." in out
    inside = sum(t <= 600 for t in times)
    document = json.loads(foucault(*words, "--t-end", "600", "--json")[1])
    assert document["transits"]["matched"] == inside == 73
    assert document["transits"]["extra"] == 0


def test_nothing_is_said_if_no_row_is_later(foucault, late):
    folder, _ = late
    out = foucault("score", "paris", folder / "mine.csv", "--t-end", "1800", "--no-diagnosis")[1]
    assert "31 rows" in out and "ignored" not in out


def test_an_end_before_the_first_row_is_refused(foucault, tmp_path):
    (tmp_path / "mine.csv").write_text("t,x,y\n120,0.1,0.1\n")
    status, out, err = foucault("score", "paris", tmp_path / "mine.csv", "--t-end", "60")
    assert (status, out) == (2, "")
    assert "t_end: got '60', expected a time from the first row on, which is at t = 120 s" in err


def test_an_approximation_is_compared_up_to_there(foucault):
    status, out, _ = foucault("score", "paris", "--approximation", "linear_3d", "--t-end", "120", "--no-diagnosis")
    assert status == 1
    assert "3 rows, t = 0 to 120 of 120 s" in out
