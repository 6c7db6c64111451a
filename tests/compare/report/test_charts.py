"""The charts: each says what it shows, with units and names, on light and dark pages, in the same bytes every time."""

from __future__ import annotations

import itertools
import re
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from compare.approximations import motions
from compare.methods import METHODS
from compare.methods.method import Family
from compare.report import approximations, page, study_charts
from compare.report.drawing import (
    BLUE,
    COLOURS,
    INKS,
    ChartLine,
    legend,
    line_style,
    logarithmic,
    name_beside,
    name_ends,
    picture,
    powers_of_ten,
    sheet,
)
from compare.report.motion import PicturedMotion
from compare.report.motion_pictures import motion_svgs
from compare.report.pareto import cost_of, curves
from compare.report.stability_charts import error_growth, heat_map
from compare.report.study_charts import CPU, ERROR, FAMILY_COLOURS, family_of, ladders
from compare.studies.approximation_errors import TimeRow, error_table
from compare.studies.approximation_limits import SweepRow
from compare.studies.long_runs import LongRun
from compare.studies.row import Row
from compare.studies.stability import Cell
from reference import InputError, load, load_scene
from reference.status import Status

pytest.importorskip("matplotlib")

BOUND = 1e-40
SVG = "{http://www.w3.org/2000/svg}"


def ladder(method, kind, points, formulation="space", status="ok", calls=None):
    return [
        Row(
            method,
            formulation,
            setting,
            kind,
            "binary64",
            status,
            error_m=error,
            cpu_s=cpu,
            rhs_evaluations=calls,
        )
        for setting, error, cpu in points
    ]


def steps(method, scale):
    return ladder(
        method, "step", [(h, h**4, scale / h) for h in (0.5, 0.1, 0.02)], "plane", calls=1000
    )


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
        points = [
            (t, t**0.9 * (i + 1) * tight, 0.01 * (i + 1) * t**-0.1) for t in (1e-6, 1e-9, 1e-12)
        ]
        rows += ladder(name, "tolerance", points, calls=None if "heyoka" in name else 5000)
    rows += ladder("heyoka_double", "tolerance", [(1e-6, 3e-6, 0.02), (1e-9, 2e-9, 0.03)], "angles")
    rows += ladder(
        "heyoka_real",
        "precision",
        [(64, 1e-17, 2.0), (113, 1e-32, 5.0), (160, 1e-39, 9.0)],
        "momentum",
    )
    rows += ladder("limbs", "precision", [(100, 1e-28, 1.0), (200, 1e-60, 4.0)])
    rows.append(
        Row(
            "mpmath_odefun",
            "momentum",
            53,
            "precision",
            "binary64",
            "not_installed",
            "not installed (mpmath)",
        )
    )
    rows.append(
        Row(
            "rk4",
            "plane",
            1.0,
            "step",
            "binary64",
            "missed_transits",
            "1 of 9",
            error_m=0.5,
            cpu_s=0.2,
        )
    )
    return rows


def long_run(method, exponent, size):
    t = np.linspace(0, 1e6, 5000)
    return LongRun(
        method,
        "space",
        0.1,
        Status.OK,
        t=t.tolist(),
        error_m=(size * t**exponent).tolist(),
        bound_m=BOUND,
    )


def cell(scene, method, status, digits=None):
    return Cell(scene, method, "double, plane", Status(status), digits, 9.0, None, "")


@cache
def motion():
    return PicturedMotion.of_golden(load("paris"))


ROWS = study_rows()
USUAL = [curve.label for curve in curves(ROWS) if curve.usual and curve.measured]
RUNS = [
    long_run("double", 1.5, 1e-16),
    long_run("quadruple", 1.0, 1e-33),
    long_run("single", 1.0, 1e-7),
]
CELLS = [
    cell("paris", "rk4", "ok", 7.99),
    cell("hard", "rk4", "silently_wrong"),
    cell("hard", "other", "not_finite"),
]
CHOSEN = [motions()[word] for word in ("linear_g", "method_1", "linear_3d")]
PARIS = error_table(load_scene("paris"), CHOSEN, 600.0, times=(1.0, 10.0, 60.0))
LATITUDES = [
    SweepRow("planar", 60.0, 1e-3 * (1 + value), 1.0, over="latitude", value=value)
    for value in (0.0, 45.0, 90.0)
]
CALLS = [
    label for label in USUAL if METHODS[label].family not in (Family.HEYOKA, Family.MANY_DIGITS)
]
TOLERANCES = [
    label for label in USUAL if METHODS[label].setting == "tolerance" and label != "heyoka_real128"
]
CHARTS = {  # how each is drawn, the titles of its axes with their units, and the names of its lines
    "overview": (lambda: study_charts.overview(ROWS, BOUND), {CPU, ERROR, "failed"}, USUAL),
    "families": (lambda: study_charts.by_family(ROWS, BOUND), {CPU, ERROR, Family.PAPER}, CALLS),
    "evaluations": (
        lambda: study_charts.right_hand_sides(ROWS, BOUND),
        {"evaluations of the right-hand side", ERROR},
        CALLS,
    ),
    "tolerance": (
        lambda: study_charts.achieved_tolerance(ROWS, BOUND),
        {"relative tolerance asked for", ERROR},
        [*TOLERANCES, "error in m = tolerance"],
    ),
    "formulations": (
        lambda: study_charts.formulations(ROWS, BOUND),
        {CPU, ERROR},
        ["space", "angles"],
    ),
    "precision": (
        lambda: study_charts.precision_ladder(ROWS, BOUND),
        {"digits achieved, −log₁₀ of the largest error in m", CPU},
        ["limbs", "heyoka_double"],
    ),
    "growth": (
        lambda: error_growth(RUNS),
        {"time in s", "largest error of position so far in m", "t", "t^1.5", "t²"},
        ["double, space, t^1.50", "quadruple, space, t^1.00", "single, space, t^1.00"],
    ),
    "map": (
        lambda: heat_map(CELLS),
        {"digits kept, at least", "paris", "hard", "rk4 plane", "other plane"},
        ["silently wrong", "not finite"],
    ),
    "approximations": (
        lambda: approximations.chart(PARIS),
        {"time since release, s", "largest error of position up to then, m", "1 mm"},
        ["linear_g, method_1", "linear_3d"],  # two that are one line to the eye are drawn once
    ),
    "latitudes": (
        lambda: approximations.chart(LATITUDES, "plane_error_arcsec"),
        {"latitude, degrees", "largest error of the swing plane, arcsec"},
        ["planar"],
    ),
    "path": (
        lambda: motion_svgs(motion())[0],
        {"x in m, east", "y in m, north"},
        ["Path from above: 9 of the swings in 24 h"],
    ),
    "azimuth": (
        lambda: motion_svgs(motion())[1],
        {"t in h", "degrees, from east to north"},
        ["Azimuth of the swing plane"],
    ),
}


@pytest.fixture(scope="module")
def pictures():
    return {name: draw() for name, (draw, _, _) in CHARTS.items()}


def texts(svg):
    return ["".join(one.itertext()).strip() for one in ET.fromstring(svg).iter(f"{SVG}text")]


@pytest.mark.parametrize("name", CHARTS)
def test_a_chart_says_what_it_shows_and_follows_the_page(pictures, name, size):
    draw, titles, names = CHARTS[name]
    svg = pictures[name]
    root, words = ET.fromstring(svg), texts(svg)
    assert root.tag == f"{SVG}svg" and root.get("role") == "img" and root.get("viewBox")
    assert root.get("aria-label"), "its title, for those who cannot see it"
    assert titles <= set(words)
    assert {word: words.count(word) for word in names} == dict.fromkeys(names, 1)
    assert "var(--" in svg and not re.search(r'stroke="(#000000|black)"', svg), (
        "lines that a dark page would hide"
    )
    assert not re.search(r"<(image|style|script)\b|\bnan\b| style=", svg)
    if name in size(("formulations", "map", "latitudes"), CHARTS):
        assert draw() == svg


@pytest.mark.parametrize("scene", ["over_top", "almost_inverted", "paris"])
def test_titles_of_the_axes_of_a_motion_lie_inside_its_pictures(scene):
    for svg in motion_svgs(PicturedMotion.of_golden(load(scene))):
        upright = re.findall(r'font-size="(\S+)px".*rotate\(-90 (\S+) \S+\)', svg)
        assert all(float(left) > 0.75 * float(height) for height, left in upright), svg[:200]


@pytest.mark.parametrize("scene", ["over_top", "force_free", "barely_over"])
def test_a_line_between_rows_far_apart_is_a_curve_on_the_sphere_not_a_chord(scene):
    motion = PicturedMotion.of_golden(load(scene))
    before, after, controls = motion.line[:-1], motion.line[1:], motion.controls[:-1]
    chord = np.linalg.norm(before + after, axis=1) / 2
    curve = np.linalg.norm(before + 2 * controls + after, axis=1) / 4
    assert chord.min() < 0.97 * motion.length, "rows so far apart that a chord is seen"
    drawn = np.where(np.isnan(curve), chord, curve)
    assert np.abs(drawn - motion.length).max() < 0.01 * motion.length
    path, sphere, *_ = motion_svgs(motion)
    assert all(re.search(r' d="M[^"]*Q ', svg) for svg in (path, sphere))


def test_ids_are_unique_over_all_pictures_of_a_page_and_every_reference_is_met(pictures):
    ids, references = [], set()
    for svg in pictures.values():
        for one in ET.fromstring(svg).iter():
            ids += [one.get("id")] if one.get("id") else []
            references |= {value[1:] for key, value in one.attrib.items() if key.endswith("href")}
        references |= set(re.findall(r"url\(#([^)]+)\)", svg))
    assert len(ids) == len(set(ids))
    assert references <= set(ids)


def test_the_darkest_of_seven_lines_follows_a_dark_page(pictures):
    seven = error_growth([long_run(f"line {i}", 1.0, 1e-16 * (i + 1)) for i in range(7)])
    assert (
        'stroke="var(--ink, #1b1b1b)"' in pictures["overview"]
        and 'stroke="var(--ink, #1b1b1b)"' in seven
    )


@pytest.mark.parametrize(
    ("name", "absent"),
    [("overview", "mpmath_odefun"), ("evaluations", "heyoka_double"), ("tolerance", "rk4")],
)
def test_a_method_without_what_a_chart_shows_is_not_in_it(pictures, name, absent):
    assert absent not in texts(pictures[name])


def test_the_bound_is_a_band_and_the_fitted_law_stands_beside_its_method(pictures):
    assert any("bound of the reference" in word for word in texts(pictures["overview"]))
    assert any(word.startswith("heyoka_real, ∝ digits^") for word in texts(pictures["precision"]))


def test_the_map_reads_without_colour_and_rounds_digits_down(pictures):
    assert {"7", "W", "N"} <= set(texts(pictures["map"]))
    assert "silently wrong: 1." in ET.fromstring(pictures["map"]).get("aria-label")
    assert "8" not in texts(pictures["map"]) and "-1" not in texts(
        heat_map([cell("paris", "rk4", "ok", -1.0)])
    )


def test_approximations_without_an_error_are_no_chart():
    empty = [TimeRow("conical", 20.0, None, None, Status.REFUSED, "no circle")]
    with pytest.raises(InputError, match="error_m"):
        approximations.chart(empty)


def test_pictures_of_rows_that_all_failed_are_none():
    failed = [row for row in ROWS if not row.measured]
    for draw in ("overview", "by_family", "achieved_tolerance", "formulations", "precision_ladder"):
        assert getattr(study_charts, draw)(failed, BOUND) is None
    assert study_charts.right_hand_sides(failed, BOUND) is None


@pytest.mark.parametrize(
    "rows", [steps("rk4", 1)[:1], ladder("rk4", "step", [(0.1, 0.0, 1.0), (0.2, 1e-3, 0.5)])]
)
def test_a_single_row_makes_a_picture_and_an_error_of_zero_harms_nothing(rows):
    assert "rk4" in texts(study_charts.overview(rows, 0.0))


def test_without_many_digits_the_overview_has_one_panel_and_a_far_bound_leaves_it_alone():
    picture = study_charts.overview(steps("rk4", 1), 1e-150)
    assert not any("bound of the reference" in one for one in texts(picture))


def test_a_program_of_others_with_many_digits_is_named_too():
    rows = steps("rk4", 1) + ladder("my_own", "tolerance", [(1e-9, 1e-8, 1.0), (1e-30, 1e-29, 9.0)])
    assert "my_own" in texts(study_charts.overview(rows, 0.0))
    assert "my_own" in texts(study_charts.by_family(rows, 0.0))


def test_every_method_has_a_family_and_within_a_picture_no_two_look_alike():
    looks = [line.style for line in ladders(curves(ROWS), cost_of, cost_of)]
    assert len({(one["color"], one["marker"]) for one in looks}) == len(looks) > 20
    assert family_of("my_own_program") == family_of("external: ./run") == Family.USERS
    assert len(set(FAMILY_COLOURS.values())) == len(Family)


def drawn_legend(size, inside=False):
    """Draw a legend of so many lines; return the boxes of its names, of the axes and of the figure."""
    lines = [
        ChartLine(f"method {i}", [1, 10], [5, 5 + i], line_style(COLOURS[i % 7], i))
        for i in range(size)
    ]
    with sheet((9.5, 8.6)) as figure:
        axes = figure.subplots()
        axes.set(xlim=(0, 10), ylim=(0, 10))
        legend(axes, lines, inside=inside)
        figure.canvas.draw()
        return (
            [one.get_window_extent() for one in axes.get_legend().get_texts()],
            axes.get_window_extent(),
            figure.bbox,
        )


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
    lines = [
        ChartLine(name, [0, x], [0, 1], line_style(COLOURS[0], 0))
        for name, x in (("west", -0.5), ("east", 0.5))
    ]
    with sheet((6, 4)) as figure:
        axes = figure.subplots()
        axes.set(xlim=(-1, 1), ylim=(0, 2))
        name_ends(axes, lines)
        figure.canvas.draw()
        boxes = {one.get_text(): one.get_window_extent() for one in axes.texts}
        ends = {line.name: axes.transData.transform((line.x[-1], 1))[0] for line in lines}
    assert boxes["west"].x1 < ends["west"] and ends["east"] < boxes["east"].x0


@pytest.mark.parametrize(
    ("exponents", "texts"),
    [
        ([-2, 0, 3], ["0.01", "1", "1000"]),
        ([-4, -2, 0], ["10⁻⁴", "10⁻²", "10⁰"]),
        ([3, 12], ["10³", "10¹²"]),
    ],
)
def test_ticks_of_one_axis_are_plain_text_in_one_style(exponents, texts):
    assert powers_of_ten(exponents) == texts


@pytest.mark.parametrize("heights", [[5e-1, 5.1e-1, 5.2e-1, 1e-9], [1e-12] * 4, [1.0] * 30])
def test_names_beside_the_axes_do_not_lie_on_each_other_and_are_in_the_order_of_their_ends(heights):
    lines = [
        ChartLine(f"program {i}", [0, 1], [1e-3, y], line_style(COLOURS[i % 7], i))
        for i, y in enumerate(heights)
    ]
    with sheet((8, 8)) as figure:
        axes = figure.subplots()
        logarithmic(axes, "y", 1e-12, 1.0)
        name_beside(axes, lines)
        figure.canvas.draw()
        boxes = [one.get_window_extent() for one in axes.texts]
        names = [one.get_text() for one in axes.texts]
        frame = axes.get_window_extent()
        page = figure.bbox
    assert names == [line.name for line in sorted(lines, key=lambda line: line.y[-1])]
    for below, above in itertools.pairwise(boxes):
        assert not below.overlaps(above) and below.y0 < above.y0
    for box in boxes:
        assert frame.x1 < box.x0 and box.x1 <= page.x1
        assert page.y0 <= box.y0 and box.y1 <= page.y1


def test_a_picture_in_a_file_has_the_colours_of_a_dark_page_too():
    css = (Path(page.__file__).parent / "page.css").read_text(encoding="utf-8")
    dark = css[css.index("prefers-color-scheme: dark") :]
    with sheet((3, 2)) as figure:
        axes = figure.subplots()
        axes.plot([0, 1], [0, 1], color=BLUE)
        text = picture(figure, "svg").decode()
    assert not re.search(r"fill: #ffffff|fill: white", text), "a ground that stays white"
    for name, light in INKS.items():
        on_dark = re.search(rf"--{name}: (#\w+)", dark)[1]
        for use in ("fill", "stroke"):
            assert f'[style*="{use}: {light}"] {{ {use}: {on_dark} !important }}' in text
    ET.fromstring(text)
