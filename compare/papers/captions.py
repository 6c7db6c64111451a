"""The captions that Mathar's paper prints under its figures, and a remark on each figure as drawn here."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Caption:
    """A figure of the paper: its number, its caption, and a remark on the figure drawn here."""

    number: int
    printed: str
    remark: str


CAPTIONS = (
    Caption(
        1,
        "Angular deviation φ of the rest position from the local geodetic vertical for pendulums at geodetic latitudes "
        "ϕ on Earth. These are three curves for l = 1, 10 and 100 m which are indistinguishable on this scale.",
        "Rest positions of the reference. The three curves differ by at most 1.6e-6°.",
    ),
    Caption(
        3,
        "Initial 20 seconds of the trajectory in x and y for the Paris pendulum released at x = 0.3 m and y = 0.4 m, "
        "another interval of 20 seconds after 7000 seconds have passed, and another 20 seconds when 12000 seconds have "
        "passed.",
        "The swing plane turns clockwise: the swing along y shrinks and that along x grows.",
    ),
    Caption(
        4,
        "Three trajectories each of 17 seconds of duration equivalent to snapshots of Figure 3 in a 3D view and in the "
        "projection on the x-y-plane, demonstrating the slow rotation of the main plane of the pendulum motion around "
        "the point equivalent to the rest position.",
        "The cross is the rest position, 11.5 cm south of the point below the pivot. The vertical axis is stretched.",
    ),
    Caption(
        5,
        "Snapshots of the z-coordinate of the Paris pendulum.",
        "One snapshot every 30 s for 24 h. The text's -66.98 m for the release is a misprint: it is -66.998 m.",
    ),
    Caption(
        6,
        "Snapshots of the λ-angle of the Paris pendulum.",
        "One snapshot every 30 s. λ is measured about the point below the suspension, while the swing passes through "
        "the rest position: so the dots crowd beside the line, which is the direction of the swing plane. That "
        "direction stays within 0.005° of a uniform rotation for a day.",
    ),
    Caption(
        7,
        "The difference in positions between the full theory and different approximations introduced in Section VI.",
        "Without rotation the pendulum is half a swing late; item 1 drops Ω², item 2 the off-diagonal elements.",
    ),
    Caption(
        8,
        "The frequency of the pendulum as a function of the geodetic latitude ϕ, measured by time differences between "
        "transits xdot = 0.",
        "Points: runs of the reference over 10 min, half swings counted. Line: harmonic in the apparent gravity g', "
        "with the slow-down 2K/π.",
    ),
    Caption(
        9,
        "Illustration of the effect of the 3 different Runge-Kutta-Nyström order parameters through the -R option of "
        "the program on the Paris pendulum positions at a step size of 0.5 seconds after 12000 seconds have passed.",
        "Above: positions. Below: distance from the reference.",
    ),
)
