"""numba checks no index by itself: the sums of digits are made once with bounds checking, on any digits."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from places import ROOT


@pytest.mark.long
def test_no_index_of_the_sums_of_digits_is_out_of_range(tmp_path):
    pytest.importorskip("numba")
    environment = {**os.environ, "NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": str(tmp_path)}
    words = [
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "tests/reference/enclosure/test_digits.py",
    ]
    command = [sys.executable, *words]
    done = subprocess.run(
        command, env=environment, cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-3000:]
