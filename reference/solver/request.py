"""A caller's request: a scene with the settings of its run, an engine, and further checks.

Mistakes are refused before any work.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from fractions import Fraction

from ..engines import AUTO
from ..engines.plan import Report
from ..errors import InputError, in_words
from ..model.sections import form_of
from ..model.start import Start
from ..numbers.precision import LONG_DOUBLE
from ..scenes.fields import CONFIRMATIONS, Confirmation
from ..scenes.scene import AnyScene, Scene, as_scene


@dataclass(frozen=True, kw_only=True)
class RunSettings:
    """Settings of a run that replace those of a scene; None keeps the scene's own.

    Attributes:
        digits: significant decimal digits of the largest number in each column.
        level: one of `scene.LEVELS`.
        t_end: end of the run in s; a number is taken as it is printed.
        transits: whether to find every zero of xdot.
        sections: other moments to find, such as ["highest", "gate 30"].
    """

    digits: int | None = None
    level: str | None = None
    t_end: str | float | None = None
    transits: bool | None = None
    sections: str | Sequence[str] | None = None

    def applied_to(self, scene: AnyScene) -> Scene:
        """Return a scene with these settings.

        Raises:
            InputError: a setting is wrong, or the scene has no such section: no gate without a rest
                position.
        """
        given = {f"run.{field.name}": getattr(self, field.name) for field in fields(self)}
        changes = {name: value for name, value in given.items() if value is not None}
        scene = as_scene(scene).with_values(changes)
        for word in scene.run.sections or ():
            form_of(word, Start.of(scene.exact, LONG_DOUBLE.prec))
        return scene


@dataclass(frozen=True, kw_only=True)
class ProofOptions:
    """What a proof at the level enclosed is to include besides its digits.

    Attributes:
        audit: whether all that compiled code returns for the proof is checked, step by step.
        confirm: what heyoka confirms in another formulation: "whole", "sampled" or "none".
        function: whether to make the golden function as well.
    """

    audit: bool = False
    confirm: Confirmation = "none"
    function: bool = False

    def check(self, level: str) -> None:
        """Refuse options that need another level.

        Raises:
            InputError: an unknown confirmation, or another level than enclosed, which alone has a
                proof.
        """
        if self.confirm not in CONFIRMATIONS:
            raise InputError("confirm", self.confirm, in_words(CONFIRMATIONS))
        if level == "enclosed":
            return
        wanted = {
            "audit": self.audit,
            "confirm": self.confirm != "none",
            "function": self.function,
        }
        for name, value in wanted.items():
            if value:
                advice = "Only level enclosed has the proof that this needs."
                raise InputError(name, level, "the level enclosed", advice)


@dataclass(frozen=True, kw_only=True)
class SolveRequest:
    """A scene to be solved.

    Attributes:
        scene: the scene, with the settings asked for.
        times: output times in s, increasing, from 0.
        engine: name of the engine; "auto" for the fastest.
        proof: what a proof is to include.
        report: called with the simulated time reached, in s.
    """

    scene: Scene
    times: tuple[Fraction, ...]
    engine: str = AUTO
    proof: ProofOptions = ProofOptions()
    report: Report | None = None


@dataclass(frozen=True, kw_only=True)
class RangesRequest:
    """A scene with uncertain inputs, for which intervals are to be proved.

    Attributes:
        scene: the scene at the level enclosed, with the settings asked for.
        widths: half of the width of each uncertain input by its full name, in SI units or degrees.
        times: output times in s, increasing, from 0.
        engine: name of the engine; "auto" for the fastest.
        derivatives: whether to prove derivatives to the uncertain inputs too.
        report: called with the simulated time reached, in s.
    """

    scene: Scene
    widths: dict[str, Fraction]
    times: tuple[Fraction, ...]
    engine: str = AUTO
    derivatives: bool = False
    report: Report | None = None


def progress_report(report: Report | None, span_s: Fraction) -> Report | None:
    """Return a callback that takes the completed share of a span and reports the simulated time."""
    if report is None:
        return None
    return lambda part: report(part * float(span_s))
