"""A problem as a program of C++: the traced equations and a library's part, compiled once, kept, and run.

Programs are kept by their text, the compiler and the processor; a scene's numbers are in the file that it reads.
"""

from __future__ import annotations

import hashlib
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from reference import IntegrationError
from reference.numbers.precision import Array
from reference.system.cache import entry, store, temporary
from reference.system.workspace import workspace

from ...candidates.external import run_program
from ...rhs.problem import Problem
from ...rhs.straight_line import Program
from .library import Library, compiler, library_folders

FLAGS = ("-std=c++17", "-O3", "-march=native", "-w")
HEAD = 4  # numbers before the states: CPU seconds, steps, calls of the right-hand side, rows


@dataclass(frozen=True)
class Answer:
    """The results of a program: states, counts and cost.

    Attributes:
        states: of the problem's variables at the times that were reached, shape (rows, variables).
        steps: number of steps.
        calls: of the right-hand side.
        cpu_s: CPU seconds of the integration alone, by the program's own clock.
        reason: why it stopped early, in the library's words.
    """

    states: Array
    steps: int
    calls: int
    cpu_s: float
    reason: str


def prepared(
    problem: Problem,
    tolerance: float,
    library: Library,
    parts: Sequence[str],
    defines: Sequence[str] = (),
    link: Sequence[str] = (),
) -> Callable[[], Answer]:
    """Compile a problem with a library's part; return what integrates it.

    Args:
        problem: at least two times of output.
        tolerance: relative.
        library: that the parts include.
        parts: files of this folder, the last of which defines `integrate`.
        defines: macros of the parts.
        link: its files to link with.

    Raises:
        IntegrationError: it cannot be compiled; the compiler's words.
    """
    program = _compiled(source(problem, parts), library, defines, link)
    start = [tolerance, float(len(problem.times)), *problem.sizes, *problem.start]
    numbers = np.concatenate([start, problem.parameters, problem.times])
    size = len(problem.start)

    def work() -> Answer:
        with tempfile.NamedTemporaryFile(prefix="foucault-") as file:
            numbers.tofile(file)
            file.flush()
            output, _, _ = run_program([str(program), file.name])
        with output:
            answer = output.read()
        head = np.frombuffer(answer, count=HEAD)
        count = int(head[3]) * size
        states = np.frombuffer(answer, count=count, offset=head.nbytes).reshape(-1, size).copy()
        reason = answer[head.nbytes + states.nbytes :].decode(errors="replace")
        return Answer(states, int(head[1]), int(head[2]), float(head[0]), reason)

    return work


def source(problem: Problem, parts: Sequence[str]) -> str:
    """Return the text of the program."""
    folder = Path(__file__).parent
    system = problem.system
    counts = len(system.variables), len(system.parameters)
    functions = [
        _function("rates", system.program, *counts, "    calls++;\n"),
        _function("slopes", system.jacobian, *counts),
    ]
    sizes = f"#define VARIABLES {len(system.variables)}\n#define PARAMETERS {len(problem.parameters)}\n"
    texts = [(folder / name).read_text(encoding="utf-8") for name in parts]
    return "\n".join([sizes + (folder / "host.hpp").read_text(encoding="utf-8"), *functions, *texts])


def _function(name: str, program: Program, variables: int, parameters: int, before: str = "") -> str:
    """Return straight-line code as a function of a state that fills an array."""
    lines = [f"x{i} = x[{i}]" for i in range(variables)] + [f"k{i} = k[{i}]" for i in range(parameters)]
    for line in program.lines:
        lines.append(f"{line.name} = {replace(line, operands=tuple(map(_number, line.operands))).expression}")
    body = before + "".join(f"    const double {line};\n" for line in lines)
    body += "".join(f"    to[{i}] = {_number(word)};\n" for i, word in enumerate(program.outputs))
    return f"static void {name}(const double *x, double *to) {{\n    using namespace std;\n{body}}}\n"


def _number(operand: str) -> str:
    """Return an operand in C++: a literal as a double, which a whole number would not be."""
    try:
        return repr(float(operand))
    except ValueError:
        return operand


def _compiled(text: str, library: Library, defines: Sequence[str], link: Sequence[str]) -> Path:
    """Return the program of a text, compiled now if it was not before."""
    call, include = compiler(), library.folder
    if call is None or include is None:
        raise IntegrationError(f"{library.missing}")
    words = [*call, *FLAGS, *(f"-D{word}" for word in defines), "-I", str(include), "-x", "c++", "-"]
    folders = (word for folder in library_folders() for word in (f"-L{folder}", f"-Wl,-rpath,{folder}"))
    ends = [*folders, *(f"-l{name}" for name in link)]
    explained = subprocess.run([*words, "-###", "-E"], input="", capture_output=True, text=True, check=False).stderr
    recipe = "\n".join([text, *words, *ends, explained, str(library.version)])  # explained: version and processor
    name = hashlib.sha256(recipe.encode()).hexdigest()[:32]

    def put(path: Path) -> None:
        with workspace(path.parent, path.name) as work:
            made = work / "program"
            command = [*words, "-o", str(made), *ends]
            ran = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
            if ran.returncode:
                first = next((line for line in ran.stderr.splitlines() if "error" in line), "no message")
                raise IntegrationError(f"a program for {library.name} does not compile here: {first}")
            made.replace(path)

    path = entry("native", name) or store("native", name, put)
    if path is None:
        path = temporary() / name
        if not path.exists():
            put(path)
    return path
