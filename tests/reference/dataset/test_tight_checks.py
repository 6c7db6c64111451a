"""The checks of single rows allow what the bounds allow and hardly more, as the corners of their box tell."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from itertools import product
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from small_scenes import make_scene

import reference
from reference.dataset.checks import motion, physics, scene_check
from reference.dataset.files import read_files
from reference.dataset.sheets import NUMBERS, Sheet, binary64_sheet
from reference.engines.registry import engines
from reference.model.constants import constants
from reference.model.force import acceleration, invariant
from reference.model.start import Start
from reference.numbers.columns import GRID, POSITION, VELOCITY
from reference.numbers.precision import bits_of, context, fixed_decimal
from reference.numbers.table import Table, integers

ROW, WIDER = 3, 10**9  # bounds so wide that rounding, of which they consist, is nothing beside them


@pytest.fixture(scope="module")
def files(original):
    found = read_files(original)
    wide = {
        kind: {name: str(mpmath.mpf(bound) * WIDER) for name, bound in getattr(found.manifest.bounds, kind).items()}
        for kind in ("grid", "transits")
    }
    bounds = found.manifest.bounds.model_copy(update=wide)
    return replace(found, manifest=found.manifest.model_copy(update={"bounds": bounds}))


def state(files, kind, row, names):
    (numbers,) = list(files.tables[f"{kind}.csv"].numbers(names))[row : row + 1]
    return numbers, [Fraction(getattr(files.manifest.bounds, kind)[name]) for name in names]


def largest(quantity, numbers, bounds):
    """The largest change of a quantity over the corners of the box."""
    middle = quantity(*numbers)
    corners = product(*((q - b, q + b) for q, b in zip(numbers, bounds, strict=True)))
    return max(abs(quantity(*corner) - middle) for corner in corners)


def with_change(files, kind, column, by):
    sheet = files.tables[f"{kind}.csv"]
    rows, place = list(sheet.rows), sheet.header.index(column)
    row = list(rows[ROW])
    row[place] = fixed_decimal(Fraction(row[place]) + by, 60)
    rows[ROW] = tuple(row)
    return replace(files, tables={**files.tables, f"{kind}.csv": replace(sheet, rows=rows)})


def said(files, word):
    return any(word in sentence for sentence in physics.problems(files))


def of_bounds(files, *words):
    """Whether a sentence about the bounds on times holds all these words."""
    sentences = scene_check._bound_column(files, files.tables["transits.csv"])
    return any(all(word in sentence for word in words) for sentence in sentences)


def on_sphere(ctx, k, x, y, vx, vy):
    """The state whose z and vz follow from the others, below the pivot, over l."""
    x, y, vx, vy = (ctx.mpf(q.numerator) / q.denominator / k.length for q in map(Fraction, (x, y, vx, vy)))
    z = -ctx.sqrt(1 - x * x - y * y)
    return (x, y, z), (vx, vy, -(x * vx + y * vy) / z)


def exact(value):
    return Fraction(str(mpmath.nstr(value, 40)))


@pytest.mark.parametrize(("part", "found"), [(Fraction(99, 100), False), (Fraction(101, 100), True)])
@pytest.mark.parametrize("kind", ["grid", "transits"])
def test_the_distance_from_the_pivot_may_be_off_by_its_corners(files, kind, part, found):
    (x, y, z), bounds = state(files, kind, ROW, ("x", "y", "z"))
    allowed = largest(lambda x, y, z: x * x + y * y + z * z, (x, y, z), bounds)
    row = {"grid": "grid.csv: t = 180", "transits": "transits.csv: transit 4"}[kind]
    moved = with_change(files, kind, "z", part * allowed / (2 * z))
    assert said(moved, f"{row}: the bob is not at the distance") is found


@pytest.mark.parametrize(("part", "found"), [(Fraction(99, 100), False), (Fraction(101, 100), True)])
def test_the_velocity_may_leave_the_sphere_by_its_corners(files, part, found):
    numbers, bounds = state(files, "grid", ROW, GRID)
    allowed = largest(lambda x, y, z, u, v, w: x * u + y * v + z * w, numbers, bounds)
    assert said(with_change(files, "grid", "vz", part * allowed / numbers[2]), "not along the sphere") is found


@pytest.mark.parametrize(("part", "found"), [(Fraction(97, 100), False), (Fraction(108, 100), True)])
@pytest.mark.parametrize("kind", ["grid", "transits"])
def test_the_invariant_may_be_off_by_its_corners(files, kind, part, found):
    ctx = context(200)
    k = constants(files.scene.exact, ctx)

    def h(x, y, *v):
        return exact(invariant(*on_sphere(ctx, k, x, y, *(v if len(v) == 2 else (0, *v))), k))

    def allowed(kind, row):
        names = ("x", "y", "vx", "vy") if kind == "grid" else ("x", "y", "vy")
        return largest(h, *state(files, kind, row, names))

    (x, y, vy), _ = state(files, kind, ROW, ("x", "y", "vy"))
    vx = state(files, kind, ROW, ("vx",))[0] if kind == "grid" else []
    tiny = Fraction(1, 10**15)
    slope = (h(x + tiny, y, *vx, vy) - h(x, y, *vx, vy)) / tiny
    by = part * (allowed(kind, ROW) + allowed("grid", 0)) / slope
    assert said(with_change(files, kind, "x", by), "the invariant h differs") is found


@pytest.mark.parametrize(("part", "found"), [(Fraction(97, 100), False), (Fraction(108, 100), True)])
def test_the_acceleration_at_a_transit_may_be_off_by_its_corners(files, part, found):
    ctx = context(200)
    k = constants(files.scene.exact, ctx)
    numbers, bounds = state(files, "transits", ROW, ("x", "y", "vy"))
    own = largest(
        lambda x, y, vy: exact(acceleration(*on_sphere(ctx, k, x, y, 0, vy), k)[0] * k.length), numbers, bounds
    )
    allowed = own + Fraction(files.manifest.bounds.transits["ax"])
    assert said(with_change(files, "transits", "ax", part * allowed), "the equations of motion give") is found


@pytest.mark.parametrize("checked", [True, False])
@pytest.mark.parametrize(("part", "found"), [(Fraction(2), False), (Fraction("2.3"), True)])
def test_the_bound_of_a_time_is_at_most_twice_the_error_of_xdot_over_ax(files, part, found, checked):
    """The wide bound on xdot leaves all else far behind; bounds are rounded up to two digits, to a tenth at most."""
    (ax,), _ = state(files, "transits", ROW, ("ax",))
    late = part * Fraction(files.manifest.bounds.grid["vx"]) / abs(ax)
    if not checked:  # the level computed
        files = replace(files, manifest=files.manifest.model_copy(update={"cross_checks": []}))
    (old,) = list(files.tables["transits.csv"].numbers(("bound",)))[ROW]
    wide = with_change(files, "transits", "bound", late - old)
    assert of_bounds(wide, "transit 4: bound", "leave open") is found


@pytest.mark.parametrize(
    ("part", "grazes"), [(Fraction(99, 100), False), (Fraction(1), True), (Fraction(101, 100), True)]
)
def test_the_bound_of_a_time_may_be_anything_where_xddot_is_so_small_that_the_zero_may_graze(
    files, monkeypatch, part, grazes
):
    """ax² against twice the bound on xdot times the jerk."""
    (ax,), _ = state(files, "transits", ROW, ("ax",))
    jerk = part * ax**2 / (2 * Fraction(files.manifest.bounds.grid["vx"]))
    monkeypatch.setattr(scene_check, "largest_jerk", lambda _: jerk)
    wide = with_change(files, "transits", "bound", Fraction(10))
    assert of_bounds(wide, "transit 4: bound", "leave open") is not grazes


@pytest.mark.parametrize(
    ("part", "found"), [(Fraction("1.9"), False), (Fraction("2.2"), False), (Fraction("2.21"), True)]
)
def test_the_bound_of_a_time_may_be_twice_the_difference_of_the_runs(files, part, found):
    apart = Fraction(1, 1000)
    checks = [files.manifest.cross_checks[0].model_copy(update={"transit_s": text}) for text in ("0", "0.001", None)]
    manifest = files.manifest.model_copy(update={"cross_checks": checks})
    (old,) = list(files.tables["transits.csv"].numbers(("bound",)))[ROW]
    rounding = Fraction(11, 20 * 10 ** manifest.decimals["transits"]["t"])
    wide = with_change(replace(files, manifest=manifest), "transits", "bound", part * apart + rounding - old)
    assert of_bounds(wide, "transit 4: bound", "leave open") is found


@pytest.mark.parametrize(("part", "found"), [(Fraction(1), False), (Fraction(99, 100), True)])
def test_the_bound_of_a_time_is_at_least_half_a_unit_of_its_last_digit(files, part, found):
    half_unit = Fraction(1, 2 * 10 ** files.manifest.decimals["transits"]["t"])
    (old,) = list(files.tables["transits.csv"].numbers(("bound",)))[ROW]
    narrow = with_change(files, "transits", "bound", part * half_unit - old)
    assert of_bounds(narrow, "transit 4: bound", "less than half a unit") is found


@pytest.mark.parametrize(("by", "found"), [(1, True), (-1, False)])
def test_the_bound_of_all_times_is_the_largest_of_them(files, by, found):
    """All are alike but one."""
    sheet, old = files.tables["transits.csv"], "5.1e-18"
    alike = replace(sheet, rows=[(*row[:-1], old) for row in sheet.rows])
    bounds = files.manifest.bounds.model_copy(update={"transits": files.manifest.bounds.transits | {"t": old}})
    manifest = files.manifest.model_copy(update={"bounds": bounds})
    changed = replace(files, manifest=manifest, tables={**files.tables, "transits.csv": alike})
    changed = with_change(changed, "transits", "bound", by * Fraction(old) / 100)
    assert of_bounds(changed, "is not the largest bound of transits.csv") is found


def test_the_jerk_is_bounded_by_the_rates_of_the_largest_speed_of_the_swing_of_rotation_and_of_drag(files):
    """Released at 3 m/s and 0.4 m above the lowest point; the Earth turns by 0.001 rad/s."""
    scene = make_scene(
        pendulum={"length": "2", "drag": "0.01"},
        site={"rotation_rate": "0.001", "gravity": "5", "gravity_is": "effective"},
        release={"x": "1.2", "y": "0", "vx": "0", "vy": "3"},
    )
    v, w = math.sqrt(1.5**2 + 2 * (0.4 / 2 * 5 / 2 + 1e-6)), 0.012
    found = scene_check.largest_jerk(replace(files, scene=scene))
    assert float(found) == pytest.approx(8 * 2 * (5 / 2 + v**2 + w**2) * (v + w), rel=1e-12)


@pytest.mark.parametrize("name", ["over_top", "conical", "damped", "fast_pole", "weightless", "overdamped", "hard"])
def test_no_rate_of_xddot_exceeds_its_bound(files, name):
    golden = reference.load(name)
    k = Start.of(golden.scene.exact, 53).k.converted(float)
    n, v = (tuple(golden.grid[name] / k.length for name in names) for names in (POSITION, VELOCITY))
    jerks = np.abs(np.diff(acceleration(n, v, k)[0] * k.length)) / np.diff(golden.t)
    assert jerks.max() <= float(scene_check.largest_jerk(replace(files, scene=golden.scene)))


@pytest.mark.parametrize(
    ("bound", "decimals", "found"),
    [("0.124", 3, True), ("0.124", 4, False), ("0.125", 3, False)],
)
def test_a_column_has_its_digits_if_its_largest_number_is_more_than_eight_bounds(bound, decimals, found):
    """From 0.876 to 1.124: five digits are four or five after the point."""
    manifest = SimpleNamespace(
        digits=5, decimals={"grid": dict.fromkeys(GRID, decimals)}, bound=lambda *_: Fraction(bound)
    )
    grid = Sheet(GRID, [("0.5",) * 6, ("-1.0",) * 6, ("0.9",) * 6], {})
    said = list(scene_check._digits(SimpleNamespace(manifest=manifest, tables={"grid.csv": grid})))
    assert len(said) == 6 * found


def test_the_states_at_transits_are_those_printed_with_no_speed_to_the_east_and_none_given_upwards(files):
    made = physics._moments(files, "transits")
    assert not made.columns[3].any() and not made.columns[5].any()
    bounds = [files.manifest.bound("transits", name) for name in ("x", "y", "z", "vy")]
    assert [Fraction(bound, made.unit) for bound in made.bounds] == [*bounds[:3], 0, bounds[3], 0]


def test_the_motion_has_its_transits_sought_unless_the_scene_asks_for_none(files, monkeypatch):
    sought = []
    monkeypatch.setattr(type(engines()["limbs"]), "run", lambda _, plan, *_words: sought.append(plan.transits))
    monkeypatch.setattr(motion, "_compared", lambda *_: [])
    unasked = files.scene.with_values(["run.transits=false"])
    undecided = files.manifest.model_copy(update={"transits": "undecided intervals"})
    states_alone = {"grid.csv": files.tables["grid.csv"]}
    others = (replace(files, scene=unasked), replace(files, manifest=undecided), replace(files, tables=states_alone))
    for changed in (files, *others):
        assert motion.problems(changed) == ([], [])
    assert sought == [True, True, False, False, *[True] * 4]


def test_transits_that_are_none_are_not_looked_at(files):
    counts = files.manifest.counts.model_copy(update={"transits": 0})
    none = files.manifest.model_copy(update={"counts": counts})
    for check, column in ((physics.problems, "z"), (scene_check.table_problems, "bound")):
        broken = with_change(files, "transits", column, Fraction(1))
        empty = {**broken.tables, "transits.csv": replace(broken.tables["transits.csv"], rows=[])}
        for changed, seen in ((broken, True), (replace(broken, manifest=none, tables=empty), False)):
            found = [problem for problem in check(changed) if "binary64" not in problem]
            assert any("transits" in problem for problem in found) is seen, (check, found)


def in_a_swing(files, state, bounds, gravity="5"):
    """One state on a cord of 1 m."""
    scene = make_scene(pendulum={"length": "1"}, site={"rotation_rate": "0", "gravity": gravity})
    columns = [integers([int(Fraction(part) * 10**18)]) for part in state]
    return physics._Moments(replace(files, scene=scene), ["row"], columns, 10**18, bounds, 10**18, None)


@pytest.mark.parametrize("z", ["-0.7", "0.7"])
def test_h_is_taken_on_the_sphere_on_the_side_where_the_bob_is(files, z):
    """With x = 0.6 it is at ±0.8, and there vz = -0.6/z."""
    (h,) = in_a_swing(files, ("0.6", "0", z, "1", "2", "9"), [1] * 6).values(physics.invariant)
    exact = (5 + Fraction(3, 4) ** 2) / 2 + (4 if float(z) > 0 else -4)
    assert abs(h - exact) < Fraction(1, 4 ** bits_of(files.manifest.digits))


def test_beyond_the_sphere_nothing_tells_z_and_vz_is_that_of_the_row(files):
    (h,) = in_a_swing(files, ("0.9", "0.9", "0.5", "1", "2", "3"), [1] * 6).values(physics.invariant)
    assert h == 7


@pytest.mark.parametrize("y", [0, 1])
def test_a_row_may_leave_the_sphere_and_its_velocity_too_by_what_the_bounds_leave_to_the_last_bit(files, y):
    """25 is off 4² by 9, as 2·4·1 + 1² allows; and (3, 0, 4)·(3, 0, 1) is 13, as four bounds of 1 allow."""
    for bounds, found in (
        ([0, 0, 1, 0, 0, 0], physics._Moments.off_the_sphere),
        ([1, 0, 1, 1, 0, 1], physics._Moments.not_along_the_sphere),
    ):
        columns = [integers([part]) for part in (3, y, 4, 3, y, 1)]
        made = physics._Moments(files, ["row"], columns, 1, bounds, 4, None)
        assert len(list(found(made))) == y, found


@pytest.mark.parametrize(
    ("z", "deep"), [("0.25", False), ("-0.25", False), (f"0.25{'0' * 15}1", True), (f"-0.25{'0' * 15}1", True)]
)
def test_z_follows_from_x_and_y_where_it_is_more_than_a_quarter_of_the_cord(files, z, deep):
    assert in_a_swing(files, ("0.9", "0", z, "1", "2", "0"), [1] * 6)._deep.tolist() == [deep]


@pytest.mark.parametrize(
    ("state", "gravity", "slopes"),
    [
        (("0.6", "0", "-0.8", "1", "2", "0.75"), "5", (5.21484375, 1.875, 0, 1.5625, 2, 0)),
        (("0.6", "0", "-0.8", "1e-6", "0", "7.5e-7"), "0", (0, 0, 0, 1.5625e-6, 0, 0)),
    ],
    ids=["swing", "hardly moves"],
)
def test_h_may_be_off_by_its_slopes_along_the_sphere(files, state, gravity, slopes):
    """Where z = -√(1 - x² - y²) and vz = -(x vx + y vy)/z follow; differentiated by hand."""
    made = in_a_swing(files, state, [int(slope > 0) for slope in slopes], gravity)
    (allowed,) = made.allowed(physics.energy)
    assert float(allowed) == pytest.approx(1.05e-18 * sum(slopes), rel=1e-3, abs=0)


def test_h_at_a_transit_with_a_nearly_level_cord_may_be_off_by_the_slope_of_vz_over_z(files):
    """A millionth of the cord below the pivot: h = (y vy)²/(2 z²) + …, and its slope is 4e6 m/s²."""
    made = in_a_swing(files, ("0", "1", "-1e-6", "0", "2e-6", "0"), [0, 0, 1, 0, 0, 0])
    (allowed,) = replace(made, transits=files.tables["transits.csv"]).allowed(physics.energy)
    assert float(allowed) == pytest.approx(1.05e-18 * 4e6, rel=0.03, abs=0)


@pytest.mark.parametrize(("bound", "apart", "found"), [("0.5", "0", 0), ("0.4", "0", 12), ("0.25", "0.25", 0)])
def test_a_row_may_be_off_from_the_motion_by_its_bound_and_by_what_the_runs_are_apart_to_the_last_bit(
    bound, apart, found
):
    """Printed are 1.5 and -1.5, the motion has 1 and -2, in quarters."""
    sheet = Sheet(("t", *GRID), [("0", *["1.5"] * 6), ("1", *["-1.5"] * 6)], {})
    manifest = SimpleNamespace(bound=lambda *_: Fraction(bound))
    scene = SimpleNamespace(exact=SimpleNamespace(grid=[Fraction(0), Fraction(1)]))
    files = SimpleNamespace(manifest=manifest, scene=scene, tables={"grid.csv": sheet}, function=None)

    def compared(apart):
        tables = (Table(GRID, 2, [(4 + gap,) * 6, (-8,) * 6]) for gap in (int(4 * Fraction(apart)), 0))
        plan = SimpleNamespace(times=scene.exact.grid)
        runs = (SimpleNamespace(grid=table, transits=None, plan=plan) for table in tables)
        return motion._compared(files, *runs)

    assert len(compared(apart)) == found
    assert compared("0.75") is None


@pytest.mark.parametrize("transits", [True, False])
def test_two_runs_with_other_directions_of_transits_or_of_passages_do_not_decide(transits):
    states = Table(GRID, 0, [(0,) * 6])
    scene = SimpleNamespace(exact=SimpleNamespace(grid=[Fraction(0)]))
    files = SimpleNamespace(scene=scene, tables={"sections.csv": Sheet((), [], {})}, manifest=None)

    def found(*directions):
        own = {"transits": states, "directions": directions} if transits else {"transits": None}
        passages = {"highest": (states, [-1]), "lowest": (states, directions)}
        return SimpleNamespace(grid=states, plan=SimpleNamespace(times=[Fraction(0)]), passages=passages, **own)

    assert motion._compared(files, found(1, -1), found(-1, 1)) is None


@pytest.mark.parametrize(("beyond", "refuted"), [(0, False), (1, True)])
@pytest.mark.parametrize("side", [1, -1])
def test_a_possible_transit_is_refuted_where_xdot_cannot_come_near_zero_to_the_last_bit(
    files, monkeypatch, side, beyond, refuted
):
    """From 1 to 5 s, with 3 m/s² in the middle and a jerk of 5 m/s³, xdot changes by 2·3 + 5·2²/2 m/s and is 1 off."""
    limbs, bits = engines()["limbs"], 60
    middles = Table(("vx", "ax"), bits, [(0, 0), (side * ((17 << bits) + beyond), -3 << bits)])
    asked = []
    monkeypatch.setattr(type(limbs), "run", lambda _, plan: asked.append(plan) or SimpleNamespace(grid=middles))
    monkeypatch.setattr(motion, "largest_jerk", lambda _: Fraction(5))
    part = SimpleNamespace(from_s="1", to_s="5", parity="even")
    manifest = SimpleNamespace(possible=[part], bound=lambda *_: Fraction(1, 8), enclosure=None)
    plan, later = limbs.plan(files.scene.exact, 110, (Fraction(0),), ("xdot",)), Table(("t", "ax"), 0, [(6, 1)])
    outside, problems = motion._outside_intervals(SimpleNamespace(manifest=manifest), plan, later)
    assert (outside, bool(problems)) == ([0], refuted)
    assert [(plan.times, plan.transits) for plan in asked] == [((0, 3), False)]


@pytest.mark.parametrize(
    ("slopes", "parity", "refuted"),
    [([5], "odd", True), ([4], "odd", False), ([4], "even", True), ([5, 4], "unknown", True), ([4, 4], "even", False),
     ([4, 4], "odd", True), ([4, 4, 4], "odd", False), ([4], "unknown", False)],
)  # fmt: skip
def test_a_possible_transit_is_refuted_by_a_zero_that_xdot_surely_crosses_and_by_another_parity(
    files, monkeypatch, slopes, parity, refuted
):
    """Zeros of xdot with 1/4 m/s² or 5/16 m/s²; it surely crosses above the root of 1/16, near times jerk."""
    limbs = engines()["limbs"]
    middles = Table(("vx", "ax"), 4, [(0, 0), (0, 4)])
    monkeypatch.setattr(type(limbs), "run", lambda *_: SimpleNamespace(grid=middles))
    monkeypatch.setattr(motion, "largest_jerk", lambda _: Fraction(1, 16))
    part = SimpleNamespace(from_s="1", to_s="5", parity=parity)
    manifest = SimpleNamespace(possible=[part], bound=lambda *_: Fraction(1, 8), enclosure=None)
    plan = limbs.plan(files.scene.exact, 110, (Fraction(0),), ("xdot",))
    outside, problems = motion._outside_intervals(
        SimpleNamespace(manifest=manifest), plan, Table(("t", "ax"), 4, [(k << 4, s) for k, s in enumerate(slopes, 1)])
    )
    assert (outside, bool(problems)) == ([], refuted)


def test_vz_follows_from_the_others_where_z_is_deep_in_a_row_and_where_it_is_not_0_in_a_transit():
    """And all of a state is known but that of a transit with z within its bound."""
    z = np.array([0, 1, 250, 251, -1000], dtype=object)
    for transits, follows in ((None, [False, False, False, True, True]), ("a sheet", [False, True, True, True, True])):
        made = physics._Moments(None, [], [None, None, z], 1, [9, 9, 1], 1000, transits)
        assert made._follows.tolist() == follows
        assert made._whole.tolist() == [transits is None] * 2 + [True] * 3


def test_the_time_that_a_run_takes_is_told_by_the_fastest_rate_and_the_largest_speed(files, monkeypatch):
    """Rates of 2, 0.5 and 0.25 /s, and 3 m/s on a cord of 2 m, for 1000 s."""
    scene = make_scene(
        pendulum={"length": "2", "drag": "0.25"},
        site={"rotation_rate": "0.5", "gravity": "8", "gravity_is": "effective"},
        run={"t_end": "1000", "grid_step": "500"},
    )
    grid = Sheet(("vx", "vy", "vz"), [("0", "1", "-1"), ("1", "-1.5", "0.5")], {})
    own = replace(files, scene=scene, tables={"grid.csv": grid})
    assert motion._steps(own) == 4250
    monkeypatch.setattr(motion.function, "moments", lambda _: [])
    speeds = SimpleNamespace(vx=np.array([0.0, 1.0]), vy=np.array([1.0, -1.5]), vz=np.array([-1.0, 0.5]))
    function = None, SimpleNamespace(at=lambda _: speeds)
    assert motion._steps(replace(own, function=function, manifest=SimpleNamespace(alone=True))) == 4250


def test_the_most_bits_are_tried_once(files, monkeypatch):
    precs = []
    monkeypatch.setattr(motion, "_first_prec", lambda _: motion.MOST_PREC)
    monkeypatch.setattr(motion, "_run", lambda _files, prec, *_: precs.append(prec))
    monkeypatch.setattr(motion, "_compared", lambda *_: [])
    assert motion.problems(files) == ([], [])
    assert precs == [motion.MOST_PREC - motion.LIMB_BITS, motion.MOST_PREC]


@pytest.mark.parametrize(
    ("kind", "name", "own", "column", "bound"),
    [("grid", "t", "9", "9", 0.0), ("grid", "x", "9", "0.25", 0.25), ("transits", "t", "0.25", "9", 0.25),
     ("transits", "x", "9", "0.25", 0.25)],
)  # fmt: skip
def test_a_double_is_that_of_a_number_within_the_bound_of_its_column_or_of_its_own_time(kind, name, own, column, bound):
    for double, found in (
        *((end, False) for end in (1 - bound, 1 + bound)),
        *((end, True) for end in (math.nextafter(1 - bound, 0), math.nextafter(1 + bound, 2))),
    ):
        doubles = {other: double if other == name else 1.0 for other in NUMBERS[kind]}
        plain = Sheet((*doubles, "bound"), [(*("1.0" for _ in doubles), own)], {})
        manifest = SimpleNamespace(bound=lambda *_: Fraction(column))
        both = {"": plain, ".binary64": binary64_sheet(plain, {other: [number] for other, number in doubles.items()})}
        files = SimpleNamespace(manifest=manifest, tables={f"{kind}{word}.csv": sheet for word, sheet in both.items()})
        assert len(list(scene_check._doubles(files, kind))) == found, double
