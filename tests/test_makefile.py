"""The Makefile on a newcomer's machine: what it refuses before it installs anything."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from places import ROOT

pytestmark = pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")

PYTHON = Path(sys.base_prefix) / "bin" / "python3"  # that of .venv may not start in these locales
READS_UTF8 = sys.version_info >= (3, 13)  # the paths in .venv, whatever the locale


def made(folder: Path, target: str, locale: str) -> subprocess.CompletedProcess[str]:
    """Make a target in a folder that has the Makefile and empty locks, in a locale."""
    folder.mkdir()
    shutil.copy(ROOT / "Makefile", folder)
    for name in (
        "requirements.lock",
        "requirements-test.lock",
        "requirements-peers.lock",
        "pyproject.toml",
    ):
        (folder / name).touch()
    # the tests may themselves be run by make, which tells others of its kind so
    environment = {
        name: value for name, value in os.environ.items() if "MAKE" not in name and name != "MFLAGS"
    }
    environment["LC_ALL"] = locale
    command = ["make", target, f"PYTHON={PYTHON}"]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.skipif(READS_UTF8, reason="this Python reads paths in UTF-8")
@pytest.mark.parametrize("target", ["golden", "test", "quick", "peers"])
@pytest.mark.parametrize("locale", ["C", "xx_XX.UTF-8"])  # the second is installed nowhere
def test_a_locale_that_lacks_a_letter_of_the_path_is_refused_before_anything_is_installed(
    tmp_path, target, locale
):
    folder = tmp_path / "Pendel Übung"
    done = made(folder, target, locale)
    assert done.returncode == 2
    assert "Run: export LC_ALL=C.UTF-8" in done.stderr
    assert not [*folder.glob(".venv*")]


@pytest.mark.parametrize(
    ("name", "locale"), [("Pendel Übung", "C.UTF-8"), ("plain", "C"), ("plain", "xx_XX.UTF-8")]
)
def test_a_locale_that_has_every_letter_of_the_path_is_taken(tmp_path, name, locale):
    done = made(tmp_path / name, "locale", locale)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
