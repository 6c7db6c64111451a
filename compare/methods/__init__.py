"""Integrators behind one interface (the paper's, this project's, libraries'), each declared in a file of its own.

>>> from compare.methods import METHODS
>>> METHODS["rk4"].title
'classical Runge-Kutta, order 4'

A method prepares a problem and returns a function that integrates it, so that the integration can
be timed alone:

    from compare.methods.rhs.problem import Problem

    problem = Problem.of(reference.load_scene("paris"), "plane")
    work = METHODS["rk4"].prepare(problem, 0.01)    # imports and compiles
    outcome = work()                                # integrates
    outcome.states                                  # x, y, z, vx, vy, vz at problem.times

The ids of all methods are known when one is first looked up: the files are imported then, and a
method's library when it prepares a problem. They are listed by family, then by file, then in the
order of the file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from reference import InputError
from reference.errors import counted
from reference.system.imports import Registry

from .external import LONGEST_NAME, file_name
from .method import Family, Method

METHODS: Mapping[str, Method] = Registry(
    __name__, "METHODS", "method", lambda method: [*Family].index(method.family)
)


def named_programs(commands: Sequence[str], names: Sequence[str] = ()) -> dict[str, str]:
    """Return the commands by their names in a study.

    Args:
        commands: of programs of the user's own, as `candidates.external.arguments` accepts them.
        names: one for each, or none at all: then each has the name of its program's file,
            shortened.

    Raises:
        InputError: the names are not as many as the commands, not short and printable, or not
            distinct.
    """
    if names and len(names) != len(commands):
        raise InputError(
            "--name",
            ", ".join(names),
            f"{counted(len(commands), 'name')}, one for each --run",
            "Or give no --name.",
        )
    programs: dict[str, str] = {}
    for command, name in zip(commands, names or map(file_name, commands), strict=True):
        if not name.strip() or not name.isprintable() or len(name) > LONGEST_NAME:
            raise InputError("--name", name, f"1 to {LONGEST_NAME} printable characters")
        if name in programs or name in METHODS:
            owner = "another --run" if name in programs else "a method"
            raise InputError(
                "--name", name, f"a name other than that of {owner}", "Give each --run a --name."
            )
        programs[name] = command
    return programs
