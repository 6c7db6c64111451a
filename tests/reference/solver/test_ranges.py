"""A scene with uncertain inputs: intervals that are proved, or a refusal that says why."""

from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from random import Random

import numpy as np
import pytest
from boxes import azimuths, drawn, truth
from mutations import loaded, named
from sampled import one_in

import reference
from reference.enclosure.trusted.shapes import Box
from reference.engines.plan import Run
from reference.engines.trajectory import Variants
from reference.solver.uncertain import UNCERTAIN, widths_of

MEASURED = {"pendulum.length": "±0.001", "site.gravity": "+-1e-5", "latitude": "+/-0.001"}


@pytest.fixture(scope="module")
def paris():
    return reference.prove_ranges("paris", t_end="120", widths=MEASURED)


def test_the_scene_itself_lies_inside(paris):
    point = reference.solve("paris", t_end="120", digits=20)
    assert paris.scene.run.level == "enclosed"
    assert paris.times == point.times
    for name in ("x", "y", "z", "vx", "vy", "vz"):
        assert (paris.grid.low(name) <= point.grid[name]).all()
        assert (point.grid[name] <= paris.grid.high(name)).all()
    assert paris.directions == point.directions
    assert (paris.transits.low("t") < point.transits["t"]).all()
    assert (point.transits["t"] < paris.transits.high("t")).all()
    assert paris.possible == ()


def test_what_is_given_exactly_stays_so_and_widths_grow_with_the_time(paris):
    assert paris.grid.exact("vx")[0] == (0, 0)
    low, high = paris.grid.exact("x")[0]
    assert low <= Fraction("0.3") <= high
    assert high - low < Fraction(1, 10**25)
    widths = paris.transits.high("t") - paris.transits.low("t")
    # a period is known to half of the relative width of length and gravity
    relative = (0.001 / 67 + 1e-5 / 9.8) * paris.transits.low("t")
    assert (widths > relative).all()
    assert (widths < 1.1 * relative + 2e-4).all()  # and what the length adds to the release


def test_doubles_are_rounded_outward(paris):
    for (low, high), left, right in zip(
        paris.grid.exact("y"), paris.grid.low("y"), paris.grid.high("y"), strict=True
    ):
        assert Fraction(left) <= low <= high <= Fraction(right)
        assert Fraction(np.nextafter(left, np.inf)) > low


def test_the_period_is_that_of_transits_in_the_same_direction(paris):
    low, high = paris.period
    swing = 2 * np.pi * np.sqrt(67 / 9.7835)
    assert float(high - low) < 0.001
    assert abs(float(low) - swing) < 0.02
    times = paris.transits.exact("t")
    assert low <= (times[2][0] + times[2][1] - times[0][0] - times[0][1]) / 2 <= high


def test_an_input_takes_its_short_name_or_a_long_one(paris):
    short = reference.prove_ranges(
        "paris", t_end="120", widths={"length": "±0.001", "gravity": "±1e-5", "latitude": "±1e-3"}
    )
    assert short.grid == paris.grid
    assert short.uncertain == paris.uncertain == {
        "pendulum.length": "0.001", "site.gravity": "0.00001", "site.latitude": "0.001",
    }  # fmt: skip
    assert repr(paris).startswith("Ranges(paris: pendulum.length ±0.001, ")


@pytest.mark.parametrize("name", one_in(2, UNCERTAIN))
def test_every_input_may_be_uncertain(name):
    release = name.startswith("release.a")
    angles = {
        "release": {"angle": "3", "azimuth": "20", "angle_rate": "0.1", "azimuth_rate": "0.1"}
    }
    position = {"release": {"x": "1", "y": "0.5", "vx": "0.01", "vy": "0.02"}}
    document = {
        "id": "a",
        "pendulum": {"length": "20", "drag": "0.01"},
        "run": {"t_end": "30", "grid_step": "10"},
    }
    scene = reference.parse_scene(document | (angles if release else position))
    wide, narrow = (
        reference.prove_ranges(scene, widths={name: f"±{width}"}) for width in ("1e-4", "1e-5")
    )
    for column in ("x", "vy"):
        assert (wide.grid.low(column)[1:] < narrow.grid.low(column)[1:]).all()
        assert (narrow.grid.high(column)[1:] < wide.grid.high(column)[1:]).all()


@pytest.mark.parametrize(
    "uncertain, told",
    [
        ({"lenght": "±1"}, "expected an input on which the motion depends"),
        ({"run.t_end": "±1"}, "expected an input on which the motion depends"),
        (
            {"length": "1 mm"},
            "expected half of a width in m, such as ±0.001, +-0.001 or 0.001",
        ),
        ({"length": None}, "expected half of a width"),
        ({3: "0.001"}, "expected an input on which the motion depends"),
        ({"length": "-0.001"}, "expected a width above 0"),
        ({"length": "±-0.001"}, "expected a width above 0"),
        ({"length": "±0"}, "expected a width above 0"),
        ({"length": "±1 mm"}, "expected half of a width"),
        ({"length": "±nan"}, "expected half of a width"),
        ({"length": "±67"}, "which reaches 0, expected a number above 0"),
        ({"drag": "±0.1"}, "which reaches -0.1, expected a number at least 0"),
        ({"latitude": "±60"}, "expected a number at least -90 and at most 90"),
        ({"angle": "±1"}, "expected an input that this scene has"),
        ({"x0": "±66", "y0": "±20"}, "expected a release below the suspension"),
        ({"length": "±1", "pendulum.length": "±1"}, "expected one width of pendulum.length"),
        ({}, "expected an input with its width"),
    ],
)
def test_a_wrong_width_is_told(uncertain, told):
    with pytest.raises(reference.InputError) as caught:
        reference.prove_ranges("paris", widths=uncertain)
    assert told in str(caught.value)


def test_a_box_too_wide_is_refused_with_the_time_up_to_which_it_holds():
    wide = {"pendulum.length": "±0.001", "release.x": "±2"}
    with pytest.raises(
        reference.UnreachableError, match=r"too uncertain: the proof reaches only t = (\d+)"
    ) as caught:
        reference.prove_ranges("paris", t_end="3600", widths=wide)
    holds = str(caught.value).partition("t = ")[2].partition(" ")[0]
    assert reference.prove_ranges("paris", t_end=holds, widths=wide).times[-1] == Fraction(holds)


def test_a_box_without_a_pull_is_refused():
    floating = {
        "id": "a",
        "site": {"gravity": "0", "rotation_rate": "0"},
        "release": {"x": "1", "y": "0", "vx": "1"},
    }
    with pytest.raises(
        reference.UnreachableError, match="too uncertain: the proof reaches only t = 0"
    ):
        reference.prove_ranges(floating, t_end="10", widths={"length": "±0.001"})


def test_derivatives_are_those_of_the_period_of_small_swings_and_of_neighbours():
    scene = {
        "id": "a",
        "site": {"rotation_rate": "0"},
        "release": {"x": "0.02", "y": "0.01"},
        "run": {"t_end": "60"},
    }
    widths = {"pendulum.length": "±1e-4", "site.gravity": "±1e-5", "release.x": "±1e-4"}
    ranges = reference.prove_ranges(scene, widths=widths, derivatives=True)
    period = sum(map(float, ranges.period)) / 2
    inputs = ranges.scene.exact
    for name, slope in (
        ("length", period / 2 / float(inputs.length)),
        ("gravity", -period / 2 / float(inputs.gravity)),
    ):
        low, high = map(float, ranges.derivative(name).period)
        assert low < slope < high
        assert high - low < 0.01 * abs(slope)
    beyond, within = (
        reference.solve(
            {**scene, "pendulum": {"length": str(67 + step)}}, level="computed", digits=12
        )
        for step in (1e-4, -1e-4)
    )
    slopes = (beyond.grid["x"] - within.grid["x"]) / 2e-4
    found = ranges.derivative("pendulum.length").grid
    assert (found.low("x") - 1e-6 <= slopes).all() and (slopes <= found.high("x") + 1e-6).all()
    shares = ranges.shares()
    assert list(shares) == ["pendulum.length", "site.gravity", "release.x"]
    assert sum(share for _, share in shares.values()) == pytest.approx(1)
    assert len(ranges.derivative("release.x").transits) == len(ranges.transits)


def test_above_the_horizontal_transits_tell_no_period():
    """A cord that passes the horizontal has xdot = 0 there too."""
    wide = ["site.rotation_rate=0", "release.azimuth=0", "release.angle=117", "run.t_end=6"]
    scene = reference.load_scene("above_horizontal", wide)
    ranges = reference.prove_ranges(scene, widths={"release.angle": "±1e-6"}, derivatives=True)
    assert len(ranges.transits) > 4
    assert ranges.period is ranges.derivative("angle").period is None
    assert ranges.shares() == {}


def test_derivatives_that_are_not_there_are_told(paris):
    with pytest.raises(reference.InputError, match="derivatives=True"):
        paris.derivative("length")
    ranges = reference.prove_ranges(
        "paris", t_end="60", widths={"length": "±0.001"}, derivatives=True
    )
    with pytest.raises(reference.InputError, match=r"There are pendulum\.length"):
        ranges.derivative("gravity")


def test_a_wide_swing_is_followed_by_its_derivatives():
    wide = {"id": "a", "pendulum": {"length": "1"}, "release": {"angle": "110", "azimuth": "30"}}
    wide |= {"run": {"t_end": "3", "grid_step": "1"}}
    ranges = reference.prove_ranges(wide, widths={"pendulum.length": "±1e-7"})
    width = (ranges.grid.high("x") - ranges.grid.low("x")).max()
    assert ranges.proof.derivatives is not None
    assert width < 1e-5


def widths_over_hulls(end, derivatives, count):
    """Return the largest width of a column over each swing, over that of drawn pendulums, shape (swings, 6)."""
    scene = reference.load_scene("paris", ["run.grid_step=2", f"run.t_end={end}"])
    ranges = reference.prove_ranges(scene, widths=MEASURED, derivatives=derivatives)
    grid = ranges.grid
    low, high = (
        np.column_stack([end(name) for name in grid.columns]) for end in (grid.low, grid.high)
    )
    model, rng, box = Variants(), Random(4711), Box(*ranges.proof.proved.box)
    least, most = np.full_like(low, np.inf), np.full_like(low, -np.inf)
    for k in range(count):
        states = model.states(
            drawn(box, rng, corner=k % 2 == 0), np.array([float(t) for t in ranges.times])
        )
        np.minimum(least, states, out=least)
        np.maximum(most, states, out=most)
    rounding = 1e-9 * (high - low).max(axis=0)  # of runs in double; the release is exact
    assert (low - rounding <= least).all()
    assert (most <= high + rounding).all()
    by_swing = [
        x[: len(x) // 8 * 8].reshape(-1, 8, 6).max(axis=1) for x in (high - low, most - least)
    ]
    return (by_swing[0] / by_swing[1])[1:]


@pytest.mark.parametrize(("derivatives", "most"), [(False, 4), (True, 1.5)])
def test_intervals_are_hardly_wider_than_the_pendulums_are_apart(derivatives, most, size):
    assert widths_over_hulls(size("400", "1500"), derivatives, size(20, 1000)).max() <= most


@pytest.mark.long
def test_a_day_of_paris_holds_every_pendulum(tally):
    wider = widths_over_hulls("86400", True, 1000)
    tally(
        f"a day of Paris, width over hull by swing: median {np.median(wider, axis=0)}, at the end {wider[-1]}"
    )


SWINGS = {  # scene, widths, whether the turn of the plane is decided
    "from rest": (
        {"release": {"x": "0.3", "y": "0.4"}},
        {"length": "±0.01", "latitude": "±0.1"},
        True,
    ),
    "across the cut": (  # the points lie west and east, at azimuths near 180 degrees
        {"release": {"x": "-1", "y": "0"}, "site": {"rotation_rate": "1e-3"}},
        {"rotation_rate": "±1e-6", "y0": "±1e-4"},
        True,
    ),
    "damped": (
        {"pendulum": {"length": "10", "drag": "0.01"}, "release": {"x": "0.5", "y": "0.1"}},
        {"drag": "±1e-4", "length": "±0.001", "x0": "±1e-4"},
        True,
    ),
    "ellipse": (
        {"pendulum": {"length": "10"}, "release": {"x": "1", "y": "0", "vy": "0.4"}},
        {"vy0": "±1e-4", "gravity": "±1e-4", "length": "±1e-4"},
        True,
    ),
    "lean": (
        {
            "site": {"rotation_rate": "0.01", "equatorial_radius": "1000"},
            "release": {"x": "1", "y": "2"},
        },
        {"latitude": "±0.02", "rotation_rate": "±1e-5"},
        True,
    ),
    "circle": (  # whose highest points are anywhere
        {"pendulum": {"length": "10"}, "release": {"x": "1", "y": "0", "vy": "0.99278"}},
        {"vy0": "±1e-3"},
        False,
    ),
}


DRAWN = 4  # pendulums of a box in every run, with which every fault below is found
RUNS: dict[str, list[Run]] = {}


def runs_in(name, box, count):
    """Return runs of pendulums drawn from the box of a scene, which are made once."""
    rng, runs = Random(name), RUNS.setdefault(name, [])
    for k in range(count):
        inputs = drawn(box, rng, corner=k % 2 == 0)
        if k == len(runs):
            runs.append(truth(inputs, [Fraction(0), Fraction(60)]))
    return runs[:count]


def decided_before(possible):
    """Return the time in s from which something is undecided; the runs end after 60 s."""
    return min((low for low, _, _ in possible), default=Fraction(61))


def swings_outside(name, count, derivatives, swing_of=None):
    """Return what of period, precession and full turn of drawn pendulums is outside of what is proved.

    With `swing_of` that tells the swing from the proven highest points.
    """
    document, widths, decided = SWINGS[name]
    scene = reference.parse_scene(
        {"id": "a", **document, "run": {"t_end": "60", "grid_step": "60"}}
    )
    ranges = reference.prove_ranges(
        scene, widths=widths, sections="highest", derivatives=derivatives
    )
    highest, found = ranges.sections["highest"], []
    known = sum(high < decided_before(highest.possible) for _, high in highest.table.exact("t"))
    if swing_of is None:
        proved = ranges.swing
    else:
        intervals = [
            *zip(*(highest.table.exact(column) for column in ("t", "x", "y", "z")), strict=True)
        ]
        proved = swing_of(intervals[:known], scene.exact, ranges.proof.bits, ranges.proof.lean)
    assert (proved is not None and proved.precession is not None) == decided
    swings = (
        sum(high < decided_before(ranges.possible) for _, high in ranges.transits.exact("t")) - 1
    ) // 2
    for run in runs_in(name, Box(*ranges.proof.proved.box), count if decided else 0):
        points, times = azimuths(run)[:known], run.transits.exact("t")
        turned = [(b - a + 90) % 180 - 90 for (_, a), (_, b) in pairwise(points)]
        span = points[-1][0] - points[0][0]
        rate = sum(turned) * 3600 / span
        period = ranges.period and (times[2 * swings] - times[0]) / swings
        numbers = {
            "hz": Fraction(len(points) - 1, 2) / span,
            "precession": rate,
            "full_turn": 360 / abs(rate),
        }
        numbers |= {"period": 2 * span / (len(points) - 1)}
        intervals = [(word, value, getattr(proved, word)) for word, value in numbers.items()]
        for word, value, interval in [*intervals, ("of transits", period, ranges.period)]:
            if interval and not interval[0] <= value <= interval[1]:
                found.append(
                    f"{word} {float(value)} not in [{float(interval[0])}, {float(interval[1])}]"
                )
    return found


@pytest.mark.parametrize(
    ("name", "derivatives"),
    [*((name, False) for name in SWINGS if name != "damped"), ("from rest", True)]
    + [pytest.param(name, True, marks=pytest.mark.long) for name in SWINGS if name != "from rest"]
    + [pytest.param("damped", False, marks=pytest.mark.long)],
)
def test_period_precession_and_full_turn_of_every_pendulum_lie_inside(name, derivatives, size):
    assert swings_outside(name, size(DRAWN, 1000), derivatives) == []


MUTATIONS_OF_SWING = [  # and a pendulum whose period or precession is wrong then
    ("_turn, drop term: sum(half_turns) * ctx.pi", "across the cut"),
    ("_apsis, swap neighbours: p, x", "from rest"),
    ("_apsis, flip sign: up * y", "from rest"),
    ("_apsis, drop term: north * z", "lean"),
    ("_turn, drop term: error", "ellipse"),
    ("_turn, drop term: to_fraction(apsis.error_m / apsis.width_m) * _ARC", "ellipse"),
    ("swing_or_reason, next index: spans[1]", "from rest"),
]


@pytest.mark.parametrize("mutation, name", one_in(3, MUTATIONS_OF_SWING))
def test_a_mutation_of_the_swing_of_a_box_is_noticed(mutation, name):
    mutated = loaded(named(f"reference/solver/swing.py {mutation}"))
    assert swings_outside(name, DRAWN, derivatives=False, swing_of=mutated.swing_of)


def test_derivatives_narrow_period_and_precession():
    wide, narrow = (
        reference.prove_ranges(
            "museum_gate", t_end="100", widths=MEASURED, sections="highest", derivatives=d
        )
        for d in (False, True)
    )
    assert wide.period[0] <= narrow.period[0] < narrow.period[1] <= wide.period[1]
    (low, high), (least, most) = wide.swing.precession, narrow.swing.precession
    assert low < least < most < high
    assert most - least < (high - low) / 10
    point = reference.solve(
        "museum_gate", t_end="100", level="enclosed", sections="highest"
    ).swing.precession
    assert least < point[0] < point[1] < most
    slope = narrow.derivative("latitude").precession  # of -Ω sin φ, in degrees an hour per degree
    assert slope[0] < -15.041 * np.cos(np.radians(50)) * np.pi / 180 < slope[1]


@pytest.mark.parametrize(
    "width", ["±0.001", "+-0.001", "+/-0.001", "0.001", " ± 0.001", 0.001, Decimal("0.001")]
)
def test_half_of_a_width_stands_with_a_sign_or_without_in_python_and_in_a_scene(width):
    assert widths_of(reference.load_scene("paris"), {"length": width}) == {
        "pendulum.length": Fraction(1, 1000)
    }
    scene = {"id": "a", "release": {"x": "1", "y": "0"}, "uncertain": {"pendulum.length": width}}
    if not isinstance(width, float):
        assert reference.parse_scene(scene).uncertain == {"pendulum.length": "±0.001"}
