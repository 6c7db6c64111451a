"""The charts: well-formed SVG, the same bytes every time, every method named."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from compare.methods import METHODS
from compare.methods.method import Family
from compare.report import charts
from compare.report.charts.drawing import COLOURS, Line, legend, line_style, name_ends, power_of_ten, sheet
from compare.report.charts.heat_map import LETTERS
from compare.report.charts.ladders import FAMILY_COLOURS, family_of, ladders
from compare.report.pareto import cost_of, curves
from compare.studies.row import Row
from reference import InputError

BOUND = 1e-40
SVG = "{http://www.w3.org/2000/svg}"


def ladder(method, kind, points, formulation="space", status="ok", calls=None):
    return [
        Row(method, formulation, setting, kind, "binary64", status, error_m=error, cpu_s=cpu, rhs_evaluations=calls)
        for setting, error, cpu in points
    ]


def steps(method, scale):
    return ladder(method, "step", [(h, h**4, scale / h) for h in (0.5, 0.1, 0.02)], "plane", calls=1000)


def study_rows():
    """Something of everything: twenty-two methods, two formulations, failures with and without a cost."""
    rows = [
        row
        for i, name in enumerate(("rk4", "rkng56", "rkng67", "rkmk4", "gauss_legendre"))
        for row in steps(name, i + 1)
    ]
    names = [name for name in METHODS if METHODS[name].setting == "tolerance"]
    for i, name in enumerate(names):
        tight = 1e-9 if name == "heyoka_real128" else 1.0
        points = [(t, t**0.9 * (i + 1) * tight, 0.01 * (i + 1) * t**-0.1) for t in (1e-6, 1e-9, 1e-12)]
        rows += ladder(name, "tolerance", points, calls=None if "heyoka" in name else 5000)
    rows += ladder("heyoka_double", "tolerance", [(1e-6, 3e-6, 0.02), (1e-9, 2e-9, 0.03)], "angles")
    rows += ladder("heyoka_real", "precision", [(64, 1e-17, 2.0), (113, 1e-32, 5.0), (160, 1e-39, 9.0)], "momentum")
    rows += ladder("limbs", "precision", [(100, 1e-28, 1.0), (200, 1e-60, 4.0)], status="extrapolated")
    rows.append(
        Row("mpmath_odefun", "momentum", 53, "precision", "binary64", "not_installed", "not installed (mpmath)")
    )
    rows.append(Row("rk4", "plane", 1.0, "step", "binary64", "missed_transits", "1 of 9", error_m=0.5, cpu_s=0.2))
    return rows


ROWS = study_rows()
HISTORIES = [
    charts.ErrorHistory("double", t := np.linspace(0, 1e6, 5000), 1e-16 * t**1.5, 1.5),
    charts.ErrorHistory("quadruple", t, 1e-33 * t, 1.0),
    charts.ErrorHistory("single", t, 1e-7 * t),
]
CELLS = [
    charts.Field("paris", "rk4", "ok", 7.9),
    charts.Field("hard", "rk4", "silently_wrong"),
    charts.Field("hard", "x", "not_finite"),
]
PICTURES = {
    "overview": lambda: charts.overview(ROWS, BOUND),
    "families": lambda: charts.by_family(ROWS, BOUND),
    "evaluations": lambda: charts.right_hand_sides(ROWS, BOUND, 86400.0),
    "tolerance": lambda: charts.achieved_tolerance(ROWS, BOUND),
    "formulations": lambda: charts.formulations(ROWS, BOUND),
    "precision": lambda: charts.precision_ladder(ROWS, BOUND),
    "growth": lambda: charts.error_growth(HISTORIES, BOUND),
    "map": lambda: charts.heat_map(CELLS),
}


@pytest.fixture(scope="module")
def pictures():
    return {name: draw() for name, draw in PICTURES.items()}


def texts(svg):
    return ["".join(one.itertext()).strip() for one in ET.fromstring(svg).iter(f"{SVG}text")]


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_is_one_svg_element_that_says_what_it_is(pictures, name):
    root = ET.fromstring(pictures[name])
    assert root.tag == f"{SVG}svg"
    assert root.get("role") == "img"
    assert root.get("aria-label")
    assert root.get("viewBox")
    assert not re.search(r"<(image|style|script)\b|\bnan\b", pictures[name])


@pytest.mark.parametrize("name", ["overview", "growth", "map"])
def test_the_same_rows_make_the_same_bytes(pictures, name):
    assert PICTURES[name]() == pictures[name]


def test_ids_are_unique_over_all_pictures_of_a_page_and_every_reference_is_met(pictures):
    ids, references = [], set()
    for svg in pictures.values():
        for one in ET.fromstring(svg).iter():
            ids += [one.get("id")] if one.get("id") else []
            references |= {value[1:] for key, value in one.attrib.items() if key.endswith("href")}
        references |= set(re.findall(r"url\(#([^)]+)\)", svg))
    assert len(ids) == len(set(ids))
    assert references == set(ids)


def test_the_darkest_lines_follow_a_dark_page(pictures):
    seven = [charts.ErrorHistory(f"line {i}", t, 1e-16 * (i + 1) * t) for i in range(7)]
    for svg in (pictures["overview"], charts.error_growth(seven, BOUND)):
        assert "stroke: var(--ink, #1b1b1b)" in svg
        assert "stroke: #000000" not in svg


def test_every_measured_method_is_named_in_the_overview(pictures):
    named = texts(pictures["overview"])
    for curve in curves(ROWS):
        if curve.measured and curve.own:
            assert curve.label in named
    assert "mpmath_odefun" not in named


def test_failed_rows_stand_as_crosses_and_the_bound_as_a_band(pictures):
    named = texts(pictures["overview"])
    assert "failed" in named
    assert any("bound of the reference" in one for one in named)


def test_methods_without_evaluations_or_tolerance_are_not_drawn_there(pictures):
    assert "heyoka_double" not in texts(pictures["evaluations"])
    assert "rk4" in texts(pictures["evaluations"])
    assert "rk4" not in texts(pictures["tolerance"])
    assert "error in m = tolerance" in texts(pictures["tolerance"])


def test_formulations_are_named_by_their_words(pictures):
    assert {"space", "angles"} <= set(texts(pictures["formulations"]))


def test_the_fitted_law_stands_in_the_precision_ladder(pictures):
    assert any(one.startswith("heyoka_real, ∝ digits^") for one in texts(pictures["precision"]))


def test_growth_names_the_slopes_and_each_lines_own(pictures):
    named = texts(pictures["growth"])
    assert {"t", "t^1.5", "t²"} <= set(named)
    assert "double, t^1.50" in named
    assert "quadruple, t^1.00" in named
    assert "single" in named


def test_the_map_reads_without_colour(pictures):
    named = texts(pictures["map"])
    assert {"7", "W", "N", "paris", "hard", "silently wrong"} <= set(named)
    assert "silently wrong: 1." in ET.fromstring(pictures["map"]).get("aria-label")


def test_digits_are_rounded_down_in_the_map():
    assert charts.Field("a", "b", "ok", 7.99).mark == "7"
    assert charts.Field("a", "b", "ok", -1.0).mark == "0"


def test_letters_of_the_map_are_all_different():
    letters = list(LETTERS.values())
    assert len(set(letters)) == len(letters)


@pytest.mark.parametrize("cells", [[], [charts.Field("a", "b", "broken")]])
def test_a_map_of_nothing_or_of_an_unknown_class_is_refused(cells):
    with pytest.raises(InputError):
        charts.heat_map(cells)


@pytest.mark.parametrize("lines", [[], [charts.ErrorHistory("still", np.array([0.0, 1.0]), np.zeros(2))]])
def test_growth_of_nothing_is_refused(lines):
    with pytest.raises(InputError):
        charts.error_growth(lines, BOUND)


def test_pictures_of_rows_that_all_failed_are_none():
    failed = [row for row in ROWS if not row.measured]
    assert charts.overview(failed, BOUND) is None
    assert charts.by_family(failed, BOUND) is None
    assert charts.right_hand_sides(failed, BOUND, 1.0) is None
    assert charts.achieved_tolerance(failed, BOUND) is None
    assert charts.formulations(failed, BOUND) is None
    assert charts.precision_ladder(failed, BOUND) is None


def test_a_single_row_makes_a_picture():
    assert "rk4" in texts(charts.overview(steps("rk4", 1)[:1], BOUND))


def test_an_error_of_zero_is_drawn_nowhere_but_harms_nothing():
    rows = ladder("rk4", "step", [(0.1, 0.0, 1.0), (0.2, 1e-3, 0.5)])
    assert "rk4" in texts(charts.overview(rows, 0.0))


def test_every_method_has_a_family_and_within_a_picture_no_two_look_alike():
    looks = [line.style for line in ladders(curves(ROWS), cost_of, cost_of)]
    assert len({(one["color"], one["marker"]) for one in looks}) == len(looks) > 20
    assert family_of("my_own_program") == family_of("external: ./run") == Family.OTHERS
    assert len(set(FAMILY_COLOURS.values())) == len(Family)


def drawn_legend(size, inside=False):
    """Draw a legend of so many lines; return the boxes of its names, of the axes and of the figure."""
    lines = [Line(f"method {i}", [1, 10], [5, 5 + i], line_style(COLOURS[i % 7], i)) for i in range(size)]
    with sheet((9.5, 8.6)) as figure:
        axes = figure.subplots()
        axes.set(xlim=(0, 10), ylim=(0, 10))
        legend(axes, lines, inside=inside)
        figure.canvas.draw()
        return [one.get_window_extent() for one in axes.get_legend().get_texts()], axes.get_window_extent(), figure.bbox


@pytest.mark.parametrize("size", [1, 45])
def test_a_legend_stands_beside_the_axes_and_within_the_picture(size):
    names, axes, page = drawn_legend(size)
    assert len(names) == size
    for i, one in enumerate(names):
        assert axes.x1 < one.x0 < one.x1 <= page.x1 and page.y0 <= one.y0
        assert not any(one.overlaps(other) for other in names[:i])


def test_a_legend_inside_the_axes_takes_no_room_from_them():
    names, axes, _ = drawn_legend(8, inside=True)
    assert all(axes.x0 < one.x0 < one.x1 < axes.x1 for one in names)


def test_names_at_ends_stand_on_the_side_away_from_the_middle():
    lines = [Line(name, [0, x], [0, 1], line_style(COLOURS[0], 0)) for name, x in (("west", -0.5), ("east", 0.5))]
    with sheet((6, 4)) as figure:
        axes = figure.subplots()
        axes.set(xlim=(-1, 1), ylim=(0, 2))
        name_ends(axes, lines)
        figure.canvas.draw()
        boxes = {one.get_text(): one.get_window_extent() for one in axes.texts}
        ends = {line.name: axes.transData.transform((line.x[-1], 1))[0] for line in lines}
    assert boxes["west"].x1 < ends["west"] and ends["east"] < boxes["east"].x0


@pytest.mark.parametrize(("value", "text"), [(1e-9, "10⁻⁹"), (0.01, "0.01"), (1000, "1000"), (1e12, "10¹²")])
def test_ticks_are_plain_text(value, text):
    assert power_of_ten(value) == text


def test_a_name_stands_once_though_the_picture_has_two_panels(pictures):
    named = texts(pictures["overview"])
    assert all(named.count(curve.label) <= 1 for curve in curves(ROWS))


def test_without_many_digits_the_overview_has_one_panel_and_a_far_bound_leaves_it_alone():
    picture = charts.overview(steps("rk4", 1), 1e-150)
    assert not any("bound of the reference" in one for one in texts(picture))


def test_a_program_of_others_with_many_digits_is_named_too():
    rows = steps("rk4", 1) + ladder("my_own", "tolerance", [(1e-9, 1e-8, 1.0), (1e-30, 1e-29, 9.0)])
    assert "my_own" in texts(charts.overview(rows, 0.0))
    assert "my_own" in texts(charts.by_family(rows, 0.0))
