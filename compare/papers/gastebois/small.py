"""Gastebois, sections 5 and 6.1: the equations for small angles and their general solution."""

from __future__ import annotations

from typing import Any

from ...approximations.gastebois import constants_of
from ..checks import Answer, Approximate, Check, Identity, Statement, component, over, section
from ..digits import MP, Vector, cos, dot, j, shown, sin, vanishes, vector
from ..first_principles import (
    acceleration_of,
    coupled_at,
    coupled_complex,
    forces,
    linearised,
    motion,
    pull,
    rate_up,
    swing_rate,
    turning_rates,
    uniform_acceleration,
)
from ..points import Point, points

CONSTANTS = (
    ("c1", "c1 = ((ω-Ω_z) x0 - v_y0) / 2ω"),
    ("c1p", "c1' = ((ω-Ω_z) y0 + v_x0) / 2ω"),
    ("c2", "c2 = ((ω+Ω_z) x0 + v_y0) / 2ω"),
    ("c2p", "c2' = ((ω+Ω_z) y0 - v_x0) / 2ω"),
)


def _flat(s: Any) -> tuple[Vector, Vector]:
    """Return -l, 0 and z, z' at s times the point's amplitude."""
    p = points()[0]
    low = p.swinging(s)
    return (-p.length, 0), (low.z, low.vz)


def _swung(s: Any) -> tuple[Any, Any]:
    """Return g_a (θm² - θ²) and v²/L0 at θ = θm/2, for a pendulum let go at θm = 0.3 s."""
    p = points()[0]
    top, angle = MP.mpf("0.3") * s, MP.mpf("0.15") * s
    return p.gravity * (top**2 - angle**2), 2 * p.gravity * (cos(angle) - cos(top))


def _with_tension(p: Point) -> Vector:
    """Return -T/m x/L0 + 2y'Ω sinλ_a - 2z'Ω cosλ_a, and the line for y''."""
    up, north, stiff = rate_up(p), p.rate * cos(p.phi), pull(p) / p.length
    return vector(-stiff * p.x + 2 * p.vy * up - 2 * p.vz * north, -stiff * p.y - 2 * p.vx * up)


def _constants(p: Point) -> Vector:
    """Return c1, c1', c2, c2' of 6.1 for the point's x, y, vx, vy."""
    return constants_of((p.x, p.y), (p.vx, p.vy), swing_rate(p), rate_up(p))


def _rates(p: Point) -> Vector:
    """Return ω + Ω_z and ω - Ω_z."""
    return vector(swing_rate(p) + rate_up(p), swing_rate(p) - rate_up(p))


def _phases(p: Point) -> Vector:
    fast, slow = p.t * _rates(p)
    return vector(cos(fast), sin(fast), cos(slow), sin(slow))


def _printed_xy(p: Point) -> Vector:
    """Return x and y of 6.1."""
    (a, b, c, d), (cf, sf, cs, ss) = _constants(p), _phases(p)
    return vector(a * cf + b * sf + c * cs - d * ss, b * cf - a * sf + d * cs + c * ss)


def _velocity(p: Point, last: int) -> Vector:
    """Return v_x and v_y of 6.1, the last term of v_x with sin (3) or with cos (2) of the slow phase."""
    (a, b, c, d), phases, (fast, slow) = _constants(p), _phases(p), _rates(p)
    cf, sf, cs, ss = phases
    vx = -a * fast * sf + b * fast * cf - c * slow * ss - d * slow * phases[last]
    return vector(vx, -b * fast * sf - a * fast * cf - d * slow * ss + c * slow * cs)


def _complex(p: Point) -> Any:
    (a, b, c, d), (fast, slow) = _constants(p), _rates(p)
    return (a + j * b) * MP.expj(-fast * p.t) + (c + j * d) * MP.expj(slow * p.t)


def _moved(p: Point) -> Vector:
    """Return x, y, vx, vy of the linear motion at the point's time."""
    return motion(p, (p.x, p.y, p.vx, p.vy), p.t)


def _whole_part() -> Answer:
    p = points()[0]
    x, whole = _moved(p)[0], MP.floor(_complex(p).real)
    return Answer(vanishes(whole - x), f"x = {shown(x)}, whole part of Z {shown(whole)}")


def fitted_constants(p: Point) -> Vector:
    """Solve C1 + C2 = Z0 and -ω1 C1 + ω2 C2 = Z0'/j for c1, c1', c2, c2'."""
    fast, slow = _rates(p)
    place, speed = MP.mpc(p.x, p.y), MP.mpc(p.vx, p.vy) / j
    first, second = MP.lu_solve(MP.matrix([[1, 1], [-fast, slow]]), MP.matrix([place, speed]))
    return vector(first.real, first.imag, second.real, second.imag)


def _roots(p: Point) -> Vector:
    """Return -Ω_z ± ω."""
    fast, slow = _rates(p)
    return vector(slow, -fast)


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    return section("gastebois_", "Gastebois",
        Identity("5_newton", "5", "a = m g_a + T + 2 m v × Ω",
            acceleration_of, forces, "m a = m g_a + T + 2 m v × Ω",
            lambda p: p.mass * acceleration_of(p)),
        Identity("5_energy", "5", "v²/L0 = 2 g_a (cosθ - cosθm): conservation of energy",
            lambda p: dot(p.velocity, acceleration_of(p)), lambda p: -p.gravity * p.vz,
            remark="as rates: v · a = -g_a z'"),
        Approximate("5_flat", "5", "z = -l, z' = 0", _flat, 2, "amplitude", remark="z and z' at a random point"),
        Approximate("5_square", "5", "2 g_a (cosθ - cosθm) = g_a (θm² - θ²)",
            _swung, 2, "θm", remark="θm = 0.3, θ = 0.15"),
        Approximate("5_tension", "5", "T = m g_a",
            over(points()[0].but(rate=MP.zero).swinging, lambda p: p.gravity, pull), 2, "amplitude",
            remark="at a random point"),
        Identity("5_long", "5", "x'' = -T/m x/L0 + 2y'Ω sinλ_a - 2z'Ω cosλ_a, y'' = -T/m y/L0 - 2x'Ω sinλ_a",
            _with_tension, uniform_acceleration, remark="truth: reference.model.force with gravity alone"),
        Identity("5_small", "5", "x'' = -ω0² x + 2y'Ω sinλ_a, y'' = -ω0² y - 2x'Ω sinλ_a",
            coupled_at, linearised, remark="truth: reference.model.force with gravity alone, linear"),
        Statement("6_1_part", "6.1", "x is the 'partie entière' (whole part) of Z",
            _whole_part, "partie réelle: x is the real part",
            lambda: all(vanishes(_complex(p).real - _moved(p)[0]) for p in points())),
        Identity("6_1_z", "6.1", "Z'' = -ω0² Z - 2 j Z' Ω sinλ_a",
            coupled_complex, lambda p: MP.mpc(*linearised(p))),
        Identity("6_1_alpha", "6.1", "-α² = -ω0² + 2αΩ sinλ_a for Z = c exp(jαt)",
            lambda p: tuple(-(a**2) for a in _roots(p)),
            lambda p: tuple(-p.gravity / p.length + 2 * a * rate_up(p) for a in _roots(p)),
            remark="at α = -Ω sinλ_a ± sqrt(ω0² + Ω² sin²λ_a)"),
        Identity("6_1_roots", "6.1", "α = -Ω sinλ_a ± ω",
            lambda p: MP.mpc(*sorted(_roots(p))), lambda p: MP.mpc(*turning_rates(p)),
            remark="truth: eigenvalues of the linear system"),
        Identity("6_1_omegas", "6.1", "ω1 = ω + Ω_z, ω2 = ω - Ω_z",
            _rates, lambda p: (-turning_rates(p)[0], turning_rates(p)[1]),
            remark="truth: eigenvalues of the linear system"),
        Identity("6_1_solution", "6.1", "Z = C1 exp(-jω1 t) + C2 exp(jω2 t)",
            _complex, lambda p: MP.mpc(*_moved(p)[:2]),
            remark="truth: exponential of the linear system's matrix"),
        Identity("6_1_xy", "6.1", "x = c1 cos(ω+Ω_z)t + …, y = c1' cos(ω+Ω_z)t - …",
            _printed_xy, lambda p: _moved(p)[:2]),
        Identity("6_1_vx", "6.1", "v_x = … - c2' (ω-Ω_z) sin(ω-Ω_z)t",
            lambda p: _velocity(p, 3)[0], lambda p: _moved(p)[2],
            "the last term has cos: - c2' (ω-Ω_z) cos(ω-Ω_z)t", lambda p: _velocity(p, 2)[0]),
        Identity("6_1_vy", "6.1", "v_y = -c1' (ω+Ω_z) sin(ω+Ω_z)t - … + c2 (ω-Ω_z) cos(ω-Ω_z)t",
            lambda p: _velocity(p, 3)[1], lambda p: _moved(p)[3]),
        *(Identity(f"6_1_{name}", "6.1", text, component(_constants, i), component(fitted_constants, i),
            remark="truth: solved from x, y, vx, vy at t = 0") for i, (name, text) in enumerate(CONSTANTS)),
    )  # fmt: skip
