"""Every bound against its definition, at random numbers of every magnitude: a term that is lost shows."""

from fractions import Fraction
from random import Random

import mpmath as mp
import numpy as np
import pytest
from enclosure_oracle import cross, dot, lin, scene, unit_step
from flint import arb, arb_mat, arb_poly, ctx, fmpz_poly

from reference.enclosure.trusted.balls import ball
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.radius import PhasePoint, Radius
from reference.enclosure.trusted.six_columns import CUT, FINE, Columns, cut, residuals
from reference.enclosure.trusted.system import Scaled, SceneBalls
from reference.numbers.taylor_step import DIGIT_BITS, Digits, TaylorStep


def exact(x):
    """The middle of a ball, or a number, as a fraction."""
    m, e = x.mid().man_exp()
    return Fraction(int(m)) * Fraction(2) ** int(e)


def length(a):
    with mp.workprec(60):
        square = dot(a, a)
        return mp.sqrt(mp.mpf(square.numerator) / square.denominator)


def poly(row, s, n=0):
    """The n-th derivative at s."""
    for _ in range(n):
        row = [k * c for k, c in enumerate(row)][1:]
    return sum((c * s**k for k, c in enumerate(row)), Fraction(0))


def anything(rng):
    """A scene whose constants have any size, and a polynomial step likewise."""
    some = lambda low, high: f"{10 ** rng.uniform(low, high):.12f}"  # noqa: E731
    balls = SceneBalls(
        scene(
            length="1", angles=("60", "30", "20", "10"), latitude=f"{rng.uniform(-90, 90):.6f}",
            gravity=rng.choice(["0", some(-3, 3)]), drag=rng.choice(["0", some(-3, 3)]),
            rotation_rate=rng.choice(["0", some(-3, 2), "-" + some(-3, 2)]), equatorial_radius=some(-9, 1),
        ), 200,
    )  # fmt: skip
    bits = rng.choice([4, 10, 64])
    scale = [10 ** rng.uniform(-4, 2) for _ in range(4)]
    rows = [
        [round(2**bits * rng.choice((0, 1, -1)) * x) for x in scale[: rng.randint(1, 4)]]
        for _ in range(3)
    ]
    if rng.random() < 0.7:  # on the sphere at s = 0
        for i, row in enumerate(rows):
            row[0] = 2**bits if i == rng.randrange(3) else 0
    rows.append([round(2**bits * rng.choice((0, 0, 1)) * 10 ** rng.uniform(-3, 2))])
    return Piece(balls, unit_step(bits, tuple(rows)))


def of_digits(rng):
    """The same, the polynomials as digits: few orders, often no more than one, some of them all zero."""
    balls, count, orders = anything(rng).balls, rng.randint(2, 4), rng.randint(1, 3)
    size = (4, count, orders)
    table = np.reshape(
        [rng.choice((0, 1)) * rng.randint(-(2**21), 2**21) for _ in range(np.prod(size))], size
    )
    if rng.random() < 0.3:
        table[:3, :, rng.randrange(orders) :] = 0
    bits = DIGIT_BITS * count - 1
    return Piece(balls, unit_step(bits, Digits(table.astype(np.int32))))


def defects(piece, s):
    """d1, d2, p, K, τ, d1' from their definitions in (1), not from Lemma 0."""
    rows = [
        [Fraction(int(c), 1 << piece.step.bits) for c in row] for row in piece.step.coefficients
    ]
    k = piece.constants
    W, c, g = [exact(x) for x in k.omega], [exact(x) for x in k.c], exact(k.drag)
    p, p1, p2 = ([poly(row, s, n) for row in rows[:3]] for n in range(3))
    V, V1 = lin((1, p1), (1, cross(W, p))), lin((1, p2), (1, cross(W, p1)))
    K, K1 = cross(p, V), lin((1, cross(p1, V)), (1, cross(p, V1)))
    turn = lin((1, K), (-1, W))
    d1 = lin((1, p1), (-1, cross(turn, p)))
    d2 = lin((1, K1), (-1, cross(p, c)), (-1, cross(K, W)), (g, turn), (g * dot(W, p), p))
    rate = lin((1, p2), (-1, cross(K1, p)), (-1, cross(turn, p1)))
    return d1, d2, p, K, [dot(p, p) - 1], rate


def test_sizes_bound_what_their_names_say_and_nearly_reach_it(size):
    rng, best = Random(5), np.zeros(6)
    for _ in range(size(250, 600)):
        piece = anything(rng)
        try:
            bounds = piece.sizes
        except ArithmeticError:
            continue
        for s in (Fraction(-1), Fraction(0), Fraction(1)):
            got = [length(x) for x in defects(piece, s)]
            for i, (x, bound) in enumerate(zip(got, bounds, strict=True)):
                assert x <= mp.mpf(float(bound)) * (1 + mp.mpf(10) ** -9), (i, piece.step)
                best[i] = max(best[i], x / float(bound) if x else 0)
    assert all(best > 0.97), best


def test_sizes_from_digits_bound_what_their_names_say(size):
    pytest.importorskip("numba")
    rng, tried, most = Random(6), 0, size(120, 300)
    for _ in range(most):
        piece = of_digits(rng)
        try:
            bounds = piece.sizes
        except ArithmeticError:  # numbers that sums of digits may not hold
            continue
        tried += 1
        for s in (Fraction(-1), Fraction(0), Fraction(1)):
            for x, bound in zip(map(length, defects(piece, s)), bounds, strict=True):
                assert x <= mp.mpf(float(bound)) * (1 + mp.mpf(10) ** -9)
    assert tried > most / 3


def moving(rng):
    """A scene with all kinds of constants, and a step of it on a part of -1 <= s <= 1, about on the sphere."""
    some = lambda low, high: f"{rng.uniform(low, high):.12f}"  # noqa: E731
    angles = (some(5, 170), some(-180, 180), some(-60, 60), some(-60, 60))
    inputs = scene(
        length="1", angles=angles, latitude=some(-90, 90), gravity=some(0.1, 3), drag=rng.choice(["0", some(0.1, 2)]),
        rotation_rate=some(-2, 2), equatorial_radius=some(0, 0.5),
    )  # fmt: skip
    balls, bits = SceneBalls(inputs, 128), 64
    p, v = np.array([float(x) for x in balls.r]), np.array([rng.gauss(0, 0.5) for _ in range(3)])
    v -= np.dot(p, v) * p
    rows = [*np.transpose([p, v, [rng.gauss(0, 0.1) for _ in range(3)]]), [rng.uniform(0, 1)]]
    whole = tuple([int(x * 2**bits) for x in row] for row in rows)
    low, span = Fraction(rng.randint(-8, 0), 32), Fraction(rng.randint(1, 32), 1024)
    h = Fraction(rng.randint(1, 4), 4)
    return Piece(balls, TaylorStep(-h * low, h, low, low + span, bits, whole))


def in_doubles(piece):
    """The constants and sizes of a step, as they stand in THEOREM.md."""
    k = {
        name: float(getattr(piece.constants, name))
        for name in ("c_size", "omega_size", "drag_size", "w", "S")
    }
    k |= {
        name: float(getattr(piece.constants, name)) for name in ("h", "lambda_minus", "lambda_plus")
    }
    return Row(k), Row({name: float(x) for name, x in piece.sizes._asdict().items()})


class Row(dict):
    """Numbers by their names."""

    __getattr__ = dict.__getitem__


def jumped(rng, piece, bound):
    """Where the step before ended, so that p and K jump by random amounts in all components; return their sizes."""
    jump = [10 ** rng.uniform(-4, -2) for _ in range(6)]
    with ctx.workprec(128):
        p, v = piece.values(ball(piece.step.low))
        start = [
            *p,
            *(
                x / piece.constants.h
                for x in cross(p, lin((1, v), (1, cross(piece.constants.omega_0, p))))
            ),
        ]
        last = [x + gap * rng.choice((-1, 1)) for x, gap in zip(start, jump, strict=True)]
        bound.last = PhasePoint(last[:3], last[3:])
    return jump


def section_3(K, P):
    return (K.c_size + K.w**2 + K.drag_size * K.omega_size * (1 + P)) / (2 * K.w)


def section_7(K, D, eta, gamma):
    W, c, g = K.omega_size, K.c_size, K.drag_size
    U = gamma + (D.k + W) * eta + D.d1
    K1 = D.p * c + D.k * W + g * (D.k + W * (1 + D.p**2)) + D.d2
    A = c * eta + W * gamma + g * (gamma + W * (1 + D.p) * eta) + D.d2
    return eta, U, A + K1 * eta + gamma * ((D.k + W) * D.p + D.d1 + U) + (D.k + W) * U + D.d1_rate


def same(got, expected):
    return np.allclose([float(x) for x in got], expected, rtol=1e-6, atol=0)


def test_one_radius_is_carried_as_theorem_c_says():
    rng, bounded, too_wide = Random(1), 0, 0
    while bounded < 50:
        piece = moving(rng)
        K, D = in_doubles(piece)
        bound, span = Radius(piece.balls), float(piece.step.high - piece.step.low)
        bound.eta = arb(10) ** -rng.randint(0, 3)
        before, jump = float(bound.eta), jumped(rng, piece, bound)
        eta = before + np.linalg.norm(jump[:3]) + np.linalg.norm(jump[3:]) / (K.w / K.h)
        source, ck = D.d2 / K.w + D.d1, K.c_size + D.k**2
        far = np.exp(span * section_3(K, D.p)) * (eta * (1 + D.k / K.w) + span * source)
        rate = (
            max(K.lambda_minus, K.lambda_plus + (K.S + K.w * far) ** 2)
            + ck * far
            + K.drag_size * K.omega_size * D.p
        )
        end = (eta + span * (ck * D.tau / (2 * K.w) + source)) * np.exp(span * rate / (2 * K.w))
        if end >= 2:
            too_wide += 1
            with pytest.raises(ArithmeticError, match="as wide as the sphere"):
                bound.advance(piece)
            continue
        bounded += 1
        got = bound.advance(piece).tube
        assert same(got, section_7(K, D, end, (K.w + D.k) * end))
        assert same([bound.eta], [end])
    assert too_wide > 0


def norms_of(norms):
    return norms.Wp, norms.WK, norms.R1, norms.R2


def test_six_columns_are_carried_as_theorem_e_says():
    rng, bounded = Random(2), 0
    while bounded < 50:
        piece = moving(rng)
        K, D = in_doubles(piece)
        bound, step, span = (
            Columns(piece.balls),
            piece.step,
            float(piece.step.high - piece.step.low),
        )
        rest, z, before = ([10 ** rng.uniform(-3, -2) for _ in range(n)] for n in (6, 6, 36))
        bound.delta, bound.z = [arb(x) for x in rest], [arb(x) for x in z]
        before, jump = np.array(before).reshape(6, 6), jumped(rng, piece, bound)
        bound.W_end = arb_mat(6, 6, [arb(x) for x in before.flat])
        whole = [
            [[rng.randint(-(2**FINE), 2**FINE) for _ in range(3)] for _ in range(6)]
            for _ in range(6)
        ]
        rows = np.array(
            [
                [float(x) for x in norms_of(norms)]
                for norms in residuals(piece, [[fmpz_poly(f) for f in c] for c in whole])
            ]
        )
        unit = np.repeat([1, 1 / K.h], 3)[:, None] / 2.0**FINE
        start, end = (
            unit * [[float(poly(whole[j][i], Fraction(s))) for j in range(6)] for i in range(6)]
            for s in (step.low, step.high)
        )
        back = np.linalg.inv(start)
        box = abs(back @ before) @ z + abs(back) @ np.add(rest, jump)
        zp, zk, r1, r2 = box @ rows
        D1, D2 = D.d1 + r1 + zp * zk, D.d2 + r2 + K.drag_size * K.omega_size * zp**2
        left = span * (D2 / K.w + D1) * np.exp(span * section_3(K, D.p + zp))
        expected = section_7(K, D, zp + left, zk + left * K.w)
        if expected[0] >= 2:
            with pytest.raises(ArithmeticError, match="as wide as the sphere"):
                bound.advance(piece, whole)
            continue
        bounded += 1
        got = bound.advance(piece, whole).tube
        assert np.allclose([float(x) for x in bound.z], box, rtol=1e-6)
        assert np.allclose(
            [float(x) for x in bound.delta], [left] * 3 + [left * K.w / K.h] * 3, rtol=1e-6
        )
        assert np.allclose(
            np.array([[float(bound.W_end[i, j]) for j in range(6)] for i in range(6)]), end
        )
        assert same(got, expected)


def test_what_holds_for_the_whole_run_follows_from_the_energy():
    rng = Random(3)
    for _ in range(100):
        piece = anything(rng)
        balls, k = piece.balls, Scaled(piece.balls, Fraction(1, 4), 64)
        r, H, W, c = ([float(x) for x in v] for v in (balls.r, balls.H, balls.omega, balls.c))
        J = np.dot(H, H) / 2 - np.dot(W, H) - np.dot(c, r)
        turn, pull, w0 = np.linalg.norm(W), np.linalg.norm(c), float(balls.w0)
        S = turn + np.sqrt(turn**2 + 2 * (J + pull))
        scale = w0**2 + turn**2 + S**2
        got = [float(x) for x in (balls.S**2, balls.lambda_minus, balls.lambda_plus)]
        assert np.allclose(
            got, [S**2, w0**2 + turn**2 / 2 + J, pull - w0**2], rtol=0, atol=1e-9 * scale
        )
        got = [
            float(x) for x in (k.w, k.S, k.lambda_minus, k.lambda_plus, k.drag, k.omega[2], *k.c)
        ]
        full = [
            w0,
            balls.S,
            balls.lambda_minus,
            balls.lambda_plus,
            balls.drag,
            balls.omega[2],
            *balls.c,
        ]
        assert np.allclose(
            got, [float(x) / 4**n for x, n in zip(full, (1, 1, 2, 2, 1, 1, 2, 2, 2), strict=True)]
        )


def test_residuals_bound_what_their_names_say_and_nearly_reach_it(size):
    rng, best = Random(6), np.zeros(4)
    for _ in range(size(120, 300)):
        piece = anything(rng)
        scale = [10 ** rng.uniform(-5, 2) for _ in range(6)]
        column = [
            [round(2**FINE * x * rng.choice((0, 1, -1))) for _ in range(rng.randint(1, 2))]
            for x in scale
        ]
        (norms,) = residuals(piece, [[fmpz_poly(f) for f in column]])
        bounds = norms_of(norms)
        W, c, g = (
            [exact(x) for x in piece.constants.omega_0],
            [exact(x) for x in piece.constants.c],
            exact(piece.constants.drag),
        )
        for s in (Fraction(-1), Fraction(0), Fraction(1)):
            _, _, p, K, _, _ = defects(piece, s)
            whole = [[Fraction(x, 1 << FINE) for x in f] for f in column]
            (P, Q), (P1, Q1) = (
                [[poly(f, s, n) for f in part] for part in (whole[:3], whole[3:])] for n in (0, 1)
            )
            R1 = lin((1, P1), (-1, cross(Q, p)), (-1, cross(lin((1, K), (-1, W)), P)))
            R2 = lin(
                (1, Q1),
                (-1, cross(P, c)),
                (-1, cross(Q, W)),
                (g, Q),
                (g * dot(W, P), p),
                (g * dot(W, p), P),
            )
            for i, (a, bound) in enumerate(zip((P, Q, R1, R2), bounds, strict=True)):
                x = length(a)
                assert x <= mp.mpf(float(bound)) * (1 + mp.mpf(10) ** -9), i
                best[i] = max(best[i], x / float(bound) if x else 0)
    assert all(best > 0.97), best


def test_a_cut_polynomial_contains_the_whole():
    with ctx.workprec(64):
        for row in ([0] * CUT + [1], [0] * (CUT + 1) + [3, -4], [1] * (2 * CUT)):
            short = cut(arb_poly(row))
            assert len(short) <= CUT
            for s in (Fraction(-1), Fraction(-7, 8), Fraction(1)):
                value = sum(c * s**k for k, c in enumerate(row))
                with ctx.workprec(400):
                    assert short(arb(s.numerator) / s.denominator).contains(
                        arb(value.numerator) / value.denominator
                    )
