"""Help, version and completion: what a newcomer and a shell ask for."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from importlib.metadata import version

import pytest
from places import ROOT

from compare.candidates.external import REPEATS, TIMEOUT_S
from compare.commands import app as comparing
from compare.commands import score, studies
from compare.score.judge import TOLERANCE
from compare.studies.stability import LIMIT_S as STABILITY_LIMIT_S
from compare.studies.study import LIMIT_S as STUDY_LIMIT_S
from compare.studies.study_plan import SPAN_S
from foucault import GROUPS
from reference.commands import app as computing
from reference.scenes.shipped import DATA_VERSION

COMMANDS = [str(one.name) for part in (computing, comparing) for one in part.registered_commands]


@pytest.mark.parametrize("word", ["--help", "-h"])
def test_the_help_says_what_the_program_does_how_to_begin_and_each_command_in_a_line(
    foucault, word, monkeypatch
):
    monkeypatch.setenv("COLUMNS", "80")
    status, out, _ = foucault(word)
    assert status == 0
    assert "reference solutions of the Foucault pendulum" in out and "foucault scenes" in out
    lines = out.splitlines()
    begin = min(lines.index(f"{heading}:") for heading in GROUPS)
    listed = [line.split()[0] for line in lines[begin:] if line.startswith("  ")]
    assert sorted(listed) == sorted(COMMANDS)
    assert [line for line in lines if line.rstrip().endswith(("…", "...")) or len(line) > 80] == [
        "Usage: foucault [OPTIONS] COMMAND [ARGS]..."
    ]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_and_pend_keeps_the_papers_switch_h(foucault, command):
    status, out, _ = foucault(command, "--help")
    assert status == 0
    if command == "pend":
        assert "-h M" in out
    else:
        assert foucault(command, "-h") == (0, out, "")


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_of_a_command_fits_on_two_screens(foucault, monkeypatch, command):
    monkeypatch.setenv("COLUMNS", "80")
    lines = foucault(command, "--help")[1].splitlines()
    assert len(lines) <= 50 and max(map(len, lines)) <= 80


def test_what_the_help_of_score_leaves_out_works_and_stands_on_the_page_that_it_names(
    foucault, tmp_path
):
    out = foucault("score", "--help")[1]
    page = (ROOT / "docs/commands.md").read_text(encoding="utf-8")
    for option, value in {"--approximation": "ID", "--name": "WORD", "--repeats": "N"}.items():
        assert option in out and f"  {option} {value}" not in out
        assert f"* `{option} {value}`: " in page
    file = tmp_path / "mine.csv"
    file.write_text("t,x,y\n0,0.3,0.4\n", encoding="utf-8")
    run = f"cat {shlex.quote(str(file))}"
    command = ["score", "paris", "--t-end", "60", "--run", run, "--name", "mine", "--repeats", "0"]
    assert foucault(*command)[1].startswith("mine ")


def test_the_version_is_that_of_the_package(foucault):
    assert foucault("--version") == (
        0,
        f"foucault {version('foucault-reference')}, data {DATA_VERSION}\n",
        "",
    )


@pytest.mark.parametrize(
    ("command", "option", "default"),
    [
        ("score", "--tolerance", f"{TOLERANCE:.0e}".replace("e-0", "e-") + " of the amplitude"),
        ("score", "--t-end", "the scene's"),
        ("score", "--timeout", f"{TIMEOUT_S:g}"),
        ("generate", "--t-end", "the scene's"),
        ("generate", "--digits", "the scene's"),
        ("generate", "--level", "the scene's"),
        ("generate", "--out", "golden/SCENE"),
        ("study", "--methods", "all"),
        ("study", "--t-end", f"the scene's; at most {SPAN_S} with --precisions"),
        ("study", "--limit", f"{STUDY_LIMIT_S:g}"),
        ("study", "--settings", studies.STEPS_S),
        ("stability", "--methods", "all"),
        ("stability", "--scenes", "paris and all that have flags"),
    ],
)
def test_the_help_states_the_default_that_the_code_has(foucault, command, option, default):
    out = foucault(command, "--help")[1]
    (text,) = re.findall(rf"^  {option} .*?(?=^  -|\Z)", out, re.MULTILINE | re.DOTALL)
    assert f"(default: {default}" in " ".join(text.split())


def test_limits_of_the_command_line_are_those_of_python():
    assert (studies.LIMIT_S, studies.STABILITY_LIMIT_S) == (STUDY_LIMIT_S, STABILITY_LIMIT_S)
    assert score.REPEATS == REPEATS
    assert studies.StabilityOptions().limit == STABILITY_LIMIT_S


def asked(*words: str) -> dict[str, str]:
    """Return the variables with which bash asks what it can offer for the last of the words."""
    line = " ".join(["foucault", *words])
    return {
        "_FOUCAULT_COMPLETE": "complete_bash",
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(words)),
    }


def test_a_shell_completes_a_command_by_a_process_of_its_own():
    done = subprocess.run(
        [sys.executable, "-m", "foucault"],
        check=False,
        env={**os.environ, **asked("gen")},
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert (done.stdout, done.stderr) == ("generate\n", "")


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (("generate", "par"), ["paris", "paris_30d", "paris_measured"]),
        (("study", "paris", "--methods", "rk4,rkng"), ["rk4,rkng56", "rk4,rkng67"]),
        (
            ("stability", "--scenes", "hard,par"),
            ["hard,paris", "hard,paris_30d", "hard,paris_measured"],
        ),
        (("generate", "paris", "--level", "con"), ["confirmed"]),
        (("show", "paris", "--set", "site.lat"), ["site.latitude="]),
        (("verify", "paris.b"), ["paris.binary64"]),
        (("score", "paris", "--approximation", "linear_3"), ["linear_3d"]),
    ],
)
def test_a_shell_completes_commands_scenes_methods_and_fields(
    foucault, monkeypatch, words, offered
):
    for name, value in asked(*words).items():
        monkeypatch.setenv(name, value)
    assert foucault()[1].split() == offered


def test_completion_can_be_installed_and_shown(foucault):
    out = foucault("--help")[1]
    assert "--install-completion" in out and "--show-completion" in out
