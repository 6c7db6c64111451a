"""What has to hold for the trusted code of derivatives, in whichever module: derivatives.py, or a mutation of it."""

from fractions import Fraction
from random import Random
from types import SimpleNamespace

import numpy as np
import pytest
from boxes import WORDS, azimuths, drawn, inputs_of, moved, outside, truth, widened
from enclosure_oracle import scene
from enclosure_recurrence import Recurrence
from flint import arb, arb_poly, ctx, fmpz, fmpz_poly

from reference.enclosure.approximant import pair
from reference.enclosure.prove import until
from reference.enclosure.tangents import TangentSource, scales_of
from reference.enclosure.trusted.balls import size as vector_size
from reference.enclosure.trusted.box import BoxBalls, BoxRadius, Windows
from reference.enclosure.trusted.course import FINISHED
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.shapes import Box, Covered, Interval, Sizes, Tube
from reference.enclosure.trusted.system import SceneBalls
from reference.enclosure.trusted.tube import tube
from reference.numbers.columns import GRID
from reference.numbers.taylor_step import EARTH, TaylorStep

BITS = 96
SLACK = 1 + 1e-9


def balls(a):
    return [arb(float(x)) for x in a]


def unit(rng):
    a = rng.normal(size=3)
    return a / np.linalg.norm(a)


def cross(a, b):
    """np.cross, which is slow for single vectors."""
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def residuals_hold(module):
    """R1, R2 and the misses of tangency are those of the formulas, at made-up polynomials a + b s."""
    rng = np.random.default_rng(5)
    for kind in range(200):
        p, K, P, Q = (
            rng.normal(size=(2, 3)) * [[1], [kind % 2]] for _ in range(4)
        )  # constants: their bounds are exact
        omega, turn, c = rng.normal(size=(3, 3)) * rng.choice([0, 1], size=(3, 1))
        drag, slow, h = rng.choice([0, 0.5]), rng.choice([0, 0.25]), rng.choice([1, 0.5, 3])
        constants = SimpleNamespace(h=arb(h), c=balls(c), drag_0=arb(drag))
        sensitivity = SimpleNamespace(omega_q=balls(turn), drag_q=arb(slow))
        poly = [[arb_poly(balls(column)) for column in rows.T] for rows in (p, K, P, Q)]
        with ctx.workprec(128):
            scene_motion = module.SceneMotion(balls(omega), *poly[:2])
            proposed = module.Proposed(*poly[2:])
            norms = module.residuals(constants, scene_motion, sensitivity, proposed)
            found = (
                norms.P, norms.Q, norms.R1, norms.R2, norms.off_sphere, norms.off_momentum
            )  # fmt: skip
        turn, slow = h * turn, h * slow
        for s in (-1.0, -0.3, 0.4, 1.0):
            x, y, u, v = (rows[0] + rows[1] * s for rows in (p, K, P, Q))
            r1 = P[1] - cross(v, x) - cross(y - omega, u) + cross(turn, x)
            r2 = Q[1] - cross(u, c) - cross(v, omega) - cross(y, turn)
            r2 = r2 + drag * (v - turn + (turn @ x) * x + (omega @ u) * x + (omega @ x) * u)
            r2 = r2 + slow * (y - omega + (omega @ x) * x)
            sizes = [*map(np.linalg.norm, (u, v, r1, r2)), abs(x @ u), abs(y @ u + x @ v)]
            for n, (bound, size) in enumerate(zip(found, sizes, strict=True)):
                assert size <= float(bound) * SLACK, (kind, n)


def drive(r, H, W, P, Q, turn, gamma, slow):
    """The terms of ρ' and χ' that (P, Q) do not drive by themselves: those that change with r, H, Ω, γ."""
    first = cross(Q, r) + cross(H - W, P) - cross(turn, r)
    inner = Q - turn + (turn @ r) * r + (W @ P) * r + (W @ r) * P
    second = cross(Q, W) + cross(H, turn) - gamma * inner - slow * (H - W + (W @ r) * r)
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
        K = cross(r, unit(rng))
        gamma, gap, slow = 0.5 * on[4], 0.01 * on[5], on[6] * rng.choice([0, 1])
        H, p, W = K + g, r - e, W0 + off
        w = 0.7
        size = np.linalg.norm
        found = drive(r, H, W, P, Q, turn, gamma + gap, slow)
        there = drive(p, K, W0, P, Q, turn, gamma, slow)
        s1, s2 = size(found[0] - there[0]), size(found[1] - there[1])
        box = W0[:, None] + np.outer(off, [-1, 1])
        k = SimpleNamespace(
            w=arb(w), h=arb(1), drag_0=arb(gamma), drag=arb(gamma + gap), drag_size=arb(gamma + gap),
            c_size=arb(3), S=arb(1.5),
            omega=[arb(float(lo + hi) / 2, float(abs(hi - lo)) / 2) for lo, hi in box],
            omega_size=arb(float(size(W0) + size(off))), lambda_minus=arb(0.3), lambda_plus=arb(0.2),
        )  # fmt: skip
        piece = SimpleNamespace(
            constants=k, step=SimpleNamespace(low=Fraction(0), high=Fraction(1, 1 << 30))
        )
        sensitivity = SimpleNamespace(omega_q=balls(turn), drag_q=arb(float(slow)), epsilon=arb(0))
        parts = [size(P), size(Q), 0.1, 0.2, abs(p @ P), abs(K @ P + p @ Q)]
        norms = module.ResidualNorms(*balls(parts))
        assumed = module.Distance(arb(float(size(e))), arb(float(size(g))))
        step = module.box_step(piece, balls(W0), arb(float(size(p))))
        bounds = module.carried(step, sensitivity, norms, assumed)
        tilt = abs(H @ P + r @ Q)
        needed = 0.1 + s1 + (0.2 + s2 + 3 * abs(r @ P) + 1.5 * tilt) / w
        assert needed <= float(bounds.a) * (1 << 30) * (1 + 1e-6), kind
        assert tilt <= float(bounds.b) * SLACK
        assert tilt + s1 + 0.1 <= float(bounds.a_rate) * SLACK
        if kind % 100 == 0:  # growth, and what bounds have of the radius itself
            sensitivity.epsilon, piece.step.high = arb(1), Fraction(1)
            step = module.box_step(piece, balls(W0), arb(float(size(p))))
            bounds = module.carried(step, sensitivity, norms, module.Distance(arb(0), arb(0)))
            grown = np.exp((max(0.3, 0.2 + 1.5**2) + (gamma + gap) * size(W)) / (2 * w))
            source = 0.1 + (0.2 + 3 * parts[4] + 1.5 * parts[5]) / w
            assert float(bounds.a) >= (1 + source) * grown * (1 - 1e-9)
            assert float(bounds.b) >= (w + 1.5) * float(bounds.a) + parts[5] - 1e-9
            least = float(bounds.b) + (1.5 + size(W)) * float(bounds.a)
            assert float(bounds.a_rate) >= least - 1e-9


def made_up_step(module, rng):
    """A step with sizes that are drawn, none of them 1 or small beside the others."""
    names = ("h", "c_size", "omega_size", "drag_size", "w", "S", "lambda_minus", "lambda_plus")
    constants = SimpleNamespace(**{name: drawn_size(rng) for name in names})
    constants.lambda_minus *= 4
    fields = ("p_size", "length", "delta_omega", "delta_drag", "W")
    return module.BoxStep(constants, **{name: drawn_size(rng) for name in fields})


def made_up_norms(module, rng):
    return module.ResidualNorms(*(drawn_size(rng) for _ in range(6)))


def made_up_sensitivity(rng):
    return SimpleNamespace(
        omega_q=[drawn_size(rng), -drawn_size(rng), drawn_size(rng)],
        drag_q=-drawn_size(rng),
        epsilon=drawn_size(rng),
        half_width=drawn_size(rng),
    )


def scene_motion_holds(module):
    """p and K₀ = p × (p' + hΩ₀ × p) on a step, where p is a + b s."""
    rng = np.random.default_rng(9)
    a, b = rng.integers(-8, 9, size=(2, 3))
    unit, h, omega_0 = 4, 0.5, np.array([0.5, -1, 2])
    piece = SimpleNamespace(
        constants=SimpleNamespace(h=arb(h)),
        unit=fmpz(unit),
        p=[fmpz_poly([int(x), int(y)]) for x, y in zip(a, b, strict=True)],
        v=[fmpz_poly([int(y)]) for y in b],
    )
    found = module.scene_motion(piece, balls(omega_0))
    assert [float(x) for x in found.omega_0] == pytest.approx(h * omega_0)
    for s in (-1, 0.25, 1):
        p = (a + b * s) / unit
        assert [float(f(arb(s))) for f in found.p] == pytest.approx(p)
        K_0 = cross(p, b / unit + cross(h * omega_0, p))
        assert [float(f(arb(s))) for f in found.K_0] == pytest.approx(K_0)


def horizontals_hold(module):
    """The part of a vector across c: with c downwards, x and y; else y is up × x."""
    for c, y in (((0, 0, -2), 2), ((0, 3, 0), 3), ((0, 3, 4), 0.2), ((0, 0.3, -0.4), 3.4)):
        found = module.horizontal(balls([1, 2, 3]), balls(c))
        assert float(found.x) == 1
        assert float(found.y) == pytest.approx(y)


def drawn_size(rng):
    return arb(float(rng.uniform(0.2, 3)))


def bounds_hold(module):
    """Lemma 12.2: the bounds are (12.2c) to (12.2k), computed once more in doubles."""
    rng = np.random.default_rng(7)
    for _ in range(20):
        step, norms = made_up_step(module, rng), made_up_norms(module, rng)
        sensitivity = made_up_sensitivity(rng)
        assumed = module.Distance(drawn_size(rng), drawn_size(rng))
        found = module.carried(step, sensitivity, norms, assumed)

        k = SimpleNamespace(**{name: float(x) for name, x in vars(step.constants).items()})
        p, W = float(step.p_size), float(step.W)
        length, off, slower = map(float, (step.length, step.delta_omega, step.delta_drag))
        P, Q, R1, R2 = map(float, (norms.P, norms.Q, norms.R1, norms.R2))
        eta, G = float(assumed.r), float(assumed.H)
        turn = k.h * np.linalg.norm([float(x) for x in sensitivity.omega_q])
        slow = k.h * abs(float(sensitivity.drag_q))
        S1 = (Q + turn) * eta + (G + off) * P
        S2 = Q * off + G * turn + slower * (Q + turn * (1 + p**2) + 2 * W * p * P)
        S2 += k.drag_size * (turn * eta * (1 + p) + 2 * P * (off + W * eta))
        S2 += slow * (G + 2 * off + W * eta * (1 + p))
        A = float(norms.off_sphere) + eta * P
        B = float(norms.off_momentum) + G * P + eta * Q
        mu = max(k.lambda_minus, k.lambda_plus + k.S**2) + k.drag_size * k.omega_size
        driven = R1 + S1 + (R2 + S2 + A * k.c_size + B * k.S) / k.w
        a = (float(sensitivity.epsilon) + length * driven) * np.exp(length * mu / (2 * k.w))
        b = (k.w + k.S) * a + B
        rate = b + (k.S + k.omega_size) * a + S1 + R1
        assert float(found.a) == pytest.approx(a, rel=1e-9)
        assert float(found.b) == pytest.approx(b, rel=1e-9)
        assert float(found.a_rate) == pytest.approx(rate, rel=1e-9)


def steps_hold(module):
    """By how much rotation and drag differ within the box, in the time of a step, and the larger rotation."""
    for omega, omega_0, W in (([0, 3, 4], [0, 0, 2], 5), ([0, 0, 1], [0, 6, 8], 5)):
        constants = SimpleNamespace(
            h=arb(0.5), omega=balls(omega), omega_size=arb(float(np.linalg.norm(omega))),
            drag=arb(0.5), drag_0=arb(2),
        )  # fmt: skip
        step = SimpleNamespace(low=Fraction(-1, 2), high=Fraction(1))
        found = module.box_step(
            SimpleNamespace(constants=constants, step=step), balls(omega_0), arb(3)
        )
        off = np.linalg.norm(np.array(omega) - np.array(omega_0) / 2)
        assert float(found.delta_omega) == pytest.approx(off)
        assert float(found.delta_drag) == pytest.approx(1.5)
        assert float(found.W) == pytest.approx(W)
        assert (found.length, found.p_size, found.constants) == (1.5, 3, constants)


def joins_hold(module):
    """ε grows by the gap between the proposals of two steps, and nothing else (12.2l); they are what was read."""
    nothing = balls([0, 0, 0])
    sensitivity = SimpleNamespace(w0=arb(4), epsilon=arb(0), end=module.Variation(nothing, nothing))

    def join(rows, bits, low, high, h):
        step = SimpleNamespace(low=Fraction(low), high=Fraction(high))
        piece = SimpleNamespace(step=step, constants=SimpleNamespace(h=arb(h)))
        candidate = module.candidate_of(rows, bits)
        module.InputSensitivity.join(sensitivity, candidate, piece)
        return candidate.polynomials()

    # P = (1 + s, 2s, 1) and Q/h = (1, s, 0): (0, -2, 1) and (1, -1, 0) where it begins, at s = -1
    first = join([[4, 4], [0, 8], [4], [2], [0, 2], [0]], 2, -1, 0.5, 0.5)
    expected = 5**0.5 + 2**0.5 / 4
    assert float(sensitivity.epsilon) == pytest.approx(expected)
    assert [float(f(arb(0.5))) for f in first.P] == [1.5, 1, 1]
    assert [float(f(arb(0.5))) for f in first.Q] == [0.5, 0.25, 0]

    # it ends with (1.5, 1, 1) and (1, 0.5, 0); the next one is (3, 4, 0) and (0, 0, 2) off that
    for _ in range(2):
        join([[36], [40], [8], [2], [1], [4]], 3, 0, 1, 0.25)
        assert float(sensitivity.epsilon) == pytest.approx(expected + 5 + 2 / 4)


# output times that are spread over several steps
WIDE = ({"rotation_rate": "0", "x": "0.01", "y": "0.003"}, {"length": "5"}, 20)
RUNS = {  # close to equality, or far from it with derivatives that are exact
    "lean": (
        {"rotation_rate": "0.001", "x": "0", "y": "0"},
        {"latitude": "0.01", "altitude": "1000"},
        9,
    ),
    "release": ({"x": "1", "y": "2", "vx": "0.1"}, {"x": "0.001", "vy": "0.001"}, 9),
    "angles": ({"angles": ("60", "30", "20", "2")}, {"angle": "0.03", "azimuth_rate": "0.01"}, 3),
    "damped": (
        {"drag": "0.1", "x": "20", "rotation_rate": "0.01", "equatorial_radius": "99"},
        {"drag": "1e-5", "rotation_rate": "1e-6"},
        9,
    ),
    "paris": (
        {"x": "0.3", "y": "0.4"},
        {"length": "0.001", "gravity": "1e-4", "latitude": "0.01"},
        20,
    ),
    "late": ({"rotation_rate": "0", "x": "0.01", "y": "0.003"}, {"length": "1.5"}, 800),
    # a transit soon after the release, which differs much within the box
    "soon": (
        {"x": "1", "y": "0.1", "vx": "0.02"},
        {"x": "0.3", "vx": "1e-6", "length": "0.001"},
        36,
    ),
    "wide": WIDE,
    "tiny": ({"x": "0.3", "y": "0.4"}, {"x": "1e-25"}, 9),
}
IN_EVERY_RUN = ("angles", "damped", "wide")  # test_derivatives.py follows more boxes
KINDS = ("box", "point", "poor", "poor box", "jumping", "coarse")
COARSE = 40  # bits of steps that are farther from the motion than the box is wide
TRUTHS = {}


class Poor:
    """Proposals that say nothing: the radius alone counts."""

    def __init__(self, sensitivities):
        self.nothing = [([[0]] * 6, 0) for _ in sensitivities]

    def propose(self, step):
        return self.nothing


class Jumping:
    """Proposals that do not join: every other one is larger by a thousandth."""

    def __init__(self, balls, sensitivities):
        self.source, self.larger = TangentSource(balls, sensitivities), False

    def propose(self, step):
        self.larger = not self.larger
        factor = 1001 if self.larger else 1000
        return [
            ([[c * factor // 1000 for c in row] for row in rows], bits)
            for rows, bits in self.source.propose(step)
        ]


ROUNDED = Fraction(1, 10**24)  # a difference of two runs with forty digits, over 2e-12


def slopes_at(inputs, key, times):
    """Differences of runs: of the states, and of each zero, by word and by what is differentiated."""
    off = Fraction(1, 10**12)
    up, down = (truth(moved(inputs, key, side * off), times) for side in (1, -1))
    rows = [
        [(a - b) / (2 * off) for a, b in zip(up.grid.exact(c), down.grid.exact(c), strict=True)]
        for c in GRID
    ]
    zeros = {}
    for word in ("xdot", "highest"):
        points = [azimuths(run, word) for run in (up, down)]
        pairs = [*zip(*points, strict=True)] if len(points[0]) == len(points[1]) else []
        zeros[word, "times"] = [(a, (a - b) / (2 * off)) for (a, _), (b, _) in pairs]
        turned = [(a, x - y - 360 * round((x - y) / 360)) for (a, x), (_, y) in pairs]
        zeros[word, "azimuths"] = [(a, turn / (2 * off)) for a, turn in turned]
    return rows, zeros


def known(name, box, times):
    """Runs of a box, and differences of runs about its scene, and about two of its corners to what it varies."""
    if name not in TRUTHS:
        rng, halves = Random(1), inputs_of(box)
        corners = [drawn(box, rng, True) for _ in range(4)]
        names = [key for key, half in halves.items() if half or name in ("paris", "angles")]
        places = {
            key: (box.inputs, *corners[:2]) if halves[key] else (box.inputs,) for key in names
        }
        slopes = {key: [slopes_at(inputs, key, times) for inputs in places[key]] for key in names}
        TRUTHS[name] = (
            {end: [truth(inputs, times[:end]) for inputs in corners] for end in (2, 13)},
            slopes,
        )
    return TRUTHS[name]


def runs_hold(module, names=RUNS, kinds=KINDS, windows_of=Windows):
    """Pendulums of a box are inside, and differences about it: of the box, of its scene alone, of poor proposals."""
    for name in names:
        changes, widths, end = RUNS[name]
        box = widened(scene(t_end=str(end), **changes), widths)
        times = [Fraction(end * k, 12) for k in range(13)]
        runs, slopes = known(name, box, times)
        for kind in kinds:
            whole, poor = kind not in ("point", "poor", "jumping"), kind.startswith("poor")
            if (not whole and name == "late") or (kind == "coarse" and name != "tiny"):
                continue
            halves = {
                key: half
                for key, half in inputs_of(box).items()
                if key in slopes and (half or not whole)
            }
            here = box if whole else Box(box.inputs, box.inputs, box.inputs)
            halves = halves if whole else dict.fromkeys(halves, Fraction(0))
            rows = 13 if not poor else 5 if kind == "poor" and name == "damped" else 2
            bits = COARSE if kind == "coarse" else BITS
            windows = windows_of(here, BITS + 64, times[:rows], WORDS)
            follower = module.Derivatives(windows, halves, scales_of(windows.balls, list(halves)))
            sensitivities = follower.bound.sensitivities
            if poor:
                source = Poor(sensitivities)
            elif kind == "jumping":
                source = Jumping(windows.balls, sensitivities)
            else:
                source = TangentSource(windows.balls, sensitivities)
            chain = pair(
                Recurrence(SceneBalls(box.inputs, BITS + 64), bits, 24).chain(Fraction(1, 16))
            )
            covered = []
            windows.course.followers.append(SimpleNamespace(advance=covered.append))
            for step in until(chain, windows.course.times[-1]):
                windows.course.advance(step, source.propose(step))
            with pytest.raises(ArithmeticError, match="course alone"):
                follower.advance(covered[-1])
            found = follower.finish()
            assert found in FINISHED, "only what counts as proved may be handed on"
            assert found.proved in FINISHED, "only what counts as proved may be handed on"
            for run in runs[rows] if whole else ():
                assert outside(found.proved, run) == [], (name, kind)
            if kind == "point":  # where all is as narrow as it can be
                transits = zip(found.proved.zeros["xdot"], found.zeros["xdot"], strict=True)
                for z, derived in transits:
                    assert len(derived.times) == len(halves) * (z.parity == "one"), (name, kind)
            for j, key in enumerate(halves):
                for truths in slopes[key] if whole else slopes[key][:1]:
                    slopes_hold(found, j, truths, (name, kind, key))


def slopes_hold(found, j, truths, case):
    """Differences of states and of single zeros are inside."""
    rows, zeros = truths
    for i, column in enumerate(rows):
        for k, (slope, row) in enumerate(zip(column, found.states, strict=False)):
            slack = abs(slope) / 10**15 + ROUNDED
            assert row[j][i].low - slack <= slope <= row[j][i].high + slack, (*case, i, k)
    assert [*found.zeros] == ["xdot", "highest"], (
        "derivatives in other axes would be false for other sections"
    )
    for (word, name), slopes in zeros.items():
        for z, derived in zip(found.proved.zeros[word], found.zeros[word], strict=True):
            near = [
                slope
                for t, slope in slopes
                if z.t.low - Fraction(1, 10**6) <= t <= z.t.high + Fraction(1, 10**6)
            ]
            made = getattr(derived, name)
            assert bool(made) == (bool(derived.times) and (word, name) != ("xdot", "azimuths"))
            if made and len(near) == 1:
                slack, interval = abs(near[0]) / 10**15, made[j]
                assert interval.low - slack <= near[0] <= interval.high + slack, (*case, word, name)


def radius_holds(module):
    """Theorem C's bounds of |r - p| and of |H - K| with the scene's Ω, at made-up sizes; none once it has failed."""
    k, d = SimpleNamespace(w=arb(0.7)), Sizes(arb(0), arb(0), arb(1.5), arb(2), arb(0), arb(0))
    for eta, off in ((0, 1), (1, 0), (1, 1)):
        kept = SimpleNamespace(
            grown=lambda *_, eta=eta: Covered(None, Tube(arb(eta), arb(0), arb(0)))
        )
        bound = SimpleNamespace(box_radius=kept, box_radius_holds=True)
        piece, widened = SimpleNamespace(constants=k), SimpleNamespace(sizes=d)
        found = module.Tangents.by_theorem_c(bound, piece, widened, arb(off))
        assert float(found.r) == pytest.approx(eta)
        assert float(found.H) == pytest.approx(2.7 * eta + 1.5**2 * off)

        # a radius that was not confirmed is kept: what follows from it is no bound
        kept.grown = unconfirmed
        module.Tangents.by_theorem_c(bound, piece, widened, arb(off))
        kept.grown = lambda *_: Covered(None, Tube(arb(1), arb(0), arb(0)))
        found = module.Tangents.by_theorem_c(bound, piece, widened, arb(off))
        assert not found.r.is_finite()
        assert not found.H.is_finite()

    # what a ball says, at its upper end
    kept = SimpleNamespace(grown=lambda *_: Covered(None, Tube(arb(1, 0.5), arb(0), arb(0))))
    bound = SimpleNamespace(box_radius=kept, box_radius_holds=True)
    found = module.Tangents.by_theorem_c(bound, piece, widened, arb(1))
    assert float(found.H.lower()) >= (2.7 * 1.5 + 1.5**2) / SLACK

    # (12.4g)
    covered = Covered(SimpleNamespace(constants=k), Tube(arb(3), arb(0), arb(0)))
    of_scene = module.Tangents.scene_distance(SimpleNamespace(scene=covered), arb(2))
    assert float(of_scene.r) == pytest.approx(3)
    assert float(of_scene.H) == pytest.approx(2.7 * 3)


def unconfirmed(*_):
    raise ArithmeticError("a bound has outgrown what it rests on")


def reach_holds(module):
    """(12.4a, b): the scene's own distance, and each half-width times the largest derivative."""
    rng = np.random.default_rng(8)
    step = made_up_step(module, rng)
    sensitivities = [made_up_sensitivity(rng) for _ in range(2)]
    norms = [made_up_norms(module, rng) for _ in range(2)]
    assumed, of_scene = (module.Distance(drawn_size(rng), drawn_size(rng)) for _ in range(2))
    bound = SimpleNamespace(sensitivities=sensitivities)
    found = module.Tangents.reached(bound, step, norms, assumed, of_scene)
    r, H = float(of_scene.r), float(of_scene.H)
    for sensitivity, norm in zip(sensitivities, norms, strict=True):
        of_input = module.carried(step, sensitivity, norm, assumed)
        r += float(sensitivity.half_width * (norm.P + of_input.a))
        H += float(sensitivity.half_width * (norm.Q + of_input.b))
    assert float(found.distance.r) == pytest.approx(r)
    assert float(found.distance.H) == pytest.approx(H)
    assert len(found.bounds) == 2


def confirmed(module, start, rates, theorem_c):
    """What is confirmed where E₁ and G₁ grow with E and G at these rates; None if it is refused."""

    def reached(step, norms, assumed, of_scene):
        r = arb(start[0]) + arb(rates[0]) * assumed.r
        H = arb(start[1]) + arb(rates[1]) * assumed.H
        return module.Reached(module.Distance(r, H), [])

    bound = SimpleNamespace(reached=reached)
    try:
        made = module.Tangents.confirmed(
            bound, None, [], None, module.Distance(*map(arb, theorem_c))
        )
    except ArithmeticError:
        return None
    return float(made.distance.r), float(made.distance.H)


def confirmed_holds(module):
    """Lemma 12.4: E and G, twice what follows from none, have to be confirmed unless they are Theorem C's."""
    none = ("inf", "inf")
    assert confirmed(module, (0, 0), (0, 0), none) == (0, 0)
    assert confirmed(module, (4, 64), (0.25, 0.25), none) == (6, 96)
    assert confirmed(module, (4, 64), (0.75, 0.25), none) is None
    assert confirmed(module, (4, 64), (0.25, 0.75), none) is None
    assert confirmed(module, (4, 64), (0.75, 0.25), (4, "inf")) == (7, 96)
    assert confirmed(module, (4, 64), (0.25, 0.75), ("inf", 64)) == (6, 112)
    assert confirmed(module, (4, 64), (0.75, 0.75), (4, "inf")) is None


def widths_hold(module):
    """A width that is missing, or another one, is refused."""
    box = widened(scene(t_end="1"), {"length": "0.001", "gravity": "1e-4"})
    wrong = [{"pendulum.length": "0.001"}, {"pendulum.length": "0.001", "site.gravity": "1e-5"}]
    for widths in wrong:
        halves = {key: Fraction(half) for key, half in widths.items()}
        windows, refused = Windows(box, BITS, [Fraction(0), Fraction(1)], ("xdot",)), False
        try:
            module.Derivatives(windows, halves, dict.fromkeys(halves, 0))
        except ArithmeticError:
            refused = True
        assert refused, widths


def ends_are_demanded(module):
    """A run that was not followed to its end proves nothing."""
    for done, states in ((1, 2), (2, 1)):
        follower = SimpleNamespace(
            windows=SimpleNamespace(finish=lambda: None, times=[Fraction(0), Fraction(1)]),
            done=done,
            states=[()] * states,
        )
        with pytest.raises(ArithmeticError, match="do not end with the run"):
            module.Derivatives.finish(follower)


def intervals_hold(module):
    """What follows for all inputs is near the scene's own number, and in the wide interval."""
    sensitivities, ends = (
        [
            SimpleNamespace(half_width=arb(0.5), scale=arb(4)),
            SimpleNamespace(half_width=arb(0.25), scale=arb(2)),
        ],
        (1, 2),
    )
    own, derivatives = Interval(*map(Fraction, ends)), [arb(2), arb(-3)]
    for wide, found in (((-90, 90), (-4.5, 7.5)), ((0, 90), (0, 7.5)), ((-90, 3), (-4.5, 3))):
        got = module.within(Interval(*map(Fraction, wide)), own, sensitivities, derivatives)
        assert (got.low, got.high) == found
    wide = Interval(Fraction(-90), Fraction(90))
    assert module.within(wide, own, sensitivities, [arb(2), arb("nan")]) == wide
    far = [SimpleNamespace(half_width=arb(0.5, 0.25), scale=arb(4))]
    assert module.within(wide, own, far, [arb(2)]).high >= 2 + 6
    with pytest.raises(ArithmeticError, match="contradict"):
        module.within(Interval(Fraction(8), Fraction(9)), own, sensitivities, derivatives)


def own_zeros_hold(module):
    """The scene's own zero is one that is alone in the interval, and single."""

    def zero(low, high, parity="one"):
        return SimpleNamespace(t=Interval(Fraction(low), Fraction(high)), parity=parity)

    own = [zero(0, 1), zero(2, 3), zero(4, 5, "odd"), zero(6, 7), zero(8, 9)]
    watched = SimpleNamespace(own_scan=SimpleNamespace(found=own))
    for low, high, n in (
        (1.5, 3.5, 1),
        (2.5, 3.5, 1),
        (1.5, 2.5, 1),
        (2.25, 2.75, 1),
        (3.5, 5.5, None),
        (1.5, 7, None),
    ):
        assert module.WatchedZeros.own_zero(watched, zero(low, high)) is (
            None if n is None else own[n]
        )
    for low, high in ((3.25, 3.75), (5.5, 9), (0, 2), (9.5, 10)):
        assert module.WatchedZeros.own_zero(watched, zero(low, high)) is None


def tubes_hold(module):
    """The tube has the smaller of two bounds, of H with each pendulum's Ω (12.4f); ε goes on from the one of |a|."""
    inputs = scene(rotation_rate="0.7", equatorial_radius="5", t_end="1")
    box = widened(inputs, {"rotation_rate": "0.125"})
    halves = {"site.rotation_rate": Fraction(1, 8)}
    box_balls = BoxBalls(box, BITS)
    rows = ([2 << BITS], [1 << BITS], [0], [0])  # |p|² = 5, so that it is not 1
    step = TaylorStep(Fraction(0), Fraction(1, 2), Fraction(0), Fraction(1), BITS, rows, EARTH)
    for derived, kept in (((0.25, 0.5), (0.5, 0.25)), ((0.5, 0.25), (0.25, 0.5))):
        reached, theorem_c = (module.Distance(*map(arb, pair)) for pair in (derived, kept))

        class Bound(module.Tangents):
            def by_theorem_c(self, *_, found=theorem_c):
                return found

            def confirmed(self, *_, found=reached):
                return module.Reached(found, [module.Carried(arb(5), arb(6), arb(7))])

        bound = Bound(box_balls, halves, {"site.rotation_rate": 0})
        piece = Piece(box_balls, step)
        bound.point = SimpleNamespace(
            advance=lambda piece: Covered(piece, Tube(arb(0), arb(0), arb(0)))
        )
        found = bound.advance(piece, [([[0]] * 6, 0)])
        k = piece.constants
        off = [x - y for x, y in zip(k.omega, k.omega_0, strict=True)]
        gamma = arb(0.25) + 5 * vector_size(off)
        sizes = BoxRadius(box_balls).widened(piece).sizes
        for x, y in zip(found.tube, tube(k, sizes, arb(0.25), gamma), strict=True):
            assert float(x) == pytest.approx(float(y), rel=1e-9)
        assert bound.eta == 0.25
        assert [(tangent.a, tangent.a_rate) for tangent in bound.tangents] == [(5, 7)]
        assert [sensitivity.epsilon for sensitivity in bound.sensitivities] == [5]


def output_times_hold(module):
    """An output time is taken wherever a pendulum may have it, until all of them have passed it."""
    taken = []

    def take(n, step, at):
        centre = int(step.covered.piece.step.centre)
        low = min(float((centre + s).lower()) for s in at)
        high = max(float((centre + s).upper()) for s in at)
        taken.append((n, round(low, 6), round(high, 6)))

    pace = Interval(Fraction(3, 4), Fraction(5, 4))
    follower = SimpleNamespace(
        done=0, windows=SimpleNamespace(times=[4, 8, 16], pace=pace), take_output_time=take
    )
    passed = []
    for begin in (2, 4, 6, 8, 10):
        module.Derivatives.take_output_times(follower, step_from(Fraction(begin)))
        passed.append(follower.done)
    expected = [(0, 3, 4), (0, 4, 5), (1, 6, 6), (1, 6, 8), (1, 8, 10), (2, 12, 12)]
    assert taken == expected
    assert passed == [0, 1, 1, 2, 2]


def order_is_demanded(module):
    """The scene's own zeros are found by their order, so they have to be in order; and the end closes the last."""

    def narrowed(*times, proved=()):
        found = [SimpleNamespace(t=Interval(*map(Fraction, ends))) for ends in times]
        derivatives = []
        watched = SimpleNamespace(
            take_closed=lambda _: derivatives.append([]),
            own_scan=SimpleNamespace(finish=lambda: found),
            scan=SimpleNamespace(found=list(proved)),
            derivatives=derivatives,
        )
        follower = SimpleNamespace(
            watched={"xdot": watched}, bound=SimpleNamespace(sensitivities=[])
        )
        return module.Derivatives.narrowed(follower, "xdot", proved)

    assert narrowed(proved=("a zero",)).zeros == ("a zero",)
    assert narrowed((0, 1), (2, 3), (2, 3)).zeros == ()
    for wrong in (((2, 3), (0, 4)), ((0, 4), (2, 3)), ((2, 3), (0, 1))):
        with pytest.raises(ArithmeticError, match="in order"):
            narrowed(*wrong)


def places_hold(module):
    """Places cover what a step has of a time, and there are none if it has nothing."""
    piece = step_from(Fraction(3)).covered.piece
    for begin, end, covered in ((1, 9, (3, 5)), (4, 9, (4, 5)), (1, 4, (3, 4)), (3.5, 4, (3.5, 4))):
        parts = module.places(piece, Fraction(begin), Fraction(end))
        low = min(float((4 + part).lower()) for part in parts)
        high = max(float((4 + part).upper()) for part in parts)
        assert (low, high) == pytest.approx(covered)
    for begin, end in ((1, 2), (6, 7), (5.0625, 5.125), (2.875, 2.9375)):
        assert module.places(piece, Fraction(begin), Fraction(end)) == []


def step_from(begin):
    """A step of two seconds, of which the time is all that is asked for."""
    step = SimpleNamespace(centre=begin + 1, h=Fraction(1))
    piece = SimpleNamespace(step=step, begin=begin, end=begin + 2)
    return SimpleNamespace(covered=SimpleNamespace(piece=piece))


def finiteness_holds(module):
    """Derivatives of a zero are finite if all of their balls are."""
    one, endless = arb(1), arb(0, "inf")
    every = [
        (module.ZeroDerivative(time, azimuth), time is one and azimuth is not endless)
        for time in (one, endless)
        for azimuth in (None, one, endless)
    ]
    assert module.all_finite([])
    for derivative, finite in every:
        for other, other_finite in every:
            assert module.all_finite([derivative, other]) == (finite and other_finite)


def hulls_of_zeros_hold(module):
    """The derivatives of a zero contain those at every place where it may be."""
    places = [module.ZeroDerivative(arb(x), arb(10 * x)) for x in (2, 1, 3)]
    found = module.hull_of_zeros(places)
    for place in places:
        assert found.time.contains(place.time)
        assert found.azimuth.contains(place.azimuth)
    places = [module.ZeroDerivative(arb(x), None) for x in (2, 1)]
    assert module.hull_of_zeros(places).azimuth is None


def watched_zeros_hold(module):
    """Every step since a zero's cluster began is kept; its derivatives are those of a single zero, and finite."""
    at, scenes = [], []

    class Watched(module.WatchedZeros):
        def of_zero(self, zero, sensitivities):
            at.append([*self.kept])
            return zero.derivatives

    scan = SimpleNamespace(found=[], cluster=[])
    watched = Watched(scan, SimpleNamespace(advance=scenes.append), False)

    def advance(step, *found, still_open):
        scan.found += [SimpleNamespace(parity=parity, derivatives=[x]) for parity, x in found]
        scan.cluster = ["a leaf"] if still_open else []
        watched.advance(step, f"scene in {step}", [])

    finite, endless = (module.ZeroDerivative(time, None) for time in (arb(1), arb("nan")))
    advance("step 1", still_open=True)
    advance("step 2", ("one", finite), still_open=False)
    assert at == [["step 1", "step 2"]]
    advance("step 3", ("one", finite), ("odd", finite), ("one", endless), still_open=False)
    assert at[1:] == [["step 3"], ["step 3"]]
    assert watched.derivatives == [[finite], [finite], [], []]
    assert scenes == ["scene in step 1", "scene in step 2", "scene in step 3"]


def zeros_are_covered(module):
    """A zero's derivatives are taken at all times that it may have, within the steps that are kept; else refused."""

    class Watched(module.WatchedZeros):
        def at_place(self, step, s, sensitivities):
            time = float(step.covered.piece.step.centre) + s
            return [module.ZeroDerivative(time, None)]

    watched = Watched(None, None, False)
    watched.kept = [step_from(Fraction(3)), step_from(Fraction(5))]
    for low, high, covered in ((4, 6, (4, 6)), (4, 8, (4, 7)), (2, 6, (3, 6)), (2, 8, (3, 7))):
        zero = SimpleNamespace(t=Interval(Fraction(low), Fraction(high)))
        (found,) = watched.of_zero(zero, [None])
        ends = float(found.time.lower()), float(found.time.upper())
        assert ends == pytest.approx(covered)
    for low, high in ((1, 2), (8, 9)):
        zero = SimpleNamespace(t=Interval(Fraction(low), Fraction(high)))
        with pytest.raises(ArithmeticError, match="not covered"):
            watched.of_zero(zero, [None])


def all_hold(module, long):
    ends_are_demanded(module)
    intervals_hold(module)
    own_zeros_hold(module)
    order_is_demanded(module)
    output_times_hold(module)
    places_hold(module)
    finiteness_holds(module)
    hulls_of_zeros_hold(module)
    watched_zeros_hold(module)
    zeros_are_covered(module)
    scene_motion_holds(module)
    horizontals_hold(module)
    joins_hold(module)
    steps_hold(module)
    bounds_hold(module)
    reach_holds(module)
    confirmed_holds(module)
    tubes_hold(module)
    widths_hold(module)
    radius_holds(module)
    residuals_hold(module)
    sources_hold(module)
    runs_hold(module, RUNS if long else IN_EVERY_RUN)
