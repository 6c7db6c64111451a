"""Programs in C, Python and JavaScript, each with a mistake that its one file does not tell from others."""

from __future__ import annotations

import math
import random
import shlex
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from places import ROOT

GIVEN = {
    "l": "{length}", "g": "{gravity}", "lat": "{latitude}", "rate": "{rotation_rate}", "x0": "{x0}", "y0": "{y0}",
    "vx0": "{vx0}", "vy0": "{vy0}", "tend": "{t_end}", "out": "{grid_step}", "h": "0.01",
}  # fmt: skip
PLACES = (  # length, latitude, x, y, t_end, grid_step
    ("67", "48.846111", "0.3", "0.4", "300", "1"),
    ("12.3", "51.48", "0.5", "0.2", "120", "0.5"),
    ("2", "-33.5", "0.06", "0.05", "60", "0.2"),
    ("27", "30", "0.7", "0.5", "200", "0.5"),
)
FIELDS = (
    "pendulum.length",
    "site.latitude",
    "release.x",
    "release.y",
    "run.t_end",
    "run.grid_step",
)
# words that change one thing
SAME = {"gtimes": "g", "ltimes": "l", "ratetimes": "rate", "counts_ends": "fast"}
MISTAKES = (  # what is told the program after its placeholders, what is true of it, the place
    ({"fast": "1.0001"}, "clock", 0),
    ({"fast": "0.99995"}, "clock", 1),
    ({"fast": "1.003"}, "clock", 2),
    ({"g": "9.812"}, "site.gravity", 0),
    ({"g": "9.7"}, "site.gravity", 1),
    ({"gtimes": "1.0003"}, "site.gravity", 2),
    ({"gtimes": "0.9992"}, "site.gravity", 3),
    ({"l": "67.1"}, "pendulum.length", 0),
    ({"l": "12"}, "pendulum.length", 1),
    ({"ltimes": "0.9995"}, "pendulum.length", 3),
    ({"lat": "48.5"}, "site.latitude", 0),
    ({"lat": "51"}, "site.latitude", 1),
    ({"rate": "7.1e-5"}, "site.rotation_rate", 0),
    ({"rate": "7.2722052166430e-5"}, "solar_day", 1),
    ({"ratetimes": "1.01"}, "site.rotation_rate", 2),
    ({"ratetimes": "0.95"}, "site.rotation_rate", 3),
    ({"half": "0.5"}, "coriolis_half", 3),
    ({"half": "-1"}, "coriolis_sign", 1),
    ({"half": "0"}, "no_coriolis", 2),
    ({"north": "0"}, "vertical_only", 0),
    ({"drag": "1e-5"}, "pendulum.drag", 0),
    ({"drag": "3e-4"}, "pendulum.drag", 2),
    ({"stars": "1"}, "inertial_rest", 1),
    ({"model": "1", "reading": "1"}, "linear_g no_centrifugal", 0),
    ({"reading": "1"}, "no_centrifugal", 3),
    ({"counts_ends": "1"}, "linspace_clock", 0),
    ({"counts_ends": "1"}, "linspace_clock", 3),
    ({"method": "3", "h": "0.05"}, "step", 0),
    ({"method": "2", "h": "0.02"}, "step", 1),
    ({"method": "4", "h": "0.2"}, "step", 2),
    ({"method": "0", "h": "{setting}"}, "step", 0),
    ({"method": "2", "h": "{setting}"}, "step", 3),
    ({"method": "3", "h": "{setting}", "g": "9.81"}, "step site.gravity", 0),
    ({"method": "2", "h": "{setting}", "drag": "2e-5"}, "pendulum.drag step", 3),
    ({"rtol": "1e-6"}, "step", 0),
    ({"rtol": "{setting}"}, "step", 1),
    ({"fast": "1.0002", "drag": "1e-4"}, "clock pendulum.drag", 1),
    ({"half": "0.5", "ltimes": "1.001"}, "coriolis_half pendulum.length", 3),
    ({"rate": "7.2722052166430e-5", "gtimes": "1.0005"}, "solar_day site.gravity", 0),
    ({"lat": "48", "fast": "1.0003"}, "site.latitude clock", 0),
    ({"model": "1", "reading": "1", "half": "-1"}, "linear_g no_centrifugal coriolis_sign", 3),
    (
        {"model": "1", "reading": "1", "half": "-1", "ratetimes": "1.01"},
        "linear_g no_centrifugal coriolis_sign site.rotation_rate",
        3,
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Ambiguous:
    """A program: its language, the options that make its scene of paris, its command, and the words true of it."""

    language: str
    settings: list[str]
    command: str
    true: frozenset[str]


def ambiguous(
    number: int,
    compiled: Path,
    node: str,
    given: Sequence[tuple[dict[str, str], str, int]] = MISTAKES,
) -> Ambiguous:
    """Return the program of a number, with the compiled `mistaken.c` and the path of Node.js."""
    mistakes, true, place = given[number]
    language = "Python" if "rtol" in mistakes else ("C", "Python", "JavaScript")[number % 3]
    helpers = ROOT / "tests/helpers"
    runs = {
        "C": [str(compiled)],
        "Python": [sys.executable, str(helpers / "mistaken.py")],
        "JavaScript": [node, str(helpers / "mistaken.js")],
    }
    values = [f"{field}={value}" for field, value in zip(FIELDS, PLACES[place], strict=True)]
    settings = [word for value in (*values, "run.transits=false") for word in ("--set", value)]
    # the last of a name counts
    words = [f"{key}={value}" for key, value in (*GIVEN.items(), *mistakes.items())]
    return Ambiguous(
        language,
        settings,
        " ".join([*map(shlex.quote, runs[language]), *words]),
        frozenset(true.split()),
    )


def words_said(ids: set[str]) -> set[str]:
    """Return ids with one word for all that an integrator does, and one for g."""
    return {
        "step" if word.startswith("integrator") else "site.gravity" if word.startswith("gravity_")
        else "no_centrifugal" if word == "effective_gravity" else word
        for word in ids
    }  # fmt: skip


def drawn(seed: int, count: int) -> Iterator[tuple[dict[str, str], str, int]]:
    """Yield mistakes as `MISTAKES` has them, one or two of them drawn at random with their numbers."""
    draw = random.Random(seed)

    def near(value: float, most: float, digits: int) -> str:
        return f"{value * (1 + draw.choice((-1, 1)) * 10 ** draw.uniform(-4, math.log10(most))):.{digits}g}"

    for _ in range(count):
        place = draw.randrange(len(PLACES))
        length, latitude = float(PLACES[place][0]), float(PLACES[place][1])
        step = draw.choice(("0.02", "0.05", "0.1", "{setting}", "{setting}"))
        kinds = [
            ({"fast": near(0.995, 0.004, 6)}, "clock"),
            ({"g": near(9.80665, 0.02, 5)}, "site.gravity"), ({"gtimes": near(1, 0.02, 6)}, "site.gravity"),
            ({"l": near(length, 0.05, 5)}, "pendulum.length"), ({"ltimes": near(1, 0.02, 6)}, "pendulum.length"),
            ({"lat": near(latitude, 0.1, 4)}, "site.latitude"), ({"drag": near(1e-4, 0.9, 2)}, "pendulum.drag"),
            ({"ratetimes": near(1, 0.1, 4)}, "site.rotation_rate"), ({"rate": "7.2722052166430e-5"}, "solar_day"),
            ({"half": "0.5"}, "coriolis_half"), ({"half": "-1"}, "coriolis_sign"), ({"north": "0"}, "vertical_only"),
            ({"stars": "1"}, "inertial_rest"), ({"model": "1", "reading": "1"}, "linear_g no_centrifugal"),
            ({"reading": "1"}, "no_centrifugal"),
            *(({"method": word, "h": step}, "step") for word in ("0", "2", "3", "3")),
        ]  # fmt: skip
        mistakes, words, used = dict[str, str](), list[str](), set[str]()
        for chosen, true in draw.sample(kinds, draw.choice((1, 1, 2))):
            touched = {
                {"gtimes": "g", "ltimes": "l", "ratetimes": "rate", "counts_ends": "fast"}.get(
                    key, key
                )
                for key in chosen
            }
            if not touched & used:
                mistakes, used = mistakes | chosen, used | touched
                words.append(true)
        yield mistakes, " ".join(words), place
