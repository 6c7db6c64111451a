"""The pages of the atlas: what they say, what a browser makes of them, and files that are dropped on them."""

from __future__ import annotations

import base64
import json
import math
import re
import shutil

import numpy as np
import pytest
from browsing import CHROMIUM, in_browser
from forgery import forge

import reference
from compare import judge
from compare.report.atlas.entry import Entry, StudyResults, entries, kept_studies, studies_folder
from compare.report.atlas.pages import scene_page
from compare.report.atlas.parts import methods, plain, vocabulary
from reference.scenes.shipped import golden_root
from reference.status import Status

browser = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")


@pytest.fixture
def readings(tmp_path):
    """A folder of the two datasets of Paris."""
    for name in ("paris", "paris.binary64"):
        (tmp_path / name).symlink_to(golden_root() / name)
    return tmp_path


def test_a_page_for_each_scene_and_one_over_all(atlas):
    assert sorted(path.name for path in atlas.iterdir()) == [
        "SHA256SUMS", "conical.html", "hard.html", "index.html", "paris.function.js", "paris.html", "scenes.html",
    ]  # fmt: skip
    text = (atlas / "scenes.html").read_text()
    golden = reference.load("paris")
    assert golden.manifest.title in text and text.count("<svg") == 3 == text.count('class="card"')
    page = (atlas / "paris.html").read_text()
    assert golden.decimals("x")[-1] in page and golden.manifest.bounds.grid["x"] in page
    assert "https://example.org/golden/paris.binary64/grid.csv" in page
    hard = (atlas / "hard.html").read_text()
    assert "Path from above" in hard and "On the sphere" in hard
    assert "foucault score hard mine.csv --t-end 5 --inputs decimal" in hard
    assert (
        "judged by the golden rows alone: the dataset has no golden function" in hard
        and 'id="player"' in hard
    )
    assert f"y within {reference.load('paris.binary64').function.bound['y']:.1e} m" in page
    assert all(record.sha256 in page for record in golden.manifest.files.values())
    assert golden.manifest.cross_checks[0].position_m in page and golden.manifest.seal in page


def test_the_atlas_begins_with_any_pendulum_and_every_page_leads_there(atlas):
    first = (atlas / "index.html").read_text()
    assert "<h1>Any Foucault pendulum</h1>" in first and 'href="scenes.html"' in first
    others = [path for path in atlas.glob("*.html") if path.name != "index.html"]
    assert len(others) == 4 and all('href="index.html"' in path.read_text() for path in others)


def test_a_thumbnail_shows_the_path_from_its_release_on(atlas):
    card = re.search(r'id="paris" .*?</a>', (atlas / "scenes.html").read_text(), re.S)[0]
    x, y = (
        float(word) for word in re.search(r'class="release" d="M(\S+) (\S+?)h0"', card).groups()
    )
    golden = reference.load("paris")
    unit = 0.46 * 200 / np.hypot(golden.x, golden.y).max()
    # 0.3 m east, 0.4 m north
    assert (x - 100, 100 - y) == pytest.approx((0.3 * unit, 0.4 * unit), abs=1.5)
    path = re.search(r'<path d="M(.*?)"', card)[1]
    places = np.array(
        [
            [float(word) for word in place.split()]
            for part in path.split("M")
            for place in re.findall(r"\d+ \d+", part)
        ]
    )
    assert path.count("M") == 8 and len(places) == 9 * 41, "nine swings, spread over the day"
    assert places.min() >= 0 and places.max() <= 200


def test_pages_load_nothing_stay_small_and_have_each_id_once(atlas):
    for path in atlas.glob("*.html"):
        text = path.read_text()
        policy = re.search(r'Content-Security-Policy" content="(.*?)"', text)[1]
        assert "default-src 'none'" in policy and "unsafe" not in policy
        elements = text.partition("<script")[0]
        assert elements.count("<style") == 1 and not re.search(r"<[^>]* style=", elements)
        assert not re.search(
            r"<(?:link|img|iframe|object)\b|\bsrc=|@import|fetch\(|XMLHttpRequest|import\(", text
        )
        assert path.stat().st_size < 1_000_000
        names = re.findall(r' id="([^"]+)"', text.partition("<script")[0])
        assert len(names) == len(set(names)), path


def test_the_script_beside_a_page_is_the_shipped_function_and_nothing_else(atlas):
    """A day of Paris takes 4.8 MB: too many for the page, so its bytes stand in a script that only names them."""
    name, _, value = (atlas / "paris.function.js").read_text().removesuffix(";\n").partition(" = ")
    made, shipped = json.loads(value), golden_root() / "paris.binary64"
    assert name == "globalThis.goldenFunction" and made["end"] == 86_400
    assert made["record"] == json.loads((shipped / "function.json").read_text())
    assert (
        base64.b64decode(made["coefficients"], validate=True)
        == (shipped / "function.f64").read_bytes()
    )
    page = (atlas / "paris.html").read_text()
    assert '"function":null' in page and "are in paris.function.js beside this page" in page


def test_what_studies_say_of_a_scene(tmp_path):
    kept = kept_studies(studies_folder())
    assert kept["paris"].same_digits and kept["paris"].least and kept["paris"].span_s == 86_400
    assert [one.error_m for one in kept["hard"].least] == sorted(
        one.error_m for one in kept["hard"].least
    )
    assert kept_studies(None) == {} and "silently wrong" in kept["hard"].sentence()
    (tmp_path / "other.json").write_text('{"rows": [{"scene": "paris"}]}')
    with pytest.raises(reference.InputError, match="a study as `foucault study` writes it"):
        kept_studies(tmp_path)


@pytest.mark.parametrize(
    "text",
    [
        "[]",
        '{"rows": [7]}',
        pytest.param(f'{{"scene": "paris", "rows": [], "t_end": {"9" * 400}}}'),
        pytest.param('{"rows":' * 100_000),
        pytest.param(
            '{"scene": "paris", "t_end": 60, "rows": [{"method": "a", "status": "ok", "error_m": 0.1, "cpu_s": []}]}',
        ),
    ],
    ids=lambda text: f"{text[:12]!r}",
)
def test_what_is_no_study_is_refused(text, tmp_path):
    (tmp_path / "mine.json").write_text(text)
    with pytest.raises(reference.InputError, match="--studies"):
        kept_studies(tmp_path)


def test_a_study_is_a_regular_file(tmp_path):
    (tmp_path / "mine.json").symlink_to("/dev/zero")
    with pytest.raises(reference.InputError, match="Pipes and devices are not read"):
        kept_studies(tmp_path)


def test_without_a_study_the_page_says_nothing_of_methods(atlas, readings):
    (paris,) = entries(readings, None)
    assert "How methods fare" in (atlas / "paris.html").read_text()
    assert "How methods fare" not in scene_page(paris, [], "", None, None)


def test_the_page_states_the_rule_by_which_runs_are_ok_and_the_kept_results_obey_it():
    studied = kept_studies(studies_folder())["hard"]
    tables = "".join(methods(studied))
    (times,) = re.findall(r"ok if its error is at most (\d+) times what was asked for", tables)
    finished = [run for run in studied.same_digits.values() if run.digits is not None]
    assert {run.status for run in finished} == {Status.OK, Status.SILENTLY_WRONG}
    for run in finished:
        assert (run.status == Status.OK) == (run.digits >= run.asked - math.log10(int(times)))


def test_a_dataset_of_hostile_words_has_a_page(foucault, tmp_path):
    pytest.importorskip("matplotlib")
    evil = "<script>alert(1)</script>"
    shutil.copytree(golden_root() / "conical", tmp_path / "data" / "conical")

    def change(manifest):
        manifest["enclosure"]["method"] = evil
        manifest |= {"title": evil, "flags": [evil], "notes": {evil: evil}, "units": {evil: evil}}

    forge(tmp_path / "data" / "conical", manifest=change)
    status, _, err = foucault("atlas", "--data", tmp_path / "data", "--out", tmp_path / "out")
    assert (status, err) == (0, "")
    assert all(evil not in path.read_text() for path in (tmp_path / "out").iterdir())
    assert "1 scene and 1 golden dataset. " in (tmp_path / "out" / "scenes.html").read_text()


def test_the_command_to_score_says_what_differs_from_the_scene(readings):
    (two,) = entries(readings, None)
    assert two.score_command() == "foucault score paris mine.csv" and len(two.datasets) == 2
    alone = Entry(two.golden, two.golden, StudyResults())
    assert alone.score_command() == "foucault score paris mine.csv --inputs decimal"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--data", "nowhere"), "a folder of golden datasets"),
        (("--data", "SOME", "--studies", "."), "a study as `foucault study` writes it"),
        (("--data", "SOME", "--studies", "nowhere"), "a folder of study results"),
        (("--out", "mine"), "a new folder, or one that an earlier run wrote"),
    ],
)
def test_wrong_folders_are_refused_before_a_dataset_is_read_and_nothing_is_written(
    foucault, tmp_path, tmp_path_factory, monkeypatch, words, said
):
    some = tmp_path_factory.mktemp("data")
    (some / "hard").mkdir()
    (some / "hard" / "manifest.json").write_text("no dataset")
    words = [some if word == "SOME" else word for word in words]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "index.html").write_text("my own page")
    (tmp_path / "some.json").write_text("[]")
    status, out, err = foucault("atlas", *words)
    assert (status, out) == (2, "") and said in err
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["index.html", "mine", "some.json"]


TOLD = """
<script>
(async () => {
  const told = [];
  const errors = [];
  addEventListener("securitypolicyviolation", (event) => errors.push(`forbidden: ${event.violatedDirective}`));
  const element = document.getElementById("player");
  const canvas = element.querySelector("canvas");
  const button = element.querySelector("button");
  const display = getComputedStyle(canvas).display;
  addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
  for (const files of %s) {
    shown.replaceChildren();
    const data = new DataTransfer();
    for (const [name, text] of files) data.items.add(new File([text], name));
    zone.dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
    while (!shown.childNodes.length || shown.className === "working") await new Promise((done) => setTimeout(done, 5));
    const drawn = Boolean(shown.querySelector("svg path.error"));
    told.push([shown.className, shown.innerText, drawn, shown.scrollWidth <= shown.clientWidth]);
  }
  const output = element.querySelector("output");
  const moved = [output.textContent];
  let drawn = 0;
  requestAnimationFrame = (next) => setTimeout(next, 16); // no frames are drawn in this browser's quick time
  new MutationObserver(() => { drawn += 1; }).observe(output, { childList: true });
  let there = false;
  player.ready().then(() => { there = true; });
  while (!there) await new Promise((done) => setTimeout(done, 5));
  button.click();
  await new Promise((done) => setTimeout(done, 4200));
  button.click();
  await new Promise((done) => setTimeout(done, 0));
  const count = drawn;
  await new Promise((done) => setTimeout(done, 1200));
  moved.push(output.textContent, count, drawn, document.getElementById("played").textContent);
  const fits = document.documentElement.scrollWidth <= innerWidth;
  const line = getComputedStyle(document.querySelector('.pictures path[stroke^="var(--blue"]')).stroke;
  document.body.innerHTML = '<pre id="told"></pre>';
  const all = { told, fits, moved, errors, display, line, wide: innerWidth };
  document.getElementById("told").textContent = JSON.stringify(all);
})();
</script></body>"""
FILTERED = """
<script>
const told = [document.getElementById("count").textContent];
for (const [name, value] of [["flag", "large_angle"], ["level", "enclosed"], ["flag", ""]]) {
  document.getElementById(name).value = value;
  form.dispatchEvent(new Event("input"));
  const left = cards.filter((card) => !card.hidden).map((card) => card.id);
  const groups = [...document.querySelectorAll("section")].filter((group) => !group.hidden).length;
  told.push([document.getElementById("count").textContent, left.sort(), groups]);
}
const fits = document.documentElement.scrollWidth <= innerWidth;
document.body.innerHTML = '<pre id="told"></pre>';
document.getElementById("told").textContent = JSON.stringify({ told, fits, wide: innerWidth });
</script></body>"""


@browser
@pytest.mark.parametrize("beside", [True, False], ids=["function", "rows"])
def test_files_dropped_on_the_page_are_judged_as_by_score(atlas, beside, tmp_path):
    """With the golden function beside the page; without it the rows at golden times are judged all the same."""
    if beside:
        shutil.copy(atlas / "paris.function.js", tmp_path)
    golden = reference.load("paris.binary64")
    t, x, y = (golden.grid[name][::10] for name in "txy")
    times = golden.transits["t"]

    def rows(header, *columns):
        return (
            header
            + "\n"
            + "".join(",".join(map(repr, row)) + "\n" for row in zip(*columns, strict=True))
        )

    columns = [one.tolist() for one in (t, x + 1e-8, y)]
    right = rows("t,x,y", *columns)
    missing = rows("t", [one for one in times.tolist() if one != times[41]])
    dropped = [
        [["right.csv", right]],
        [["right.csv", right], ["times.csv", rows("t", times.tolist())]],
        [["right.csv", right], ["times.csv", missing]],
        [["exchanged.csv", rows("t,y,x", *columns)]],
        [["late.csv", rows("t,x,y", (t + 7.0).tolist()[:-1], columns[1][:-1], columns[2][:-1])]],
        [["ragged.csv", right + "86400,0.1\n"]],
    ]
    told = in_browser(
        atlas / "paris.html", TOLD % json.dumps(dropped).replace("<", "\\u003c"), tmp_path
    )
    assert told["fits"], "the page is wider than a phone"
    assert told["errors"] == []
    assert told["line"] == "rgb(0, 114, 178)", "pictures have the page's colours"
    assert told["moved"][-1].startswith("Computed in this page, its error estimated at ")
    words = [one[0] for one in told["told"]]
    late = "disagrees" if beside else "refused"  # no row of it is at a golden time
    assert words == ["agrees", "agrees", "disagrees", "disagrees", late, "refused"]
    texts = [one[1] for one in told["told"]]
    assert [one[2] for one in told["told"]] == [True, True, True, True, beside, False] and all(
        one[3] for one in told["told"]
    )
    path = tmp_path / "right.csv"
    path.write_text(right)
    score = judge(path, "paris", explain=False)
    assert score.verdict == "agrees" and f"{score.errors.max_m:.3g}".replace("e-0", "e-") in texts[
        0
    ].replace("1.00e", "1e")
    assert "10514 matched, 0 missed, 0 extra" in texts[1]
    assert f"10513 matched, 1 missed ({times[41]:.6f} s)" in texts[2]
    assert "Your file writes north as x and east as y: corrected, the error is " in texts[3]
    assert "144 rows" in texts[4] if beside else "All are 7.00 s after one" in texts[4]
    assert "fields, and the first row has 3" in texts[5]


def odd(golden, wrong=0.0):
    """A file at times of no grid, late in the run, whose x is too large by a part of it."""
    t = np.sort(np.random.default_rng(6).uniform(61.5, 93.25, 500))
    t[0], t[-1] = 61.5, 93.25
    at = golden.at(t)
    rows = zip(t.tolist(), (at.x * (1 + wrong)).tolist(), at.y.tolist(), strict=True)
    return "t,x,y\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows)


@pytest.fixture(scope="session")
def circling(atlas):
    return reference.load(atlas.parent / "data" / "conical.binary64")


def dropped_on(page, files, tmp_path, *flags):
    return in_browser(page, TOLD % json.dumps([[file] for file in files]), tmp_path, *flags)


@browser
@pytest.mark.parametrize("flag", ["", "--force-prefers-reduced-motion"])
def test_a_file_at_any_times_is_judged_and_the_motion_played_beside_it(
    atlas, circling, flag, tmp_path
):
    files = [["right.csv", odd(circling, 1e-9)], ["wrong.csv", odd(circling, 1e-4)]]
    told = dropped_on(atlas / "conical.html", files, tmp_path, *filter(None, [flag]))
    assert told["fits"] and told["errors"] == [] and told["display"] == "block"
    (right, words, *_), (wrong, *_) = told["told"]
    assert (right, wrong) == ("agrees", "disagrees")
    said = re.search(
        r"the golden function, which is within (\S+) m of the truth at every time", words
    )
    assert float(said[1]) == pytest.approx(
        np.hypot(circling.function.bound["x"], circling.function.bound["y"]), rel=0.01
    )
    assert "500 rows" in words
    begin, end = (re.search(rf"^{text}$", words, re.M) for text in ("61.5", "93.25"))
    assert begin and end, "the chart spans the file"
    before, after, drawn, later, _ = told["moved"]
    assert before != after and all(
        "yours in orange, its error times 1,000" in text for text in (before, after)
    )
    assert later == drawn, "a press of the button stops it"
    assert drawn > 40 if not flag else 3 <= drawn <= 5


@browser
def test_a_page_without_the_coefficients_beside_it_judges_the_rows_alone(atlas, tmp_path):
    golden = reference.load("paris.binary64")
    beside, alone = tmp_path / "beside", tmp_path / "alone"
    for folder in (beside, alone):
        folder.mkdir()
    shutil.copy(atlas / "paris.function.js", beside)
    files = [
        ["right.csv", odd(golden, 1e-9)],
        ["rows.csv", (golden.path / "grid.binary64.csv").read_text()],
    ]
    told = dropped_on(atlas / "paris.html", files, beside)
    assert [one[0] for one in told["told"]] == ["agrees", "agrees"] and told["errors"] == []
    assert told["display"] == "none", "no gap stands where nothing is drawn before the first play"
    told = dropped_on(atlas / "paris.html", files, alone)
    assert [one[0] for one in told["told"]] == ["refused", "agrees"] and told["errors"] == []
    assert "paris.function.js is not beside this page" in told["told"][1][1]


@browser
def test_scenes_are_filtered_by_flag_and_level(atlas, tmp_path):
    told = in_browser(atlas / "scenes.html", FILTERED, tmp_path)
    every, *chosen = told["told"]
    assert every == "3 of 3 scenes" and told["fits"]
    assert chosen == [
        ["1 of 3 scenes", ["hard"], 1],
        ["0 of 3 scenes", [], 0],
        ["2 of 3 scenes", ["conical", "paris"], 2],
    ]


def test_what_has_no_form_in_json_is_refused_and_no_word_of_the_vocabulary_is_lost():
    with pytest.raises(TypeError, match="cannot be written as JSON"):
        json.dumps({"unknown": object()}, default=plain)
    words = json.loads(json.dumps(vocabulary(), default=plain))
    assert [name for name, value in words.items() if value is None] == []
    assert "#" in words["MARKS"]
