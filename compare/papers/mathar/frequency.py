"""Mathar, section VII: the frequencies of the Paris pendulum, from closed forms and from its golden dataset."""

from __future__ import annotations

from typing import Any

from ...approximations.gastebois_small import turntable_frequency
from ...approximations.mathar_linear import slow_down
from ..checks import Check, Finding, PrintedNumber, Statement
from ..digits import MP, Vector, acos, asin, dot, mpf, pi, shown, sin, sqrt
from ..first_principles import rest
from ..points import Point, paris
from ..runs import solved, transit_times

VII = "Mathar VII"
STILL = ["site.rotation_rate=0"]


def released() -> Vector:
    """Return the place of release in m."""
    p = paris()
    return (p.x, p.y, p.z)


def planar_amplitude() -> Any:
    """Return φ(0) of a swing of sqrt(0.3² + 0.4²) m, in rad."""
    return asin(sqrt(mpf("0.3") ** 2 + mpf("0.4") ** 2) / paris().length)


def planar_period() -> Any:
    """Return 4 sqrt(l/g) K(sin(φ0/2)) in s."""
    p = paris().but(rate=MP.zero)  # so that the rest position is straight down
    return 2 * pi * sqrt(p.length / p.gravity) * slow_down(p.case)


def harmonic_frequency(p: Point, gravity: Any) -> Any:
    """Return the frequency of (51)-(52): sqrt(g/l + (Ω sinϕ)²) / 2π, in Hz."""
    return turntable_frequency(p.case, gravity, p.rate * sin(p.phi)) / (2 * pi)


def amplitude() -> Any:
    """Return the angle between the release and the rest position, seen from the suspension, in rad."""
    return acos(dot(released(), rest(paris())) / paris().length ** 2)


def estimate(p: Point) -> Any:
    """Return the frequency of (51)-(52) with g' of (48), slowed down, in Hz."""
    return harmonic_frequency(p, p.case.apparent_gravity) / slow_down(p.case)


def first_period_frequency() -> Any:
    """Return the frequency from the release to the second transit, in Hz."""
    return 1 / transit_times()[1]


def day_frequency() -> Any:
    """Return the frequency over the day in Hz, from swings, not transits: the day has one transit too many."""
    times = transit_times()
    return (len(times) - swings_surplus()) / (2 * times[-1])


def swings_surplus() -> int:
    """Return the number of transits of the day beyond two a swing."""
    times = transit_times()
    return len(times) - round(float(times[-1] / (times[1] / 2)))


def transit_frequency() -> Any:
    """Return N/(2 t_n) at the end of the day, as the paper's program prints it, in Hz."""
    times = transit_times()
    return len(times) / (2 * times[-1])


def _planar_run() -> Finding:
    run = solved(STILL, "20", 30)
    assert run.transits is not None
    period = mpf(run.transits.exact("t")[1])
    return Finding(abs(period - planar_period()) < MP.mpf("1e-27"), f"run without rotation: {shown(period, 25)} s")


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    p = paris()
    return [
        PrintedNumber(
            "mathar_vii_harmonic",
            f"{VII}, item 1",
            "sqrt(g/l)/2π = 0.0608895 Hz",
            "0.0608895",
            lambda: sqrt(p.gravity / p.length) / (2 * pi),
        ),
        PrintedNumber("mathar_vii_phi0", f"{VII}, item 2", "φ(0) ≈ 0.00746276 rad", "0.00746276", planar_amplitude),
        PrintedNumber(
            "mathar_vii_period", f"{VII}, item 2", "4 sqrt(l/g) K(sin(φ0/2)) ≈ 16.423225 s", "16.423225", planar_period
        ),
        Statement("mathar_vii_formula", f"{VII}, item 2", "period = 4 sqrt(l/g) K(sin(φ0/2))", _planar_run),
        PrintedNumber(
            "mathar_vii_planar", f"{VII}, item 2", "0.06088938 Hz", "0.06088938", lambda: 1 / planar_period()
        ),
        PrintedNumber(
            "mathar_vii_51",
            f"{VII}, item 3",
            "sqrt(ĝ + (Ω sinϕ)²) ≈ 0.06088959 Hz",
            "0.06088959",
            lambda: harmonic_frequency(p, p.gravity),
        ),
        PrintedNumber(
            "mathar_vii_g", f"{VII}, item 4", "g' = 9.79195 m/s²", "9.79195", lambda: p.case.apparent_gravity
        ),
        PrintedNumber(
            "mathar_vii_g_hz",
            f"{VII}, item 4",
            "≈ 0.060843935 Hz",
            "0.060843935",
            lambda: harmonic_frequency(p, p.case.apparent_gravity),
        ),
        Statement(
            "mathar_vii_slow",
            f"{VII}, item 5",
            "a slow-down with the factor 4K(sin(φ0/2))",
            lambda: _slowed(2 * pi),
            "the factor is 4K/2π = 2K/π",
            lambda: _slowed(MP.one).holds,
        ),
        PrintedNumber("mathar_vii_z", f"{VII}, item 5", "release at z = -66.9981 m", "-66.9981", lambda: released()[2]),
        PrintedNumber(
            "mathar_vii_rest_y",
            f"{VII}, item 5",
            "equilibrium y = -0.115202 m",
            "-0.115202",
            lambda: rest(p)[1],
            remark="the rest position of (46) with the paper's own inputs",
        ),
        PrintedNumber(
            "mathar_vii_rest_z", f"{VII}, item 5", "equilibrium z = -66.999 m", "-66.999", lambda: rest(p)[2]
        ),
        PrintedNumber("mathar_vii_amplitude", f"{VII}, item 5", "φ(0) = 0.008898355 rad", "0.008898355", amplitude),
        PrintedNumber("mathar_vii_estimate", f"{VII}, item 5", "0.060843634 Hz", "0.060843634", lambda: estimate(p)),
        PrintedNumber(
            "mathar_vii_frequency",
            f"{VII}, item 6",
            "the actual Foucault pendulum: 0.060843633 Hz",
            "0.060843633",
            first_period_frequency,
            remark=f"first period; swings of the day {shown(day_frequency(), 12)} Hz, which is the paper's digits "
            f"cut off; n/(2 t_n) over the day {shown(transit_frequency(), 12)} Hz",
        ),
    ]


def _slowed(by: Any) -> Finding:
    """Compare the factor, `by` times 2K/π, with the two frequencies between which the paper puts it."""
    hertz = estimate(paris()) / by
    factor = by * slow_down(paris().case)
    return Finding(
        abs(hertz - mpf("0.060843634")) < mpf("5e-10"), f"0.060843935 Hz / {shown(factor)} = {shown(hertz)} Hz"
    )
