"""When passages come if inputs are uncertain, what limits that, and what to measure better: estimates.

They follow from motions with each input at both ends of its width, as those of the period do
(`effects`). What a proof needs is another question: `narrowing`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from ..scenes.scene import Scene
from .effects import Effect, Effects, Estimate, at_ends, limits_document, rounded_down
from .passages import MORE_SWINGS, Asked, computed_passages

# what is estimated of each input
_OF_AN_INPUT = ("moves_s", "moves_error_s", "share")
_OWN_DIGITS = 12  # of the passages of the scene's own inputs
_MOVED_DIGITS = 10  # of those with an input at an end of its width; of effects three are printed
_NEGLIGIBLE = 0.01  # part of the wanted width: an input that causes less is not named
_DIGITS = 2  # of a width that suffices
_TRIES = 5  # of widths: effects are nearly in proportion to them

_Passage = tuple[str, int]  # section and number


class _Missing(NamedTuple):
    """Why the time of a passage is missing.

    Attributes:
        reason: what the user is told.
        is_absent: whether the motion has no such passage; False where it could not be solved.
    """

    reason: str
    is_absent: bool


_Times = dict[_Passage, Estimate | _Missing]


class PassageEstimates:
    """Estimated times of the passages of a scene with uncertain inputs.

    Args:
        scene: the scene.
        widths: half of the width of each uncertain input, as decimals.
        asked: the passages of each section.
        longest_s: the longest period of the uncertain pendulums in s; None if that is not known.
    """

    def __init__(
        self,
        scene: Scene,
        widths: Mapping[str, str],
        asked: Sequence[Asked],
        longest_s: float | None,
    ) -> None:
        self._widths = widths
        self._asked = asked
        self._longest_s = longest_s
        self._own = self._times(scene, _OWN_DIGITS)
        self._longer = _longer(scene, longest_s)
        # of inputs and their widths, so that nothing is solved twice
        self._at_ends: dict[tuple[str, str], list[_Times]] = {}

    def document(self, word: str, asked: Asked) -> dict[str, Any]:
        """Return what is estimated of a passage in the form of --json, or why nothing is.

        `reason`: the motion has no such passage. `no_estimate`: the motion could not be solved.
        `limits`: how far each input alone moves it, and its share. `enough_by_estimate`: see
        `_enough`.
        """
        passage = (word, asked.number)
        own = self._own[passage]
        if isinstance(own, _Missing):
            if own.is_absent:
                return {"reason": f"none: {own.reason}"}
            return {"no_estimate": own.reason}
        document: dict[str, Any] = {"estimate_s": own.value, "estimate_error_s": own.error}
        effects = self._effects(passage, own)
        if isinstance(effects, str):
            return document | {"no_estimate_range": effects}
        document["estimate_range_s"] = effects.ends
        document["estimate_plus_minus_s"] = effects.plus_minus
        document["limits"] = limits_document(effects, _OF_AN_INPUT)
        if asked.width_s is not None:
            document["enough_by_estimate"] = self._enough(passage, effects, float(asked.width_s))
        return document

    def _effects(self, passage: _Passage, own: Estimate) -> Effects | str:
        """Return how far each input moves a passage, or why that is not known."""
        by_input = {}
        for name, width in self._widths.items():
            effect = self._effect(passage, own, name, width)
            if isinstance(effect, str):
                return f"with {name} at an end of its width, {effect}"
            by_input[name] = effect
        return Effects(own, by_input)

    def _effect(self, passage: _Passage, own: Estimate, name: str, width: str) -> Effect | str:
        """Return how far an input of some width moves a passage, or why that is not known."""
        if (name, width) not in self._at_ends:
            pair = at_ends(self._longer, {name: width})[name]
            self._at_ends[name, width] = [self._times(end, _MOVED_DIGITS) for end in pair]
        numbers = []
        for times in self._at_ends[name, width]:
            number = times[passage]
            if isinstance(number, _Missing):
                return number.reason
            numbers.append(number)
        return Effect.of(own, numbers)

    def _times(self, scene: Scene, digits: int) -> _Times:
        """Return the time of each passage, or why it is missing."""
        times: _Times = {}
        for found in computed_passages(scene, self._asked, self._longest_s, digits):
            word = found["section"]
            if "number" not in found:
                unsolved = _Missing(found["reason"], is_absent=False)
                times |= {(word, one.number): unsolved for one in self._asked}
            elif "reason" in found:
                times[word, found["number"]] = _Missing(found["reason"], is_absent=True)
            else:
                times[word, found["number"]] = Estimate(found["t_s"], found["t_error_s"])
        return times

    def _enough(self, passage: _Passage, effects: Effects, wanted_s: float) -> dict[str, Any]:
        """Return which widths of inputs suffice for a wanted width of a passage, in s.

        `alone`: of each input, the width that suffices if the others stay as they are, None if none
        does, and half of the width of the passage if this input is exact. `together`: where no
        input suffices alone, the widths of all that matter, divided by one factor.
        """
        if effects.half_width <= wanted_s:
            return {"is_within": True, "alone": {}, "together": None}
        alone = {}
        shares = effects.shares
        for name in sorted(shares, key=lambda name: -shares[name]):
            others_s = effects.half_width - effects.by_input[name].half_width
            widths = self._width_for(passage, [name], effects, wanted_s)
            alone[name] = {
                "width": f"±{widths[name]}" if widths else None,
                "if_exact_half_width_s": f"{others_s:.3g}",
            }
        together = None
        if not any(one["width"] for one in alone.values()):
            matter = [
                name
                for name, effect in effects.by_input.items()
                if effect.half_width > _NEGLIGIBLE * wanted_s
            ]
            widths = self._width_for(passage, matter, effects, wanted_s)
            if widths:
                together = {name: f"±{width}" for name, width in widths.items()}
        return {"is_within": False, "alone": alone, "together": together}

    def _width_for(
        self, passage: _Passage, names: Sequence[str], effects: Effects, wanted_s: float
    ) -> dict[str, str] | None:
        """Return widths of some inputs, all divided by one factor, that suffice; None if none do.

        They are checked by motions with each input at its new ends.

        Args:
            passage: section and number.
            names: the inputs that get narrower.
            effects: of all inputs with their widths as they are.
            wanted_s: half of the width that the passage may have, in s.
        """
        moved_s = sum(effects.by_input[name].half_width for name in names)
        free_s = wanted_s - (effects.half_width - moved_s)
        if free_s <= 0:
            return None
        factor = moved_s / free_s
        for _ in range(_TRIES):
            widths = {
                name: rounded_down(float(self._widths[name]) / factor, _DIGITS) for name in names
            }
            moved_s = 0.0
            for name, width in widths.items():
                effect = self._effect(passage, effects.own, name, width)
                if isinstance(effect, str):
                    return None
                moved_s += effect.half_width
            if moved_s <= free_s:
                return widths
            factor *= moved_s / free_s
        return None


def _longer(scene: Scene, longest_s: float | None) -> Scene:
    """Return a scene whose run has some swings more, if the time of a swing is known.

    With an input at an end of its width, a passage may come after the end of the run.
    """
    if longest_s is None:
        return scene
    t_end = f"{float(scene.run.t_end) + MORE_SWINGS * longest_s:.6g}"
    return scene.with_values({"run.t_end": t_end, "run.grid_step": t_end})
