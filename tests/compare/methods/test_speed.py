"""Generated code: what a step of it does, the same in C, and how generated code is kept."""

from __future__ import annotations

import math
import shutil
import subprocess
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from compare.methods import METHODS, rk4
from compare.methods.fixed_step import runge_kutta, traced_step
from compare.methods.method import available
from compare.methods.rhs.problem import Problem
from compare.methods.rhs.straight_line import compiled
from reference import load_scene

pytestmark = pytest.mark.skipif(
    available(METHODS["rk4"]) is not None, reason="numba is not installed"
)
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
def test_rk4_finds_the_same_as_the_same_program_in_c(tmp_path, tally):
    source, program = Path(__file__).with_name("rk4_plane.c"), tmp_path / "rk4"
    subprocess.run(["cc", "-O3", "-o", program, source, "-lm"], check=True)
    problem = Problem.of(
        load_scene("paris").with_values(["inputs=binary64"]), "plane", 60.0 * np.arange(ROWS + 1)
    )
    work = METHODS["rk4"].prepare(problem, STEP)
    begun = time.process_time()
    states = work().states
    ours = time.process_time() - begun
    printed = subprocess.run(
        [program, *arguments(problem)], check=True, capture_output=True, text=True
    ).stdout
    *lines, theirs = printed.split("\n")[:-1]
    theirs_xy = np.array([[float.fromhex(word) for word in line.split()] for line in lines])
    # metres against n, other roundings
    np.testing.assert_allclose(states[1:, :2], theirs_xy, atol=1e-11)
    tally(f"rk4: {ours / float(theirs):.2f} of the CPU time of the same program in C")


def test_a_step_of_momentum_has_fewer_operations_than_one_of_plane_and_none_that_is_slow():
    scene = load_scene("paris")

    def operations(formulation):
        step = traced_step(Problem.of(scene, formulation, [0.0, 7200.0]), runge_kutta(rk4.TABLEAU))
        return Counter(line.operation for line in step.lines)

    momentum, plane = operations("momentum"), operations("plane")
    # a neg joins its sum
    assert all(momentum[operation] <= plane[operation] for operation in ("mul", "add", "sub"))
    assert set(momentum) == {"mul", "add", "sub", "neg"}
    assert {"div", "sqrt"} < set(plane)


SOURCE = """
@nb.njit("float64(float64)", **OPTIONS)
def twice(x):
    return x + x
"""


def test_generated_code_is_kept_and_a_damaged_file_of_it_does_no_harm(tmp_path, monkeypatch):
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path))
    compiled.cache_clear()
    assert compiled(SOURCE).twice(2.0) == 4.0
    (cached,) = tmp_path.rglob("f*.py")
    cached.write_text("raise SystemExit")
    compiled.cache_clear()
    assert compiled(SOURCE).twice(3.0) == 6.0
    assert list(tmp_path.rglob("*.nbi"))


def test_where_nothing_can_be_kept_code_is_compiled_in_memory(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("a file where a folder should be")
    monkeypatch.setenv("FOUCAULT_CACHE", str(blocked))
    compiled.cache_clear()
    assert compiled(SOURCE).twice(2.0) == 4.0
    compiled.cache_clear()
