"""`--baseline`: what its exit status means, for files, documents, commands, suites, JUnit, and other people's tests."""

from __future__ import annotations

import json
import shlex
import shutil
from importlib.resources import files
from xml.etree import ElementTree

import jsonschema
import numpy as np
import pytest
from sampled import one_in

from compare import assert_agrees, judge
from compare.score.document import document
from compare.testing import SceneCase
from reference import InputError, load_scene, solve, trajectory

SCHEMA = json.loads(files("compare.report").joinpath("score.schema.json").read_text("utf-8"))
SCENE = (
    'id = "{name}"\ninputs = "binary64"\n[pendulum]\nlength = "2"\n[release]\nx = "0.1"\ny = "0.2"\n'
    '[run]\nt_end = "20"\ngrid_step = "5"\ndigits = 22\n'
)
# m; the tolerance is 2e-7 m
OFF = {"right": 0.0, "near": 1e-7, "wrong": 1e-3, "as_wrong": 1e-3 + 1e-7, "worse": 2e-3}


@pytest.fixture(scope="module", autouse=True)
def own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FOUCAULT_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    """A folder of a scene, and what versions of a program that are off by so much print."""
    folder = tmp_path_factory.mktemp("versions")
    (folder / "mine.toml").write_text(SCENE.format(name="mine"))
    t = np.linspace(0, 20, 41)
    states = trajectory(load_scene(folder / "mine.toml"), t)[:, :2]
    for name, off in OFF.items():
        table = np.column_stack([t, states[:, 0] + off, states[:, 1]])
        np.savetxt(
            folder / f"{name}.csv", table, delimiter=",", header="t,x,y", fmt="%.17g", comments=""
        )
    np.savetxt(
        folder / "short.csv", table[:20], delimiter=",", header="t,x,y", fmt="%.17g", comments=""
    )
    return folder


def judged(foucault, folder, new, old, *words):
    words = (
        "score",
        folder / "mine.toml",
        folder / f"{new}.csv",
        "--baseline",
        old,
        "--no-diagnosis",
        *words,
    )
    status, out, err = foucault(*words, "--json")
    assert "Traceback" not in err
    document = json.loads(out)
    jsonschema.validate(document, SCHEMA)
    text = foucault(*words)[1].splitlines()
    assert text[1] == f"{document['baseline']['text']}."
    return status, document


CASES = [  # version, baseline, exit status, verdict, how the line begins
    ("right", "right", 0, "agrees", "Since"),
    ("near", "right", 0, "agrees", "Since"),  # worse, but by less than the tolerance
    ("wrong", "right", 1, "disagrees", "Worse since"),
    ("right", "wrong", 0, "agrees", "Better since"),
    ("wrong", "wrong", 0, "disagrees", "Since"),  # wrong before, and as wrong now
    ("as_wrong", "wrong", 0, "disagrees", "Since"),
    ("worse", "wrong", 1, "disagrees", "Worse since"),
    ("wrong", "worse", 0, "disagrees", "Better since"),
    ("short", "worse", 1, "disagrees", "Worse since"),  # it ends earlier
    ("worse", "short", 0, "disagrees", "Since"),  # over the span that both have
]


@pytest.mark.parametrize(
    ("kind", "new", "old", "status", "verdict", "begins"),
    [*(("file", *case) for case in CASES), *one_in(4, [("document", *case) for case in CASES])],
)
def test_the_status_tells_whether_it_became_worse(
    foucault, rows, tmp_path, kind, new, old, status, verdict, begins
):
    baseline = rows / f"{old}.csv"
    if kind == "document":
        out = foucault("score", rows / "mine.toml", baseline, "--json", "--no-diagnosis")[1]
        baseline = tmp_path / "old.json"
        baseline.write_text(out)
    done, document = judged(foucault, rows, new, baseline)
    since = document["baseline"]
    assert (done, document["verdict"]) == (status, verdict) and since["text"].startswith(
        f"{begins} {baseline}: "
    )
    assert bool(since["worse"]) is bool(status) and since["better"] is begins.startswith("Better")
    expected = pytest.approx(abs(OFF.get(new, 2e-3) - OFF.get(old, 2e-3)), abs=1e-12)
    assert since["apart_m"] == expected and (since["apart_m"] == 0) is (
        "no position changed" in since["text"]
    )


def test_what_became_worse_is_said(foucault, rows):
    worse = judged(foucault, rows, "wrong", rows / "right.csv")[1]["baseline"]["worse"]
    assert worse == ["0.001 m more, 4.4e+03 tolerances", "it agreed before"]
    assert judged(foucault, rows, "short", rows / "worse.csv")[1]["baseline"]["worse"] == [
        "it ends at t = 9.5 s, and ended at 20 s"
    ]
    unknown = judged(foucault, rows, "worse", rows / "wrong.csv")[1]["baseline"]["text"]
    # with --no-diagnosis
    not_sought = "what lies between them, 0.001 m, is not explained: its cause was not looked for"
    assert not_sought in unknown
    lost = ("--transits", rows / "right.csv")
    # the baseline has no transits
    assert judged(foucault, rows, "wrong", rows / "wrong.csv", *lost)[0] == 0


def test_a_clock_that_starts_late_is_what_changed(foucault, rows, tmp_path):
    table = np.loadtxt(rows / "right.csv", delimiter=",", skiprows=1)
    table[:, 0] += 0.01
    late = tmp_path / "late.csv"
    np.savetxt(late, table, delimiter=",", header="t,x,y", fmt="%.17g", comments="")
    words = ("score", rows / "mine.toml", late, "--baseline", rows / "right.csv")
    status, out, _ = foucault(*words)
    change = out.splitlines()[1]
    assert status == 1 and "its file now starts its clock at 0.01 s and not at 0: " in change
    assert "; nothing else" in change


def test_transits_that_moved_are_told_where_no_position_did(rows):
    """Also where both versions disagree; a document tells as much as a score."""
    scene, t = load_scene(rows / "mine.toml"), np.linspace(0, 20, 41)
    columns = {"t": t, **dict(zip("xy", trajectory(scene, t)[:, :2].T, strict=True))}
    zeros = solve(scene).transits.array("t")

    def version(late, baseline=None):
        return judge(columns, scene, transits=zeros + late, explain=False, baseline=baseline)

    right, late = version(0.0), version(1e-3)
    for old in (late, document(late)):
        worse, better = version(2e-3, old).since, version(0.0, old).since
        assert worse.text.startswith("Worse since candidate: no position changed") and better.better
        (reason,) = worse.worse
        assert (
            reason.startswith("transits are off by 0.000")
            and "weighted by |ax|, and were by 0.000" in reason
        )
        assert better.text.startswith("Better since candidate: no position changed")
        assert better.gains[0] == "it disagreed before" and better.gains[1].startswith(
            "transits are off by "
        )
    same = version(1e-3, late).since
    assert (same.worse, same.gains) == ((), ())
    fewer = judge(columns, scene, transits=zeros[1:], explain=False, baseline=right).since
    assert fewer.worse == ("it agreed before", "of transits 1 are missed or extra, and 0 were")
    # what is missed later says nothing of this span
    early = {name: column[:20] for name, column in columns.items()}
    short = judge(early, scene, transits=zeros[zeros < 9.5], explain=False)
    assert judge(
        columns, scene, transits=zeros[:-1], explain=False, baseline=short
    ).since.worse == ("it agreed before",)


def test_a_baseline_that_cannot_be_read_is_told_by_its_own_name(foucault, rows, tmp_path):
    words = ("score", rows / "mine.toml")
    for name in ("nowhere.csv", "nowhere.json"):
        for more in (
            (rows / "right.csv",),
            ("--run", f"cat {shlex.quote(str(rows / 'right.csv'))}", "--repeats", "0"),
        ):
            status, _, err = foucault(*words, *more, "--baseline", tmp_path / name)
            assert status == 2 and f"--baseline: got '{tmp_path / name}'" in err, err
    status, _, err = foucault(*words, rows / "right.csv", "--baseline", tmp_path)
    assert status == 2 and "--baseline: got" in err and "Is a directory" in err
    (tmp_path / "suite").mkdir()
    shutil.copy(rows / "right.csv", tmp_path / "suite" / "paris.csv")
    assert (
        "--baseline: got"
        in foucault("score", "--suite", tmp_path / "suite", "--baseline", "nowhere.json")[2]
    )
    for wrong in ("nowhere.csv", "nowhere.json", 3, [3]):
        with pytest.raises(InputError, match=r"^baseline: got '(nowhere|3|\[3)"):
            judge(rows / "right.csv", rows / "mine.toml", baseline=wrong)


def test_commands_are_compared_too(foucault, rows):
    run = f"cat {shlex.quote(str(rows / 'worse.csv'))}"
    words = ("score", rows / "mine.toml", "--repeats", "0", "--no-diagnosis", "--run", run)
    baseline = f"cat {shlex.quote(str(rows / 'wrong.csv'))}"
    status, out, _ = foucault(*words, "--baseline", baseline)
    assert status == 1 and f"Worse since {baseline}: 0.001 → 0.002 m" in out
    assert foucault(*words, "--baseline", rows / "worse.csv")[0] == 0
    earlier = rows / "base.json"
    earlier.write_text(foucault(*words, "--json")[1])
    status, out, _ = foucault(*words, "--baseline", earlier)
    # both versions are "the program"
    assert status == 0 and f"Since {earlier}: no position changed" in out
    status, _, err = foucault(*words, "--baseline", "no_such_program at all")
    assert status == 2 and "a program that can be started" in err


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[]", "a JSON object of keys and values"),
        ("{}", "a document that `foucault score --json` wrote"),
        ('{"scene": "mine"}', "a document that `foucault score --json` wrote"),
        ('{"rows": [7]}', "a document that `foucault score --json` wrote"),
        ("other", "Score both with the same inputs"),
        ("changed", "Score both with the same inputs"),
        ("words", "a document that `foucault score --json` wrote"),
    ],
)
def test_what_is_no_baseline_is_refused(foucault, rows, tmp_path, text, said):
    document = json.loads(
        foucault("score", rows / "mine.toml", rows / "near.csv", "--json", "--no-diagnosis")[1]
    )
    change = {
        "other": {"scene": "paris"}, "words": {"max_error_m": "small"},
        "changed": {"problem": document["problem"] | {"release": {"x": "0.3", "y": "0.2"}}},
    }  # fmt: skip
    (tmp_path / "old.json").write_text(
        json.dumps(document | change[text]) if text in change else text
    )
    words = ("score", rows / "mine.toml", rows / "near.csv", "--no-diagnosis")
    status, out, err = foucault(*words, "--baseline", tmp_path / "old.json")
    assert (status, out) == (2, "") and said in err
    status, _, err = foucault(*words, "--baseline", tmp_path / "nowhere.csv")
    assert status == 2 and "nowhere.csv" in err
    status, _, err = foucault("score", "paris", "--approximation", "conical", "--baseline", "x.csv")
    assert status == 2 and "without a file, --run or --suite" in err


@pytest.fixture
def suites(rows, tmp_path):
    """Two folders: `same` became no better, `lost` is gone, `new` has come, `worse` became worse."""
    for folder, versions in {
        "old": {"same": "wrong", "lost": "right", "worse": "right"},
        "new": {"same": "wrong", "new": "right", "worse": "wrong"},
    }.items():
        (tmp_path / folder).mkdir()
        for name, version in versions.items():
            (tmp_path / folder / f"{name}.toml").write_text(SCENE.format(name=name))
            shutil.copy(rows / f"{version}.csv", tmp_path / folder / f"{name}.csv")
    return tmp_path


@pytest.mark.parametrize("kind", one_in(2, ["folder", "document", "page"]))
def test_a_suite_is_compared_with_an_earlier_one(foucault, suites, kind):
    baseline = suites / "old"
    if kind != "folder":
        words = (
            "score",
            "--suite",
            baseline,
            "--no-diagnosis",
            "--json",
            "--out",
            suites / "before",
        )
        (suites / "old.json").write_text(foucault(*words)[1])
        baseline = suites / ("old.json" if kind == "document" else "before/suite.json")
    words = (
        "score",
        "--suite",
        suites / "new",
        "--baseline",
        baseline,
        "--no-diagnosis",
        "--junit",
        suites / "j.xml",
    )
    status, out, _ = foucault(*words, "--json", "--out", suites / "page")
    assert status == 2
    document = json.loads(out)
    jsonschema.validate(document, SCHEMA)
    told = {row["scene"]: row for row in document["rows"]}
    assert told["lost"]["verdict"] == "refused" and "no file for lost" in told["lost"]["error"]
    assert told["new"]["baseline"] is None and "nothing is compared" in told["new"]["notes"][0]
    before = suites / "old/same.csv" if kind == "folder" else baseline
    assert told["same"]["baseline"]["text"].startswith(f"Since {before}: ")
    assert (
        told["same"]["baseline"]["worse"] == []
        and "it agreed before" in told["worse"]["baseline"]["worse"]
    )
    root = ElementTree.parse(suites / "j.xml").getroot()
    assert root.attrib == {"tests": "4", "failures": "1", "errors": "1"}
    kinds = {case.get("classname"): case[0] for case in root.iter("testcase")}
    tags = {name: kind.tag for name, kind in kinds.items()}
    names = ("same", "new", "worse", "lost")
    assert [tags[f"foucault.{name}"] for name in names] == [
        "system-out",
        "system-out",
        "failure",
        "error",
    ]
    assert kinds["foucault.worse"].get("message").startswith("Worse since")
    assert "no position changed" in kinds["foucault.same"].text
    page = (suites / "page/index.html").read_text()
    assert "Worse since" in page and "no position changed" in page
    out = foucault(*words, "--github")[1]
    signs = [
        line.partition(" ")[0]
        for line in out.splitlines()
        if line.startswith(("::error", "::notice"))
    ]
    assert signs == ["::notice", "::notice", "::error", "::error"]


def test_other_peoples_tests_have_a_baseline_too(rows):
    scene = load_scene(rows / "mine.toml")
    t, *columns = np.loadtxt(rows / "wrong.csv", delimiter=",", skiprows=1).T
    states = np.column_stack(columns)
    with pytest.raises(AssertionError, match="position error"):
        assert_agrees(scene, t, states)
    kept = assert_agrees(scene, t, states, baseline=rows / "wrong.csv")
    assert kept.verdict == "disagrees" and kept.since is not None and kept.since.apart_m == 0
    assert assert_agrees(scene, t, states, baseline=kept).accepted
    with pytest.raises(AssertionError, match=r"Worse since .*right\.csv.*it agreed before"):
        SceneCase(scene).assert_agrees(t, states, baseline=rows / "right.csv")
    with pytest.raises(InputError, match=r"nowhere\.json.*foucault score … --json"):
        assert_agrees(scene, t, states, baseline="nowhere.json")
