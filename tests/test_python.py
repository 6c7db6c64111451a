"""Python as people write it: scenes in any form, mappings and arrays for values, columns of any kind, notebooks."""

from __future__ import annotations

import sys
from decimal import Decimal

import numpy as np
import pandas
import pytest

import compare
import reference
from reference.errors import InputError

ROWS = {"t": [0.0, 60.0], "x": [0.3, -0.176326733], "y": [0.4, -0.415867688]}


@pytest.fixture(scope="module")
def minute():
    return reference.solve("paris", t_end=60, digits=15)


def test_dir_lists_what_is_public_and_no_imported_names():
    for module in (reference, compare):
        assert {name for name in dir(module) if not name.startswith("_")} == set(module.__all__)


@pytest.mark.parametrize(
    "values",
    [
        {"site.latitude": 40.5, "run.t_end": np.float64(60)},
        ["site.latitude=40.5", "run.t_end=60.0"],
        {"site.latitude": "40.5", "run.t_end": "60.0"},
    ],
)
def test_fields_are_replaced_by_words_or_a_mapping(values):
    scene = reference.load_scene("paris", values)
    assert (scene.site.latitude, scene.run.t_end) == ("40.5", "60.0")
    assert reference.load_scene("paris").with_values(values) == scene


def test_numbers_of_any_kind_in_a_scene_are_what_they_print_as():
    number = {"length": Decimal("67.10"), "drag": np.int64(0)}
    document = {
        "id": "a",
        "pendulum": number,
        "release": {"x": np.float64(0.1), "y": Decimal("1E-3")},
    }
    solution = reference.solve(
        document | {"run": {"t_end": np.int64(60), "digits": np.int64(12)}}, level="computed"
    )
    scene = solution.scene
    assert (scene.pendulum.length, scene.pendulum.drag, scene.run.t_end) == ("67.10", "0", "60")
    assert (scene.release.x, scene.release.y, scene.run.digits) == ("0.1", "0.001", 12)
    for wrong in (Decimal("NaN"), Decimal("Infinity"), True):
        with pytest.raises(InputError, match=r"pendulum\.length"):
            reference.parse_scene(document | {"pendulum": {"length": wrong}})


def test_one_word_is_one_word():
    assert reference.load_scene("paris", "site.latitude=40").site.latitude == "40"
    assert len(reference.sweep("paris", "site.latitude=0,10", t_end=60, engine="heyoka")) == 2


@pytest.mark.parametrize(
    "latitudes", [range(0, 90, 30), [0, 30, 60], np.linspace(0, 60, 3), "0:60:30"]
)
def test_an_axis_of_a_sweep_is_a_range_a_list_an_array_or_text(latitudes):
    swept = reference.sweep(
        "paris", {"site.latitude": latitudes, "pendulum.length": 60}, t_end=60, engine="heyoka"
    )
    assert swept["site.latitude"].tolist() == [0, 30, 60]
    assert repr(swept) == "Swept(paris: 3 rows, 3 ok; heyoka)"
    frame = swept.to_pandas()
    assert frame["swing_hz"].tolist() == swept["swing_hz"].tolist()
    assert "<table" in swept._repr_html_()


def test_a_sweep_whose_rows_all_go_through_the_solver_names_it():
    swept = reference.sweep("paris", {"site.latitude": [0]}, t_end=20, digits=18, engine="octet")
    assert repr(swept) == "Swept(paris: 1 row, 1 ok; the solver)"


@pytest.mark.parametrize(
    "columns", [ROWS, {k: np.array(v) for k, v in ROWS.items()}, pandas.DataFrame(ROWS)]
)
def test_columns_by_name_are_judged(columns):
    score = compare.judge(columns, "paris", tolerance=1e-8)
    assert score.agrees
    assert str(score).startswith("candidate agrees with paris (2 rows") and "largest error" in str(
        score
    )
    assert repr(score) == "Score(agrees with paris: 2.6e-10 m)"
    assert score._repr_html_().startswith("<pre>candidate agrees")


@pytest.mark.parametrize(
    ("candidate", "message"),
    [
        (
            {"x": [0.3], "y": [0.4]},
            "candidate: got no t in x, y, expected one column t. Columns are t, x, y",
        ),
        ([[0.0, 0.3, 0.4]], "candidate: got 'list', expected a file"),
        (np.zeros((2, 3)), "candidate: got 'ndarray', expected a file"),
        ({**ROWS, "x": ["a", "b"]}, "candidate: x: got dtype"),
        ({**ROWS, "x": [0.3]}, "candidate: x: got shape"),
    ],
)
def test_other_candidates_are_refused(candidate, message):
    with pytest.raises(InputError) as caught:
        compare.judge(candidate, "paris")
    assert str(caught.value).startswith(message)


def test_columns_may_have_the_names_and_units_of_a_header():
    centimetres = {
        "Time [ms]": [0.0, 60000.0],
        **{f"{name} (cm)": 100 * np.array(ROWS[name]) for name in "xy"},
    }
    score = compare.judge(centimetres, "paris", tolerance=1e-8)
    assert score.agrees and "x from cm, y from cm, converted to SI units" in str(score)


def test_solutions_and_their_tables_are_frames(minute, monkeypatch):
    assert minute.to_pandas().columns.tolist() == ["t", "x", "y", "z", "vx", "vy", "vz"]
    assert minute.to_pandas()["x"].iloc[-1] == minute.x[-1]
    assert minute.transits.to_pandas()["t"].tolist() == minute.transits["t"].tolist()
    assert "<table" in minute._repr_html_() and "<table" in minute.transits._repr_html_()
    monkeypatch.setitem(sys.modules, "pandas", None)
    assert minute._repr_html_() is None
    with pytest.raises(InputError, match="pip install pandas"):
        minute.to_pandas()


def test_numbers_and_directions_of_transits_are_whole_in_a_frame():
    golden = reference.load("hard")
    kinds = golden.transits.to_pandas().dtypes
    assert [kinds[name].kind for name in ("k", "direction", "t")] == ["i", "i", "f"]


def test_columns_of_a_dataset_and_a_solution_are_had_by_name(minute):
    for table in (reference.load("hard"), minute):
        assert table["t"].tolist() == table.t.tolist() and table["vz"].tolist() == table.vz.tolist()
        with pytest.raises(KeyError, match="no column 'q'"):
            table["q"]


def test_a_scene_is_named_in_a_line_and_shown_with_its_fields_in_a_notebook():
    scene = reference.load_scene("hard", {"title": "a <b> pendulum"})
    assert repr(scene) == "Scene(hard: a <b> pendulum)"
    shown = scene._repr_html_()
    assert "a &lt;b&gt; pendulum" in shown and f"length = {scene.pendulum.length}" in shown


@pytest.mark.parametrize("several", [[1], (1, 2), np.array([60.0])])
def test_several_values_for_one_field_are_refused(several):
    with pytest.raises(InputError, match=r"run\.t_end: got .*expected a single value"):
        reference.solve("paris", t_end=several)
    assert reference.load_scene("paris", {"run.t_end": np.array(60.0)}).exact.t_end == 60


def test_lists_in_the_list_of_an_axis_are_refused():
    for nested in ([[1]], [0, [1, 2]], np.array([[1, 2]])):
        with pytest.raises(InputError, match=r"site\.latitude: got .*a list of numbers or words"):
            reference.sweep("paris", {"site.latitude": nested}, t_end=60)


def test_motions_and_errors_are_drawn(minute, tmp_path):
    pytest.importorskip("matplotlib")
    score = compare.judge(ROWS, "paris", tolerance=1e-8)
    for source in ("laboratory", minute, score, score.candidate):
        picture = compare.plot(source)
        drawn = picture._repr_svg_()  # at each call
        assert drawn.lstrip().startswith("<?xml") and "</svg>" in drawn
    picture.save(tmp_path / "motion.png")
    assert (tmp_path / "motion.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(InputError, match=r"path: got"):
        picture.save(tmp_path / "motion.txt")
    with pytest.raises(InputError, match="SCENE"):
        compare.plot("pariss")
