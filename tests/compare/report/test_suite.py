"""Several candidates at once, as in other people's CI: a bad one costs only itself, and every form says the same."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
from importlib.resources import files
from xml.etree import ElementTree

import jsonschema
import numpy as np
import pytest

from compare.commands.suite_files import suite_files
from reference import load, load_scene, trajectory
from reference.scenes.shipped import DATA_VERSION

SCHEMA = json.loads(files("compare.report").joinpath("score.schema.json").read_text("utf-8"))
SHORT = (
    'id = "{name}"\n[pendulum]\nlength = "2"\n[release]\nx = "0.1"\ny = "0.2"\n'
    '[run]\nt_end = "20"\ngrid_step = "5"\ndigits = 22\n'
)


@pytest.fixture(scope="module", autouse=True)
def own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FOUCAULT_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A suite: paris is right, a scene of its own is wrong, another cannot be read, one has transits alone."""
    folder = tmp_path_factory.mktemp("suite")
    golden = load("paris.binary64")
    np.savez(folder / "paris.npz", t=golden.t[:61], x=golden.x[:61], y=golden.y[:61])
    times = golden.transits["t"][golden.transits["t"] < 3600].tolist()
    (folder / "paris.transits.csv").write_text("t\n" + "".join(f"{t!r}\n" for t in times))
    for name in ("wrong", "bad"):
        (folder / f"{name}.toml").write_text(SHORT.format(name=name))
    t = np.linspace(0, 20, 41)
    states = trajectory(load_scene(folder / "wrong.toml", ["inputs=binary64"]), t)
    rows = np.column_stack([t, states[:, :2] + [1e-3, 0]])
    np.savetxt(folder / "wrong.csv", rows, delimiter=",", header="t,x,y", fmt="%.17g")
    (folder / "bad.csv").write_text("t,x,y\n0,0.1,0.2\n5,nan,0.1\n")
    (folder / "README.md").write_text("not a candidate")
    return folder


def test_the_files_of_a_suite_are_named_by_their_scenes(folder):
    found = suite_files(folder)
    assert [files.rows.name for files in found] == ["bad.csv", "paris.npz", "wrong.csv"]
    scenes = [str(folder / "bad.toml"), "paris", str(folder / "wrong.toml")]
    assert [files.scene for files in found] == scenes
    assert [files.transits for files in found] == [None, folder / "paris.transits.csv", None]


def test_a_suite_is_one_table_one_page_one_badge(foucault, folder, tmp_path):
    status, out, _ = foucault(
        "score", "--suite", folder, "--no-diagnosis", "--out", tmp_path / "page"
    )
    assert status == 2
    assert "bad.csv was not judged by bad: " in out and "nan in row 2" in out
    assert "paris.npz agrees with paris (61 rows, t = 0 to 3600 of 86400 s: 4.16 %)" in out
    assert "wrong.csv disagrees with wrong" in out
    names = ["SHA256SUMS", "badge.svg", "index.html", "rows.csv", "suite.json"]
    assert sorted(os.listdir(tmp_path / "page")) == names
    badge = (tmp_path / "page/badge.svg").read_text()
    root = ElementTree.fromstring(badge)
    title = root.find("{http://www.w3.org/2000/svg}title").text
    assert title == f"Foucault pendulum: 1 of 3 scenes · 16.1 digits · data {DATA_VERSION}"
    page = (tmp_path / "page/index.html").read_text()
    assert all(
        word in page
        for word in ("paris", "wrong", "bad", "refused", "disagrees", "What was found", "<svg")
    )
    document = json.loads((tmp_path / "page/suite.json").read_text())
    assert (document["agree"], document["verdict"]) == (1, "refused")
    assert "<li>- " not in page
    first = {path.name: path.read_bytes() for path in (tmp_path / "page").iterdir()}
    assert (
        foucault("score", "--suite", folder, "--no-diagnosis", "--out", tmp_path / "page")[0] == 2
    )
    assert first == {path.name: path.read_bytes() for path in (tmp_path / "page").iterdir()}


def test_a_folder_with_a_page_of_somebody_else_stays_as_it_is(foucault, folder, tmp_path):
    (tmp_path / "index.html").write_text("mine")
    status, out, err = foucault("score", "--suite", folder, "--out", tmp_path)
    assert (status, out) == (2, "") and "--out" in err
    assert os.listdir(tmp_path) == ["index.html"]


def test_two_files_for_one_scene_are_refused(foucault, tmp_path):
    for name in ("paris.csv", "paris.txt"):
        (tmp_path / name).write_text("t,x,y\n0,0.3,0.4\n")
    status, _, err = foucault("score", "--suite", tmp_path)
    assert status == 2 and "paris.csv and paris.txt" in err


def test_a_file_of_no_scene_costs_only_itself(foucault, tmp_path, folder):
    shutil.copy(folder / "paris.npz", tmp_path)
    (tmp_path / "pariss.csv").write_text("t,x,y\n0,0.3,0.4\n")
    status, out, _ = foucault("score", "--suite", tmp_path)
    assert status == 2
    assert (
        "pariss.csv was not judged by pariss: SCENE: got 'pariss'" in out
        and "Did you mean paris?" in out
    )
    assert "paris.npz agrees" in out


@pytest.mark.parametrize(
    ("names", "status"), [(("good", "wrong"), 1), (("good", "bad", "wrong"), 2), (("good",), 0)]
)
def test_one_bad_file_of_several_costs_only_itself_and_the_worst_status_counts(
    foucault, tmp_path, names, status
):
    golden = load("paris.binary64")
    rows = np.column_stack([golden.t, golden.x, golden.y])[:11]
    for name in names:
        text = "".join(
            f"{t!r},{'soon' if name == 'bad' else x + (name == 'wrong')},{y!r}\n"
            for t, x, y in rows.tolist()
        )
        (tmp_path / f"{name}.csv").write_text(f"t,x,y\n{text}")
    words = (
        "score",
        "paris",
        *(tmp_path / f"{name}.csv" for name in names),
        "--no-diagnosis",
        "--json",
    )
    done, out, _ = foucault(*words)
    assert done == status
    document = json.loads(out)
    jsonschema.validate(document, SCHEMA)
    verdicts = {"good": "agrees", "bad": "refused", "wrong": "disagrees"}
    rows = document.get("rows") if len(names) > 1 else [document]
    assert [row["verdict"] for row in rows] == [verdicts[name] for name in names]


def test_a_single_bad_file_is_a_message_alone(foucault, tmp_path):
    (tmp_path / "bad.csv").write_text("t,x,y\n0,0.1\n")
    status, out, err = foucault("score", "paris", tmp_path / "bad.csv")
    assert (status, out) == (2, "") and "2 fields" in err


def test_junit_has_a_test_for_each(foucault, folder, tmp_path):
    target = tmp_path / "junit.xml"
    assert foucault("score", "--suite", folder, "--no-diagnosis", "--junit", target)[0] == 2
    root = ElementTree.parse(target).getroot()
    assert root.attrib == {"tests": "3", "failures": "1", "errors": "1"}
    cases = {case.get("classname"): case for case in root.iter("testcase")}
    assert set(cases) == {"foucault.bad", "foucault.paris", "foucault.wrong"}
    assert [child.tag for child in cases["foucault.paris"]] == ["system-out"]
    (failure,) = cases["foucault.wrong"]
    assert failure.tag == "failure" and "disagrees with wrong" in failure.get("message")
    assert "largest error" in failure.text
    (error,) = cases["foucault.bad"]
    assert error.tag == "error" and "nan in row 2" in error.get("message")


def test_junit_of_a_single_bad_file_is_written_too(foucault, tmp_path):
    (tmp_path / "b\x1b.csv").write_text("t,x,y\n0,<&>\n")
    assert (
        foucault("score", "paris", tmp_path / "b\x1b.csv", "--junit", tmp_path / "junit.xml")[0]
        == 2
    )
    root = ElementTree.parse(tmp_path / "junit.xml").getroot()
    assert root.get("errors") == "1"
    status, _, err = foucault(
        "score", "paris", tmp_path / "b\x1b.csv", "--junit", tmp_path / "no/such/junit.xml"
    )
    assert status == 2 and "--junit" in err


def test_github_gets_annotations_and_a_summary(foucault, folder, tmp_path, monkeypatch):
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path / "summary.md"))
    (tmp_path / "summary.md").write_text("before\n")
    status, out, _ = foucault("score", "--suite", folder, "--no-diagnosis", "--github")
    assert status == 2
    commands = [line for line in out.splitlines() if line.startswith(("::error", "::notice"))]
    assert [line.split(" ")[0] for line in commands] == ["::error", "::notice", "::error"]
    assert "title=foucault paris::" in commands[1]
    assert all("%0A" in line or line.count("::") == 2 for line in commands)
    summary = (tmp_path / "summary.md").read_text()
    assert summary.startswith("before\n### Foucault pendulum")
    assert (
        "| ✅ | `paris` |" in summary and "| ❌ | `wrong` |" in summary and "<details>" in summary
    )
    monkeypatch.delenv("GITHUB_STEP_SUMMARY")
    assert foucault("score", "--suite", folder, "--no-diagnosis", "--github")[0] == 2


def test_what_an_annotation_would_take_for_its_own_is_escaped(foucault, tmp_path):
    name = tmp_path / "a,b:c%.csv"
    name.write_text("t,x,y\n0,0.3,0.4\n60,1,1\n")
    out = foucault("score", "paris", name, "--github", "--no-diagnosis")[1]
    (line,) = [line for line in out.splitlines() if line.startswith("::error")]
    assert line.startswith("::error file=") and "a%2Cb%3Ac%25.csv,title=foucault paris::" in line


def test_an_annotation_of_what_is_no_file_names_none(foucault, tmp_path):
    rows = tmp_path / "rows.csv"
    rows.write_text("t,x,y\n0,0.3,0.4\n60,1,1\n")
    for words in (("--run", f"cat {rows}", "--repeats", "0"), (tmp_path / "no.csv",)):
        out = foucault("score", "paris", *words, "--github", "--no-diagnosis")[1]
        (line,) = [line for line in out.splitlines() if line.startswith("::error")]
        assert line.startswith("::error title=foucault paris::")


def test_documents_keep_their_schema(foucault, folder, tmp_path):
    """A score with everything in it, one of transits alone, a suite; an extra key or a word for a number is refused."""
    paris, exchanged = folder / "paris.npz", tmp_path / "exchanged.csv"
    t, x, y = np.loadtxt(folder / "wrong.csv", delimiter=",").T
    np.savetxt(
        exchanged, np.column_stack([t, y, x - 1e-3]), delimiter=",", header="t,x,y", fmt="%.17g"
    )
    documents = [
        json.loads(foucault("score", *words, "--json")[1])
        for words in (
            ("paris", paris, "--transits", folder / "paris.transits.csv"),
            ("paris", "--transits", folder / "paris.transits.csv"),
            (folder / "wrong.toml", exchanged),
            (
                "paris",
                "--run",
                f"cat {shlex.quote(str(folder / 'wrong.csv'))}",
                "--repeats",
                "0",
                "--no-diagnosis",
            ),
            ("--suite", folder, "--no-diagnosis"),
        )
    ]
    for document in documents:
        jsonschema.validate(document, SCHEMA)
    assert documents[2]["conventions"]  # so that what is explained is held too
    for change in ({"extra": 1}, {"max_error_m": "small"}, {"verdict": "maybe"}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**documents[0], **change}, SCHEMA)
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_c_and_javascript_are_judged_through_run(foucault, tmp_path):
    """Python is in tests/compare/commands/test_programs.py."""
    from places import ROOT

    command = "{x0} {y0} {length} {latitude} {gravity} {rotation_rate} {t_end} 0.05"
    for tool, program in (
        ("cc", tmp_path / "pendulum"),
        ("node", ROOT / "tests/helpers/pendulum.js"),
    ):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
        if tool == "cc":
            subprocess.run(
                ["cc", "-O2", ROOT / "docs/pendulum.c", "-o", program, "-lm"], check=True
            )
        words = [str(program)] if tool == "cc" else ["node", str(program)]
        run = f"{shlex.join(words)} {command}"
        words = (
            "score",
            "paris",
            "--t-end",
            "600",
            "--repeats",
            "0",
            "--covers",
            "1",
            "--name",
            tool,
        )
        status, out, _ = foucault(*words, "--run", run)
        assert (status, out.splitlines()[0]) == (
            0,
            f"{tool} agrees with paris (11 rows, t = 0 to 600 of 600 s: 100 %)",
        )
        assert foucault(*words, "--run", run.replace("{t_end}", "540"))[0] == 1
