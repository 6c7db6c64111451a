"""Without heyoka, as on macOS and Windows: what works, and what is refused with the command that installs it."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
from places import ROOT

INSTALL = "conda install -c conda-forge heyoka.py"
# in one process: how each command line ended
SCRIPT = """
import json, sys
from typer.testing import CliRunner
from foucault import commands
ended = {}
for line in json.loads(sys.argv[1]):
    result = CliRunner().invoke(commands(), line.split())
    error = "" if isinstance(result.exception, SystemExit | None) else str(result.exception)
    status = getattr(result.exception, "exit_status", result.exit_code)
    ended[line] = status, result.output + error
print(json.dumps(ended))
"""
WORKS = {
    "scenes": "paris",
    "show paris --set run.t_end=60": "no period",
    "verify separatrix": "separatrix: ok",
    "score paris right.csv": "agrees with paris",
    "score --how c": "printf",
    "methods": "heyoka_double",
}
REFUSED = [
    "show paris --equations",
    "show paris --sensitivity",
    "generate paris --t-end 60 --out out",
    "verify separatrix --recompute",
    "score paris right.csv --set release.x=0.2",
    "sweep paris --over latitude=0:90:45 --t-end 60",
    "sweep paris --over latitude=0:90:45 --t-end 60 --digits 20",
    "study paris --t-end 60 --methods heyoka_double",
    "paper",
]
WRONG = "score paris wrong.csv"


def in_python(script, *words, folder):
    """Return what a script prints in a Python without heyoka, FLINT and numba."""
    path = os.pathsep.join([str(ROOT / "tests/helpers/hidden"), str(ROOT)])
    environment = {**os.environ, "PYTHONPATH": path, "HIDDEN": "heyoka,flint,numba"}
    call = [sys.executable, "-c", script, *words]
    ended = subprocess.run(
        call, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    folder = tmp_path_factory.mktemp("here")
    (folder / "right.csv").write_text("t,x,y\n0,0.3,0.4\n60,-0.176326733,-0.415867688\n")
    (folder / "wrong.csv").write_text("t,x,y\n0,0.3,0.4\n60,-0.1763,-0.4159\n")
    lines = json.dumps([*WORKS, *REFUSED, WRONG])
    return json.loads(in_python(SCRIPT, lines, folder=folder))


@pytest.mark.parametrize("line", WORKS)
def test_what_solves_nothing_works(ended, line):
    status, output = ended[line]
    assert status == 0, output
    assert WORKS[line] in output


@pytest.mark.parametrize("line", REFUSED)
def test_what_solves_is_refused_with_the_command_that_installs_heyoka(ended, line):
    status, output = ended[line]
    assert status == 2, output
    assert INSTALL in output


def test_a_wrong_file_is_judged_and_the_reasons_are_left_out(ended):
    status, output = ended[WRONG]
    assert status == 1 and "disagrees with paris" in output
    assert "no reasons are looked for" in output and INSTALL in output


def test_golden_data_and_functions_are_read_in_python(tmp_path):
    script = """
import reference
golden = reference.load("paris.binary64")
print(golden.x[0], float(golden.at(30.5).x))
"""
    first, between = map(float, in_python(script, folder=tmp_path).split())
    assert first == 0.3 and 0 < abs(between) < 0.71
