"""An engine that is compiled in the background, so that the next sweep can use it."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace

from .driver import prepared
from .request import Request, request_of, worth_compiling

_PRIORITY = 10  # of the process, in steps of `nice`
_START = (
    "import sys; sys.path[:] = sys.argv[2:]; "
    "from reference.sweeps.background import compile_now; compile_now(sys.argv[1])"
)


def compile_for_the_next(request: Request) -> str:
    """Compile in the background an engine that would solve a sweep's rows faster; return what was started.

    Returns:
        One sentence for the user; empty if nothing faster can be compiled. The process goes on when
        this one ends: it takes some seconds, once on a machine.
    """
    engine = worth_compiling(request)
    if engine is None:
        return ""
    words = [sys.executable, "-c", _START, request.text, *sys.path]
    try:
        subprocess.Popen(
            words,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
    except OSError:  # the request is longer than an argument may be, or there is no room
        return ""
    seconds = engine.compiling_s(bool(request.sections))
    return (
        f"{engine.name} is compiled in the background, once, for about {seconds:.0f} s: "
        f"{request.engine} solves these rows, and {engine.name} those of the next sweep."
    )


def compile_now(text: str) -> None:
    """Compile what would solve the rows of a request faster, in this process."""
    os.nice(_PRIORITY)
    request = request_of(text)
    engine = worth_compiling(request)
    if engine is not None:
        prepared(replace(request, engine=engine.name))
