"""`foucault plot`: pictures of scenes, datasets and files; what cannot be drawn is refused, and nothing is written."""

from __future__ import annotations

import re
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import compare
import reference
from compare.candidates.arrays import candidate_of
from compare.observed.swing_plane import Gauge
from compare.report.drawing import COLOURS
from compare.report.motion import PicturedMotion
from compare.report.motion_pictures import length_unit, time_unit
from compare.report.plot import error_picture, motion_of

pytest.importorskip("matplotlib")


@pytest.fixture(scope="module")
def paris():
    return PicturedMotion.of_golden(reference.load("paris"))


def test_rows_far_apart_are_filled_in_by_single_swings(paris):
    swings = np.split(paris.line, np.flatnonzero(np.isnan(paris.line[:, 0])))
    assert len(swings) == paris.swings + 1 == 10
    first = paris.line[: np.flatnonzero(np.isnan(paris.line[:, 0]))[0]]
    assert np.abs(first[0] - paris.rows[0]).max() < 1e-12
    # one swing later the bob is back, but for the turn of the plane: 0.05 degrees
    assert 1e-5 < np.hypot(*(first[-1] - first[0])[:2]) < 1e-3


def test_the_swing_plane_of_paris_turns_as_it_should_and_of_a_file_too(paris):
    hours = paris.plane_t / 3600
    steps = (np.diff(paris.plane) + 90) % 180 - 90
    turned = steps.sum() / (hours[-1] - hours[0])
    # not about the ellipsoid's normal: 1.5e-3 less
    about_the_plumb_line = Gauge.of(reference.load_scene("paris")).turn
    assert turned == pytest.approx(-np.degrees(about_the_plumb_line) * 3600, rel=1e-4)
    x, y, _ = paris.rows.T
    alone = PicturedMotion.of_candidate(candidate_of("mine.csv", {"t": paris.t, "x": x, "y": y}))
    steps = (np.diff(alone.plane) + 90) % 180 - 90
    assert steps.sum() / np.ptp(alone.plane_t) * 3600 == pytest.approx(turned, rel=0.01)
    # a line through its rows would follow nothing
    assert len(alone.line) == 0 and alone.swings == 0


def test_a_dense_file_is_a_line_and_a_wide_one_is_on_its_sphere():
    t = np.linspace(0, 6, 200)
    far = candidate_of("mine.csv", {"t": t, "x": np.cos(t), "y": 0 * t, "z": np.sin(t)})
    motion = PicturedMotion.of_candidate(far)
    assert len(motion.line) == 200 and motion.wide
    assert not PicturedMotion.of_candidate(
        candidate_of("mine.csv", {"t": t, "x": np.cos(t), "y": 0 * t})
    ).wide


@pytest.mark.parametrize(
    ("size", "unit"),
    [(1200.0, "km"), (67.0, "m"), (0.3, "m"), (0.03, "mm"), (3e-4, "µm"), (1e-9, "nm"), (0.0, "m")],
)
def test_lengths_are_told_in_units_of_their_size(size, unit):
    factor, word = length_unit(size)
    assert word == unit and (not size or 0.1 <= size * factor <= 1000)


@pytest.mark.parametrize(
    ("span", "unit"), [(5e5, "d"), (86_400, "h"), (3600, "min"), (60, "s"), (0.2, "ms")]
)
def test_spans_are_told_in_units_of_their_size(span, unit):
    factor, word = time_unit(span)
    assert word == unit and 1 <= span * factor <= 1000


def test_of_a_dataset_that_ships_only_the_span_is_drawn():
    """Where its grid is not the span's, the scene is solved."""
    for t_end, rows in ((3600, 61), (90, 3)):
        motion = motion_of(reference.load_scene("paris", {"run.t_end": t_end}))
        assert motion.t[-1] == t_end == 60 * (rows - 1) or rows == len(motion.t) == 3
        assert 0.9 * t_end < motion.transit_t[-1] <= t_end
        assert len(motion.transit_t) == len(motion.transit_x) == len(motion.directions)


def test_a_bob_at_rest_has_no_swing():
    motion = PicturedMotion.of_golden(reference.load("at_rest"))
    assert motion.swings == len(motion.plane) == 0


def test_a_dataset_and_a_file_are_drawn(foucault, tmp_path):
    out = tmp_path / "paris.svg"
    assert foucault("plot", "paris", "--out", out) == (0, f"{out}: the picture\n", "")
    text = out.read_text()
    assert all(
        word in text for word in ("Path from above", "Azimuth of the swing plane", "10514 transits")
    )
    again = tmp_path / "again.svg"
    foucault("plot", "paris", "--out", again)
    assert again.read_bytes() == out.read_bytes()
    mine, png = tmp_path / "mine.csv", tmp_path / "mine.png"
    mine.write_text("t,x,y\n" + "".join(f"{t},{t * t},{t}\n" for t in range(9)))
    assert foucault("plot", mine, "--out", png, "--what", "path")[0] == 0
    assert png.read_bytes().startswith(b"\x89PNG")


def texts_of(path):
    texts = ET.fromstring(path.read_bytes()).iter("{http://www.w3.org/2000/svg}text")
    return [text.text for text in texts]


def test_a_picture_names_what_it_draws(foucault, tmp_path):
    out = tmp_path / "paris.svg"
    foucault("plot", "paris", "--out", out)
    names = {"first swing", "later swings", "release", "eastern end", "western end"}
    assert names <= set(texts_of(out))


@pytest.mark.parametrize(("start", "name"), [(0, "release"), (5, "first row")])
def test_the_first_row_is_the_release_only_at_zero(foucault, tmp_path, start, name):
    mine = tmp_path / "mine.csv"
    out = tmp_path / "mine.svg"
    mine.write_text("t,x,y\n" + "".join(f"{t},{t * t},{t}\n" for t in range(start, start + 9)))
    assert foucault("plot", mine, "--out", out)[0] == 0
    names = {"release", "first row"}
    assert names & set(texts_of(out)) == {name}


@pytest.fixture
def score():
    """A program whose error is 1e-7 m or more after the release, where it has none."""
    golden = reference.load("paris")
    t, x, y = (golden[name][:50] for name in ("t", "x", "y"))
    off = np.where(t > 0, 1e-7 + 1e-9 * t, 0.0)
    return compare.judge({"t": t, "x": x + off, "y": y}, "paris")


def test_the_axis_of_errors_begins_at_the_smallest_after_the_release(score, tmp_path):
    path = tmp_path / "error.svg"
    compare.plot(score).save(path)
    ticks = [text for text in texts_of(path) if re.fullmatch("10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+", text)]
    assert ticks[0] == "10⁻⁷"


def test_a_release_without_an_error_has_no_point_on_the_logarithmic_axis(score, tmp_path):
    path = tmp_path / "error.svg"
    compare.plot(score).save(path)
    curve = rf'd="([^"]*)"[^>]*stroke: {COLOURS[0]}; stroke-width'
    (points,) = re.findall(curve, path.read_text())
    assert len(re.findall("[ML]", points)) == len(score.errors.t) - 1


def test_two_lines_that_coincide_are_both_seen(score, tmp_path):
    path = tmp_path / "error.svg"
    path.write_bytes(error_picture([score, score], path))
    curves = re.findall(
        rf"stroke: ({COLOURS[0]}|{COLOURS[1]}); stroke-width: ([\d.]+)", path.read_text()
    )
    below, above = [float(width) for _, width in curves]
    assert below > 1.5 * above


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("pariss",), "Did you mean paris?"),
        (("paris", "--what", "spere"), "Did you mean sphere?"),
        (("paris", "--what", "sphere"), "a picture of paris: path, plane or transits"),
        (("paris", "--out", "nowhere/x.svg"), "a path in an existing folder"),
        (("paris", "--out", "x.gif"), "a path that ends in .svg, .png or .pdf"),
        (("mine.csv", "--t-end", "3"), "has no effect for a file"),
        (("mine.csv",), "mine.csv: line 2"),
    ],
)
def test_what_cannot_be_drawn_is_refused_and_nothing_is_written(
    foucault, tmp_path, monkeypatch, words, said
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.csv").write_text("t,x,y\n0,1,two\n")
    status, out, err = foucault("plot", *words)
    assert (status, out) == (2, "") and said in err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.csv"]


def test_a_matplotlib_that_cannot_be_imported_is_told_before_anything_is_solved(
    foucault, tmp_path, monkeypatch
):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    status, _, err = foucault("plot", "laboratory", "--out", str(tmp_path / "a.svg"))
    assert (status, list(tmp_path.iterdir())) == (2, [])
    assert "matplotlib.figure" in err and "--force-reinstall" in err
