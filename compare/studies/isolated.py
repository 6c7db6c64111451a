"""Run a list of measurements in a child process: a hang (killed after `patience_s`) or a crash loses only that item."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from reference import IntegrationError
from reference.process import Worker

STARTING_S = 30.0  # wall-clock time for imports and compilation, on top of the patience for a process's first item

Item = TypeVar("Item")
Result = TypeVar("Result")


def isolated(
    function: Callable[..., None],
    arguments: tuple[Any, ...],
    items: Sequence[Item],
    patience_s: float,
    failed: Callable[[Item, bool, str], Result],
) -> Iterator[Result]:
    """Run `function(emit, *arguments, items)` in a child process; it emits one result for each item, in order.

    After a hang or a crash a new process goes on with the next item.

    Args:
        function: at the top level of a module, so that it can be pickled.
        arguments: anything that can be pickled.
        items: to be measured.
        patience_s: wall-clock seconds for one item; then the process is killed.
        failed: called with the item, whether it timed out, and the reason; returns the item's result.
    """
    remaining = list(items)
    while remaining:
        worker = Worker(function, *arguments, remaining)
        timed_out = threading.Event()
        answers = iter(worker)
        starting_s = STARTING_S
        try:
            while remaining:
                alarm = threading.Timer(patience_s + starting_s, _end, (worker, timed_out))
                alarm.start()
                try:
                    result = next(answers)
                finally:
                    alarm.cancel()
                starting_s = 0.0
                yield result
                remaining.pop(0)
        except (IntegrationError, StopIteration) as error:
            reason = f"no answer within {patience_s:g} s" if timed_out.is_set() else f"its process ended: {error}"
            yield failed(remaining.pop(0), timed_out.is_set(), reason)
        finally:
            worker.kill()
            worker.stop()


def _end(worker: Worker, timed_out: threading.Event) -> None:
    timed_out.set()
    worker.kill()
