"""A list of measurements in a process of its own: one that hangs or dies costs that one and not the rest."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from reference import IntegrationError
from reference.process import Worker

STARTING_S = 30.0  # wall-clock time for imports and compilation, beside the patience for each measurement

Item = TypeVar("Item")
Result = TypeVar("Result")


def isolated(
    function: Callable[..., None],
    arguments: tuple[Any, ...],
    items: Sequence[Item],
    patience_s: float,
    failed: Callable[[Item, bool, str], Result],
) -> Iterator[Result]:
    """Run `function(emit, *arguments, items)`, which emits one result an item, in order.

    Args:
        function: at the top level of a module.
        arguments: whatever pickles.
        items: what to measure.
        patience_s: wall-clock seconds for one item; then the process is ended.
        failed: makes the result of an item that hung (True) or whose process ended, with the reason.
    """
    todo = list(items)
    while todo:
        worker = Worker(function, *arguments, todo)
        late = threading.Event()
        answers = iter(worker)
        grace = STARTING_S
        try:
            while todo:
                alarm = threading.Timer(patience_s + grace, _end, (worker, late))
                alarm.start()
                try:
                    result = next(answers)
                finally:
                    alarm.cancel()
                grace = 0.0
                yield result
                todo.pop(0)
        except (IntegrationError, StopIteration) as error:
            reason = f"no answer within {patience_s:g} s" if late.is_set() else f"its process ended: {error}"
            yield failed(todo.pop(0), late.is_set(), reason)
        finally:
            worker.kill()
            worker.stop()


def _end(worker: Worker, late: threading.Event) -> None:
    late.set()
    worker.kill()
