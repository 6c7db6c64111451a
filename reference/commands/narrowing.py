"""Which uncertain input to measure better, and how well, found by proofs with narrower inputs.

First-order shares would not do: most of a wide interval is what the proof loses, which grows with the square of
the widths. A proof with a narrower input measures both.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from ..errors import BoxTooWideError
from ..numbers.zeros import XDOT
from ..scenes.scene import Scene
from ..solver.uncertain import decimal, prove_ranges
from .progress import Move

_TENTH = 10
_NARROWER = (2, 5, 10, 20, 50, 100)  # factors that are tried, in turn
_AFTER = Fraction(101, 100)  # of a passage's time: where the proofs of this passage end

Widths = Mapping[str, str]


def reach_s(scene: Scene, widths: Widths) -> float:
    """Return the time in s up to which the states can be proved for these widths, at most the end of the run."""
    try:
        prove_ranges(scene, widths, derivatives=True, transits=False, sections=[])
    except BoxTooWideError as error:
        return error.holds_s
    return float(scene.run.t_end)


class Narrowing:
    """Proofs of a scene with narrower inputs.

    Args:
        scene: the scene.
        widths: half of the width of each uncertain input, as decimals.
        report: called with the number of proofs that are done.
    """

    def __init__(self, scene: Scene, widths: Widths, report: Move) -> None:
        self._scene = scene
        self._widths = widths
        self._report = report
        self._done = 0

    def for_the_run(self, holds_s: float) -> dict[str, Any]:
        """Return how far the proof reaches with each single input known ten times better, and which widths suffice.

        Args:
            holds_s: up to which time it holds with the widths as they are.
        """
        t_end_s = float(self._scene.run.t_end)

        def measured(widths: Widths) -> float:
            return reach_s(self._scene, widths)

        alone = self._alone(measured)
        best = max(alone, key=lambda name: alone[name])
        # a proof holds no longer than in proportion
        least = t_end_s / holds_s if holds_s > 0 else 1.0
        return {
            "alone": [
                {"input": name, "width": self._text(name, _TENTH), "holds_s": alone[name]}
                for name in sorted(alone, key=lambda name: -alone[name])
            ],
            "enough": self._enough(measured, best, lambda reached_s: reached_s >= t_end_s, least),
        }

    def for_a_passage(self, passage: Mapping[str, Any]) -> dict[str, Any]:
        """Return the width of a passage's interval in s with each single input known ten times better.

        If a width was asked for, return what suffices for it as well.

        Args:
            passage: one with an interval, in the form of --json.
        """
        low, high = map(Fraction, passage["t_s"])
        word = passage["section"]
        number = passage["number"]
        # the passage, and hardly more
        t_end = min(self._scene.exact.t_end, high * _AFTER)
        part = self._scene.with_values(
            {"run.t_end": decimal(t_end), "run.grid_step": decimal(t_end)}
        )
        sections = [] if word == XDOT else [word]

        def measured(widths: Widths) -> float:
            ranges = prove_ranges(
                part, widths, derivatives=True, transits=word == XDOT, sections=sections
            )
            times = ranges.zeros[word].table.exact("t")
            if number > len(times):
                return math.inf
            first, last = times[number - 1]
            return float(last - first) / 2

        alone = self._alone(measured)
        found: dict[str, Any] = {
            "half_width_s": float(high - low) / 2,
            "alone": [
                {"input": name, "width": self._text(name, _TENTH), "half_width_s": alone[name]}
                for name in sorted(alone, key=lambda name: alone[name])
            ],
        }
        if "wanted_s" in passage:
            wanted_s = float(passage["wanted_s"])
            best = min(alone, key=lambda name: alone[name])
            found["enough"] = {}
            if found["half_width_s"] > wanted_s:
                found["enough"] = self._enough(measured, best, lambda half_s: half_s <= wanted_s)
        return found

    def _alone(self, measured: Callable[[Widths], float]) -> dict[str, float]:
        """Return what is measured with each input alone ten times as well known."""
        results = {}
        for name in self._widths:
            results[name] = measured(self._narrower([name], _TENTH))
            self._done += 1
            self._report(self._done)
        return results

    def _enough(
        self,
        measured: Callable[[Widths], float],
        best: str,
        suffices: Callable[[float], bool],
        least: float = 1.0,
    ) -> dict[str, str] | None:
        """Return the widths that suffice: of one input, or else of all of them; None if none does.

        Args:
            measured: what is measured by a proof with some widths.
            best: the input that helps most, ten times as well known.
            suffices: whether that is good enough.
            least: factor below which no width helps.
        """
        for names, most in (([best], _TENTH), (list(self._widths), _NARROWER[-1])):
            for factor in _NARROWER:
                if not least <= factor <= most:
                    continue
                if suffices(measured(self._narrower(names, factor))):
                    return {name: self._text(name, factor) for name in names}
        return None

    def _narrower(self, names: list[str], factor: int) -> dict[str, str]:
        """Return the widths, some of them divided by a factor."""
        narrower = dict(self._widths)
        for name in names:
            narrower[name] = decimal(Fraction(narrower[name]) / factor)
        return narrower

    def _text(self, name: str, factor: int) -> str:
        """Return the width of an input divided by a factor, with its sign."""
        return f"±{decimal(Fraction(self._widths[name]) / factor)}"
