"""The third source paper, method 3: complex variables; and the paper's conclusion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..checks import Check, Finding, Identity, Statement
from ..digits import MP, Vector, add, derivative, j, mpf, norm, scale, shown, sqrt
from ..linear import motion, rate_up
from ..mathar.slow import linearised
from ..points import Point, points
from .axes import D, axes_rate, coupled, measured_rate, stiffness


def _in_turning_frame(p: Point, rate: Any, drive: Callable[[Vector, Vector], Vector]) -> Vector:
    """Return the acceleration in axes that turn at `rate`; in axes at rest it is `drive(place, velocity)`.

    The point's x, y, vx, vy are those in the turning axes, which coincide with the axes at rest at this moment.
    """
    place, speed = (p.x, p.y), (p.vx, p.vy)
    at_rest = add(speed, scale(rate, (-p.y, p.x)))
    force = drive(place, at_rest)
    return add(force, scale(2 * rate, (p.vy, -p.vx)), scale(rate**2, place))


def _simple_in_frame() -> Finding:
    def excess(p: Point) -> Any:
        turned = _in_turning_frame(p, axes_rate(p), lambda place, speed: coupled(p, place, speed))
        return norm(add(turned, scale(stiffness(p), (p.x, p.y))))

    gap = max(map(excess, points()))
    return Finding(gap < mpf("1e-45"), f"x'' + (g/L + ω_P²) x = {shown(gap)} in axes that turn at -ω sinα")


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    m = f"{D}, method 3"

    def equation(p: Point) -> Any:
        z, v = MP.mpc(p.x, p.y), MP.mpc(p.vx, p.vy)
        return -2 * j * rate_up(p) * v - p.gravity / p.length * z

    def spun(p: Point) -> tuple[Any, Any, Any]:
        """Return w, w', w'' of z = w exp(-iω_P t) at t = 0, for the linear motion from the point."""

        def w(t: Any) -> Any:
            x, y = motion(p, (p.x, p.y, p.vx, p.vy), t)[:2]
            return MP.mpc(x, y) * MP.expj(rate_up(p) * t)

        return w(MP.zero), derivative(w), derivative(w, 0, 2)

    def substituted(p: Point) -> Any:
        w, first, second = spun(p)
        up = rate_up(p)
        return (second - 2 * j * up * first - up**2 * w) + 2 * j * up * (first - j * up * w) + p.gravity / p.length * w

    return [
        Identity(
            "methods_3_z",
            m,
            "zddot + 2iω_P zdot + (g/L) z = 0, ω_P = ω sinα",
            equation,
            lambda p: MP.mpc(*linearised(p)),
            remark="ω_P with the other sign than in method 1 and in the conclusion, where it is the axes' -ω sinα",
        ),
        Identity(
            "methods_3_w",
            m,
            "(wddot - 2iω_p wdot - ω_P² w) + 2iω_P (wdot - iω_P w) + (g/L) w = 0",
            substituted,
            lambda p: MP.zero,
        ),
        Identity(
            "methods_3_simple",
            m,
            "wddot + (g/L + ω_P²) w = 0",
            lambda p: -stiffness(p) * spun(p)[0],
            lambda p: spun(p)[2],
        ),
        Identity("methods_3_omega", m, "ω = sqrt(g/L + ω_P²)", lambda p: sqrt(stiffness(p)), measured_rate),
        Statement(
            "methods_end_frame",
            f"{D}, conclusion",
            "in axes that turn at -ω sinα: simple harmonic, frequency sqrt(g/L + ω_P²)",
            _simple_in_frame,
        ),
    ]
