"""Which uncertain input a proof needs to be narrower, and how much, found by proofs with narrower inputs.

First-order shares would not do: most of a wide interval is what the proof loses, which grows with the square of
the widths. A proof with a narrower input measures both. What the pendulum itself needs is estimated in
`effects` and `estimated_passages`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from ..engines.plan import Report
from ..errors import BoxTooWideError
from ..numbers.zeros import XDOT
from ..scenes.scene import Scene
from ..solver.swing import Ends
from ..solver.uncertain import decimal, prove_ranges
from .passages import passage_interval
from .progress import Move

_TENTH = 10
_NARROWER = (2, 5, 10, 20, 50, 100)  # factors that are tried, in turn
_NEGLIGIBLE = 0.01  # a share of an estimate below which a proof is tried without a narrower input
_AFTER = Fraction(101, 100)  # of a passage's time: where the proofs of this passage end

Widths = Mapping[str, str]


def reach_s(scene: Scene, widths: Widths, report: Report | None = None) -> float:
    """Return the time in s up to which the states can be proved for these widths, at most the end of the run.

    `report` is called with the simulated time reached, in s.
    """
    try:
        prove_ranges(scene, widths, derivatives=True, transits=False, sections=[], report=report)
    except BoxTooWideError as error:
        return error.holds_s
    return float(scene.run.t_end)


def ending_after(scene: Scene, time_s: Fraction) -> Scene:
    """Return a scene whose run ends hardly later than a time."""
    t_end = decimal(min(scene.exact.t_end, time_s * _AFTER))
    return scene.with_values({"run.t_end": t_end, "run.grid_step": t_end})


def interval_alone(
    scene: Scene, widths: Widths, word: str, number: int, report: Report
) -> Ends | str:
    """Return the interval of the time of a passage, or why there is none; of all zeros only its section is sought.

    Raises:
        BoxTooWideError: the proof ends before the run.
    """
    is_transit = word == XDOT
    sections = [] if is_transit else [word]
    ranges = prove_ranges(
        scene, widths, derivatives=True, transits=is_transit, sections=sections, report=report
    )
    return passage_interval(ranges, word, number)


class _Proved(NamedTuple):
    """What a proof with some widths achieves.

    Attributes:
        holds_s: up to which time it holds.
        half_width_s: half of the width of the interval of a passage; infinite if there is none.
        reason: why that interval is missing; "" if it is not, or if no passage was asked for.
    """

    holds_s: float
    half_width_s: float = math.inf
    reason: str = ""

    def is_within(self, wanted_s: float) -> bool:
        """Return whether the passage has an interval, which is no wider than wanted."""
        return math.isfinite(self.half_width_s) and self.half_width_s <= wanted_s


class Narrowing:
    """Proofs of a scene with narrower inputs.

    Args:
        scene: the scene.
        widths: half of the width of each uncertain input, as decimals.
        goals: how many questions will be asked.
        report: called with the number of proofs that are done, and how many there are at most.
    """

    def __init__(self, scene: Scene, widths: Widths, goals: int, report: Move) -> None:
        self._scene = scene
        self._widths = widths
        self._report = report
        self._done = 0
        # each goal takes one proof for each input, some until one suffices, and one with fewer inputs
        self._most = goals * (len(widths) + len(_NARROWER) + 1)

    def for_the_run(self, holds_s: float) -> dict[str, Any]:
        """Return how far the proof reaches with each single input known ten times better, and which widths suffice.

        `narrowest_holds_s` is how far it reaches with all widths divided by the largest factor that
        is tried, if none suffices.

        Args:
            holds_s: up to which time it holds with the widths as they are.
        """
        t_end_s = float(self._scene.run.t_end)

        def measured(widths: Widths) -> _Proved:
            return _Proved(reach_s(self._scene, widths, self._share_of(t_end_s)))

        alone = self._alone(measured)
        names = sorted(alone, key=lambda name: -alone[name].holds_s)
        enough, last = self._enough(
            measured,
            alone,
            names[0],
            lambda proved: proved.holds_s >= t_end_s,
            _least_factor(t_end_s, holds_s),
        )
        found: dict[str, Any] = {
            "alone": [
                {"input": name, "width": self._text(name, _TENTH), "holds_s": alone[name].holds_s}
                for name in names
            ],
            "enough": enough,
        }
        if enough is None:
            found["narrowest_holds_s"] = last.holds_s
        return found

    def for_a_passage(self, passage: Mapping[str, Any], until_s: Fraction) -> dict[str, Any]:
        """Return the width of a passage's interval in s with each single input known ten times better.

        If a width was asked for, or the passage is not proved, return what suffices for it as well.

        Args:
            passage: in the form of --json.
            until_s: by when it has come.
        """
        word = passage["section"]
        number = passage["number"]
        part = ending_after(self._scene, until_s)
        t_end_s = float(part.run.t_end)

        def measured(widths: Widths) -> _Proved:
            try:
                interval = interval_alone(part, widths, word, number, self._share_of(t_end_s))
            except BoxTooWideError as error:
                return _Proved(error.holds_s, reason=ends_before(error.holds_s))
            if isinstance(interval, str):
                return _Proved(t_end_s, reason=interval)
            return _Proved(t_end_s, float(interval.high - interval.low) / 2)

        alone = self._alone(measured)
        names = sorted(alone, key=lambda name: (alone[name].half_width_s, -alone[name].holds_s))
        half_width_s = _half_width_s(passage)
        found: dict[str, Any] = {
            "half_width_s": _or_none(half_width_s),
            "alone": [
                {
                    "input": name,
                    "width": self._text(name, _TENTH),
                    "half_width_s": _or_none(alone[name].half_width_s),
                    "holds_s": alone[name].holds_s,
                    "reason": alone[name].reason,
                }
                for name in names
            ],
        }
        is_proved = math.isfinite(half_width_s)
        if is_proved and "wanted_s" not in passage:
            return found
        wanted_s = float(passage.get("wanted_s", "inf"))
        found["enough"] = {}
        if not is_proved or half_width_s > wanted_s:

            def suffices(proved: _Proved) -> bool:
                return proved.is_within(wanted_s)

            enough, _ = self._enough(measured, alone, names[0], suffices)
            if enough and len(enough) > 1:
                fewer = _with_a_share(enough, passage)
                if fewer and suffices(self._measured(measured, self._with(fewer))):
                    enough = fewer
            found["enough"] = enough
        return found

    def _share_of(self, t_end_s: float) -> Report:
        """Return a callback that reports the simulated time of a proof as a part of one proof."""
        return lambda t: self._report(self._done + t / t_end_s, self._most)

    def _measured(self, measured: Callable[[Widths], _Proved], widths: Widths) -> _Proved:
        """Return what is proved with some widths, and count the proof."""
        proved = measured(widths)
        self._done += 1
        self._report(self._done, self._most)
        return proved

    def _alone(self, measured: Callable[[Widths], _Proved]) -> dict[str, _Proved]:
        """Return what is proved with each input alone ten times as well known."""
        return {
            name: self._measured(measured, self._narrower([name], _TENTH)) for name in self._widths
        }

    def _enough(
        self,
        measured: Callable[[Widths], _Proved],
        alone: Mapping[str, _Proved],
        best: str,
        suffices: Callable[[_Proved], bool],
        least: float = 1.0,
    ) -> tuple[dict[str, str] | None, _Proved]:
        """Return the widths that suffice, and what was proved last.

        The widths are those of one input, or else of all of them; None if none suffices.

        Args:
            measured: what is proved with some widths.
            alone: what is proved with each input alone ten times as well known.
            best: the input that helps most.
            suffices: whether that is good enough.
            least: factor below which no width helps.
        """
        one_suffices = suffices(alone[best])
        names = [best] if one_suffices else list(self._widths)
        narrowest = _TENTH if one_suffices else _NARROWER[-1]
        proved = alone[best]
        for factor in _NARROWER:
            # the narrowest are tried in any case, to say how far they reach
            if factor < min(least, narrowest):
                continue
            if not (one_suffices and factor == _TENTH):
                proved = self._measured(measured, self._narrower(names, factor))
            if suffices(proved):
                return {name: self._text(name, factor) for name in names}, proved
            if factor == narrowest:
                break
        return None, proved

    def _narrower(self, names: list[str], factor: int) -> dict[str, str]:
        """Return the widths, some of them divided by a factor."""
        narrower = dict(self._widths)
        for name in names:
            narrower[name] = decimal(Fraction(narrower[name]) / factor)
        return narrower

    def _with(self, texts: Widths) -> dict[str, str]:
        """Return the widths, those of some inputs replaced by widths with their sign."""
        return {**self._widths, **{name: text.removeprefix("±") for name, text in texts.items()}}

    def _text(self, name: str, factor: int) -> str:
        """Return the width of an input divided by a factor, with its sign."""
        return f"±{decimal(Fraction(self._widths[name]) / factor)}"


def _least_factor(needed_s: float, holds_s: float) -> float:
    """Return a factor below which no narrower inputs help: a proof holds no longer than in proportion."""
    return needed_s / holds_s if holds_s > 0 else 1.0


def ends_before(holds_s: float) -> str:
    """Return why a passage is not proved if the proof ends before it."""
    return f"the proof ends at {holds_s:.4g} s"


def _with_a_share(widths: Widths, passage: Mapping[str, Any]) -> dict[str, str]:
    """Return the widths of the inputs that move a passage by estimate; empty if all do, or if that is not known."""
    limits = passage.get("limits", {})
    fewer = {
        name: width
        for name, width in widths.items()
        if name in limits and limits[name]["share"] > _NEGLIGIBLE
    }
    return fewer if len(fewer) < len(widths) else {}


def _half_width_s(passage: Mapping[str, Any]) -> float:
    """Return half of the width of a passage's interval in s; infinite if it has none."""
    if "t_s" not in passage:
        return math.inf
    low, high = map(Fraction, passage["t_s"])
    return float(high - low) / 2


def _or_none(half_width_s: float) -> float | None:
    """Return a half-width, or None for an infinite one, which JSON does not have."""
    return half_width_s if math.isfinite(half_width_s) else None
