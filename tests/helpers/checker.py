"""docs/checker/check.c compiled: a proof of a dataset that takes nothing from this package."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest
from places import ROOT

SOURCE = ROOT / "docs/checker/check.c"
LIBRARIES = (["-lflint-arb", "-lflint"], ["-lflint"])  # FLINT 2.9 and Arb; FLINT 3


@pytest.fixture(scope="session")
def check(tmp_path_factory):
    """Run the checker on a folder."""
    if shutil.which("cc") is None:
        pytest.skip("no C compiler")
    program = tmp_path_factory.mktemp("checker") / "check"
    for libraries in LIBRARIES:
        command = ["cc", "-O2", "-Wall", "-o", program, SOURCE, *libraries, "-lmpfr", "-lgmp", "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            assert not done.stderr
            return lambda folder: subprocess.run([program, folder], capture_output=True, text=True, check=False)
        if not re.search(r"\.h: No such file|cannot find -lflint", done.stderr):
            pytest.fail(done.stderr)
    return pytest.skip("no FLINT: apt install libflint-dev libflint-arb-dev")
