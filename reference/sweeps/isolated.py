"""A process that promotes rows for the threads of another: the solver is not made for several threads."""

from __future__ import annotations

import os
import threading
from dataclasses import replace
from typing import Any

from ..errors import IntegrationError
from ..system.process import Parent, Worker
from .promote import Promoted, promoted
from .request import Request


class Isolated:
    """Calls `promoted` in one process of its own, which starts with the first row and is replaced if it dies."""

    def __init__(self) -> None:
        self._turn = threading.Lock()
        self._worker: Worker | None = None
        self._hash = ""

    def __call__(self, request: Request, row: int, *, doubtful: bool) -> Promoted:
        """Return a row solved by itself; see `promote.promoted`."""
        with self._turn:
            if self._hash != request.hash:
                self._end()
            try:
                if self._worker is None:
                    self._worker, self._hash = Worker(serve, request.document()), request.hash
                self._worker.send((row, doubtful))
                result: Promoted = self._worker.receive()
            except (IntegrationError, OSError) as error:
                self._end()
                return Promoted({}, ([], []), str(error))
            return result

    def stop(self) -> None:
        """End the process."""
        with self._turn:
            self._end()

    def _end(self) -> None:
        if self._worker is not None:
            self._worker.stop()
            self._worker = None


def serve(parent: Parent, document: dict[str, Any]) -> None:
    """Promote the rows that the parent sends."""
    request = Request.of(document)
    for row, doubtful in parent:
        before = sum(os.times()[:4])
        result = promoted(request, row, doubtful=doubtful)
        parent(replace(result, cpu_s=sum(os.times()[:4]) - before))
