"""CONTRIBUTING's recipes name what is there; that for a column of grid.csv, followed to the letter in a copy."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from places import ROOT

from reference.dataset.files import read_manifest

BALL = '''

_state = output


def output(covered: Covered, time: Fraction) -> State:
    """Return position, velocity and ax at an output time."""
    piece = covered.piece
    with ctx.workprec(piece.balls.prec):
        s = ball((time - piece.step.centre) / piece.step.h)
        ax = piece.v[0].derivative()(s) / piece.unit + arb(0, covered.tube.a)
        return (*_state(covered, time), interval(ax * piece.balls.length / piece.constants.h**2))
'''
# what is done to each file that the recipe names
EDITS = {
    "reference/numbers/columns.py": lambda text: re.sub(
        "^GRID = STATE", 'GRID = (*STATE, "ax")', text, flags=re.M
    ),
    "reference/enclosure/trusted/tube.py": lambda text: text + BALL,
    "reference/enclosure/trusted/printed.py": lambda text: re.sub(
        '^GRID = "t,x.*?vz', r"\g<0>,ax", text, flags=re.M
    ),
    "tests/reference/dataset/test_write_and_read.py": lambda text: text.replace(
        '"t,x,y,z,vx,vy,vz"', "its header"
    ),
}
HEADER = "t,x,y,z,vx,vy,vz,ax"
IN_TURN = """
import json, sys
from foucault import main
for words in json.loads(sys.argv[1]):
    sys.argv[1:] = words
    try:
        main()
    except SystemExit as end:
        if end.code:
            raise
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the project whose grid.csv has the column ax, too."""
    root = tmp_path_factory.mktemp("project")
    shutil.copy(ROOT / "foucault.py", root)
    for name in ("reference", "compare", "tests/reference/dataset", "data/scenes"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "data/flags.toml", root / "data")
    for name, edit in EDITS.items():
        before = (root / name).read_text(encoding="utf-8")
        assert edit(before) != before, name
        (root / name).write_text(edit(before), encoding="utf-8")
    return root


def recipes() -> dict[str, str]:
    """Return the rows of CONTRIBUTING's table by what is added."""
    table = (
        (ROOT / "CONTRIBUTING.md").read_text("utf-8").partition("| what |")[2].partition("\n\n")[0]
    )
    return dict(re.findall(r"^\| ([^|]+) \|(.+)$", table, re.M))


def test_every_file_that_a_recipe_names_is_there():
    paths = r"((?:reference|compare|tests|data|docs)/[\w/.]+)(?=[` ])"
    names = {name for row in recipes().values() for name in re.findall(paths, row)}
    assert len(names) > 30
    assert [name for name in sorted(names) if not (ROOT / name).exists()] == []


def test_the_recipe_for_a_scene_makes_functions_of_doubles_as_they_ship():
    (words,) = re.findall(
        r"`foucault generate <id> (--set inputs=binary64 .+?)`", recipes()["a scene"]
    )
    manifest = read_manifest(ROOT / "data/golden/pole.binary64")
    assert manifest.alone
    assert {*words.split()} <= {*manifest.command.split()}


def test_the_recipe_names_the_files_that_have_to_be_touched_and_no_others():
    named = re.findall(r"`((?:reference|tests)/[\w/]+\.py)`", recipes()["a column of `grid.csv`"])
    assert {*named} == {*EDITS}


def test_a_column_is_made_and_verified_at_levels_of_runs_and_of_proof(copy, tmp_path, size):
    levels, env = ("self_consistent", "enclosed"), {**os.environ, "PYTHONPATH": str(copy)}
    # heyoka alone: limbs would be compiled for the copy
    env |= size({"NUMBA_DISABLE_JIT": "1"}, {})
    lines = []
    for level in levels:
        out = str(tmp_path / level)
        lines += [
            [
                "generate",
                "paris",
                "--t-end",
                "120",
                "--digits",
                "20",
                "--level",
                level,
                "--out",
                out,
            ]
        ]
        lines += [["verify", out]]
    lines += [
        [
            "generate",
            "paris",
            "--t-end",
            "5",
            "--uncertain",
            "length=±0.001",
            "--out",
            str(tmp_path / "ranges"),
        ]
    ]
    run = [sys.executable, "-c", IN_TURN, json.dumps(lines)]
    done = subprocess.run(run, check=False, cwd=copy, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    sheets = [(tmp_path / level / "grid.csv").read_text("utf-8").splitlines() for level in levels]
    runs, proof = ([line.split(",") for line in sheet] for sheet in sheets)
    assert ",".join(runs[0]) == ",".join(proof[0]) == HEADER
    # two ways to compute ax, the same digits
    assert [row[-1] for row in runs] == [row[-1] for row in proof]
