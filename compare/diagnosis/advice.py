"""The advice on each cause and each habit of a file, by its id.

An id that ends in _ stands for several.
"""

from __future__ import annotations

import re

FAMILIES = ("gravity_", "integrator_", "frame_")  # causes whose ids begin so share their advice
# the centrifugal force at the suspension is Ω² q, away from the axis
_AXIS = "q is the suspension's distance from the Earth's axis (`foucault show` prints it)"
DO = {
    "no_centrifugal": "Add Ω² x along x, −Ω² p sin φ along y and Ω² p cos φ along z, where "
    f"p = q − y sin φ + z cos φ, and {_AXIS}. If your g is a measured one, take q = 0, and say "
    "`--set site.gravity_is=effective`.",
    "effective_gravity": "If your g is the measured one, say `--set site.gravity_is=effective`; else add "
    f"−Ω² q sin φ along y and Ω² q cos φ along z, where {_AXIS}.",
    "no_tilt": f"Add −Ω² q sin φ along y, where {_AXIS}.",
    "no_lift": f"Add Ω² q cos φ along z, where {_AXIS}.",
    "centrifugal_sign": f"Reverse it: it is −Ω² q sin φ along y and Ω² q cos φ along z, where {_AXIS}.",
    "centrifugal_double": "Add it once. A measured g has it already: then say `--set site.gravity_is=effective`.",
    "tilt_sign": f"Reverse it: it is −Ω² q sin φ along y, where {_AXIS}.",
    "tilt_double": f"Add it once: it is −Ω² q sin φ along y, where {_AXIS}.",
    "lift_sign": f"Reverse it: it is Ω² q cos φ along z, where {_AXIS}.",
    "lift_double": f"Add it once: it is Ω² q cos φ along z, where {_AXIS}.",
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
    "coriolis_sign": "Compare the sign of your rotation rate with the scene's. If it is right, reverse the force: "
    "it is −2 Ω × v.",
    "coriolis_half": "Multiply the Coriolis force by 2.",
    "coriolis_double": "Halve the Coriolis force.",
    "no_coriolis": "Add −2 Ω × v.",
    "vertical_only": "Add the part of Ω to the north, Ω cos φ.",
    "horizontal_sign": "Reverse the sign of Ω cos φ: it points north.",
    "vertical_sign": "Reverse the sign of Ω sin φ: it points up on the northern hemisphere.",
    "turned_plane": "Integrate the equations on the turning Earth; a turned plane leaves out the ellipse.",
    "turned_plane_sign": "Turn the other way, or better: integrate the equations.",
    "frame_": "Let x point east and y north, or turn the release and the output.",
    "inertial_rest": "Release at rest in the turning axes: v = 0.",
    "inertial_rest_sign": "Release at rest in the turning axes: v = 0.",
    "release_at_twice": "Release at rest in the turning axes: v = 0.",
    "hemisphere": "Reverse the sign of the latitude: north is positive.",
    "radians": "Convert the latitude to radians before its sine.",
    "colatitude": "Use the latitude, or swap sine and cosine.",
    "pole": "Take the latitude of the scene, and multiply Ω by its sine.",
    "no_sine": "Take the latitude of the scene, and multiply Ω by its sine.",
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
    "linspace_clock": "Count the points of your `linspace`: n steps need n + 1. If you use none, look for that part "
    "in the clock: frames a second, or a day.",
    "clock": "Divide its times by that factor, and look for it in the clock: frames a second, or a day.",
    "late": "Print the time before the step, or the state after it, not one of each.",
    "integrator_": "Take a smaller step, or a method of higher order ([studies](studies.md)).",
    "integrator_loose": "Take a smaller step or a tighter tolerance.",
    "linear_g": "Integrate the full equations: a small-angle model leaves out that a wide swing is slower.",
    "linear_in_angle": "Integrate the full equations: this model leaves out that a wide swing is slower.",
}
HABITS = {  # of a file: ids, what is said of it, what to do
    "decimals, decimals_of_z, digits": ("prints few digits", "Print 17 digits."),
    "single_precision": ("holds numbers in single precision", "Compute and write in double."),
    "z_down": ("counts z downwards", "Nothing: it is converted."),
    "z_from_lowest": ("counts z from the lowest point", "Nothing: it is converted."),
    "z_offset": (
        "has z too high or too low by the same in every row",
        "Count z from the suspension, upwards.",
    ),
    "vertical_is_not_z": ("calls the vertical x or y", "Nothing: it is converted."),
    "z_constant": (
        "gives z a constant: its bob does not rise as it swings",
        "Write the height, or leave the column out.",
    ),
    "z_wrong": (
        "prints a z that is not the height of a bob at its x and y",
        "Print the height of the bob: z = −√(l² − x² − y²), in metres from the suspension.",
    ),
    "off_the_sphere": (
        "does not keep |r| = l: one of its columns is wrong, its cord is a spring, or its integrator leaves the sphere",
        "Check each column. If all are right, put the bob back on the sphere after each step.",
    ),
    "unit_of_length": (
        "is in another unit than metres or than its header says, or in cord lengths",
        "Name the unit in the header, or say `--units`; multiply cord lengths by the length.",
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
    "column_copied, column_constant, column_mirrored, column_scaled, column_moved, column_late": (
        "prints another column, a constant, or the column mirrored, scaled, moved or some rows late",
        "Print the coordinate itself: x east, y north and z up, in metres from the suspension.",
    ),
    "plane_scaled, plane_turned, plane_moved": (
        "prints x and y scaled, turned or moved",
        "Print x east and y north, in metres from the vertical through the suspension.",
    ),
    "clock_offset": ("starts its clock late", "Let the clock be 0 at the release."),
    "rows_reversed": ("has its rows in reverse order", "Write the rows in order of time."),
    "rows_late, rows_early": (
        "has its clock behind or ahead of its rows",
        "Print time and state of the same moment, the time from the release on.",
    ),
}


def advice_on(cause_id: str) -> str:
    """Return what to do about a cause, or about a habit of a file; "" where there is nothing to do."""
    family = next((family for family in FAMILIES if cause_id.startswith(family)), cause_id)
    habits = {one: what for ids, (_, what) in HABITS.items() for one in ids.split(", ")}
    text = DO.get(cause_id) or DO.get(family) or habits.get(cause_id, "")
    text = "" if text.startswith("Nothing") else text
    # on a terminal a link is the file that it leads to
    return re.sub(r"\[\w+\]\((\S+?)\)", r"docs/\1", text)
