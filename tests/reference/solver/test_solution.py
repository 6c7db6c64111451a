"""Digits after the point of grid and zeros, and numbers that an error leaves undecided."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from fractions import Fraction

import pytest

import reference
from reference import InputError
from reference.engines.plan import Plan
from reference.engines.registry import run
from reference.numbers import columns
from reference.numbers.columns import GRID, SECTION, TRANSITS, GridColumns
from reference.numbers.precision import DOUBLE
from reference.numbers.table import Table
from reference.numbers.zeros import Zeros
from reference.solver.solution import (
    SAMPLED,
    CrossCheck,
    UndecidedRounding,
    check_decided,
    decimals_of_zeros,
    exact_decimals,
    grid_decimals,
)
from reference.solver.swing import NO_SECTION, UNDECIDED

SURE, OPEN = Fraction(1, 10**12), Fraction(1)


@pytest.fixture(scope="module")
def solution():
    short = {"t_end": "60", "digits": 6, "level": "computed"}
    solved = reference.solve(reference.load_scene("paris"), sections=["gate 30"], **short)
    errors = {
        word: dict.fromkeys(zeros.table.columns, SURE) for word, zeros in solved.zeros.items()
    }
    return replace(
        solved,
        grid=solved.grid.with_errors(dict.fromkeys(GRID, SURE)),
        zeros={word: with_errors(zeros, errors[word]) for word, zeros in solved.zeros.items()},
    )


def with_errors(zeros, errors):
    return zeros._replace(table=zeros.table.with_errors(errors))


def test_transits_have_the_decimals_of_the_grid_and_their_own_for_time_and_acceleration(solution):
    grid, transits = grid_decimals(solution), decimals_of_zeros(solution, "xdot")
    assert {name: transits[name] for name in ("x", "y", "z", "vy")} == {
        name: grid[name] for name in ("x", "y", "z", "vy")
    }
    assert (transits["t"], transits["ax"]) == (4, 7)  # 57 s and 0.04 m/s² with six digits


@pytest.mark.parametrize("word", ["xdot", "gate 30"])
def test_zeros_that_a_solution_has_not_have_no_decimals(solution, word):
    assert decimals_of_zeros(solution, word)
    assert decimals_of_zeros(replace(solution, zeros={}), word) == {}


@pytest.mark.parametrize("kind", ["grid", "xdot", "gate 30"])
def test_a_number_whose_error_leaves_a_digit_open_is_refused_in_grid_and_zeros(solution, kind):
    check_decided(solution)
    check_decided(replace(solution, zeros={}))
    if kind == "grid":
        unsure = replace(
            solution, grid=solution.grid.with_errors(dict.fromkeys(GRID, SURE) | {"y": OPEN})
        )
    else:
        zeros = solution.zeros[kind]
        zeros = with_errors(zeros, dict.fromkeys(zeros.table.columns, SURE) | {"y": OPEN})
        unsure = replace(solution, zeros=solution.zeros | {kind: zeros})
    with pytest.raises(UndecidedRounding, match="of y = "):
        check_decided(unsure)


@pytest.mark.parametrize("word", ["xdot", "gate 30"])
@pytest.mark.parametrize(("of_grid", "of_zeros"), [(OPEN, 2 * OPEN), (2 * OPEN, OPEN)])
def test_the_widest_of_the_numbers_with_an_open_digit_is_named(solution, word, of_grid, of_zeros):
    grid = solution.grid.with_errors(dict.fromkeys(GRID, SURE) | {"y": of_grid})
    zeros = solution.zeros[word]
    zeros = with_errors(zeros, dict.fromkeys(zeros.table.columns, SURE) | {"y": of_zeros})
    unsure = replace(solution, grid=grid, zeros=solution.zeros | {word: zeros})
    with pytest.raises(UndecidedRounding) as caught:
        check_decided(unsure)
    assert (caught.value.width, caught.value.column) == (
        2 * OPEN * 10 ** grid_decimals(unsure)["y"],
        "y",
    )


@pytest.mark.parametrize(
    ("values", "digits"), [(("60", "0"), 0), (("0.05",), 2), (("1.5", "0.125", "7"), 3)]
)
def test_terminating_decimals_are_printed_exactly(values, digits):
    assert exact_decimals(tuple(map(Fraction, values))) == digits


def test_the_motion_at_any_time_takes_a_golden_function(solution):
    enclosed = {"t_end": "20", "digits": 12, "level": "enclosed"}
    for without in (solution, reference.solve("paris", **enclosed)):
        assert without.function is None
        with pytest.raises(InputError, match="function=True"):
            without.at(1.0)
    moving = reference.solve("paris", **enclosed, function=True)
    at = moving.at([0.0, 8.217792, 20.0])
    assert at.x[0] == 0.3
    assert at.vx[1] == pytest.approx(0, abs=1e-6)  # the first transit
    assert at.z[2] == pytest.approx(moving.z[-1], abs=1e-12)


@pytest.mark.parametrize("words", [("early", "late"), ("late", "early")])
def test_passages_have_the_decimals_of_the_grid_and_those_of_the_latest_time(solution, words):
    """Transits, which have a file of their own, count for none of them."""
    rows = {"early": (1, *[0] * 6), "late": (57, *[0] * 6)}
    zeros = {word: Zeros(Table(SECTION, 0, [rows[word]]), [1]) for word in words}
    zeros |= {"xdot": Zeros(Table(TRANSITS, 0, [(5700, *[0] * 5)]), [1])}
    of_zeros = replace(solution, zeros=zeros)
    for word in words:
        assert decimals_of_zeros(of_zeros, word) == grid_decimals(solution) | {"t": 4}
    assert decimals_of_zeros(of_zeros, "xdot")["t"] == 2


def test_a_swing_is_measured_by_its_highest_points_unless_some_are_undecided(solution):
    found = reference.solve(solution.scene, sections=["highest", "lowest"])
    highest, lowest = found.sections["highest"], found.sections["lowest"]
    # two a swing of 16.4355 s
    times = highest.table["t"]
    assert float(sum(found.swing.hz)) / 2 == pytest.approx(
        (len(times) - 1) / 2 / (times[-1] - times[0]), rel=1e-9
    )
    assert float(found.swing.hz[0]) == pytest.approx(1 / 16.4355, rel=1e-4)
    for sections, reason in (
        ({"lowest": lowest}, NO_SECTION),
        ({"highest": Zeros(highest.table, highest.directions, ((SURE, OPEN, "even"),))}, UNDECIDED),
    ):
        solved = replace(found, zeros=sections)
        assert solved.swing_or_reason == reason
        assert solved.swing is None


def test_a_check_tells_the_largest_gap_of_positions_and_of_velocities(solution):
    witness = run(Plan(solution.scene.exact, "spin", DOUBLE, solution.times, ("xdot",)))
    gaps = {name: Fraction(i, 7) for i, name in enumerate(GRID)}
    check = CrossCheck.by(witness, gaps, None)
    assert (check.engine, check.formulation, check.number) == ("heyoka", "spin", "double")
    assert (check.position_m, check.velocity_m_s, check.transit_s) == (
        Fraction(2, 7),
        Fraction(5, 7),
        None,
    )
    assert SAMPLED == 10  # "a tenth" in help, pages and what is written


def test_transits_are_the_zeros_of_xdot_and_sections_the_others(solution):
    assert list(solution.zeros) == ["xdot", "gate 30"]
    transits = solution.zeros["xdot"]
    assert (solution.transits, solution.directions, solution.possible) == transits
    assert solution.sections == {"gate 30": solution.zeros["gate 30"]}
    assert len(solution.transits) > 0
    without = replace(solution, zeros={})
    assert (len(without.transits), without.directions, without.possible, without.sections) == (
        0,
        [],
        (),
        {},
    )
    assert without.transits.columns == TRANSITS


def told_by_mypy(program, *words):
    """Return what mypy, in a process of its own as it raises the recursion limit for good, says of a program."""
    words = ["--strict", f"--cache-dir={program.parent}", *words, str(program)]
    return subprocess.run(
        [sys.executable, "-m", "mypy", *words], capture_output=True, text=True, check=False
    ).stdout


def test_a_type_checker_finds_what_is_no_column(tmp_path):
    """Read without all that the module imports, which takes a fifth of the time."""
    assert issubclass(reference.Solution, GridColumns)
    assert issubclass(reference.Golden, GridColumns)
    assert reference.Solution.__getattr__ is reference.Golden.__getattr__ is GridColumns.__getattr__
    program, settings = tmp_path / "user.py", tmp_path / "mypy.ini"
    program.write_text("""from reference.numbers.columns import GridColumns
def read(both: GridColumns) -> None:
    both.vz
    both.nonsense
""")
    settings.write_text("[mypy]\nfollow_imports = skip\nfollow_imports_for_stubs = true\n")
    output = told_by_mypy(program, f"--config-file={settings}", columns.__file__)
    assert '"GridColumns" has no attribute "nonsense"' in output
    assert '"vz"' not in output


@pytest.mark.long
def test_columns_have_a_type_and_a_type_checker_finds_what_is_no_attribute(tmp_path):
    program = tmp_path / "user.py"
    program.write_text("""import reference
for both in (reference.solve("paris"), reference.load("paris")):
    reveal_type(both.vz)
reference.solve({"id": "a"}).nonsense
reference.load("paris").nonsense
""")
    output = told_by_mypy(program, "--config-file=")
    assert "float64" in output.splitlines()[0]
    assert '"Solution" has no attribute "nonsense"' in output
    assert '"Golden" has no attribute "nonsense"' in output
