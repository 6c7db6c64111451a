"""Programs of C++: the traced equations in their language, compiled once, and what is said where that cannot be."""

from __future__ import annotations

import subprocess
from dataclasses import replace

import numpy as np
import pytest
from method_cases import case, python_function
from small_scenes import make_scene

from compare.methods import METHODS, c_libraries, library
from compare.methods.library import BOOST, GSL, Library
from compare.methods.method import available
from compare.methods.rhs.problem import Problem
from reference import IntegrationError

HOST = r"""
static void integrate(Run &run) {
    double to[VARIABLES * VARIABLES];
    slopes(run.row(0), to);
    for (int i = 0; i < VARIABLES; i++) std::copy_n(to + i * VARIABLES, VARIABLES, run.row(1 + i));
    rates(run.row(0), to), std::copy_n(to, VARIABLES, run.row(0));
    run.reached = 1 + VARIABLES, run.reason = "as asked", run.steps = 7;
}
"""
NATIVE = [name for name, method in METHODS.items() if method.native]
needs_compiler = pytest.mark.skipif(library.compiler() is None, reason="no C++ compiler")


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A library that consists of one header, and a cache of its own."""
    folder = tmp_path / "include"
    folder.mkdir()
    (folder / "own.h").write_text('#define OWN_VERSION "3_1"\n')
    monkeypatch.setenv("CPATH", str(folder))
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / "cache"))
    return Library("Own", "own.h", "own.h", "OWN_VERSION", "make own")


@pytest.fixture
def part(tmp_path):
    """A part that writes the rates and the Jacobian at the start instead of integrating."""
    path = tmp_path / "part.cpp"
    path.write_text(HOST)
    return str(path)


class InItsOwnVariables(Problem):
    """A problem whose rows stay in the variables of its formulation."""

    def cartesian(self, states):
        return states


@needs_compiler
@pytest.mark.parametrize(
    # those in every run have all that C++ is printed of: square roots, sines and arc tangents
    "formulation",
    [
        "plane",
        "angles",
        *(pytest.param(word, marks=pytest.mark.long) for word in ("momentum", "space", "spin")),
    ],
)
def test_the_equations_in_cpp_are_those_in_python(formulation, here, part):
    lively = make_scene(
        inputs="binary64",
        pendulum={"length": "1", "drag": "0.1"},
        site={"rotation_rate": "0.7", "equatorial_radius": "3"},
        release={"angle": "50", "azimuth": "20", "angle_rate": "40", "azimuth_rate": "100"},
    )
    problem = InItsOwnVariables.of(lively, formulation, np.arange(9.0))
    outcome = c_libraries.prepare(problem, 1e-9, here, [part])()
    parameters = list(problem.system.parameters.values())
    rates = python_function(problem.system.program)(*problem.start, *parameters)
    slopes = python_function(problem.system.jacobian)(*problem.start, *parameters)
    np.testing.assert_allclose(outcome.states[0], rates, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(outcome.states[1:].ravel(), slopes, rtol=1e-13, atol=1e-15)
    assert (outcome.steps, outcome.rhs_evaluations, outcome.reason) == (7, 1, "as asked")
    assert outcome.cpu_s is not None


@needs_compiler
def test_a_program_is_compiled_once_and_serves_scenes_with_the_same_terms(here, part, tmp_path):
    c_libraries.prepare(case("paris").problem("gsl_rk8pd"), 1e-9, here, [part])
    programs = tmp_path / "cache" / "native"
    (kept,) = programs.glob("[0-9a-f]*")
    before = kept.stat()
    other = c_libraries.prepare(
        case("steep").problem("gsl_rk8pd", formulation="space"), 1e-6, here, [part]
    )
    assert other().reason == "as asked"
    assert [*programs.glob("[0-9a-f]*")] == [kept]
    after = kept.stat()
    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)


@needs_compiler
def test_what_does_not_compile_is_said_in_the_compilers_words(here, tmp_path):
    wrong = tmp_path / "wrong.cpp"
    wrong.write_text("static void integrate(Run &) { no_such_thing(); }\n")
    with pytest.raises(IntegrationError, match=r"cannot compile .* Own: .*no_such_thing"):
        c_libraries.prepare(case("paris").problem("gsl_rk8pd"), 1e-9, here, [str(wrong)])


@needs_compiler
def test_a_program_that_crashes_is_an_outcome(here, tmp_path):
    crash = tmp_path / "crash.cpp"
    crash.write_text("#include <cstdlib>\nstatic void integrate(Run &) { std::abort(); }\n")
    outcome = c_libraries.prepare(case("paris").problem("gsl_rk8pd"), 1e-9, here, [str(crash)])()
    assert outcome.status == "gave_up"
    assert "exit status -6" in outcome.reason


@needs_compiler
def test_a_library_without_headers_says_what_brings_it():
    absent = replace(GSL, header="gsl/not_here.h")
    assert absent.missing == "not installed: gsl/not_here.h of GSL (apt install libgsl-dev)"
    assert available(replace(METHODS["gsl_rk8pd"], native=absent)) == absent.missing
    assert absent.version is None
    assert "pip install 'foucault-reference[methods-native]'" in BOOST.brings


def test_a_machine_without_a_compiler_says_so(monkeypatch):
    monkeypatch.setenv("CXX", "no-such-compiler")
    assert {METHODS[name].native.missing for name in NATIVE} == {
        "not installed: a C++ compiler, which the variable CXX may name"
    }


def test_the_version_is_read_from_the_headers(here):
    assert here.version == "3.1"
    assert here.missing is None or library.compiler() is None


def test_a_version_is_that_of_the_library_itself(installed):
    installed("odeint_rkf78")
    text = f"#include <{BOOST.version_file}>\n#include <cstdio>\nint main() {{ std::puts({BOOST.version_word}); }}\n"
    ran = subprocess.run(
        [*library.compiler(), "-E", "-P", "-I", str(BOOST.folder), "-x", "c++", "-"],
        input=text, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert f'puts("{BOOST.version.replace(".", "_")}")' in ran.stdout


@pytest.mark.parametrize(
    ("native", "wrapped"), [("cvode_c_adams", "cvode_adams"), ("cvode_c_bdf", "cvode_bdf")]
)
def test_cvode_takes_the_same_steps_behind_its_wrapper(native, wrapped, installed):
    problem = case("steep").problem(wrapped)
    first, second = (installed(name).prepare(problem, 1e-8)() for name in (native, wrapped))
    length = problem.constants.length
    assert np.abs(first.states - second.states)[:, :3].max() < 1e-3 * length
    assert first.rhs_evaluations == pytest.approx(second.rhs_evaluations, rel=0.2)
