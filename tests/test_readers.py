"""docs/readers: each program is compiled and run where its tool is installed, and reads what `reference.load` reads."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from golden_functions import random_times
from limbs_states import states
from places import ROOT

import reference
from reference.numbers.columns import STATE

READERS = ROOT / "docs/readers"
PARIS = ROOT / "data/golden/paris"
# s, of the motions whose functions are evaluated; one has more than a hundred pieces by then
END = 30
# the tool that is wanted, what compiles the program (none for scripts), and what runs it
COMMANDS = {
    "golden.c": (["cc", "-O2", "{file}", "-o", "{program}"], ["{program}"]),
    "golden.f90": (["gfortran", "{file}", "-o", "{program}"], ["{program}"]),
    "golden.mjs": ([], ["node", "{file}"]),
    "golden.go": (["go", "build", "-o", "{program}", "{file}"], ["{program}"]),
    "golden.rs": (["rustc", "-O", "{file}", "-o", "{program}"], ["{program}"]),
    "Golden.java": ([], ["java", "-XX:TieredStopAtLevel=1", "{file}"]),
    "golden.m": ([], ["octave-cli", "--norc", "{file}"]),
    "golden.R": ([], ["Rscript", "--vanilla", "{file}"]),
}
WITH_JSON = {"golden.mjs", "golden.go", "golden.m"}
# what evaluates golden functions; R is given hexfloats, as it rounds decimals by itself not always right
EVALUATORS = {
    "function.c": (["cc", "-O2", "{file}", "-o", "{program}", "-lm"], ["{program}"]),
    "function.f90": (["gfortran", "-O2", "{file}", "-o", "{program}"], ["{program}"]),
    "function.mjs": ([], ["node", "{file}"]),
    "function.go": (["go", "build", "-o", "{program}", "{file}"], ["{program}"]),
    "function.rs": (["rustc", "-O", "{file}", "-o", "{program}"], ["{program}"]),
    "Function.java": ([], ["java", "-XX:TieredStopAtLevel=1", "{file}"]),
    "function_at.m": ([], ["octave-cli", "--norc", "{file}"]),
    "function.R": ([], ["Rscript", "--vanilla", "{file}"]),
}


@pytest.fixture(scope="module")
def paris():
    return reference.load(PARIS)


def test_every_program_is_run_and_stands_in_the_table():
    files = {path.name for path in READERS.iterdir()} - {"README.md"}
    assert files == {*COMMANDS, *EVALUATORS}
    table = re.findall(
        r"^\|[^|]+\| \[([\w.]+)\]\(\1\) \|", (READERS / "README.md").read_text(), re.M
    )
    assert set(table) == files


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    """Where programs are compiled, each once."""
    return tmp_path_factory.mktemp("programs")


def printed(
    name: str, folder: Path, programs: Path, *words: str, flags: tuple[str, ...] = ()
) -> list[list[str]]:
    """Return the words of each line that a program prints about a dataset, given more words."""
    program = programs / "-".join(("run", name.replace(".", "_"), *flags))
    places = {"file": str(READERS / name), "program": str(program)}
    both = (COMMANDS | EVALUATORS)[name]
    compiling, running = ([word.format(**places) for word in command] for command in both)
    if compiling and not program.exists():
        subprocess.run([*compiling, *flags], check=True, capture_output=True, cwd=programs)
    done = subprocess.run(
        [*running, str(folder), *words], check=True, capture_output=True, text=True, cwd=programs
    )
    return [line.split() for line in done.stdout.splitlines()]


def works(tool: str) -> bool:
    """Return whether a tool is there, and more than the name of one that a home has to choose, as with rustup."""
    return shutil.which(tool) is not None and (
        tool != "rustc"
        or not subprocess.run([tool, "--version"], capture_output=True, check=False).returncode
    )


# a fresh go compiles its own library first, for a quarter of a minute
LONG = {"golden.go", "function.go"}
NAMES = [pytest.param(name, marks=[pytest.mark.long] if name in LONG else []) for name in COMMANDS]


@pytest.mark.parametrize("name", NAMES)
def test_it_reads_paris(name, paris, programs):
    compiling, running = COMMANDS[name]
    tool = (compiling or running)[0]
    if not works(tool):
        pytest.skip(f"{tool} is not installed for this user")
    grid, state, transits, *vectors = _parted(printed(name, PARIS, programs))
    assert grid == ["grid", str(len(paris.times))]
    assert [words[0] for words in state] == ["t", "x", "y", "z", "vx", "vy", "vz"]
    assert [float(words[1]) for words in state] == [
        float(paris.exact(words[0])[-1]) for words in state
    ]
    assert [float(words[2]) for words in state[1:]] == [
        float(paris.grid.bound(words[0])[-1]) for words in state[1:]
    ]
    assert transits[:2] == ["transits", str(len(paris.directions))]
    assert float(transits[2]) == float(max(paris.transits.bound("t")))
    if name in WITH_JSON:
        document = json.loads((PARIS / "vectors.json").read_text())
        counts = [str(len(document[kind])) for kind in ("states", "transits")]
        assert vectors == [["vectors", *counts, document["states"][1]["values"]["x"]["hexfloat"]]]
    else:
        assert vectors == []


def _parted(lines):
    """Return the line on the grid, the seven on its last row, that on transits, and what follows."""
    return [lines[0], lines[1:8], lines[8], *lines[9:]]


def test_fortran_reads_as_many_digits_as_quadruple_precision_has(paris, programs):
    if shutil.which("gfortran") is None:
        pytest.skip("gfortran is not installed")
    for column, value, *_ in printed("golden.f90", PARIS, programs)[2:8]:
        exact = paris.exact(column)[-1]
        assert abs(Fraction(value) - exact) <= abs(exact) / 2**111


@pytest.fixture(scope="module", params=["paris", "hard"])
def with_function(request, tmp_path_factory):
    """A dataset whose z follows from the sphere, and one in which z has a series."""
    pytest.importorskip("flint")
    scene = reference.load_scene(
        request.param, [f"run.t_end={END}", f"run.grid_step={END // 2}", "run.digits=12"]
    )
    solution = reference.solve(
        scene, level="enclosed", transits=False, engine="limbs", function=True
    )
    return reference.write(solution, tmp_path_factory.mktemp("function") / scene.id)


FUSED = pytest.param("function.c", ("-O3", "-ffp-contract=fast", "-mfma"), id="function.c-fused")
EVALUATING = [
    *(
        pytest.param(name, (), marks=[pytest.mark.long] if name in LONG else [])
        for name in EVALUATORS
    ),
    FUSED,
]


@pytest.mark.parametrize(("name", "flags"), EVALUATING)
def test_it_evaluates_as_python_does(name, flags, with_function, programs, size):
    """The same doubles; with fused operations as near to a run in limbs as the bounds say."""
    tool = (EVALUATORS[name][0] or EVALUATORS[name][1])[0]
    if not works(tool):
        pytest.skip(f"{tool} is not installed for this user")
    if flags and " fma " not in Path("/proc/cpuinfo").read_text():
        pytest.skip("this processor does not fuse operations")
    golden = reference.load(with_function)
    times = random_times(golden.function, size(1_000, 10_000))
    words = [t.hex() if name.endswith(".R") else repr(t) for t in times.tolist()]
    found = np.array(printed(name, with_function, programs, *words, flags=flags), dtype=np.float64)
    at = golden.at(times)
    expected = np.column_stack([times, *(getattr(at, name) for name in STATE)])
    assert found.shape == expected.shape
    if not flags:
        assert np.array_equal(found, expected)
        return
    assert not np.array_equal(found, expected)
    high, low = states(golden.scene.exact, times)
    off = np.abs((found[:, 1:] - high) - low).max(axis=0)
    assert all(gap <= at.bound[name] for gap, name in zip(off, STATE, strict=True))


@pytest.mark.parametrize("name", ["function.c", "function.mjs", "function_at.m", "function.R"])
@pytest.mark.parametrize("t", ["-1", f"{END}.5", "nan"])
def test_a_time_outside_is_refused(name, t, with_function, programs):
    tool = (EVALUATORS[name][0] or EVALUATORS[name][1])[0]
    if not works(tool):
        pytest.skip(f"{tool} is not installed for this user")
    with pytest.raises(subprocess.CalledProcessError) as refused:
        printed(name, with_function, programs, t)
    assert f"not within 0 to {END} s" in refused.value.stderr
