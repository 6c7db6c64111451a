"""The exceptions of this project: one small tree; each carries its payload and the exit status of the command line."""

from __future__ import annotations


class FoucaultError(Exception):
    """Base of every error that this project raises on purpose."""

    exit_status = 1


class InputError(FoucaultError):
    """A user's mistake: the field, the value it got, what was expected, and advice."""

    exit_status = 2

    def __init__(self, field: str, got: object, expected: str, advice: str = "") -> None:
        self.field, self.got, self.expected, self.advice = field, got, expected, advice
        value = got if isinstance(got, str) else repr(got)
        value = value if len(value) <= 120 else value[:117] + "..."
        text = f"{field}: got {value!r}, expected {expected}."
        super().__init__(f"{text} {advice}".rstrip())


class UnreachableError(FoucaultError):
    """The requested level or digits cannot be reached; the reason says how far the solver came."""

    exit_status = 3

    def __init__(self, reason: str, advice: str = "") -> None:
        self.reason, self.advice = reason, advice
        super().__init__(f"{reason} {advice}".rstrip())


class IntegrationError(UnreachableError):
    """The integrator stopped, warned, or contradicted itself; a failed run returns no numbers."""


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
