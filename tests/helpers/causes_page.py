"""The table of all causes in docs/oracle.md, written anew from the code: python tests/helpers/causes_page.py."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from places import ROOT

from compare.diagnosis import conventions
from compare.diagnosis.causes import causes_of
from compare.diagnosis.fitted import MODELS
from compare.diagnosis.gate import LOOSE
from compare.diagnosis.programs import Program

PAGE, BEFORE = ROOT / "docs/oracle.md", "## All causes\n"
FAMILIES = ("gravity_", "integrator_", "frame_")  # of whose words one line speaks
RIGHT = Program(
    9.80665, 67.0, 48.846, 7.292115e-5, 6378137.0, 1 / 298.257, 0.0, 0.001, 0.3, 0.4, 0.01, 0.02
)
DO = {
    "no_centrifugal": "Add −Ω × (Ω × (R + r)), or judge against a scene whose g is the measured one.",
    "effective_gravity": "If your g is the measured one, say `--set site.gravity_is=effective`; else add the force.",
    "no_tilt": "Add the force's part along y: −Ω² R cos φ sin φ.",
    "no_lift": "Add the force's part along z: Ω² R cos² φ.",
    "tilt_no_sine": "Multiply the part along y by sin φ.",
    "uniform_gravity": "Compute the force where the bob is and not at the suspension. The effect is small.",
    "ellipsoid_gravity": "Leave the force at the suspension out: a measured g has it. Keep its change along the swing.",
    "point_mass": "Keep g constant in size and direction, as the scene does.",
    "sphere": "Take the distance to the axis from the ellipsoid ([physics](physics.md)).",
    "mean_sphere": "Take the distance to the axis from the ellipsoid, not from a radius of 6371 km.",
    "site.altitude": "Set the altitude of the scene, in metres.",
    "gravity_": "Take the scene's g: `foucault show SCENE` prints it.",
    "solar_day": "Divide 2π by the sidereal day, or take the scene's rotation rate.",
    "rounded_rate": "Take all digits of the scene's rotation rate.",
    "sidereal_day": "Take the scene's rotation rate and not 2π over a day.",
    "rate_per_hour": "Divide the rate by 3600.",
    "rate_in_degrees_per_hour": "Convert the rate to rad/s.",
    "rate_in_degrees": "Multiply the rate by π/180.",
    "rate_factor": "Remove the factor. It is often there to make the turn visible.",
    "no_rotation": "Add the Coriolis and centrifugal forces.",
    "site.rotation_rate": "Compare your rotation rate with the scene's.",
    "coriolis_sign": "Turn the sign: the force is −2 Ω × v.",
    "coriolis_half": "Multiply the Coriolis force by 2.",
    "coriolis_double": "Halve the Coriolis force.",
    "no_coriolis": "Add −2 Ω × v.",
    "vertical_only": "Add the part of Ω to the north, Ω cos φ.",
    "horizontal_sign": "Turn the sign of Ω cos φ: it points north.",
    "vertical_sign": "Turn the sign of Ω sin φ: it points up on the northern hemisphere.",
    "turned_plane": "Integrate the equations on the turning Earth; a turned plane leaves out the ellipse.",
    "turned_plane_sign": "Turn the other way, or better: integrate the equations.",
    "frame_": "Let x point east and y north, or turn the release and the output.",
    "inertial_rest": "Release at rest in the turning axes: v = 0.",
    "inertial_rest_sign": "Release at rest in the turning axes: v = 0.",
    "release_at_twice": "Release at rest in the turning axes: v = 0.",
    "hemisphere": "Turn the sign of the latitude: north is positive.",
    "radians": "Convert the latitude to radians before its sine.",
    "colatitude": "Use the latitude, or swap sine and cosine.",
    "no_sine": "Multiply Ω by sin φ.",
    "geocentric": "Use the geodetic latitude, the one on maps.",
    "site.latitude": "Compare your latitude with the scene's.",
    "at_rest": "Give the bob the scene's velocity at its release.",
    "swapped": "Swap x and y of the release.",
    "no_drag": "Add −drag · v to the acceleration.",
    "drag_half": "Double the drag: the acceleration is −drag · v, without a half.",
    "drag_double": "Halve the drag: the acceleration is −drag · v, without a two.",
    "site.gravity": "Compare your g with the scene's.",
    "pendulum.length": "Compare your length with the scene's.",
    "pendulum.drag": "Compare your drag with the scene's, in 1/s.",
    "release.x": "Compare the x of your release with the scene's.",
    "release.y": "Compare the y of your release with the scene's.",
    "release.vx": "Compare the vx of your release with the scene's.",
    "release.vy": "Compare the vy of your release with the scene's.",
    "stretched_cord": "Put the bob back on the sphere after each step, or use equations that keep the length.",
    "linspace_clock": "Give `linspace` one point more, or leave its end out.",
    "late": "Print the time before the step, or the state after it, not one of each.",
    "integrator_": "Take a smaller step, or a method of higher order ([studies](studies.md)).",
    "integrator_loose": "Take a smaller step or a tighter tolerance.",
    "linear_g": "Integrate the full equations: a small-angle model leaves out that a wide swing is slower.",
    "linear_in_angle": "Integrate the full equations: this model leaves out that a wide swing is slower.",
}
HABITS = {  # of a file: words, what is said of it, what to do
    "decimals, digits": ("prints few digits", "Print 17 digits."),
    "single_precision": ("holds numbers in single precision", "Compute and write in double."),
    "z_down": ("counts z downwards", "Nothing: it is converted."),
    "z_from_lowest": ("counts z from the lowest point", "Nothing: it is converted."),
    "z_offset": (
        "has z too high or too low by the same in every row",
        "Count z from the suspension, upwards.",
    ),
    "vertical_is_not_z": ("calls the vertical x or y", "Nothing: it is converted."),
    "z_constant": (conventions.FLAT, "Write the height, or leave the column out."),
    "off_the_sphere": (conventions.SPRING, "Put the bob back on the sphere after each step."),
    "unit_of_length": (
        "is in another unit than metres or than its header says, or in cord lengths",
        "Name the unit in the header, or say `--units`.",
    ),
    "unit_of_time": (
        "counts time in another unit than seconds",
        "Name the unit in the header, or say `--units`.",
    ),
    "angles": (
        "gives x and y as angles of the cord",
        "Write x and y in metres, or name the columns as angles.",
    ),
    "x_west, y_south, xy_reversed, xy_swapped, axes_turned": (
        "has other horizontal axes",
        "Let x point east and y north.",
    ),
    "clock_offset": ("starts its clock late", "Let the clock be 0 at the release."),
    "rows_reversed": ("has its rows in reverse order", "Write the rows in order of time."),
    "rows_late, rows_early": (
        "has its clock behind or ahead of its rows",
        "Print time and state of the same moment.",
    ),
}


def causes() -> dict[str, str]:
    """Return what is said of each cause, by its word; one entry for a family of words."""
    said: dict[str, str] = {}
    rows = SimpleNamespace(cord=67.1)
    for right in (RIGHT, replace(RIGHT, gravity_reading="effective")):
        for released in (True, False):
            for kind in ("sphere", "linear", "angle"):
                case: Any = SimpleNamespace(
                    right=right, released=released, rows=rows, intervals=1440
                )
                for cause in causes_of(case, kind):
                    family = next((one for one in FAMILIES if cause.id.startswith(one)), cause.id)
                    said.setdefault(family, cause.text.replace("{value}", "…"))
    return dict(MODELS.values()) | said | {"integrator_loose": LOOSE}


def lines() -> Iterator[str]:
    """Yield the lines of the section.

    Raises:
        SystemExit: a cause has no advice here, or an advice no cause.
    """
    said = causes()
    if set(said) != set(DO):
        raise SystemExit(
            f"{__file__}: DO lacks {set(said) - set(DO)}, and has for nothing {set(DO) - set(said)}"
        )
    yield "The word stands in the JSON document (`causes`). A word that ends in … stands for several."
    yield ""
    yield "| word | your program … | what to do |"
    yield "|---|---|---|"
    for word, text in said.items():
        yield f"| `{word}{'…' * (word in FAMILIES)}` | {text.replace('|', chr(92) + '|')} | {DO[word]} |"
    yield ""
    yield "And these are habits of a file. Most are converted, and cost nothing:"
    yield ""
    yield "| word | your file … | what to do |"
    yield "|---|---|---|"
    for words, (text, advice) in HABITS.items():
        quoted = ", ".join(f"`{word}`" for word in words.split(", "))
        yield f"| {quoted} | {text.replace('|', chr(92) + '|')} | {advice} |"


def page() -> str:
    """Return the page as it should be: what is written by hand, then the tables."""
    return "\n".join([PAGE.read_text(encoding="utf-8").partition(BEFORE)[0] + BEFORE, *lines(), ""])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
