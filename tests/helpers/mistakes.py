"""Programs with one to three mistakes at values drawn at random, and what an explanation ought to name of each."""

from __future__ import annotations

import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from small_scenes import make_scene

from reference import Scene

OFF = 1e-7  # of the cord: a distance from the suspension that changes by more is to be said


@dataclass
class Case:
    """A scene, the arguments of `mistaken.c`, and the causes and numbers that ought to be named."""

    number: int
    scene: Scene
    arguments: dict[str, float]
    expected: set[str] = field(default_factory=set)
    values: dict[str, float] = field(default_factory=dict)

    def rows(self, program: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Return times and columns that the program writes."""
        words = [f"{key}={value!r}" for key, value in self.arguments.items()]
        text = subprocess.run([str(program), *words], check=True, capture_output=True, text=True).stdout
        table = np.loadtxt(text.splitlines(), delimiter=",", skiprows=1)
        return table[:, 0], {name: np.ascontiguousarray(table[:, i + 1]) for i, name in enumerate("xyz")}

    def said(self, columns: dict[str, np.ndarray]) -> set[str]:
        """Return the words that ought to be said of what the program wrote, programs with the same motion being one."""
        words = one_word_for_one_motion(self.expected)
        if max(np.abs(column).max() for column in columns.values()) > 1e12 * 0.5e-9:  # no double has such decimals
            words = words - {"decimals"}
        if "scale" in self.arguments:  # heights are made anew in another unit
            return words
        places = np.array([columns[name] for name in ("x", "y", "z")])
        places[2] = (places[2] - self.arguments.get("zshift", 0.0)) * self.arguments.get("zsign", 1.0)
        reach = np.linalg.norm(places, axis=0)
        return words | ({"off_the_sphere"} if np.ptp(reach) > OFF * self.arguments["l"] else set())


def one_word_for_one_motion(words: set[str]) -> set[str]:
    """Return words with those replaced that no output can tell apart.

    A motion in the plane knows only the sign of Ω's vertical part, and without any of the forces of rotation there is
    no rotation.
    """
    found = set(words)
    if found & {"linear_g", "linear_in_angle"} and "hemisphere" in found:
        found = found ^ {"hemisphere", "coriolis_sign"}
    if {"no_centrifugal", "no_coriolis"} <= found:
        found = found - {"no_centrifugal", "no_coriolis"} | {"no_rotation"}
    return found


def case(number: int) -> Case:
    """Return the case of a number: the same at every call."""
    rng = np.random.default_rng([17, number])
    length = float(np.round(rng.uniform(2, 70), 2))
    latitude = float(np.round(rng.uniform(20, 70), 4)) * (1 if rng.random() < 0.8 else -1)
    amplitude, azimuth = length * rng.uniform(0.01, 0.08), rng.uniform(0.2, 1.3)
    x, y = (float(np.round(amplitude * part, 4)) for part in (np.cos(azimuth), np.sin(azimuth)))
    period = 2 * np.pi * np.sqrt(length / 9.80665)
    out = float(np.round(period / rng.uniform(5, 12), 2))
    rows = int(rng.integers(250, 400))
    end = out * rows
    scene = make_scene(
        f"mistaken_{number}", pendulum={"length": repr(length)}, site={"latitude": repr(latitude)},
        release={"x": repr(x), "y": repr(y)}, run={"t_end": repr(end), "grid_step": repr(out), "digits": 20},
    ).with_values(["inputs=binary64"])  # fmt: skip
    steps = int(np.ceil(out / (period / 900)))
    made = Case(
        number, scene, {"l": length, "lat": latitude, "x0": x, "y0": y, "tend": end, "out": out, "h": out / steps}
    )
    count = int(rng.choice([1, 2, 3], p=[0.4, 0.35, 0.25]))
    groups: set[str] = set()
    kinds = list(rng.permutation(len(_KINDS)))
    linear = False
    while count and kinds:
        group, words, change = _KINDS[kinds.pop()]
        if group in groups or (linear and "sphere" in words) or ("linear" in words and groups & _NEVER_LINEAR):
            continue
        groups |= {group} | ({"gravity", "model", "earth", "integrator"} if "linear" in words else set())
        groups |= {"gravity", "earth"} if group in ("gravity", "earth") else set()
        linear = linear or "linear" in words
        change(made, rng)
        count -= 1
    return made


_NEVER_LINEAR = {"gravity", "earth", "integrator", "model"}


def _mistake(word: str, **arguments: float):
    def change(made: Case, rng: np.random.Generator) -> None:
        made.arguments |= arguments
        made.expected.add(word)

    return change


def _model(number: int, word: str):
    def change(made: Case, rng: np.random.Generator) -> None:
        made.arguments |= {"model": number, "reading": 1}
        made.expected |= {word, "no_centrifugal"}

    return change


def _shifted(key: str, word: str, low: float, high: float):
    def change(made: Case, rng: np.random.Generator) -> None:
        before = made.arguments.get(key, 9.80665)
        shift = float(np.exp(rng.uniform(np.log(low), np.log(high)))) * float(rng.choice([-1, 1]))
        value = before * (1 + shift)
        made.arguments[key] = value
        made.expected.add(word)
        made.values[word] = value - before

    return change


def _drag(made: Case, rng: np.random.Generator) -> None:
    made.arguments["drag"] = value = float(np.exp(rng.uniform(np.log(1e-5), np.log(1e-2))))
    made.expected.add("pendulum.drag")
    made.values["pendulum.drag"] = value


def _radians(made: Case, rng: np.random.Generator) -> None:
    made.arguments["corlat"] = float(np.degrees(made.arguments["lat"]))
    made.expected.add("radians")


def _turned(made: Case, rng: np.random.Generator) -> None:
    made.arguments["lat"] = -made.arguments["lat"]
    made.expected.add("hemisphere")


def _rate(value: float, word: str):
    def change(made: Case, rng: np.random.Generator) -> None:
        made.arguments["rate"] = value
        made.expected.add(word)

    return change


def _euler(method: int, word: str, low: float, high: float):
    def change(made: Case, rng: np.random.Generator) -> None:
        period = 2 * np.pi * np.sqrt(made.arguments["l"] / 9.80665)
        steps = max(1, round(made.arguments["out"] / (period / rng.uniform(low, high))))
        made.arguments |= {"method": method, "h": made.arguments["out"] / steps}
        made.expected.add(word)
        made.values[word] = made.arguments["h"]

    return change


def _z(sign: float, from_lowest: bool, word: str):
    def change(made: Case, rng: np.random.Generator) -> None:
        made.arguments |= {"zsign": sign, "zshift": made.arguments["l"] if from_lowest else 0.0}
        made.expected.add(word)

    return change


_KINDS = (
    ("gravity", "", _mistake("no_centrifugal", reading=1)),
    ("gravity", "", _mistake("effective_gravity", reading=2)),
    ("gravity", "", _mistake("no_centrifugal", reading=1)),
    ("model", "linear", _model(1, "linear_g")),
    ("model", "linear", _model(1, "linear_g")),
    ("model", "linear", _model(2, "linear_in_angle")),
    ("earth", "sphere", _mistake("sphere", invf=1e9)),
    ("rate", "", _rate(2 * np.pi / 86400, "solar_day")),
    ("coriolis", "", _mistake("coriolis_sign", half=-1)),
    ("coriolis", "", _mistake("coriolis_half", half=0.5)),
    ("coriolis", "", _mistake("no_coriolis", half=0)),
    ("latitude", "", _radians),
    ("latitude", "sphere", _turned),
    ("stars", "", _mistake("inertial_rest", stars=1)),
    ("g", "", _shifted("g", "site.gravity", 1e-5, 1e-2)),
    ("g", "sphere", _shifted("l", "pendulum.length", 1e-4, 1e-2)),
    ("start", "", _shifted("x0", "release.x", 1e-3, 1e-2)),
    ("start", "", _shifted("y0", "release.y", 1e-3, 1e-2)),
    ("drag", "", _drag),
    ("integrator", "", _euler(0, "integrator_semi_implicit_euler", 100, 400)),
    ("integrator", "", _euler(4, "integrator_rk4", 30, 60)),
    ("rows", "", _mistake("unit_of_length", scale=100)),
    ("rows", "", _mistake("unit_of_length", scale=1000)),
    ("clock", "", _mistake("unit_of_time", tscale=60)),
    ("clock", "", _mistake("clock_offset", toffset=1000)),
    ("clock", "", _mistake("rows_reversed", reversed=1)),
    ("rows", "", _mistake("xy_swapped", swap=1)),
    ("rows", "", _z(-1, False, "z_down")),
    ("rows", "", _z(1, True, "z_from_lowest")),
    ("digits", "", _mistake("decimals", decimals=9)),
)
