"""One small tree of errors; each carries its payload and the exit status of the command line."""

from __future__ import annotations


class FoucaultError(Exception):
    """Base of every error that this project raises on purpose."""

    exit_status = 1


class InputError(FoucaultError):
    """A user's mistake: the field, what came, what was expected and what to do."""

    exit_status = 2

    def __init__(self, field: str, got: object, expected: str, advice: str = "") -> None:
        self.field, self.got, self.expected, self.advice = field, got, expected, advice
        shown = got if isinstance(got, str) else repr(got)
        shown = shown if len(shown) <= 120 else shown[:117] + "..."
        text = f"{field}: got {shown!r}, expected {expected}."
        super().__init__(f"{text} {advice}".rstrip())


class UnreachableError(FoucaultError):
    """The level or the digits asked for cannot be reached; says how far it came."""

    exit_status = 3

    def __init__(self, reason: str, advice: str = "") -> None:
        self.reason, self.advice = reason, advice
        super().__init__(f"{reason} {advice}".rstrip())


class IntegrationError(UnreachableError):
    """The integrator stopped, warned, or contradicted itself: a failed run gives no numbers."""


class DatasetError(FoucaultError):
    """A golden dataset is damaged or contradicts itself; `problems` lists how."""

    def __init__(self, path: str, problems: list[str]) -> None:
        self.path, self.problems = path, problems
        super().__init__(f"{path}: " + "; ".join(problems))
