"""Gastebois, sections 5 and 6.1: the equations for small angles and their general solution."""

from __future__ import annotations

from typing import Any

from reference.model.force import tension

from ...approximations.gastebois import constants_of
from ..checks import Approximate, Check, Finding, Identity, Statement, component, section
from ..digits import MP, Vector, add, cos, dot, j, mpf, scale, shown, sin
from ..first_principles import (
    acceleration_of,
    coupled_at,
    linearised,
    motion,
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
    low = p.but(x=p.x * s, y=p.y * s, vx=p.vx * s, vy=p.vy * s)
    return (-p.length, MP.zero), (low.z, low.vz)


def _swung(s: Any) -> tuple[Any, Any]:
    """Return g_a (θm² - θ²) and v²/L0 at θ = θm/2, for a pendulum let go at θm = 0.3 s."""
    p = points()[0]
    top, angle = MP.mpf("0.3") * s, MP.mpf("0.15") * s
    return p.gravity * (top**2 - angle**2), 2 * p.gravity * (cos(angle) - cos(top))


def _tension(s: Any) -> tuple[Any, Any]:
    """Return g_a and the tension of the cord per mass, without rotation, at s times the point's amplitude."""
    p = points()[0].but(rate=MP.zero)
    x, y = p.x * s, p.y * s
    state = p.but(x=x, y=y, vx=p.vx * s, vy=p.vy * s)
    n, v = (scale(1 / p.length, vector) for vector in (state.position, state.velocity))
    return p.gravity, p.length * tension(n, v, state.uniform)


def _with_tension(p: Point) -> Vector:
    """Return -T/m x/L0 + 2y'Ω sinλ_a - 2z'Ω cosλ_a, and the line for y''."""
    n, v = (scale(1 / p.length, vector) for vector in (p.position, p.velocity))
    pull = p.length * tension(n, v, p.uniform)
    up, north = rate_up(p), p.rate * cos(p.phi)
    return (
        -pull * p.x / p.length + 2 * p.vy * up - 2 * p.vz * north,
        -pull * p.y / p.length - 2 * p.vx * up,
    )


def forces(p: Point) -> tuple[Vector, Vector]:
    """Return the acceleration of the reference's model, and m g_a + T + 2 m v × Ω."""
    n, v = (scale(1 / p.length, vector) for vector in (p.position, p.velocity))
    pull = p.length * tension(n, v, p.uniform)
    weight = (MP.zero, MP.zero, -p.mass * p.gravity)
    north, up = p.rate * cos(p.phi), rate_up(p)
    bent = (p.vy * up - p.vz * north, -p.vx * up, p.vx * north)
    return acceleration_of(p), add(weight, scale(-p.mass * pull, n), scale(2 * p.mass, bent))


def _energy(p: Point) -> tuple[Any, Any]:
    """Return the change of v²/2 per time, and the power of gravity per mass: the Coriolis force does no work."""
    accelerated = dot(p.velocity, acceleration_of(p))
    return accelerated, -p.gravity * p.vz


def _constants(p: Point) -> Vector:
    """Return c1, c1', c2, c2' of 6.1 for the point's x, y, vx, vy."""
    return constants_of((p.x, p.y), (p.vx, p.vy), swing_rate(p), rate_up(p))


def _phases(p: Point, t: Any) -> Vector:
    fast, slow = (swing_rate(p) + rate_up(p)) * t, (swing_rate(p) - rate_up(p)) * t
    return cos(fast), sin(fast), cos(slow), sin(slow)


def printed_xy(p: Point, t: Any) -> Vector:
    """Return x and y of 6.1."""
    a, b, c, d = _constants(p)
    cf, sf, cs, ss = _phases(p, t)
    return a * cf + b * sf + c * cs - d * ss, b * cf - a * sf + d * cs + c * ss


def _velocity(p: Point, t: Any, last: int) -> Vector:
    """Return v_x and v_y of 6.1, the last term of v_x with sin (3) or with cos (2) of the slow phase."""
    a, b, c, d = _constants(p)
    fast, slow = swing_rate(p) + rate_up(p), swing_rate(p) - rate_up(p)
    phases = _phases(p, t)
    cf, sf, cs, ss = phases
    vx = -a * fast * sf + b * fast * cf - c * slow * ss - d * slow * phases[last]
    return vx, -b * fast * sf - a * fast * cf - d * slow * ss + c * slow * cs


def _complex(p: Point, t: Any) -> Any:
    a, b, c, d = _constants(p)
    w, up = swing_rate(p), rate_up(p)
    return (a + j * b) * MP.expj(-(w + up) * t) + (c + j * d) * MP.expj((w - up) * t)


def _as_released(p: Point) -> Vector:
    return (p.x, p.y, p.vx, p.vy)


def _whole_part() -> Finding:
    p = points()[0]
    z = _complex(p, p.t)
    x = motion(p, _as_released(p), p.t)[0]
    return Finding(
        abs(MP.floor(z.real) - x) < mpf("1e-40"), f"x = {shown(x)}, whole part of Z {shown(MP.floor(z.real))}"
    )


def _real_part() -> bool:
    return all(abs(_complex(p, p.t).real - motion(p, _as_released(p), p.t)[0]) < mpf("1e-40") for p in points())


def fitted_constants(p: Point) -> Vector:
    """Solve C1 + C2 = Z0 and -ω1 C1 + ω2 C2 = Z0'/j for c1, c1', c2, c2'."""
    fast, slow = swing_rate(p) + rate_up(p), swing_rate(p) - rate_up(p)
    place, speed = MP.mpc(p.x, p.y), MP.mpc(p.vx, p.vy) / j
    first, second = MP.lu_solve(MP.matrix([[1, 1], [-fast, slow]]), MP.matrix([place, speed]))
    return first.real, first.imag, second.real, second.imag


def _rates(p: Point) -> Any:
    return (-rate_up(p) + swing_rate(p), -rate_up(p) - swing_rate(p))


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    return section("gastebois_", "Gastebois",
        Identity("5_newton", "5", "a = m g_a + T + 2 m v × Ω",
            lambda p: forces(p)[0], lambda p: forces(p)[1], "m a = m g_a + T + 2 m v × Ω",
            lambda p: scale(p.mass, forces(p)[0])),
        Identity("5_energy", "5", "v²/L0 = 2 g_a (cosθ - cosθm): conservation of energy",
            lambda p: _energy(p)[0], lambda p: _energy(p)[1], remark="as rates: v · a = -g_a z'"),
        Approximate("5_flat", "5", "z = -l, z' = 0", _flat, 2, "amplitude", remark="z and z' at a random point"),
        Approximate("5_square", "5", "2 g_a (cosθ - cosθm) = g_a (θm² - θ²)",
            _swung, 2, "θm", remark="θm = 0.3, θ = 0.15"),
        Approximate("5_tension", "5", "T = m g_a", _tension, 2, "amplitude", remark="at a random point"),
        Identity("5_long", "5", "x'' = -T/m x/L0 + 2y'Ω sinλ_a - 2z'Ω cosλ_a, y'' = -T/m y/L0 - 2x'Ω sinλ_a",
            _with_tension, uniform_acceleration, remark="truth: reference.model.force with gravity alone"),
        Identity("5_small", "5", "x'' = -ω0² x + 2y'Ω sinλ_a, y'' = -ω0² y - 2x'Ω sinλ_a",
            coupled_at, linearised, remark="truth: reference.model.force with gravity alone, linear"),
        Statement("6_1_part", "6.1", "x is the 'partie entière' (whole part) of Z",
            _whole_part, "partie réelle: x is the real part", _real_part),
        Identity("6_1_z", "6.1", "Z'' = -ω0² Z - 2 j Z' Ω sinλ_a",
            lambda p: -p.gravity / p.length * MP.mpc(p.x, p.y) - 2 * j * MP.mpc(p.vx, p.vy) * rate_up(p),
            lambda p: MP.mpc(*linearised(p))),
        Identity("6_1_alpha", "6.1", "-α² = -ω0² + 2αΩ sinλ_a for Z = c exp(jαt)",
            lambda p: tuple(-(a**2) for a in _rates(p)),
            lambda p: tuple(-p.gravity / p.length + 2 * a * rate_up(p) for a in _rates(p)),
            remark="at α = -Ω sinλ_a ± sqrt(ω0² + Ω² sin²λ_a)"),
        Identity("6_1_roots", "6.1", "α = -Ω sinλ_a ± ω",
            lambda p: MP.mpc(*sorted(_rates(p))), lambda p: MP.mpc(*turning_rates(p)),
            remark="truth: eigenvalues of the linear system"),
        Identity("6_1_omegas", "6.1", "ω1 = ω + Ω_z, ω2 = ω - Ω_z",
            lambda p: (swing_rate(p) + rate_up(p), swing_rate(p) - rate_up(p)),
            lambda p: (-turning_rates(p)[0], turning_rates(p)[1]), remark="truth: eigenvalues of the linear system"),
        Identity("6_1_solution", "6.1", "Z = C1 exp(-jω1 t) + C2 exp(jω2 t)",
            lambda p: _complex(p, p.t), lambda p: MP.mpc(*motion(p, _as_released(p), p.t)[:2]),
            remark="truth: exponential of the linear system's matrix"),
        Identity("6_1_xy", "6.1", "x = c1 cos(ω+Ω_z)t + …, y = c1' cos(ω+Ω_z)t - …",
            lambda p: printed_xy(p, p.t), lambda p: motion(p, _as_released(p), p.t)[:2]),
        Identity("6_1_vx", "6.1", "v_x = … - c2' (ω-Ω_z) sin(ω-Ω_z)t",
            lambda p: _velocity(p, p.t, 3)[0], lambda p: motion(p, _as_released(p), p.t)[2],
            "the last term has cos: - c2' (ω-Ω_z) cos(ω-Ω_z)t", lambda p: _velocity(p, p.t, 2)[0]),
        Identity("6_1_vy", "6.1", "v_y = -c1' (ω+Ω_z) sin(ω+Ω_z)t - … + c2 (ω-Ω_z) cos(ω-Ω_z)t",
            lambda p: _velocity(p, p.t, 3)[1], lambda p: motion(p, _as_released(p), p.t)[3]),
        *(Identity(f"6_1_{name}", "6.1", text, component(_constants, i), component(fitted_constants, i),
            remark="truth: solved from x, y, vx, vy at t = 0") for i, (name, text) in enumerate(CONSTANTS)),
    )  # fmt: skip
