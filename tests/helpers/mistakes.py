"""Programs with one to three mistakes at values drawn at random, what is told of their rows, and what may be."""

from __future__ import annotations

import math
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from small_scenes import make_scene

from compare import Candidate, judge
from reference import InputError, Scene

SAME = {"effective_gravity": "no_centrifugal", "decimals": "digits", "single_precision": "digits"}
NO_CLOCK = "the first row"  # in the message that nobody can tell when the release was
UNTOLD = {"digits", "off_the_sphere", "stretched_cord"}  # said of the file, whatever made it
FLATTENING = 1 / 298.257223563


@dataclass
class Case:
    """A scene, the arguments of `mistaken.c`, and the words that are true of the program."""

    number: int
    scene: Scene
    period: float
    rng: np.random.Generator
    arguments: dict[str, float]
    true: set[str] = field(default_factory=set)
    # and the right arguments
    parts: list[tuple[set[str], dict[str, float | None]]] = field(default_factory=list)

    def add(self, change: Change) -> None:
        """Make a mistake."""
        before, words = dict(self.arguments), set(self.true)
        change(self)
        keys = {key for key, value in self.arguments.items() if before.get(key) != value}
        self.parts.append((self.true - words, {key: before.get(key) for key in keys}))

    def without(self, words: set[str]) -> Case:
        """Return the case with the mistakes mended that have one of some words."""
        arguments: dict[str, float | None] = dict(self.arguments)
        kept = []
        for names, right in self.parts:
            if (names | one_word_for_one_motion(names)) & (words | one_word_for_one_motion(words)):
                arguments |= right
            else:
                kept.append((names, right))
        given = {key: value for key, value in arguments.items() if value is not None}
        true = {word for names, _ in kept for word in names}
        return replace(self, arguments=given, true=true, parts=kept)

    def matters(self, program: Path) -> set[str]:
        """Return the words of mistakes without which the rows are others by more than the tolerance."""
        words: set[str] = set()
        for names, right in self.parts:
            if self._is_seen(self.without(names), program) or names & SAME.keys():
                words |= names
            if "model" in right and "no_centrifugal" in names:
                words -= {"no_centrifugal"} - self._along_the_swing(right, program)
        return words

    def _is_seen(self, other: Case, program: Path) -> bool:
        """Return whether the rows of another case are others by more than the tolerance."""
        times, columns = self.rows(program)
        mended, others = other.rows(program)
        if not np.array_equal(times, mended):
            return True
        allowed = self.allowed_m * self.arguments.get("scale", 1.0)  # in the unit of the file
        return any(np.abs(columns[name] - others[name]).max() > allowed for name in columns)

    def _along_the_swing(self, right: dict[str, float | None], program: Path) -> set[str]:
        """Return the word of the centrifugal force that a linear model leaves out, if the rows show it."""
        without = self._with(model=1)
        given = self._with(model=3, reading=right.get("reading") or 0)
        return {"no_centrifugal"} if without._is_seen(given, program) else set()

    def _with(self, **arguments: float) -> Case:
        """Return the case with other arguments."""
        return replace(self, arguments=self.arguments | arguments)

    def rows(self, program: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Return times and columns that the program writes."""
        words = [f"{key}={float(value)!r}" for key, value in self.arguments.items()]
        text = subprocess.run(
            [str(program), *words], check=True, capture_output=True, text=True
        ).stdout
        table = np.loadtxt(text.splitlines(), delimiter=",", skiprows=1)
        return table[:, 0], {
            name: np.ascontiguousarray(table[:, i + 1]) for i, name in enumerate("xyz")
        }

    @property
    def allowed_m(self) -> float:
        """Distance in m that counts as agreement."""
        return 1e-6 * math.hypot(self.arguments["x0"], self.arguments["y0"])

    def told(self, times: np.ndarray, columns: dict[str, np.ndarray]) -> Told:
        """Return what is told of rows, at the tolerance of the case."""
        return told(self.scene, times, columns, self.allowed_m)

    def wrong(self, words: set[str]) -> set[str]:
        """Return the words that are said and are not true, programs with the same motion being one."""
        true = self.true | one_word_for_one_motion(self.true)
        # the same of one column
        if {"x_west", "y_south"} & true:
            true.add("column_mirrored")
        # Ω is vertical
        if {"vertical_only", "hemisphere"} <= true and self.arguments["reading"] == 2:
            true.add("coriolis_sign")
        said = one_word_for_one_motion(words) - true - UNTOLD
        steps = (
            {"integrator_loose"}
            if any(word.startswith("integrator") for word in self.true)
            else set()
        )
        return said - steps


@dataclass(frozen=True)
class Told:
    """What is told of a file: words of what is certain, how it is explained, and whether nothing is left of its error.

    Attributes:
        words: ids of causes and conventions.
        explanation: as in its score; None if it agrees, or could not be judged.
        agrees: whether it does.
        alternatives: words of which one or another is true: "either … or …".
    """

    words: set[str]
    explanation: Any
    agrees: bool
    alternatives: set[str] = field(default_factory=set)


def told(scene: Scene, times: np.ndarray, columns: dict[str, np.ndarray], allowed_m: float) -> Told:
    """Return what is told of rows, of a scene that is as long as they are: so `judge` advises."""
    last = float(times[-1])
    if times[0] <= scene.exact.t_end < last:
        scene = scene.with_values([f"run.t_end={last!r}"])
    try:
        score = judge(Candidate.of("mine", times, columns), scene, tolerance=allowed_m)
    except InputError as error:
        assert NO_CLOCK in str(error)
        return Told({"clock_offset"}, None, False)
    found = score.explanation
    texts = [part.text for part in (*found.causes, *found.conventions)] if found else []
    assert len(texts) == len(set(texts)), "a cause is told twice"
    words = {part.id for part in (*found.known, *found.conventions)} if found else set()
    alternatives = {
        word
        for part in (found.causes if found else ())
        for ids in part.id.split("|")
        for word in ids.split("+")
        if "|" in part.id
    }
    if any(part.id == "clock_start" for part in score.candidate.conventions):
        words.add("clock_offset")
    return Told(words, found, score.agrees, alternatives)


def one_word_for_one_motion(words: set[str]) -> set[str]:
    """Return words with those replaced that no output can tell apart.

    A motion in the plane knows only the sign of Ω's vertical part, and without any of the forces of rotation there is
    no rotation.
    """
    found = {
        "site.gravity" if word.startswith("gravity_") else SAME.get(word, word) for word in words
    }
    if found & {"linear_g", "linear_in_angle"} and "hemisphere" in found:
        found = found ^ {"hemisphere", "coriolis_sign"}
    if {
        "hemisphere",
        "coriolis_sign",
    } <= found:  # Ω's northward part turned round, as by half a turn about the vertical
        found = found - {"hemisphere", "coriolis_sign"} | {"frame_x_west"}
    if {"no_centrifugal", "no_coriolis"} <= found:
        found = found - {"no_centrifugal", "no_coriolis"} | {"no_rotation"}
    return found


def case(number: int, seed: int = 17, most: int = 3) -> Case:
    """Return the case of a number, with `most` mistakes at most: the same at every call."""
    rng = np.random.default_rng([seed, number])
    length = float(np.round(np.exp(rng.uniform(np.log(0.5), np.log(70))), 2))
    latitude = float(np.round(rng.uniform(15, 75), 4)) * (1 if rng.random() < 0.8 else -1)
    wide = math.sin(math.radians(rng.uniform(10, 70)))
    amplitude, azimuth = (
        length * (wide if rng.random() < 0.3 else rng.uniform(0.01, 0.08)),
        rng.uniform(0.2, 1.3),
    )
    x, y = (float(np.round(amplitude * part, 4)) for part in (np.cos(azimuth), np.sin(azimuth)))
    period = 2 * math.pi * math.sqrt(length / 9.80665)
    # rows dense, as usual, or sparse
    low, high = ((15, 60), (5, 12), (0.6, 3))[int(rng.choice(3, p=[0.3, 0.5, 0.2]))]
    out = float(f"{period / rng.uniform(low, high):.2g}")
    rows = int(rng.integers(250, 600))
    effective = rng.random() < 0.3
    site = {"latitude": repr(latitude)} | ({"gravity_is": "effective"} if effective else {})
    scene = make_scene(
        f"mistaken_{number}", pendulum={"length": repr(length)}, site=site, release={"x": repr(x), "y": repr(y)},
        run={"t_end": repr(out * rows), "grid_step": repr(out), "digits": 20},
    ).with_values(["inputs=binary64"])  # fmt: skip
    step = out / math.ceil(out / (period / 1500))
    made = Case(
        number,
        scene,
        period,
        rng,
        {"l": length, "lat": latitude, "x0": x, "y0": y, "out": out, "h": step},
    )
    made.arguments |= {"tend": out * rows, "reading": 2.0 if effective else 0.0}
    _mistaken(made, effective, int(rng.choice([1, 2, 3], p=[0.4, 0.35, 0.25])) if most else 0)
    return made


def _mistaken(made: Case, effective: bool, count: int) -> None:
    """Make mistakes that exclude no other."""
    kinds = [*_KINDS, *(_EFFECTIVE if effective else _ELLIPSOID)]
    order, groups = list(made.rng.permutation(len(kinds))), set()
    while count and order:
        group, change = kinds[order.pop()]
        excluded = _EXCLUDED.get(group, {group})
        if not groups & excluded:
            groups |= excluded
            made.add(change)
            count -= 1


Change = Callable[[Case], None]
_EXCLUDED = {
    "linear": {"gravity", "earth", "linear", "integrator", "coriolis", "latitude", "length"},
    "gravity": {"gravity", "earth", "linear"},
    "earth": {"gravity", "earth", "linear"},
}


def _mistake(word: str, **arguments: float) -> Change:
    def change(made: Case) -> None:
        made.arguments |= arguments
        made.true.add(word)

    return change


def _linear(model: int, reading: int, *words: str) -> Change:
    def change(made: Case) -> None:
        made.arguments |= {"model": model, "reading": reading}
        made.true |= set(words)

    return change


def _shifted(key: str, word: str, low: float, high: float) -> Change:
    """Change an input; of ten people seven type it, with three to five digits, three compute it."""

    def change(made: Case) -> None:
        rng, before = made.rng, made.arguments.get(key, 9.80665)
        value = before * (
            1 + math.exp(rng.uniform(math.log(low), math.log(high))) * rng.choice([-1, 1])
        )
        typed = float(f"{value:.{rng.integers(3, 6)}g}")
        made.arguments[key] = typed if rng.random() < 0.7 and typed != before else value
        made.true.add(word)

    return change


def _drag(made: Case) -> None:
    made.arguments["drag"] = float(
        f"{math.exp(made.rng.uniform(math.log(1e-5), math.log(1e-2))):.2g}"
    )
    made.true.add("pendulum.drag")


def _radians(made: Case) -> None:
    made.arguments["corlat"] = math.degrees(made.arguments["lat"])
    made.true.add("radians")


def _geocentric(made: Case) -> None:
    tangent = (1 - FLATTENING) ** 2 * math.tan(math.radians(made.arguments["lat"]))
    made.arguments["corlat"] = math.degrees(math.atan(tangent))
    made.true.add("geocentric")


def _turned(made: Case) -> None:
    made.arguments["lat"] = -made.arguments["lat"]
    made.true.add("hemisphere")


def _clock(made: Case) -> None:
    made.arguments["fast"] = 1 + made.arguments["out"] / made.arguments["tend"]
    made.true.add("linspace_clock")


def _from_lowest(made: Case) -> None:
    made.arguments["zshift"] = -1
    made.true.add("z_from_lowest")


def _step(method: int, word: str, low: float, high: float) -> Change:
    """Take a method at `low` to `high` steps a swing, a whole number of them from row to row."""

    def change(made: Case) -> None:
        steps = max(1, round(made.arguments["out"] / (made.period / made.rng.uniform(low, high))))
        made.arguments |= {"method": method, "h": made.arguments["out"] / steps}
        made.true.add(word)

    return change


_KINDS: tuple[tuple[str, Change], ...] = (
    ("gravity", _mistake("no_centrifugal", reading=1)),
    ("gravity", _mistake("no_centrifugal", reading=1)),
    ("linear", _linear(1, 1, "linear_g", "no_centrifugal")),
    ("linear", _linear(2, 1, "linear_in_angle", "no_centrifugal")),
    ("rate", _mistake("solar_day", rate=2 * math.pi / 86400)),
    ("rate", _mistake("rounded_rate", rate=7.29e-5)),
    ("coriolis", _mistake("coriolis_sign", half=-1)),
    ("coriolis", _mistake("coriolis_half", half=0.5)),
    ("coriolis", _mistake("no_coriolis", half=0)),
    ("coriolis", _mistake("vertical_only", north=0)),
    ("latitude", _radians),
    ("latitude", _turned),
    ("latitude", _geocentric),
    ("stars", _mistake("inertial_rest", stars=1)),
    ("g", _shifted("g", "site.gravity", 1e-5, 1e-2)),
    ("g", _shifted("g", "site.gravity", 1e-4, 1e-2)),
    ("length", _shifted("l", "pendulum.length", 1e-4, 1e-2)),
    ("start", _shifted("x0", "release.x", 1e-3, 1e-2)),
    ("start", _shifted("y0", "release.y", 1e-3, 1e-2)),
    ("drag", _drag),
    ("integrator", _step(0, "integrator_semi_implicit_euler", 50, 400)),
    ("integrator", _step(5, "integrator_semi_implicit_euler_drift", 50, 400)),
    ("integrator", _step(3, "integrator_leapfrog", 20, 200)),
    ("integrator", _step(1, "integrator_explicit_euler", 2000, 5000)),
    ("integrator", _step(4, "integrator_rk4", 20, 60)),
    ("integrator", _step(2, "integrator_rk2", 60, 300)),
    ("clock", _clock),
    ("clock", _mistake("unit_of_time", tscale=60)),
    ("clock", _mistake("clock_offset", toffset=1000)),
    ("clock", _mistake("rows_reversed", reversed=1)),
    ("rows", _mistake("unit_of_length", scale=100)),
    ("rows", _mistake("unit_of_length", scale=1000)),
    ("rows", _mistake("xy_swapped", swap=1)),
    ("rows", _mistake("y_south", ysign=-1)),
    ("rows", _mistake("x_west", xsign=-1)),
    ("heights", _mistake("z_down", zsign=-1)),
    ("heights", _from_lowest),
    ("digits", _mistake("decimals", decimals=9)),
    ("digits", _mistake("single_precision", single=1)),
)
_ELLIPSOID: tuple[tuple[str, Change], ...] = (
    ("gravity", _mistake("effective_gravity", reading=2)),
    ("gravity", _mistake("point_mass", point=1)),
    ("earth", _mistake("sphere", invf=1e9)),
    ("earth", _mistake("mean_sphere", outward=6371000)),
    ("linear", _linear(3, 0, "linear_g", "no_lift")),
)
_EFFECTIVE: tuple[tuple[str, Change], ...] = (
    ("gravity", _mistake("ellipsoid_gravity", reading=0)),
    ("gravity", _mistake("ellipsoid_gravity", reading=0, outward=6371000)),
)
