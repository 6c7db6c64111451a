"""Faults in the trusted lines of a box, one at a time in a copy of the module: each has to be found."""

from fractions import Fraction
from random import Random

import numpy as np
import pytest
from boxes import SECTIONS, drawn, outside, truth, widened
from enclosure_oracle import scene
from enclosure_recurrence import Recurrence
from flint import arb
from sabotage import sabotaged
from sampled import one_in

import reference.enclosure.box
from reference.enclosure.approximant import pair
from reference.enclosure.bound import Piece, SceneBalls
from reference.enclosure.prove import until
from reference.numbers.taylor_step import EARTH, TaylorStep

SOURCE = reference.enclosure.box.__file__
BITS, UNIT = 96, 1 << 96
SLACK = 1 + 1e-9  # of the truth in doubles


def defects_hold(module):
    """Lemmas 11.2 and 11.3 at made-up polynomials: p = a + b s, constants and boxes of every kind."""
    rng = np.random.default_rng(3)
    for kind in range(120):
        a = unit(rng) * rng.choice([1, 0.5, 2])
        across = np.cross(a, unit(rng))
        b = [across / np.linalg.norm(across), a / np.linalg.norm(a), 0 * a][kind % 3] * rng.choice([1e-3, 1])
        omega, off = (
            np.array([0, 0, rng.choice([0, 1.0])]),
            np.array([0, *rng.normal(size=2)]) * rng.choice([0, 1e-3, 1]),
        )
        if kind % 4 == 0:  # along p, but for its x, which Ω has not
            off = np.array([0, *a[1:]]) * rng.choice([1e-3, 1])
        if kind % 5 == 0:  # perpendicular to p
            off = np.array([0, -a[2], a[1]]) * rng.choice([1e-3, 1])
        if kind == 0:  # all of it is in the first term
            a, b, omega, off = np.array([0, 0.6, 0.8]), np.array([0.05, 0, 0]), np.zeros(3), np.array([0, 6e-4, 8e-4])
        drag, more = rng.choice([0, 0.5]) * (kind > 0), rng.choice([0, 0.25]) * (kind > 0)
        d2, jump, actual, jumped = made_up(module, a, b, omega, off, drag, more, rng)
        assert actual <= d2 * SLACK, (kind, actual, d2)
        assert jumped <= jump * SLACK, (kind, jumped, jump)


def unit(rng):
    a = rng.normal(size=3)
    return a / np.linalg.norm(a)


def made_up(module, a, b, omega, off, drag, more, rng):
    """Bound of d2 and of a jump; the largest that they are for a member of the box whose Ω is omega ± off."""
    balls = SceneBalls(scene(rotation_rate="0.1"), BITS + 64)
    balls.omega, balls.drag, balls.c = [arb(x) for x in omega], arb(drag), [arb(0)] * 3
    balls.turning = [arb(x) + arb(0, abs(y)) for x, y in zip(omega, off, strict=True)]
    balls.damping = arb(drag) + arb(0, more)
    rows = tuple([int(x * UNIT), int(y * UNIT)] for x, y in zip(a, b, strict=True))
    step = TaylorStep(Fraction(0), Fraction(1), Fraction(0), Fraction(1), BITS, (*rows, [0, 0]), EARTH)
    bound = module.BoxRadius(balls)
    gap = rng.normal(size=3) * rng.choice([0, 0.1])
    start = a + gap
    bound.last = [arb(x) for x in (*start, *np.cross(start, b + np.cross(omega, start)))]
    _, sizes, jump = bound.widened(Piece(balls, step))
    found, jumped = [], []
    for signs in [(0, 1, 1), (0, 1, -1), (0, -1, 1), (0, -1, -1)]:
        for g in (drag - more, drag + more):
            W = omega + np.array(signs) * np.abs(off)
            for s in np.linspace(0, 1, 5):
                p, v = a + b * s, b
                V = v + np.cross(W, p)
                K, rate = np.cross(p, V), np.cross(v, V) + np.cross(p, np.cross(W, v))
                found.append(np.linalg.norm(rate - np.cross(K, W) + g * (K - W + np.dot(W, p) * p)))
            K = [np.cross(x, b + np.cross(W, x)) for x in (a, start)]
            jumped.append(np.linalg.norm(gap) + np.linalg.norm(K[0] - K[1]) / float(balls.w0))
    return float(sizes.d2), float(jump), max(found), max(jumped)


SHORT_RUNS = {  # close to equality: in small steps, and early
    "length": ({"rotation_rate": "0"}, {"length": "0.1"}, 9),
    "gravity": ({"rotation_rate": "0"}, {"gravity": "0.01"}, 9),
    "rate": ({"gravity_is": "effective", "rotation_rate": "0", "x": "20"}, {"rotation_rate": "1e-6"}, 1),
    "latitude": ({"gravity_is": "effective", "rotation_rate": "1e-4", "x": "20"}, {"latitude": "0.01"}, 1),
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
    "gravity and vx": ({"rotation_rate": "0", "x": "0", "y": "0", "vx": "1"}, {"gravity": "0.1"}, 9),
    "gravity and y": ({"rotation_rate": "0", "x": "0", "y": "1", "vx": "0.1"}, {"gravity": "0.1"}, 9),
    "nearly upright": ({"length": "1", "angles": ("170", "30", "0", "0")}, {"angle": "1e-9"}, 2),
    "narrow": ({"rotation_rate": "0.001", "latitude": "20", "altitude": "1000"}, {"length": "1e-9"}, 9),
    "narrow, effective": ({"rotation_rate": "0.001", "gravity_is": "effective"}, {"length": "1e-9"}, 9),
    "all of it": (
        {"rotation_rate": "0.001", "y": "0", "x": "3"},
        {"length": "0.5", "gravity": "0.05", "latitude": "0.1", "x": "0.001", "vx": "0.001"},
        30,
    ),
}
# these find every fault that is tried in every run and that made-up polynomials do not; test_box.py follows more boxes
IN_EVERY_RUN = ("gravity", "rate", "drag", "nearly upright", "narrow")
TRUTHS = {}


def runs_hold(module, names=SHORT_RUNS):
    """Pendulums at the corners of a box lie inside, in states and transits."""
    for name in names:
        changes, widths, end = SHORT_RUNS[name]
        box = widened(scene(t_end=str(end), **{"drag": "1e-3", **changes} if name == "drag" else changes), widths)
        times = [Fraction(end * k, 40) for k in range(41)]
        windows = module.Windows(box, BITS + 64, times, True, SECTIONS)
        chain = pair(Recurrence(SceneBalls(box.inputs, BITS + 64), BITS, 24).chain(Fraction(1, 16)))
        for step in until(chain, windows.course.times[-1]):
            windows.course.advance(step)
        proved = windows.finish()
        assert "narrow" not in name or float(windows.course.bound.eta) < 1e-10
        if name not in TRUTHS:
            rng = Random(1)
            TRUTHS[name] = [truth(drawn(box, rng, True), times) for _ in range(6)]
        for run in TRUTHS[name]:
            assert outside(proved, run) == [], name


FAULTS = [
    ("ball(low).union(ball(high))", "ball(low)"),
    ("ball(low).union(ball(high))", "ball(high)"),
    ('wide["latitude"] / 90', 'wide["latitude"] / 180'),
    ("(1 - cos) / 2).sqrt()", "(1 + cos) / 2).sqrt()"),
    (" + altitude)", ")"),
    ("push * sin / 2", "push * sin"),
    ("push * sin / 2", "-push * sin / 2"),
    ("gravity - push * (1 + cos) / 2", "gravity"),
    ("gravity - push * (1 + cos) / 2", "gravity - push * (1 - cos) / 2"),
    ('0 if wide["gravity_is"] == "effective" else 1', "1"),
    ('0 if wide["gravity_is"] == "effective" else 1', "0"),
    ("(pull / self.length / ", "(pull / 67 / "),
    ("arb.atan2(-w, m) - lean", "arb.atan2(-w, m)"),
    ("arb.atan2(-w, m) - lean", "arb.atan2(-w, m) + lean"),
    ('(turn - ball(wide["latitude"])', '(turn.mid() - ball(wide["latitude"]).mid()'),
    ('(turn - ball(wide["latitude"])', '(turn + ball(wide["latitude"])'),
    ('times(ball(wide["rotation_rate"]) / self.pace, ', "times(self.own.omega[2] / self.pace, "),
    ("times(1 / self.pace, self.turned(self.release[1], 1))", "self.turned(self.release[1], 1)"),
    ('ball(wide["drag"]) / self.pace', "self.own.drag"),
    ("self.omega, self.drag = own.omega, own.drag", "self.drag = own.drag"),
    ("k.omega, k.drag_size = times(h, balls.turning), upper(h * balls.damping)", "pass"),
    ("2 * along * v1 + ", ""),
    ("2 * along * v1 + ", "along * v1 + "),
    ("turn * norms[7] + ", ""),
    (" + d.p**2 * turn * (k.omega_size + piece.k.omega_size)", ""),
    ("(k.omega_size + piece.k.omega_size)", "(k.omega_size - piece.k.omega_size)"),
    (" + slow * d.p * v1", ""),
    (" + 2 * turn / h * gap * (2 * d.p + gap)", ""),
    ("upper(gap + moved / balls.w0)", "upper(moved / balls.w0)"),
    ("upper(gap + moved / balls.w0)", "gap"),
    ("self.eta + jump + span", "jump + span"),
    ("self.eta + jump + span", "self.eta + span"),
    ("+ d.d2 / w + d.d1)", "+ d.d1)"),
    ("start * (span * rate / (2 * w)).exp()", "start"),
    ("start * (span * rate / (2 * w)).exp()", "start * (span * rate / (20 * w)).exp()"),
    ("low, high = self.pace.low * self.times[n], self.pace.high * self.times[n]", "low = high = self.times[n]"),
    ("low, high = self.pace.low * self.times[n],", "low, high = self.times[n],"),
    ("self.pace.high * self.times[n]\n", "self.times[n]\n"),
    ("max(low, covered.piece.begin), min(high, covered.piece.end)", "*2 * (max(low, covered.piece.begin),)"),
    ("zip(*self.hulls[n : n + 1], *parts, strict=True)", "zip(*parts, strict=True)"),
    ("times(length, x[:3])", "times(67, x[:3])"),
    ("times(length * pace, x[3:])", "times(length, x[3:])"),
    ('"t": 1 / pace', '"t": pace'),
    ('"t": 1 / pace', '"t": arb(1)'),
    ('"vy": pace', '"vy": arb(1)'),
    ('"ax": pace**2', '"ax": pace'),
    ('"ax": pace**2', '"ax": arb(1)'),
    ("near(f, s) / piece.unit", "f(s.mid()) / piece.unit"),
    ("q + arb(0, eta)", "q"),
    ("(q + arb(0, u))", "q"),
    ("1 - x * x - y * y", "1 - x * x"),
    ("-below.sqrt()", "below.sqrt()"),
    ("-(x * vx + y * vy) / z", "(x * vx + y * vy) / z"),
    ("-(x * vx + y * vy) / z", "-(x * vx + y * vy)"),
    ("(x * vx + y * vy) / z", "x * vx / z"),
]


def test_without_a_fault_nothing_is_found(size):
    module = sabotaged("PARTS = 16", "PARTS = 16 ", SOURCE)
    runs_hold(module, size(IN_EVERY_RUN, SHORT_RUNS))
    defects_hold(module)


@pytest.mark.parametrize("old, new", one_in(16, FAULTS))
def test_a_fault_is_found(old, new, size):
    module = sabotaged(old, new, SOURCE)
    with pytest.raises((AssertionError, ArithmeticError, TypeError, AttributeError, ValueError)):
        runs_hold(module, size(IN_EVERY_RUN, SHORT_RUNS))
        defects_hold(module)
