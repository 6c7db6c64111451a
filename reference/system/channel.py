"""Text messages from inside long work to the code that shows its progress."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

Listener = Callable[[str], None]


class Channel:
    """Sends texts to the last listener; without one they are dropped."""

    def __init__(self) -> None:
        self._listeners: list[Listener] = []

    @contextmanager
    def heard_by(self, listener: Listener) -> Iterator[None]:
        """Call `listener` with each text that is sent inside this context."""
        self._listeners.append(listener)
        try:
            yield
        finally:
            self._listeners.remove(listener)

    @property
    def heard(self) -> bool:
        """Whether anybody listens."""
        return bool(self._listeners)

    def send(self, text: str) -> None:
        """Send a text to the last listener."""
        if self._listeners:
            self._listeners[-1](text)


ACTIVITY = Channel()  # what is being done now, such as "proving"
ANNOUNCEMENTS = Channel()  # one sentence for each piece of work that is done for the first time
