"""Files of more steps than are read first: what is said of a fixed step holds for all rows, or is not said."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mistakes import told
from places import MISTAKEN_C

from reference import Scene, load_scene, trajectory

Rows = np.ndarray  # t, x, y, z
COMPILER = shutil.which("cc")
# the pendulum of the museum, a Runge-Kutta method of order 4: of 30,000 steps the first 15,000 take 750 s
MUSEUM = "l=20 g=9.8107 lat=50 reading=2 x0=0.8 y0=0.6 tend=1500 out=10 h=0.05"
ALLOWED_M = 1e-6
LONG = pytest.mark.long
LATE = 1000  # s: when a fault begins


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if COMPILER is None:
        pytest.skip("no C compiler")
    target = tmp_path_factory.mktemp("programs") / "mistaken"
    subprocess.run([COMPILER, "-O2", "-o", str(target), str(MISTAKEN_C), "-lm"], check=True)
    return target


def museum(t_end_s: float) -> Scene:
    settings = [f"run.t_end={t_end_s}", "run.transits=false", "inputs=binary64"]
    return load_scene("museum", settings)


def printed(program: Path, options: str = "") -> Rows:
    """Return the rows of the program, shape (rows, 4)."""
    command = [str(program), *MUSEUM.split(), *options.split()]
    output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return np.loadtxt(output.splitlines(), delimiter=",", skiprows=1)


def explained(rows: Rows) -> Any:
    """Return the explanation of the x and y of some rows."""
    times, x, y, _ = rows.T.copy()
    return told(museum(times[-1]), times, {"x": x, "y": y}, ALLOWED_M).explanation


def error_m(rows: Rows) -> float:
    """Return the largest error of x and y in m."""
    truth = trajectory(museum(rows[-1, 0]), rows[:, 0])
    return float(np.linalg.norm(rows[:, 1:3] - truth[:, :2], axis=1).max())


def test_the_size_of_a_step_error_is_that_of_all_rows(program: Path) -> None:
    rows = printed(program)
    found = explained(rows)
    assert [cause.id for cause in found.known] == ["integrator_rk4"]
    assert found.known[0].size_m == pytest.approx(error_m(rows), rel=0.02)
    assert found.explains and found.corrected_m < ALLOWED_M / 10


@pytest.mark.parametrize(
    ("options", "cause_id"),
    [
        ("rate=7.3e-5 decimals=7", "rounded_rate"),
        pytest.param("g=9.81", "gravity_9.81", marks=LONG),
        pytest.param("g=9.8123", "site.gravity", marks=LONG),
    ],
)
def test_the_size_of_a_cause_beside_a_step_is_that_of_all_rows(
    program: Path, options: str, cause_id: str
) -> None:
    rows = printed(program, options)
    found = explained(rows)
    sizes_m = {cause.id: cause.size_m for cause in found.known}
    assert set(sizes_m) == {cause_id, "integrator_rk4"}
    assert sizes_m[cause_id] == pytest.approx(error_m(rows), rel=0.1)
    assert found.explains and found.corrected_m < ALLOWED_M / 10


@LONG
def test_a_number_beside_a_step_is_fitted_to_all_rows(program: Path) -> None:
    """160,000 steps of leapfrog move the phase by a radian: g has to be fitted with the steps, not beside them."""
    rows = printed(program, "g=9.8123 method=3 tend=8000")
    found = explained(rows)
    numbers = {cause.id: cause.value for cause in found.known}
    assert set(numbers) - {"off_the_sphere"} == {"site.gravity", "integrator_leapfrog"}
    assert numbers["site.gravity"] == pytest.approx(9.8123, rel=1e-13)
    assert found.corrected_m < ALLOWED_M / 1000


def stuck(rows: Rows) -> None:
    """Repeat one x from some time on."""
    late = rows[:, 0] >= LATE
    rows[late, 1] = rows[late, 1][0]


def moved(rows: Rows) -> None:
    """Move x by a few tolerances from some time on."""
    rows[rows[:, 0] >= LATE, 1] += 20 * ALLOWED_M


def dropped(rows: Rows) -> None:
    """Leave out one row, the times going on as if it were there."""
    late = np.flatnonzero(rows[:-1, 0] >= LATE)
    rows[late, 1:] = rows[late + 1, 1:]


@pytest.mark.parametrize("options", ["", "g=9.81"])
@pytest.mark.parametrize("fault", [stuck, moved, dropped])
def test_no_step_is_certain_if_later_rows_are_wrong(
    program: Path, options: str, fault: Callable[[Rows], None]
) -> None:
    rows = printed(program, options)
    fault(rows)
    found = explained(rows)
    assert not found.explains
    assert all(not cause.id.startswith("integrator_rk4") for cause in found.known)
    # what is corrected, if anything, does not remove the fault, and the text says so
    assert not found.corrected_m < 2 * ALLOWED_M
