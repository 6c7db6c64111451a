"""The page for any pendulum: its weight and policy, and what a browser makes of links, typed fields and files."""

from __future__ import annotations

import html
import json
import re
from urllib.parse import urlencode

import pytest
from browsing import CHROMIUM, in_browser
from pages import blocks

from compare.report.atlas.pendulum_page import pendulum_page
from reference import Scene

browser = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")

MOST_BYTES = 300_000
EVIL = "<img src=x onerror=hacked=1>"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "index.html"
    path.write_text(pendulum_page("scenes.html"))
    return path


def test_the_page_is_small_loads_nothing_and_runs_only_its_own_scripts(page):
    text = page.read_text()
    assert len(text.encode()) <= MOST_BYTES
    policy = re.search(r'Content-Security-Policy" content="(.*?)"', text)[1]
    assert (
        "default-src 'none'" in policy and "unsafe" not in policy and "worker-src blob:" in policy
    )
    assert not re.search(
        r"<(?:link|iframe|object)\b|\bsrc=|@import|fetch\(|XMLHttpRequest|import\(", text
    )
    assert "innerHTML" not in text and " style=" not in text and not re.search(r" on[a-z]+=", text)
    scripts = re.findall(r"<script class=", text)
    assert policy.count("'sha256-") == len(scripts) + 1  # and the style


def test_every_field_has_a_label_a_meaning_and_a_place_for_its_mistake(page):
    text = page.read_text()
    names = re.findall(r'<input id="([a-z_]+[.][a-z_]+)"', text)
    assert len(names) == 18
    for name in names:
        assert f'<label for="{name}">' in text
        assert f'aria-describedby="{name}.meaning {name}.wrong"' in text
        assert f'id="{name}.meaning"' in text and f'id="{name}.wrong"' in text
    ids = re.findall(r' id="([^"]+)"', text.partition("<script")[0])
    assert len(ids) == len(set(ids))


def test_the_form_says_of_each_meaning_of_g_what_a_scene_says_of_it(page):
    buttons = re.findall(r'name="site.gravity_is".*?<span>(.*?)</span>', page.read_text())
    said = [html.unescape(re.sub("<.*?>", "", button)) for button in buttons]
    meanings = [text.partition(".")[0] for text in said]
    site = Scene.model_json_schema()["$defs"]["Site"]["properties"]
    assert "; ".join(meanings) == site["gravity_is"]["description"]


def test_the_page_has_the_lines_of_the_documentation(page):
    lines = [
        html.unescape(code) for code in re.findall(r"<pre>(.*?)</pre>", page.read_text(), re.S)
    ]
    described = [block.text.strip() for block in blocks("docs/paste.md")]
    *programs, command = described
    assert len(programs) == 6 and [code.strip() for code in lines[:6]] == programs
    assert command.startswith("$ foucault score")


# what a visitor does is between these two
BEGIN = r"""
<script>
(async () => {
  const told = {};
  const violations = [];
  addEventListener("securitypolicyviolation", (event) => violations.push(event.violatedDirective));
  const pause = () => new Promise((done) => setTimeout(done, 5));
  const until = async (holds) => { while (!holds()) await pause(); };
  const computed = () => at("state").textContent.startsWith("Computed in");
  const verdict = async () => {
    await until(() => shown.childNodes.length && shown.className !== "working");
    return [shown.className, shown.innerText];
  };
  const type = async (id, text) => {
    at("state").textContent = "";
    at(id).value = text;
    at(id).dispatchEvent(new Event("input", { bubbles: true }));
    await until(() => at("state").textContent !== "" && (computed() || /wrong/.test(at("state").textContent)));
  };
  const paste = async (text) => {
    shown.replaceChildren();
    at("pasted").value = text;
    at("judge").click();
    return verdict();
  };
  const hold = (id, text) => { // type, and stay in the field
    at(id).value = text;
    at(id).dispatchEvent(new Event("input", { bubbles: true }));
  };
"""
END = r"""
  const all = { ...told, hacked: typeof hacked, violations };
  document.body.replaceChildren(elementOf("pre", { id: "told" }, JSON.stringify(all)));
})();

// Rows of the motion that is shown, or of a changed one, through a function of x, y and t.
function rowsNow(changes = {}) {
  const texts = { ...textsOfForm(), ...changes };
  const at_ = motionOf(integrate(problemOf(sceneOf(texts, fields)), 20, 2 ** -50));
  return (header, map) => {
    const lines = Array.from({ length: 121 }, (_, i) => {
      const [x, y] = at_(i / 2);
      return [i / 2, ...map(x, y, i / 2)].join(",");
    });
    return [header, ...lines, ""].join("\n");
  };
}
</script></body>"""

WALK = r"""
  await until(computed);
  told.title = at("title").value;
  told.toml = at("toml").textContent;
  told.facts = at("facts").innerText;
  told.fits = document.documentElement.scrollWidth <= innerWidth;

  await type("pendulum.length", "-1");
  told.wrong = at("pendulum.length.wrong").textContent;
  await type("release.x", "");
  told.missing = at("release.x.wrong").textContent;
  at("release.x").value = "0.3";
  told.invalid = at("pendulum.length").getAttribute("aria-invalid");
  shown.replaceChildren();
  told.nothing = await paste(" \n");
  await type("pendulum.length", "10");
  told.right = at("pendulum.length.wrong").textContent;
  told.link = location.hash;

  const motion = await player.ready() && rowsNow();
  told.agrees = await paste(motion("t,x,y", (x, y) => [x, y]));
  told.swapped = await paste(motion("t,x,y", (x, y) => [y, x]));
  told.wrongRows = await paste(motion("t,x,y", (x, y, t) => [x * Math.cos(t / 900), y]));
  const other = { ellipsoid: "effective", effective: "ellipsoid" }[textsOfForm()["site.gravity_is"]];
  told.gravity = await paste(rowsNow({ "site.gravity_is": other })("t,x,y", (x, y) => [x, y]));
  at("tolerance").value = "1";
  shown.replaceChildren();
  at("tolerance").dispatchEvent(new Event("change", { bubbles: true }));
  told.loose = await verdict();
  at("tolerance").value = "";
  told.header = await paste(`t,x,%s\n0,1,2\n`);
  const data = new DataTransfer();
  data.items.add(new File([motion("t,x,y", (x, y) => [x, 2 * y])], "%s.csv"));
  shown.replaceChildren();
  at("drop").dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
  told.dropped = await verdict();
  told.images = document.querySelectorAll("main img").length;
  told.fitsAfter = document.documentElement.scrollWidth <= innerWidth;

  at("preset").value = "hard";
  at("preset").dispatchEvent(new Event("change", { bubbles: true }));
  at("state").textContent = "";
  await until(computed);
  told.preset = [at("about").textContent, at("release.angle").value, location.hash];
  at("direction").value = "bearing";
  at("direction").dispatchEvent(new Event("change", { bubbles: true }));
  told.bearing = [at("release.azimuth").value, textsOfForm()["release.azimuth"]];

"""


@browser
def test_a_link_a_form_and_files_of_a_stranger(page, tmp_path):
    """From a link to the mistake, on a screen as wide as a phone's; nothing of a stranger's text becomes HTML."""
    asked = {
        "title": EVIL,
        "release.x": "0.3",
        "release.y": "0.4",
        "run.t_end": "60",
        "run.grid_step": "1",
        "site.gravity_is": "effective",
        "evil": EVIL,
    }
    script = (BEGIN + WALK + END).replace("%s", EVIL)
    told = in_browser(page, script, tmp_path, fragment=f"#{urlencode(asked)}")
    assert told["hacked"] == "undefined" and told["images"] == 0 and told["violations"] == []
    assert told["fits"] and told["fitsAfter"]
    assert told["title"] == EVIL and f"title = {json.dumps(EVIL)}" in told["toml"]
    assert "precession" in told["facts"] and "estimated" in told["facts"]
    assert told["wrong"] == "Expected a number above 0." and told["invalid"] == "true"
    assert (
        told["right"] == "" and "pendulum.length=10" in told["link"] and "evil" not in told["link"]
    )

    assert told["missing"].endswith("The box is empty.")
    assert (
        told["nothing"][0] == "refused" and "Paste what your program printed" in told["nothing"][1]
    )

    assert told["gravity"][0] == "disagrees"
    assert "adds the centrifugal force to a g that contains it already" in told["gravity"][1]
    assert "choose ellipsoid under Place" in told["gravity"][1]
    assert "Halve your step" not in told["gravity"][1], "nothing is left to explain"
    assert "the largest distance of the right motion from the vertical" in told["gravity"][1]
    assert told["loose"][0] == "agrees" and "tolerance that you typed" in told["loose"][1]
    assert told["agrees"][0] == "agrees" and "your output agrees" in told["agrees"][1]
    assert told["swapped"][0] == "disagrees"
    assert (
        "Your file writes north as x and east as y: corrected, the error is " in told["swapped"][1]
    )
    assert told["wrongRows"][0] == "disagrees"
    assert "foucault score pendulum.toml mine.csv" in told["wrongRows"][1]
    assert "the other meaning of g makes it no better" in told["wrongRows"][1]
    assert "The right motion contains what programs often leave out" in told["wrongRows"][1]
    assert re.search(r"small angles.*Without it: off by \S+ m up to t = 60 s", told["wrongRows"][1])
    assert told["header"][0] == "refused" and EVIL in told["header"][1]
    assert f"{EVIL}.csv disagrees with {EVIL}" in told["dropped"][1]
    assert "Your file prints y times 2" in told["dropped"][1]

    assert told["preset"][0].startswith("80 degrees") and told["preset"][1] == "80"
    assert "release.angle=80" in told["preset"][2]
    assert told["bearing"] == ["60", "30"]


JUMPS = r"""
  await until(computed);
  await type("pendulum.length", "12.5");
  const form = () => JSON.stringify([textsOfForm(), at("title").value, at("preset").value, location.hash]);
  told.before = form();
  told.after = [];
  for (const link of document.querySelectorAll("nav a")) {
    scrollTo(0, 0);
    link.click(); // as the mouse and Enter do
    await new Promise((done) => setTimeout(done, 200));
    told.after.push([form(), scrollY > 0]);
  }
  location.hash = "#release.x=0.1&release.y=0";
  await until(() => at("release.x").value === "0.1");
  told.other = location.hash;
"""


@browser
def test_a_link_to_a_section_leaves_the_pendulum_and_its_address(page, tmp_path):
    asked = {"title": "mine", "release.x": "0.3", "release.y": "0.4", "run.t_end": "60"}
    told = in_browser(page, BEGIN + JUMPS + END, tmp_path, fragment=f"#{urlencode(asked)}")
    assert "pendulum.length=12.5" in told["before"]
    assert [form for form, _ in told["after"]] == [told["before"]] * 3
    assert all(scrolled for _, scrolled in told["after"][1:])
    assert "release.x=0.1" in told["other"], "an address with a pendulum is taken"


VISIT = r"""
  await until(computed);
  const enter = () => at("tolerance").dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
  const outdated = () => at("outdated").textContent;
  const motion = await player.ready() && rowsNow();
  const wrong = (size) => motion("t,x,y", (x, y, t) => [x * Math.cos(size * t), y]);

  told.fresh = [outdated(), getComputedStyle(shown).display];
  hold("pasted", wrong(1e-3));
  shown.replaceChildren();
  enter();
  told.first = await verdict();
  const [, inFacts] = at("facts").innerText.match(/([0-9.e-]+) m at the end/);
  const [, inVerdict] = told.first[1].match(/estimated at ([0-9.e-]+) m/);
  told.estimates = [inFacts, inVerdict];
  told.largest = () => Number(shown.innerText.match(/largest error\n(\S+) m/)[1]);
  told.errors = [told.largest()];
  const address = location.hash;
  shown.querySelector('a[href="#player"]').click();
  await new Promise((done) => setTimeout(done, 200));
  told.link = [at("release.x").value, location.hash === address];
  shown.focus();
  told.focused = document.activeElement === shown;

  hold("pasted", wrong(5e-4));
  told.edited = outdated();
  shown.replaceChildren(); // where g changes, the rows that were judged are judged once more
  take();
  told.again = await verdict();
  told.stillEdited = outdated();
  told.second = await paste(at("pasted").value);
  told.errors.push(told.largest());
  told.judged = outdated();
  hold("tolerance", "1e3");
  told.typed = outdated();
  shown.replaceChildren();
  enter();
  told.loose = await verdict();
  told.decided = outdated();
  at("pendulum.length").value = "-1";
  take();
  told.wrongForm = outdated();
  delete told.largest;
"""


@browser
def test_a_verdict_is_compared_with_the_one_before_and_marked_where_it_is_out_of_date(
    page, tmp_path
):
    asked = {"release.x": "0.3", "release.y": "0.4", "run.t_end": "60", "run.grid_step": "1"}
    told = in_browser(page, BEGIN + VISIT + END, tmp_path, fragment=f"#{urlencode(asked)}")
    assert told["fresh"] == ["", "none"], "an empty verdict is no stop of the Tab key"
    assert told["focused"], "a verdict is one"
    assert told["first"][0] == "disagrees", "Enter in the tolerance judges what the box has"
    assert "in the verdict before" not in told["first"][1]
    assert told["link"] == ["0.3", True], "the verdict leads to the moving picture"
    assert re.search(r"error at the end\n\S+ m\nrms error\n\S+ m\n", told["first"][1])
    assert told["estimates"][0] == told["estimates"][1]

    assert "the rows in the box have changed" in told["edited"] == told["stillEdited"]
    before, after = (f"{error:.3g}" for error in told["errors"])
    assert float(after) < float(before)
    line = re.search(
        r"The largest error is (\S+) m; in the verdict before it was (\S+) m", told["second"][1]
    )
    assert [float(word) for word in line.groups()] == [float(after), float(before)]
    assert told["judged"] == "" and "the tolerance has changed" in told["typed"]
    assert told["loose"][0] == "agrees" and told["decided"] == ""
    assert "wrong digit" not in told["loose"][1] and "right up to" in told["loose"][1]
    assert "the pendulum has changed" in told["wrongForm"]


ENTERS = r"""
  await until(computed);
  const motion = await player.ready() && rowsNow();
  const wrong = (size) => motion("t,x,y", (x, y, t) => [x * Math.cos(size * t), y]);
  let judgements = 0;
  const isJudging = ({ addedNodes }) => [...addedNodes].some((node) => node.textContent === "Judging …");
  const count = (records) => { judgements += records.filter(isJudging).length; };
  new MutationObserver(count).observe(shown, { childList: true });
  const judged = async () => {
    const answer = [...(await verdict()), judgements];
    judgements = 0;
    return answer;
  };
  const fire = (event) => at("tolerance").dispatchEvent(event);
  const key = () => fire(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
  const change = () => fire(new Event("change", { bubbles: true }));

  await paste(wrong(1e-3));
  await judged();
  hold("pasted", wrong(5e-4)); // a browser fires both events for Enter in a field that was typed in
  hold("tolerance", "1e-5");
  key();
  change();
  told.both = await judged();
  key(); // and the first alone for Enter once more
  told.again = await judged();
  hold("tolerance", "1e3"); // and the second alone where the field is left
  change();
  told.left = await judged();
"""


@browser
def test_enter_in_the_tolerance_judges_once(page, tmp_path):
    asked = {"release.x": "0.3", "release.y": "0.4", "run.t_end": "60", "run.grid_step": "1"}
    told = in_browser(page, BEGIN + ENTERS + END, tmp_path, fragment=f"#{urlencode(asked)}")
    assert [told[name][2] for name in ("both", "again", "left")] == [1, 1, 1]
    assert "in the verdict before" in told["both"][1], "the rows in the box are other ones"
    assert told["both"][0] == told["again"][0] == "disagrees" and told["left"][0] == "agrees"


def test_the_lines_to_print_stand_below_where_rows_are_pasted_and_judged(page):
    text = page.read_text()
    order = [text.index(word) for word in ('id="drop"', 'id="verdict"', "How to print t,x,y")]
    assert order == sorted(order)


def test_the_page_says_which_equations_it_solves(page):
    words = html.unescape(re.sub("<.*?>", "", page.read_text()))
    assert "g − 2 Ω × v − Ω × (Ω × (R + r)) − drag v" in words
