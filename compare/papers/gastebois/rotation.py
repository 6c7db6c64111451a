"""Gastebois, sections 1, 2 and 4.1: the rotation of the swing plane."""

from __future__ import annotations

from reference import load_scene

from ..checks import Approximate, Check, Finding, Identity, PrintedNumber, Statement
from ..digits import MP, atan2, cross, dot, mpf, norm, pi, radians, shown, sin
from ..points import paris
from ..runs import rotation, solved
from .frames import turning
from .gravity import apparent, pantheon_on_sphere
from .numbers import MEAN_RADIUS, SIDEREAL_DAY, G
from .turning_swing import narrow_swing, wide_swing


def _slower_when_wide() -> Finding:
    """Run the reference at the pole with the Pantheon's amplitude: its transits are its points of rest."""
    run = solved(["site.latitude=90", "site.gravity=9.8", "release.x=6.5", "release.y=0"], "20", 30)
    assert run.transits is not None
    t, x, y = (mpf(run.transits.exact(name)[1]) for name in ("t", "x", "y"))
    ratio = -2 * pi * t / atan2(y, x) / (SIDEREAL_DAY * 3600)
    closed = wide_swing(MP.one)[1]
    return Finding(
        bool(ratio > 1 and abs(ratio - closed) < mpf("1e-20")), f"T_f/T_p = {shown(ratio)} at r0 = 6.5 m, pole"
    )


def _turn(latitude: str, t_end: float = 7200.0) -> float:
    scene = load_scene("paris", [f"site.latitude={latitude}"])
    return rotation(scene, t_end)


def _pole() -> Finding:
    turn = _turn("90")
    return Finding(abs(turn / -15.04106864 - 1) < 1e-4, f"{turn:.15f}° an hour, the Earth -15.041068640° in the sky")


def _equator() -> Finding:
    turn = _turn("0")
    return Finding(abs(turn) < 1e-3, f"{turn:.15f}° an hour")


def _south() -> Finding:
    turn = _turn("-48.846111")
    return Finding(turn > 0, f"{turn:+.15f}° an hour, east to north (anticlockwise from above)")


def _number_rows() -> list[Check]:
    return [
        PrintedNumber(
            "gastebois_1",
            f"{G} 1",
            "in one hour the pendulum had turned by 11,3°",
            "11.3",
            lambda: 360 / SIDEREAL_DAY * sin(radians("48.846111")),
        ),
        PrintedNumber(
            "gastebois_2_radius",
            f"{G} 2",
            "R_p = 6370 km",
            "6370e3",
            lambda: MEAN_RADIUS,
            about=lambda: MEAN_RADIUS,
            remark="m; mean radius of the ellipsoid",
        ),
        PrintedNumber(
            "gastebois_2_day", f"{G} 2", "T_p = 23,92 h", "23.92", lambda: SIDEREAL_DAY, remark="2π/Ω of WGS84"
        ),
        PrintedNumber(
            "gastebois_2_rate",
            f"{G} 2",
            "Ω = 2π/T_p = 7,297 · 10⁻⁵ rd/s",
            "7.297e-5",
            lambda: 2 * pi / (SIDEREAL_DAY * 3600),
            from_inputs=lambda: 2 * pi / (mpf("23.92") * 3600),
            inputs="T_p = 23,92 h",
        ),
        PrintedNumber(
            "gastebois_4_1_bound",
            f"{G} 4.1",
            "a_e < 0,034 m/s²",
            "0.034",
            lambda: paris().rate ** 2 * paris().radius,
            remark="at the equator",
        ),
        PrintedNumber(
            "gastebois_4_1_paris",
            f"{G} 4.1",
            "24 / sin 49° = 31 h 48 min",
            "1908",
            lambda: 24 * 60 / sin(radians(49)),
            remark="minutes",
        ),
        PrintedNumber(
            "gastebois_4_1_hour", f"{G} 4.1", "(11,3° in 1 hour)", "11.3", lambda: 360 * sin(radians(49)) / 24
        ),
    ]


def _plane_rows() -> list[Check]:
    return [
        Approximate(
            "gastebois_4_1_ga",
            f"{G} 4.1",
            "g_a = g",
            lambda s: (pantheon_on_sphere(s).gravity, norm(apparent(pantheon_on_sphere(s)))),
            1,
            "Ω²",
            "m/s²",
            "at 48.87°",
        ),
        Identity(
            "gastebois_4_1_omega",
            f"{G} 4.1",
            "Ω = Ω cosλ j + Ω sinλ k",
            turning,
            lambda p: p.k.turn,
            remark="truth: reference.model.constants",
        ),
        Identity(
            "gastebois_4_1_cross",
            f"{G} 4.1",
            "v_r × Ω = v_y Ω sinλ i for v_r = v_y j",
            lambda p: (p.vy * p.rate * sin(p.phi), MP.zero, MP.zero),
            lambda p: cross((MP.zero, p.vy, MP.zero), turning(p)),
        ),
        Identity(
            "gastebois_4_1_tf",
            f"{G} 4.1",
            "T_f = 2π/ω_f = T_p / sinλ",
            lambda p: 2 * pi / p.rate / sin(p.phi),
            lambda p: 2 * pi / dot(turning(p), (MP.zero, MP.zero, MP.one)),
        ),
        Approximate(
            "gastebois_4_1_small",
            f"{G} 4.1",
            "ω_f = Ω sinλ for small angles",
            narrow_swing,
            2,
            "r0/L0",
            remark="T_f/T_p at the pole, r0 = 6.5 m; truth: elliptic integrals",
        ),
        Statement("gastebois_4_1_pole", f"{G} 4.1", "at the poles T_f = T_p", _pole, by_run=True),
        Statement("gastebois_4_1_equator", f"{G} 4.1", "at the equator the plane does not turn", _equator, by_run=True),
        Statement(
            "gastebois_4_1_wide",
            f"{G} 4.1, remark",
            "T_f grows slightly with the amplitude",
            _slower_when_wide,
            by_run=True,
        ),
        Statement(
            "gastebois_4_1_south",
            f"{G} 4.1, remark",
            "in the south it turns anticlockwise seen from above",
            _south,
            by_run=True,
        ),
    ]


def checks() -> list[Check]:
    """Return the rows of sections 1, 2 and 4.1."""
    return [*_number_rows(), *_plane_rows()]
