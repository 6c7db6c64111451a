"""Mathar, section VII: statements about the Paris pendulum's motion and about figures 5 to 7, tested on runs."""

from __future__ import annotations

from typing import Any

import numpy as np

from reference import load_scene

from ...approximations import APPROXIMATIONS, Motion
from ..checks import Check, Finding, PrintedNumber, Statement
from ..digits import MP, Vector, add, degrees, mpf, norm, shown
from ..first_principles import rest
from ..points import paris
from ..runs import frequency, lead, paris_day, paris_path, paris_swing_plane, path_in, solved, window
from .frequency import STILL, VII, day_frequency, planar_period, released


def _transit(column: str) -> list[Any]:
    return [mpf(text) for text in paris_day().transits.decimals(column)]


def _frame_5() -> Any:
    """Return the range of z over the day, which Fig. 5 shows, in m."""
    z = paris_path()[1][:, 2]
    return mpf(float(z.max() - z.min()))


def _higher_after_half_a_swing() -> Finding:
    rise = _transit("z")[0] - released()[2]
    return Finding(bool(MP.mpf("1e-3") < rise < MP.mpf("1e-2")), f"{shown(1000 * rise)} mm higher")


def _work_of_the_centrifugal_force() -> Finding:
    """Compare g Δz + Δv²/2 with Ω² Δ(x² + q²)/2 over the first half swing."""
    p = paris()
    x, y, z, vy = (_transit(name)[0] for name in ("x", "y", "z", "vy"))
    vz = -y * vy / z

    def square(place: Vector) -> Any:
        q = p.R - MP.sin(p.phi) * place[1] + MP.cos(p.phi) * place[2]
        return place[0] ** 2 + q**2

    gained = p.gravity * (z - p.z) + (vy**2 + vz**2) / 2
    work = p.rate**2 * (square((x, y, z)) - square(released())) / 2
    return Finding(abs(gained - work) < MP.mpf("1e-25"), f"gained {shown(gained)} J/kg, work done {shown(work)} J/kg")


def _middle_of_the_first_swing() -> Finding:
    middle = tuple((_transit(name)[0] + start) / 2 for name, start in zip("xy", released(), strict=False))
    x, y, _ = rest(paris())
    gap = norm(add(middle, (-x, -y)))
    return Finding(gap < MP.mpf("1e-3"), f"middle {shown(middle)} m, rest position y = {shown(y)} m")


def _never_vertical() -> Finding:
    """Find how near the path, straight between samples 0.25 s apart, comes to the vertical below the pivot.

    The rest position lies south of it, so that the swing passes nearest while its plane lies north and south. Ten
    minutes before and after, the plane has turned by 1.9° and misses the vertical by 4 mm.
    """
    passage = paris_path()[0][np.abs(np.cos(paris_swing_plane())).argmin()]
    states = window(passage - 600, 1200, step=0.25)[1]
    near = states[np.hypot(states[:, 0], states[:, 1]) < 0.06]
    miss = np.abs(near[:, 0] * near[:, 4] - near[:, 1] * near[:, 3]) / np.hypot(near[:, 3], near[:, 4])
    return Finding(bool(miss.min() > 1e-6), f"nearest approach in 24 h {miss.min():.15e} m")


def _clouds_move() -> Finding:
    z = [float(value) for value in _transit("z")]
    at_release, opposite = z[1:2000:2], z[0:2000:2]
    rising = at_release[-1] > at_release[0] and opposite[-1] < opposite[0]
    change = f"near the release {z[1]:.15f} to {z[1999]:.15f} m, opposite {z[0]:.15f} to {z[1998]:.15f} m in 4.6 h"
    return Finding(rising, change)


def mean_rotation() -> tuple[float, float]:
    """Return the swing plane's degrees an hour, by a line fitted to the day, and the largest distance from the line."""
    hours, turned = paris_path()[0] / 3600, np.degrees(paris_swing_plane())
    slope, start = np.polyfit(hours, turned, 1)
    return float(slope), float(np.abs(turned - slope * hours - start).max())


def _linear() -> Finding:
    slope, off = mean_rotation()
    return Finding(off < 0.01, f"{slope:.15f}° an hour, within {off:.2e}° of a straight line for 24 h")


def _north_east_to_east() -> Finding:
    _, y, _ = rest(paris())
    start = degrees(MP.atan2(mpf("0.4") - y, mpf("0.3")))
    slope, _ = mean_rotation()
    hours = -start / slope
    return Finding(bool(0 < start < 90 and slope < 0), f"from {shown(start)}° to 0° (east-west) in {shown(hours, 6)} h")


def _coupling_is_ahead() -> Finding:
    scene, at = load_scene("paris"), np.array([0.0, 12000.0])
    simpler = APPROXIMATIONS["mathar_item_2"]
    assert isinstance(simpler, Motion)
    ahead = lead(simpler.trajectory(scene, at)[-1], path_in(scene, at)[-1])
    return Finding(0 < ahead < 1, f"{ahead:.9f} s ahead at 12000 s (double run)")


def _release() -> list[Check]:
    return [
        PrintedNumber("mathar_vii_l", VII, "l = 67 m", "67", lambda: mpf(load_scene("paris").exact.length)),
        PrintedNumber(
            "mathar_vii_lat", VII, "ϕ = 48.846111°", "48.846111", lambda: mpf(load_scene("paris").exact.latitude)
        ),
        PrintedNumber(
            "mathar_vii_above",
            VII,
            "roughly 2 mm above the lowest point",
            "0.002",
            lambda: paris().length + released()[2],
            remark="m",
        ),
        Statement(
            "mathar_vii_higher",
            VII,
            "the first swing ends a few millimetres higher than the release",
            _higher_after_half_a_swing,
            by_run=True,
        ),
        Statement(
            "mathar_vii_energy",
            VII,
            "the centrifugal force injects the energy",
            _work_of_the_centrifugal_force,
            by_run=True,
            remark="g Δz + Δv²/2 = Ω² Δ(x² + q²)/2 over the first half swing",
        ),
        Statement(
            "mathar_vii_middle",
            VII,
            "the centre of the motion is the point of rest, further south",
            _middle_of_the_first_swing,
            by_run=True,
        ),
        Statement(
            "mathar_vii_vertical",
            VII,
            "never moves through the vertical x = y = 0 if started at rest",
            _never_vertical,
            by_run=True,
        ),
    ]


def _figures() -> list[Check]:
    return [
        PrintedNumber(
            "mathar_fig5_start",
            f"{VII}, Fig. 5",
            "point of release near -66.98",
            "-66.98",
            lambda: released()[2],
            about=_frame_5,
            decimals=3,
            remark="m; judged against the height of the figure, 4 mm",
        ),
        PrintedNumber(
            "mathar_fig5_opposite",
            f"{VII}, Fig. 5",
            "opposite points near -66.9965",
            "-66.9965",
            lambda: _transit("z")[0],
            about=_frame_5,
            remark="m",
        ),
        Statement(
            "mathar_fig5_clouds",
            f"{VII}, Fig. 5",
            "one cloud goes up in time, the other down",
            _clouds_move,
            by_run=True,
        ),
        Statement("mathar_fig5_plane", f"{VII}, Fig. 5", "from NE-SW to more E-W", _north_east_to_east, by_run=True),
        Statement(
            "mathar_fig6", f"{VII}, Fig. 6", "the rotation of the mean azimuth is very linear", _linear, by_run=True
        ),
        Statement(
            "mathar_fig7_ahead",
            f"{VII}, Fig. 7",
            "without the outer-diagonal terms: a little bit ahead in time",
            _coupling_is_ahead,
            by_run=True,
        ),
        PrintedNumber("mathar_fig7_foucault", f"{VII}, Fig. 7", "≈ 0.06084 Hz", "0.06084", day_frequency),
        PrintedNumber(
            "mathar_fig7_planar", f"{VII}, Fig. 7", "≈ 0.06089 Hz", "0.06089", lambda: frequency(solved(STILL, "600"))
        ),
        PrintedNumber(
            "mathar_fig7_half",
            f"{VII}, Fig. 7",
            "after 12 thousand seconds detuned by approximately half a cycle",
            "0.5",
            lambda: 12000 * (1 / planar_period() - day_frequency()),
            about=lambda: MP.one,
        ),
    ]


def checks() -> list[Check]:
    """Return the rows about the release and the figures."""
    return [*_release(), *_figures()]
