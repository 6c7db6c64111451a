"""Five numbers of the Paris pendulum as the only row of a sweep."""

import pytest

import reference


def test_paris_as_a_row():
    row = reference.sweep("paris", {"site.latitude": ["48.846111"]}, t_end=3600)
    assert row["t_first_s"][0] == pytest.approx(8.2177924296, abs=1e-9)  # the first transit
    assert row["frequency_hz"][0] == pytest.approx(0.0608436, abs=1e-7)
    assert row["precession_deg_per_h"][0] == pytest.approx(-11.34, abs=0.02)  # clockwise
    assert row["transits"][0] == 438  # two a swing of 16.4355 s
    # 0.6 m on 67 m, about the plumb line
    assert row["max_angle_deg"][0] == pytest.approx(0.5, abs=0.1)
