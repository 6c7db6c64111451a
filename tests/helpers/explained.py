"""Explanations of programs with drawn mistakes and of real ones, as JSON: by this process's processor and libraries.

Run as `python explained.py PROGRAM NAME …`, with the compiled `mistaken.c`; a name is a seed and a number ("17-3") or
a real program ("w21"). With a second seed behind it ("w21~1") every number is moved by an ulp, or by none.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mistakes import case, told
from places import ROOT
from wild_programs import TRUE, read_in, said

# kernels of OpenBLAS that other processors use: with them sums and factorisations round otherwise
OTHER_KERNEL = {"x86_64": "Prescott", "aarch64": "ARMV8"}.get(platform.machine(), "Prescott")
Found = dict[str, dict[str, Any]]


def explained(program: Path, word: str) -> dict[str, Any]:
    """Return what is said of the rows of a program, and which of these words are wrong."""
    name, _, noise = word.partition("~")
    if name in TRUE:
        scene, times, columns = read_in(name)
        x, y = (float(q) for q in scene.exact.position[:2])
        allowed_m = 1e-6 * float(np.hypot(x, y))
    else:
        seed, number = map(int, name.split("-"))
        made = case(number, seed)
        scene, allowed_m = made.scene, made.allowed_m
        times, columns = made.rows(program)
    if noise:
        rng = np.random.default_rng([int(noise), *name.encode()])
        columns = {axis: moved(values, rng) for axis, values in columns.items()}
    found = told(scene, times, columns, allowed_m)
    explanation = found.explanation
    causes = set(found.words)
    if explanation is not None:
        causes |= {part.id for part in explanation.causes}
        causes |= {"slip"} if explanation.slip else set()
        causes |= {explanation.model.id} if explanation.model else set()
    # a step error of no name says less than its name, and is true
    wrong = (
        said(explanation) - TRUE[name] - {"integrator_loose"}
        if name in TRUE
        else made.wrong(found.words)
    )
    return {"causes": sorted(causes), "wrong": sorted(wrong)}


def moved(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return numbers, each moved by one unit in the last place, or by none; a zero stays one."""
    ulps = rng.integers(-1, 2, values.shape) * (values != 0)
    return np.where(ulps, np.nextafter(values, np.copysign(np.inf, ulps)), values)


def start(program: Path, names: Sequence[str], kernel: str = "") -> subprocess.Popen[str]:
    """Start a process that explains programs, with a kernel of OpenBLAS, or with the one that it chooses."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    if kernel:
        environment["OPENBLAS_CORETYPE"] = kernel
    command = [sys.executable, __file__, str(program), *names]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)


def result(process: subprocess.Popen[str]) -> Found:
    """Return what such a process printed."""
    output, _ = process.communicate()
    assert process.returncode == 0
    found: Found = json.loads(output)
    return found


if __name__ == "__main__":
    document: Found = {word: explained(Path(sys.argv[1]), word) for word in sys.argv[2:]}
    print(json.dumps(document))
