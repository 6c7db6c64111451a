"""Kernels are called by address from compiled functions, and compiled by two processes on the first use."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from fractions import Fraction

import pytest
from places import ROOT
from small_scenes import make_scene, run_in_limbs

from reference.system.process import usable_cores

pytest.importorskip("numba")

FUNCTIONS = """
from typing import NamedTuple

from reference.engines.limbs.compiling import entry
from reference.engines.limbs.kernel import Kernel
from reference.engines.limbs.limb import Array
from reference.engines.limbs.series import Counts

class Inner(NamedTuple):
    values: Array
    scale: float

class Outer(NamedTuple):
    counts: Counts
    inner: Inner
    negative: bool

@Kernel
def total(a: Outer, start: int) -> float:
    total = 0.0
    for i in range(start, len(a.inner.values)):
        total += a.counts[i] * a.inner.values[i] * a.inner.scale
    return -total if a.negative else total

_total = total.call

@entry("", 0)
def twice(address, a, start):
    return 2 * _total(address, a, start)

@Kernel
def divided(a: int, b: int) -> int:
    if b == 0:
        raise ZeroDivisionError("by nothing")
    return a // b

_divided = divided.call

@entry("", 0)
def halved(address, a, b):
    return _divided(address, a, b) // 2

@Kernel
def wrong(start: int) -> float:
    return start
"""

COLD = """
import json, os, sys
cores, sys.path[:0] = sys.argv[1], sys.argv[2:]
if cores == "one":
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
from fractions import Fraction
from numba.core import event
from small_scenes import make_scene, run_in_limbs
from reference.engines.limbs.march import march, taylor_coefficients, write_outputs
from reference.system.machine_code import missing

with event.install_recorder("numba:compile") as recorder:
    found = run_in_limbs(make_scene(release={"x": "0.3", "y": "0.4"}), 120, (0, Fraction(60)))
names = {one.data["dispatcher"].__name__ for _, one in recorder.buffer if one.is_start}
kept = [not missing(kernel.python, kernel._signature.args) for kernel in (march, taylor_coefficients, write_outputs)]
print(json.dumps([sorted(names), kept, str(found.transits.values)]))
"""


@pytest.fixture
def functions(tmp_path):
    path = tmp_path / "functions.py"
    path.write_text(FUNCTIONS)
    spec = importlib.util.spec_from_file_location("functions", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["functions"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["functions"]


def test_a_kernel_gets_its_arguments_and_gives_its_result_by_address(functions):
    import numpy as np

    inner = functions.Inner(np.array([1.5, 2.5, 4.0]), 0.25)
    for negative, sign in ((False, 1), (True, -1)):
        a = functions.Outer(np.array([3, 5, 7]), inner, negative)
        assert functions.total.python(a, 1) == sign * (5 * 2.5 + 7 * 4.0) / 4
        assert functions.twice(functions.total.address(), a, 1) == 2 * functions.total.python(a, 1)
        assert len(functions.total.python.signatures) == 1  # the types of its annotations are those of its arguments


def test_an_exception_passes_through_a_call_by_address(functions):
    assert functions.halved(functions.divided.address(), 12, 3) == 2
    with pytest.raises(ZeroDivisionError, match="by nothing"):
        functions.halved(functions.divided.address(), 12, 0)


def test_a_kernel_that_returns_another_type_than_it_says_is_refused(functions):
    with pytest.raises(TypeError, match=r"wrong is \(int64,\) -> int64, not \(int64,\) -> float64"):
        functions.wrong.address()


@pytest.mark.parametrize("cores", ["all", pytest.param("one", marks=pytest.mark.long)])
def test_on_the_first_use_two_processes_compile_where_there_are_two_cores(cores, tmp_path):
    if cores == "all" and usable_cores() < 2:
        pytest.skip("one core")
    paths = [str(ROOT), str(ROOT / "tests" / "helpers")]
    program = [sys.executable, "-c", COLD, cores, *paths]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    said = subprocess.run(program, env=environment, capture_output=True, text=True, check=True).stdout
    names, kept, transits = json.loads(said)
    assert {"march", "taylor_coefficients", "add_products"} <= set(names)
    assert {"write_outputs", "bracket_zeros"}.isdisjoint(names) == (cores == "all")
    assert kept == [True] * 3
    assert not [*tmp_path.rglob("*.lock")]
    found = run_in_limbs(make_scene(release={"x": "0.3", "y": "0.4"}), 120, (0, Fraction(60)))
    assert transits == str(found.transits.values)
