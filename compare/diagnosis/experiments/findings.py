"""Experiments with a program that is run again: what they change, for which its command is fit, and what they found."""

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

PUSH = 0.2  # of the rate of the swing: by this the release is pushed, round the vertical
SWING = ("x", "y", "vx", "vy", "angle", "angle_rate", "azimuth_rate")
ADVICE = (
    "Add {rotation_rate}, {latitude}, {gravity}, {length}, {x0} {y0}, {vx0} {vy0}, {t_end} or {setting}, "
    "and have the program use them."
)
Values = Callable[[Scene], dict[str, str]]


@dataclass(frozen=True)
class Experiment:
    """A change of what the program is given.

    Attributes:
        id: a stable word, and the name of the file that is kept.
        title: what is changed.
        values: the fields of the scene with their other values.
        where: where the mistake is, if the error is gone with it; "" if that would not show it.
        finer: by which {setting} is divided.
    """

    id: str
    title: str
    values: Values
    where: str = ""
    finer: int = 1

    def changed(self, scene: Scene) -> Scene:
        """Return the scene that a program is given."""
        return scene.with_values(f"{field}={value}" for field, value in self.values(scene).items())


def _times(factor: str, *fields: str) -> Values:
    def values(scene: Scene) -> dict[str, str]:
        texts = {field: attrgetter(field)(scene) for field in fields}
        return {
            field: str(Decimal(text) * Decimal(factor))
            for field, text in texts.items()
            if text is not None
        }

    return values


def _pole(scene: Scene) -> dict[str, str]:
    return {"site.latitude": "-90" if scene.exact.latitude < 0 else "90"}


def _pushed(scene: Scene) -> dict[str, str]:
    release, start = scene.release, Start.of(scene.exact, DOUBLE.prec)
    rate = PUSH * start.fastest_rate
    if release.angle is not None:
        turn = Decimal(release.azimuth_rate or "0") + Decimal(f"{math.degrees(rate):.3g}")
        return {"release.azimuth_rate": str(turn)}
    x, y, _ = (float(value) for value in start.position)
    speed = Decimal(f"{rate * (math.hypot(x, y) or 0.05 * float(scene.exact.length)):.3g}")
    vx, vy = Decimal(release.vx or "0") + speed, Decimal(release.vy or "0") - speed
    return {"release.vx": str(vx), "release.vy": str(vy)}


EXPERIMENTS = (
    Experiment("half_step", "half the step", lambda _: {}, finer=2),
    Experiment("quarter_g", "a quarter of g", _times("0.25", "site.gravity")),
    Experiment("no_rotation", "no rotation", lambda _: {"site.rotation_rate": "0"}, "in what the rotation does"),
    Experiment(
        "small_swing", "a swing a hundredth as wide", _times("0.01", *(f"release.{name}" for name in SWING)),
        "in what a wide swing does",
    ),
    Experiment("pushed", "the release pushed", _pushed),
    Experiment("twice_length", "twice the length", _times("2", "pendulum.length")),
    Experiment("pole", "the pole", _pole, "in what the latitude does"),
    Experiment("short_span", "half the span", _times("0.5", "run.t_end")),
)  # fmt: skip
MOST_RUNS = len(EXPERIMENTS)


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
        measured: ids of the causes that make all files: of no explanation, one, or several that no run told apart.
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
    """Return the experiments for which a command has the placeholders: those that give a program all of a change.

    Raises:
        InputError: there are none.
    """
    words, given = set(re.findall(r"(?<!\{)\{(\w+)\}", command)), placeholders(scene)
    angles, places = (
        {name for name in given if re.match(form, name)} for form in ("a(ng|z)", "v?[xyz]0")
    )
    experiments = []
    for experiment in EXPERIMENTS:
        try:
            values = placeholders(experiment.changed(scene))
        except FoucaultError:  # the scene has no such form: twice its swing over the top
            continue
        changed = {name for name, value in values.items() if value != given[name]} - {"z0", "vz0"}
        complete = changed - angles <= words or (changed & angles and changed - places <= words)
        if (changed and complete) or (experiment.finer > 1 and SETTING.strip("{}") in words):
            experiments.append(experiment)
    if not experiments:
        expected = "a command with a placeholder that an experiment can change"
        raise InputError("--experiments", command, expected, ADVICE)
    return experiments
