"""THEOREM.md line by line, at random rational points where every identity must hold exactly."""

from fractions import Fraction
from random import Random

import pytest
from enclosure_oracle import cross, dot, lin


def any_vector(rng):
    return [Fraction(rng.randint(-50, 50), rng.randint(1, 9)) for _ in range(3)]


def unit(rng):
    """A rational point of the sphere, by stereographic projection."""
    a, b = (Fraction(rng.randint(-30, 30), rng.randint(1, 9)) for _ in range(2))
    n = 1 + a * a + b * b
    return [2 * a / n, 2 * b / n, (n - 2) / n]


@pytest.fixture(params=range(40))
def at(request):
    """r, H on the manifold, everything else arbitrary."""
    rng = Random(request.param)
    r = unit(rng)
    H = cross(r, any_vector(rng))
    names = {n: any_vector(rng) for n in ("c", "W", "p", "p1", "p2", "d1", "d2")}
    names["K"] = cross(names["p"], any_vector(rng))
    return {
        "r": r,
        "H": H,
        "g": Fraction(rng.randint(0, 20), 7),
        "w": Fraction(rng.randint(1, 30), 7),
        **names,
    }


def rates(at, r, H):
    turn = lin((1, H), (-1, at["W"]))
    along = dot(at["W"], r)
    H1 = lin(
        (1, cross(r, at["c"])), (1, cross(H, at["W"])), (-at["g"], turn), (-at["g"] * along, r)
    )
    return cross(turn, r), H1


def errors(at):
    """e, g and their rates for an approximant with arbitrary defects."""
    v, H1 = rates(at, at["r"], at["H"])
    p1, K1 = rates(at, at["p"], at["K"])
    p1, K1 = lin((1, p1), (1, at["d1"])), lin((1, K1), (1, at["d2"]))
    e, g = lin((1, at["r"]), (-1, at["p"])), lin((1, at["H"]), (-1, at["K"]))
    return e, g, lin((1, v), (-1, p1)), lin((1, H1), (-1, K1)), p1, K1


def test_momentum_form_is_the_pendulum_with_drag(at):
    r, H, W, c, g = (at[n] for n in ("r", "H", "W", "c", "g"))
    v, H1 = rates(at, r, H)
    second = lin((1, cross(H1, r)), (1, cross(lin((1, H), (-1, W)), v)))
    force = lin((1, c), (-1, cross(W, cross(W, r))), (-2, cross(W, v)), (-g, v))
    assert second == lin((1, force), (-(dot(v, v) + dot(r, force)), r))
    assert dot(r, v) == 0


def test_drag_torque_is_quadratic_on_the_sphere(at):
    v, _ = rates(at, at["r"], at["H"])
    turn = lin((1, at["H"]), (-1, at["W"]))
    assert cross(at["r"], v) == lin((1, turn), (dot(at["W"], at["r"]), at["r"]))


def test_constraints_are_kept_on_the_sphere_and_energy_only_falls(at):
    v, H1 = rates(at, at["r"], at["H"])
    assert dot(at["r"], v) == 0
    assert dot(H1, at["r"]) + dot(at["H"], v) == 0
    turn = lin((1, at["H"]), (-1, at["W"]))
    assert dot(turn, H1) - dot(at["c"], v) == -at["g"] * dot(v, v)


def test_constraints_are_neutral_everywhere_without_drag(at):
    free = {**at, "g": 0}
    p1, K1 = rates(free, at["p"], at["K"])
    assert dot(at["p"], p1) == 0
    assert dot(K1, at["p"]) + dot(at["K"], p1) == 0


def test_defects_come_from_one_force_and_the_distance_from_the_sphere(at):
    """Lemma 0, for any p, p', p'' and any pull."""
    p, p1, p2, c, W, g, pull = (at[n] for n in ("p", "p1", "p2", "c", "W", "g", "w"))
    V, V1 = lin((1, p1), (1, cross(W, p))), lin((1, p2), (1, cross(W, p1)))
    K, K1 = cross(p, V), lin((1, cross(p1, V)), (1, cross(p, V1)))
    d = lin((1, V1), (1, cross(W, V)), (g, p1), (-1, c), (pull, p))
    tau = dot(p, p) - 1
    v, H1 = rates(at, p, K)
    assert lin((1, p1), (-1, v)) == lin((dot(p, p1), p), (-tau, V))
    assert lin((1, K1), (-1, H1)) == lin((1, cross(p, d)), (g * tau, W))
    assert dot(K, p) == 0
    # as it is computed, with the Earth's axis for the third
    (x, m, w), (x1, m1, _), W = p, p1, [0, 0, W[2]]
    V1, V = lin((1, p2), (1, cross(W, p1))), lin((1, p1), (1, cross(W, p)))
    plain = lin((1, p2), (2 * W[2], [-m1, x1, 0]), (g, p1), (-1, c))
    lift = pull - W[2] ** 2
    assert lin((1, plain), (1, [lift * x, lift * m, pull * w])) == lin(
        (1, V1), (1, cross(W, V)), (g, p1), (-1, c), (pull, p)
    )


def test_third_derivative_is_that_of_the_equations_of_motion(at):
    r, v, a, W, c, g = (at[n] for n in ("p", "p1", "p2", "W", "c", "g"))

    def force(r, v, c):
        return lin((1, c), (-1, cross(W, lin((1, cross(W, r)), (2, v)))), (-g, v))

    def second(step):
        here, moving = lin((1, r), (step, v)), lin((1, v), (step, a))
        F = force(here, moving, c)
        return lin((1, F), (-dot(moving, moving) - dot(here, F), here))

    # of a polynomial of degree four or less this is the derivative
    exact = lin((8, second(1)), (-8, second(-1)), (-1, second(2)), (1, second(-2)))
    F, F1 = force(r, v, c), force(v, a, [0, 0, 0])
    rate = 2 * dot(v, a) + dot(v, F) + dot(r, F1)
    assert exact == lin((12, F1), (-12 * (dot(v, v) + dot(r, F)), v), (-12 * rate, r))


def test_energy_identity_of_theorem_n(at):
    e, g, e1, g1, _, _ = errors(at)
    w2, G, W, r, p = at["w"] ** 2, at["g"], at["W"], at["r"], at["p"]
    left = dot(g, g1) + w2 * dot(e, e1)
    drag = -G * dot(g, lin((1, g), (dot(W, e), r), (dot(W, p), e)))
    inner = lin((1, at["c"]), (-w2, r))
    assert left == dot(g, cross(e, inner)) - w2 * dot(e, at["d1"]) - dot(g, at["d2"]) + drag


def test_energy_identity_of_theorem_c(at):
    e, g, e1, g1, _, _ = errors(at)
    r, H, K, c, G, W, p = (at[n] for n in ("r", "H", "K", "c", "g", "W", "p"))
    v, _ = rates(at, r, H)
    w2 = at["w"] ** 2
    rg = dot(r, g)
    flat = lin((1, g), (-rg, r))
    rg1 = dot(v, g) + dot(r, g1)
    left = dot(g, g1) - rg * rg1 + w2 * dot(e, e1)
    er, cr, Kr = dot(e, r), dot(c, r), dot(K, r)
    e_flat, k, c_flat = lin((1, e), (-er, r)), lin((1, K), (-Kr, r)), lin((1, c), (-cr, r))
    bracket = lin((cr - w2, e_flat), (dot(k, e_flat), k))
    right = -dot(flat, cross(r, bracket)) + er * dot(flat, cross(r, c_flat))
    right -= Kr * er * dot(flat, cross(r, K)) + dot(flat, at["d2"]) + w2 * dot(e, at["d1"])
    right -= G * (dot(flat, flat) + dot(W, p) * dot(flat, e))
    assert left == right


def test_acceleration_error_is_the_sum_that_is_bounded(at):
    e, g, e1, g1, p1, K1 = errors(at)
    r, H, K, W = (at[n] for n in ("r", "H", "K", "W"))
    v, H1 = rates(at, r, H)
    true = lin((1, cross(H1, r)), (1, cross(lin((1, H), (-1, W)), v)))
    near = lin((1, cross(K1, at["p"])), (1, cross(lin((1, K), (-1, W)), p1)))  # p'' without d1'
    terms = (
        (1, cross(g1, r)),
        (1, cross(K1, e)),
        (1, cross(g, v)),
        (1, cross(lin((1, K), (-1, W)), e1)),
    )
    assert lin((1, true), (-1, near)) == lin(*terms)
