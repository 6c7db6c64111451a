"""TRUSTED. The tube about a step that the motion stays in, and the state in it (THEOREM.md, section 7).

In the time of a step, lengths over that of the rod:

| name                 | symbol                                 | unit |
|----------------------|----------------------------------------|------|
| `eta`, `gamma`       | η >= |e| = |r − p|, Γ >= |g| = |H − K| | 1    |
| `U`, `A`             | bounds of |v − p'|, |r'' − p''|        | 1    |
| `P`, `K`, `D1`, `D2` | the sizes of section 6                 | 1    |
| `K_rate`             | K1 >= |K'|                             | 1    |
| `g_rate`             | Γ1 >= |g'| = |H' − K'|                 | 1    |
| `c`, `Omega`, `drag` | |c|, |Ω|, γ                            | 1    |
"""

from fractions import Fraction

from flint import arb, ctx

from .balls import Vector, ball, demand, interval, times, upper
from .shapes import Covered, Sizes, State, Tube
from .system import Scaled


def tube(constants: Scaled, sizes: Sizes, eta: arb, gamma: arb) -> Tube:
    """Return the bounds of position, velocity and acceleration from |e| <= eta and |g| <= gamma (section 7)."""
    demand(eta < 2, "a bound is as wide as the sphere")
    c = constants.c_size
    Omega = constants.omega_size
    drag = constants.drag_size
    P = sizes.p
    K = sizes.k
    D1 = sizes.d1
    D2 = sizes.d2

    U = gamma + (K + Omega) * eta + D1  # (7.1)
    g_rate = c * eta + Omega * gamma + drag * gamma + drag * Omega * (1 + P) * eta + D2  # (7.2)
    K_rate = P * c + K * Omega + drag * K + drag * Omega * (1 + P**2) + D2  # (7.3)
    A = (
        g_rate + K_rate * eta + gamma * ((K + Omega) * P + D1 + U) + (K + Omega) * U + sizes.d1_rate
    )  # (7.4)
    return Tube(upper(eta), upper(U), upper(A))


def state(covered: Covered, s: arb, first: int = 0) -> tuple[Vector, Vector]:
    """Return balls that contain the true r and r' at `s`, of this from a component on."""
    p, v = covered.piece.values(s, first)
    eta = arb(0, covered.tube.eta)
    U = arb(0, covered.tube.u)
    return [x + eta for x in p], [x + U for x in v]


def output(covered: Covered, time: Fraction) -> State:
    """Return position and velocity at an output time, in m and m/s; at 0 those of the release itself."""
    piece = covered.piece
    balls = piece.balls
    with ctx.workprec(balls.prec):
        demand(piece.begin <= time <= piece.end, "the tube holds on its own step only")
        if time:
            r, v = state(covered, ball((time - piece.step.centre) / piece.step.h))
            position = balls.turned(r, -1)
            velocity = balls.turned(times(1 / piece.constants.h, v), -1)
        else:
            position, velocity = balls.release
        return tuple(interval(x * balls.length) for x in (*position, *velocity))
