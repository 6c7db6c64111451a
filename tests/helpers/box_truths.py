"""What has to hold for the trusted code of boxes, whichever module has it: box.py, or a mutation of it."""

from dataclasses import replace
from fractions import Fraction
from random import Random
from types import SimpleNamespace

import derivative_truths
import numpy as np
import pytest
from boxes import WORDS, drawn, outside, truth, widened
from derivative_truths import cross
from enclosure_oracle import scene
from enclosure_recurrence import Recurrence
from flint import arb, arb_series, fmpq, fmpz_poly

import reference.enclosure.trusted.derivatives
from reference.enclosure.approximant import pair
from reference.enclosure.prove import until
from reference.enclosure.trusted.course import FINISHED
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.radius import Jump, PhasePoint
from reference.enclosure.trusted.shapes import Box, Covered, EnclosedZero, Interval, Sizes, Tube
from reference.enclosure.trusted.system import SceneBalls
from reference.enclosure.trusted.tube import tube
from reference.numbers.taylor_step import EARTH, TaylorStep

BITS, UNIT = 96, 1 << 96
SLACK = 1 + 1e-9  # of the truth in doubles


def defects_hold(module):
    """Lemmas 11.2 and 11.3 at made-up polynomials: p = a + b s, constants and boxes of every kind."""
    rng = np.random.default_rng(3)
    for kind in range(120):
        a = unit(rng) * rng.choice([1, 0.5, 2])
        across = cross(a, unit(rng))
        b = [across / np.linalg.norm(across), a / np.linalg.norm(a), 0 * a][kind % 3] * rng.choice(
            [1e-3, 1]
        )
        omega, off = (
            np.array([0, 0, rng.choice([0, 1.0])]),
            np.array([0, *rng.normal(size=2)]) * rng.choice([0, 1e-3, 1]),
        )
        if kind % 4 == 0:  # along p, but for its x, which Ω has not
            off = np.array([0, *a[1:]]) * rng.choice([1e-3, 1])
        if kind % 5 == 0:  # perpendicular to p
            off = np.array([0, -a[2], a[1]]) * rng.choice([1e-3, 1])
        if kind == 0:  # all of it is in the first term
            a, b, omega, off = (
                np.array([0, 0.6, 0.8]),
                np.array([0.05, 0, 0]),
                np.zeros(3),
                np.array([0, 6e-4, 8e-4]),
            )
        drag, more = rng.choice([0, 0.5]) * (kind > 0), rng.choice([0, 0.25]) * (kind > 0)
        gap = rng.normal(size=3) * rng.choice([0, 0.1])
        d2, jump, actual, jumped = made_up(module, a, b, omega, off, drag, more, gap)
        assert actual <= d2 * SLACK, (kind, actual, d2)
        assert jumped <= jump * SLACK, (kind, jumped, jump)

    # a long p, so that what P multiplies counts: drag that differs, and a jump along p across what Ω differs by
    still, long, rate = np.zeros(3), np.array([5.0, 0, 0]), np.array([0, 0.05, 0])
    for off, more in ((still, 0.25), (np.array([0, 0, 1.0]), 0)):
        d2, jump, actual, jumped = made_up(module, long, rate, still, off, 0, more, 0.1 * long / 5)
        assert actual <= d2 * SLACK, (actual, d2)
        assert jumped <= jump * SLACK, (jumped, jump)


def growth_holds(module):
    """Lemma 11.4 at made-up numbers: a radius is at least what its own rate makes of it, or it is refused."""
    rng, accepted = np.random.default_rng(4), 0
    for _ in range(400):
        eta, jump, d1, d2, tau, speed, c, drag, omega, below, above = rng.uniform(
            size=11
        ) * rng.choice([0, 1], size=11)
        w, span, p, rate = rng.uniform(0.1, 2, size=4) * (1, 0.2, 1, rng.choice([0, 1]))
        eta += 0.1
        names = ["w", "S", "c_size", "drag_size", "omega_size", "lambda_minus", "lambda_plus"]
        sizes = map(arb, map(float, (w, speed, c, drag, omega, below, above - 0.5)))
        k = SimpleNamespace(**dict(zip(names, sizes, strict=True)))
        d = Sizes(*(arb(float(x)) for x in (d1, d2, p, rate, tau, 0)))
        piece = SimpleNamespace(
            constants=k, step=SimpleNamespace(low=Fraction(0), high=Fraction(span))
        )
        start = eta + jump + span * ((c + rate**2) * tau / (2 * w) + d2 / w + d1)
        least = start
        for _ in range(200):
            curved = max(below, above - 0.5 + (speed + (w + rate) * least) ** 2)
            growth = curved + (c + rate**2) * least + drag * omega * p
            least = min(start * np.exp(min(span * growth / (2 * w), 50)), 1e9)
        bound = SimpleNamespace(eta=arb(float(eta)))
        try:
            tube = module.BoxRadius.grown(bound, piece, module.Widened(d, arb(float(jump)))).tube
        except ArithmeticError:
            continue
        accepted += 1
        assert least <= float(bound.eta) * SLACK, "the radius"
        fastest = (w + rate) * least + (rate + omega) * least + d1
        assert fastest <= float(tube.u) * SLACK, "what follows from it"
    assert accepted > 100


def parts_hold(module):
    """Parts of a step cover it, from one time to another, and are short."""
    for begin, end in (
        (0, 0),
        (0, Fraction(1, 3)),
        (Fraction(1, 5), 2),
        (-1, Fraction(1, 7)),
        (1, 3),
    ):
        piece = SimpleNamespace(step=SimpleNamespace(centre=Fraction(1), h=Fraction(2)))
        parts = module.spread(piece, Fraction(begin), Fraction(end))
        for k in range(101):
            s = (begin + (end - begin) * Fraction(k, 100) - 1) / 2
            assert any(part.contains(fmpq(s.numerator, s.denominator)) for part in parts)
        assert all(part.rad() < 0.06 for part in parts)


def unit(rng):
    a = rng.normal(size=3)
    return a / np.linalg.norm(a)


def made_up(module, a, b, omega, off, drag, more, gap):
    """Bound of d2 and of a jump; the largest that they are for a member of the box whose Ω is omega ± off."""
    balls = SceneBalls(scene(rotation_rate="0.1"), BITS + 64)
    balls.omega_0, balls.drag_0, balls.c = [arb(x) for x in omega], arb(drag), [arb(0)] * 3
    balls.omega = [arb(x) + arb(0, abs(y)) for x, y in zip(omega, off, strict=True)]
    balls.drag = arb(drag) + arb(0, more)
    rows = tuple([int(x * UNIT), int(y * UNIT)] for x, y in zip(a, b, strict=True))
    step = TaylorStep(
        Fraction(0), Fraction(1), Fraction(0), Fraction(1), BITS, (*rows, [0, 0]), EARTH
    )
    bound = module.BoxRadius(balls)
    start = a + gap
    momentum = cross(start, b + cross(omega, start))
    bound.last = PhasePoint([arb(x) for x in start], [arb(x) for x in momentum])
    sizes, jump = bound.widened(Piece(balls, step))
    found, jumped = [], []
    for signs in [(0, 1, 1), (0, 1, -1), (0, -1, 1), (0, -1, -1)]:
        for g in (drag - more, drag + more):
            W = omega + np.array(signs) * np.abs(off)
            for s in np.linspace(0, 1, 5):
                p, v = a + b * s, b
                V = v + cross(W, p)
                K, rate = cross(p, V), cross(v, V) + cross(p, cross(W, v))
                found.append(np.linalg.norm(rate - cross(K, W) + g * (K - W + np.dot(W, p) * p)))
            K = [cross(x, b + cross(W, x)) for x in (a, start)]
            jumped.append(np.linalg.norm(gap) + np.linalg.norm(K[0] - K[1]) / float(balls.w0))
    return float(sizes.d2), float(jump), max(found), max(jumped)


SHORT_RUNS = {  # close to equality: in small steps, and early
    "length": ({"rotation_rate": "0"}, {"length": "0.1"}, 9),
    "gravity": ({"rotation_rate": "0"}, {"gravity": "0.01"}, 9),
    "rate": (
        {"gravity_is": "effective", "rotation_rate": "0", "x": "20"},
        {"rotation_rate": "1e-6"},
        1,
    ),
    "latitude": (
        {"gravity_is": "effective", "rotation_rate": "1e-4", "x": "20"},
        {"latitude": "0.01"},
        1,
    ),
    "lean": ({"rotation_rate": "0.001", "x": "0", "y": "0"}, {"latitude": "0.01"}, 9),
    "altitude": ({"rotation_rate": "0.001", "x": "0", "y": "0"}, {"altitude": "1000"}, 9),
    "radius": ({"rotation_rate": "0.001", "x": "0", "y": "0"}, {"equatorial_radius": "1000"}, 9),
    "shape": ({"rotation_rate": "0.001", "x": "0", "y": "0"}, {"flattening": "1e-4"}, 9),
    "drag": ({"rotation_rate": "0", "x": "20"}, {"drag": "1e-5"}, 1),
    "x": ({"rotation_rate": "0"}, {"x": "0.001"}, 4),
    "vy": ({"rotation_rate": "0"}, {"vy": "0.001"}, 4),
    "angle": ({"angles": ("20", "30", "0", "0")}, {"angle": "0.001"}, 2),
    "azimuth": ({"angles": ("20", "30", "0", "0")}, {"azimuth": "0.001"}, 2),
    "angle_rate": ({"angles": ("20", "30", "1", "2")}, {"angle_rate": "0.001"}, 1),
    "azimuth_rate": ({"angles": ("20", "30", "1", "2")}, {"azimuth_rate": "0.001"}, 1),
    "large": ({"angles": ("60", "30", "20", "2")}, {"angle": "0.3"}, 3),
    "gravity and v": (
        {"rotation_rate": "0", "x": "0", "y": "0", "vx": "1", "vy": "0.5"},
        {"gravity": "0.1"},
        9,
    ),
    "gravity and y": (
        {"rotation_rate": "0", "x": "0", "y": "1", "vx": "0.1"},
        {"gravity": "0.1"},
        9,
    ),
    "nearly upright": ({"length": "1", "angles": ("170", "30", "0", "0")}, {"angle": "1e-9"}, 2),
    "narrow": (
        {"rotation_rate": "0.001", "latitude": "20", "altitude": "1000"},
        {"length": "1e-9"},
        9,
    ),
    "narrow, effective": (
        {"rotation_rate": "0.001", "gravity_is": "effective"},
        {"length": "1e-9"},
        9,
    ),
    "wide": derivative_truths.WIDE,
    "all of it": (
        {"rotation_rate": "0.001", "y": "0", "x": "3"},
        {"length": "0.5", "gravity": "0.05", "latitude": "0.1", "x": "0.001", "vx": "0.001"},
        30,
    ),
}
# these find every fault that is tried in every run and that made-up polynomials do not; test_box.py follows more boxes
IN_EVERY_RUN = ("wide", "gravity", "rate", "drag", "nearly upright", "narrow")
TRUTHS = {}


def runs_hold(module, names=SHORT_RUNS):
    """Pendulums at the corners of a box lie inside, in states and zeros."""
    for name in names:
        changes, widths, end = SHORT_RUNS[name]
        box = widened(
            scene(t_end=str(end), **{"drag": "1e-3", **changes} if name == "drag" else changes),
            widths,
        )
        times = [Fraction(end * k, 40) for k in range(41)]
        windows = module.Windows(box, BITS + 64, times, WORDS)
        chain = pair(Recurrence(SceneBalls(box.inputs, BITS + 64), BITS, 24).chain(Fraction(1, 16)))
        covered = []
        windows.course.followers.append(SimpleNamespace(advance=covered.append))
        for step in until(chain, windows.course.times[-1]):
            windows.course.advance(step)
        with pytest.raises(ArithmeticError, match="course alone"):
            windows.advance(covered[-1])
        proved = windows.finish()
        assert proved in FINISHED, "only what counts as proved may be handed on"
        assert "narrow" not in name or float(windows.course.bound.eta) < 1e-10
        if name not in TRUTHS:
            rng = Random(1)
            TRUTHS[name] = [truth(drawn(box, rng, True), times) for _ in range(6)]
        for run in TRUTHS[name]:
            assert outside(proved, run) == [], name


def chain_rule_holds(module, names=derivative_truths.RUNS):
    """What derivatives are made of, by derivatives as they are."""
    derivative_truths.runs_hold(
        reference.enclosure.trusted.derivatives, names, ("box", "point"), module.Windows
    )


def radii_hold(module):
    """Lemma 11.4: the radius and what is refused are those of (11.4a, b), computed once more in doubles."""
    rng, accepted = np.random.default_rng(10), 0
    for _ in range(60):
        w, S, c, drag, omega, below, above, P, K = rng.uniform(0.2, 2, size=9)
        eta, jump, d1, d2, tau = rng.uniform(0.002, 0.02, size=5)
        length = rng.uniform(0.1, 0.6)
        below *= rng.choice([1, 4])
        constants = SimpleNamespace(
            w=arb(w), S=arb(S), c_size=arb(c), drag_size=arb(drag), omega_size=arb(omega),
            lambda_minus=arb(below), lambda_plus=arb(above),
        )  # fmt: skip
        sizes = Sizes(arb(d1), arb(d2), arb(P), arb(K), arb(tau), arb(0))
        step = SimpleNamespace(low=Fraction(-1, 4), high=Fraction(length) - Fraction(1, 4))
        piece = SimpleNamespace(constants=constants, step=step)

        driven = eta + jump + length * ((c + K**2) * tau / (2 * w) + d2 / w + d1)
        still = max(below, above + S**2) + drag * omega * P
        E = 2 * driven * np.exp(length * still / (2 * w))
        curved = max(below, above + (S + (w + K) * E) ** 2) + (c + K**2) * E + drag * omega * P
        radius = driven * np.exp(min(length * curved / (2 * w), 50))

        bound = SimpleNamespace(eta=arb(eta))
        widened_step = module.Widened(sizes, arb(jump))
        if radius >= E:
            with pytest.raises(ArithmeticError, match="outgrown"):
                module.BoxRadius.grown(bound, piece, widened_step)
            continue
        accepted += 1
        found = module.BoxRadius.grown(bound, piece, widened_step).tube
        wanted = tube(constants, sizes, arb(radius), arb((w + K) * radius))
        assert float(bound.eta) == pytest.approx(radius, rel=1e-9)
        assert [float(x) for x in found] == pytest.approx([float(x) for x in wanted], rel=1e-9)
    assert 20 < accepted < 55


def widening_holds(module):
    """Lemmas 11.2 and 11.3: (11.2a, b) and (11.3a), computed once more in doubles."""
    rng = np.random.default_rng(11)
    for sign in (1, -1):
        omega, omega_0, delta_p, delta_K = rng.uniform(0.2, 3, size=(4, 3))
        h, omega_size, drag, p_rate, tau_rate, w0, P, d2 = rng.uniform(0.2, 3, size=8)
        rows = rng.integers(-9, 10, size=(3, 3))
        constants = SimpleNamespace(
            h=arb(h), omega=[arb(x) for x in omega], omega_0=[arb(x) for x in omega_0],
            omega_size=arb(omega_size), drag=arb(drag), drag_0=arb(drag + 0.5 * sign),
        )  # fmt: skip
        piece = SimpleNamespace(
            constants=constants,
            norms=SimpleNamespace(p_rate=arb(p_rate), tau_rate=arb(tau_rate)),
            sizes=Sizes(arb(1), arb(d2), arb(P), arb(2), arb(3), arb(4)),
            p=[fmpz_poly([int(x) for x in row]) for row in rows],
            step=SimpleNamespace(bits=2),
        )
        jump = Jump([arb(x) for x in delta_p], [arb(x) for x in delta_K])
        bound = SimpleNamespace(
            join=lambda _, jump=jump: jump, balls=SimpleNamespace(prec=64, w0=arb(w0))
        )
        found = module.BoxRadius.widened(bound, piece)

        off = np.linalg.norm(omega - omega_0)
        along = (np.abs(rows).sum(axis=1) / 4) @ np.abs(omega - omega_0)
        D2 = d2 + 2 * along * p_rate + off * tau_rate + 0.5 * P * p_rate
        D2 += P**2 * off * (omega_size + np.linalg.norm(omega_0))
        p_jump = np.linalg.norm(delta_p)
        K_jump = np.linalg.norm(delta_K) + 2 * off / h * p_jump * (2 * P + p_jump)
        assert float(found.sizes.d2) == pytest.approx(D2, rel=1e-9)
        assert float(found.jump) == pytest.approx(p_jump + K_jump / w0, rel=1e-9)
        assert found.sizes._replace(d2=piece.sizes.d2) == piece.sizes


def plumb_lines_hold(module):
    """(11.1b) in doubles; effective gravity is along the plumb line, and contains what the rotation takes off."""
    site = {"gravity": 10, "altitude": 2, "rotation_rate": 0.5, "equatorial_radius": 8}
    site |= {"flattening": 0.25, "latitude": 30}
    wide = {name: Fraction(x) for name, x in site.items()}
    lean, pull = module.plumb(wide | {"gravity_is": "ellipsoid"})
    push = 0.5**2 * (8 / np.sqrt(1 - 0.25 * 1.75 * np.sin(np.pi / 6) ** 2) + 2)
    aside, down = push * np.sin(np.pi / 3) / 2, 10 - push * (1 + np.cos(np.pi / 3)) / 2
    assert float(lean) == pytest.approx(np.arctan2(aside, down), rel=1e-9)
    assert float(pull) == pytest.approx(np.hypot(aside, down), rel=1e-9)
    lean, pull = module.plumb(wide | {"gravity_is": "effective"})
    assert float(lean) == 0
    assert float(pull) == pytest.approx(10)


def spheres_hold(module):
    """Below the suspension z and vz follow from the sphere (11.6, 11.7), of series as well; else they stay."""
    x, y, vx, vy = arb(0.48), arb(0.36), arb(1), arb(2)
    for z, vz, found in ((arb(-1, 0.5), arb(0, 9), (-0.8, 1.5)), (arb(1, 0.5), arb(2), (1, 2))):
        made = module.on_the_sphere(x, y, z, vx, vy, vz)
        assert made[:2] + made[3:5] == [x, y, vx, vy]
        assert [float(made[2]), float(made[5])] == pytest.approx(found)
        assert float(made[5].rad()) < 1e-9

    # along x: z' = -x x'/z, and vz' = -(x' vx)/z + x vx z'/z²
    none = arb_series([arb(0), arb(0)], 2)
    vague = arb_series([arb(-1, 0.5), arb(0, 9)], 2), arb_series([arb(0, 9), arb(0, 9)], 2)
    along = arb_series([arb(0.6), arb(1)], 2)
    speed = arb_series([arb(2), arb(0)], 2)
    *_, z, _, _, vz = module.on_the_sphere(along, none, vague[0], speed, none, vague[1])
    assert [float(z[0]), float(z[1])] == pytest.approx([-0.8, 0.75])
    assert [float(vz[0]), float(vz[1])] == pytest.approx([1.5, 2.5 + 1.2 * 0.75 / 0.64])
    assert all(float(q[k].rad()) < 1e-9 for q in (z, vz) for k in (0, 1))


def hulls_hold(module):
    """A state at an output time is the hull of those at all times when a pendulum may have it."""
    balls = SceneBalls(scene(rotation_rate="0"), BITS + 64)
    windows = SimpleNamespace(
        course=SimpleNamespace(open=False), times=[4, 8, 16], done=0, hulls=[],
        pace=Interval(Fraction(3, 4), Fraction(5, 4)),
    )  # fmt: skip
    passed = []
    for begin in (2, 4, 6, 8, 10):  # x is the time
        rows = ([(begin + 1) << BITS, 1 << BITS], [0], [0], [0])
        step = TaylorStep(
            Fraction(begin + 1), Fraction(1), Fraction(-1), Fraction(1), BITS, rows, EARTH
        )
        covered = Covered(Piece(balls, step), Tube(arb(0), arb(0), arb(0)))
        module.Windows.advance(windows, covered)
        passed.append(windows.done)
    ends = [(float(x.lower()), float(x.upper())) for x, *_ in windows.hulls]
    for found, wanted in zip(ends, ((3, 5), (6, 10), (12, 12)), strict=True):
        assert found == pytest.approx(wanted)
    assert passed == [0, 1, 1, 2, 2]


def wrong_boxes_are_refused(module):
    """A drag below 0 at either end, a run from a later time on, and one that was not followed to its end."""
    low, high = (scene(drag=drag) for drag in ("0", "1e-4"))
    below = replace(low, drag=Fraction(-1, 10**4))
    for ends in ((below, high), (high, below)):
        with pytest.raises(ArithmeticError, match="drag"):
            module.BoxBalls(Box(low, *ends), BITS)
    with pytest.raises(ArithmeticError, match="from its release on"):
        module.Windows(Box(low, low, low), BITS, [Fraction(1), Fraction(2)], ())
    windows = SimpleNamespace(
        course=SimpleNamespace(finish=lambda: None), done=1, times=[Fraction(0), Fraction(1)]
    )
    with pytest.raises(ArithmeticError, match="do not end with the run"):
        module.Windows.finish(windows)


def bounds_of_the_motion_hold(module):
    """(4.5) to (4.7) in the scene's time, in which a pendulum under less gravity is faster; γ₀ is the scene's own."""
    fast = {"x": "0", "y": "0", "vx": "3", "length": "1", "gravity": "10", "rotation_rate": "0"}
    hanging = scene(drag="0.25", **fast)
    balls = module.BoxBalls(widened(hanging, {"gravity": "0.2", "drag": "0.25"}), BITS)
    slowest = np.sqrt(0.98)  # pace: the square root of the gravity over the scene's
    speed = 3 / slowest
    assert speed <= float(balls.S) == pytest.approx(speed, rel=1e-3)
    assert speed**2 / 2 <= float(balls.lambda_minus) == pytest.approx(speed**2 / 2, rel=1e-3)
    assert 0 <= float(balls.lambda_plus) == pytest.approx(0, abs=1e-9)
    assert float(balls.drag_0) == 0.25


def own_times_hold(module):
    """Zeros that may come up to the end, in each pendulum's own time: the first ones, or it is refused."""
    windows = SimpleNamespace(balls=SimpleNamespace(pace=arb(2)), times=[Fraction(0), Fraction(5)])

    def zero(low, high):
        there = Interval(Fraction(-1), Fraction(3))
        t = Interval(Fraction(low), Fraction(high))
        return EnclosedZero("one", 1, t, there, there, there, vy=there, ax=there)

    zeros = zero(2, 3), zero(9, 11), zero(12, 13)
    own = module.Windows._in_own_time(windows, zeros)
    assert len(own) == 2
    for z, ends in zip(own, ((1, 1.5), (4.5, 5.5)), strict=True):
        assert (z.x, z.vx) == (zeros[0].x, None)
        found = [float(end) for q in (z.t, z.vy, z.ax) for end in (q.low, q.high)]
        assert found == pytest.approx([*ends, -2, 6, -4, 12])
    with pytest.raises(ArithmeticError, match="in order"):
        module.Windows._in_own_time(windows, (zeros[0], zeros[2], zeros[1]))


def all_hold(module, long):
    bounds_of_the_motion_hold(module)
    own_times_hold(module)
    plumb_lines_hold(module)
    spheres_hold(module)
    hulls_hold(module)
    wrong_boxes_are_refused(module)
    radii_hold(module)
    widening_holds(module)
    defects_hold(module)
    growth_holds(module)
    parts_hold(module)
    runs_hold(module, SHORT_RUNS if long else IN_EVERY_RUN)
    chain_rule_holds(module, derivative_truths.RUNS if long else derivative_truths.IN_EVERY_RUN)
