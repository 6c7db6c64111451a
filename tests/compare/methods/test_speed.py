"""Generated code against C, and how generated code is kept."""

from __future__ import annotations

import math
import shutil
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from compare.methods import METHODS, Problem, available
from reference import load_scene

pytestmark = pytest.mark.skipif(available(METHODS["rk4"]) is not None, reason="numba is not installed")
ROWS, STEP = 120, 0.01  # two hours


def arguments(problem):
    k = problem.constants
    values = [
        k.length,
        k.gravity * k.length,
        math.radians(48.846111),
        k.rate,
        k.axis_distance * k.length,
        0.3,
        0.4,
        STEP,
    ]
    return [*(repr(float(value)) for value in values), str(ROWS), "6000"]


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_rk4_is_as_fast_as_the_same_program_in_c_and_finds_the_same(tmp_path):
    source, program = Path(__file__).with_name("rk4_plane.c"), tmp_path / "rk4"
    subprocess.run(["cc", "-O3", "-o", program, source, "-lm"], check=True)
    problem = Problem.of(load_scene("paris").with_values(["inputs=binary64"]), "plane", 60.0 * np.arange(ROWS + 1))
    work = METHODS["rk4"].prepare(problem, STEP)
    ratios = []
    for _ in range(3):
        begun = time.process_time()
        states = work().states
        ours = time.process_time() - begun
        printed = subprocess.run([program, *arguments(problem)], check=True, capture_output=True, text=True).stdout
        *lines, theirs = printed.split("\n")[:-1]
        ratios.append(ours / float(theirs))
    theirs_xy = np.array([[float.fromhex(word) for word in line.split()] for line in lines])
    np.testing.assert_allclose(states[1:, :2], theirs_xy, atol=1e-11)  # metres against n, other roundings
    assert min(ratios) < 1.5


def test_momentum_costs_a_step_half_of_what_plane_does():
    scene = load_scene("paris")

    def cost(formulation):
        work = METHODS["rk4"].prepare(Problem.of(scene, formulation, [0.0, 7200.0]), STEP)
        costs_s = []
        for _ in range(3):
            begun = time.process_time()
            work()
            costs_s.append(time.process_time() - begun)
        return min(costs_s)

    assert cost("momentum") < 0.7 * cost("plane")


SOURCE = """
@nb.njit("float64(float64)", **OPTIONS)
def twice(x):
    return x + x
"""


def test_generated_code_is_kept_whole_and_renewed_where_it_was_damaged(tmp_path, monkeypatch):
    from compare.rhs.compiled import compiled

    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path))
    compiled.cache_clear()
    assert compiled(SOURCE).twice(2.0) == 4.0
    (cached,) = tmp_path.rglob("f*.py")
    good = cached.read_text()
    cached.write_text("raise SystemExit")
    compiled.cache_clear()
    assert compiled(SOURCE).twice(3.0) == 6.0
    assert cached.read_text() == good
    assert list(tmp_path.rglob("*.nbi"))


def test_where_nothing_can_be_kept_code_is_compiled_in_memory(tmp_path, monkeypatch):
    from compare.rhs.compiled import compiled

    blocked = tmp_path / "file"
    blocked.write_text("a file where a folder should be")
    monkeypatch.setenv("FOUCAULT_CACHE", str(blocked))
    compiled.cache_clear()
    assert compiled(SOURCE).twice(2.0) == 4.0
    compiled.cache_clear()
