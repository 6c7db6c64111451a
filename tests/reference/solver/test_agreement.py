"""Two runs that are one prove nothing; bounds are above zero, and hold in every column of grid and transits."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest
from mpmath import findroot, mpf, sqrt
from sampled import one_in
from small_scenes import make_scene

import reference
from reference.engines.plan import Plan
from reference.engines.registry import run
from reference.errors import IntegrationError
from reference.model.force import acceleration, force, tension
from reference.model.sections import form_of
from reference.model.start import Start
from reference.numbers.columns import GRID, SECTION, TRANSITS
from reference.numbers.precision import DOUBLE, real, to_fraction, to_mpf
from reference.numbers.table import Table
from reference.solver.agreement import (
    Agreement,
    bits_lacking,
    with_passage_errors,
    with_transit_errors,
    zeros_lacking,
)
from reference.solver.pilot import MARGIN_BITS

# in both runs these two once had the same number of limbs and, as steps were at their longest, the same steps
ONE_RUN_TWICE = make_scene(
    pendulum={"length": "0.230728425241"},
    site={"latitude": "-19.109114989775", "gravity": "1.75", "rotation_rate": "0", "inverse_flattening": "inf"},
    release={"x": "0", "y": "-3e-06", "vx": "-1.2623088e-05", "vy": "2.47212963009768e-06"},
    run={"t_end": "27.38", "grid_step": "0.684484", "digits": 25, "level": "self_consistent"},
)


# so small a swing that limbs, which count from the length of the cord, have not the bits for sixty digits of vz
BEYOND_LIMBS = make_scene(
    site={"rotation_rate": "0"},
    release={"x": "1e-25", "y": "0", "vx": "0", "vy": "1e-25"},
    run={"t_end": "30", "grid_step": "10", "digits": 60, "level": "self_consistent"},
)


@pytest.mark.parametrize(
    "scene",
    [BEYOND_LIMBS, pytest.param(ONE_RUN_TWICE, marks=pytest.mark.long)],
    ids=["beyond limbs", "at the longest steps"],
)
def test_a_tiny_swing_has_bounds_that_hold(scene):
    solution = reference.solve(scene)
    truth = run(Plan(scene.exact, "spin", real(512), solution.times, ("xdot",)))
    assert solution.directions == truth.directions
    for table, exact, columns in ((solution.grid, truth.grid, GRID), (solution.transits, truth.transits, TRANSITS)):
        gaps = table.only(columns).distance(exact)
        for name in columns:
            bounds = table.bound(name)
            assert min(bounds) > 0
            assert all(gap <= bound for gap, bound in zip(gaps.exact(name), bounds, strict=True)), name


def test_where_steps_are_at_their_longest_the_second_run_has_others():
    solution = reference.solve(ONE_RUN_TWICE, engine="limbs")
    (check,) = solution.checks
    assert solution.run.engine == check.engine == "limbs"
    assert check.steps > 1.02 * solution.run.steps


def test_a_run_does_not_confirm_itself(paris):
    alone = run(Plan(paris.exact, "spin", real(90), (Fraction(0), Fraction(10)), ("xdot",)))
    with pytest.raises(IntegrationError, match="the same run"):
        Agreement.between(alone, alone, 15)


UNCHANGING = {
    "y on the equator": {"site": {"latitude": "0"}, "release": {"x": "0.5", "y": "0"}},
    "x in the meridian": {"site": {"rotation_rate": "0"}, "release": {"x": "0", "y": "0.5"}},
    "straight down at a pole": {"site": {"latitude": "90"}, "release": {"x": "0", "y": "0"}},
    "no force": {"site": {"gravity": "0", "rotation_rate": "0"}, "release": {"x": "0", "y": "0"}},
}


@pytest.mark.parametrize("sections", one_in(3, UNCHANGING.values()), ids=UNCHANGING.keys())
@pytest.mark.parametrize("level", ["self_consistent", "confirmed"])
def test_what_never_changes_may_be_equal_in_both_runs(level, sections):
    """Exact zeros and constants: no error, and a bound above zero unless no rate at all is in the scene."""
    scene = make_scene(**sections, run={"t_end": "20", "digits": 15, "level": level})
    solution = reference.solve(scene)
    unchanging = [name for name in GRID if len(set(solution.grid.exact(name))) == 1]
    assert unchanging
    for name in unchanging:
        start = solution.grid.exact(name)[0]
        assert start == (-67 if name == "z" else 0)
        assert 0 < max(solution.grid.bound(name)) < Fraction(1, 10**14) or scene.exact.gravity == 0


TRANSIT_SCENES = {
    "short cord": {"pendulum": {"length": "0.01"}, "release": {"x": "0.003", "y": "0.004"}},
    "near the meridian": {"release": {"x": "1e-3", "y": "0.5"}, "site": {"rotation_rate": "1e-4"}},
    "conical": {"pendulum": {"length": "2"}, "release": {"angle": "70", "azimuth": "20", "azimuth_rate": "200"}},
    "drag": {"pendulum": {"length": "1", "drag": "0.05"}, "release": {"x": "0.003", "y": "0.004"}},
    "fast Earth": {
        "pendulum": {"length": "1"},
        "site": {"rotation_rate": "0.3", "equatorial_radius": "0"},
        "release": {"x": "0.003", "y": "0.004"},
    },
}


@cache
def transits_in_double(name):
    """Return a run in double, its largest errors on a dense grid, and those of its transits; the truth is far finer."""
    end = 5 if name == "short cord" else 20  # s; that one swings five times a second
    scene, times = make_scene(**TRANSIT_SCENES[name]), tuple(Fraction(k, 20) for k in range(20 * end + 1))
    rough = run(Plan(scene.exact, "momentum", DOUBLE, times, ("xdot",)))
    fine = run(Plan(scene.exact, "spin", real(120), times, ("xdot",)))
    assert rough.directions == fine.directions
    on_grid = rough.grid.only(GRID).distance(fine.grid).largest()
    return rough, on_grid, rough.transits.only(TRANSITS).distance(fine.transits)


@pytest.mark.parametrize("name", one_in(4, TRANSIT_SCENES))
def test_the_errors_of_transits_follow_from_those_of_the_grid(name):
    rough, on_grid, gaps = transits_in_double(name)
    table = with_transit_errors(rough, on_grid, None)
    assert len(table) > 1
    for column in TRANSITS:
        for gap, bound in zip(gaps.exact(column), table.bound(column), strict=True):
            assert gap <= bound < 10**6 * max(on_grid.values()), column


def test_the_errors_of_the_grid_as_they_are_do_not_bound_those_of_transits():
    _, on_grid, gaps = transits_in_double("short cord")
    assert gaps.largest()["ax"] > on_grid["vx"]


TURNING = make_scene(
    pendulum={"length": "1", "drag": "0.25"},
    site={"rotation_rate": "1.5", "equatorial_radius": "3"},
    run={"t_end": "10", "grid_step": "1"},
)


def test_the_errors_of_transits_are_the_sums_that_the_module_states():
    """A fast Earth and much drag, where each term counts; in exact fractions but for the norms."""
    made = run(Plan(TURNING.exact, "spin", DOUBLE, (Fraction(0), Fraction(10)), ("xdot",)))
    errors = {name: Fraction(k, 10**6) for name, k in zip(GRID, (3, 5, 7, 2, 11, 13), strict=True)}
    table = with_transit_errors(made, errors, None)
    k = Start.of(TURNING.exact, 200).k
    w, square, e = 2 * abs(k.rate) + k.drag, k.rate**2, {name: float(error) for name, error in errors.items()}
    states = made.transits.only(GRID)
    assert len(table) > 5
    for row, state in enumerate(zip(*(states.exact(name) for name in GRID), strict=True)):
        n, v = ([mpf(value) / k.length for value in part] for part in (state[:3], state[3:]))
        pull, (ax, ay, az), aside = force(n, v, k), acceleration(n, v, k), abs(n[0])
        of_x = abs(tension(n, v, k))
        of_r, of_v = square + aside * (norm(pull) + square), w + aside * (2 * norm(v) + w)
        off = of_x * e["x"] + of_r * (e["x"] + e["y"] + e["z"]) + of_v * (e["vx"] + e["vy"] + e["vz"])
        jerk = k.length * (of_x * abs(v[0]) + of_r * norm(v) + of_v * norm((ax, ay, az)))
        late = findroot(lambda t: (abs(ax) * k.length - off - jerk * t) * t - e["vx"], e["vx"] / abs(ax))  # noqa: B023
        expected = {
            "t": late,
            "x": e["x"] + abs(ax) * k.length * late**2,
            "y": e["y"] + abs(v[1]) * k.length * late,
            "z": e["z"] + abs(v[2]) * k.length * late,
            "vy": e["vy"] + abs(ay) * k.length * late,
            "ax": off + jerk * late,
        }
        for name, value in expected.items():
            assert float(table.bound(name)[row]) == pytest.approx(float(value), rel=1e-6), name


@cache
def passages_in_double():
    words = ("gate 30", "gate 70@0", "turn 50", "highest")
    return run(Plan(TURNING.exact, "spin", DOUBLE, (Fraction(0), Fraction(10)), words))


def form_and_rates(word, state):
    """What errors the form has for those of 1, its first and second rate, and the rates of the state, in SI units."""
    start = Start.of(TURNING.exact, 200)
    form, k, h = form_of(word, start), start.k, start.ctx.mpf("1e-30")
    n, v = ([to_mpf(value, start.ctx) / k.length for value in part] for part in state)
    acc = acceleration(n, v, k)
    n2, v2 = ([q + h * p for q, p in zip(part, rate, strict=True)] for part, rate in ((n, v), (v, acc)))
    first, later = (
        sum(p * q for p, q in zip((*form.a, *form.b), (*v, *a), strict=True))
        for v, a in ((v, acc), (v2, acceleration(n2, v2, k)))
    )
    parts = dict(zip(GRID, map(abs, (*form.a, *form.b)), strict=True))
    rates = {name: abs(rate) * k.length for name, rate in zip(GRID, (*v, *acc), strict=True)}
    return parts, abs(first) * k.length, abs(later - first) / h * k.length, rates


@pytest.mark.parametrize("word", ["gate 30", "gate 70@0", "turn 50", "highest"])
def test_the_errors_of_passages_follow_from_the_errors_of_the_form_and_its_rates(word):
    """And a time is unknown where its error may be as large as a quarter of the first rate over the second."""
    made = passages_in_double()
    table, _ = made.passages[word]
    ratios = dict(zip(GRID, (3, 5, 7, 2, 11, 13), strict=True))
    assert len(table) > 3
    for row, state in enumerate(zip(*(table.exact(name) for name in GRID), strict=True)):
        parts, slope, bend, rates = form_and_rates(word, (state[:3], state[3:]))
        late = 2 * sum(ratios[name] * part for name, part in parts.items()) / slope  # for one unit
        largest = slope / 4 / bend / late
        for unit in (largest / 10**5, largest * 0.9999, largest * 1.0001):
            errors = {name: to_fraction(ratio * unit) for name, ratio in ratios.items()}
            found = with_passage_errors(made, errors, word, None)
            if unit > largest:
                assert {found.bound(name)[row] for name in SECTION} == {10**9}
                continue
            expected = {"t": late * unit} | {n: (ratios[n] + rates[n] * late) * unit for n in GRID}
            for name, value in expected.items():
                assert float(found.bound(name)[row]) == pytest.approx(float(value), rel=1e-5), name


def test_no_error_of_a_time_is_below_the_last_bit_of_the_run():
    tiny = dict.fromkeys(GRID, Fraction(1, 10**40))
    rough, _, _ = transits_in_double("short cord")
    passages = passages_in_double()
    for table in (with_transit_errors(rough, tiny, None), with_passage_errors(passages, tiny, "highest", None)):
        for t, bound in zip(table.exact("t"), table.bound("t"), strict=True):
            assert float(bound / t) == pytest.approx(2.0**-53, rel=1e-6)


def test_zeros_lack_bits_where_directions_differ_or_a_number_has_not_its_digits(paris):
    witness = run(Plan(paris.exact, "spin", real(90), (Fraction(0), Fraction(10)), ("xdot",)))
    table, places = Table(SECTION, 8, [(500 << 8, *[0] * 6)]), dict.fromkeys(GRID, 9) | {"t": 2}
    later = Table(SECTION, 8, [((500 << 8) + 1, *[0] * 6)])
    missing, apart = zeros_lacking((table, [1]), (table, [1]), places, witness)
    assert (missing, apart.largest()["t"]) == (0, 0)
    missing, apart = zeros_lacking((table, [1]), (later, [1]), places, witness)
    assert (missing, apart.largest()["t"]) == (bits_lacking({"t": Fraction(1, 256)}, {"t": 2}), Fraction(1, 256))
    # half of the 90 bits
    assert zeros_lacking((table, [1]), (later, [-1]), places, witness) == (45, None)


def test_the_times_of_passages_have_the_decimals_of_the_latest_of_all_sections(paris):
    """Five digits of 117 s are two after the point, and 1/512 s is less than a quarter of a unit of the last."""
    times, words = (Fraction(0), Fraction(60), Fraction(120)), ("highest", "lowest")
    plans = (Plan(paris.exact, "momentum", real(bits), times, words) for bits in (136, 120))
    one, other = map(run, plans)
    early = {word: (replace(table, values=table.values[:3]), ways[:3]) for word, (table, ways) in one.passages.items()}

    def missing(**passages):
        table, ways = other.passages["highest"]
        late = table.values[0][0] + (1 << table.bits - 9)
        moved = {"highest": (replace(table, values=[(late, *table.values[0][1:]), *table.values[1:3]]), ways[:3])}
        found = replace(one, passages={"highest": early["highest"], **passages})
        return Agreement.between(found, replace(other, passages=other.passages | moved), 5).missing_bits

    assert missing() > 0 == missing(lowest=one.passages["lowest"])


@pytest.mark.parametrize("error", [Fraction(1, 10**40), Fraction(1, 10**16)])
@pytest.mark.parametrize("bits", [100, 200])
def test_no_error_of_a_transit_is_below_twice_the_difference_of_two_runs(error, bits):
    rough, _, _ = transits_in_double("short cord")
    rows, columns = range(1, len(rough.transits) + 1), range(1, len(TRANSITS) + 1)
    # of more bits than a double has, so that half of them are rounded down there
    apart = Table(TRANSITS, bits, [[2**bits * row * column // 10**12 for column in columns] for row in rows])
    table = with_transit_errors(rough, dict.fromkeys(GRID, error), apart)
    for name in TRANSITS:
        for bound, gap in zip(table.bound(name), apart.exact(name), strict=True):
            assert 2 * gap <= bound < 2 * gap * (1 + Fraction(1, 10**9)), name


@pytest.mark.parametrize("error", [Fraction(1, 2**200), Fraction(1, 2**60)])
def test_no_error_of_a_passage_is_below_twice_the_difference_of_two_runs(paris, error):
    plan = Plan(paris.exact, "momentum", DOUBLE, (Fraction(0), Fraction(60)), ("gate 30",))
    found = run(plan)
    passages, _ = found.passages["gate 30"]
    apart = Table(SECTION, 90, [[2**60 * (1 + k) for k in range(len(SECTION))]] * len(passages))
    table = with_passage_errors(found, dict.fromkeys(GRID, error), "gate 30", apart)
    for name in SECTION:
        for bound, gap in zip(table.bound(name), apart.exact(name), strict=True):
            assert 2 * gap <= bound < 2 * gap * (1 + Fraction(1, 10**9)), name


def norm(vector):
    return sqrt(sum(part**2 for part in vector))


def test_the_time_of_a_transit_that_only_grazes_zero_is_unknown(paris):
    """xdot may be off by as much as the whole swing has: no zero of it is certain."""
    solution = run(Plan(paris.exact, "momentum", DOUBLE, (Fraction(0), Fraction(60)), ("xdot",)))
    table = with_transit_errors(solution, dict.fromkeys(GRID, Fraction(1)), None)
    assert set(table.bound("t")) == {10**9}


@pytest.mark.parametrize(("units", "lacking"), [("1/4", 0), ("0.26", -1), ("1", 0), ("1.9", 1), ("1000", 10)])
def test_runs_agree_to_a_quarter_of_the_last_digit_and_else_lack_the_bits_of_the_rest(units, lacking):
    gap = Fraction(units) / 10**5
    found = bits_lacking({"x": Fraction(0), "y": gap}, {"x": 9, "y": 5})
    assert found == (lacking + MARGIN_BITS if gap > Fraction(1, 4) / 10**5 else 0)


def test_the_error_of_a_column_is_twice_the_difference_of_two_runs(paris):
    times = (Fraction(0), Fraction(30), Fraction(60))
    one, other = (run(Plan(paris.exact, "spin", number, times, ("xdot",))) for number in (DOUBLE, real(120)))
    found = Agreement.between(one, other, 12)
    gaps = one.grid.only(GRID).distance(other.grid).largest()
    assert found.errors == {name: 2 * gap for name, gap in gaps.items()}


@pytest.mark.parametrize("y", ["0.5", "0"])
def test_the_error_of_a_column_that_never_changes_is_the_last_bit_of_the_second_run(y):
    """Of the cord's length, and of the largest speed; where nothing moves, of the speed of a swing as wide as that."""
    scene = make_scene(pendulum={"length": "2"}, site={"rotation_rate": "0"}, release={"x": "0", "y": y})
    times = (Fraction(0), Fraction(1), Fraction(2))
    one, other = (run(Plan(scene.exact, "spin", number, times)) for number in (DOUBLE, real(120)))
    found = Agreement.between(one, other, 12).errors
    fastest = one.grid.largest()["vy"] or sqrt(scene.exact.gravity * 2)
    assert found["x"] == Fraction(2, 2**120)
    assert float(found["vx"] * 2**120) == pytest.approx(float(fastest), rel=1e-12)


def test_runs_that_find_other_transits_lack_half_their_bits_and_one_without_any_is_not_asked(paris):
    plans = (
        Plan(paris.exact, "spin", number, (Fraction(0), Fraction(60)), ("xdot",)) for number in (DOUBLE, real(120))
    )
    one, other = map(run, plans)
    found = Agreement.between(one, replace(other, directions=other.directions[:-1]), 12)
    assert (found.missing_bits, found.transits) == (60, None)
    found = Agreement.between(one, replace(other, transits=None, directions=[]), 12)
    assert (found.missing_bits != 60, found.transits) == (True, None)  # the grid alone tells
