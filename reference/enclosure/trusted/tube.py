"""TRUSTED. The tube about a step that the motion stays in, and the state in it (THEOREM.md, section 7)."""

from fractions import Fraction

from flint import arb, ctx

from .balls import Vector, ball, demand, interval, times, upper
from .shapes import Covered, Sizes, State, Tube
from .system import Scaled


def tube(k: Scaled, d: Sizes, eta: arb, gamma: arb) -> Tube:
    """Return the bounds of position, velocity and acceleration from |e| <= eta and |g| <= gamma (section 7)."""
    demand(eta < 2, "a bound is as wide as the sphere")
    turn, gw = d.k + k.omega_size, k.drag_size * k.omega_size
    u = gamma + turn * eta + d.d1
    torque = (
        k.c_size * eta + k.omega_size * gamma + k.drag_size * gamma + gw * (1 + d.p) * eta + d.d2
    )
    rate = d.p * k.c_size + d.k * k.omega_size + k.drag_size * d.k + gw * (1 + d.p**2) + d.d2
    a = torque + rate * eta + gamma * (turn * d.p + d.d1 + u) + turn * u + d.d1_rate
    return Tube(upper(eta), upper(u), upper(a))


def state(covered: Covered, s: arb, first: int = 0) -> tuple[Vector, Vector]:
    """Return balls that contain the true r and r' at `s`, of this from a component on."""
    (p, v), (eta, u, _) = covered.piece.values(s, first), covered.tube
    return [x + arb(0, eta) for x in p], [x + arb(0, u) for x in v]


def output(covered: Covered, time: Fraction) -> State:
    """Return position and velocity at an output time, in m and m/s; at 0 those of the release itself."""
    piece, balls = covered.piece, covered.piece.balls
    with ctx.workprec(balls.prec):
        demand(piece.begin <= time <= piece.end, "the tube holds on its own step only")
        r, v = state(covered, ball((time - piece.step.centre) / piece.step.h))
        moving = [balls.turned(r, -1), balls.turned(times(1 / piece.k.h, v), -1)]
        return tuple(
            interval(x * balls.length) for part in (moving if time else balls.release) for x in part
        )
