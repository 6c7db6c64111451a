"""Faults in the trusted lines of derivatives, one at a time in a copy of the module: each has to be found."""

from fractions import Fraction
from random import Random
from types import SimpleNamespace

import numpy as np
import pytest
from boxes import SECTIONS, azimuths, drawn, inputs_of, moved, outside, truth, widened
from enclosure_oracle import scene
from enclosure_recurrence import Recurrence
from flint import arb, arb_poly, ctx
from sabotage import sabotaged
from sampled import one_in

import reference.enclosure.box
import reference.enclosure.derivatives
from reference.enclosure.approximant import pair
from reference.enclosure.bound import SceneBalls
from reference.enclosure.box import Windows
from reference.enclosure.prove import until
from reference.enclosure.shapes import Box, Covered, Sizes, Tube
from reference.enclosure.tangents import TangentSource, scales_of
from reference.numbers.columns import GRID

SOURCE, BOX = reference.enclosure.derivatives.__file__, reference.enclosure.box.__file__
BITS = 96
SLACK = 1 + 1e-9


def balls(a):
    return [arb(float(x)) for x in a]


def unit(rng):
    a = rng.normal(size=3)
    return a / np.linalg.norm(a)


def residuals_hold(module):
    """R1, R2 and the misses of tangency are those of the formulas, at made-up polynomials a + b s."""
    rng = np.random.default_rng(5)
    for kind in range(200):
        p, K, P, Q = (
            rng.normal(size=(2, 3)) * [[1], [kind % 2]] for _ in range(4)
        )  # constants: their bounds are exact
        omega, turn, c = rng.normal(size=(3, 3)) * rng.choice([0, 1], size=(3, 1))
        drag, slow, h = rng.choice([0, 0.5]), rng.choice([0, 0.25]), rng.choice([1, 0.5, 3])
        k = SimpleNamespace(h=arb(h), c=balls(c), drag=arb(drag))
        way = SimpleNamespace(turn=balls(turn), slow=arb(slow))
        poly = [[arb_poly(balls(column)) for column in rows.T] for rows in (p, K, P, Q)]
        with ctx.workprec(128):
            found = module.residuals(SimpleNamespace(k=k), balls(omega), *poly[:2], way, [*poly[2], *poly[3]])
        turn, slow = h * turn, h * slow
        for s in (-1.0, -0.3, 0.4, 1.0):
            x, y, u, v = (rows[0] + rows[1] * s for rows in (p, K, P, Q))
            r1 = P[1] - np.cross(v, x) - np.cross(y - omega, u) + np.cross(turn, x)
            r2 = Q[1] - np.cross(u, c) - np.cross(v, omega) - np.cross(y, turn)
            r2 = r2 + drag * (v - turn + (turn @ x) * x + (omega @ u) * x + (omega @ x) * u)
            r2 = r2 + slow * (y - omega + (omega @ x) * x)
            sizes = [*map(np.linalg.norm, (u, v, r1, r2)), abs(x @ u), abs(y @ u + x @ v)]
            for n, (bound, size) in enumerate(zip(found, sizes, strict=True)):
                assert size <= float(bound) * SLACK, (kind, n)


def drive(r, H, W, P, Q, turn, gamma, slow):
    """The terms of ρ' and χ' that (P, Q) do not drive by themselves: those that change with r, H, Ω, γ."""
    first = np.cross(Q, r) + np.cross(H - W, P) - np.cross(turn, r)
    inner = Q - turn + (turn @ r) * r + (W @ P) * r + (W @ r) * P
    second = np.cross(Q, W) + np.cross(H, turn) - gamma * inner - slow * (H - W + (W @ r) * r)
    return first, second


def sources_hold(module):
    """S1, S2, A and B bound what the tube and the box add, one kind of it at a time."""
    rng = np.random.default_rng(6)
    for kind in range(500):
        on = rng.choice([0, 1], size=7, p=[0.6, 0.4])
        if kind % 2:
            on = np.zeros(7)
            on[rng.integers(7, size=3)] = 1
        e, g, off = 0.01 * on[0] * unit(rng), 0.01 * on[1] * unit(rng), 0.01 * on[2] * unit(rng)
        P, Q, turn = (n * unit(rng) for n in rng.choice([0, 1], size=3))
        r, W0 = unit(rng), on[3] * unit(rng) * rng.choice([1, 5])
        if kind % 3 == 0:  # where vectors stand well to each other
            frame = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
            r, e, g, off, P, Q, turn, W0 = (
                frame[rng.integers(2)] * np.linalg.norm(x) for x in (r, e, g, off, P, Q, turn, W0)
            )
        if kind == 0:  # drag alone, with all of the others along one axis
            r, e, P, W0 = np.array([[1, 0, 0]] * 4) * [[1], [0.01], [1], [5]]
            g, off, Q, turn, on = 0 * r, 0 * r, 0 * r, 0 * r, np.array([1, 0, 0, 1, 1, 0, 0])
        K = np.cross(r, unit(rng))
        gamma, gap, slow = 0.5 * on[4], 0.01 * on[5], on[6] * rng.choice([0, 1])
        H, p, W = K + g, r - e, W0 + off
        w = 0.7
        size = np.linalg.norm
        found = drive(r, H, W, P, Q, turn, gamma + gap, slow)
        there = drive(p, K, W0, P, Q, turn, gamma, slow)
        s1, s2 = size(found[0] - there[0]), size(found[1] - there[1])
        box = W0[:, None] + np.outer(off, [-1, 1])
        k = SimpleNamespace(
            w=arb(w), h=arb(1), drag=arb(gamma), drag_size=arb(gamma + gap), c_size=arb(3), speed=arb(1.5),
            omega=[arb(float(lo + hi) / 2, float(abs(hi - lo)) / 2) for lo, hi in box],
            omega_size=arb(float(size(W0) + size(off))), below=arb(0.3), above=arb(0.2),
        )  # fmt: skip
        d = Sizes(arb(0), arb(0), arb(float(size(p))), arb(2), arb(0), arb(0))
        piece = SimpleNamespace(k=k, sizes=d, step=SimpleNamespace(low=Fraction(0), high=Fraction(1, 1 << 30)))
        owner = SimpleNamespace(omega=balls(W0), damping=arb(gamma + gap))
        way = SimpleNamespace(turn=balls(turn), slow=arb(float(slow)), error=arb(0))
        parts = [size(P), size(Q), 0.1, 0.2, abs(p @ P), abs(K @ P + p @ Q)]
        error, momentum, rate = module.carried(
            owner, piece, way, balls(parts), arb(float(size(e))), arb(float(size(g)))
        )
        tilt = abs(H @ P + r @ Q)
        needed = 0.1 + s1 + (0.2 + s2 + 3 * abs(r @ P) + 1.5 * tilt) / w
        assert needed <= float(error) * (1 << 30) * (1 + 1e-6), kind
        assert tilt <= float(momentum) * SLACK
        assert tilt + s1 + 0.1 <= float(rate) * SLACK
        if kind % 100 == 0:  # growth, and what bounds have of the radius itself
            way.error, piece.step.high = arb(1), Fraction(1)
            error, momentum, rate = module.carried(owner, piece, way, balls(parts), arb(0), arb(0))
            grown = np.exp((max(0.3, 0.2 + 1.5**2) + (gamma + gap) * size(W)) / (2 * w))
            assert float(error) >= (1 + 0.1 + (0.2 + 3 * parts[4] + 1.5 * parts[5]) / w) * grown * (1 - 1e-9)
            assert float(momentum) >= (w + 1.5) * float(error) + parts[5] - 1e-9
            least = float(momentum) + (1.5 + size(W)) * float(error)
            assert float(rate) >= least - 1e-9


RUNS = {  # close to equality, or far from it with derivatives that are exact
    "lean": ({"rotation_rate": "0.001", "x": "0", "y": "0"}, {"latitude": "0.01", "altitude": "1000"}, 9),
    "release": ({"x": "1", "y": "2", "vx": "0.1"}, {"x": "0.001", "vy": "0.001"}, 9),
    "angles": ({"angles": ("60", "30", "20", "2")}, {"angle": "0.03", "azimuth_rate": "0.01"}, 3),
    "damped": (
        {"drag": "0.1", "x": "20", "rotation_rate": "0.01", "equatorial_radius": "99"},
        {"drag": "1e-5", "rotation_rate": "1e-6"},
        9,
    ),
    "paris": ({"x": "0.3", "y": "0.4"}, {"length": "0.001", "gravity": "1e-4", "latitude": "0.01"}, 20),
    "late": ({"rotation_rate": "0", "x": "0.01", "y": "0.003"}, {"length": "1.5"}, 800),
    # a transit soon after the release, which differs much within the box
    "soon": ({"x": "1", "y": "0.1", "vx": "0.02"}, {"x": "0.3", "vx": "1e-6", "length": "0.001"}, 36),
    "tiny": ({"x": "0.3", "y": "0.4"}, {"x": "1e-25"}, 9),
}
IN_EVERY_RUN = ("angles", "damped")  # test_derivatives.py follows more boxes
COARSE = 40  # bits of steps that are farther from the motion than the box is wide
TRUTHS = {}


class Poor:
    """Proposals that say nothing: the radius alone counts."""

    def __init__(self, ways):
        self.nothing = [([[0]] * 6, 0) for _ in ways]

    def propose(self, step):
        return self.nothing


ROUNDED = Fraction(1, 10**24)  # a difference of two runs with forty digits, over 2e-12


def slopes_at(inputs, key, times):
    """Differences of runs: of the states, and of each transit."""
    off = Fraction(1, 10**12)
    up, down = (truth(moved(inputs, key, side * off), times) for side in (1, -1))
    rows = [[(a - b) / (2 * off) for a, b in zip(up.grid.exact(c), down.grid.exact(c), strict=True)] for c in GRID]
    zeros = [run.transits.exact("t") for run in (up, down)]
    pairs = zip(*zeros, strict=True) if len(zeros[0]) == len(zeros[1]) else ()
    points = [azimuths(run) for run in (up, down)]
    apses = [*zip(*points, strict=True)] if len(points[0]) == len(points[1]) else []
    late = [(a, (a - b) / (2 * off)) for (a, _), (b, _) in apses]
    turned = [(a, (x - y - 360 * round((x - y) / 360)) / (2 * off)) for (a, x), (_, y) in apses]
    return rows, [(a, (a - b) / (2 * off)) for a, b in pairs], late, turned


def known(name, box, times):
    """Runs of a box, and differences of runs about its scene, and about two of its corners to what it varies."""
    if name not in TRUTHS:
        rng, halves = Random(1), inputs_of(box)
        corners = [drawn(box, rng, True) for _ in range(4)]
        names = [key for key, half in halves.items() if half or name in ("paris", "angles")]
        places = {key: (box.inputs, *corners[:2]) if halves[key] else (box.inputs,) for key in names}
        slopes = {key: [slopes_at(inputs, key, times) for inputs in places[key]] for key in names}
        TRUTHS[name] = {end: [truth(inputs, times[:end]) for inputs in corners] for end in (2, 13)}, slopes
    return TRUTHS[name]


def runs_hold(module, names=RUNS, kinds=("box", "point", "poor", "poor box", "coarse")):
    """Pendulums of a box are inside, and differences about it: of the box, of its scene alone, of poor proposals."""
    for name in names:
        changes, widths, end = RUNS[name]
        box = widened(scene(t_end=str(end), **changes), widths)
        times = [Fraction(end * k, 12) for k in range(13)]
        runs, slopes = known(name, box, times)
        for kind in kinds:
            whole, poor = kind not in ("point", "poor"), kind.startswith("poor")
            if (not whole and name == "late") or (kind == "coarse" and name != "tiny"):
                continue
            halves = {key: half for key, half in inputs_of(box).items() if key in slopes and (half or not whole)}
            here = box if whole else Box(box.inputs, box.inputs, box.inputs)
            halves = halves if whole else dict.fromkeys(halves, Fraction(0))
            rows = 13 if not poor else 5 if kind == "poor" and name == "damped" else 2
            bits = COARSE if kind == "coarse" else BITS
            windows = Windows(here, BITS + 64, times[:rows], True, SECTIONS)
            follower = module.Derivatives(windows, halves, scales_of(windows.balls, list(halves)))
            ways = follower.bound.ways
            source = Poor(ways) if poor else TangentSource(windows.balls, ways)
            chain = pair(Recurrence(SceneBalls(box.inputs, BITS + 64), bits, 24).chain(Fraction(1, 16)))
            for step in until(chain, windows.course.times[-1]):
                windows.course.advance(step, source.propose(step))
            found = follower.finish()
            for run in runs[rows] if whole else ():
                assert outside(found.proved, run) == [], (name, kind)
            for j, key in enumerate(halves):
                for truths in slopes[key] if whole else slopes[key][:1]:
                    slopes_hold(found, j, truths, (name, kind, key))


def slopes_hold(found, j, truths, case):
    """Differences of states and of single transits are inside."""
    rows, *zeros = truths
    for i, column in enumerate(rows):
        for k, (slope, row) in enumerate(zip(column, found.states, strict=False)):
            slack = abs(slope) / 10**15 + ROUNDED
            assert row[j][i].low - slack <= slope <= row[j][i].high + slack, (*case, i, k)
    highest = found.proved.sections["highest"], found.passages["highest"]
    made = [(found.proved.transits, found.transits, "times"), (*highest, "times"), (*highest, "azimuths")]
    for slopes, (proved, every, name) in zip(zeros, made, strict=True):
        for z, led in zip(proved, every, strict=True):
            near = [slope for t, slope in slopes if z.t.low - Fraction(1, 10**6) <= t <= z.t.high + Fraction(1, 10**6)]
            if led.times and len(near) == 1:
                slack, interval = abs(near[0]) / 10**15, getattr(led, name)[j]
                assert interval.low - slack <= near[0] <= interval.high + slack, (*case, name)


def radius_holds(module):
    """Theorem C's bounds of |r - p| and of |H - K| with the scene's Ω, at made-up sizes; nothing where it fails."""
    k, d = SimpleNamespace(w=arb(0.7)), Sizes(arb(0), arb(0), arb(1.5), arb(2), arb(0), arb(0))
    for eta, off in ((0, 1), (1, 0), (1, 1)):
        kept = SimpleNamespace(grown=lambda *_, eta=eta: Covered(None, Tube(arb(eta), arb(0), arb(0))))
        bound = SimpleNamespace(plain=kept)
        found = module.Tangents.by_radius(bound, SimpleNamespace(k=k), d, arb(0), arb(off))
        assert [float(x) for x in found] == pytest.approx([eta, 2.7 * eta + 1.5**2 * off])


def widths_hold(module):
    """A width that is missing, or another one, is refused."""
    box = widened(scene(t_end="1"), {"length": "0.001", "gravity": "1e-4"})
    wrong = [{"pendulum.length": "0.001"}, {"pendulum.length": "0.001", "site.gravity": "1e-5"}]
    for widths in wrong:
        halves = {key: Fraction(half) for key, half in widths.items()}
        windows, refused = Windows(box, BITS, [Fraction(0), Fraction(1)], True), False
        try:
            module.Derivatives(windows, halves, dict.fromkeys(halves, 0))
        except ArithmeticError:
            refused = True
        assert refused, widths


FAULTS = [
    ("self.twin = ball(half) / self.scale, ", "self.twin = ball(half), "),
    ("add(self.twin.v, cross(self.twin.turning, self.twin.r))", "self.twin.v"),
    ("[first(x) for x in self.twin.turning]", "[arb(0) for x in self.twin.turning]"),
    ("first(self.twin.damping)", "arb(0)"),
    ("[first(x) for x in (*self.twin.r, *momentum)]", "[arb(0) for x in (*self.twin.r, *momentum)]"),
    ('demand(ends == [*balls.inputs[1:]], "a width is missing, or another one")', "pass"),
    ("way.error + size(jump[:3]) + size(jump[3:]) / self.balls.w0", "way.error + size(jump[3:]) / self.balls.w0"),
    ("way.error + size(jump[:3]) + size(jump[3:]) / self.balls.w0", "way.error + size(jump[:3])"),
    ("way.error + size(jump[:3]) + size(jump[3:]) / self.balls.w0", "size(jump[:3]) + size(jump[3:]) / self.balls.w0"),
    ("(way.half * (x[0] + y[0]) for", "(way.half * y[0] for"),
    ("(way.half * (x[0] + y[0]) for", "(way.half * x[0] for"),
    ("(way.half * (x[1] + y[1]) for", "(way.half * y[1] for"),
    ("way.error = part[0]", "pass"),
    ("for way, x, y in parts), near_by)", "for way, x, y in parts), arb(0))"),
    ("Tangent(f, unit, x[0], x[2])", "Tangent(f, unit, arb(0), x[2])"),
    ("Tangent(f, unit, x[0], x[2])", "Tangent(f, unit, x[0], arb(0))"),
    ("times(k.h, way.turn), k.h * way.slow, add", "way.turn, k.h * way.slow, add"),
    ("k.h * way.slow, add(K", "way.slow, add(K"),
    ("add(K, times(-1, omega))\n    r1", "K\n    r1"),
    ("add(rates[:3], cross(p, Q)", "add(cross(p, Q)"),
    ("cross(p, Q), cross(P, lean)", "cross(Q, p), cross(P, lean)"),
    ("cross(p, Q), cross(P, lean), ", "cross(p, Q), "),
    ("cross(P, lean)", "cross(lean, P)"),
    (", cross(turn, p))", ")"),
    ("cross(turn, p))", "cross(p, turn))"),
    ("add(rates[3:], cross(k.c, P)", "add(cross(k.c, P)"),
    ("cross(k.c, P)", "cross(P, k.c)"),
    ("cross(omega, Q)", "cross(Q, omega)"),
    (", cross(omega, Q)", ""),
    (", cross(turn, K))", ")"),
    ("cross(turn, K))", "cross(K, turn))"),
    ("dot(turn, p) + dot(omega, P), p)", "dot(omega, P), p)"),
    ("dot(turn, p) + dot(omega, P), p)", "dot(turn, p), p)"),
    ("add(Q, times(-1, turn), along", "add(times(-1, turn), along"),
    ("add(Q, times(-1, turn), along", "add(Q, along"),
    ("times(-1, turn), along, times(dot(omega, p), P)", "times(-1, turn), along"),
    ("add(lean, times(dot(omega, p), p))", "lean"),
    ("times(slow, add(lean, times", "times(slow, add(K, times"),
    ("r2 = add(r2, times(k.drag,", "r2 = add(r2, times(arb(0),"),
    ("r2 = add(r2, times(slow,", "r2 = add(r2, times(arb(0),"),
    ("[dot(K, P) + dot(p, Q)]", "[dot(p, Q)]"),
    ("[dot(K, P) + dot(p, Q)]", "[dot(K, P)]"),
    ("[dot(p, P)], [", "[dot(p, Q)], ["),
    ("size([f(UNIT) for f in part])", "size([f(arb(0)) for f in part])"),
    ("s1 = (Q + turn) * e", "s1 = Q * e"),
    ("s1 = (Q + turn) * e", "s1 = turn * e"),
    ("(g + off) * P\n", "g * P\n"),
    ("(g + off) * P\n", "off * P\n"),
    ("s2 = Q * off + g * turn", "s2 = g * turn"),
    ("s2 = Q * off + g * turn", "s2 = Q * off"),
    ("gap * (Q + turn", "gap * (turn"),
    ("gap * (Q + turn * (1 + d.p**2) + 2 * W * d.p * P)", "gap * (Q + turn * (1 + d.p**2))"),
    ("gap * (Q + turn * (1 + d.p**2) + 2 * W * d.p * P)", "0 * Q"),
    ("k.drag_size * (turn * e * (1 + d.p) + 2", "k.drag_size * (2"),
    ("2 * P * (off + W * e)", "2 * P * off"),
    ("2 * P * (off + W * e)", "2 * P * W * e"),
    ("slow * (g + 2 * off", "slow * (2 * off"),
    ("g + 2 * off + W * e * (1 + d.p)", "g + W * e * (1 + d.p)"),
    ("g + 2 * off + W * e * (1 + d.p)", "g + 2 * off"),
    ("along + e * P, across", "along, across"),
    ("along + e * P, across", "e * P, across"),
    ("across + g * P + e * Q", "g * P + e * Q"),
    ("across + g * P + e * Q", "across + e * Q"),
    ("across + g * P + e * Q", "across + g * P"),
    ("s1 + r1 + (s2", "r1 + (s2"),
    ("s1 + r1 + (s2", "s1 + (s2"),
    ("(s2 + r2 + aside", "(s2 + aside"),
    ("(s2 + r2 + aside", "(r2 + aside"),
    ("+ aside * k.c_size + tilt", "+ tilt"),
    (" + tilt * k.speed) / w", ") / w"),
    ("k.below.max(k.above + k.speed**2)", "k.below"),
    ("k.below.max(k.above + k.speed**2)", "k.below.max(k.above)"),
    ("k.speed**2) + k.drag_size * k.omega_size", "k.speed**2)"),
    ("(way.error + span * source)", "span * source"),
    ("(way.error + span * source)", "way.error"),
    (" * (span * rate / (2 * w)).exp())", ")"),
    ("upper((w + k.speed) * error + tilt)", "upper(w * error + tilt)"),
    ("upper((w + k.speed) * error + tilt)", "upper((w + k.speed) * error)"),
    ("momentum + (k.speed + k.omega_size) * error +", "(k.speed + k.omega_size) * error +"),
    ("momentum + (k.speed + k.omega_size) * error +", "momentum +"),
    ("k.omega_size) * error + s1 + r1)", "k.omega_size) * error)"),
    ("low, high = windows.pace.low * time, windows.pace.high * time", "low = high = windows.pace.low * time"),
    ("max(low, covered.piece.begin), min(high, covered.piece.end)", "*2 * (max(low, covered.piece.begin),)"),
    ("[[x, *row] if x else row for", "[row for"),
    ("ball(time)) for s, own in motions", "arb(0)) for s, own in motions"),
    ("else -ux / ax", "else ux / ax"),
    ("else -ux / ax", "else arb(0)"),
    ("ball(piece.step.centre) + s * piece.k.h, late", "ball(piece.step.centre), late"),
    ("2) / way.twin.pace)\n", "2))\n"),
    ("[x / way.scale for x in", "[x for x in"),
    ("[[reduce(arb.union, x) for x in zip(*parts, strict=True)] for parts in found]", "[parts[0] for parts in found]"),
    ("-(dx * vx + dy * vy + x * ux", "(dx * vx + dy * vy + x * ux"),
    ("-(dx * vx + dy * vy + x * ux + y * uy)", "-(x * ux + y * uy)"),
    ("-(dx * vx + dy * vy + x * ux + y * uy)", "-(dx * vx + dy * vy)"),
    ("/ (vx**2 + vy**2 + x * ax + y * ay)", "/ (x * ax + y * ay)"),
    ("x * dy - y * dx", "x * dy + y * dx"),
    (" + late * (x * vy - y * vx)", ""),
    ("late * (x * vy - y * vx)", "late * (x * vy + y * vx)"),
    ("/ (x**2 + y**2) * 180", "* 180"),
    ("180 / arb.pi()", "1"),
    ("[arb(0), -w, m]", "[arb(0), w, m]"),
    ("[arb(0), -w, m]", "[arb(0), m, w]"),
    ("* eta + d.p**2 * off)", "* eta)"),
    ("(whole.k.w + d.k) * eta", "arb(0)"),
    ("eta.min(sure[0]), gamma", "arb(0), gamma"),
    ("gamma.min(sure[1])\n", "arb(0)\n"),
    ("way.half * way.scale * x.abs_upper()", "way.half * x.abs_upper()"),
    ("way.half * way.scale * x.abs_upper()", "way.half * way.scale * x.abs_upper() / 2"),
    ("max(wide.low, own.low - reach)", "max(wide.low, own.low)"),
    ("min(wide.high, own.high + reach)", "min(wide.high, own.high)"),
    ("first(twin.pace) * time\n", "0 * time\n"),
    ("[q + arb(0, tangent.error) for q in rho]", "rho"),
    ("(q + arb(0, tangent.rate)) / h", "q / h"),
    ("(eta, u, a), (1, h, h**2)", "(eta, 0, a), (1, h, h**2)"),
    ("(q + arb(0, tangent.rate)) / h", "(q + arb(0, tangent.rate))"),
    ("(1, h, h**2), strict", "(1, h, h), strict"),
    ("(1, h, h**2), strict", "(1, 1, h**2), strict"),
    ("y, z * later + u], 2) for y, z, u in zip(r, v, rho", "y, u], 2) for y, z, u in zip(r, v, rho"),
    ("y, z * later + u], 2) for y, z, u in zip(r, v, rho", "y, z * later], 2) for y, z, u in zip(r, v, rho"),
    ("y, z * later + u], 2) for y, z, u in zip(v, a, rate", "y, u], 2) for y, z, u in zip(v, a, rate"),
    ("y, z * later + u], 2) for y, z, u in zip(v, a, rate", "y, z * later], 2) for y, z, u in zip(v, a, rate"),
    ("times(twin.length, moving[:3])", "times(covered.piece.balls.length, moving[:3])"),
    ("*twin.turned(R, -1)", "*covered.piece.balls.turned(R, -1)"),
    ("times(twin.length * twin.pace, moving", "times(twin.length, moving"),
    ("*twin.turned(V, -1)", "*twin.turned(V, 1)"),
    ("[first(q) / way.scale for q in moving]", "[first(q) for q in moving]"),
]  # fmt: skip
OF_BOXES = [
    ('1 / series(1 / ball(wide["flattening"]))', 'series(ball(wide["flattening"]))'),
    ("series(x) if n == name", "ball(x) if n == name"),
    ("wide[name] = series(wide[name])", "pass"),
    ("arb_series([ball(x), scale], 2)", "arb_series([ball(x), 2 * scale], 2)"),
    ("arb_series([angle, lean.atan()[1]], 2)", "arb_series([angle], 2)"),
    ("arb_series([angle, lean.atan()[1]], 2)", "arb_series([angle, -lean.atan()[1]], 2)"),
]
HARMLESS = [  # the box's balls in place of the scene's hold the scene as well: what follows is wider, and true
    ("self.own, self.c = box, wide, own, own.c", "self.own, self.c = box, wide, self, own.c"),
]


def found_by(module, names):
    widths_hold(module)
    radius_holds(module)
    residuals_hold(module)
    sources_hold(module)
    runs_hold(module, names)


def test_without_a_fault_nothing_is_found(size):
    found_by(sabotaged("TINY = ", "TINY  = ", SOURCE), size(IN_EVERY_RUN, RUNS))


@pytest.mark.parametrize("old, new", one_in(32, FAULTS))
def test_a_fault_is_found(old, new, size):
    module = sabotaged(old, new, SOURCE)
    with pytest.raises((AssertionError, ArithmeticError, TypeError, AttributeError, ValueError)):
        found_by(module, size(IN_EVERY_RUN, RUNS))


@pytest.mark.parametrize("old, new", one_in(8, OF_BOXES))
def test_a_fault_in_the_chain_rule_is_found(old, new, monkeypatch, size):
    box = sabotaged(old, new, BOX)
    monkeypatch.setitem(globals(), "Windows", box.Windows)
    with pytest.raises((AssertionError, ArithmeticError, TypeError, AttributeError, ValueError)):
        runs_hold(reference.enclosure.derivatives, size(IN_EVERY_RUN, RUNS))


@pytest.mark.parametrize("old, new", HARMLESS)
def test_what_only_widens_intervals_is_still_true(old, new, monkeypatch):
    monkeypatch.setitem(globals(), "Windows", sabotaged(old, new, BOX).Windows)
    runs_hold(reference.enclosure.derivatives, IN_EVERY_RUN, ("box",))
