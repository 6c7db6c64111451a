"""Every number in docs/physics.md is recomputed here."""

from __future__ import annotations

from typing import Any

import pytest
from places import ROOT

from compare.approximations.frequency import anharmonic
from compare.approximations.mathar import slow_down
from compare.papers.digits import MP, degrees, mpf, norm, pi, shown, sin, sqrt
from compare.papers.first_principles import rest
from compare.papers.mathar.paris import (
    day_frequency,
    first_period_frequency,
    planar_period,
    swings_surplus,
    transit_frequency,
)
from compare.papers.points import paris, transits

PAGE = " ".join((ROOT / "docs/physics.md").read_text(encoding="utf-8").split())
P = paris()
OUTWARD = P.R * P.rate**2
TURN = P.rate * sin(P.phi + P.case.rest_angle)  # of the swing plane, rad/s
REAL_TURN = P.rate * sin(P.phi)  # where the geodetic vertical is the plumb line


def fixed(value: Any, decimals: int) -> str:
    return f"{float(value):.{decimals}f}"


def half_axes() -> tuple[Any, Any]:
    _, y, _ = rest(P)
    long = norm((P.x, P.y - y))
    return long, long * TURN / (2 * pi * day_frequency())


def without_the_centrifugal_part() -> tuple[Any, Any]:
    """Latitude and gravity at which the bob hangs along Paris's geodetic vertical, pulled by 9.80665 m/s²."""

    def missed(latitude: Any, gravity: Any) -> tuple[Any, Any]:
        there = P.but(latitude=latitude, gravity=gravity)
        return latitude + degrees(
            there.case.rest_angle
        ) - P.latitude, there.case.pull_at_rest - P.gravity

    return tuple(
        MP.findroot(missed, (P.latitude - degrees(P.case.rest_angle), P.gravity), tol=1e-30)
    )


def estimate_with_square_rate() -> Any:
    """Stiffness east T/l - Ω², along the meridian T/l - w²; their mean, and w² for the turning axes."""
    square = P.case.pull_at_rest / P.length - (P.rate**2 + TURN**2) / 2 + TURN**2
    return sqrt(square) / (2 * pi) / slow_down(P.case)


def jump() -> Any:
    times = transits("t")
    extra = next(i for i in range(2, len(times)) if times[i] - times[i - 1] < 6)
    assert extra + 1 == 5786
    return (extra + 2) / (2 * times[extra + 1])


def gaps() -> list[Any]:
    times = transits("t")
    return [times[i + 1] - times[i] for i in range(len(times) - 1)]


def last_run_that_prints_633() -> Any:
    times = transits("t")
    return next(
        times[n - 1] for n in range(2, 400, 2) if n / (2 * times[n - 1]) > mpf("0.0608436335")
    )


def detuned() -> Any:
    return 1 / planar_period() - day_frequency()


NUMBERS = {
    "radius": lambda: f"*R* of {fixed(P.R / 1000, 0)} km",
    "outward": lambda: f"*R*Ω² of {fixed(OUTWARD, 5)} m/s²",
    "share": lambda: f"{fixed(100 * OUTWARD / P.gravity, 3)} % of gravity",
    "turn": lambda: f"clockwise by {fixed(degrees(REAL_TURN) * 3600, 3)}° an hour",
    "full turn": lambda: f"a full turn in {fixed(2 * pi / REAL_TURN / 3600, 1)} hours",
    "turn of the model": lambda: (
        f"In the paper's model it turns by {fixed(degrees(TURN) * 3600, 3)}°"
    ),
    "ellipse": lambda: (
        f"half-axes of {fixed(half_axes()[0], 3)} m and {fixed(1000 * half_axes()[1], 3)} mm"
    ),
    "tilt": lambda: (
        f"hangs {fixed(degrees(P.case.rest_angle), 4)}° south of straight down, which at 67 m is"
    ),
    "aside": lambda: f"{fixed(-100 * rest(P)[1], 1)} cm",
    "rise": lambda: f"ends {fixed(1000 * (transits('z')[0] - P.z), 2)} mm *higher*",
    "away": lambda: f"0.5 m from the one and {fixed(half_axes()[0], 3)} m from the other",
    "leans": lambda: f"leans {fixed(degrees(P.case.rest_angle), 4)}°",
    "apparent": lambda: f"apparent gravity is {fixed(P.case.pull_at_rest, 5)} m/s²",
    "slower": lambda: f"slower by {fixed(detuned(), 7)} Hz",
    "half": lambda: (
        f"after {int(1 / (2 * detuned()) / 3600)} h {fixed((1 / (2 * detuned()) % 3600) / 60, 0)} min"
    ),
    "latitude": lambda: f"site.latitude={fixed(without_the_centrifugal_part()[0], 4)}",
    "gravity": lambda: f"site.gravity={fixed(without_the_centrifugal_part()[1], 4)}",
    "passage": lambda: (
        f"falls {fixed((pi / 2 + MP.atan2(P.y - rest(P)[1], P.x)) / TURN / 3600, 1)} hours after the release"
    ),
    "spacing": lambda: f"each other {fixed(sorted(gaps())[5000], 2)} s apart",
    "gaps": lambda: (
        " s and then ".join(fixed(gap, 2) for gap in gaps() if gap < 6)
        + " s: number 5786 is the extra one"
    ),
    "jump": lambda: f"from {fixed(first_period_frequency(), 7)} Hz to {fixed(jump(), 7)} Hz",
    "end": lambda: f"still {fixed(transit_frequency(), 7)} Hz",
    "count": lambda: (
        f"{len(transits('t')) - swings_surplus()} of them for {len(transits('t'))} transits, gives "
        f"{fixed(day_frequency(), 11)} Hz"
    ),
    "estimate": lambda: f"amplitude | {fixed(anharmonic(P.case), 11)} Hz",
    "first": lambda: f"the first swing | {fixed(first_period_frequency(), 11)} Hz",
    "day": lambda: f"not rounded | {fixed(day_frequency(), 11)} Hz",
    "minutes": lambda: f"less than about {int(last_run_that_prints_633() / 60)} minutes",
    "higher": lambda: f"higher by {float(anharmonic(P.case) - estimate_with_square_rate()):.0e} Hz",
    "corrected": lambda: f"estimate is {fixed(estimate_with_square_rate(), 11)} Hz",
    "agree": lambda: f"agree to {float(abs(estimate_with_square_rate() - day_frequency())):.0e} Hz",
}


@pytest.mark.parametrize("name", NUMBERS)
def test_a_number_on_the_page_is_the_recomputed_one(name: str) -> None:
    assert NUMBERS[name]() in PAGE


def test_the_page_s_remedy_hangs_the_bob_along_the_geodetic_vertical() -> None:
    remedied = P.but(latitude=mpf("48.7477"), gravity=mpf("9.8214"))
    # the last digit given
    assert abs(remedied.latitude + degrees(remedied.case.rest_angle) - P.latitude) < mpf("5e-5")
    assert f"{fixed(degrees(remedied.case.rest_angle), 4)}° from the scene's own *z* axis" in PAGE
    assert f"apparent gravity is {fixed(remedied.case.pull_at_rest, 4)}" in PAGE


def test_a_gravimeter_shows_what_the_page_says() -> None:
    """Normal gravity of GRS 80 at the latitude of Paris; its heights and anomalies change it by less than 1e-3 m/s²."""
    square = sin(P.phi) ** 2
    normal = (
        mpf("9.7803267715")
        * (1 + mpf("0.001931851353") * square)
        / sqrt(1 - mpf("0.00669438002290") * square)
    )
    assert abs(normal - mpf("9.809")) < mpf("1e-3")
    assert "a gravimeter in Paris shows about 9.809" in PAGE


def test_between_transits_of_the_passage_the_plane_lies_north_south() -> None:
    times = transits("t")
    passage = (pi / 2 + MP.atan2(P.y - rest(P)[1], P.x)) / TURN
    assert times[5784] < passage < times[5786], shown(passage)
