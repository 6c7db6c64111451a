"""heyoka on a tenth of a proof's intervals: which are drawn, what it finds, and how often."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from hashlib import sha256

import pytest
from sampled import one_in

import reference
from reference.engines import AUTO
from reference.engines.heyoka.run import run_between
from reference.errors import IntegrationError
from reference.numbers.columns import GRID
from reference.solver.choice import confirming_plan, drawn_intervals, first_prec
from reference.solver.enclosed import confirmed
from reference.solver.pilot import run_pilot
from reference.solver.proving import ProofTask
from reference.solver.sensitivity import digits_lost
from reference.solver.solution import grid_decimals

ROWS = [
    "run.t_end=60",
    "run.grid_step=3",
    "run.digits=18",
    "run.level=enclosed",
    "run.transits=false",
]
SCENE = reference.load_scene("paris", ROWS)
COUNT = 20  # intervals


@pytest.fixture(scope="module")
def proved():
    return reference.solve(SCENE)


@pytest.fixture(scope="module")
def problem(proved):
    return ProofTask(SCENE, "auto", run_pilot(SCENE.exact, proved.times))


def confirms(problem, solution):
    """Whether a sampled confirmation passes a solution."""
    plan = confirming_plan(
        SCENE, solution.times, problem.pilot, first_prec(SCENE, problem.pilot, AUTO)
    )
    try:
        found = confirmed(
            problem, solution, "sampled", run_between(plan, solution.grid, drawn_intervals(SCENE))
        )
    except IntegrationError as error:
        assert "does not confirm" in str(error)
        return False
    assert found.proof.confirmed == "sampled"
    return True


def test_a_tenth_is_drawn_by_the_hash_of_the_inputs_as_the_specification_says():
    manifest = reference.load("paris").manifest
    named = {name: dict(table) for name, table in manifest.scene.items()}
    run = named["run"]
    run |= {"digits": int(run["digits"]), "transits": run["transits"] == "true"}
    text = json.dumps({"inputs": manifest.inputs, **named}, separators=(",", ":"))
    word = sha256(text.encode()).hexdigest()
    by_hash = sorted(range(1, 1441), key=lambda k: sha256(f"{word} {k}".encode()).hexdigest())
    drawn = drawn_intervals(reference.load_scene("paris"))
    assert drawn == [k - 1 for k in sorted(by_hash[:144])]
    assert drawn[:6] == [6, 7, 8, 23, 36, 37]


@pytest.mark.parametrize(
    ("end", "count"), [("60", 1), ("600", 1), ("660", 2), ("1200", 2), ("1201", 3)]
)
def test_a_tenth_is_rounded_up_and_another_scene_draws_others(end, count):
    drawn = [
        drawn_intervals(SCENE.with_values([f"run.t_end={end}", "run.grid_step=60", *more]))
        for more in ((), ["site.latitude=1"])
    ]
    assert [len(each) for each in drawn] == [count, count]
    assert (drawn[0] != drawn[1]) == (end != "60")


def test_a_digit_forged_into_a_row_is_found_where_a_drawn_interval_begins_or_ends_there(
    proved, problem
):
    """One unit of the last digit, in each row in turn: so often as a tenth of the intervals touch a row."""
    drawn, found = drawn_intervals(SCENE), []
    for row in range(COUNT + 1):
        name = GRID[row % len(GRID)]
        values = [list(each) for each in proved.grid.values]
        values[row][GRID.index(name)] += (1 << proved.grid.bits) // 10 ** grid_decimals(proved)[
            name
        ]
        forged = replace(proved, grid=replace(proved.grid, values=[tuple(each) for each in values]))
        found += [row] * (not confirms(problem, forged))
    assert found == sorted({row for i in drawn for row in (i, i + 1)})
    assert len(drawn) == COUNT // 10


def test_a_wrong_step_is_found_in_a_tenth_of_the_intervals(proved, problem):
    """From some step on the motion is another one, each row of it in itself right: of all intervals one is wrong."""
    other = reference.solve(SCENE.with_values(["release.x=0.30000000000000001"])).grid
    assert other.bits == proved.grid.bits
    found = []
    for interval in range(COUNT):
        values = [*proved.grid.values[: interval + 1], *other.values[interval + 1 :]]
        found += [interval] * (
            not confirms(problem, replace(proved, grid=replace(proved.grid, values=values)))
        )
    assert found == drawn_intervals(SCENE)


def test_of_a_grid_finer_than_the_steps_the_whole_is_confirmed_which_costs_less():
    fine = SCENE.with_values(["run.grid_step=0.01", "run.t_end=10", "run.transits=true"])
    solution = reference.solve(fine, confirm="sampled")
    check = solution.checks[-1]
    assert solution.proof.confirmed == "whole" and check.transit_s is not None
    assert check.steps < len(drawn_intervals(fine)) == 100


KINDS = (
    "damped",
    "pole",
    "over_top",
    "equator",
    "at_rest",
    "conical_pole",
    "weightless",
    "inverted_rest",
)


@pytest.mark.parametrize("name", one_in(4, KINDS))
def test_scenes_of_every_kind_are_confirmed_by_sample(name):
    rows = [
        "run.t_end=20",
        "run.grid_step=2",
        "run.digits=20",
        "run.level=enclosed",
        "run.transits=false",
    ]
    solution = reference.solve(reference.load_scene(name, rows), confirm="sampled")
    check = solution.checks[-1]
    assert solution.proof.confirmed == "sampled" and check.formulation in ("space", "spin")
    last = {column: Fraction(1, 10**places) for column, places in grid_decimals(solution).items()}
    assert check.position_m <= max(last[column] for column in "xyz") / 4


def test_an_interval_that_costs_more_digits_than_are_printed_is_confirmed_to_a_quarter_of_the_last(
    size,
):
    """From the digits printed of its first row this pendulum, released almost upside down, could be anywhere."""
    end = size("5", "7")
    run = [
        f"run.t_end={end}",
        f"run.grid_step={end}",
        "run.digits=3",
        "run.level=enclosed",
        "run.transits=false",
    ]
    release = {"angle": "179.9999999", "azimuth": "10"}
    scene = reference.parse_scene(
        {"id": "falling", "pendulum": {"length": "0.1"}, "release": release}
    ).with_values(run)
    assert digits_lost(scene.exact, tuple(scene.exact.grid), constants=False) > scene.run.digits
    assert reference.solve(scene, confirm="sampled").proof.confirmed == "sampled"
