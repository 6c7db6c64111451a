"""Five numbers that the commands print of the Paris pendulum."""

from __future__ import annotations

import json

import pytest


def test_a_sweep_from_the_pole_to_paris(foucault):
    pytest.importorskip("pyarrow")
    words = ("--over", "latitude=90,48.846111", "--t-end", "600", "--engine", "heyoka", "--json")
    pole, paris = json.loads(foucault("sweep", "paris", *words)[1])["rows"]
    # 360° in a sidereal day of 23.93 h
    assert pole["precession_deg_per_h"] == pytest.approx(-15.04, abs=0.02)
    # times sin 48.85° = 0.753
    assert paris["precession_deg_per_h"] == pytest.approx(-11.33, abs=0.02)
    assert 1 / paris["frequency_hz"] == pytest.approx(16.43, abs=0.01)  # s: 2π √(67 / 9.8)


def test_a_millimetre_and_a_minute(foucault, tmp_path):
    (tmp_path / "mine.csv").write_text("t,x,y\n0,0.3,0.4\n60,-0.176326733,-0.414867688\n")
    status, out, _ = foucault("score", "paris", tmp_path / "mine.csv", "--json", "--no-diagnosis")
    score = json.loads(out)
    assert (status, score["verdict"]) == (1, "disagrees")
    assert score["max_error_m"] == pytest.approx(0.001, rel=1e-5)
    assert score["covered"] == pytest.approx(60 / 86400)
