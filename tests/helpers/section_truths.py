"""What has to hold for the trusted code of sections, whichever module has it: sections.py, or a mutation of it."""

from fractions import Fraction
from functools import cache
from itertools import combinations, pairwise, product
from math import factorial

import mpmath as mp
import numpy as np
import pytest
from enclosure_oracle import acceleration, constants, scene, start, truth
from enclosure_recurrence import Recurrence
from flint import arb, ctx
from numpy.polynomial import Polynomial
from passages import WAYS, form, value

from reference.enclosure.approximant import pair
from reference.enclosure.prove import until
from reference.enclosure.trusted.balls import ball
from reference.enclosure.trusted.course import Course
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.shapes import Covered, Tube
from reference.enclosure.trusted.system import SceneBalls
from reference.numbers.taylor_step import EARTH, TaylorStep

BITS = 128
FAST = {"rotation_rate": "0.02", "equatorial_radius": "1000", "length": "20", "x": "3", "y": "-2"}
CASES = {  # changes of Paris, sections, end: rest and moving, fast planets, where d is large
    "paris": ({}, ("highest", "lowest", "gate 30", "gate -75.5@0", "turn 100.25"), 20),
    "fast": (FAST | {"vx": "0.4"}, ("highest", "lowest", "gate 30", "gate 110@0", "turn 200"), 20),
    "lean": (
        FAST | {"latitude": "-35", "gravity_is": "effective"},
        ("gate 0", "gate 91", "gate 0@0", "highest"),
        20,
    ),
    "plane": (
        {"rotation_rate": "0", "vy": "0.3"},
        ("gate 10", "gate 100@0", "turn 53.2", "lowest"),
        20,
    ),
    "pole": ({"latitude": "90", "angles": ("5", "30", "0", "0")}, ("turn 120", "gate 60"), 20),
    "own plane": ({"angles": ("5", "30", "0", "0")}, ("gate 30@0", "turn 120", "highest"), 20),
    "aside": ({"gravity_is": "effective", "vx": "-0.04", "vy": "0.03"}, ("highest", "lowest"), 20),
    "nearly aside": (
        {"gravity_is": "effective", "vx": "-0.04", "vy": f"0.03{'0' * 45}1"},
        ("highest", "lowest"),
        20,
    ),
    "from below": (
        {"x": "0", "y": "0", "vx": "0.3"},
        ("highest", "lowest", "gate 30@0", "turn 90"),
        20,
    ),
}
# what vanishes at the release with its rate, or may vanish there, so that nothing is decided
POSSIBLE = {
    ("own plane", "gate 30@0"),
    ("pole", "turn 120"),
    ("nearly aside", "highest"),
    ("nearly aside", "lowest"),
}
# with the checks by made-up motions these find every fault that is tried in every run
IN_EVERY_RUN = ("paris", "pole", "nearly aside")
TRUTHS = {}
form_of = cache(form)  # in 200 bits


FORMS = (
    ([1, 0, 0], [0, 0, 0], 0),
    ([0, 0, 0], [0, 1, 0], 0),
    ([0, 3, 0], [0, 0, 0], 2),
    ([0, 0, 1], [0, 0, 2], 1),
    ([0, 0, 0], [1, 0, 0], 1),
    ([0, 0, Fraction(1, 3)], [0, 0, Fraction(2, 7)], Fraction(1, 9)),
)


def forms_hold(module):
    """Lemmas 13.1 and 13.2 at a made-up motion that uses up one of the three bounds of its tube, none or all."""
    unit, made_up = 1 << BITS, ([1, 2, 3], [3, -1, 2], [-2, 4, 1], [0])
    rows = tuple([x * unit // 8 for x in row] for row in made_up)
    motions = {
        s: [
            [sum(Fraction(c, unit) * f(k) for k, c in enumerate(x)) for x in rows[:3]]
            for f in _powers(s)
        ]
        for s in (Fraction(-1, 2), Fraction(0), Fraction(3, 4))
    }
    for speed, (a, b, d), h in product(("0", "0.1"), FORMS, (1, Fraction(1, 4), 3)):
        balls = SceneBalls(scene(rotation_rate="0", vx=speed), BITS + 64)
        piece = Piece(
            balls,
            TaylorStep(Fraction(0), Fraction(h), Fraction(-1), Fraction(1), BITS, rows, EARTH),
        )
        axis = next(i for i in range(3) if a[i] or b[i])
        for part in range(5):
            sizes = [Fraction(part in (i, 4), 100) for i in range(3)]
            with ctx.workprec(BITS + 64):
                affine = module.AffineForm(
                    [ball(Fraction(x)) for x in a],
                    [ball(Fraction(x)) for x in b],
                    ball(Fraction(d)),
                )
                made = module.SectionOnStep(Covered(piece, Tube(*map(ball, sizes))), affine)
            for s, side in product(motions, (1, -1)):
                r, v, w = ([*x] for x in motions[s])
                for i, x in enumerate((r, v, w)):
                    x[axis] += side * sizes[i]
                with ctx.workprec(BITS + 64):
                    value = ball(h * (_dot(a, r) - d) + _dot(b, v))
                    assert made.value_at(ball(s)).overlaps(value)
                    rate = ball(h * _dot(a, v) + _dot(b, w))
                    assert made.rate_at(ball(s)).overlaps(rate)
            scale = float(h * max(a) * sizes[0] + max(b) * sizes[1])
            assert float(made.value.off.rad()) == pytest.approx(scale, rel=1e-6), (
                "what counts as near to zero"
            )


RELEASES = [  # position and velocity, or angle, azimuth and their rates
    *(
        dict(zip(("x", "y", "vx", "vy"), row, strict=True))
        for row in product("03", "04", ("0", "0.3"), ("0", "0.3"))
    ),
    {"x": "3", "y": "4", "vx": "-0.4", "vy": "0.3"},
    {"x": "3", "y": "4", "vx": "-0.4", "vy": f"0.3{'0' * 60}1"},
    {"x": "3", "y": "3", "length": "64"},  # the balls of x and y are exact, and equal
    *({"angles": angles} for angles in product(("0", "5", "180"), ("0", "30", "90"), "02", "03")),
    {"angles": ("5", f"30.{'0' * 60}1", "0", "3")},
]
SITES = [
    {},
    {"gravity_is": "effective"},
    {"rotation_rate": "0"},
    {"latitude": "0"},
    {"latitude": "-90"},
    {"latitude": "1e-40"},
]
AT_RELEASE = (
    "highest",
    "turn 0",
    "turn 30",
    "turn 90",
    "gate 0@0",
    "gate 30@0",
    "gate -90@0",
    "gate 30",
)
SURE = {  # what exact zeros show to vanish, or a sum of exact products
    ("3", "4", "0", "0"): {"highest", "turn 0", "turn 30", "turn 90"},
    ("3", "4", "-0.4", "0.3"): {"highest"},
    ("0", "4", "0.3", "0"): {"highest", "turn 90", "gate -90@0"},
    ("0", "0", "0.3", "0"): {"highest", "turn 90", "gate 0@0", "gate 30@0", "gate -90@0"},
    ("5", "30", "0", "3"): {"highest"},
    ("0", "90", "2", "3"): {"highest", "turn 0", "gate 0@0", "gate 30@0", "gate -90@0"},
}


@cache
def forms_at(site):
    """What the other code makes of the words at a site."""
    with mp.workprec(1000):
        return {word: form(scene(**SITES[site]), word) for word in AT_RELEASE}


def releases_hold(module):
    """Lemma 13.2: a form that is said to vanish at the release is 0 there in 1000 bits; those that have to be are."""
    for changes, site in product(RELEASES, range(len(SITES))):
        inputs = scene(**changes, **SITES[site])
        balls = SceneBalls(inputs, BITS)
        said = {word for word in AT_RELEASE if module.vanishes_at_release(balls, word)}
        with mp.workprec(1000):
            released = start(inputs)
            for word in said:
                assert abs(value(forms_at(site)[word], released)) < mp.mpf(10) ** -250, (
                    changes,
                    site,
                    word,
                )
        if SITES[site] == {"gravity_is": "effective"}:
            assert said >= SURE.get(changes.get("angles") or tuple(changes.values()), set()), (
                changes
            )


def wide_forms_hold(module):
    """Lemma 13.1 where a, b, d are balls of a box: the form and its rate of each member are inside."""
    unit = 1 << BITS
    rows = tuple([x * unit // 8 for x in row] for row in ([1, 2, 3], [3, -1, 2], [-2, 4, 1], [0]))
    still = Tube(arb(0), arb(0), arb(0))
    off = Fraction(1, 50)
    for h, place in product((Fraction(1, 4), 3), range(7)):
        balls = SceneBalls(scene(rotation_rate="0"), BITS + 64)
        piece = Piece(
            balls,
            TaylorStep(Fraction(0), Fraction(h), Fraction(-1), Fraction(1), BITS, rows, EARTH),
        )
        middle = [Fraction(x) for x in (1, -2, 3, 2, 1, -1, 1)]
        with ctx.workprec(BITS + 64):
            wide = [
                ball(x) + (arb(0, ball(off)) if i == place else 0) for i, x in enumerate(middle)
            ]
            affine = module.AffineForm(wide[:3], wide[3:6], wide[6])
            made = module.SectionOnStep(Covered(piece, still), affine)
        for side, s in product((1, -1), (Fraction(-1), Fraction(1, 2), Fraction(1))):
            member = [x + side * off * (i == place) for i, x in enumerate(middle)]
            r, v, w = (
                [sum(Fraction(c, unit) * f(k) for k, c in enumerate(x)) for x in rows[:3]]
                for f in _powers(s)
            )
            a, b, d = member[:3], member[3:6], member[6]
            with ctx.workprec(BITS + 64):
                value = ball(h * (_dot(a, r) - d) + _dot(b, v))
                assert made.value_at(ball(s)).overlaps(value), "the form of a member"
                rate = ball(h * _dot(a, v) + _dot(b, w))
                assert made.rate_at(ball(s)).overlaps(rate), "the rate of a member"
        # a wide d costs no more than it is wide, and nothing in the rate, as it is constant
        if place == 6:
            assert float(made.value.off.rad()) == pytest.approx(float(h * off), rel=1e-6)
            assert float(made.rate.off.rad()) < 1e-30


def few_bits_hold(module):
    """In few bits and orders a form and its rate contain what they are in all, at places and on parts of a step."""
    wave = [(0, 1, 0, -1)[k % 4] * Fraction(3**k, factorial(k)) for k in range(48)]  # sin 3s
    slow = [Fraction((-1) ** (k // 3), 2 + k) for k in range(48)]  # whose last orders are not small
    rows = tuple([int(c * 2**BITS) for c in row] for row in (wave, slow, [0], [0]))
    piece = Piece(
        SceneBalls(scene(), BITS + 64), TaylorStep(*map(Fraction, (0, 1, -1, 1)), BITS, rows, EARTH)
    )
    tube, ends = Tube(*map(arb, ("1e-9", "2e-9", "3e-9"))), [Fraction(k, 8) for k in range(-8, 9)]
    for (x, m), (n, (low, high)) in product(
        ((1, 0), (0, 1), (2, 1)), product((0, 1), combinations(ends, 2))
    ):
        with ctx.workprec(BITS + 64):
            affine = module.AffineForm([arb(0)] * 3, [arb(x), arb(m), arb(0)], arb(0))
            made = module.SectionOnStep(Covered(piece, tube), affine)
            at = made.rate_at if n else made.value_at
            both = [at(ball(s)) for s in (low, high)]
        with ctx.workprec(64):
            assert all(at(ball(s)).contains(y) for s, y in zip((low, high), both, strict=True)), (
                "at a place"
            )
            whole = at(ball(low).union(ball(high)))
            assert all(whole.contains(y) for y in both), "on a part"


def losses_hold(module):
    """What integers over few bits lose is (13.1c, d), in addition to (13.1a, b)."""
    bits = 6
    balls = SceneBalls(scene(rotation_rate="0"), BITS)
    h = Fraction(1, 2)
    rows = ([40, 0, 12], [0, 100], [-128], [0])
    step = TaylorStep(Fraction(0), h, Fraction(-1), Fraction(1), bits, rows, EARTH)
    a = [Fraction(n, 7) for n in (3, -5, 2)]
    b = [Fraction(n, 11) for n in (-4, 9, 6)]
    d = Fraction(8, 13)
    missed_a, missed_b, missed_d = (
        float(sum(x - Fraction(x * 2**bits // 1, 2**bits) for x in every))
        for every in ([h * x for x in a], b, [h * d])
    )
    eta, U, A = 0.01, 0.02, 0.04
    with ctx.workprec(BITS):
        piece = Piece(balls, step)
        affine = module.AffineForm([ball(x) for x in a], [ball(x) for x in b], ball(d))
        covered = Covered(piece, Tube(arb(eta), arb(U), arb(A)))
        made = module.SectionOnStep(covered, affine)
    P, K = float(piece.sizes.p), float(piece.sizes.k)
    a_size, b_size = (float(np.linalg.norm([float(x) for x in every])) for every in (a, b))
    value = a_size * float(h) * eta + b_size * U + missed_a * P + missed_b * K + missed_d
    rate = a_size * float(h) * U + b_size * A + missed_a * K + missed_b * 3 * K
    assert float(made.value.off.rad()) == pytest.approx(value, rel=1e-6)
    assert float(made.rate.off.rad()) == pytest.approx(rate, rel=1e-6)


def second_order_holds(module):
    """Lemma 13.4: (13.4a, b) by hand, where b·p is constant; where it may be 0, Lemma 13.1 alone."""
    balls = SceneBalls(scene(rotation_rate="0"), BITS)
    unit = 1 << 20
    rows = ([0, 3 * unit // 4, unit // 4], [0], [-3 * unit // 2], [0])  # x = 3s/4 + s²/4, w = 0
    step = TaylorStep(Fraction(0), Fraction(1), Fraction(-1), Fraction(1), 20, rows, EARTH)
    eta, U, A = 0.01, 0.02, 0.04
    with ctx.workprec(BITS):
        covered = Covered(Piece(balls, step), Tube(arb(eta), arb(U), arb(A)))
        zero = [arb(0)] * 3
        across = module.AffineForm(zero, [arb(0), arb(0), arb(2)], arb(0))
        along = module.AffineForm(zero, [arb(2), arb(0), arb(0)], arb(0))
        made = module.ApsisOnStep(covered, across)
        plain, same = (kind(covered, along) for kind in (module.SectionOnStep, module.ApsisOnStep))
    # |x| <= 1, |x'| <= 5/4, |x''| = 1/2; p·p' = 9s/16 + 9s²/16 + s³/8, and its derivative
    value = 2 / 3 * (2 * U + 2 * (eta * (5 / 4 + U) + 5 / 4))
    second = eta * (1 / 2 + A) + U * (5 / 2 + U) + 9 / 16 + 9 / 8 + 3 / 8
    rate = 2 / 3 * (2 * A + 2 * second)
    assert float(made.value.off.rad()) == pytest.approx(value, rel=1e-6)
    assert float(made.rate.off.rad()) == pytest.approx(rate, rel=1e-6)
    assert same.value.off.rad() == plain.value.off.rad()
    assert same.rate.off.rad() == plain.rate.off.rad()


def on_sphere(angle, size=1.0):
    """Polynomials of a point at an angle from straight down, both polynomials, times `size`."""
    sin = angle - angle**3 / 6 + angle**5 / 120 - angle**7 / 5040
    cos = 1 - angle**2 / 2 + angle**4 / 24 - angle**6 / 720
    return sin * size, -cos * size


def apses_hold(module):
    """Lemma 13.4 where polynomials miss r, r', r'' at s = 0 by e, f, g: one term of it at a time, and two."""
    s, slow, tiny = Polynomial([0.0, 1.0]), 0.01, 1e-3
    down, tilted = (0.0, -3.0), (1.5, -2.0)
    cases = [  # b, the true angle, the polynomials
        (tilted, 0 * s, on_sphere(-tiny * s)),
        (down, slow * s, on_sphere(slow * s - tiny)),
        (down, 0 * s, on_sphere(0 * s, 1 + tiny * (3 + s))),
        (tilted, 0 * s, on_sphere(-tiny * s**2)),
        (down, slow * s**2, on_sphere(slow * s**2 - tiny)),
        (down, tiny * (1 + s), on_sphere(0 * s)),
        (down, tiny * (1 + 3 * s / 2), on_sphere(tiny * s / 2)),
        (down, slow * s, on_sphere((slow - tiny) * s)),
        (down, 0 * s, on_sphere(0 * s, 1 + tiny * (3 + s**2))),
    ]
    balls, unit = SceneBalls(scene(), BITS + 64), 1 << BITS
    for b, angle, made_up in cases:
        gaps = [q - f for q, f in zip(on_sphere(angle), made_up, strict=True)]
        missed = [np.array([gap.deriv(n)(0) if n else gap(0) for gap in gaps]) for n in range(3)]
        x, z = ([int(c * unit) for c in f.coef] for f in made_up)
        step = TaylorStep(
            Fraction(0), Fraction(3), Fraction(-1), Fraction(1), BITS, (x, [0], z, [0]), EARTH
        )
        piece, tube = Piece(balls, step), Tube(*(arb(float(np.linalg.norm(q))) for q in missed))
        affine = module.AffineForm([arb(0)] * 3, [arb(b[0]), arb(0), arb(b[1])], arb(0))
        made = module.ApsisOnStep(Covered(piece, tube), affine)
        plain = module.SectionOnStep(Covered(piece, tube), affine)
        assert abs(b @ missed[1]) <= float(made.value.off.rad()) * (1 + 1e-6), (b, missed)
        assert abs(b @ missed[2]) <= float(made.rate.off.rad()) * (1 + 1e-6), (b, missed)
        if b == tilted and missed[1].any():  # what it is for
            assert float(made.value.off.rad()) < 0.8 * float(plain.value.off.rad())
        row = made.row(arb(0.5, 0.25))
        at = [row[name] for name in ("x", "y", "z", "vx", "vy", "vz")]
        with ctx.workprec(BITS + 64):
            for q in (Fraction(1, 4), Fraction(3, 4)):
                r, v = piece.values(ball(q))
                turned = [*balls.turned(r, -1), *balls.turned([x / 3 for x in v], -1)]
                assert all(p.overlaps(q) for p, q in zip(at, turned, strict=True))
        assert all(p.rad() >= r for p, r in zip(at, 3 * [tube.eta] + 3 * [tube.u / 3], strict=True))


def _dot(a, x):
    return sum(p * q for p, q in zip(a, x, strict=True))


def _powers(s):
    yield lambda k: s**k
    yield lambda k: k * s ** (k - 1) if k else 0
    yield lambda k: k * (k - 1) * s ** (k - 2) if k > 1 else 0


def passages_hold(module, names=CASES):
    """Passages lie where the motion is, in the direction that it has; as many as its form has signs."""
    for name in names:
        changes, words, end = CASES[name]
        inputs = scene(t_end=str(end), **changes)
        balls = SceneBalls(inputs, BITS + 64)
        course = Course(balls, [Fraction(0), Fraction(end)], False, ())
        both = [*product(words, (False, True))]
        course.scans = {
            (word, second): module.section_scan(balls, word, second) for word, second in both
        }
        for step in until(pair(Recurrence(balls, BITS, 64).chain(Fraction(1, 4))), Fraction(end)):
            course.advance(step)
        proved = course.finish()
        with mp.workprec(200):
            if name not in TRUTHS:
                times = [Fraction(end * k, 100) for k in range(1, 101)]
                TRUTHS[name] = [
                    [mp.mpf(x.numerator) / x.denominator for x in row]
                    for row in truth(inputs, times, 200)
                ]
            for word, second in both:
                check(inputs, word, proved.zeros[word, second], TRUTHS[name], end, name)


def check(inputs, word, zeros, states, end, name):
    parts, pars, way = form_of(inputs, word), constants(inputs), WAYS.get(word)
    signs = [int(mp.sign(value(parts, state))) for state in states]
    changes = [q for p, q in pairwise(signs) if p != q and way in (None, q)]
    ones = [z for z in zeros if z.parity == "one"]
    possible = [z for z in zeros if z.parity != "one"]
    assert [z.direction for z in ones] == changes, (name, word, len(ones), len(changes))
    assert len(possible) == ((name, word) in POSSIBLE), (name, word)
    assert all(z.t.low <= 0 < z.t.high < Fraction(1, 100) for z in possible)
    at = truth(inputs, [(z.t.low + z.t.high) / 2 for z in ones], 200) if ones else []
    for z, row in zip(ones, at, strict=True):
        state = [mp.mpf(x.numerator) / x.denominator for x in row]
        rates = [*state[3:], *acceleration(pars, state)]
        speed = value((*parts[:2], 0), rates)
        late, half = -value(parts, state) / speed, (z.t.high - z.t.low) / 2
        assert mp.sign(speed) == z.direction, (name, word, "direction")
        assert abs(late) <= mp.mpf(half.numerator) / half.denominator, (name, word, "time")
        assert half < Fraction(1, 10**25), (name, word, "useless")
        for x, rate, q in zip(state, rates, (z.x, z.y, z.z, z.vx, z.vy, z.vz), strict=True):
            low, high = (mp.mpf(e.numerator) / e.denominator for e in (q.low, q.high))
            assert low <= x + late * rate <= high, (name, word, "state")


def fast_rotation_is_refused(module):
    """A gate goes through the rest position, so there has to be one."""
    with pytest.raises(ArithmeticError, match="single rest position"):
        module.form(SceneBalls(scene(rotation_rate="0.5", equatorial_radius="5"), BITS), "gate 30")


def other_words_are_refused(module):
    """A word that means no section has no form: what was enclosed for it would be called something else."""
    balls = SceneBalls(scene(), BITS)
    for word in ("gates 30", "Turn 30", "highest 30", "30", "turn 30@0"):
        with pytest.raises((ArithmeticError, ValueError)):
            module.form(balls, word)


def all_hold(module, long):
    fast_rotation_is_refused(module)
    other_words_are_refused(module)
    forms_hold(module)
    losses_hold(module)
    second_order_holds(module)
    releases_hold(module)
    wide_forms_hold(module)
    apses_hold(module)
    few_bits_hold(module)
    passages_hold(module, CASES if long else IN_EVERY_RUN)
