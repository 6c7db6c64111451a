"""docs/checker/check.c compiled: a proof of a dataset that takes nothing from this package."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from places import ROOT

SOURCE = ROOT / "docs/checker/check.c"
LIBRARIES = (["-lflint-arb", "-lflint"], ["-lflint"])  # FLINT 2.9 and Arb; FLINT 3
SANITIZERS = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
MOST_S = 300  # a run on a short dataset takes less than a second; this one hangs
ENVIRONMENT = {"ASAN_OPTIONS": "detect_leaks=0"}  # it ends without giving its memory back

Check = Callable[[Path], "subprocess.CompletedProcess[str]"]


def compiled(folder: Path, *options: str) -> Check:
    """Compile the checker into a folder; return what runs it on a dataset. Skip the test where that is impossible."""
    if shutil.which("cc") is None:
        pytest.skip("no C compiler")
    program = folder / "check"

    def check(dataset: Path) -> subprocess.CompletedProcess[str]:
        environment = os.environ | ENVIRONMENT
        command = [program, dataset]
        return subprocess.run(
            command,
            capture_output=True,
            text=True,
            errors="replace",
            env=environment,
            check=False,
            timeout=MOST_S,
        )

    for libraries in LIBRARIES:
        command = ["cc", "-O2", "-Wall", "-Wextra", *options, "-o", program, SOURCE]
        command += [*libraries, "-lmpfr", "-lgmp", "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            assert not done.stderr
            return check
        if re.search(r"cannot find .*(asan|ubsan)", done.stderr):
            pytest.skip("no AddressSanitizer")
        if not re.search(r"\.h: No such file|cannot find -lflint", done.stderr):
            pytest.fail(done.stderr)
    return pytest.skip("no FLINT: apt install libflint-dev libflint-arb-dev")


@pytest.fixture(scope="session")
def check(tmp_path_factory: pytest.TempPathFactory) -> Check:
    """Run the checker on a folder."""
    return compiled(tmp_path_factory.mktemp("checker"))


@pytest.fixture(scope="session")
def sanitized_check(tmp_path_factory: pytest.TempPathFactory) -> Check:
    """Run the checker on a folder, with AddressSanitizer and UBSan: a memory error ends it with another exit status."""
    return compiled(tmp_path_factory.mktemp("sanitized_checker"), *SANITIZERS)
