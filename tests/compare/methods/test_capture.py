"""What libraries print is captured, and the descriptors come back."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np

import reference
from compare import assert_agrees, study
from compare.methods import METHODS
from compare.methods.method import available
from compare.methods.rhs.problem import Problem
from reference.scenes.fields import LEVELS


def test_in_a_users_process_no_descriptor_is_redirected(monkeypatch, size):
    redirected, golden = [], reference.load("paris")
    monkeypatch.setattr(os, "dup2", lambda *descriptors: redirected.append(descriptors))
    for level in size(LEVELS[-1:], LEVELS):
        reference.solve("paris", t_end="5", digits=10, level=level)
    minute = reference.load_scene("paris", ["run.t_end=60"])
    for how in size([{}], [{}, {"level": "confirmed", "workers": 1}]):
        reference.sweep(minute, ["site.latitude=0,45"], **how)
    assert_agrees("paris", golden.t[:9], np.column_stack([golden.x, golden.y])[:9])
    assert study("paris", items=[("rk4", "plane", 0.1)], t_end=60).rows
    problem = Problem.of(reference.load_scene("paris"), "momentum", [0.0, 1.0, 2.0])
    tried = [name for name in ("cvode_adams", "numbalsoda_lsoda") if not available(METHODS[name])]
    for name in tried:
        METHODS[name].prepare(problem, 1e-8)()
    assert tried
    assert redirected == []


IN_A_PROCESS_OF_ITS_OWN = """
import os
from compare.methods import library

library.isolated = True
with library.captured() as output:
    os.write(1, b"a step\\n")
    os.write(2, b"failed\\n")
print(library.quoted(output), "was captured", flush=True)
os.write(1, b"after\\n")
"""


def test_what_is_written_is_captured_and_quoted_on_one_line():
    done = subprocess.run(
        [sys.executable, "-c", IN_A_PROCESS_OF_ITS_OWN], check=True, capture_output=True, text=True
    )
    assert (done.stdout, done.stderr) == ("a step failed was captured\nafter\n", "")
