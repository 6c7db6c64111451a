"""Mathar, section VII: the Paris pendulum's motion, its figures 5 to 7, and its frequencies."""

from __future__ import annotations

from typing import Any

import numpy as np

from reference import load_scene

from ...approximations import motions
from ...approximations.frequency import anharmonic, harmonic, planar, turntable
from ...approximations.mathar import slow_down
from ..checks import Answer, Check, PrintedNumber, Statement, section
from ..digits import MP, Vector, acos, asin, cos, degrees, dot, mpf, norm, pi, shown, sin, vector
from ..first_principles import rest
from ..points import (
    frequency,
    paris,
    paris_passage,
    paris_path,
    paris_swing_plane,
    path_in,
    rotation,
    solved,
    transits,
    window,
)

STILL = ("site.rotation_rate=0",)


def _frame_5() -> Any:
    """Return the range of z over the day, which Fig. 5 shows, in m."""
    z = paris_path()[1][:, 2]
    return mpf(float(z.max() - z.min()))


def _higher_after_half_a_swing() -> Answer:
    rise = transits("z")[0] - paris().z
    return Answer(bool(MP.mpf("1e-3") < rise < MP.mpf("1e-2")), f"{shown(1000 * rise)} mm higher")


def _work_of_the_centrifugal_force() -> Answer:
    """Compare g Δz + Δv²/2 with Ω² Δ(x² + q²)/2 over the first half swing."""
    p = paris()
    x, y, z, vy = (transits(name)[0] for name in ("x", "y", "z", "vy"))
    vz = -y * vy / z

    def square(place: Vector) -> Any:
        return place[0] ** 2 + (p.R - sin(p.phi) * place[1] + cos(p.phi) * place[2]) ** 2

    gained = p.gravity * (z - p.z) + (vy**2 + vz**2) / 2
    work = p.rate**2 * (square((x, y, z)) - square(paris().position)) / 2
    return Answer(
        abs(gained - work) < MP.mpf("1e-25"),
        f"gained {shown(gained)} J/kg, work done {shown(work)} J/kg",
    )


def _middle_of_the_first_swing() -> Answer:
    middle = (vector(*(transits(name)[0] for name in "xy")) + paris().position[:2]) / 2
    x, y, _ = rest(paris())
    gap = norm(middle - vector(x, y))
    return Answer(gap < MP.mpf("1e-3"), f"middle {shown(middle)} m, rest position y = {shown(y)} m")


def _never_vertical() -> Answer:
    """Find how near the path, straight between samples 0.25 s apart, comes to the vertical below the pivot."""
    miss = paris_passage()[1].min()
    return Answer(bool(miss > 1e-6), f"nearest approach in 24 h {miss:.15e} m")


def _about_the_rest_position() -> Answer:
    """Compare the mean place over a swing, early and late, with the rest position."""
    period, x_y = float(1 / day_frequency()), np.array([float(part) for part in rest(paris())[:2]])
    gaps = []
    for begin in (0.0, 7000.0, 12000.0):
        middle = window(begin, 63 / 64 * period, step=period / 64)[1][:, :2].mean(axis=0)
        gaps.append(np.hypot(*(middle - x_y)))
    return Answer(
        max(gaps) < 1e-3,
        f"the mean of a swing is {max(gaps):.4e} m from the rest position, or less",
    )


def _clouds_move() -> Answer:
    z = [float(value) for value in transits("z")]
    at_release, opposite = z[1:2000:2], z[0:2000:2]
    rising = at_release[-1] > at_release[0] and opposite[-1] < opposite[0]
    change = f"near the release {z[1]:.15f} to {z[1999]:.15f} m, opposite {z[0]:.15f} to {z[1998]:.15f} m in 4.6 h"
    return Answer(rising, change)


def _linear() -> Answer:
    slope, off = rotation(paris_path()[0], paris_swing_plane())
    return Answer(
        off < 0.01, f"{slope:.15f}° an hour, within {off:.2e}° of a straight line for 24 h"
    )


def _north_east_to_east() -> Answer:
    _, y, _ = rest(paris())
    start = degrees(MP.atan2(mpf("0.4") - y, mpf("0.3")))
    slope, _ = rotation(paris_path()[0], paris_swing_plane())
    hours = -start / slope
    return Answer(
        bool(0 < start < 90 and slope < 0),
        f"from {shown(start)}° to 0° (east-west) in {shown(hours, 6)} h",
    )


def _coupling_is_ahead() -> Answer:
    scene, at = load_scene("paris"), np.array([0.0, 12000.0])
    item_2, true = (
        motion(scene, at)[-1] for motion in (motions()["mathar_item_2"].trajectory, path_in)
    )
    gap, speed = (item_2 - true)[:2], true[3:5]
    ahead = float(gap @ speed / (speed @ speed))  # along the way
    return Answer(0 < ahead < 1, f"{ahead:.9f} s ahead at 12000 s (double run)")


def planar_period() -> Any:
    """Return 4 sqrt(l/g) K(sin(φ0/2)) in s."""
    return 1 / planar(paris().case)


def first_period_frequency() -> Any:
    """Return the frequency from the release to the second transit, in Hz."""
    return 1 / transits("t")[1]


def day_frequency() -> Any:
    """Return the frequency over the day in Hz, from swings, not transits: the day has one transit too many."""
    times = transits("t")
    return (len(times) - swings_surplus()) / (2 * times[-1])


def swings_surplus() -> int:
    """Return the number of transits of the day beyond two a swing."""
    times = transits("t")
    return len(times) - round(float(times[-1] / (times[1] / 2)))


def transit_frequency() -> Any:
    """Return N/(2 t_n) at the end of the day, as the paper's program prints it, in Hz."""
    times = transits("t")
    return len(times) / (2 * times[-1])


def _planar_run() -> Answer:
    run = solved(STILL, "20", 30)
    period = mpf(run.transits.exact("t")[1])
    return Answer(
        abs(period - planar_period()) < MP.mpf("1e-27"),
        f"run without rotation: {shown(period, 25)} s",
    )


def _slowed(by: Any) -> Answer:
    """Compare the factor, `by` times 2K/π, with the two frequencies between which the paper puts it."""
    hertz = anharmonic(paris().case) / by
    factor = by * slow_down(paris().case)
    holds = abs(hertz - mpf("0.060843634")) < mpf("5e-10")
    return Answer(holds, f"0.060843935 Hz / {shown(factor)} = {shown(hertz)} Hz")


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    p = paris()
    return section("mathar_", "Mathar VII",
        PrintedNumber("vii_l", "", "l = 67 m", "67", lambda: mpf(load_scene("paris").exact.length)),
        PrintedNumber("vii_lat", "", "ϕ = 48.846111°", "48.846111", lambda: mpf(load_scene("paris").exact.latitude)),
        PrintedNumber("vii_above", "", "roughly 2 mm above the lowest point",
            "0.002", lambda: p.length + p.z, remark="m"),
        Statement("vii_higher", "", "the first swing ends a few millimetres higher than the release",
            _higher_after_half_a_swing, by_run=True),
        Statement("vii_energy", "", "the centrifugal force injects the energy",
            _work_of_the_centrifugal_force, by_run=True,
            remark="g Δz + Δv²/2 = Ω² Δ(x² + q²)/2 over the first half swing"),
        Statement("vii_middle", "", "the centre of the motion is the point of rest, further south",
            _middle_of_the_first_swing, by_run=True),
        Statement("vii_vertical", "", "never moves through the vertical x = y = 0 if started at rest",
            _never_vertical, by_run=True),
        Statement("fig4", ", Fig. 4", "the plane of the motion turns around the rest position",
            _about_the_rest_position, by_run=True, remark="swings from 0, 7000 and 12000 s"),
        PrintedNumber("fig5_start", ", Fig. 5", "point of release near -66.98",
            "-66.98", lambda: p.z, about=_frame_5, decimals=3,
            remark="m; judged against the height of the figure, 4 mm"),
        PrintedNumber("fig5_opposite", ", Fig. 5", "opposite points near -66.9965",
            "-66.9965", lambda: transits("z")[0], about=_frame_5, remark="m"),
        Statement("fig5_clouds", ", Fig. 5", "one cloud goes up in time, the other down", _clouds_move, by_run=True),
        Statement("fig5_plane", ", Fig. 5", "from NE-SW to more E-W", _north_east_to_east, by_run=True),
        Statement("fig6", ", Fig. 6", "the rotation of the mean azimuth is very linear", _linear, by_run=True),
        Statement("fig7_ahead", ", Fig. 7", "without the outer-diagonal terms: a little bit ahead in time",
            _coupling_is_ahead, by_run=True),
        PrintedNumber("fig7_foucault", ", Fig. 7", "≈ 0.06084 Hz", "0.06084", day_frequency),
        PrintedNumber("fig7_planar", ", Fig. 7", "≈ 0.06089 Hz", "0.06089", lambda: frequency(solved(STILL, "600"))),
        PrintedNumber("fig7_half", ", Fig. 7", "after 12 thousand seconds detuned by approximately half a cycle",
            "0.5", lambda: 12000 * (1 / planar_period() - day_frequency()), about=lambda: MP.one),
        PrintedNumber("vii_harmonic", ", item 1", "sqrt(g/l)/2π = 0.0608895 Hz", "0.0608895", lambda: harmonic(p.case)),
        PrintedNumber("vii_phi0", ", item 2", "φ(0) ≈ 0.00746276 rad", "0.00746276",
            lambda: asin(norm(p.position[:2]) / p.length)),
        PrintedNumber("vii_period", ", item 2", "4 sqrt(l/g) K(sin(φ0/2)) ≈ 16.423225 s", "16.423225", planar_period),
        Statement("vii_formula", ", item 2", "period = 4 sqrt(l/g) K(sin(φ0/2))", _planar_run),
        PrintedNumber("vii_planar", ", item 2", "0.06088938 Hz", "0.06088938", lambda: 1 / planar_period()),
        PrintedNumber("vii_51", ", item 3", "sqrt(ĝ + (Ω sinϕ)²) ≈ 0.06088959 Hz",
            "0.06088959", lambda: turntable(p.case, p.gravity)),
        PrintedNumber("vii_g", ", item 4", "g' = 9.79195 m/s²", "9.79195", lambda: p.case.apparent_gravity),
        PrintedNumber("vii_g_hz", ", item 4", "≈ 0.060843935 Hz",
            "0.060843935", lambda: turntable(p.case, p.case.apparent_gravity)),
        Statement("vii_slow", ", item 5", "a slow-down with the factor 4K(sin(φ0/2))",
            lambda: _slowed(2 * pi), "the factor is 4K/2π = 2K/π", lambda: _slowed(MP.one).holds),
        PrintedNumber("vii_z", ", item 5", "release at z = -66.9981 m", "-66.9981", lambda: p.z),
        PrintedNumber("vii_rest_y", ", item 5", "equilibrium y = -0.115202 m",
            "-0.115202", lambda: rest(p)[1], remark="the rest position of (46) with the paper's own inputs"),
        PrintedNumber("vii_rest_z", ", item 5", "equilibrium z = -66.999 m", "-66.999", lambda: rest(p)[2]),
        PrintedNumber("vii_amplitude", ", item 5", "φ(0) = 0.008898355 rad", "0.008898355",
            lambda: acos(dot(p.position, rest(p)) / p.length**2)),
        PrintedNumber("vii_estimate", ", item 5", "0.060843634 Hz", "0.060843634", lambda: anharmonic(p.case)),
        PrintedNumber("vii_frequency", ", item 6", "the actual Foucault pendulum: 0.060843633 Hz",
            "0.060843633", first_period_frequency,
            remark=f"first period; swings of the day {shown(day_frequency(), 12)} Hz, which is the paper's digits "
                f"cut off; n/(2 t_n) over the day {shown(transit_frequency(), 12)} Hz"),
    )  # fmt: skip
