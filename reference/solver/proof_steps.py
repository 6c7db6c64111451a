"""The approximant of a proof: the Taylor steps of an engine's run, in a child process if costly.

A polynomial serves both sides of its centre, so only every other step is sent. The proof consumes
the polynomials as they arrive; the pipe provides back-pressure. The proof bounds the defect of
every polynomial, and relies on none.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator
from fractions import Fraction
from itertools import chain, islice
from time import process_time

from ..engines.plan import Run
from ..engines.registry import MANY_STEPS, WORTH_A_PROCESS, engines, fastest
from ..errors import IntegrationError
from ..numbers.taylor_step import TaylorStep
from ..scenes.inputs import Inputs
from ..system.workers import Emit, Worker

# coefficients carry this many bits below the run's epsilon, so that cutting them costs nothing
COEFFICIENT_BITS = 20
_BATCH = 32  # steps sent at once
# A step of heyoka is as long as its epsilon allows: one radius that encloses such a run is up to 10
# bits wider than `MARGIN_BITS` assumes, and a proof that begins with too few bits is made a second
# time. Columns begin with too few bits as well, but the shipped bytes of `inverted_rest` depend on
# that.
_HEYOKA_BITS = 8

_Sent = tuple[TaylorStep | Run, float]


class EngineChanged(Exception):
    """A proof has to go on with another engine than it began with: `engine`."""

    def __init__(self, engine: str) -> None:
        super().__init__(engine)
        self.engine = engine


class Feed:
    """The run whose Taylor steps a proof takes.

    Called with the proof's bits, it starts a run and returns its steps.
    """

    def __init__(
        self, inputs: Inputs, times: tuple[Fraction, ...], engine: str, steps: int = MANY_STEPS
    ) -> None:
        """Prepare the run.

        Args:
            inputs: the scene's exact inputs.
            times: output times in s; the run goes one step beyond the last.
            engine: name of the engine, where it has the bits; "auto" for the fastest.
            steps: about how many steps it takes in double.

        `begun` is the engine of the last run, "" before the first. `run_s` and `proof_s` are the
        CPU seconds of the last run so far, and of the work with its steps; `discarded_s` are those
        of all earlier runs.
        """
        self._inputs = inputs
        self._times = times
        self._engine = engine
        self._count = steps
        self.begun = ""
        self._worker: Worker | None = None
        self._steps = self._only_steps(())
        self._run: Run | None = None
        self.run_s = self.proof_s = self.discarded_s = 0.0

    def __call__(self, bits: int) -> Iterator[TaylorStep]:
        """Start the run for a proof in so many bits and return its steps, in order from t = 0.

        Raises:
            EngineChanged: another engine has to make this run than the first. All runs of a proof
                have to be by the engine that its dataset names, so that `--engine` gives the same
                bytes again.
        """
        self.stop()
        self._steps.close()  # this stops its clock
        self.discarded_s += self.run_s + self.proof_s
        self.run_s = self.proof_s = 0.0
        prec = bits - COEFFICIENT_BITS
        engine = fastest(prec, self._engine, self._count, proof=True)
        if self.begun not in ("", engine.name):
            raise EngineChanged(engine.name)
        self.begun = engine.name
        self._run = None
        run = (engine.name, self._inputs, self._times, prec)
        if engine.own_process and engine.expected_s(self._count, prec) >= WORTH_A_PROCESS:
            self._worker = Worker(_send, *run)
            self._steps = self._only_steps(chain.from_iterable(self._worker))
        else:
            self._steps = self._only_steps(_steps_and_run(*run))
        return self._steps

    def lost(self, bits: int) -> int:
        """Return how many bits a run in `bits` bits loses besides those that a proof allows for."""
        engine = fastest(bits - COEFFICIENT_BITS, self._engine, self._count, proof=True)
        return _HEYOKA_BITS if engine.name == "heyoka" else 0

    def finished(self) -> Run:
        """Exhaust the steps and return the run, with its states at `times`."""
        for _ in self._steps:
            pass
        if self._run is None:
            raise IntegrationError(
                "the run of the approximant ended before it returned its states."
            )
        return self._run

    def stop(self) -> None:
        """End the process."""
        if self._worker is not None:
            self._worker.stop()

    def _only_steps(self, items: Iterable[_Sent]) -> Generator[TaylorStep]:
        for item, self.run_s in items:
            if isinstance(item, Run):
                self._run = item
                continue
            begun = process_time()
            try:
                yield item
            finally:  # also where the proof gives up
                self.proof_s += process_time() - begun


def _steps_and_run(
    engine: str, inputs: Inputs, times: tuple[Fraction, ...], prec: int
) -> Iterator[_Sent]:
    """Yield the steps of an engine's run, in the axes of a proof and paired, and finally the run.

    With each come the CPU seconds since the first, before which code is compiled.
    """
    from ..enclosure import pair, turned

    runs: list[Run] = []

    def steps() -> Iterator[TaylorStep]:
        coefficient_bits = prec + COEFFICIENT_BITS
        run = yield from engines()[engine].taylor_steps(inputs, times, prec, coefficient_bits)
        runs.append(run)

    items: Iterator[TaylorStep | Run] = chain(pair(turned(inputs, steps())), runs)
    cpu_s = 0.0
    begun: float | None = None
    for item in items:
        if begun is not None:
            cpu_s += process_time() - begun
        yield item, cpu_s
        begun = process_time()


def _send(emit: Emit, engine: str, inputs: Inputs, times: tuple[Fraction, ...], prec: int) -> None:
    items = _steps_and_run(engine, inputs, times, prec)
    while batch := list(islice(items, _BATCH)):
        emit(batch)
