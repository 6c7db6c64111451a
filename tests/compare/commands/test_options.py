"""Options without effect are refused with the reason; nothing is computed or written before."""

from __future__ import annotations

import sys

import pytest
from lines import unwrapped

from compare.methods import METHODS

STUDY, SCORE, GENERATE = ("study", "paris"), ("score", "paris", "-"), ("generate", "paris")
LATE = ("--t-end", "10", "--set", "run.t_end=20")

REFUSED = [
    (
        (*STUDY, "--approximations", "--precisions", "53"),
        "--precisions",
        "together with --approximations",
    ),
    (
        (*STUDY, "--approximations", "--methods", "rk4"),
        "--methods",
        "together with --approximations",
    ),
    ((*STUDY, "--approximations", "--run", "./p"), "--run", "together with --approximations"),
    ((*STUDY, "--approximations", "--limit", "5"), "--limit", "together with --approximations"),
    (
        (*STUDY, "--approximations", "--no-formulations"),
        "--no-formulations",
        "together with --approximations",
    ),
    ((*STUDY, "--approximations", "--set", "run.grid_step=7"), "--set", "at set times"),
    ((*STUDY, "--methods", "rk5"), "method", "Did you mean rkng56 or rk4?"),
    ((*STUDY, "--limit", "0"), "--limit", "a positive number of seconds"),
    ((*STUDY, "--precisions", "12"), "--precisions", "bits from 53 to 4096"),
    ((*STUDY, "--precisions", "x"), "--precisions", "bits from 53 to 4096"),
    ((*STUDY, "--t-end", "-1"), "run.t_end", "a number above 0"),
    ((*STUDY, "--cpu", "1"), "--cpu", "without --candidates"),
    ((*STUDY, "--settings", "0.1"), "--settings", "without --run"),
    (
        (*STUDY, "--settings", "0.1", "--run", "./p"),
        "--settings",
        "without {setting} in --run",
    ),
    ((*STUDY, "--name", "mine"), "--name", "without --run"),
    (
        (*STUDY, "--run", "./p", "--run", "./q", "--name", "p"),
        "--name",
        "2 names, one for each --run",
    ),
    ((*STUDY, "--run", "./p", "--name", "rk4"), "--name", "a name other than that of a method"),
    (
        (*STUDY, "--run", "./p 1", "--run", "./p 2"),
        "--name",
        "a name other than that of another --run",
    ),
    ((*STUDY, "--run", "./p", "--name", "x" * 25), "--name", "1 to 24 printable characters"),
    ((*STUDY, "--run", "./p {nonsense}"), "--run", "{x0}"),
    ((*STUDY, *LATE), "--t-end", "together with --set run.t_end=20"),
    ((*STUDY, "--set", "inputs=decimal"), "--set", "Methods are given doubles"),
    ((*STUDY, "--set", "run.level=enclosed"), "--set", "confirmed"),
    ((*STUDY, "--precisions", "113", "--set", "run.digits=9"), "--set", "the finest precision"),
    (
        (*STUDY, "--precisions", "113", "--methods", "rk4"),
        "--methods",
        "methods with these --precisions",
    ),
    ((*SCORE, "--name", "mine"), "--name", "without --run"),
    ((*SCORE, "--out", "page"), "--out", "without --suite"),
    ((*SCORE, "--json", "--github"), "--github", "together with --json"),
    ((*SCORE, "--covers", "1.5"), "--covers", "up to 1"),
    ((*SCORE, "--units", "furlong"), "--units", "units of time or length: s, ms"),
    ((*SCORE, "--units", "ms,min"), "--units", "one unit of time"),
    (("score",), "SCENE", "or --suite DIR"),
    (("score", "paris", "--suite", "."), "SCENE", "together with --suite"),
    (("score", "--suite", ".", "--set", "site.latitude=1"), "--set", "together with --suite"),
    (("score", "--suite", "."), "--suite", "paris.csv"),
    (("score", "--suite", "nowhere"), "--suite", "a folder"),
    (("score", "--how", "pithon"), "--how", "Did you mean python?"),
    ((*SCORE, *LATE), "--t-end", "together with --set run.t_end=20"),
    ((*SCORE, "--timeout", "5"), "--timeout", "without --run"),
    ((*SCORE, "--repeats", "0"), "--repeats", "without --run"),
    (
        (*SCORE, "--inputs", "decimal", "--set", "inputs=binary64"),
        "--inputs",
        "together with --set inputs=binary64",
    ),
    ((*SCORE, "--inputs", "floats"), "--inputs", "expected auto, decimal or binary64"),
    (
        (*SCORE, "--set", "x0=0.1", "--set", "release.x=0.2"),
        "--set",
        "--set x0=0.1 is given as well",
    ),
    ((*SCORE, "--t-end", "10", "--set", "t_end=20"), "--t-end", "together with --set t_end=20"),
    ((*SCORE, "--set", "z0=-3"), "z0", "a field that scenes have"),
    ((*GENERATE, *LATE), "--t-end", "together with --set run.t_end=20"),
    (
        (*GENERATE, "--digits", "9", "--set", "run.digits=9"),
        "--digits",
        "together with --set run.digits=9",
    ),
    ((*GENERATE, "--level", "computed", "--set", "run.level=enclosed"), "--level", "together with"),
    ((*GENERATE, "--no-transits", "--set", "run.transits=true"), "--no-transits", "together with"),
    (
        (*GENERATE, "--set", "run.digits=9", "--set", " run.digits = 8"),
        "--set",
        "--set run.digits=9 is given as well",
    ),
    ((*GENERATE, "--level", "confimed"), "--level", "Did you mean confirmed?"),
    ((*GENERATE, "--engine", "limb"), "--engine", "Did you mean limbs?"),
    (("study", "pariss"), "SCENE", "Did you mean paris?"),
    ((*STUDY, "--methods", "rk4,dop853"), "method", "scipy_dop853"),
    (("score", "paris", "--approximation", "conic"), "approximation", "Did you mean conical?"),
    (
        ("score", "paris", "--approximation", "precession_sine"),
        "--approximation",
        "gives a single number",
    ),
    (("stability", "--methods", "nothing_like_it"), "method", "`foucault methods` lists them"),
    (
        ("stability", "--methods", "rk4,mpmath_odefun"),
        "methods",
        "expected methods that declare runs in `stability`",
    ),
    (("stability", "--name", "mine"), "--name", "without --run"),
    (("stability", "--run", "./p {nonsense}"), "--run", "{x0}"),
    (("stability", "--run", "./p 'x"), "--run", "a command with balanced quotes"),
    (("stability", "--scenes", "harrd"), "SCENE", "Did you mean hard?"),
]


@pytest.mark.parametrize(
    ("words", "field", "reason"), REFUSED, ids=[" ".join(row[0]) for row in REFUSED]
)
def test_what_would_have_no_effect_is_refused(
    foucault, words, field, reason, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    status, out, err = foucault(*words)
    assert (status, out) == (2, "")
    assert err.startswith(f"foucault: {field}: ")
    assert reason in err
    assert len(err) < 500
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "words", [("study", "paris", "--methods", "rk4"), ("stability", "--methods", "rk4,rkmk4")]
)
def test_methods_of_which_none_is_installed_are_refused_with_the_command_that_installs_them(
    foucault, words, monkeypatch, tmp_path
):
    for package in ("numba", "flint"):
        monkeypatch.setitem(sys.modules, package, None)
    status, out, err = foucault(*words, "--out", tmp_path / "out")
    assert (status, out) == (2, "")
    assert "rk4: not installed (numba): pip install 'foucault-reference[methods]'" in err
    assert list(tmp_path.iterdir()) == []


def test_every_method_and_approximation_is_listed_with_what_it_lacks(foucault):
    status, out, _ = foucault("methods")
    assert status == 0
    for name, method in METHODS.items():
        assert f"  {name} " in out and method.title in unwrapped(out)
    assert "linear_3d" in out


@pytest.mark.parametrize("words", [("score", "rows.csv"), ("study",), ("sweep", "--rows", "2")])
def test_a_dataset_in_place_of_a_scene_is_told_from_other_folders_and_its_scene_named(
    foucault, words
):
    command, *rest = words
    status, _, err = foucault(command, "paris.binary64", *rest)
    assert status == 2
    assert "It is a dataset. Name its scene: paris --set inputs=binary64" in err
