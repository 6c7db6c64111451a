"""Machine code of an engine that was kept before one of its files changed is not used any more."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

import pytest
from places import ROOT

pytest.importorskip("numba")

FOLDERS = """
from reference.engines.limbs.march import march as limbs
from reference.engines.octet.march import march as octet

print(limbs.stats.cache_path)
print(octet.stats.cache_path)
"""


# a file, and the engines whose code is made of it
CHANGES = {
    "simd/lanes.py": {"limbs", "octet"},
    "limbs/series.py": {"limbs"},
    "octet/series.py": {"octet"},
    "batch_interface.py": {"octet"},  # its constants
}


def test_a_change_of_a_file_makes_the_code_that_is_made_of_it_again(tmp_path):
    shutil.copytree(
        ROOT / "reference", tmp_path / "reference", ignore=shutil.ignore_patterns("__pycache__")
    )
    environment = os.environ | {
        "NUMBA_CACHE_DIR": str(tmp_path / "numba"),
        "PYTHONPATH": str(tmp_path),
    }

    def folders():
        command = [sys.executable, "-c", FOLDERS]
        run = subprocess.run(
            command, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, check=True
        )
        return dict(zip(("limbs", "octet"), run.stdout.split(), strict=True))

    before = folders()
    for file, engines in CHANGES.items():
        with open(tmp_path / "reference/engines" / file, "a") as source:
            source.write("# changed\n")
        after = folders()
        assert {name for name in before if before[name] != after[name]} == engines, file
        before = after
