"""An explanation says the same on every processor: neither kernels of BLAS nor an ulp of a number decide a word."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from explained import OTHER_KERNEL, result, start
from places import MISTAKEN_C
from wild_programs import TRUE

# each of them once had other causes, or other digits, under another kernel
ONCE_DIFFERENT = ("770101-0", "770101-20", "770101-74", "770202-59")
MORE = ("770202-9", "770202-52", *(f"930303-{number}" for number in range(60)), *sorted(TRUE))
COMPILER = shutil.which("cc")


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_neither_a_kernel_of_blas_nor_an_ulp_changes_what_is_said(
    tmp_path: Path, size: Callable[[Sequence[str], Sequence[str]], Sequence[str]]
) -> None:
    names = size(ONCE_DIFFERENT, (*ONCE_DIFFERENT, *MORE))
    program = tmp_path / "mistaken"
    subprocess.run([str(COMPILER), "-O2", "-o", str(program), str(MISTAKEN_C), "-lm"], check=True)
    with_noise = [f"{name}~1" for name in names]
    processes = [start(program, [*names, *with_noise]), start(program, names, kernel=OTHER_KERNEL)]
    here, elsewhere = map(result, processes)
    causes = {name: here[name]["causes"] for name in names}
    assert {name: elsewhere[name]["causes"] for name in names} == causes
    assert {name: here[f"{name}~1"]["causes"] for name in names} == causes
    assert {
        name: found["wrong"] for name, found in (here | elsewhere).items() if found["wrong"]
    } == {}
