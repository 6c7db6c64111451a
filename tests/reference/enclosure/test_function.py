"""The golden function's bound: against limbs, against exact evaluation, with spoilt coefficients and forged files."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from enclosure_oracle import scene as inputs_of
from enclosure_oracle import steps
from golden_functions import TRUTH, TRUTH_BITS, errors, evaluator, proved_function, random_times
from numpy.polynomial import chebyshev
from sampled import one_in
from small_scenes import make_scene

pytest.importorskip("flint")

from flint import arb, arb_mat, ctx

from reference.dataset.golden import load
from reference.enclosure.fit import FunctionFit, on_doubles
from reference.enclosure.trusted.course import Course
from reference.enclosure.trusted.function import (
    CUT,
    ComponentBounds,
    Following,
    basis,
    check_function,
    on_sphere,
    weights,
)
from reference.enclosure.trusted.system import SceneBalls
from reference.numbers.columns import STATE
from reference.numbers.function import GoldenFunction
from reference.scenes.scene import load_scene
from reference.scenes.shipped import golden_root

# id, end in s, engine: in every run a small angle, over the top, with drag
SCENES = [
    ("paris", "120", "heyoka"),
    ("over_top", "20", "limbs"),
    ("damped", "60", "limbs"),
]
MORE_SCENES = [
    ("nanometre", "120", "limbs"),
    ("at_rest", "60", "limbs"),
    ("paris", "600", "limbs"),
    ("hard", "20", "limbs"),
    ("near_inverted", "20", "limbs"),
    ("no_rotation", "120", "limbs"),
    ("conical_pole", "20", "limbs"),
    ("ten_kilometres", "600", "limbs"),
    ("weightless", "60", "limbs"),
]

SHIPPED = sorted(path.parent.name for path in golden_root().glob("*/function.f64"))


def short(name, end):
    return load_scene(name, [f"run.t_end={end}", f"run.grid_step={end}"])


@pytest.mark.parametrize(
    ("name", "end", "engine"),
    SCENES + [pytest.param(*case, marks=pytest.mark.long) for case in MORE_SCENES],
)
def test_no_time_is_outside_of_the_bound(name, end, engine, size):
    scene = short(name, end)
    function = evaluator(proved_function(scene, engine=engine))
    assert function.times[0] == 0
    assert function.times[-1] == float(end)
    off, truth = (
        errors(scene, function, random_times(function, size(1000, 100_000))),
        TRUTH * float(scene.exact.length),
    )
    for component in STATE:
        assert off[component].max() <= function.bound[component] + truth, component
    at = function.at(random_times(function, 1000))
    swing = float(np.hypot(at.x, at.y).max())
    assert function.bound["x"] <= 4e-15 * swing + 1e-300
    assert function.bound["y"] <= 4e-15 * swing + 1e-300


@pytest.mark.parametrize("name", one_in(12, SHIPPED))
def test_no_time_is_outside_of_the_bound_of_a_function_that_ships(name, size, tally):
    """Random times, a million over all of them at full size; `tally` prints bounds over the swing and sizes."""
    golden = load(name)
    function, length = golden.function, float(golden.scene.exact.length)
    times = random_times(function, size(500, 1_000_000 // len(SHIPPED) + 1))
    bits = max(
        TRUTH_BITS, *(int(text) for text in re.findall(r"\((\d+)\)", golden.manifest.run.number))
    )
    off = errors(golden.scene, function, times, bits)
    for component in STATE:
        assert off[component].max() <= function.bound[component] + TRUTH * length, component
    at = function.at(times)
    swing, fastest = float(np.hypot(at.x, at.y).max()) or length, float(np.abs(at.vx).max()) or 1.0
    x, z, vx = (
        function.bound["x"] / swing,
        function.bound["z"] / np.spacing(length),
        function.bound["vx"] / fastest,
    )
    megabytes = function.coefficients.nbytes / 1e6
    tally(
        f"{name}: {len(times)} times, x {x:.1e} of the swing, z {z:.2g} ulp, vx {vx:.1e}, {megabytes:.3f} MB"
    )


@pytest.mark.parametrize("name", one_in(10, SHIPPED))
def test_z_is_within_two_ulp_of_the_length(name):
    golden = load(name)
    assert golden.function.bound["z"] <= 2 * np.spacing(float(golden.scene.exact.length))


def test_a_piece_on_which_z_rounds_much_is_halved():
    function = evaluator(proved_function(short("force_free", "10")))
    assert function.bound["z"] <= 2 * np.spacing(1.0)


BITS = 128  # of the coefficients of steps


class Lying:
    """A driver's hold on a `Following`, whose proposals `change` makes of honest ones."""

    def __init__(self, following, change):
        self.following, self.change = following, change

    def __getattr__(self, name):
        """Hand on all else."""
        return getattr(self.following, name)

    def add(self, until, series):
        self.change(self.following, until, series)


class Driver:
    """Proves a scene's golden function step by step, as whoever calls trusted code may do."""

    def __init__(self, scene, bits=BITS, order=64):
        self.inputs = scene.exact
        self.course = Course(
            SceneBalls(self.inputs, bits + 64), self.inputs.grid, columns=False, words=()
        )
        self.fit = FunctionFit(self.course)
        self.proposed = list(on_doubles(steps(self.inputs, self.inputs.grid[-1], bits, order)))

    def proved(self, change=Following.add):
        """Take every step, with proposals that are changed; return what is proved."""
        self.fit.following = Lying(self.fit.following, change)
        for step in self.proposed:
            self.course.advance(step)
            self.fit.add()
        return self.fit.finish()

    @property
    def last(self):
        """The last step with its tube."""
        return self.fit.following.covered


def of_proof(made):
    return GoldenFunction.of(made.facts, made.bounds, made.data)


def test_the_tube_counts():
    scene = short("paris", "60")
    usual = of_proof(Driver(scene).proved()).bound
    coarse = Driver(scene, bits=36, order=CUT - 6)
    bound = of_proof(coarse.proved()).bound
    piece, tube = coarse.last
    eta, fastest = float(tube.eta), float(tube.u) / float(piece.step.h)
    assert eta > 1e-10
    # the degree is the lowest that adds a third at most
    assert 67 * eta <= bound["x"] < 4 / 3 * 67 * eta + usual["x"]
    assert 67 * fastest <= bound["vx"]


def test_the_orders_that_are_left_out_count():
    """A term of the last step's x beyond those that the function takes is in the tube, and once more besides."""
    driver = Driver(short("paris", "60"))
    step = driver.proposed[-1]
    rows = [[int(c) for c in row] for row in step.coefficients]
    order, size = CUT + 4, 1e-9
    rows[0][order] += int(size * 2**step.bits)
    driver.proposed[-1] = step._replace(rows=tuple(rows))
    bound = of_proof(driver.proved()).bound
    tube = driver.last.tube
    assert bound["x"] >= 67 * (float(tube.eta) + size) * (1 - 1e-6)
    assert bound["vx"] >= 67 * (float(tube.u) + order * size) / float(step.h) * (1 - 1e-6)


@pytest.mark.parametrize("size_of", [1e-17, 1e-14, 1e-9, 1e-3])
def test_wrong_coefficients_have_a_bound_that_covers_them(size_of):
    """The error of each of some coefficients, as large as it is, is inside the bound."""
    scene, rng = short("paris", "120"), np.random.default_rng(3)

    def spoilt(following, until, series):
        wrong = list(series)
        for i in rng.integers(0, 20, 3):
            wrong[i + CUT * rng.integers(2)] += size_of * rng.choice([-1, 1])
        following.add(until, wrong)

    function = of_proof(Driver(scene).proved(spoilt))
    off = errors(scene, function, random_times(function, 3000))
    for component in STATE:
        assert off[component].max() <= function.bound[component], component
    assert off["x"].max() >= size_of / 4 or size_of < 1e-15


@pytest.mark.parametrize(
    "other_end",
    [
        lambda following, until: until + 1,
        lambda following, until: float(following.end),
        lambda following, until: -until,
    ],
)
def test_a_piece_that_does_not_join_or_lie_in_its_step_is_refused(other_end):
    def moved(following, until, series):
        following.add(other_end(following, until), series)

    with pytest.raises(ArithmeticError, match="must join"):
        Driver(short("paris", "20")).proved(moved)


def test_a_gap_between_pieces_is_refused():
    driver = Driver(short("paris", "60"))
    first, *driver.proposed = driver.proposed
    driver.course.advance(first)  # of which no piece is proposed
    with pytest.raises(ArithmeticError, match="must join"):
        driver.proved()


class OtherText(float):
    """A time that is printed as another."""

    def hex(self):
        return (float(self) * (1 - 2**-40)).hex()


def test_the_times_that_are_printed_are_those_that_were_bounded():
    """F7 of the audit: the end of a piece was any object, asked for its value and then for its text."""
    ends = []

    def lying(following, until, series):
        ends.append(until.hex())
        following.add(OtherText(until), series)

    made = Driver(short("paris", "60")).proved(lying)
    assert made.facts["times"][1:] == ends


def test_a_proposal_of_another_shape_is_refused_in_words():
    driver = Driver(short("paris", "20"))
    driver.proved()
    course, following = driver.course, driver.fit.following
    series = [0.0] * CUT * following.count
    for words, call in (
        ("a degree from 0 to 35", lambda: following.finish(36)),
        ("a degree from 0 to 35", lambda: following.finish(-1)),
        ("series of x and y", lambda: Following(course, 1)),
        ("series of x and y", lambda: Following(course, 4)),
        ("36 coefficients", lambda: following.following.add(1.0, [0.0])),
        ("a finite time", lambda: following.following.add(float("inf"), series)),
        ("a finite time", lambda: following.following.add(float("nan"), series)),
    ):
        with pytest.raises(ArithmeticError, match=words):
            call()


def test_a_tube_from_elsewhere_is_refused():
    """Only the course may say which tube a piece is compared with."""

    def forged(following, until, series):
        following.advance(following.covered)
        following.add(until, series)

    with pytest.raises(ArithmeticError, match="from the course alone"):
        Driver(short("paris", "20")).proved(forged)


def test_series_are_copied_when_they_are_taken():
    def changing(following, until, series):
        following.add(until, series)
        series[0] += 1.0

    scene = short("paris", "60")
    function = of_proof(Driver(scene).proved(changing))
    assert errors(scene, function, random_times(function, 200))["x"].max() <= function.bound["x"]


def test_the_basis_is_that_of_numpy_and_exact():
    matrix = basis()
    assert all(entry.rad() == 0 for entry in matrix.entries())
    for k in (0, 1, 7, 20):
        row = [float(matrix[k, j]) for j in range(CUT)]
        expected = np.zeros(CUT)
        expected[: k + 1] = chebyshev.poly2cheb([0] * k + [1])
        assert np.allclose(row, expected, rtol=1e-14, atol=1e-16)


def rounded(q):
    return q.numerator / q.denominator


def fused(a, b, c):
    return rounded(Fraction(a) * Fraction(b) + Fraction(c))


def unfused(a, b, c):
    return a * b + c


def clenshaw(c, begin, end, t, multiply):
    """Return value and rate in doubles, as THEOREM.md has them; `multiply` gives a b + c in one or two roundings."""
    width = end - begin
    u = ((t - begin) - (end - t)) / width
    y, b1, b2, d1, d2 = u + u, 0.0, 0.0, 0.0, 0.0
    for k in range(len(c) - 1, 0, -1):
        b1, b2 = multiply(y, b1, -b2) + c[k], b1
        d1, d2 = multiply(float(k), c[k], multiply(y, d1, -d2)), d1
    return multiply(u, b1, -b2) + c[0], (d1 + d1) / width


def exactly(c, begin, end, t):
    begin, end, t = map(Fraction, (begin, end, t))
    u = (2 * t - begin - end) / (end - begin)
    value, rate, before, now, b, n = (
        Fraction(c[0]),
        Fraction(0),
        Fraction(1),
        u,
        Fraction(0),
        Fraction(1),
    )
    for k in range(1, len(c)):
        value, rate = value + Fraction(c[k]) * now, rate + k * Fraction(c[k]) * n
        before, now, b, n = now, 2 * u * now - before, n, 2 * u * n - b
    return value, rate * 2 / (end - begin)


@pytest.mark.parametrize("multiply", [unfused, fused])
def test_what_is_evaluated_in_doubles_is_within_the_bound_of_its_rounding(multiply, size):
    """Random series of all kinds, at random times and at ends, in plain and in fused operations, against fractions."""
    rng = np.random.default_rng(11)
    closest = np.zeros(2)
    for _ in range(size(60, 3000)):
        degree = int(rng.integers(1, 24))
        c = (
            rng.choice([-1, 1], degree + 1)
            * rng.uniform(0.5, 1, degree + 1)
            * rng.choice([1, 0.2, 0.6]) ** np.arange(degree + 1)
        ).tolist()
        begin = float(rng.choice([0.0, rng.uniform(0, 1), rng.uniform(1, 1e5)]))
        end = begin + float(rng.uniform(0.1, 10))
        lam, width = 1 if 2 * begin >= end else 5, Fraction(end) - Fraction(begin)
        cost = arb_mat([[abs(x) for x in c] + [0] * (CUT - degree - 1)]) * weights(degree, lam)
        limits = float(cost[0, 0]), float(cost[0, 2] * float(2 / width))
        for t in (begin, end, np.nextafter(end, 0), *rng.uniform(begin, end, 5)):
            both = zip(
                clenshaw(c, begin, end, float(t), multiply),
                exactly(c, begin, end, float(t)),
                limits,
                strict=True,
            )
            ratios = [abs(float(Fraction(value) - truth)) / limit for value, truth, limit in both]
            assert max(ratios) <= 1
            closest = np.maximum(closest, ratios)
    assert (closest > 0.02).all()  # the bound is no empty one


def test_the_evaluator_makes_the_specified_operations():
    function = evaluator(proved_function(short("hard", "10")))
    for t in random_times(function, 20)[::5].tolist():
        piece = max(i for i in range(len(function.times) - 1) if function.times[i] <= t)
        at = function.at(t)
        for i, name in enumerate("xyz"):
            c = function.coefficients[:, i, piece].tolist()
            both = clenshaw(c, *function.times[piece : piece + 2].tolist(), t, unfused)
            assert both == (getattr(at, name), getattr(at, f"v{name}"))


def test_z_from_the_sphere_is_within_its_bound():
    """Made-up errors of x, y, vx, vy, as large as they are said to be, beside a true state on the sphere."""
    rng, inside = np.random.default_rng(5), []
    length = Fraction("1.3")
    balls = SceneBalls(inputs_of(length="1.3"), 64)
    square = rounded(length**2)
    for _ in range(400):
        d, e, wide, fast = (
            float(x) for x in rng.uniform(0, 1, 4) * [10.0 ** -rng.integers(2, 17), 1e-3, 0.8, 2]
        )
        turn, way = rng.uniform(0, 2 * np.pi, 2)
        x, y = (Fraction(float(wide * f(turn))) for f in (np.cos, np.sin))
        vx, vy = (Fraction(float(fast * f(way))) for f in (np.cos, np.sin))
        x_bounds = ComponentBounds(*map(arb, (d, abs(float(x)), e, abs(float(vx)))))
        y_bounds = ComponentBounds(*map(arb, (d, abs(float(y)), e, abs(float(vy)))))
        z_bound, vz_bound = on_sphere(balls, arb(square), x_bounds, y_bounds)
        X, Y, VX, VY = (
            float(q) + s * rng.choice([-1, 1, 0.3]) * 0.999
            for q, s in ((x, d), (y, d), (vx, e), (vy, e))
        )
        z = -np.sqrt(square - (X * X + Y * Y))
        vz = -(X * VX + Y * VY) / z
        with ctx.workprec(200):
            true = -(arb(13) ** 2 / 100 - sum(arb(float(q)) ** 2 for q in (x, y))).sqrt()
            rate = -(arb(float(x)) * float(vx) + arb(float(y)) * float(vy)) / true
            gaps = abs(arb(float(z)) - true), abs(arb(float(vz)) - rate)
            assert gaps[0] <= z_bound.upper()
            assert gaps[1] <= vz_bound.upper()
            inside.append(float(gaps[0] / z_bound))
    assert max(inside) > 0.3


def test_z_has_a_series_unless_the_bob_stays_deep():
    assert proved_function(short("paris", "60")).function.facts["components"] == ["x", "y"]
    steep = make_scene(
        "steep",
        pendulum={"length": "1"},
        release={"angle": "40", "azimuth": "10"},
        run={"t_end": "10"},
    )
    assert proved_function(steep).function.facts["components"] == ["x", "y", "z"]


def test_without_a_series_of_z_a_high_bob_is_refused():
    driver = Driver(short("hard", "10"))
    driver.fit.following = Following(driver.course, 2)
    with pytest.raises(ArithmeticError, match=r"finite|negative"):
        driver.proved()


def test_files_that_state_something_else_are_refused():
    proof = proved_function(short("paris", "60"))
    made, proved = proof.function, proof.proved
    said = {
        **made.facts,
        "bounds": {name: str(float(bound) * 1.01) for name, bound in made.bounds.items()},
    }
    check_function(json.dumps(said), made.data, made, proved)

    def refused(said, data=made.data, function=made, proved=proved):
        with pytest.raises((ArithmeticError, LookupError)):
            check_function(json.dumps(said), data, function, proved)

    for key in made.facts:
        refused({**said, key: None})
    refused({**said, "times": [*said["times"][:-1], (59.5).hex()]})
    for name, bound in made.bounds.items():
        refused({**said, "bounds": {**said["bounds"], name: str(float(bound) * 0.99)}})
    refused({**said, "bounds": {}})
    refused(said, data=made.data[:-1] + bytes([made.data[-1] ^ 1]))
    refused(said, function=replace(made))
    refused(said, proved=replace(proved))


def test_a_time_outside_of_the_span_is_refused():
    from reference import InputError

    function = evaluator(proved_function(short("paris", "60")))
    for t in (-1e-300, 60.00000001, float("nan"), float("inf"), [[1.0, 2.0], [3.0, 61.0]]):
        with pytest.raises(InputError, match="times from 0 to 60 s"):
            function.at(t)
    assert function.at([]).x.shape == (0,)
