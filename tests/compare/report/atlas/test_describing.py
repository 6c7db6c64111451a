"""The form of a pendulum: its mistakes as the package names them, its address, its file, its bearing (Node.js)."""

from __future__ import annotations

import math
import random
import shutil
import tomllib

import pytest
from page_motion import code, node

from compare.report.atlas.form import fields, form_words, presets, texts_of
from reference import InputError, load_scene, scene_ids
from reference.model.constants import constants_in_double
from reference.model.start import Start, zero_at_release
from reference.numbers.precision import GUARD_BITS
from reference.scenes.scene import as_scene, checked_value

pytestmark = pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not installed")

_ASK = """
const { cases, fields, words } = JSON.parse(require("fs").readFileSync(0, "utf8"));
const told = cases.map((asked) => (%s)(asked));
console.log(JSON.stringify(told));
"""


def ask(function, cases):
    """Return what a function in JavaScript says of each case; it may use `fields` and `words`."""
    document = {"cases": list(cases), "fields": fields(), "words": form_words()}
    return node(code() + _ASK % function, document)


WRONG = {
    "pendulum.length": ["0", "-1", "1,5", "2 m", "", "nan", "inf", "1e999", "٣"],
    "pendulum.drag": ["-1e-9", "0.1.2"],
    "site.latitude": ["90.0001", "-91", "48°"],
    "site.gravity": ["-9.8"],
    "site.inverse_flattening": ["1", "0", "-inf"],
    "site.equatorial_radius": ["-1"],
    "release.angle": ["-1", "180.5"],
    "release.azimuth": ["361", "-361"],
    "run.t_end": ["0", "1e16"],
    "run.grid_step": ["0", "-60"],
}
RIGHT = {
    "pendulum.length": ["67", "+.5", "1e-3", "7."],
    "site.inverse_flattening": ["inf", "1.5"],
    "site.latitude": ["90", "-90", "-0"],
    "release.angle": ["180", "0"],
    "site.altitude": ["-400"],
}


def expected(name, text):
    """Return what the package expects of a field with this text; None if that is right."""
    try:
        checked_value(name, text, "binary64")
    except InputError as error:
        return error.expected
    return None


def test_each_field_is_checked_as_in_a_scene():
    pairs = [(name, text) for of in (WRONG, RIGHT) for name, texts in of.items() for text in texts]
    told = ask(
        "([name, text]) => wrongText(text, fields.find((field) => field.name === name), words)?.expected ?? null",
        pairs,
    )
    for (name, text), mine in zip(pairs, told, strict=True):
        theirs = expected(name, text)
        assert (mine is None) == (theirs is None), (name, text)
        if theirs and "double" not in theirs and "absolute value" not in theirs:
            assert mine == theirs, (name, text)


def test_every_field_of_the_form_has_the_range_of_the_scene():
    """A number far outside and one inside: a range that is missing here or there is seen."""
    probes = [
        (field["name"], text)
        for field in fields()
        if not field["choices"]
        for text in ("-1e9", "0", "1e9", "1")
    ]
    told = ask(
        "([name, text]) => wrongText(text, fields.find((field) => field.name === name), words)?.expected ?? null",
        probes,
    )
    assert told == [expected(name, text) for name, text in probes]


def test_a_release_is_below_the_suspension_and_rows_are_limited():
    cases = [
        {"release.x": "50", "release.y": "50"},
        {"release.x": "1"},
        {"release.angle": "170", "release.azimuth": "0"},
        {"release.x": "1", "release.y": "0", "run.grid_step": "1e-3"},
    ]
    beyond, missing, right, rows = ask("(texts) => wrongOf(texts, fields, words)", cases)
    assert "a point below the suspension" in beyond["release.x"]["expected"]
    assert [*missing] == ["release.y"] and right == {}
    assert missing["release.y"]["expected"].startswith("a decimal number such as ")
    assert missing["release.y"]["advice"] == "The box is empty."
    assert rows["run.grid_step"]["expected"] == "at most 2000000 grid times up to t_end"


def scene_of(texts):
    document = {"id": "mine"}
    for name, text in texts.items():
        table, _, key = name.partition(".")
        document.setdefault(table, {})[key] = text
    return as_scene(document)


def test_scenes_that_ship_are_the_same_from_their_address_and_from_their_file():
    shipped = presets()
    assert [preset["id"] for preset in shipped] == list(scene_ids())
    told = ask(
        """({ title, texts }) => {
          const back = textsOfFragment(`#${fragmentOf(title, texts, fields)}`, fields);
          return { ...back, toml: tomlOf(back.title, back.texts, fields) };
        }""",
        shipped,
    )
    for preset, mine in zip(shipped, told, strict=True):
        scene = load_scene(preset["id"], ["inputs=decimal"])
        for document in (
            scene_of(mine["texts"]),
            as_scene({"id": "mine", **tomllib.loads(mine["toml"])}),
        ):
            assert document.exact == scene.exact, preset["id"]
            assert document.site == scene.site and document.pendulum == scene.pendulum
        assert mine["title"] == scene.title[:200].strip()


HOSTILE = [
    '"\\n[site]\\ngravity = "1"',
    "<img src=x onerror=alert(1)>",
    "a\u2028b\x00\x7f\x1b[31m",
    "\ud800",
    "&#x22; release.x=7",
]


def test_a_name_stays_one_text_in_address_and_file():
    told = ask(
        """(title) => {
          const texts = { "release.x": "0.1", "release.y": "0" };
          const back = textsOfFragment(`#${fragmentOf(title, texts, fields)}`, fields);
          return { ...back, toml: tomlOf(back.title, back.texts, fields) };
        }""",
        HOSTILE,
    )
    for mine in told:
        document = tomllib.loads(mine["toml"].encode("utf-8", "replace").decode())
        assert mine["texts"] == {"release.x": "0.1", "release.y": "0"}
        assert document["site"]["gravity"] == "9.80665" and len(document) <= 5
        as_scene({"id": "mine", **document})


def test_a_bearing_is_ninety_minus_the_azimuth_exactly():
    bearings = ["0", "45", "90.10", "270", "359.999999999999999", "-0.0000000000000000001", "1e1"]
    told = ask("(text) => turnedCompass(text)", bearings)
    assert told == [
        "90",
        "45",
        "-0.1",
        "-180",
        "-269.999999999999999",
        "90.0000000000000000001",
        "80",
    ]
    back = ask("(text) => turnedCompass(text)", told)
    assert [float(text) for text in back] == [float(text) for text in bearings]
    assert ask("(text) => negated(text)", ["1", "-1", "+2", "0"]) == ["-1", "1", "-2", "0"]


def random_texts(count):
    """Pendulums anywhere, with both meanings of g, on small and large planets."""
    rng = random.Random(70)
    for _ in range(count):
        texts = {
            "pendulum.length": f"{10 ** rng.uniform(-2, 3):.12g}",
            "site.latitude": rng.choice(["0", "90", "-90", f"{rng.uniform(-90, 90):.12g}"]),
            "site.gravity": f"{rng.uniform(0, 20):.12g}",
            "site.gravity_is": rng.choice(["ellipsoid", "effective"]),
            "site.rotation_rate": rng.choice(["0", "7.292115e-5", f"{rng.gauss(0, 1e-4):.12g}"]),
            "site.altitude": f"{rng.uniform(-400, 9000):.6g}",
            "site.inverse_flattening": rng.choice(["inf", "298.257223563", "5"]),
        }
        if rng.random() < 0.5:
            texts["release.angle"] = f"{rng.uniform(0, 180):.10g}"
            texts["release.azimuth"] = rng.choice(["90", "33.3"])
        else:
            texts |= {"release.x": "0.001", "release.y": rng.choice(["0", "-0.003"])}
            texts["release.vx"] = "0.01"
        yield texts


def test_constants_and_release_are_those_of_the_model():
    """For all scenes that ship and 200 others; a double has rounded each operation once."""
    cases = [texts_of(load_scene(scene_id)) for scene_id in scene_ids()] + list(random_texts(200))
    told = ask(
        """(texts) => {
          const scene = sceneOf(texts, fields);
          const problem = problemOf(scene);
          const [turnNorth, turnUp] = constantsOf(scene);
          const products = centrifugalProducts(scene.site.rotation_rate, turnNorth, turnUp);
          return { constants: constantsOf(scene), products, release: releaseOf(scene), zeros: zeroAtRelease(problem) };
        }""",
        cases,
    )
    for texts, mine in zip(cases, told, strict=True):
        scene = scene_of(texts).with_values(["inputs=binary64"])
        k = constants_in_double(scene.exact)
        known = [float(value) for value in (*k.turn[1:], *k.pull[1:])]
        size = max(math.hypot(*known[2:]), float(scene.exact.gravity / scene.exact.length))
        for value, exact in zip(mine["constants"][:2], known[:2], strict=True):
            assert value == pytest.approx(exact, rel=1e-15, abs=1e-16 * abs(float(k.rate))), texts
        for value, exact in zip(mine["constants"][2:], known[2:], strict=True):
            assert value == pytest.approx(exact, rel=2e-15, abs=4e-16 * size), texts
            assert (value == 0) == (exact == 0) or abs(exact) < 1e-16 * size, texts
        products = [float(value) for value in k.centrifugal]
        assert mine["products"] == pytest.approx(products, rel=4e-15, abs=4e-16 * products[0])
        start = Start.of(scene.exact, 53 + GUARD_BITS)
        released = [float(value) for value in (*start.position, *start.velocity)]
        length, speed = float(k.length), math.hypot(*released[3:])
        assert mine["release"][:3] == pytest.approx(released[:3], abs=4e-16 * length), texts
        assert mine["release"][3:] == pytest.approx(released[3:], rel=1e-14, abs=4e-15 * speed), (
            texts
        )
        assert mine["zeros"] == zero_at_release(start), texts
