"""The pages: every block of code in them is run or is data, every link leads somewhere, and they make a site."""

from __future__ import annotations

import contextlib
import doctest
import io
import json
import locale
import math
import re
import shlex
import shutil
import ssl
import sys
import tomllib
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from functools import cache, partial
from pathlib import Path

import causes_page
import commands_page
import functions_page
import numpy as np
import pytest
import typer
from notebooks import GALLERY, code_cells, text_of
from pages import (
    PAGES,
    blocks,
    code_spans,
    commands,
    of_language,
    output,
    output_here,
    shows,
    write_files,
)
from places import ROOT

import compare
import reference
from compare.diagnosis import conventions
from compare.diagnosis.advice import DO
from foucault import commands as commands_of_foucault
from reference.scenes.scene import Scene

TUTORIAL, SCENE, MEASURED, ORACLE, SWEEPS, STUDIES, CONTRIBUTING, API = (
    "docs/tutorial.md",
    "docs/scene.md",
    "docs/measured.md",
    "docs/oracle.md",
    "docs/sweeps.md",
    "docs/studies.md",
    "CONTRIBUTING.md",
    "docs/api.md",
)
INDENTED = None
# where the files are that a page names without a folder
BESIDE = {ORACLE: ["compare/score", "compare/diagnosis"]}
EVERYWHERE = ["compare", "reference", "tests", "docs"]
# what the blocks of each page are in; all but formulas, and what Sphinx itself carries out, is run
LANGUAGES = {
    "README.md": {"sh", "console", "pycon"},  # sh by .ci/run, the others by test_readme.py
    CONTRIBUTING: {"sh"},
    TUTORIAL: {"sh", "console", "python", "toml"},
    SCENE: {"console", "toml"},
    MEASURED: {"console", "pycon", "text", "toml"},
    ORACLE: {"python", "console"},
    SWEEPS: {"console", "sh", "bash"},
    STUDIES: {"sh"},
    API: {"{eval-rst}", "pycon", "python"},
    "docs/commands.md": {"text"},
    # by test_paste.py; the console's line is of files that the page has no more than the names of
    "docs/paste.md": {"javascript", "python", "octave", "text", "console"},
    "docs/cite.md": {"{literalinclude} ../CITATION.cff"},
    "docs/format.md": {INDENTED},  # formulas
    "docs/index.md": {"{include} ../README.md", "{toctree}"},
    "docs/theorem/README.md": {"text"},  # a statement of Coq, held by test_theorem.py
    "reference/enclosure/THEOREM.md": {INDENTED},  # formulas
}


@pytest.fixture
def typed(foucault, capfd):
    """What a line prints in a folder."""
    return partial(output_here, foucault=foucault, capfd=capfd)


def test_what_a_page_s_blocks_are_in_is_known_and_so_is_what_runs_them():
    languages = {page: {block.language for block in blocks(page)} for page in PAGES}
    assert {page: words for page, words in languages.items() if words} == LANGUAGES


def _texts(picture):
    """Return the texts of a picture: its names, titles and ticks."""
    texts = ET.fromstring(picture.read_bytes()).iter("{http://www.w3.org/2000/svg}text")
    return [text.text for text in texts]


def test_every_command_of_the_tutorial_in_its_turn_prints_what_it_shows(tmp_path, typed):
    assert write_files(TUTORIAL, tmp_path) == [
        "pendulum.py",
        "sphere.py",
        "test_pendulum.py",
        "mine.toml",
    ]
    for command, shown in commands(TUTORIAL):
        got = typed(command, tmp_path)
        assert shows(shown, got), f"{command}\n{got}"
    assert (tmp_path / "foucault.xml").is_file()
    assert _texts(tmp_path / "error.svg") == _texts(ROOT / "docs/tutorial.svg")


def test_every_command_of_the_page_on_scenes_prints_what_it_shows(tmp_path, typed):
    assert write_files(SCENE, tmp_path) == ["church.toml"]
    for command, shown in commands(SCENE):
        got = typed(command, tmp_path)
        assert shows(shown, got), f"{command}\n{got}"
    template = reference.load_scene(tmp_path / "mine.toml")
    assert (template.id, template.site.gravity_is, template.release.angle) == (
        "mine",
        "effective",
        "5",
    )


def test_from_a_tape_measure_to_the_hundredth_passage(tmp_path, typed):
    assert write_files(MEASURED, tmp_path) == ["hall.toml", "passages.csv"]
    for command, shown in commands(MEASURED):
        got = typed(command, tmp_path)
        assert shows(shown, got), f"{command}\n{got}"
    late = (tmp_path / "passages.csv").read_text(encoding="utf-8").replace("446.38", "446.5")
    (tmp_path / "late.csv").write_text(late, encoding="utf-8")
    assert "late.csv disagrees" in typed(
        'foucault score hall --transits late.csv --section "gate 127"', tmp_path
    )


def test_the_page_on_the_oracle_says_of_its_program_what_the_first_notebook_does(tmp_path, typed):
    """It is one program, and the notebook's test judges it."""
    write_files(ORACLE, tmp_path)
    printed = [
        [float(word) for word in row.split(",")]
        for row in typed("python swing.py", tmp_path).splitlines()[1:]
    ]
    cell, explained, *_ = code_cells(
        json.loads((GALLERY / "first_verdict.ipynb").read_text("utf-8"))
    )
    program, _, judged = "".join(cell["source"]).partition("first = compare.judge(")
    names = {}
    exec(program, names)
    columns = eval(judged.partition(', "paris"')[0], names)
    assert np.array(printed) == pytest.approx(np.column_stack([*columns.values()]), abs=1e-12)
    (_, shown), *_ = commands(ORACLE)
    reasons = shown.partition("\n")[2].partition("…")[0]
    assert reasons == text_of(explained)


@pytest.mark.long
def test_the_program_of_the_page_on_the_oracle_is_judged_as_it_says(tmp_path, typed):
    assert write_files(ORACLE, tmp_path) == ["swing.py"]
    (command, shown), *_ = commands(ORACLE)
    got = typed(command, tmp_path)
    assert shows(shown, got), got


def test_the_table_of_golden_functions_is_that_of_the_files():
    page = functions_page.page()
    assert page == functions_page.PAGE.read_text("utf-8"), (
        "run: python tests/helpers/functions_page.py"
    )
    table = (
        page.partition(functions_page.BEFORE)[2]
        .partition(functions_page.AFTER)[0]
        .split("|---|\n")[1]
    )
    cells = {
        line.split(" | ")[0].removeprefix("| "): line.split(" | ") for line in table.splitlines()
    }
    assert all(float(row[4]) <= 4e-15 for row in cells.values() if row[4] != "at rest")
    assert all(float(row[6]) <= 2 for row in cells.values())


COLUMN_WORDS = {
    f"column_{word}" for word in ("copied", "constant", "mirrored", "scaled", "moved", "late")
}


def test_the_table_of_causes_is_that_of_the_code():
    assert causes_page.page() == causes_page.PAGE.read_text("utf-8"), (
        "run: python tests/helpers/causes_page.py"
    )
    source = (ROOT / "compare/diagnosis/conventions.py").read_text(encoding="utf-8")
    words = set(re.findall(r'Deviation\("(\w+)"', source)) | {
        word for word, _ in conventions.AXES_SAID.values() if word
    }
    source = (ROOT / "compare/diagnosis/observed.py").read_text(encoding="utf-8")
    words |= {
        f"column_{word}" for word in re.findall(r'_mapped\(\s*"(\w+)"', source)
    } & COLUMN_WORDS
    words |= {f"plane_{word}" for word in ("scaled", "turned", "moved")}
    told = {word for words in causes_page.HABITS for word in words.split(", ")}
    # those are made of parts
    assert words | {"z_down", "z_from_lowest", "rows_late", "rows_early"} == told


def test_what_an_advice_says_to_add_is_made_of_numbers_that_are_printed(foucault):
    for word in ("no_centrifugal", "effective_gravity", "no_tilt", "no_lift"):
        assert (
            "q is the suspension's distance from the Earth's axis (`foucault show` prints it)"
            in DO[word]
        )
    assert not [word for word, text in DO.items() if re.search(r"\bR\b", text)], "R is not printed"
    status, out, _ = foucault("show", "paris")
    assert status == 0 and re.search(r"Earth's axis +4205335\.7\d+ m away", out)


def test_the_page_on_scenes_has_every_field_with_its_default_unit_and_meaning():
    rows = {}
    for name, info in Scene.model_fields.items():
        inside = getattr(info.annotation, "model_fields", None)
        rows |= (
            {f"{name}.{key}": field for key, field in inside.items()} if inside else {name: info}
        )
    page = (ROOT / SCENE).read_text(encoding="utf-8")
    for name, info in rows.items():
        default = (
            "" if info.is_required() or info.default in (None, "", (), {}) else str(info.default)
        )
        default = {"True": "true"}.get(default, default)
        unit = (info.json_schema_extra or {}).get("unit", "")
        assert f"| `{name}` | {default} | {unit} | {info.description} |" in page


def test_drag_and_azimuth_are_what_the_page_on_scenes_says(tmp_path, typed):
    """A cord of 12.3 m at 51.48 degrees, pulled 5 degrees to the south-west, half as wide after 20 minutes."""
    path = tmp_path / "hall.toml"
    path.write_text(
        'pendulum = {length = "12.3", drag = "0.00115525"}\nsite = {latitude = "51.48", gravity_is = "effective"}\n'
        'release = {angle = "5", azimuth = "-135"}\n'
        'run = {t_end = "1200", grid_step = "0.2", level = "computed", digits = 10}\n',
        encoding="utf-8",
    )
    solved = reference.solve(path)
    x, y = (np.array(values, float) for values in (solved.x, solved.y))
    assert (
        x[0]
        == pytest.approx(y[0])
        == pytest.approx(-12.3 * math.sin(math.radians(5)) / math.sqrt(2))
    )
    width = np.hypot(x, y)
    swing = 36  # rows of one swing
    assert width[-swing:].max() / width[:swing].max() == pytest.approx(0.5, rel=0.005)
    motion = json.loads(typed(f"foucault show {path} --json", tmp_path))["motion"]
    sidereal = -15.0410671786 * math.sin(math.radians(51.48))
    # the rest is what Airy found
    assert motion["precession_deg_per_h"] == pytest.approx(sidereal, rel=0.004)
    assert motion["full_turn_h"] == pytest.approx(360 / abs(motion["precession_deg_per_h"]))


def test_the_error_budget_is_that_of_the_dataset():
    page = (ROOT / "docs/error_budget.md").read_text(encoding="utf-8")
    golden, doubles = reference.load("paris"), reference.load("paris.binary64")
    manifest = golden.manifest.model_dump()
    proof, bounds = manifest["enclosure"], manifest["bounds"]
    assert (
        f"at most {proof['position_radius_m']} m, and {proof['transit_radius_s']} s for a transit"
        in page
    )
    assert f"between the {len(golden.directions)} that are listed" in page
    assert (
        f"{bounds['grid']['x']} m in *x* and *y*, {bounds['grid']['z']} m in *z*, {bounds['transit_s']} s"
        in page
    )
    for check in manifest["cross_checks"]:
        assert float(check["position_m"]) < 1e-46
    own, other = (
        zip(*(table.exact(name) for name in ("x", "y", "z")), strict=True)
        for table in (golden, doubles)
    )
    gaps = (
        [float(a - b) for a, b in zip(p, q, strict=True)] for p, q in zip(own, other, strict=True)
    )
    apart = max(math.hypot(*gap) for gap in gaps)
    assert f"depart by up to {apart:.1e} m" in page
    late = max(
        float(abs(p - q))
        for p, q in zip(golden.transits.exact("t"), doubles.transits.exact("t"), strict=True)
    )
    assert f"its transits by up to {late:.1e} s" in page


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_experiments_of_the_oracle_measure_what_the_page_shows(tmp_path, typed, size):
    """In every run those of the first ten minutes, whose errors alone are others than those of the page's hour."""
    metres = re.compile(r"(?<= )[\d.e-]+(?= m\b)")
    for command, shown in list(commands(ORACLE))[1:]:
        asked = command.replace("/tmp/", f"{tmp_path}/").replace(
            "--t-end 3600", size("--t-end 600", "--t-end 3600")
        )
        got = typed(asked, ROOT).replace(f"{tmp_path}/", "/tmp/")
        ours, theirs = size([metres.sub("0", text) for text in (shown, got)], [shown, got])
        assert shows(ours, theirs), f"{asked}\n{got}"
    kept = {path.stem for path in (tmp_path / "runs").iterdir()}
    assert kept == {"as_given", "experiments", "no_rotation", "quarter_g"}


def test_what_the_tutorial_installs_can_be_had():
    (block,) = of_language(TUTORIAL, "sh")
    (extras,) = re.findall(r"'\.\[([\w,]+)\]'", block)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(extras.split(",")) <= set(project["optional-dependencies"])


@pytest.mark.parametrize("page", [API, MEASURED])
def test_the_lines_of_python_on_a_page_print_what_it_shows(page):
    (block,) = of_language(page, "pycon")
    parser, runner = doctest.DocTestParser(), doctest.DocTestRunner()
    runner.run(parser.get_doctest(block, {}, page, page, 0))
    assert runner.summarize(verbose=False).failed == 0


def test_the_programs_and_the_test_of_the_page_on_python_pass(tmp_path, typed):
    program, gates, swing, box, limits, name = write_files(API, tmp_path)
    assert -67 < float(typed(f"python {program}", tmp_path)) < -66.99
    assert 8.21 < Fraction(typed(f"python {gates}", tmp_path)) < 8.22  # half a swing
    assert re.match(r"16\.4355\d+ ± \de-1\d s", typed(f"python {swing}", tmp_path))
    low, high = map(float, typed(f"python {box}", tmp_path).split())
    assert low < 599.898 < high < low + 0.01  # what the point's own transit is: 599.8984 s
    assert typed(f"python {limits}", tmp_path).startswith(
        "pendulum.length moves the period by 1.2e-04 s at most: 93."
    )
    assert typed(f"python -m pytest -q {name}", tmp_path).startswith(".  ")


def shell(page: str) -> Iterator[list[str]]:
    """Yield the words of each command of a page's sh blocks, comments left out."""
    for block in of_language(page, "sh"):
        for line in block.replace("\\\n", " ").splitlines():
            yield shlex.split(line, comments=True)


def test_the_tables_of_the_page_on_sweeps_are_what_is_printed(tmp_path, typed):
    """Digit by digit but the last, and the size of the errors: octet and heyoka round differently."""
    lengths = []
    for command, shown in commands(SWEEPS):
        pairs = [*zip(shown.splitlines(), typed(command, tmp_path).splitlines(), strict=False)]
        for line, printed in pairs[:-1]:
            # heads, and how many rows there are
            if not line.strip()[:1].isdigit() or "rows" in line:
                assert line.split() == printed.split()
                continue
            for one, other in zip(line.split(), printed.split(), strict=True):
                unit = min(float(Decimal(word).as_tuple().exponent) for word in (one, other))
                if re.fullmatch(r"\d[.]\de-\d\d", one):
                    assert 0.02 < float(one) / float(other) < 50
                elif unit:
                    assert float(one) == pytest.approx(float(other), abs=10 ** max(unit + 2, -12))
                else:
                    assert one == other
        assert pairs[-1][0] == "…"
        lengths.append(len(pairs))
    assert len(lengths) == 2 and min(lengths) > 6


def test_the_commands_of_the_page_on_sweeps_work(foucault, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("heights.csv").write_text("0\n1000\n", encoding="utf-8")
    Path("draws.csv").write_text("pendulum.length,site.latitude\n60,40\n61,41\n", encoding="utf-8")
    rows = []
    for name, *words in shell(SWEEPS):
        # the last --t-end counts
        status, out, err = foucault(*words, "--t-end", "20", "--engine", "heyoka")
        assert (name, status) == ("foucault", 0), err
        rows.append(int(re.findall(r"^(\d+) rows: \1 ok$", out, re.M)[0]))
    assert rows == [181, 10 * 20, 3 * 2, 2]


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificate")
def test_what_the_page_on_sweeps_exports_is_all_that_dask_needs_for_tls(tmp_path):
    """That such a configuration is that of a sweep's cluster, tests/reference/sweeps/test_cluster.py has."""
    dask, security = pytest.importorskip("dask"), pytest.importorskip("distributed.security")
    (block,) = of_language(SWEEPS, "bash")
    exports, _, sweep = block.strip().rpartition("\n")
    assert sweep.startswith("foucault sweep ") and sweep.endswith(" --cluster local:2")
    pairs = [line.partition("=")[::2] for line in output(f"{exports}\nenv", tmp_path).splitlines()]
    exported = dask.config.collect_env(
        {name: value for name, value in pairs if name.startswith("DASK_")}
    )
    with dask.config.set(dask.config.merge(dask.config.config, exported)):
        found = security.Security()
    assert found.require_encryption
    for who in ("client", "scheduler", "worker"):
        assert isinstance(found.get_connection_args(who)["ssl_context"], ssl.SSLContext)


@pytest.mark.long
@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificate")
def test_a_cluster_under_tls_is_begun_as_the_page_on_sweeps_says(tmp_path):
    pytest.importorskip("distributed")
    (block,) = of_language(SWEEPS, "bash")
    assert re.search(r"^91 rows: 91 ok$", output(block, tmp_path), re.M)


def test_the_commands_of_the_studies_are_those_that_make_the_page():
    sys.path.append(str(ROOT / "tests/bench"))
    import studies_page

    shown = [words for words in shell(STUDIES) if words]
    assert all(words in map(shlex.split, studies_page.COMMANDS.values()) for words in shown)
    assert shown


def test_what_the_contributor_types_are_targets_and_what_the_readme_types_is_what_ci_runs():
    made = [words[1] for words in shell(CONTRIBUTING)]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (phony,) = re.findall(r"^\.PHONY: (.+)$", makefile, re.M)
    assert set(made) == set(phony.split()) - {"lint", "pytest", "locale", "clean"}
    made = [" ".join(words) for words in shell("README.md") if words[0] == "make"]
    assert made == ["make golden", "make test"]
    ci = (ROOT / ".ci/run").read_text(encoding="utf-8").splitlines()
    assert set(made) <= set(ci)


def test_every_command_and_option_in_the_text_of_a_page_is_there():
    known = typer.main.get_command(commands_of_foucault()).commands
    options = {
        name: {option for param in known[name].params for option in param.opts} | {"--help"}
        for name in known
    }
    for page in {*PAGES} - {"CHANGELOG.md"}:  # which tells of what was
        for name, words in re.findall(
            r"`foucault ([a-z]+)([^`]*)`", (ROOT / page).read_text(encoding="utf-8")
        ):
            assert set(re.findall(r"(?<!\S)--[\w-]+", words)) <= options[name], (page, name, words)


def build(source: Path, site: Path, *more: str) -> tuple[int, str]:
    """Make a site as `make docs` does, in this process and without an index for the search; return status, stderr."""
    from sphinx.builders.html import StandaloneHTMLBuilder
    from sphinx.cmd.build import main

    (line,) = re.findall(
        r"-m sphinx (.+) -c docs \. build/docs$", (ROOT / "Makefile").read_text("utf-8"), re.M
    )
    err = io.StringIO()
    with (
        pytest.MonkeyPatch.context() as patch,
        warnings.catch_warnings(),
        contextlib.redirect_stderr(err),
    ):
        warnings.simplefilter("ignore")  # Sphinx's own about its future
        patch.setattr(StandaloneHTMLBuilder, "search", False)
        patch.setattr(sys, "path", [*sys.path])
        # it would choose one for all tests that follow
        patch.setattr(locale, "setlocale", lambda *_: "C")
        status = main([*line.split(), *more, "-c", str(ROOT / "docs"), str(source), str(site)])
    return status, err.getvalue()


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    # the theme lists all pages on each page, a fifth of the work; the site with a broken link has it
    status, err = build(ROOT, folder, "-D", "html_theme=basic")
    # any warning is an error: broken links, unknown names, pages in no list
    assert status == 0, err
    return folder


def test_all_pages_are_on_the_site_and_its_first_page_leads_to_them(site):
    assert all((site / page).with_suffix(".html").is_file() for page in PAGES)
    (start,) = re.findall(r"url=([\w/.]+)", (site / "index.html").read_text(encoding="utf-8"))
    assert (site / start).is_file()


@pytest.mark.parametrize("package", [reference, compare])
def test_every_public_name_is_on_the_page_on_python(site, package):
    page = (site / API).with_suffix(".html").read_text(encoding="utf-8")
    assert [name for name in package.__all__ if f'id="{package.__name__}.{name}"' not in page] == []


def test_every_command_is_on_the_page_on_commands_with_its_options(site):
    page = (site / "docs/commands.html").read_text(encoding="utf-8")
    listed = set(re.findall(r'<section id="foucault-(\w+)">', page))
    assert listed == set(typer.main.get_command(commands_of_foucault()).list_commands(None))
    assert commands_page.page() == commands_page.PAGE.read_text("utf-8"), (
        "run: python tests/helpers/commands_page.py"
    )


def test_a_number_with_an_exponent_is_one_element_that_is_not_broken_across_lines(site):
    page = (site / STUDIES).with_suffix(".html").read_text(encoding="utf-8")
    shown = re.sub(r"<(script|style|pre)\b.*?</\1>|<title>.*?</title>", "", page, flags=re.S)
    numbers = re.findall(r"(>?)\b\d[\d.]*e-\d+", re.sub(r"<a\b[^>]*>", "", shown))
    assert set(numbers) == {">"}
    style = (site / "_static/style.css").read_text(encoding="utf-8")
    assert re.search(r"^\.number \{[^}]*white-space: nowrap", style, re.M)


def test_a_broken_link_fails(tmp_path):
    (tmp_path / "docs").mkdir()
    links = [
        "[a](other.md)",
        "[b](other.md#there)",
        "[c](other.md#gone)",
        "[d](gone.md)",
        "[e](#nowhere)",
    ]
    (tmp_path / "docs/index.md").write_text(
        "# I\n\n" + " ".join(links) + "\n\n```{toctree}\nother\n```\n", "utf-8"
    )
    (tmp_path / "docs/other.md").write_text("# O\n\n## There\n", "utf-8")
    status, err = build(tmp_path, tmp_path / "site")
    assert status == 1
    assert re.findall(r": '([\w.]+)' \[myst.xref_missing\]", err) == ["gone", "gone.md", "nowhere"]


def test_every_file_and_folder_that_a_page_names_exists():
    missing = []
    for page in PAGES:
        text = (ROOT / page).read_text(encoding="utf-8")
        links = [target for target in re.findall(r"\]\(([^)#]+)\)", text) if "://" not in target]
        paths = [
            ROOT / path
            for path in re.findall(r"`((?:reference|compare|tests|docs|data)/[\w./]*)`", text)
        ]
        paths += [(ROOT / page).parent / link for link in links]
        missing += [(page, path) for path in paths if not path.exists()]
    assert missing == []


@cache
def names_below(folder: str) -> set[str]:
    """Return the names of all files below a folder of the project."""
    return {path.name for path in (ROOT / folder).rglob("*.*")}


@pytest.mark.parametrize("page", sorted({*PAGES} - {"CHANGELOG.md"}))  # which tells of what was
def test_every_script_that_a_page_names_is_in_the_tree_or_written_by_the_page(page, tmp_path):
    there = {name for folder in BESIDE.get(page, EVERYWHERE) for name in names_below(folder)}
    there |= {path.name for path in ROOT.glob("*.py")} | {*write_files(page, tmp_path)}
    scripts = [
        word
        for span in code_spans(page)
        for word in span.split()
        if re.fullmatch(r"[\w./-]+\.(py|js)", word)
    ]
    assert [
        word for word in scripts if not ((ROOT / word).is_file() if "/" in word else word in there)
    ] == []
