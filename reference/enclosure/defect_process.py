"""Defects computed in another process, as those of different steps do not depend on each other. Untrusted.

Not the `Worker` of `reference.process`, which is sent its arguments once: this one is sent steps while it works.
"""

from __future__ import annotations

import contextlib
import pickle
import subprocess
import sys
from time import process_time
from types import SimpleNamespace
from typing import IO, Any, cast

from flint import arb, fmpz

from .approximant import polynomials
from .bound import Piece, World
from .shapes import Sizes, Step


def _pack(sizes: Sizes) -> list[tuple[int, int]]:
    return [(int(m), int(e)) for m, e in (x.man_exp() for x in sizes)]


def _unpack(row: list[tuple[int, int]]) -> Sizes:
    return Sizes(*(arb((fmpz(m), fmpz(e))) for m, e in row))


class DefectProcess:
    """A process that computes defects; it ends when its input does, so it cannot outlive this one."""

    def __init__(self, inputs: Any, prec: int) -> None:
        code = "import pickle, sys; sys.path[:] = pickle.load(sys.stdin.buffer); from {} import serve; serve()"
        self.process = subprocess.Popen(
            [sys.executable, "-c", code.format(__name__)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self._put(sys.path)
        self._put((SimpleNamespace(**vars(inputs)), prec))

    def _put(self, value: object) -> None:
        pipe = cast("IO[bytes]", self.process.stdin)
        pickle.dump(value, pipe, protocol=pickle.HIGHEST_PROTOCOL)
        pipe.flush()

    def send(self, steps: list[Step]) -> None:
        """Send steps to work on; waits while the pipe is full."""
        self._put([tuple(step) for step in steps])

    def receive(self) -> tuple[list[Sizes], float]:
        """Return the sizes of the steps sent first, and the CPU seconds spent on them."""
        rows, cpu = pickle.load(cast("IO[bytes]", self.process.stdout))
        return [_unpack(row) for row in rows], cpu

    def stop(self) -> None:
        """End the process."""
        self.process.kill()
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe:
                with contextlib.suppress(OSError):
                    pipe.close()
        self.process.wait()


def serve() -> None:
    """Run the second process: read steps and write their sizes until the input ends."""
    source, target = sys.stdin.buffer, sys.stdout.buffer
    inputs, prec = pickle.load(source)
    world = World(inputs, prec)
    while True:
        before = process_time()
        try:
            steps = [Step(*row) for row in pickle.load(source)]
        except EOFError:
            return
        rows = [_pack(Piece(world, polynomials(s)).sizes()) for s in steps]
        pickle.dump((rows, process_time() - before), target)
        target.flush()
