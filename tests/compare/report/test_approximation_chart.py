"""The chart of approximations: every name appears in it once, and the same rows give the same bytes."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import pytest

from compare.report.charts.approximations import plot
from compare.studies.approximation_errors import TimeRow, error_table
from compare.studies.approximation_limits import SweepRow
from reference import InputError, load_scene
from reference.status import Status

pytest.importorskip("matplotlib")
SVG = "{http://www.w3.org/2000/svg}"


def texts(svg):
    return [(element.text or "").strip() for element in ET.fromstring(svg).iter(f"{SVG}text")]


def test_names_units_and_limits_stand_in_the_picture():
    rows = error_table(load_scene("paris"), ["linear_g", "method_1", "linear_3d"], 600.0, times=(1.0, 10.0, 60.0))
    svg = plot(rows, title="Paris")
    words = texts(svg)
    assert "Paris" in words
    assert "linear_g, method_1" in words  # one line to the eye, drawn once
    assert "linear_3d" in words
    assert "1 mm" in words
    assert any("position" in word and word.endswith(", m") for word in words)
    assert plot(rows, title="Paris") == svg


def test_a_sweep_is_drawn_over_its_own_axis():
    rows = [SweepRow("planar", "latitude", value, 60.0, 1e-3 * (1 + value), 1.0) for value in (0.0, 45.0, 90.0)]
    words = texts(plot(rows, "plane_error_arcsec"))
    assert "latitude, degrees" in words
    assert "planar" in words


def test_two_charts_fit_into_one_page():
    rows = [SweepRow("planar", "latitude", value, 60.0, 1e-3 * (1 + value), 1.0) for value in (0.0, 45.0, 90.0)]
    svgs = plot(rows), plot(rows, "plane_error_arcsec")
    ids = [set(re.findall(r' id="([^"]+)"', svg)) for svg in svgs]
    assert all(svg.startswith("<svg") for svg in svgs)
    assert ids[0]
    assert not ids[0] & ids[1]


def test_nothing_to_draw_is_said():
    empty = [TimeRow("conical", 20.0, None, None, Status.REFUSED, "no circle")]
    with pytest.raises(InputError, match="error_m"):
        plot(empty)
    with pytest.raises(InputError, match="colour"):
        plot(empty, "colour")
