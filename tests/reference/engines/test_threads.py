"""Runs in several threads of one process: the same numbers, and what the process prints is not lost."""

from __future__ import annotations

import subprocess
import sys

from places import ROOT

PROGRAM = """
import os, threading, reference
from reference.scenes.scene import load_scene

def scene(*values):
    return load_scene("paris", ["run.digits=18", *values])

computed = scene("run.t_end=120", "run.level=computed")
expected = reference.solve(computed).grid.values
reference.solve(scene("run.t_end=60", "run.level=enclosed"))
same, done = [], threading.Event()

def talk():
    while not done.wait(1e-3):
        print("meanwhile", flush=True)
        os.write(2, b"also\\n")

def run():
    same.append(reference.solve(computed).grid.values == expected)

talking = threading.Thread(target=talk)
talking.start()
threads = [threading.Thread(target=run) for _ in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
done.set()
talking.join()
print("the end", same, flush=True)
"""


def test_threads_lose_nothing_that_is_printed():
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True, cwd=ROOT)
    *lines, last = done.stdout.splitlines()
    assert last == "the end [True, True, True, True]"
    assert set(lines) == {"meanwhile"}
    assert set(done.stderr.splitlines()) == {"also"}
