"""A method that is not installed skips its test with the reason; under --peers only one that no extra brings may."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from compare.methods import METHODS
from compare.methods.method import Method, available


@pytest.fixture
def installed(pytestconfig: pytest.Config) -> Callable[[str], Method]:
    def method(name: str) -> Method:
        missing = available(METHODS[name])
        if missing and pytestconfig.getoption("--peers") and METHODS[name].extra:
            pytest.fail(missing)
        if missing:
            pytest.skip(missing)
        return METHODS[name]

    return method
