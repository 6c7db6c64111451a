"""Two runs that are one prove nothing; bounds are above zero, and hold in every column of the grid and of zeros."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest
from mpmath import sqrt
from sampled import one_in
from small_scenes import make_scene

import reference
from reference.engines.plan import Plan
from reference.engines.registry import run
from reference.errors import IntegrationError
from reference.model.force import acceleration, force
from reference.model.sections import form_of
from reference.model.start import Start
from reference.numbers.columns import GRID, SECTION
from reference.numbers.precision import DOUBLE, real, to_fraction, to_mpf
from reference.numbers.table import Table
from reference.numbers.zeros import Zeros, columns_of
from reference.solver.agreement import Agreement, bits_lacking, with_zero_errors, zeros_lacking
from reference.solver.pilot import MARGIN_BITS

# in both runs these two once had the same number of limbs and, as steps were at their longest, the same steps
ONE_RUN_TWICE = make_scene(
    pendulum={"length": "0.230728425241"},
    site={
        "latitude": "-19.109114989775",
        "gravity": "1.75",
        "rotation_rate": "0",
        "inverse_flattening": "inf",
    },
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
    """Its height is beyond the digits of double, and so is the rate at which it is highest."""
    words = ("xdot", "gate 30", "highest")
    solution = reference.solve(scene, sections=words[1:])
    truth = run(Plan(scene.exact, "spin", real(512), solution.times, words))
    tables = [(solution.grid, truth.grid, GRID)]
    for word in words:
        found, exact = solution.zeros[word], truth.zeros[word]
        assert found.directions == exact.directions
        assert len(found.directions) > 1
        assert max(found.table.bound("t")) < Fraction(1, 10**15)
        tables.append((found.table, exact.table, columns_of(word)))
    for table, exact, columns in tables:
        gaps = table.only(columns).distance(exact)
        for name in columns:
            bounds = table.bound(name)
            assert min(bounds) > 0
            assert all(gap <= bound for gap, bound in zip(gaps.exact(name), bounds, strict=True)), (
                name
            )


def test_where_steps_are_at_their_longest_the_second_run_has_others():
    solution = reference.solve(ONE_RUN_TWICE, engine="limbs")
    (check,) = solution.checks
    assert solution.run.engine == check.engine == "limbs"
    assert check.steps > 1.02 * solution.run.steps


def test_a_run_does_not_confirm_itself(paris):
    alone = run(Plan(paris.exact, "spin", real(90), (Fraction(0), Fraction(10)), ("xdot",)))
    with pytest.raises(IntegrationError, match="gave the same numbers"):
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


ZERO_SCENES = {
    "short cord": {"pendulum": {"length": "0.01"}, "release": {"x": "0.003", "y": "0.004"}},
    "near the meridian": {"release": {"x": "1e-3", "y": "0.5"}, "site": {"rotation_rate": "1e-4"}},
    "conical": {
        "pendulum": {"length": "2"},
        "release": {"angle": "70", "azimuth": "20", "azimuth_rate": "200"},
    },
    "drag": {"pendulum": {"length": "1", "drag": "0.05"}, "release": {"x": "0.003", "y": "0.004"}},
    "fast Earth": {
        "pendulum": {"length": "1"},
        "site": {"rotation_rate": "0.3", "equatorial_radius": "0"},
        "release": {"x": "0.003", "y": "0.004"},
    },
}
WORDS = ("xdot", "gate 30", "gate 70@0", "turn 50", "highest")


@cache
def zeros_in_double(name):
    """Return a run in double, its largest errors on a dense grid, and by word those of its zeros.

    The truth is far finer.
    """
    end = 5 if name == "short cord" else 20  # s; that one swings five times a second
    scene = make_scene(**ZERO_SCENES[name])
    times = tuple(Fraction(k, 20) for k in range(20 * end + 1))
    rough = run(Plan(scene.exact, "momentum", DOUBLE, times, WORDS))
    fine = run(Plan(scene.exact, "spin", real(120), times, WORDS))
    gaps = {}
    for word in WORDS:
        assert rough.zeros[word].directions == fine.zeros[word].directions
        gaps[word] = rough.zeros[word].table.only(columns_of(word)).distance(fine.zeros[word].table)
    return rough, rough.grid.only(GRID).distance(fine.grid).largest(), gaps


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("name", one_in(4, ZERO_SCENES))
def test_the_errors_of_zeros_follow_from_those_of_the_grid(name, word):
    rough, on_grid, gaps = zeros_in_double(name)
    table = with_zero_errors(rough, on_grid, word, None)
    assert len(table) > 1
    for column in columns_of(word):
        for gap, bound in zip(gaps[word].exact(column), table.bound(column), strict=True):
            assert gap <= bound < 10**6 * max(on_grid.values()), column


def test_the_errors_of_the_grid_as_they_are_do_not_bound_those_of_transits():
    _, on_grid, gaps = zeros_in_double("short cord")
    assert gaps["xdot"].largest()["ax"] > on_grid["vx"]


TURNING = make_scene(
    pendulum={"length": "1", "drag": "0.25"},
    site={"rotation_rate": "1.5", "equatorial_radius": "3"},
    run={"t_end": "10", "grid_step": "1"},
)


@cache
def turning_in_double():
    return run(Plan(TURNING.exact, "spin", DOUBLE, (Fraction(0), Fraction(10)), WORDS))


def total(factors, errors):
    """Return the sum of products, each as large as it may be."""
    return sum(abs(p) * q for p, q in zip(factors, errors, strict=True))


class TermsOfErrors:
    """The terms that the module states for the errors of a zero, in mpmath and SI units, for errors on the grid.

    Attributes:
        form: the error of the form.
        rate: that of its rate.
        slope, bend: sizes of its rate and of its second rate.
        rates, second_rates: by column, those of the state.
    """

    def __init__(self, word, state, errors):
        start = Start.of(TURNING.exact, 200)
        form = form_of(word, start)
        k = start.k
        n, v = (
            [to_mpf(value, start.ctx) / k.length for value in part]
            for part in (state[:3], state[3:])
        )
        of_r, of_v = errors[:3], errors[3:]

        acc = acceleration(n, v, k)
        instant = start.ctx.mpf("1e-30")
        n_later = [q + instant * rate for q, rate in zip(n, v, strict=True)]
        v_later = [q + instant * rate for q, rate in zip(v, acc, strict=True)]
        acc_later = acceleration(n_later, v_later, k)
        jerk = [(after - before) / instant for before, after in zip(acc, acc_later, strict=True)]

        self.slope = abs(inner(form.a, v) + inner(form.b, acc)) * k.length
        self.bend = abs(inner(form.a, acc) + inner(form.b, jerk)) * k.length
        self.rates = {
            name: abs(rate) * k.length for name, rate in zip(GRID, (*v, *acc), strict=True)
        }
        self.second_rates = {
            name: abs(rate) * k.length for name, rate in zip(GRID, (*acc, *jerk), strict=True)
        }
        self.form = total(form.a, of_r) + total(form.b, of_v)

        # a·|Δv| + λ b·|Δr| + (|b| Ω² + |b·n| (|F| + Ω²)) |Δr| + (|b| w + |b·n| (2 |v| + w)) |Δv|
        pull = force(n, v, k)
        tension = abs(inner(v, v) + inner(n, pull))
        w = 2 * abs(k.rate) + k.drag
        b = norm(form.b)
        along = abs(inner(form.b, n))
        self.rate = total(form.a, of_v) + tension * total(form.b, of_r)
        self.rate += (b * k.rate**2 + along * (norm(pull) + k.rate**2)) * sum(of_r)
        self.rate += (b * w + along * (2 * norm(v) + w)) * sum(of_v)

    def largest(self, unit):
        """Return by how much the errors may grow before (slope - rate - bend late) late = form has no root."""
        half = self.slope * self.rate + 2 * self.bend * self.form
        return self.slope**2 / (half + sqrt(half**2 - (self.slope * self.rate) ** 2)) * unit

    def late(self):
        """Return the smaller root, from the larger one, which has no cancellation, and their product."""
        slope = self.slope - self.rate
        return 2 * self.form / (slope + sqrt(slope**2 - 4 * self.bend * self.form))


# the solver's second rate is a difference over 1e-6 of a radian; near the largest errors it counts ten times as much
NEAR = 1e-4


def inner(one, other):
    return sum(p * q for p, q in zip(one, other, strict=True))


@pytest.mark.parametrize("word", WORDS)
def test_the_errors_of_zeros_are_the_sums_that_the_module_states(word):
    """A fast Earth and much drag, where each term counts; a zero is unknown where its error has no bound."""
    made = turning_in_double()
    ratios = dict(zip(GRID, (3, 5, 7, 2, 11, 13), strict=True))
    table = made.zeros[word].table
    assert len(table) > 3
    for row, state in enumerate(zip(*(table.exact(name) for name in GRID), strict=True)):
        largest = TermsOfErrors(word, state, list(ratios.values())).largest(1)
        for unit in (largest / 10**5, largest * 0.99, largest * 1.01):
            errors = {name: to_fraction(ratio * unit) for name, ratio in ratios.items()}
            found = with_zero_errors(made, errors, word, None)
            if unit > largest:
                assert {found.bound(name)[row] for name in columns_of(word)} == {10**9}
                continue
            terms = TermsOfErrors(word, state, [ratio * unit for ratio in ratios.values()])
            late = terms.late()
            expected = {"t": late, "ax": terms.rate + terms.bend * late}
            for name in GRID:
                expected[name] = (
                    ratios[name] * unit
                    + terms.rates[name] * late
                    + terms.second_rates[name] * late**2
                )
            for name in columns_of(word):
                assert float(found.bound(name)[row]) == pytest.approx(
                    float(expected[name]), rel=NEAR
                ), name


@pytest.mark.parametrize("word", WORDS)
def test_no_error_of_a_time_is_below_the_last_bit_of_the_run(word):
    tiny = dict.fromkeys(GRID, Fraction(1, 10**40))
    table = with_zero_errors(turning_in_double(), tiny, word, None)
    for t, bound in zip(table.exact("t"), table.bound("t"), strict=True):
        assert bound >= t * Fraction(1, 2**53)
    rough, _, _ = zeros_in_double("short cord")
    table = with_zero_errors(rough, tiny, "xdot", None)
    for t, bound in zip(table.exact("t"), table.bound("t"), strict=True):
        assert float(bound / t) == pytest.approx(2.0**-53, rel=1e-6)


def test_zeros_lack_bits_where_directions_differ_or_a_number_has_not_its_digits(paris):
    witness = run(Plan(paris.exact, "spin", real(90), (Fraction(0), Fraction(10)), ("xdot",)))
    table, places = Table(SECTION, 8, [(500 << 8, *[0] * 6)]), dict.fromkeys(GRID, 9) | {"t": 2}
    later = Table(SECTION, 8, [((500 << 8) + 1, *[0] * 6)])
    missing, apart = zeros_lacking(Zeros(table, [1]), Zeros(table, [1]), places, witness)
    assert (missing, apart.largest()["t"]) == (0, 0)
    missing, apart = zeros_lacking(Zeros(table, [1]), Zeros(later, [1]), places, witness)
    assert (missing, apart.largest()["t"]) == (
        bits_lacking({"t": Fraction(1, 256)}, {"t": 2}),
        Fraction(1, 256),
    )
    # half of the 90 bits
    assert zeros_lacking(Zeros(table, [1]), Zeros(later, [-1]), places, witness) == (45, None)


def test_the_times_of_passages_have_the_decimals_of_the_latest_of_all_sections(paris):
    """Five digits of 117 s are two after the point, and 1/512 s is less than a quarter of a unit of the last."""
    times, words = (Fraction(0), Fraction(60), Fraction(120)), ("highest", "lowest")
    plans = (Plan(paris.exact, "momentum", real(bits), times, words) for bits in (136, 120))
    one, other = map(run, plans)
    highest, lowest = one.zeros["highest"], one.zeros["lowest"]
    early = Zeros(replace(highest.table, values=highest.table.values[:3]), highest.directions[:3])
    table, directions = other.zeros["highest"].table, other.zeros["highest"].directions
    late = table.values[0][0] + (1 << table.bits - 9)
    moved = Zeros(
        replace(table, values=[(late, *table.values[0][1:]), *table.values[1:3]]), directions[:3]
    )
    witness = replace(other, zeros=other.zeros | {"highest": moved})
    alone = Agreement.between(replace(one, zeros={"highest": early}), witness, 5)
    both = Agreement.between(replace(one, zeros={"highest": early, "lowest": lowest}), witness, 5)
    assert alone.missing_bits > 0 == both.missing_bits


@pytest.mark.parametrize("word", ["xdot", "gate 30"])
@pytest.mark.parametrize("error", [Fraction(1, 10**40), Fraction(1, 2**60)])
@pytest.mark.parametrize("bits", [100, 200])
def test_no_error_of_a_zero_is_below_twice_the_difference_of_two_runs(word, error, bits):
    rough, _, _ = zeros_in_double("short cord")
    rows = range(1, len(rough.zeros[word].table) + 1)
    columns = range(1, len(columns_of(word)) + 1)
    # of more bits than a double has, so that half of them are rounded down there
    apart = Table(
        columns_of(word),
        bits,
        [[2**bits * row * column // 10**12 for column in columns] for row in rows],
    )
    table = with_zero_errors(rough, dict.fromkeys(GRID, error), word, apart)
    for name in columns_of(word):
        for bound, gap in zip(table.bound(name), apart.exact(name), strict=True):
            assert 2 * gap <= bound < 2 * gap * (1 + Fraction(1, 10**9)), name


def norm(vector):
    return sqrt(sum(part**2 for part in vector))


@pytest.mark.parametrize("word", ["xdot", "gate 30", "highest"])
def test_the_time_of_a_zero_is_unknown_where_the_form_may_only_graze_it(paris, word):
    """A form may be off by as much as the whole swing has: no zero of it is certain."""
    found = run(Plan(paris.exact, "momentum", DOUBLE, (Fraction(0), Fraction(60)), (word,)))
    table = with_zero_errors(found, dict.fromkeys(GRID, Fraction(1)), word, None)
    assert set(table.bound("t")) == {10**9}


@pytest.mark.parametrize("word", WORDS)
def test_a_run_that_ends_before_the_first_zero_has_no_errors_of_zeros(paris, word):
    found = run(Plan(paris.exact, "momentum", DOUBLE, (Fraction(0), Fraction(1)), (word,)))
    table = with_zero_errors(found, dict.fromkeys(GRID, Fraction(1, 10**12)), word, None)
    assert (len(table), table.columns) == (0, columns_of(word))


@pytest.mark.parametrize(
    ("units", "lacking"), [("1/4", 0), ("0.26", -1), ("1", 0), ("1.9", 1), ("1000", 10)]
)
def test_runs_agree_to_a_quarter_of_the_last_digit_and_else_lack_the_bits_of_the_rest(
    units, lacking
):
    gap = Fraction(units) / 10**5
    found = bits_lacking({"x": Fraction(0), "y": gap}, {"x": 9, "y": 5})
    assert found == (lacking + MARGIN_BITS if gap > Fraction(1, 4) / 10**5 else 0)


def test_the_error_of_a_column_is_twice_the_difference_of_two_runs(paris):
    times = (Fraction(0), Fraction(30), Fraction(60))
    one, other = (
        run(Plan(paris.exact, "spin", number, times, ("xdot",))) for number in (DOUBLE, real(120))
    )
    found = Agreement.between(one, other, 12)
    gaps = one.grid.only(GRID).distance(other.grid).largest()
    assert found.errors == {name: 2 * gap for name, gap in gaps.items()}


@pytest.mark.parametrize("y", ["0.5", "0"])
def test_the_error_of_a_column_that_never_changes_is_the_last_bit_of_the_second_run(y):
    """Of the cord's length, and of the largest speed; where nothing moves, of the speed of a swing as wide as that."""
    scene = make_scene(
        pendulum={"length": "2"}, site={"rotation_rate": "0"}, release={"x": "0", "y": y}
    )
    times = (Fraction(0), Fraction(1), Fraction(2))
    one, other = (run(Plan(scene.exact, "spin", number, times)) for number in (DOUBLE, real(120)))
    found = Agreement.between(one, other, 12).errors
    fastest = one.grid.largest()["vy"] or sqrt(scene.exact.gravity * 2)
    assert found["x"] == Fraction(2, 2**120)
    assert float(found["vx"] * 2**120) == pytest.approx(float(fastest), rel=1e-12)


@pytest.mark.parametrize("word", ["xdot", "lowest"])
def test_runs_that_find_other_zeros_lack_half_their_bits_and_are_not_asked_for_more_than_the_first_has(
    paris, word
):
    times = (Fraction(0), Fraction(60))
    one, other = (
        run(Plan(paris.exact, "spin", number, times, (word,))) for number in (DOUBLE, real(120))
    )
    zeros = other.zeros[word]
    fewer = replace(other, zeros={word: zeros._replace(directions=zeros.directions[:-1])})
    found = Agreement.between(one, fewer, 12)
    assert (found.missing_bits, found.zeros, found.transit_s) == (60, {word: None}, None)
    found = Agreement.between(replace(one, zeros={}), fewer, 12)
    # the grid alone tells
    assert (found.missing_bits != 60, found.zeros, found.transit_s) == (True, {}, None)
