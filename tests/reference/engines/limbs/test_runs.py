"""Whole runs in limbs beside heyoka's `real` at more bits: every scene that may be nasty, grid and transits."""

from __future__ import annotations

import os
import subprocess
import sys
from fractions import Fraction

import mpmath
import numpy as np
import pytest

pytest.importorskip("numba")

from limbs_states import states
from sampled import one_in
from small_scenes import make_scene, run_in_limbs

from reference import load, load_scene
from reference.engines.limbs.size import MOST_PREC
from reference.engines.plan import Plan
from reference.engines.registry import run
from reference.errors import InputError, IntegrationError
from reference.numbers.columns import POSITION, STATE, VELOCITY
from reference.numbers.precision import real

PARIS = {"release": {"x": "0.3", "y": "0.4"}}
SCENES = {
    "paris": PARIS,
    "pole": {"site": {"latitude": "90"}},
    "equator": {"site": {"latitude": "0"}},
    "no_rotation": {"site": {"rotation_rate": "0"}},
    "drag": {"pendulum": {"drag": "0.03"}},
    "fast_earth": {"site": {"rotation_rate": "0.05"}},
    "fast_earth_with_drag": {"site": {"rotation_rate": "0.05"}, "pendulum": {"drag": "0.1"}},
    "overdamped": {"pendulum": {"drag": "5"}},
    "from_the_meridian": {"release": {"x": "0", "y": "0.5"}},
    "off_the_vertical": {"release": {"x": "0", "y": "0"}},
    "pushed": {"release": {"x": "0.3", "y": "0.4", "vx": "0.067", "vy": "0.01"}},
    "tiny": {"release": {"x": "1e-9", "y": "2e-9"}},
    "whirling": {
        "pendulum": {"length": "1"},
        "release": {"angle": "90", "azimuth": "45", "azimuth_rate": "200"},
    },
    "two_radian": {"release": {"angle": "114.6", "azimuth": "30"}},
    "near_inverted": {"pendulum": {"length": "1"}, "release": {"angle": "177.6", "azimuth": "30"}},
    "from_the_top": {
        "pendulum": {"length": "1"},
        "site": {"rotation_rate": "0"},
        "release": {"angle": "179.999999999999", "azimuth": "30"},
    },
    "without_gravity": {
        "site": {"gravity": "0"},
        "release": {"x": "1", "y": "0.5", "vx": "1", "vy": "2"},
    },
}
TIMES = tuple(Fraction(7 * k, 5) for k in range(26))
# gravity is a thousand times the usual: a tenth of the time will do
FAST = {"fast_earth", "fast_earth_with_drag"}
CASES = [(name, 45) for name in SCENES] + [
    ("paris", 32),
    ("paris", 60),
    ("near_inverted", 32),
    ("near_inverted", 60),
]
CASES += [("from_the_top", digits) for digits in range(30, 60, 4)]
SPARE = 8  # times what heyoka loses at the same precision: the conditioning of the scene, measured
FLOOR_BITS = 6


@pytest.mark.parametrize(("name", "digits"), one_in(6, CASES))
def test_a_run_loses_no_more_than_the_scene_does_to_heyoka(name, digits):
    scene, prec = make_scene(**SCENES[name]), int(digits * 3.33) + 4
    times = tuple(t / 10 for t in TIMES) if name in FAST else TIMES
    ours = run_in_limbs(scene, prec, times)
    same, finer = (
        run(Plan(scene.exact, "momentum", real(bits), times, zeros))
        for bits, zeros in ((prec, ()), (prec + 40, ("xdot",)))
    )
    lost, gaps = (finer.grid.distance(one.grid).largest() for one in (same, ours))
    sizes = finer.grid.largest()

    def allowed(columns):
        return SPARE * max(lost[c] for c in columns) + max(sizes[c] for c in columns) * Fraction(
            2
        ) ** (FLOOR_BITS - prec)

    # z is of the size of l, and its error is x's
    position = allowed(POSITION[:2] if name == "tiny" else POSITION)
    assert max(gaps[c] for c in POSITION) <= position
    assert max(gaps[c] for c in VELOCITY) <= allowed(VELOCITY)
    assert ours.directions == finer.directions
    late = finer.transits.distance(ours.transits).exact("t")
    for gap, ax in zip(late, ours.transits.exact("ax"), strict=True):
        assert gap <= 4 * allowed(VELOCITY) / abs(ax) + times[-1] * Fraction(2) ** (
            FLOOR_BITS - prec
        )


def test_an_hour_of_paris_keeps_32_digits_and_all_transits():
    """Of the dataset that ships, which heyoka has confirmed."""
    golden = load("paris")
    ours = run_in_limbs(golden.scene, 113, golden.times[:61])
    for column in POSITION:
        pairs = zip(ours.grid.exact(column), golden.exact(column)[:61], strict=True)
        assert max(abs(one - other) for one, other in pairs) < Fraction(1, 10**34)
    assert ours.directions == golden.directions[:438]
    assert golden.transits["t"][437] < 3600 < golden.transits["t"][438]


# x at 60 s and the time of the last transit, over 2**bits
LAST_BITS = [
    (
        "paris",
        144,
        -36268305333018921436294805793869037690655526744389162058645504,
        11832105910695557760604700125233616012909773165744633017656147968,
    ),
    (
        "paris",
        200,
        -638038774934153857098053788874091864835509666482751358481416791084788350976,
        208152608478190457627755250572351427114063419578974919742545156203598267285504,
    ),
    (
        "laboratory_drag",
        144,
        14485087720797840423574155245337477419864573577410025676079104,
        12181907731313432610532512113166317828255219244646870849549238272,
    ),
]


@pytest.mark.parametrize(
    ("name", "prec", "x", "t"), LAST_BITS, ids=[f"{name} {prec}" for name, prec, _, _ in LAST_BITS]
)
def test_a_dataset_made_again_has_the_last_bits_that_it_had(name, prec, x, t):
    """Sums of products are exact in any order, so that a faster loop changes no bit of any dataset."""
    scene = load_scene(name).with_values(["run.t_end=60"])
    ours = run_in_limbs(scene, prec, scene.exact.grid)
    assert ours.grid.values[-1][0] == x
    assert ours.transits.values[-1][0] == t


def test_a_quarter_period_is_that_of_the_elliptic_integral():
    scene = make_scene(
        site={"rotation_rate": "0", "gravity": "9.81"},
        pendulum={"length": "2"},
        release={"angle": "150", "azimuth": "0"},
    )
    ctx = mpmath.mp.clone()
    ctx.dps = 60
    quarter = ctx.sqrt(ctx.mpf(2) / ctx.mpf("9.81")) * ctx.ellipk(ctx.sinpi(ctx.mpf(75) / 180) ** 2)
    time = Fraction(int(ctx.floor(quarter * 2**190)), 2**190)
    result = run_in_limbs(scene, 160, (Fraction(0), time), zeros=())
    x, y, z = (
        ctx.mpf(value) / 2**result.grid.bits for value in result.grid.only(POSITION).values[1]
    )
    assert abs(x) < 1e-44
    assert y == 0
    assert abs(z + 2) < 1e-44


def test_xdot_identically_zero_gives_no_transits():
    scene = make_scene(site={"rotation_rate": "0"}, release={"x": "0", "y": "0.5"})
    result = run_in_limbs(scene, 113, TIMES)
    assert result.transits is None
    assert result.zeros == {}
    assert not any(result.grid["x"])


def test_a_transit_after_the_last_time_is_not_reported():
    scene = make_scene(**PARIS)
    every = run_in_limbs(scene, 113, TIMES)
    third = every.transits.exact("t")[2]
    for end, count in ((third - Fraction(1, 10**9), 2), (third + Fraction(1, 10**9), 3)):
        cut = run_in_limbs(scene, 113, (Fraction(0), end))
        assert len(cut.transits) == count


def test_more_bits_than_there_can_be_are_refused():
    scene = make_scene(**PARIS)
    with pytest.raises(InputError, match="heyoka"):
        run_in_limbs(scene, MOST_PREC + 1, TIMES, zeros=())


def test_a_transit_that_only_grazes_is_refused():
    # swinging exactly north-south at the pole of a slow Earth, xdot is far below the precision at every turn
    scene = make_scene(
        site={"latitude": "90", "rotation_rate": "1e-300"},
        release={"x": "0", "y": "0.5"},
        pendulum={"length": "2"},
    )
    with pytest.raises(IntegrationError):
        run_in_limbs(scene, 113, TIMES)


def test_the_report_says_how_far_a_run_is():
    reports = []
    times = tuple(Fraction(3000 * k) for k in range(5))
    run_in_limbs(make_scene(**PARIS), 80, times, zeros=(), report=reports.append)
    assert reports == sorted(reports)
    assert 0 < reports[0] < reports[-1] < 12000


def test_states_are_double_doubles_of_a_finer_run():
    scene = make_scene(**PARIS)
    moments = np.linspace(0, 3600, 1001)
    high, low = states(scene.exact, moments)
    assert high.shape == low.shape == (1001, 6)
    assert (np.abs(low) <= np.spacing(np.abs(high))).all()
    times = tuple(Fraction(float(t)) for t in moments)
    fine = run_in_limbs(scene, 150, times, zeros=())
    for j, name in enumerate(STATE):
        for i, value in list(enumerate(fine.grid.exact(name)))[::10]:
            exact = Fraction(float(high[i, j])) + Fraction(float(low[i, j]))
            assert abs(exact - value) < Fraction(1, 10**28)


@pytest.mark.parametrize("times", [[], [1.0, 1.0], [-1.0, 2.0], [0.0, float("nan")], [[1.0]]])
def test_times_that_are_no_increasing_list_are_refused(times):
    with pytest.raises(InputError, match="times"):
        states(make_scene(**PARIS).exact, times)


SHORT = """
from fractions import Fraction
from reference import load_scene
from reference.engines.registry import engines
times = tuple(Fraction(7 * k, 5) for k in range(40))
limbs = engines()["limbs"]
result = limbs.run(limbs.plan(load_scene("paris").exact, 113, times, ("xdot",)))
print((result.grid.values, result.transits.values, result.steps))
"""


@pytest.mark.long
def test_a_machine_without_fused_multiplication_gives_the_same_bits(tmp_path, capsys):
    plain = {
        "NUMBA_CPU_NAME": "generic",
        "NUMBA_CPU_FEATURES": "",
        "NUMBA_CACHE_DIR": str(tmp_path),
    }
    command = [sys.executable, "-c", SHORT]
    generic = subprocess.run(
        command, env={**os.environ, **plain}, capture_output=True, text=True, check=True
    )
    exec(SHORT, {})
    assert capsys.readouterr().out == generic.stdout


FIRST_USE = """
from reference.system.channel import ANNOUNCEMENTS
with ANNOUNCEMENTS.heard_by(lambda line: print("announced")):
    exec(SHORT)
"""


@pytest.mark.long
def test_the_first_use_is_announced_and_the_second_is_not(tmp_path, capsys):
    command = [sys.executable, "-c", f"SHORT = {SHORT!r}\n{FIRST_USE}"]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    first, second = (
        subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    )
    exec(SHORT, {})
    assert (first, second) == ("announced\n" + second, capsys.readouterr().out)
