"""The approximant of a proof: the Taylor steps of an engine's run, computed in a child process if they are dear.

A polynomial serves both sides of its centre, so only every other step is sent. The proof consumes the polynomials as
they arrive; the pipe provides back-pressure. The proof bounds the defect of every polynomial, so none need be trusted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice

from ..engines import AUTO
from ..engines.plan import Run
from ..engines.registry import MANY_STEPS, engines, fastest
from ..engines.side_by_side import WORTH_A_PROCESS
from ..errors import IntegrationError
from ..numbers.taylor_step import TaylorStep
from ..scenes.inputs import Inputs
from ..system.process import Emit, Worker

COEFFICIENT_BITS = 20  # coefficients carry this many bits below the run's epsilon, so that cutting them costs nothing
BATCH = 32  # steps sent at once


class EngineChanged(Exception):
    """The engine that a proof began with is not the one to go on with: that is `engine`."""

    def __init__(self, engine: str) -> None:
        super().__init__(engine)
        self.engine = engine


@dataclass
class Feed:
    """The run whose Taylor steps the proof takes.

    Called with a precision, it starts the run and yields its steps; `finished` then returns the states.

    Attributes:
        inputs: the scene's exact inputs.
        times: output times in s; the run goes one step beyond the last.
        engine: name of the engine, where it has the bits; "auto" for the fastest.
        steps: about how many steps it takes in double.
    """

    inputs: Inputs
    times: tuple[Fraction, ...]
    engine: str = AUTO
    steps: int = MANY_STEPS
    _begun: str = ""
    _worker: Worker | None = field(default=None, repr=False)
    _steps: Iterator[TaylorStep] = field(default_factory=lambda: iter(()), repr=False)
    _runs: list[Run] = field(default_factory=list, repr=False)

    def __call__(self, prec: int) -> Iterator[TaylorStep]:
        """Start a run at `prec` bits and return its steps, in order from t = 0.

        Raises:
            EngineChanged: another engine has to do it than at the first call. All that a proof has tried is to be of the
                engine that its dataset names, so that `--engine` gives the same bytes again.
        """
        self.stop()
        self._runs.clear()
        engine = fastest(prec, self.engine, self.steps)
        if self._begun not in ("", engine.name):
            raise EngineChanged(engine.name)
        self._begun = engine.name
        if engine.own_process and engine.expected_s(self.steps, prec) >= WORTH_A_PROCESS:
            self._worker = Worker(_send_steps, engine.name, self.inputs, self.times, prec)
            self._steps = self._received(self._worker)
        else:
            self._steps = _paired(engine.name, self.inputs, self.times, prec, self._runs)
        return self._steps

    def finished(self) -> Run:
        """Exhaust the steps and return the run, with its states at `times`."""
        for _ in self._steps:
            pass
        if not self._runs:
            raise IntegrationError("the approximant ended without its states.")
        return self._runs[0]

    def _received(self, worker: Worker) -> Iterator[TaylorStep]:
        for item in worker:
            if isinstance(item, Run):
                self._runs.append(item)
            else:
                yield from item

    def stop(self) -> None:
        """End the process."""
        if self._worker is not None:
            self._worker.stop()


def _paired(
    engine: str, inputs: Inputs, times: tuple[Fraction, ...], prec: int, runs: list[Run]
) -> Iterator[TaylorStep]:
    """Return the steps of an engine's run, in the axes of a proof and paired; at the end the run is put into `runs`."""
    from ..enclosure import pair, turned

    def chain() -> Iterator[TaylorStep]:
        runs.append((yield from engines()[engine].taylor_steps(inputs, times, prec, prec + COEFFICIENT_BITS)))

    return pair(turned(inputs, chain()))


def _send_steps(emit: Emit, engine: str, inputs: Inputs, times: tuple[Fraction, ...], prec: int) -> None:
    runs: list[Run] = []
    steps = _paired(engine, inputs, times, prec, runs)
    while batch := list(islice(steps, BATCH)):
        emit(batch)
    emit(runs[0])
