"""Settings for every test, and the fixture that most of them want."""

from __future__ import annotations

import io
import signal
import sys
from collections.abc import Callable

import pytest
from hypothesis import settings
from small_scenes import make_scene

from reference.scene import Scene, load_scene

settings.register_profile("here", deadline=None, derandomize=True)
settings.load_profile("here")

# tests interrupt what they start; a shell's background job would have it ignore that
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

__all__ = ["make_scene"]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--long", action="store_true", help="run the campaigns at full size, as `make campaign` does")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark campaigns."""
    for item in items:
        if "size" in getattr(item, "fixturenames", []) or "campaigns" in item.path.parts:
            item.add_marker("campaign")


@pytest.fixture
def size(pytestconfig: pytest.Config) -> Callable[[int, int], int]:
    """Choose how many cases a campaign tries: the first number in every test run, the second with --long."""
    return lambda short, long: long if pytestconfig.getoption("--long") else short


@pytest.fixture
def tally(record_property: Callable[[str, object], None]) -> Callable[[str], None]:
    """Report what a campaign tried and found: the line is printed at the end of the test run."""
    return lambda line: record_property("tally", line)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    reports = [report for kind in ("passed", "failed") for report in terminalreporter.stats.get(kind, ())]
    lines = [str(value) for report in reports for key, value in report.user_properties if key == "tally"]
    if lines:
        terminalreporter.section("campaigns")
    for line in sorted(lines):
        terminalreporter.write_line(line)


@pytest.fixture
def paris() -> Scene:
    return load_scene("paris")


@pytest.fixture
def foucault(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Run a command in this process; return exit status, stdout, stderr."""

    def call(*words: object, stdin: bytes = b"") -> tuple[int, str, str]:
        from foucault import main

        monkeypatch.setattr(sys, "argv", ["foucault", *map(str, words)])
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(stdin)))
        status = 0
        try:
            main()
        except SystemExit as stop:
            status = int(stop.code or 0)
        finally:
            signal.signal(signal.SIGINT, signal.default_int_handler)  # as it ends, it has it ignored
        output = capfd.readouterr()
        return status, output.out, output.err

    return call
