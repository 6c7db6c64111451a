"""Precision is chosen, confirmed and raised; hard scenes keep their digits; what cannot be had is refused."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import product

import numpy as np
import pytest
from sampled import one_in
from small_scenes import make_scene

import reference
from reference.dataset.sheets import grid_sheet, transits_sheet
from reference.engines.plan import Plan
from reference.engines.registry import run, run_both
from reference.errors import InputError, IntegrationError, UnreachableError
from reference.numbers.columns import GRID
from reference.numbers.precision import DOUBLE, LONG_DOUBLE, real
from reference.scenes.shipped import data_root
from reference.solver import pilot
from reference.solver import solve as solver


@pytest.fixture
def paris(paris):
    """Paris at the level of two runs; proofs have files of their own."""
    return paris.with_values(["run.level=confirmed"])


def by_higher_precision(scene, prec=256):
    """x, y, z, vx, vy, vz at the end from one run far finer than any under test, in yet another formulation."""
    done = run(Plan(scene.exact, "spin", real(prec), tuple(scene.exact.grid)))
    return [done.grid.exact(name)[-1] for name in GRID]


@cache
def after_five_minutes():
    return by_higher_precision(make_scene(run={"t_end": "300"}), 300)


HARD = {
    "3.1 rad": {"angle": "177.61691649055521", "azimuth": "30"},
    "80 degrees": {"angle": "80", "azimuth": "30"},
    "2 rad": {"angle": "114.59155902616464", "azimuth": "30"},
}


@pytest.mark.parametrize("release", one_in(3, HARD.values()), ids=HARD.keys())
def test_large_angles_keep_forty_digits(release, size):
    scene = make_scene(
        pendulum={"length": "1"}, release=release, run={"t_end": size("6", "60"), "digits": 40}
    )
    solution = reference.solve(scene)
    sheet = grid_sheet(solution)
    truth = by_higher_precision(scene)
    for name, text, exact in zip(sheet.header[1:], sheet.rows[-1][1:], truth, strict=True):
        unit = Fraction(1, 10 ** sheet.decimals[name])
        assert abs(Fraction(text) - exact) <= unit, name
        assert sheet.decimals[name] >= 39
    assert solution.checks[0].formulation == ("space" if release["angle"] == "80" else "spin")
    assert solution.checks[0].number != solution.run.number


# one, a double's and more digits; each level
PRINTED = [("computed", 1), ("self_consistent", 17), ("confirmed", 25)]
PRINTED += [
    pytest.param(level, digits, marks=pytest.mark.long)
    for level, digits in product(("computed", "self_consistent", "confirmed"), (1, 5, 12, 17, 25))
    if (level, digits) not in PRINTED
]


@pytest.mark.parametrize(("level", "digits"), PRINTED)
def test_the_last_printed_digit_is_off_by_at_most_one_at_every_level(level, digits):
    scene = make_scene(run={"t_end": "300", "digits": digits, "level": level})
    solution = reference.solve(scene)
    sheet, truth = grid_sheet(solution), after_five_minutes()
    for name, text, exact in zip(sheet.header[1:], sheet.rows[-1][1:], truth, strict=True):
        assert abs(Fraction(text) - exact) <= Fraction(1, 10 ** sheet.decimals[name])
        assert abs(solution.grid.exact(name)[-1] - exact) <= solution.grid.bound(name)[-1]


def test_the_bound_of_every_transit_holds_against_a_finer_run(paris, size):
    solution = reference.solve(paris, t_end=size("120", "600"), digits=20, level="confirmed")
    finer = run(Plan(solution.scene.exact, "spin", real(160), solution.times, ("xdot",)))
    exact = finer.transits.exact("t")
    sheet = transits_sheet(solution)
    assert len(exact) == len(sheet.rows) == size(14, 73)
    for row, t in zip(sheet.rows, exact, strict=True):
        assert abs(Fraction(row[1]) - t) <= Fraction(row[-1])


def test_the_bound_of_a_transit_is_the_error_of_xdot_over_ax(paris):
    solution = reference.solve(paris, t_end="60", digits=20)
    late, ax = solution.transits.bound("t"), solution.transits.exact("ax")
    speed = solution.grid.bound("vx")[0]
    for bound, slope in zip(late, ax, strict=True):
        assert bound >= speed / abs(slope) * Fraction(999, 1000)


def test_double_serves_where_few_digits_are_asked_and_real_where_many_are(paris):
    assert reference.solve(paris, t_end="60", digits=6, level="computed").run.number == "double"
    many = {"t_end": "60", "digits": 30, "level": "computed"}
    assert reference.solve(paris, **many, engine="heyoka").run.number.startswith("real")
    assert reference.solve(paris, **many, engine="limbs").run.number.startswith("limbs")
    # a minute is not worth numba's import
    assert reference.solve(paris, **many).run.number.startswith("real")
    with pytest.raises(InputError, match="engine"):
        reference.solve(paris, **many, engine="abacus")


def test_arrays_are_the_nearest_doubles_of_the_exact_values(paris):
    solution = reference.solve(paris, t_end="120", digits=25, level="self_consistent")
    assert solution.t.tolist() == [0, 60, 120]
    for name in ("x", "y", "z", "vx", "vy", "vz"):
        assert getattr(solution, name).tolist() == [
            float(value) for value in solution.grid.exact(name)
        ]
    with pytest.raises(
        AttributeError, match=r"a Solution has no attribute 'transit'; it has transits, "
    ):
        _ = solution.transit
    assert solution.exact("x") == solution.grid.exact("x")
    assert solution.exact("t") == list(solution.times)


def test_a_scene_may_be_given_by_id_by_path_and_as_mappings(paris, tmp_path):
    path, short = tmp_path / "paris.toml", {"t_end": "60", "digits": 10, "level": "computed"}
    path.write_text((data_root() / "scenes" / "paris.toml").read_text())
    expected = reference.solve(paris, **short).grid.values
    for given in ("paris", path, str(path), paris.model_dump()):
        assert reference.solve(given, **short).grid.values == expected
    assert len(reference.sweep("paris", ["run.t_end=60,61"])) == 2
    assert (
        reference.trajectory("paris", [0, 1]).tolist()
        == reference.trajectory(paris, [0, 1]).tolist()
    )
    for wrong, field in (
        (None, "scene"),
        (3, "scene"),
        ("pariss", "SCENE"),
        ({"id": "a"}, "release"),
    ):
        for call in (
            reference.solve,
            reference.sweep,
            lambda scene: reference.trajectory(scene, [0, 1]),
        ):
            with pytest.raises(InputError) as caught:
                call(wrong)
            assert caught.value.field == field


def test_transits_can_be_left_out_and_are_not_looked_for_where_xdot_is_zero(paris):
    assert len(reference.solve(paris, t_end="60", digits=10, transits=False).transits) == 0
    planar = make_scene(
        site={"rotation_rate": "0"},
        release={"x": "0", "y": "0.4"},
        run={"t_end": "60", "digits": 10},
    )
    assert reference.solve(planar).transits["t"].shape == (0,)


@pytest.mark.parametrize(
    "sections",
    [
        {"site": {"latitude": "90"}},
        pytest.param({"site": {"latitude": "0"}}, marks=pytest.mark.long),
        pytest.param({"site": {"latitude": "-33.9"}}, marks=pytest.mark.long),
        pytest.param({"site": {"rotation_rate": "0"}}, marks=pytest.mark.long),
        pytest.param({"site": {"rotation_rate": "0.001"}}, marks=pytest.mark.long),
        pytest.param(
            {"site": {"rotation_rate": "0.001", "gravity_is": "effective"}}, marks=pytest.mark.long
        ),
        {"pendulum": {"drag": "0.01"}},
        {
            "site": {"gravity": "0", "rotation_rate": "0"},
            "release": {"x": "1", "y": "1", "vx": "1", "vy": "0"},
        },
        {"release": {"x": "0", "y": "0"}},
        pytest.param({"release": {"x": "1e-9", "y": "0"}}, marks=pytest.mark.long),
    ],
    ids=[
        "pole",
        "equator",
        "south",
        "no rotation",
        "fast Earth",
        "fast Earth, effective",
        "drag",
        "no force",
        "straight down",
        "tiny",
    ],
)
def test_every_kind_of_scene_is_confirmed_to_thirty_digits(sections, size):
    scene = make_scene(**sections, run={"t_end": size("30", "120"), "digits": 30})
    solution = reference.solve(scene)
    truth = by_higher_precision(scene, 300)
    for name, exact in zip(solution.grid.columns, truth, strict=True):
        assert abs(solution.grid.exact(name)[-1] - exact) <= solution.grid.bound(name)[-1]


@pytest.mark.parametrize("level", ["confirmed", pytest.param("enclosed", marks=pytest.mark.long)])
def test_effective_gravity_is_the_pivot_on_the_axis_to_the_last_bit(level):
    """Two engines agree on it, and a proof; a pivot on the axis has no centrifugal force that g could contain."""
    run = {"t_end": "120", "digits": "30", "level": level}
    fast = {"rotation_rate": "0.01", "altitude": "100"}
    effective = reference.solve(make_scene(site={**fast, "gravity_is": "effective"}, run=run))
    on_axis = reference.solve(
        make_scene(site={**fast, "equatorial_radius": "0", "altitude": "0"}, run=run)
    )
    assert len(effective.transits) > 0
    assert [effective.grid.exact(name) for name in GRID] == [
        on_axis.grid.exact(name) for name in GRID
    ]
    assert effective.transits.exact("t") == on_axis.transits.exact("t")
    otherwise = reference.solve(
        make_scene(site=fast, run=run | {"digits": "9", "level": "computed"})
    )
    assert abs(effective.x[-1] - otherwise.x[-1]) > 1e-3


def test_precision_is_raised_when_the_first_guess_is_too_low():
    """Of a swing of a nanometre: the first two runs do not agree to so many digits."""
    solution = reference.solve("nanometre", t_end="20", digits=30, level="confirmed")
    assert solution.discarded_s > 0
    truth = by_higher_precision(solution.scene, 400)
    for name, exact in zip(GRID, truth, strict=True):
        assert abs(solution.grid.exact(name)[-1] - exact) <= solution.grid.bound(name)[-1], name
    assert max(solution.grid.bound("x")) < Fraction(1, 10**39)


def test_two_cheap_runs_give_the_states_at_any_times_and_their_distance_as_the_error(paris):
    solution = solver.roughly(paris, [Fraction(90), Fraction(1, 4), Fraction(37)])
    assert solution.times == (0, Fraction(1, 4), 37, 90)
    assert (solution.level, solution.pilot_s) == ("confirmed", 0)
    assert (solution.run.number, solution.checks[0].number) == ("long_double", "double")
    truth = run(Plan(paris.exact, "spin", real(160), solution.times, ("xdot",)))
    for table, finer in ((solution.grid, truth.grid), (solution.transits, truth.transits)):
        gaps = table.distance(finer)
        for name in table.columns:
            both = zip(gaps.exact(name), table.bound(name), strict=True)
            assert all(gap <= bound < Fraction(1, 10**9) for gap, bound in both), name


def test_two_cheap_runs_that_diverge_give_nothing_and_those_of_too_many_steps_are_refused():
    """Released 1e-12 degrees from the top, double and long double fall at other times."""
    top = {"release": {"angle": "179.999999999999", "azimuth": "30"}, "run": {"t_end": "60"}}
    scene = make_scene(pendulum={"length": "1"}, site={"rotation_rate": "0"}, **top)
    assert solver.roughly(scene, [Fraction(60)]) is None
    stiff = reference.load_scene("creeping", ["run.transits=false"])
    with pytest.raises(UnreachableError, match="Stiff"):
        solver.roughly(stiff, [Fraction(10**7)])
    with pytest.raises(UnreachableError, match="out of reach"):
        solver.roughly(reference.load_scene("paris"), [Fraction(10**12)])


@pytest.mark.parametrize(
    ("asked", "times"), [([], [0, 60]), ([0], [0, 60]), ([17], [0, 17]), ([90, 17], [0, 17, 90])]
)
def test_a_scene_is_solved_at_the_times_asked_for_and_at_one_other_at_least(paris, asked, times):
    solution = solver.solve_at(paris, [*map(Fraction, asked)], 12)
    assert list(solution.times) == times
    assert (solution.level, solution.scene.run.digits, solution.zeros) == (
        "self_consistent",
        12,
        {},
    )


def test_what_a_proof_and_ranges_are_asked_for_they_have_and_else_it_is_refused(paris):
    wishes = {"audit": True, "confirm": "sampled", "function": True}
    short = {"t_end": "60", "engine": "limbs"}
    solution = reference.solve(paris, **short, level="enclosed", digits=15, **wishes)
    assert (solution.level, solution.run.engine) == ("enclosed", "limbs")
    assert (solution.proof.audited, solution.proof.confirmed) == (True, "sampled")
    assert solution.function is not None
    ranges = reference.prove_ranges(paris, {"length": "±0.001"}, **short)
    assert (ranges.scene.run.level, ranges.engine, ranges.derivatives) == (
        "enclosed",
        "limbs",
        False,
    )
    assert ranges.uncertain == {"pendulum.length": "0.001"}
    for wish in wishes.items():
        with pytest.raises(InputError, match="the level enclosed"):
            reference.solve(paris, **dict([wish]))
    with pytest.raises(InputError, match="confirm"):
        reference.solve(paris, level="enclosed", confirm="all")


def test_two_runs_that_never_agree_are_refused_and_give_no_numbers(monkeypatch, paris):
    """No scene is known where they do not agree: a run lies here, and no argument of `solve` brings it in."""
    honest = solver.run_both

    def wrong(fine, coarse, *rest):
        one, other = honest(fine, coarse, *rest)
        grid = other.grid
        off = [tuple(value + 2 ** (grid.bits - 40) for value in row) for row in grid.values]
        return one, replace(other, grid=replace(grid, values=off))

    monkeypatch.setattr(solver, "run_both", wrong)
    with pytest.raises(UnreachableError) as caught:
        reference.solve(paris, t_end="60", digits=15)
    assert caught.value.exit_status == 3


def test_an_engine_whose_runs_come_no_nearer_is_replaced():
    """limbs count from the length of the cord: they have not the bits for so many digits of so small a swing."""
    tiny = {"x": "1e-25", "y": "0", "vx": "0", "vy": "1e-25"}
    run_ = {"t_end": "30", "grid_step": "10", "digits": 60, "level": "self_consistent"}
    solution = reference.solve(
        make_scene(site={"rotation_rate": "0"}, release=tiny, run=run_), engine="limbs"
    )
    assert (solution.run.engine, solution.checks[0].engine) == ("heyoka", "heyoka")
    assert solution.discarded_s > 0


SECOND = [  # level, engine and digits; the engine and the formulation of the second run
    ("confirmed", "heyoka", 12, "heyoka", "space"),
    ("confirmed", "limbs", 25, "heyoka", "space"),
    ("self_consistent", "limbs", 25, "limbs", "inertial"),
    ("self_consistent", "heyoka", 12, "heyoka", "momentum"),
]


@pytest.mark.parametrize(("level", "engine", "digits", "other", "formulation"), SECOND)
def test_a_level_has_the_second_run_that_it_is_named_for(
    paris, level, engine, digits, other, formulation
):
    """By another formulation, or at least in other steps: by an engine's own it would agree with itself."""
    solution = reference.solve(paris, t_end="60", digits=digits, level=level, engine=engine)
    (check,) = solution.checks
    assert (solution.run.engine, check.engine, check.formulation) == (engine, other, formulation)
    assert (check.formulation == solution.run.formulation) == (level == "self_consistent")
    assert check.number != solution.run.number
    assert (check.order, check.steps) != (solution.run.order, solution.run.steps)


def test_a_scene_that_loses_every_digit_of_double_is_measured_with_more():
    """Released 1e-12 degrees from the top: the runs in double and long double diverge completely."""
    scene = make_scene(
        pendulum={"length": "1"},
        site={"rotation_rate": "0"},
        release={"angle": "179.999999999999", "azimuth": "30"},
        run={"t_end": "30", "digits": 20},
    )
    assert pilot.run_pilot(scene.exact, tuple(scene.exact.grid)).prec > LONG_DOUBLE.prec
    solution = reference.solve(scene)
    truth = by_higher_precision(scene, 400)
    assert abs(solution.grid.exact("x")[-1] - truth[0]) <= solution.grid.bound("x")[-1]


def test_a_wrong_field_is_refused_before_anything_runs(paris):
    with pytest.raises(InputError, match=r"run\.digits"):
        reference.solve(paris, digits=0)


def test_two_processes_give_what_one_gives(monkeypatch, paris):
    fine = Plan(paris.exact, "momentum", real(120), (Fraction(0), Fraction(120)), ("xdot",))
    coarse = replace(fine, formulation="space", number=real(100))
    seen: list[float] = []
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0}, raising=False)
    alone = run_both(fine, coarse, 10**9, seen.append)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1}, raising=False)
    together = run_both(fine, coarse, 10**9, seen.append)
    for one, other in zip(alone, together, strict=True):
        assert one.grid == other.grid
        assert one.transits == other.transits
    assert 0 < max(seen) <= 120


def test_two_runs_report_by_what_they_cost(monkeypatch, paris):
    """A run in double before one in many digits: half of the reports, and a tenth of the work."""
    times = (Fraction(0), Fraction(4000))
    cheap = Plan(paris.exact, "momentum", DOUBLE, times)
    costly = replace(cheap, number=real(120))
    seen: list[float] = []
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0}, raising=False)
    run_both(cheap, costly, 10**9, seen.append)
    assert seen == sorted(seen)
    assert seen[len(seen) // 4] < 0.15 * 4000


def test_a_run_reports_its_second_pass_for_sections_too(paris):
    """The run itself is a seventh of the work."""
    times = (Fraction(0), Fraction(2000))
    alone = Plan(paris.exact, "momentum", DOUBLE, times, ("xdot",))
    with_section = replace(alone, zeros=("xdot", "highest"))
    first_pass: list[float] = []
    both: list[float] = []
    run(alone, first_pass.append)
    run(with_section, both.append)
    assert both == sorted(both)
    assert len(both) > len(first_pass)
    assert both[len(first_pass) - 1] <= 2000 / 7
    assert both[-1] > 0.9 * 2000


def test_an_error_in_the_second_process_arrives_in_the_first(paris):
    good = Plan(paris.exact, "momentum", DOUBLE, (Fraction(0), Fraction(60)))
    lost = make_scene(pendulum={"length": "1e-300"}, release={"angle": "170", "azimuth": "10"})
    bad = Plan(lost.exact, "space", DOUBLE, (Fraction(0), Fraction(10**6)))
    with pytest.raises(IntegrationError):
        run_both(good, bad, 10**9)


@pytest.mark.long  # in every run test_sensitivity.py compares the two golden datasets
def test_the_readings_differ_by_what_rounding_the_inputs_does(paris):
    """Rounding the inputs of Paris to binary64 alone moves the bob by 5e-13 m in a day, and by 1e-13 m in six hours."""
    ends = [
        reference.solve(
            paris.with_values([f"inputs={reading}"]),
            t_end="21600",
            digits=11,
            level="computed",
            transits=False,
        ).x[-1]
        for reading in ("decimal", "binary64")
    ]
    assert 1e-14 < abs(np.subtract(*ends)) < 5e-12


SCRIPT = """
import sys, reference, reference.engines.registry
reference.engines.registry.WORTH_A_PROCESS = 0.0
for level in sys.argv[1:]:
    solution = reference.solve(reference.load_scene("paris"), t_end="60", digits=20, level=level)
    print(level, len(solution.directions))
"""


def test_a_plain_script_without_a_main_guard_may_use_both_cores(tmp_path, size):
    script, levels = tmp_path / "mine.py", size(["confirmed"], ["confirmed", "enclosed"])
    script.write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, str(script), *levels], capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr) == ("".join(f"{level} 7\n" for level in levels), "")
