"""The inputs of a scene: their exact numbers, and how the text of a number is read."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

GravityIs = Literal["ellipsoid", "effective"]
# what each means, in the words of the schema, the template, `show`, its warning and the page's form
GRAVITY_MEANINGS: dict[GravityIs, str] = {
    "ellipsoid": "gravity alone, to which the centrifugal force is added",
    "effective": "as measured along the plumb line, with the centrifugal force included",
}

# of a grid step: times nearer than this differ only by the rounding of the inputs
_SAME_TIME = Fraction(1, 1 << 30)
# numbers of a site
SITE = ("latitude", "altitude", "gravity", "rotation_rate", "equatorial_radius")
RELEASES = {
    "position": ("x", "y", "vx", "vy"),
    "angles": ("angle", "azimuth", "angle_rate", "azimuth_rate"),
}
# inputs on which the motion depends, and which may be uncertain
UNCERTAIN = [
    "pendulum.length",
    "pendulum.drag",
    *(f"site.{name}" for name in (*SITE, "inverse_flattening")),
]
UNCERTAIN += [f"release.{name}" for names in RELEASES.values() for name in names]


@dataclass(frozen=True)
class Inputs:
    """The exact numbers of a scene: SI units, angles in degrees; `flattening` is 0 for a sphere.

    Exactly one of `position` (x, y, vx, vy) and `angles` (angle, azimuth, angle_rate, azimuth_rate)
    is set, the one that the scene contains. `gravity_is` tells the pull along the ellipsoid's
    normal, to which the centrifugal force comes, from the effective one along the plumb line, which
    contains that at the pivot.
    """

    length: Fraction
    drag: Fraction
    latitude: Fraction
    altitude: Fraction
    gravity: Fraction
    rotation_rate: Fraction
    equatorial_radius: Fraction
    flattening: Fraction
    position: tuple[Fraction, Fraction, Fraction, Fraction] | None
    angles: tuple[Fraction, Fraction, Fraction, Fraction] | None
    t_end: Fraction
    grid_step: Fraction
    gravity_is: GravityIs = "ellipsoid"

    @property
    def grid(self) -> list[Fraction]:
        """Output times in s: 0, grid_step, 2 grid_step, …, and t_end as the last.

        Read as binary64, the last step may miss t_end by rounding alone: then t_end takes its
        place.
        """
        whole = int(self.t_end / self.grid_step)
        times = [k * self.grid_step for k in range(whole + 1)]
        if whole and self.t_end - times[-1] < self.grid_step * _SAME_TIME:
            times.pop()
        return [*times, self.t_end]

    @property
    def by_name(self) -> dict[str, Fraction]:
        """The numbers on which the motion depends, by their names in a scene file, such as "site.gravity"."""
        values = {"pendulum.length": self.length, "pendulum.drag": self.drag}
        values |= {f"site.{name}": getattr(self, name) for name in SITE}
        if self.flattening:  # not a sphere
            values["site.inverse_flattening"] = 1 / self.flattening
        kind = "angles" if self.position is None else "position"
        release = zip(RELEASES[kind], getattr(self, kind), strict=True)
        return values | {f"release.{name}": value for name, value in release}

    @property
    def creeps(self) -> bool:
        """True if drag is at least 2 sqrt(g/l): the bob falls back to rest without swinging."""
        return self.drag**2 * self.length >= 4 * self.gravity > 0

    @property
    def released(self) -> dict[str, Fraction]:
        """The columns of the state at t = 0 that the scene gives as they are: x, y, vx and vy, or none."""
        return dict(zip(RELEASES["position"], self.position, strict=True)) if self.position else {}

    @property
    def at_rest(self) -> bool:
        """True if the bob is released without any velocity."""
        moving = self.position[2:] if self.position else (self.angles or ())[2:]
        return not any(moving)


def as_read(text: str, reading: str) -> Fraction:
    """Return the exact value of a decimal number, or that of the nearest double if `reading` is binary64.

    Raises:
        OverflowError: no double is as large.
    """
    value = Fraction(text)
    return Fraction(float(value)) if reading == "binary64" else value


def azimuth_of(word: str) -> Fraction:
    """Return the azimuth that a section's word names, in degrees from east to north.

    0 if it names none.
    """
    return Fraction(word.partition(" ")[2].removesuffix("@0") or 0)
