"""Runs in several threads of one process: the same numbers, and what the process prints is not lost."""

from __future__ import annotations

import os
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
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True, cwd=ROOT
    )
    *lines, last = done.stdout.splitlines()
    assert last == "the end [True, True, True, True]"
    assert set(lines) == {"meanwhile"}
    assert set(done.stderr.splitlines()) == {"also"}


MANY_WAYS = """
import asyncio, multiprocessing, os, signal, sys, threading
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
import reference

def solved(digits):
    solution = reference.solve("paris", t_end="60", digits=digits, level="computed")
    return solution.grid.values, solution.transits.values

def main(workers, *several):
    asked = several or (10, 24)
    expected = [solved(digits) for digits in asked]
    assert len(expected[0][1]) == 7
    with ThreadPoolExecutor(workers) as threads:
        for result in [threads.submit(lambda: [solved(digits) for digits in asked]) for _ in range(workers)]:
            assert result.result() == expected
    for method in ("fork", "spawn"):
        with ProcessPoolExecutor(1 + bool(several), multiprocessing.get_context(method)) as pool:
            assert list(pool.map(solved, asked)) == expected
    child = os.fork()
    if not child:
        os._exit(solved(asked[-1]) != expected[-1])
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0

    async def at_once():
        return await asyncio.gather(*(asyncio.to_thread(solved, digits) for digits in asked))

    assert asyncio.run(at_once()) == expected
    names = {"reference": reference}
    exec("scene = reference.load_scene('paris')", names)
    threading.Timer(0.5, signal.raise_signal, [signal.SIGINT]).start()
    try:
        exec("while True: reference.solve(scene, t_end='60', digits=24, level='computed')", names)
    except KeyboardInterrupt:
        print("interrupted")
    exec("done = reference.solve(scene, t_end='60', digits=24, level='computed').grid.values", names)
    assert names["done"] == solved(24)[0]
    print("the end")

if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
"""


def test_threads_pools_forks_tasks_and_interrupted_cells_give_the_same_numbers(tmp_path, size):
    program = tmp_path / "many_ways.py"
    program.write_text(MANY_WAYS)
    environment = os.environ | {
        "PYTHONPATH": str(ROOT),
        "PYTHONWARNINGS": "error,ignore::DeprecationWarning",
    }
    words = [sys.executable, program, *size(["2"], ["8", *["10", "17", "24"] * 17])]
    done = subprocess.run(words, capture_output=True, text=True, check=False, env=environment)
    assert (done.returncode, done.stdout.split("\n"), done.stderr) == (
        0,
        ["interrupted", "the end", ""],
        "",
    )


CLOCK = """
import itertools, random, sys, time
jumps = random.Random(31)
time.time = lambda: jumps.uniform(0, 4e9)  # years back and forth from call to call
time.time_ns = lambda: int(time.time() * 1e9)
import numpy as np, reference
from reference.system import cache
assert len(reference.solve("paris", t_end="60", digits=10, level="enclosed").transits) == 7
solution = reference.solve("paris", t_end="60", digits=10, level="confirmed")
for folder in ("one", "one"):
    reference.write(solution, folder)
    swept = reference.sweep("paris", ["site.latitude=0:80:80", "run.t_end=60"], out="sweep")
    assert swept.counts == {"ok": 2}
assert len(reference.load("one").transits["t"]) == 7
for name in map(str, range(cache.KEEP + 5)):
    assert cache.arrays("clock", name, lambda: {"x": np.ones(1)})["x"] == 1
print("the end")
"""


def test_a_clock_that_jumps_breaks_nothing(tmp_path):
    environment = os.environ | {"PYTHONPATH": str(ROOT), "FOUCAULT_CACHE": str(tmp_path / "cache")}
    words = [sys.executable, "-c", CLOCK]
    done = subprocess.run(
        words, capture_output=True, text=True, check=False, cwd=tmp_path, env=environment
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "the end\n", "")
