"""Public simulators: 30 trajectories of real programs, run at their own parameters, and their true causes.

The causes were found by reading the programs. `tests/compare/diagnosis/wild/` holds what they wrote, and nothing of the
programs.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from places import ROOT

from reference import Scene, load_scene

FOLDER = ROOT / "tests" / "compare" / "diagnosis" / "wild"
G_EFFECTIVE = "g is the effective one"
FORMAT = {"decimals", "digits"}
# they differ by less than the tolerance
SAME = {"no_centrifugal": G_EFFECTIVE, "effective_gravity": G_EFFECTIVE}

TWO = {"integrator_leapfrog_late": {"integrator_leapfrog", "half_a_step"}}  # one word for both


def words(
    length: str, gravity: str, latitude: str, x: str, y: str, t_end: str, *more: str
) -> list[str]:
    """Return the settings of a program."""
    scene = [f"pendulum.length={length}", f"site.gravity={gravity}", f"site.latitude={latitude}"]
    release = [f"release.x={x}", f"release.y={y}"]
    return [
        *scene,
        *release,
        f"run.t_end={t_end}",
        "run.level=self_consistent",
        "run.transits=false",
        *more,
    ]


ROTATION = "site.rotation_rate={}".format
PUSH = "release.vy={}".format
AXIS = "site.equatorial_radius=0"
SAHA = (
    "67",
    "9.7976432222",
    "48.846222",
    "3.3486043411354482",
    "0",
    "600",
    ROTATION("7.2921158553e-5"),
)
SETTINGS = {
    "w01": words("2.5", "9.80665", "45", "0.1", "0", "600", ROTATION("7.2921e-5")),
    "w02": words("67", "9.81", "48.8664", "6", "0", "60"),
    "w03": words("67", "9.81", "48.8664", "6", "0", "60", ROTATION("0.26179938779914941"), AXIS),
    "w04": words("67", "9.8", "8.1126614607530314", "1", "0", "199.8", ROTATION("-0.3"), AXIS),
    "w05": words("67", "9.81", "52.237", "2", "0", "199.666666667", ROTATION("7.292e-5")),
    "w06": words("6.7", "9.81", "49", "0.067", "0.1", "400"),
    "w07": words("6131.25", "9.81", "48.85", "1", "0", "3600", ROTATION("7.2921235169903748e-05")),
    "w08": words("100", "9.81", "75", "98.480775301220802", "0", "100", ROTATION("0.0072722052166430398"), AXIS),
    "w09": words("100", "9.81", "75", "0", "-98.480775301220802", "100", ROTATION("0.0072722052166430398"), AXIS),
    "w10": words("60", "9.81", "60", "0.2", "0.1", "3600"),
    "w11": words("2", "9.8", "44", "0.15", "0.15", "100"),
    "w12": words("67", "9.8", "34", "1", "0", "3600"),
    "w13": words("67", "9.8", "34", "1", "0.5", "3600"),
    "w14": words("10", "9.81", "45", "0.99833416646828155", "0", "99.75", ROTATION("7.292e-5"), "pendulum.drag=0.05"),
    "w15": words("10", "9.81", "60", "2.9552020666133956", "0", "600", ROTATION("7.292e-5")),
    "w16": words("1.25", "9.8", "45", "-0.21706031416388524", "0", "60"),
    "w17": words(*SAHA, "site.inverse_flattening=inf"),
    "w18": words(*SAHA),
    "w19": words("67", "9.81", "45", "58.023702053557386", "0", "59.9", ROTATION("0"), PUSH("0.20254092900615431")),
    "w20": words("1", "1", "90", "0.001", "0", "62.83", ROTATION("0.1")),
    "w21": words(
        "9.81", "9.81", "45", "6.6868762358289082", "0", "100", ROTATION("0.0001"), PUSH("0.66868762358289091")
    ),
    "w22": words(
        "67", "9.81", "45", "11.634427903684331", "0", "599.99", PUSH("1.1634427903684332"),
        "release.vx=6.5982119451817942",
    ),
    "w23": words("60", "9.81", "60", "0.2", "0.1", "11519", ROTATION("7.292444483e-5")),
    "w24": words("51247559.3", "9.81", "45", "0", "1", "86200", ROTATION("7.292e-5")),
    "w25": words("1", "9.81", "90", "0.01", "0", "600", ROTATION("0.00072722052166430395")),
    "w26": words(
        "65", "9.8", "37.5", "0", "-20", "600", ROTATION("7.27220521664304e-05"), "site.equatorial_radius=6400000",
        "release.vx=3",
    ),
    "w27": words("10", "9.81", "45", "0.9983341664682815", "0", "20.1", ROTATION("7.27e-5")),
    "w28": words("1", "9.8", "60", "0.01", "0", "20", ROTATION("1"), AXIS),
    "w29": words("2", "9.81", "47.2682", "1", "0", "3600", ROTATION("7.27220521664304e-05"), "release.vx=1"),
    "w30": words("1", "1", "90", "0.001", "0", "100", ROTATION("0.0143"), "site.gravity_is=effective"),
}  # fmt: skip
LINEAR = {"linear_g", G_EFFECTIVE}
TRUE = {
    # at 0.01 s, which moves it by half as much again as the tolerance
    "w01": {*LINEAR, "integrator_rk4"},
    "w02": {*LINEAR, "rate_per_hour"},
    "w03": LINEAR,
    # np.append puts the newest row first, and the release is half a row away; Runge-Kutta at 0.3 s
    "w04": {*LINEAR, "rows_reversed", "rows_late", "integrator_rk4"},
    # its formula is a plane that turns, with the frequency of a pendulum that does not
    "w05": {*LINEAR, "rate_factor", "turned_plane", "inertial_rest"},
    "w06": {*LINEAR, "solar_day", "integrator_semi_implicit_euler"},
    # the conjugate turns the plane the wrong way, and the release with it
    "w07": {*LINEAR, "turned_plane_sign", "release_at_twice"},
    "w08": {G_EFFECTIVE, "frame_x_south"},
    "w09": {G_EFFECTIVE},
    "w10": {*LINEAR, "sidereal_day", "integrator_loose"},
    "w11": {*LINEAR, "site.rotation_rate", "integrator_semi_implicit_euler"},
    "w12": {*LINEAR, "solar_day", "inertial_rest"},
    "w13": {*LINEAR, "solar_day", "inertial_rest", "slip"},
    "w14": {"linear_in_angle", G_EFFECTIVE, "integrator_loose"},
    "w15": {G_EFFECTIVE, "turned_plane_sign", "inertial_rest", "integrator_rk4"},
    # a spring in place of a cord; no rotation contains no centrifugal force
    "w16": {"no_rotation", "off_the_sphere", "stretched_cord", "integrator_semi_implicit_euler"},
    "w17": {"point_mass"},
    "w18": {"point_mass", "sphere"},
    "w19": {"integrator_loose"},
    "w20": {"linear_g"},
    # a wrong sign in the equation of the polar angle, on a swing of 43 degrees
    "w21": {G_EFFECTIVE, "slip"},
    "w22": {G_EFFECTIVE, "frame_x_south", "rounded_rate"},  # odeint leaves as much as both of these
    "w23": {*LINEAR, "integrator_loose"},
    "w24": {G_EFFECTIVE, "turned_plane"},  # cos and sin of sqrt(g/l), on a cord of 51,000 km
    "w25": {*LINEAR, "integrator_leapfrog", "half_a_step"},  # x(2) = x(1)
    # Euler-Cromer at 5 ms
    "w26": {"linear_g", "tilt_no_sine", "sphere", "integrator_semi_implicit_euler"},
    "w27": {"falls", "y_is_vertical"},
    "w28": {"slip"},
    "w29": {*LINEAR, "integrator_loose"},
    "w30": LINEAR,
}
# what is true and told as one of several
ONE_OF = {
    # ode45 moves the bob by 95 mm, in phase and in amplitude; so would a vertical centrifugal force that is kept
    "w10": {G_EFFECTIVE},
    "w18": {"point_mass"},
    "w30": {"linear_g"},  # either this, or linear in the angle
}
# what is true and not told: the file does not tell it from something else, or a step of no name hides it
UNTOLD = {
    "w02": {"rate_per_hour"},  # what odeint leaves, three tolerances, a latitude takes up
    "w07": {"linear_g"},  # it moves the bob by a quarter of the tolerance
    "w10": {
        "linear_g",
        "sidereal_day",
    },  # 86160 s for a day move it by 2 micrometres, and a wide swing drifts
    "w14": {"integrator_loose"},  # three times as much is left without it, within the tolerance
    "w15": {"integrator_rk4"},  # a step error, of no name
    "w16": {"integrator_semi_implicit_euler"},  # a step error, of no name
    "w19": {"integrator_loose"},  # three tolerances, of no phase and no amplitude that drift
    "w21": {
        G_EFFECTIVE,
        "slip",
    },  # of 3e-4 m/s², where the rows, 26 to a swing, tell accelerations to 2e-3 m/s²
    "w22": {"frame_x_south", "rounded_rate"},  # odeint leaves as much as both of these
    "w23": {"linear_g"},  # a swing that is slower as it is wider: a phase that drifts
}


def read_in(name: str) -> tuple[Scene, np.ndarray, dict[str, np.ndarray]]:
    """Return the scene of a trajectory, its times, and its columns."""
    scene = load_scene("paris", [*SETTINGS[name], "inputs=binary64"])
    path = FOLDER / f"{name}.csv"
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    with path.open() as lines:
        header = lines.readline().strip().split(",")
    columns = {
        word: np.ascontiguousarray(table[:, i]) for i, word in enumerate(header) if word in "xyz"
    }
    return scene, table[:, 0], columns


def one_of(found: Any) -> set[str]:
    """Return the words of which an explanation says that one or another is true."""
    alternatives = "|".join(cause.id for cause in found.causes if "|" in cause.id)
    return {SAME.get(word, word) for word in alternatives.replace("+", "|").split("|")}


def said(found: Any) -> set[str]:
    """Return the words of an explanation."""
    slip = (
        {"falls", "y_is_vertical"} if "y falls" in found.slip else {"slip"} if found.slip else set()
    )
    known = {SAME.get(one.id, one.id) for one in (*found.known, *found.conventions)} - FORMAT | slip
    known = {word for word in known if "|" not in word}
    return known - TWO.keys() | {word for one in known & TWO.keys() for word in TWO[one]}
