"""Every trap of heyoka's event detection is first shown, then shown to be guarded against."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import heyoka as hy
import numpy as np
import pytest
from small_scenes import make_scene, start_for, stepper_of

from reference import solve, sweep
from reference.engines.heyoka.conversions import Numbers
from reference.engines.heyoka.events import march
from reference.engines.heyoka.stepper import Stepper, Zero
from reference.engines.heyoka.system import system_of
from reference.engines.plan import Plan
from reference.engines.registry import run
from reference.errors import IntegrationError
from reference.model.start import xdot_vanishes, zero_at_release
from reference.numbers.precision import DOUBLE, LONG_DOUBLE, real


def bare_heyoka(scene, number, t_end, first_step=None):
    """Times of xdot = 0 in (or at) 0 … t_end as heyoka alone reports them; its log is where it is."""
    from reference.model.formulations import FORMULATIONS

    release = start_for(scene, number)
    numbers, model = Numbers(number), FORMULATIONS["momentum"]
    equations, xdot = system_of(model, release.k.converted(numbers.of))
    times: list[float] = []
    event = hy.nt_event(
        xdot, callback=lambda _, t, __: times.append(float(t)), fp_type=numbers.type
    )
    start = np.array([numbers.of(part) for part in release.state(model)], dtype=numbers.dtype)
    alone = hy.taylor_adaptive(
        equations, start, nt_events=[event], fp_type=numbers.type, **numbers.keywords
    )
    if first_step is not None:
        alone.step(first_step)
    alone.propagate_until(numbers.of(t_end))
    return times


def guarded(scene, number, t_end=60, stepper=None):
    """The zeros of xdot that pass the guards."""
    stepper = stepper or stepper_of(scene, number, events=True)
    multiplicity = zero_at_release(start_for(scene, number))
    return march(stepper, [stepper.numbers.of(0), stepper.numbers.of(t_end)], multiplicity)[1]


def exact_first_transit(scene, number):
    return guarded(scene, number, 10)[0].t


def test_trap_a_root_on_a_steps_edge_makes_heyoka_warn_in_real(paris, capfd):
    hy.set_logger_level_warning()
    try:
        bare_heyoka(paris, real(192), 60)
    finally:
        hy.set_logger_level_critical()
    assert "polynomial root finding during event detection failed" in capfd.readouterr().out


def test_guard_the_same_run_is_silent_and_complete(paris, capfd):
    zeros = guarded(paris, real(192))
    assert capfd.readouterr().out == ""
    assert [zero.direction for zero in zeros] == [1, -1, 1, -1, 1, -1, 1]


class EdgeOnTransit(Stepper):
    """A step boundary is forced onto the first transit, where heyoka loses or doubles it."""

    edge: object = None

    def advance(self, limit):
        if self.edge is not None and self.time < self.edge:
            limit = min(limit, self.edge - self.time)
        super().advance(limit)


@pytest.mark.parametrize(
    ("number", "offset"),
    [(DOUBLE, 0), (DOUBLE, 1), (DOUBLE, -1), (real(192), 0)]
    + [
        pytest.param(number, offset, marks=pytest.mark.long)
        for number in (real(128), real(160), real(192))
        for offset in (0, 1, -1)
        if (number, offset) != (real(192), 0)
    ],
    ids=str,
)
def test_a_step_edge_on_a_transit_neither_loses_nor_doubles_it(paris, number, offset):
    stepper = stepper_of(paris, number, kind=EdgeOnTransit, events=True)
    first = exact_first_transit(paris, number)
    stepper.edge = first + first * stepper.numbers.power_of_two(-number.prec) * stepper.numbers.of(
        offset
    )
    zeros = guarded(paris, number, stepper=stepper)
    assert len(zeros) == 7
    assert abs(zeros[0].t - first) < first * stepper.numbers.power_of_two(8 - number.prec)


def test_trap_heyoka_reports_the_zero_at_the_release(paris):
    assert bare_heyoka(paris, DOUBLE, 60)[0] < 1e-15
    assert len(bare_heyoka(paris, DOUBLE, 60)) == 8


def test_guard_the_zero_at_the_release_is_no_transit(paris):
    zeros = guarded(paris, DOUBLE)
    assert len(zeros) == 7
    assert zeros[0].t > 8


def test_trap_xdot_identically_zero_gives_bogus_events():
    planar = make_scene(site={"rotation_rate": "0"}, release={"x": "0", "y": "0.5"})
    assert len(bare_heyoka(planar, DOUBLE, 60)) > 7


@pytest.mark.parametrize(
    ("sections", "vanishes"),
    [
        ({"site": {"rotation_rate": "0"}, "release": {"x": "0", "y": "0.5"}}, True),
        ({"site": {"rotation_rate": "0"}, "release": {"angle": "40", "azimuth": "-90"}}, True),
        ({"site": {"rotation_rate": "0"}, "release": {"x": "0", "y": "0.5", "vy": "1"}}, True),
        ({"site": {"rotation_rate": "0"}, "release": {"x": "0", "y": "0.5", "vx": "1"}}, False),
        ({"site": {"latitude": "90"}, "release": {"x": "0", "y": "0"}}, True),
        ({"site": {"latitude": "0"}, "release": {"x": "0", "y": "0"}}, True),
        ({"site": {"latitude": "0"}, "release": {"angle": "180", "azimuth": "0"}}, True),
        ({"site": {"gravity": "0", "rotation_rate": "0"}}, True),
        ({"release": {"x": "0", "y": "0"}}, False),
        ({"release": {"x": "0", "y": "0.5"}}, False),
        ({"site": {"latitude": "90"}, "release": {"x": "0", "y": "0.5"}}, False),
        ({}, False),
    ],
)
def test_guard_xdot_identically_zero_is_known_from_the_exact_inputs(sections, vanishes):
    scene = make_scene(**sections)
    assert xdot_vanishes(start_for(scene, DOUBLE)) == vanishes
    if vanishes:
        done = run(Plan(scene.exact, "momentum", DOUBLE, (Fraction(0), Fraction(60)), ("xdot",)))
        assert done.transits is None
        assert len(set(done.grid.exact("x"))) == 1


class LosesEvents(Stepper):
    """Forgets the events of one step, as heyoka does when its root finder gives up."""

    lost = 0
    forget: slice = slice(None)
    when = 5000.0

    def advance(self, limit):
        super().advance(limit)
        if self.lost == 0 and self.zeros and float(self.time) > self.when:
            self.lost = len(self.zeros)
            del self.zeros[self.forget]


def losing(scene, number, kind=LosesEvents):
    return stepper_of(scene, number, kind=kind, events=True)


def test_guard_a_root_lost_in_silence_is_found_again(paris):
    stepper = losing(paris, DOUBLE)
    assert len(guarded(paris, DOUBLE, 6000, stepper)) == len(guarded(paris, DOUBLE, 6000))
    assert stepper.lost == 1


def close_pair_scene():
    """A fast small Earth at its equator: z drives x at twice the swing's frequency, and xdot dips through zero."""
    return make_scene(
        pendulum={"length": "1"},
        site={"latitude": "0", "rotation_rate": "0.05", "equatorial_radius": "1"},
        release={"x": "0", "y": "0.5", "vx": "-0.00775"},
    )


def test_guard_a_close_pair_lost_together_is_found_again():
    """xdot passes through zero and back inside one step; both events are lost; only the minimum of |xdot| shows."""
    scene = close_pair_scene()
    plain = guarded_moving(scene, stepper_of(scene, DOUBLE, events=True))
    gaps = np.diff([float(zero.t) for zero in plain])
    assert gaps.min() < 0.03, "the scene must have a pair inside one step of 0.1 s"

    class LosesPair(LosesEvents):
        def advance(self, limit):
            Stepper.advance(self, limit)
            if self.lost == 0 and len(self.zeros) == 2:
                self.lost = 2
                self.zeros.clear()

    stepper = losing(scene, DOUBLE, LosesPair)
    again = guarded_moving(scene, stepper)
    assert stepper.lost == 2
    assert len(again) == len(plain)


class LosesSome(Stepper):
    """Forgets some of the events of one step, the first that has four."""

    forget, lost = (), 0

    def advance(self, limit):
        super().advance(limit)
        if self.lost == 0 and len(self.zeros) == 4:
            self.lost = len(self.forget)
            self.zeros[:] = [zero for i, zero in enumerate(self.zeros) if i not in self.forget]


def bunched_scene():
    """A swing so much smaller than the cord that a step lasts two periods, and most hold four zeros."""
    release = {"x": "1e-32", "y": "1e-32", "vx": "1e-32"}
    return make_scene(site={"gravity_is": "effective", "rotation_rate": "0"}, release=release)


@pytest.mark.parametrize(
    "forget",
    [
        lost
        if lost in {(0,), (1, 2), (0, 2, 3), (0, 1, 2, 3)}
        else pytest.param(lost, marks=pytest.mark.long)
        for count in range(1, 5)
        for lost in combinations(range(4), count)
    ],
)
def test_guard_whatever_is_lost_in_a_step_is_found_again(forget):
    scene = bunched_scene()
    stepper = losing(scene, real(128), type("Loses", (LosesSome,), {"forget": forget}))
    times = [float(zero.t) for zero in guarded_moving(scene, stepper, 120)]
    assert np.diff(times) == pytest.approx(np.full(14, np.pi * np.sqrt(67 / 9.80665)), abs=1e-6)
    assert stepper.lost == len(forget)


def guarded_moving(scene, stepper, t_end=60):
    return march(stepper, [stepper.numbers.of(0), stepper.numbers.of(t_end)])[1]


class MadeUp:
    """What `march` steps: one second, in which xdot is a known polynomial with these zeros and others elsewhere."""

    def __init__(self, number, zeros, rest):
        self.number, self.numbers = number, Numbers(number)
        polynomial = np.polynomial.polynomial
        xdot = polynomial.polymul(polynomial.polyfromroots(zeros), rest)
        series = np.concatenate([[0.3], xdot / np.arange(1, len(xdot) + 1)])
        self.series = series.astype(self.numbers.dtype)
        self.state, self.time = self.series[:1], self.numbers.of(0)
        self.found, self.zeros = [], []

    def advance(self, limit):
        """Take the whole step, however long it may be, and find what is found of its zeros."""
        self.time, self.zeros = self.numbers.of(1), list(self.found)

    def last_of_x(self):
        return self.series, self.numbers.of(1)

    def mark(self):
        return self.time, None

    def back(self, mark):
        self.time = mark[0]

    def sample(self, times, states):
        states.append(self.state)

    def marched(self, found):
        """The zeros that `march` lets pass, of those that are found."""
        self.time, self.found = self.numbers.of(0), found
        return march(self, [self.numbers.of(0), self.numbers.of(1)])[1]


@pytest.mark.parametrize("number", [DOUBLE, LONG_DOUBLE])
def test_guard_the_zeros_of_any_polynomial_are_counted(number, size):
    """Up to four zeros in a step, some close together, others just outside it, or complex and near."""
    rng, numbers = np.random.default_rng(31), Numbers(number)
    for case in range(size(80, 300)):
        many = case % 5
        zeros = np.sort(rng.uniform(0.001, 0.999, many))
        if many > 1 and case % 4 == 0:
            zeros[1] = zeros[0] + 10 ** rng.uniform(-5, -3)
            zeros.sort()
        outside = rng.choice([-1e-6, 1 + 1e-6, 1.5, -3.0], rng.integers(0, 3)).tolist()
        middle, aside = rng.uniform(0, 1), 10 ** rng.uniform(-3, 0)
        near = np.polynomial.polynomial.polyfromroots(outside) if outside else np.ones(1)
        rest = np.polynomial.polynomial.polymul([middle**2 + aside**2, -2 * middle, 1], near)
        far = np.exp(-2.0 * np.arange(15)) * rng.uniform(-1, 1, 15)
        far[0] = 2.0
        rest = np.polynomial.polynomial.polymul(rest, far)
        first = -np.sign(np.polynomial.polynomial.polyval(0, rest) * (-1) ** many)
        directions = [int(first) * (-1) ** k for k in range(many)]
        every = [
            Zero(numbers.of(s), d, None) for s, d in zip(zeros.tolist(), directions, strict=True)
        ]
        stepper = MadeUp(number, zeros, rest)
        assert stepper.marched(every) == every, (case, zeros)
        for lost in range(1, 1 << many):
            with pytest.raises(IntegrationError, match="zeros of xdot near"):
                stepper.marched([zero for k, zero in enumerate(every) if not lost >> k & 1])


def test_events_that_contradict_each_other_for_good_stop_the_run(paris):
    class NeverSees(LosesEvents):
        def advance(self, limit):
            Stepper.advance(self, limit)
            self.zeros.clear()

    with pytest.raises(IntegrationError, match="zeros of xdot near t = "):
        guarded(paris, DOUBLE, 60, losing(paris, DOUBLE, NeverSees))


def test_the_transits_of_a_day_are_those_of_other_steps_and_another_form(paris, size):
    hours = size(1, 24)
    times, pairs = (Fraction(0), Fraction(3600 * hours)), {1: 219, 24: 5257}[hours]
    runs = [
        run(Plan(paris.exact, name, LONG_DOUBLE, times, ("xdot",)))
        for name in ("momentum", "space")
    ]
    assert [len(one.transits) for one in runs] == [2 * pairs, 2 * pairs]
    assert runs[0].directions == runs[1].directions == [1, -1] * pairs
    late, slopes = (
        runs[0].transits.distance(runs[1].transits).exact("t"),
        runs[0].transits.exact("ax"),
    )
    worst = max(gap * abs(slope) for gap, slope in zip(late, slopes, strict=True))
    # of a day: 64 bits, a phase of 3.3e4 rad and 0.2 m/s leave 4e-16 m/s, times the roundings met
    assert worst < 1e-13 * hours / 24


def test_the_time_of_a_transit_near_the_north_south_passage_is_worse_than_the_others(paris):
    times = (Fraction(0), Fraction(86400))
    done = run(Plan(paris.exact, "momentum", DOUBLE, times, ("xdot",)))
    slopes = sorted(abs(done.transits["ax"]))
    assert slopes[0] < slopes[len(slopes) // 2] / 1000


@pytest.mark.parametrize(
    ("release", "latitude", "multiplicity"),
    [
        ({"x": "0.3", "y": "0.4"}, "45", 1),
        ({"x": "0", "y": "0.5"}, "45", 2),
        pytest.param({"x": "0", "y": "0.5", "vy": "0.1"}, "45", 1, marks=pytest.mark.long),
        ({"x": "0.3", "y": "0.4", "vx": "0.067"}, "45", 0),
        pytest.param({"x": "0", "y": "0", "vy": "0.1"}, "0", 2, marks=pytest.mark.long),
        pytest.param({"angle": "90", "azimuth": "33"}, "45", 1, marks=pytest.mark.long),
        ({"angle": "90", "azimuth": "180"}, "45", 3),
        pytest.param({"angle": "90", "azimuth": "33"}, "-90", 3, marks=pytest.mark.long),
        ({"angle": "90", "azimuth": "90"}, "90", 4),
        ({"angle": "40.1", "azimuth": "90"}, "40.1", 4),
        pytest.param({"x": "0", "y": "-33.5"}, "-30", 4, marks=pytest.mark.long),
        ({"angle": "40.1", "azimuth": "90", "angle_rate": "5"}, "40.1", 2),
    ],
)
def test_the_order_of_the_zero_at_the_release_is_that_of_its_polynomial(
    release, latitude, multiplicity
):
    scene = make_scene(release=release, site={"latitude": latitude})
    assert zero_at_release(start_for(scene, DOUBLE)) == multiplicity
    coefficients = [float(a) for a in stepper_of(scene, real(200)).coefficients()[0][0][1:]]
    sizes = [abs(a) / max(map(abs, coefficients)) for a in coefficients]
    assert max(sizes[:multiplicity], default=0.0) < 1e-40 < 1e-14 < sizes[multiplicity]


@pytest.mark.parametrize(
    ("release", "latitude"),
    [
        ({"angle": "90", "azimuth": "180"}, "45"),
        pytest.param({"angle": "90", "azimuth": "33"}, "-90", marks=pytest.mark.long),
        ({"vy": "0.1"}, "0"),
        ({"angle": "30", "azimuth": "90"}, "30"),
    ],
)
def test_a_zero_of_higher_order_at_the_release_is_left_out_and_no_other(release, latitude):
    release = release if "angle" in release else {"x": "0", "y": "0", **release}
    run = {"t_end": "60", "grid_step": "20", "digits": 15}
    # with drag, so that it does not come back to the horizontal
    scene = make_scene(
        release=release, site={"latitude": latitude}, run=run, pendulum={"drag": "0.01"}
    )
    proved, computed = (
        solve(scene.with_values([f"run.level={level}"])) for level in ("enclosed", "computed")
    )
    assert proved.directions == computed.directions != []
    for engine in ("octet", "heyoka"):
        row = sweep(scene, ["pendulum.length=67"], engine=engine, want=("transit-times",))
        assert row.transits()["direction"].tolist() == proved.directions
        assert row.transits()["t_s"] == pytest.approx(proved.transits["t"], rel=1e-8)
    assert computed.transits["t"] == pytest.approx(proved.transits["t"], rel=1e-12)


@pytest.mark.parametrize("number", [DOUBLE, real(160)], ids=str)
def test_a_release_at_rest_in_the_meridian_has_its_first_transit_where_the_proof_has_it(number):
    """y0 = 0.5 m: the first transit is proved to be at 8.2266590196580988 s; there must be no spurious one at 0."""
    scene = make_scene(release={"x": "0", "y": "0.5"})
    done = run(Plan(scene.exact, "momentum", number, (Fraction(0), Fraction(60)), ("xdot",)))
    assert abs(done.transits.exact("t")[0] - Fraction("8.2266590196580988")) < (
        1e-9 if number is DOUBLE else 1e-15
    )


def test_a_moving_release_may_have_a_transit_in_its_first_step():
    """xdot(0) = 0.067 m/s: the first transit is proved to be at 1.38290078 s."""
    scene = make_scene(release={"x": "0.3", "y": "0.4", "vx": "0.067"})
    done = run(Plan(scene.exact, "momentum", DOUBLE, (Fraction(0), Fraction(60)), ("xdot",)))
    assert abs(done.transits["t"][0] - 1.38290078) < 1e-8


def test_a_run_shorter_than_the_quiet_start_has_no_transit(paris):
    done = run(Plan(paris.exact, "momentum", real(160), (Fraction(0), Fraction(1, 10)), ("xdot",)))
    assert len(done.transits) == 0


@pytest.mark.parametrize("vx", ["1e-22", "1e-25", "1e-30", "1e-300", "-1e-24", "-1e-30"])
def test_a_push_below_the_rounding_of_a_run_turns_at_the_time_that_the_exact_inputs_give(vx):
    """Released 1 m to the east and pulled back by about g/20 m/s², it turns after vx/ax s; pushed back, it does not."""
    scene = make_scene(
        pendulum={"length": "20"},
        site={"latitude": "50", "gravity": "9.81", "gravity_is": "effective"},
        release={"x": "1", "y": "0", "vx": vx, "vy": "0.3"},
        run={"t_end": "30", "digits": 10, "level": "confirmed"},
    )
    still = scene.with_values(["release.vx=0"])
    made, expected = solve(scene), solve(still)
    early, later = made.transits["t"][: float(vx) > 0], made.transits["t"][float(vx) > 0 :]
    assert np.allclose(early.astype(float), float(vx) / 0.49007805, rtol=1e-6)
    assert np.allclose(later.astype(float), expected.transits["t"].astype(float), rtol=0, atol=1e-9)
