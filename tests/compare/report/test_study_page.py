"""The report of a study: its three files, its page as HTML, and its table as text."""

from __future__ import annotations

import csv
import json
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import asdict
from html.parser import HTMLParser

import pytest
from lines import unwrapped
from places import ROOT

from compare.report import page as parts
from compare.report import study_page
from compare.report.page import Html, PageTable
from compare.report.pareto import tidy
from compare.report.study_tables import busy, cpu, failures, setting, text_table
from compare.studies.campaign import load_per_core
from compare.studies.row import Row
from reference.status import Status

VOID = {"meta", "br", "link", "path", "use"}
NASTY = 'died of <script>alert("x")</script> & "quotes"'


def row(
    method,
    setting_,
    error_m,
    cpu_s,
    status=Status.OK,
    formulation="space",
    kind="tolerance",
    **more,
):
    return Row(
        method,
        formulation,
        setting_,
        kind,
        "binary64",
        status,
        error_m=error_m,
        cpu_s=cpu_s,
        **more,
    )


def study_document(rows=None, **more):
    rows = rows or [
        row("rk4", 0.1, 1e-4, 0.1, formulation="plane", kind="step", rhs_evaluations=4_000_000, cpu_spread=0.02),
        row("rk4", 0.01, 1e-8, 1.0, formulation="plane", kind="step", rhs_evaluations=40_000_000, steps=10_000_000),
        row("heyoka_double", 1e-8, 2e-7, 0.01, formulation="momentum", h_drift=1e-12, transit_error_s=3e-9),
        row("heyoka_double", 2.0**-52, 3e-13, 0.02, formulation="momentum"),
        row("heyoka_double", 2.0**-52, 9e-13, 0.025),
        row("scipy_dop853", 1e-6, None, 40.0, Status.EXTRAPOLATED, reason="measured to t = 90 s"),
        row("scipy_lsoda", 1e-12, None, 0.7, Status.GAVE_UP, reason=NASTY, reached_t=123.5),
        row("scipy_bdf", 1e-12, 0.5, 0.7, Status.MISSED_TRANSITS, reason="1 of 9 transits is missed", reached_t=900.0),
        row("mpmath_odefun", 53, None, None, Status.NOT_INSTALLED, kind="precision",
            reason="not installed (mpmath): pip install 'foucault-reference[methods]'"),
    ]  # fmt: skip
    return {
        "scene": "paris",
        "title": "",
        "t_end": 900.0,
        "limit_s": 8.0,
        "programs": {},
        "candidates": [],
        "reference": {"level": "enclosed", "bound_m": 5e-39, "transits": 109},
        "machine": {
            "processor": "Some <CPU>",
            "system": "Linux",
            "python": "3.11",
            "heyoka": "7.13",
        },
        "rows": [asdict(one) for one in rows],
        **more,
    }


class Reader(HTMLParser):
    """Checks that tags close in order, and collects tables and text."""

    def __init__(self, text):
        super().__init__()
        self.open, self.tables, self.text = [], [], []
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attributes):
        if tag not in VOID:
            self.open.append(tag)
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append((dict(attributes).get("class", ""), []))
        if tag in ("td", "th"):
            self.tables[-1][-1][1].append("")

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)
        if {"td", "th"} & set(self.open):
            self.tables[-1][-1][1][-1] += data


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    out = tmp_path_factory.mktemp("report") / "new" / "folder"
    assert study_page.REPORT.write(study_document(), out) == out / "index.html"
    return out


@pytest.fixture(scope="module")
def read(written):
    return Reader((written / "index.html").read_text(encoding="utf-8"))


def table_of(read, *titles):
    return next(one for one in read.tables if set(titles) <= set(one[0][1]))


def test_the_folder_holds_the_document_and_its_rows_and_the_page(written):
    assert sorted(path.name for path in written.iterdir()) == [
        "SHA256SUMS",
        "index.html",
        "rows.csv",
        "study.json",
    ]
    assert json.loads((written / "study.json").read_text()) == study_document()
    with (written / "rows.csv").open(newline="") as stream:
        back = list(csv.DictReader(stream))
    assert len(back) == 9
    assert list(back[0])[:4] == ["method", "formulation", "setting", "kind"]
    assert float(back[3]["setting"]) == 2.0**-52
    assert (back[6]["reason"], back[8]["error_m"]) == (NASTY, "")


def test_the_page_has_every_row_with_its_marks(read):
    head, *body = table_of(read, "status", "reason")
    assert len(body) == 9
    place = {title: i for i, title in enumerate(head[1])}
    by_setting = {
        (cells[place["method"]], cells[place["formulation"]], cells[place["setting"]]): (
            kind,
            cells,
        )
        for kind, cells in body
    }
    assert (
        by_setting["rk4", "plane", "0.01 s"][1][place["evaluations"]].replace("\u202f", "")
        == "40000000"
    )
    assert "front" in by_setting["heyoka_double", "momentum", "2.22e-16"][0]
    assert "front" not in by_setting["heyoka_double", "space", "2.22e-16"][0]
    assert by_setting["scipy_dop853", "space", "1e-6"][1][place["CPU s"]] == "~40.0"
    kind, cells = by_setting["scipy_lsoda", "space", "1e-12"]
    assert "failed" in kind
    assert cells[place["last t, s"]] == "123.5"
    assert cells[place["reason"]] == NASTY


def test_failures_are_listed_with_their_reason_and_each_way_to_fail_with_what_to_do_about_it(read):
    rows = {cells[0]: cells for _, cells in table_of(read, "settings", "reason")[1:]}
    assert set(rows) == {"scipy_lsoda", "scipy_bdf", "mpmath_odefun"}
    assert "foucault-reference[methods]" in rows["mpmath_odefun"][-1]
    assert rows["scipy_bdf"][2] == "missed transits"
    words = {cells[0]: cells[1:] for _, cells in table_of(read, "word", "what to do")[1:]}
    assert words.keys() == {"gave up", "missed transits", "not installed"}
    assert words["missed transits"] == [
        Status.MISSED_TRANSITS.meaning,
        Status.MISSED_TRANSITS.advice,
    ]


def test_the_times_that_failed_rows_reached_are_in_increasing_order_and_each_once():
    rows = [
        row("scipy_lsoda", tol, None, 0.7, Status.GAVE_UP, reason="too stiff", reached_t=reached_t)
        for tol, reached_t in ((1e-6, 100.0), (1e-7, 20.0), (1e-8, 100.0), (1e-9, None))
    ]
    html = failures(rows)
    assert html is not None
    assert "20, 100<" in html


def test_the_front_is_a_table_of_its_own(read):
    fronts = next(
        one for one in read.tables if one[0][1] == ["method", "setting", "error m", "CPU s", ""]
    )
    assert [cells[:2] for _, cells in fronts[1:]] == [
        ["heyoka_double", "1e-8"],
        ["heyoka_double", "2.22e-16"],
    ]


def test_the_page_is_self_contained_and_escapes_what_was_said_by_others(written, read):
    html = (written / "index.html").read_text()
    assert not re.search(r"<(link|script|img|iframe)\b|@import|url\((?!#)", html)
    assert set(re.findall(r'(?:src|href)="([^#"][^"]*)"', html)) == set()
    ids = re.findall(r' id="([^"]+)"', html)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'href="#([^"]+)"', html)) <= set(ids)
    pictures = re.findall(r"<svg.*?</svg>", html, flags=re.DOTALL)
    # no precision ladder: heyoka_real is not among the rows
    assert len(list(map(ET.fromstring, pictures))) == 5
    assert NASTY in "".join(read.text) and "Some <CPU>" in "".join(read.text)


def test_the_page_says_where_and_how_it_was_measured(read):
    text = "".join(read.text)
    for word in (
        "python 3.11, heyoka 7.13",
        "level enclosed, bound 5.0e-39 m",
        "in one thread",
        "nearest double",
    ):
        assert word in text
    assert "At 1e-6 m the cheapest method is heyoka_double" in text


@pytest.fixture
def no_pictures(monkeypatch):
    """Pages without their pictures, which cost most of what a page does."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)


@pytest.mark.usefixtures("no_pictures")
def test_title_and_limit_are_on_the_page():
    html = study_page.page_text(study_document(title="A & B"))
    assert "<title>Error against run time: A &amp; B</title>" in html
    assert "8 CPU seconds" in html


def test_the_same_document_makes_the_same_bytes(written, tmp_path):
    study_page.REPORT.write(json.loads((written / "study.json").read_text()), tmp_path)
    for path in written.iterdir():
        assert (tmp_path / path.name).read_bytes() == path.read_bytes(), path.name


def test_a_study_in_which_everything_failed_still_has_a_page():
    html = study_page.page_text(
        study_document([row("my_program", 0.1, None, None, Status.GAVE_UP, reason="broken")])
    )
    assert "No method reached an error of 1e-3 m." in html
    assert "broken" in html
    Reader(html)


@pytest.mark.usefixtures("no_pictures")
def test_without_matplotlib_the_page_says_what_is_missing():
    html = study_page.page_text(study_document())
    assert "<svg" not in html
    assert "foucault-reference[plot]" in html


def test_the_text_table_has_every_row_and_the_sentences():
    text = study_page.REPORT.text(study_document())
    for word in (
        "rk4",
        "scipy_dop853",
        "mpmath_odefun",
        "~40.0",
        "At 1e-6 m",
        "1 of 9 transits is missed",
    ):
        assert word in unwrapped(text)
    marked = [line.split() for line in text.splitlines() if line.startswith("*  ")]
    # a wide table goes on below, with mark, method and setting again
    runs = {(method, setting) for _, method, setting, *_ in marked}
    assert runs == {("heyoka_double", "1e-8"), ("heyoka_double", "2.22e-16")}
    assert [line for line in text.splitlines() if len(line) > 80] == []
    told = unwrapped(text)
    assert told.count("missed transits") == 2  # the row's status, and what to do about it
    assert Status.MISSED_TRANSITS.advice in told


@pytest.mark.parametrize(
    ("value", "text"),
    [(1e-4, "1e-4"), (2.0**-52, "2.22e-16"), (0.05, "0.05"), (113, "113"), (0.002, "0.002")],
)
def test_settings_are_short(value, text):
    assert tidy(value) == text
    assert setting(row("x", value, 1.0, 1.0, kind="step")) == f"{text} s"


def test_a_short_number_is_its_value_to_three_digits():
    """A zero of an exponent or of a whole number stays."""
    powers = [float(f"1e{k}") for k in range(-40, 7)]
    errors = [float(f"2.56e{k}") for k in range(-40, 7)]
    numbers = [*powers, *errors, *(-number for number in errors)]
    assert [float(tidy(number)) for number in numbers] == numbers


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.012345, "0.0123"), (1.2345, "1.23"), (123.4, "123"), (0.0, "0"), (None, "")],
)
def test_cpu_seconds_have_three_digits(value, text):
    assert cpu(value) == text


def test_parts_escape_text_and_keep_html():
    assert parts.text("a < b") == "a &lt; b"
    assert parts.text(Html("<b>")) == "<b>"
    made_table = PageTable({"<x>": "number"}, [["1 & 2"]], ["front"]).html("a < b")
    for piece in ("&lt;x&gt;", "1 &amp; 2", "a &lt; b", '<tr class="front">', 'class="number"'):
        assert piece in made_table
    assert "<em>" in parts.page("t", [parts.section("A b, c", Html("<em>x</em>"))])
    link = '<a href="#a-b-c">A b, c</a>'
    assert link in parts.page("t", [parts.section("A b, c", "x"), parts.section("D", "y")])
    assert link not in parts.page("t", [parts.section("A b, c", "x")])  # of one heading alone


def test_a_table_says_the_same_as_html_as_text_and_as_csv():
    table = PageTable({"name": "", "size": "number"}, [["one", 0.1 + 0.2], ["two & more", None]])
    assert table.lines() == [
        "name                       size",
        "one         0.30000000000000004",
        "two & more",
    ]
    assert table.csv() == "name,size\none,0.30000000000000004\ntwo & more,\n"
    assert '<td>two &amp; more</td><td class="number"></td>' in table.html()


def test_neither_the_report_nor_its_parts_load_matplotlib():
    modules = "compare.report.study_page, compare.report.page, compare.report.study_charts"
    code = f"import {modules}, sys; print('matplotlib' in sys.modules)"
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert process.stdout.strip() == "False"


@pytest.mark.usefixtures("no_pictures")
def test_the_declared_order_stands_beside_the_observed_one():
    rows = [
        row(
            "rk4", 0.1 / 2**i, 1e-3 / 16**i, 0.1, formulation="plane", kind="step", steps=100 * 2**i
        )
        for i in range(5)
    ]
    document = study_document(
        [*rows, row("scipy_dop853", 1e-6, 1e-5, 4.0), row("heyoka_double", 1e-8, 2e-7, 0.01)]
    )
    read = Reader(study_page.page_text(document))
    head, *body = table_of(read, "order", "observed")
    place = {title: i for i, title in enumerate(head[1])}
    found = {cells[0]: (cells[place["order"]], cells[place["observed"]]) for _, cells in body}
    assert found == {
        "rk4": ("4", "4.00 ± 0.00"),
        "scipy_dop853": ("8", "–"),
        "heyoka_double": ("–", "–"),
    }
    text = unwrapped(study_page.REPORT.text(document))
    assert "rk4 4 4.00 ± 0.00 scipy_dop853 8 –" in text


@pytest.mark.parametrize(
    ("load", "spread", "words"),
    [
        (
            0.5,
            0.05,
            "0.5 processes for each core (median), 0.5 at most; repeats of a run differ by 5 % (median)",
        ),
        (2.5, 0.05, "The machine was busy: ratios of costs drift too"),
        (0.5, 0.9, "Costs were uneven: ratios of costs drift too"),
        (None, None, "not known"),
    ],
)
def test_a_busy_machine_is_said_to_be_so(load, spread, words):
    rows = [row("rk4", 0.1, 1e-3, 1.0, kind="step", cpu_spread=spread, load=load)]
    text = busy(rows)
    assert words in text
    assert f"load: {text}" in unwrapped(study_page.REPORT.text(study_document(rows)))
    assert ("busy" in text) == ((load or 0) > 1)


@pytest.mark.skipif(not hasattr(os, "getloadavg"), reason="this system does not tell its load")
def test_the_load_is_that_of_the_system_over_its_cores(monkeypatch):
    monkeypatch.setattr(os, "getloadavg", lambda: (6.0, 1.0, 1.0))
    monkeypatch.setattr(os, "cpu_count", lambda: 4)
    assert load_per_core() == 1.5
    monkeypatch.delattr(os, "getloadavg")
    assert load_per_core() is None


def test_the_page_of_a_study_of_precisions_says_what_digits_cost_and_holds_no_picture_of_single_points(
    written,
):
    rows = [row("heyoka_double", 2.0**-52, 1e-12, 0.001, formulation="momentum")]
    rows += [
        row("limbs", bits, 10.0 ** (-bits / 3.3), bits**2 / 1e6, kind="precision")
        for bits in (113, 160, 256)
    ]
    text = study_page.page_text(study_document(rows))
    assert "What digits cost" in text and "Every row" in text
    whole = (written / "index.html").read_text(encoding="utf-8")
    for heading in (
        "Error against CPU time",
        "Family by family",
        "Tolerance asked for",
        "Least cost",
        "Pareto front<",
    ):
        assert heading in whole and heading not in text, heading


def test_a_run_over_a_part_of_the_span_has_no_error_and_is_no_failure():
    part = row(
        "scipy_dop853",
        1e-6,
        None,
        40.0,
        Status.EXTRAPOLATED,
        reason="measured to t = 90 s",
        end_error_m=1e-9,
    )
    page, text = study_page.page_text(study_document([part])), text_table(study_document([part]))
    assert "What failed" not in page and "Failed:" not in text
    assert "~40.0" in page and "~40.0" in text
    assert "without its error (see --limit)" in unwrapped(text)


def test_the_users_own_program_is_in_the_main_results_with_how_it_was_measured():
    rows = [
        row("rk4", 0.1, 1e-4, 0.1, kind="step"),
        row("rk4", 0.01, 1e-8, 1.0, kind="step"),
        row("gl4", 0.1, 1e-7, 0.39, kind="step"),
        row("old.csv", 0.0, 2e-2, None, kind="file", formulation="file"),
    ]
    document = study_document(rows, programs={"gl4": "./gl4 {setting}"}, candidates=["old.csv"])
    text = " ".join(text_table(document).split())
    assert "Your gl4: 0.39 s at 1e-3 m, 3.9 times rk4;" in text
    assert "Your old.csv: 2.0e-02 m at best." in text
    page = study_page.page_text(document)
    assert "Your gl4: 0.39 s at 1e-3 m" in page
    assert "CPU time of its whole process" in page
    assert "whole process" not in study_page.page_text(study_document())
