"""Gastebois, section 6.1: the general solution for small angles."""

from __future__ import annotations

from typing import Any

from ..checks import Check, Finding, Identity, Statement, component
from ..digits import MP, Vector, cos, j, mpf, shown, sin
from ..linear import matrix, motion, rate_up, swing_rate
from ..mathar.slow import linearised
from ..points import Point, points
from .numbers import G


def constants_of(p: Point) -> Vector:
    """Return c1, c1', c2, c2' of 6.1 for the point's x, y, vx, vy."""
    w, up = swing_rate(p), rate_up(p)
    return (
        ((w - up) * p.x - p.vy) / (2 * w),
        ((w - up) * p.y + p.vx) / (2 * w),
        ((w + up) * p.x + p.vy) / (2 * w),
        ((w + up) * p.y - p.vx) / (2 * w),
    )


def _phases(p: Point, t: Any) -> Vector:
    fast, slow = (swing_rate(p) + rate_up(p)) * t, (swing_rate(p) - rate_up(p)) * t
    return cos(fast), sin(fast), cos(slow), sin(slow)


def printed_xy(p: Point, t: Any) -> Vector:
    """Return x and y of 6.1."""
    a, b, c, d = constants_of(p)
    cf, sf, cs, ss = _phases(p, t)
    return a * cf + b * sf + c * cs - d * ss, b * cf - a * sf + d * cs + c * ss


def _velocity(p: Point, t: Any, last: int) -> Vector:
    """Return v_x and v_y of 6.1, the last term of v_x with sin (3) or with cos (2) of the slow phase."""
    a, b, c, d = constants_of(p)
    fast, slow = swing_rate(p) + rate_up(p), swing_rate(p) - rate_up(p)
    phases = _phases(p, t)
    cf, sf, cs, ss = phases
    vx = -a * fast * sf + b * fast * cf - c * slow * ss - d * slow * phases[last]
    return vx, -b * fast * sf - a * fast * cf - d * slow * ss + c * slow * cs


def _complex(p: Point, t: Any) -> Any:
    a, b, c, d = constants_of(p)
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


def _eigenvalues(p: Point) -> list[Any]:
    """Return the imaginary rates of the matrix whose motion turns as exp(jαt): those with y = -j x."""
    values, vectors = MP.eig(matrix(p))
    return [value for i, value in enumerate(values) if abs(vectors[1, i] + j * vectors[0, i]) < mpf("1e-30")]


def fitted_constants(p: Point) -> Vector:
    """Solve C1 + C2 = Z0 and -ω1 C1 + ω2 C2 = Z0'/j for c1, c1', c2, c2'."""
    fast, slow = swing_rate(p) + rate_up(p), swing_rate(p) - rate_up(p)
    place, speed = MP.mpc(p.x, p.y), MP.mpc(p.vx, p.vy) / j
    first, second = MP.lu_solve(MP.matrix([[1, 1], [-fast, slow]]), MP.matrix([place, speed]))
    return first.real, first.imag, second.real, second.imag


def checks() -> list[Check]:
    """Return the rows of section 6.1."""

    def rates(p: Point) -> Any:
        return (-rate_up(p) + swing_rate(p), -rate_up(p) - swing_rate(p))

    return [
        Statement(
            "gastebois_6_1_part",
            f"{G} 6.1",
            "x is the 'partie entière' (whole part) of Z",
            _whole_part,
            "partie réelle: x is the real part",
            _real_part,
        ),
        Identity(
            "gastebois_6_1_z",
            f"{G} 6.1",
            "Z'' = -ω0² Z - 2 j Z' Ω sinλ_a",
            lambda p: -p.gravity / p.length * MP.mpc(p.x, p.y) - 2 * j * MP.mpc(p.vx, p.vy) * rate_up(p),
            lambda p: MP.mpc(*linearised(p)),
        ),
        Identity(
            "gastebois_6_1_alpha",
            f"{G} 6.1",
            "-α² = -ω0² + 2αΩ sinλ_a for Z = c exp(jαt)",
            lambda p: tuple(-(a**2) for a in rates(p)),
            lambda p: tuple(-p.gravity / p.length + 2 * a * rate_up(p) for a in rates(p)),
            remark="at α = -Ω sinλ_a ± sqrt(ω0² + Ω² sin²λ_a)",
        ),
        Identity(
            "gastebois_6_1_roots",
            f"{G} 6.1",
            "α = -Ω sinλ_a ± ω",
            lambda p: MP.mpc(*sorted(rates(p))),
            lambda p: MP.mpc(*sorted(part.imag for part in _eigenvalues(p))),
            remark="truth: eigenvalues of the linear system",
        ),
        Identity(
            "gastebois_6_1_solution",
            f"{G} 6.1",
            "Z = C1 exp(-jω1 t) + C2 exp(jω2 t)",
            lambda p: _complex(p, p.t),
            lambda p: MP.mpc(*motion(p, _as_released(p), p.t)[:2]),
            remark="truth: exponential of the linear system's matrix",
        ),
        Identity(
            "gastebois_6_1_xy",
            f"{G} 6.1",
            "x = c1 cos(ω+Ω_z)t + …, y = c1' cos(ω+Ω_z)t - …",
            lambda p: printed_xy(p, p.t),
            lambda p: motion(p, _as_released(p), p.t)[:2],
        ),
        Identity(
            "gastebois_6_1_vx",
            f"{G} 6.1",
            "v_x = … - c2' (ω-Ω_z) sin(ω-Ω_z)t",
            lambda p: _velocity(p, p.t, 3)[0],
            lambda p: motion(p, _as_released(p), p.t)[2],
            "the last term has cos: - c2' (ω-Ω_z) cos(ω-Ω_z)t",
            lambda p: _velocity(p, p.t, 2)[0],
        ),
        Identity(
            "gastebois_6_1_vy",
            f"{G} 6.1",
            "v_y = -c1' (ω+Ω_z) sin(ω+Ω_z)t - … + c2 (ω-Ω_z) cos(ω-Ω_z)t",
            lambda p: _velocity(p, p.t, 3)[1],
            lambda p: motion(p, _as_released(p), p.t)[3],
        ),
        *(
            Identity(
                f"gastebois_6_1_{name}",
                f"{G} 6.1",
                text,
                component(constants_of, i),
                component(fitted_constants, i),
                remark="truth: solved from x, y, vx, vy at t = 0",
            )
            for i, (name, text) in enumerate(
                (
                    ("c1", "c1 = ((ω-Ω_z) x0 - v_y0) / 2ω"),
                    ("c1p", "c1' = ((ω-Ω_z) y0 + v_x0) / 2ω"),
                    ("c2", "c2 = ((ω+Ω_z) x0 + v_y0) / 2ω"),
                    ("c2p", "c2' = ((ω+Ω_z) y0 - v_x0) / 2ω"),
                )
            )
        ),
    ]
