"""Of functions that compiled functions call, machine code is made once: with the function that Python calls."""

from __future__ import annotations

import importlib.util
import math

import pytest

pytest.importorskip("numba")

from numba.core import codegen, event

FUNCTIONS = """
from reference.engines.limbs.compiling import compiled, entry, inlined

@inlined
def square(x):
    return x * x

@compiled
def fourth(x):
    return square(square(x))

@compiled
def eighth(x):
    return fourth(x) * fourth(x)

@entry("", 0)
def sixteenth(x):
    return eighth(x) * eighth(x)

@entry("", 0)
def ninth(x):
    return eighth(x) * x
"""
PARTS = ["eighth", "fourth", "square"]


@pytest.fixture
def names(monkeypatch):
    """Names of the functions of which machine code is made, but for numba's own runtime."""
    names: list[str] = []
    make = codegen.JITCodeLibrary._finalize_specific

    def noted(library):
        names.extend({library.name} - {"nrt"})
        make(library)

    monkeypatch.setattr(codegen.JITCodeLibrary, "_finalize_specific", noted)
    return names


def loaded(folder):
    """Return the functions as a new process would see them."""
    path = folder / "functions.py"
    if not path.exists():  # older numba takes a file that is written again for another one
        path.write_text(FUNCTIONS)
    spec = importlib.util.spec_from_file_location("functions", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def compiled_by(call):
    """Return a call's result, and the names of the functions that it compiles."""
    with event.install_recorder("numba:compile") as recorder:
        result = call()
    return result, sorted(one.data["dispatcher"].__name__ for _, one in recorder.buffer if one.is_start)


def test_machine_code_is_made_of_what_python_calls_alone(tmp_path, names):
    functions = loaded(tmp_path)
    assert compiled_by(lambda: functions.sixteenth(3)) == (3**16, sorted(["sixteenth", *PARTS]))
    assert names == ["sixteenth"]
    assert compiled_by(lambda: functions.ninth(3)) == (3**9, ["ninth"])
    assert names == ["sixteenth", "ninth"]


def test_parts_serve_other_types_too(tmp_path, names):
    functions = loaded(tmp_path)
    assert functions.sixteenth(3) == 3**16
    assert math.isclose(functions.sixteenth(1.5), 1.5**16, rel_tol=1e-15)
    assert names == ["sixteenth"] * 2


def test_what_is_kept_on_disk_needs_no_parts(tmp_path):
    assert loaded(tmp_path).sixteenth(3) == 3**16
    functions = loaded(tmp_path)
    assert compiled_by(lambda: functions.sixteenth(3)) == (3**16, [])
    assert compiled_by(lambda: functions.ninth(3)) == (3**9, sorted(["ninth", *PARTS]))
