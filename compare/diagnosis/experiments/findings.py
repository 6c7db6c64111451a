"""Experiments with a program that is run again: changes, which a command allows, and findings."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from operator import attrgetter
from typing import Any

from reference import FoucaultError, InputError, Scene
from reference.model.start import Start
from reference.numbers.precision import DOUBLE

from ...candidates.external import SETTING, placeholders

_PUSH = 0.2  # of the rate of the swing: the rate round the vertical that is added to the release
# fields of a scene that make its swing wide
_SWING = (
    "release.x",
    "release.y",
    "release.vx",
    "release.vy",
    "release.angle",
    "release.angle_rate",
    "release.azimuth_rate",
)
_ADVICE = (
    "Add {rotation_rate}, {latitude}, {gravity}, {length}, {x0} {y0}, {vx0} {vy0}, {t_end} or "
    "{setting}, and have the program use them."
)
_Values = Callable[[Scene], dict[str, str]]


@dataclass(frozen=True)
class Experiment:
    """A change of what the program is given.

    Attributes:
        id: a stable word, and the name of the file that is kept.
        title: what is changed.
        values: returns the fields of a scene with their changed values.
        where: where the mistake is, if the error vanishes with the change; "" if that shows
            nothing.
        finer: number by which {setting} is divided.
    """

    id: str
    title: str
    values: _Values
    where: str = ""
    finer: int = 1

    def changed(self, scene: Scene) -> Scene:
        """Return the scene that a program is given."""
        return scene.with_values(f"{field}={value}" for field, value in self.values(scene).items())


def _times(factor: str, *fields: str) -> _Values:
    """Return a change that multiplies fields of a scene by a factor."""

    def values(scene: Scene) -> dict[str, str]:
        changed = {}
        for field in fields:
            text = attrgetter(field)(scene)
            if text is not None:
                changed[field] = str(Decimal(text) * Decimal(factor))
        return changed

    return values


def _pole(scene: Scene) -> dict[str, str]:
    """Return the latitude of the nearer pole."""
    return {"site.latitude": "-90" if scene.exact.latitude < 0 else "90"}


def _pushed(scene: Scene) -> dict[str, str]:
    """Return the velocity of the release, pushed round the vertical."""
    release = scene.release
    start = Start.of(scene.exact, DOUBLE.prec)
    rate = _PUSH * start.fastest_rate
    if release.angle is not None:
        turn = Decimal(release.azimuth_rate or "0") + Decimal(f"{math.degrees(rate):.3g}")
        return {"release.azimuth_rate": str(turn)}
    x, y, _ = (float(value) for value in start.position)
    distance = math.hypot(x, y) or 0.05 * float(scene.exact.length)
    speed = Decimal(f"{rate * distance:.3g}")
    vx = Decimal(release.vx or "0") + speed
    vy = Decimal(release.vy or "0") - speed
    return {"release.vx": str(vx), "release.vy": str(vy)}


_EXPERIMENTS = (
    Experiment("half_step", "half the step", lambda _: {}, finer=2),
    Experiment("quarter_g", "a quarter of g", _times("0.25", "site.gravity")),
    Experiment(
        "no_rotation",
        "no rotation",
        lambda _: {"site.rotation_rate": "0"},
        "in what the rotation does",
    ),
    Experiment(
        "small_swing",
        "a swing a hundredth as wide",
        _times("0.01", *_SWING),
        "in what a wide swing does",
    ),
    Experiment("pushed", "the release pushed", _pushed),
    Experiment("twice_length", "twice the length", _times("2", "pendulum.length")),
    Experiment("pole", "the pole", _pole, "in what the latitude does"),
    Experiment("short_span", "half the span", _times("0.5", "run.t_end")),
)
MOST_RUNS = len(_EXPERIMENTS)


@dataclass(frozen=True)
class Finding:
    """Report one experiment: what was changed, and what followed.

    Attributes:
        id: of the experiment.
        title: what was changed.
        changes: what the program was given, by field.
        max_error_m: the largest error in m, conventions put right; None if the run failed.
        conclusion: what follows by itself, or why nothing does; "" for nothing.
    """

    id: str
    title: str
    changes: dict[str, str]
    max_error_m: float | None
    conclusion: str = ""

    def line(self) -> str:
        """Return what was found, for people."""
        changes = ", ".join(f"{name} = {value}" for name, value in self.changes.items())
        error = "" if self.max_error_m is None else f"the error is {self.max_error_m:.2g} m"
        results = ": ".join(text for text in (error, self.conclusion) if text)
        return f"Experiment, {self.title} ({changes}): {results}."


@dataclass(frozen=True)
class Experiments:
    """The experiments with a program, and what they measured.

    Attributes:
        runs: in their order.
        measured: ids of the causes that explain all files: of no explanation, of one, or of several
            that no run distinguishes.
        text: what follows from all runs.
    """

    runs: tuple[Finding, ...]
    measured: tuple[tuple[str, ...], ...]
    text: str

    def lines(self) -> Iterator[str]:
        """Yield what was found, line by line, for people."""
        yield from (finding.line() for finding in self.runs)
        yield self.text

    def document(self) -> dict[str, Any]:
        """Return it as a JSON document."""
        return vars(self) | {"runs": [vars(finding) for finding in self.runs]}


def possible(scene: Scene, command: str) -> list[Experiment]:
    """Return the experiments of which a command's placeholders pass on the whole change.

    Raises:
        InputError: there are none.
    """
    words = set(re.findall(r"(?<!\{)\{(\w+)\}", command))
    given = placeholders(scene)
    experiments = []
    for experiment in _EXPERIMENTS:
        try:
            values = placeholders(experiment.changed(scene))
        except FoucaultError:  # such a scene is impossible: twice its swing goes over the top
            continue
        changed = {name for name, value in values.items() if value != given[name]}
        finer_step = experiment.finer > 1 and SETTING.strip("{}") in words
        if finer_step or _passes_on(words, changed - {"z0", "vz0"}):
            experiments.append(experiment)
    if not experiments:
        expected = "a command with a placeholder that an experiment can change"
        raise InputError("--experiments", command, expected, _ADVICE)
    return experiments


def _passes_on(words: set[str], changed: set[str]) -> bool:
    """Return whether the placeholders of a command pass on all that changed.

    A release may be given by its position or by its angles.
    """
    angles = {name for name in changed if re.match("a(ng|z)", name)}
    positions = {name for name in changed if re.match("v?[xyz]0", name)}
    if not changed:
        return False
    return changed - angles <= words or (bool(angles) and changed - positions <= words)
