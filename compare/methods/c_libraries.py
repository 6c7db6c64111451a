"""Boost odeint, GSL, CVODE and ARKODE as their users call them: from a program in C++, without Python.

They are compared with the same codes behind a wrapper. The program consists of the traced equations
and the library's part. It is compiled once for the scene's equations, and cached by its text, the
compiler and the processor; it reads a scene's numbers from a file. It integrates, measures the CPU
seconds of that by its own clock, and writes its states. A tolerance t means rtol = t and atol = t
times each variable's swing; odeint takes one number for all, t times the smallest of them.
"""

from __future__ import annotations

import hashlib
import subprocess
import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from reference import InputError, IntegrationError
from reference.system.cache import kept
from reference.system.workspace import workspace

from ..candidates.external import failure_of, run_program
from .library import BOOST, GSL, SUNDIALS, Library, compiler, library_folders
from .method import (
    HIGH_ORDER,
    SPACE_FIRST,
    Family,
    Method,
    RunOutcome,
    Work,
    adaptive,
    failed,
    outcome,
)
from .rhs.problem import Problem
from .rhs.straight_line import StraightLine

FLAGS = ("-std=c++17", "-O3", "-march=native", "-w")
HEAD = 4  # numbers before the states: CPU seconds, steps, calls of the right-hand side, rows
DENSE = ("sundials_nvecserial", "sundials_sunmatrixdense", "sundials_sunlinsoldense")


def prepare(
    problem: Problem,
    setting: float,
    library: Library,
    parts: Sequence[str],
    defines: Sequence[str] = (),
    link: Sequence[str] = (),
) -> Work:
    """Compile the program; the returned function runs it.

    Args:
        problem: to be solved.
        setting: relative tolerance.
        library: that the parts include.
        parts: files of the folder `native`, the last of which defines `integrate`.
        defines: macros of the parts.
        link: the library's files to link with.

    Raises:
        IntegrationError: it cannot be compiled; the compiler's words.
    """
    if library is SUNDIALS and not f"{library.version}".startswith("6."):  # since 7
        link = (*link, "sundials_core")
    program = _compiled(source(problem, parts), library, defines, link)
    start = [setting, float(len(problem.times)), *problem.sizes, *problem.start]
    numbers = np.concatenate([start, problem.parameters, problem.times])

    def work() -> RunOutcome:
        with tempfile.NamedTemporaryFile(prefix="foucault-") as file:
            numbers.tofile(file)
            file.flush()
            try:
                output, _, _ = run_program([str(program), file.name], limit="")
            except InputError as error:  # it crashed, or was ended
                return failed(problem, failure_of(error))
        with output:
            answer = output.read()
        cpu_s, steps, calls, rows = np.frombuffer(answer, count=HEAD).tolist()
        size, offset = len(problem.start), HEAD * numbers.itemsize
        states = (
            np.frombuffer(answer, count=int(rows) * size, offset=offset).reshape(-1, size).copy()
        )
        reason = answer[offset + states.nbytes :].decode(errors="replace")
        return outcome(
            problem,
            states,
            steps=int(steps),
            rhs_evaluations=int(calls),
            reason=reason,
            cpu_s=cpu_s,
        )

    return work


def source(problem: Problem, parts: Sequence[str]) -> str:
    """Return the text of the program."""
    folder = Path(__file__).parent / "native"
    system = problem.system
    functions = [
        _function("rates", system.program, "    calls++;\n"),
        _function("slopes", system.jacobian),
    ]
    sizes = (
        f"#define VARIABLES {len(system.variables)}\n#define PARAMETERS {len(problem.parameters)}\n"
    )
    texts = [(folder / name).read_text(encoding="utf-8") for name in parts]
    return "\n".join(
        [sizes + (folder / "host.hpp").read_text(encoding="utf-8"), *functions, *texts]
    )


def _function(name: str, program: StraightLine, before: str = "") -> str:
    """Return straight-line code of x0, x1, … and k0, k1, … as a function of a state that fills an array."""
    lines = [f"{symbol} = {symbol[0]}[{symbol[1:]}]" for symbol in program.inputs]
    lines += [f"{line.name} = {line.expression}" for line in program.lines]
    body = before + "".join(f"    const double {line};\n" for line in lines)
    body += "".join(f"    to[{i}] = {word};\n" for i, word in enumerate(program.outputs))
    return (
        f"static void {name}(const double *x, double *to) {{\n    using namespace std;\n{body}}}\n"
    )


def _compiled(text: str, library: Library, defines: Sequence[str], link: Sequence[str]) -> Path:
    """Return the program of a text, compiled now if it was not before."""
    call, include = compiler(), library.folder
    if call is None or include is None:
        raise IntegrationError(f"{library.missing}")
    words = [
        *call,
        *FLAGS,
        *(f"-D{word}" for word in defines),
        "-I",
        str(include),
        "-x",
        "c++",
        "-",
    ]
    folders = (
        word for folder in library_folders() for word in (f"-L{folder}", f"-Wl,-rpath,{folder}")
    )
    ends = [*folders, *(f"-l{name}" for name in link)]
    explained = subprocess.run(
        [*words, "-###", "-E"], input="", capture_output=True, text=True, check=False
    ).stderr
    # explained: version and processor
    recipe = "\n".join([text, *words, *ends, explained, str(library.version)])
    name = hashlib.sha256(recipe.encode()).hexdigest()[:32]

    def put(path: Path) -> None:
        with workspace(path.parent, path.name) as work:
            made = work / "program"
            command = [*words, "-o", str(made), *ends]
            ran = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
            if ran.returncode:
                first = next(
                    (line for line in ran.stderr.splitlines() if "error" in line), "no message"
                )
                raise IntegrationError(
                    f"this machine cannot compile a program that uses {library.name}: {first}"
                )
            made.replace(path)

    return kept("native", name, put)


def _native(
    library: Library,
    parts: Sequence[str],
    *,
    defines: Sequence[str] = (),
    link: Sequence[str] = (),
    **fields: Any,
) -> Method:
    """Declare a method; arguments as in `prepare`, then further fields of `Method`."""
    work = partial(prepare, library=library, parts=parts, defines=defines, link=link)
    return adaptive(native=library, prepare=work, family=Family.COMPILED, **fields)


_odeint = partial(
    _native, BOOST, ("odeint.cpp",),
    ladder=HIGH_ORDER, extra="methods-native", licence="BSL-1.0", formulations=SPACE_FIRST,
)  # fmt: skip
_sundials = partial(
    _native, SUNDIALS,
    licence="BSD-3-Clause", source="A. C. Hindmarsh et al., ACM Trans. Math. Softw. 31 (2005) 363",
)  # fmt: skip
_cvode = partial(
    _sundials,
    ("sundials.hpp", "cvode.cpp"),
    link=("sundials_cvode", *DENSE),
    ladder=(1e-8, 1e-10, 1e-12, 1e-14),
)

METHODS = (
    _odeint(
        id="odeint_rkf78",
        title="Fehlberg 8(7), Boost odeint in C++",
        source="E. Fehlberg, NASA TR R-287 (1968); K. Ahnert and M. Mulansky, AIP Conf. Proc. 1389 (2011) 1586",
        order=8,
    ),
    _odeint(
        id="odeint_bulirsch_stoer",
        title="Bulirsch-Stoer extrapolation, Boost odeint in C++",
        source="R. Bulirsch and J. Stoer, Numer. Math. 8 (1966) 1; K. Ahnert and M. Mulansky (2011)",
        defines=("BULIRSCH_STOER",),
    ),
    _native(
        GSL,
        ("gsl.cpp",),
        link=("gsl", "gslcblas"),
        id="gsl_rk8pd",
        title="Prince-Dormand 8(9), GSL in C",
        ladder=HIGH_ORDER,
        source="P. J. Prince and J. R. Dormand, J. Comput. Appl. Math. 7 (1981) 67; GSL odeiv2",
        licence="GPL-3.0-or-later",
        formulations=SPACE_FIRST,
        order=8,
    ),
    _cvode(
        id="cvode_c_adams",
        title="Adams, orders 1 to 12, CVODE in C",
        defines=("MULTISTEP=CV_ADAMS",),
    ),
    _cvode(
        id="cvode_c_bdf",
        title="backward differentiation, orders 1 to 5, CVODE in C",
        defines=("MULTISTEP=CV_BDF",),
    ),
    _sundials(
        ("sundials.hpp", "arkode.cpp"),
        link=("sundials_arkode", "sundials_nvecserial"),
        id="arkode_erk8",
        title="Fehlberg 8(7), ARKODE in C",
        ladder=HIGH_ORDER,
        formulations=SPACE_FIRST,
        order=8,
    ),
)
