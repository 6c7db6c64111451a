"""Settings for every test, and the fixture that most of them want."""

from __future__ import annotations

import gc
import io
import os
import signal
import sys
from collections import Counter
from collections.abc import Callable, Generator
from functools import cache
from typing import Any

import pytest
from checker import check, sanitized_check
from hypothesis import settings
from small_scenes import make_scene

from foucault import SELDOM
from reference.scenes.scene import Scene, load_scene

COSTLY = 15  # files named at the end of a test run, with the CPU seconds that they took
# begun first, so that no worker is left with one of them at the end
FIRST = {
    f"test_{name}.py"
    for name in ("explanation", "docs", "same_bytes", "kill", "experiments", "judge")
}

settings.register_profile("here", deadline=None, derandomize=True)
settings.load_profile("here")

# a command looks for garbage as seldom
gc.set_threshold(SELDOM)

# tests interrupt what they start; a shell's background job would have it ignore that
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

__all__ = ["check", "make_scene", "sanitized_check"]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--long",
        action="store_true",
        help="run the campaigns at full size, as `make campaign` does",
    )
    parser.addoption(
        "--peers", action="store_true", help="fail where a method that an extra brings is missing"
    )


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Put the costliest files first; mark campaigns; skip what is only a part of them."""
    items.sort(key=lambda item: item.path.name not in FIRST)
    for item in items:
        long = item.get_closest_marker("long")
        if long or "size" in getattr(item, "fixturenames", []) or "campaigns" in item.path.parts:
            item.add_marker("campaign")
        if long and not config.getoption("--long"):
            item.add_marker(pytest.mark.skip(reason="under --long"))


def pytest_collection_finish() -> None:
    """Have no search for garbage go through what was collected, which stays to the end."""
    gc.freeze()


@pytest.fixture(autouse=True)
def interruptible() -> Generator[None]:
    """Let Ctrl-C end again what a test starts: a command that ended in this process has it ignored."""
    yield
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def size(pytestconfig: pytest.Config) -> Callable[[Any, Any], Any]:
    """Choose how many cases a campaign tries: the first number in every test run, the second with --long."""
    return lambda short, long: long if pytestconfig.getoption("--long") else short


@pytest.fixture
def tally(record_property: Callable[[str, object], None]) -> Callable[[str], None]:
    """Report what a campaign tried and found: the line is printed at the end of the test run."""
    return lambda line: record_property("tally", line)


def cpu_s() -> float:
    """Return the CPU seconds of this process and of those that it waited for."""
    return sum(os.times()[:4])


USED = pytest.StashKey[float]()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Note what a test, its preparation or its clearing away took."""
    report = yield
    before, now = item.config.stash.get(USED, 0.0), cpu_s()
    item.config.stash[USED] = now
    report.user_properties.append(("cpu_s", now - before))
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    reports = [
        report
        for kind in ("passed", "failed", "")
        for report in terminalreporter.stats.get(kind, ())
    ]
    lines = {
        str(value) for report in reports for key, value in report.user_properties if key == "tally"
    }
    if lines:
        terminalreporter.section("campaigns")
    for line in sorted(lines):
        terminalreporter.write_line(line)
    taken: Counter[str] = Counter()
    for report in reports:
        properties = dict(report.user_properties)
        taken[report.nodeid.partition("::")[0]] += properties.get("cpu_s", 0.0)
    terminalreporter.section(f"{sum(taken.values()):.0f} CPU seconds")
    for path, seconds in taken.most_common(COSTLY):
        terminalreporter.write_line(f"{seconds:6.1f} {path}")


@pytest.fixture
def paris() -> Scene:
    return load_scene("paris")


@cache
def command_line() -> Any:
    """Return what `main` runs, built once for all calls in this process."""
    from typer.main import get_command

    from foucault import commands

    return get_command(commands())


@pytest.fixture
def foucault(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str, str]]:
    """Run a command in this process; return exit status, stdout, stderr."""

    def call(*words: object, stdin: bytes = b"") -> tuple[int, str, str]:
        from foucault import main

        built = command_line()
        monkeypatch.setattr("foucault.commands", lambda: built)
        monkeypatch.setattr(sys, "argv", ["foucault", *map(str, words)])
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(stdin)))
        status = 0
        try:
            main()
        except SystemExit as stop:
            status = int(stop.code or 0)
        finally:
            # as it ends, it has it ignored
            signal.signal(signal.SIGINT, signal.default_int_handler)
        output = capfd.readouterr()
        return status, output.out, output.err

    return call
