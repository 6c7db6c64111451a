"""The exceptions of this project: one small tree; each carries its payload and the exit status of the command line."""

from __future__ import annotations

from .plain_text import plain, plain_lines
from .shortened import shortened

LONGEST_VALUE = 120  # characters of a value that a message repeats


class FoucaultError(Exception):
    """Base of every error that this project raises on purpose."""

    exit_status = 1

    def __init__(self, text: str) -> None:
        super().__init__(plain_lines(text))


class InputError(FoucaultError):
    """A user's mistake: the field, the value it got, what was expected, and advice."""

    exit_status = 2

    def __init__(self, field: str, got: object, expected: str, advice: str = "") -> None:
        self.field, self.got, self.expected, self.advice = field, got, expected, advice
        text = f"{plain(field)}: got {_shown(got)!r}, expected {expected}."
        super().__init__(f"{text} {advice}".rstrip())


def _shown(value: object) -> str:
    """Return the beginning of a value as text."""
    try:
        text = value if isinstance(value, str) else repr(value)
    except (ValueError, RecursionError):  # an integer of more than 4300 digits, or lists in lists without end
        text = f"too large a value to print, {type(value).__name__}"
    return shortened(text, LONGEST_VALUE)


class UnreachableError(FoucaultError):
    """The requested level or digits cannot be reached; the reason says how far the solver came."""

    exit_status = 3

    def __init__(self, reason: str, advice: str = "") -> None:
        self.reason, self.advice = reason, advice
        super().__init__(f"{reason} {advice}".rstrip())


class IntegrationError(UnreachableError):
    """The integrator stopped, warned, or contradicted itself; a failed run returns no numbers."""


class BeyondDoublesError(UnreachableError):
    """A number of a scene is too large for what is computed in binary64, such as steps and sizes."""

    def __init__(self) -> None:
        super().__init__("A length, force, rate or time of the scene is beyond the range of binary64.")


class DatasetError(FoucaultError):
    """A golden dataset is damaged or contradicts itself; `problems` lists how."""

    def __init__(self, path: str, problems: list[str]) -> None:
        self.path, self.problems = path, problems
        super().__init__(f"{path}: " + "; ".join(problems))


class Stopped(FoucaultError):
    """The user stopped a command (Ctrl-C); the message says what became of its work."""

    exit_status = 130

    def __init__(self, outcome: str) -> None:
        super().__init__(f"stopped; {outcome}")
