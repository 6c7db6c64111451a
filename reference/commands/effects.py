"""How far uncertain inputs move period and precession: estimates, from runs in double precision.

Each input alone is put at both ends of its width, the others as they are. Proofs: `proved`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from ..dataset.ranges import ends
from ..errors import FoucaultError
from ..scenes.scene import Scene
from ..solver.uncertain import decimal
from ..sweeps.scene_swing import EstimatedSwing, first_swings, swing

# what is estimated of each input
_OF_AN_INPUT = ("moves_period_s", "moves_period_error_s", "share")


class _Number(NamedTuple):
    """A number with its estimated error."""

    value: float
    error: float


class Effect(NamedTuple):
    """How far one input moves a number: from its own value at most down to `low` and up to `high`.

    Attributes:
        low: at most 0.
        high: at least 0.
        error: estimated error of both.
    """

    low: float
    high: float
    error: float

    @property
    def size(self) -> float:
        """The larger of the two."""
        return max(-self.low, self.high)


@dataclass(frozen=True)
class Effects:
    """The swing of a scene, and how far each uncertain input alone moves its period and precession.

    Attributes:
        own: the swing of the scene's own inputs.
        at_ends: the swings with one input at either end of its width, by the name of the input.
    """

    own: EstimatedSwing
    at_ends: Mapping[str, tuple[EstimatedSwing, EstimatedSwing]]

    def of_period(self, name: str) -> Effect:
        """Return how far an input moves the period, in s."""
        return _effect(_period(self.own), [_period(end) for end in self.at_ends[name]])

    def shares(self) -> dict[str, float]:
        """Return how much of what moves the period is due to each input; they add up to 1."""
        sizes = {name: self.of_period(name).size for name in self.at_ends}
        whole = sum(sizes.values())
        return {name: size / whole if whole else 0.0 for name, size in sizes.items()}

    def period_range(self) -> Effect:
        """Return how far all inputs together move the period, in s."""
        return _together([self.of_period(name) for name in self.at_ends], self.own.period_error_s)

    def precession_range(self) -> Effect | None:
        """Return how far all inputs together move the precession, in degrees an hour.

        None where one of the swings has none.
        """
        own = _precession(self.own)
        if own is None:
            return None
        effects = []
        for pair in self.at_ends.values():
            numbers = [_precession(end) for end in pair]
            with_value = [number for number in numbers if number is not None]
            if len(with_value) < len(numbers):
                return None
            effects.append(_effect(own, with_value))
        return _together(effects, own.error)


def estimated_effects(scene: Scene, widths: Mapping[str, str]) -> Effects:
    """Return how far uncertain inputs move period and precession, over the run or its first swings.

    Args:
        scene: the scene.
        widths: half of the width of each uncertain input, as decimals.

    Raises:
        UnreachableError: one of the pendulums does not swing to and fro, or double precision does
            not decide it.
    """
    base = first_swings(scene)
    at_ends = {}
    for name, width in widths.items():
        value = base.exact.by_name[name]
        half = Fraction(width)
        low = swing(base.with_values({name: decimal(value - half)}))
        high = swing(base.with_values({name: decimal(value + half)}))
        at_ends[name] = (low, high)
    return Effects(swing(base), at_ends)


def effects_document(scene: Scene, widths: Mapping[str, str]) -> dict[str, Any]:
    """Return the estimates in the form of --json, or why there are none.

    `limits`: how far each input alone moves the period, and its share. `first_order`: the ranges of
    period and precession, the effects of the inputs added.
    """
    try:
        effects = estimated_effects(scene, widths)
    except (FoucaultError, ArithmeticError) as error:
        limits = {name: dict.fromkeys(_OF_AN_INPUT) for name in widths}
        return {"limits": limits, "first_order": {}, "no_estimate": str(error)}

    shares = effects.shares()
    limits = {}
    for name in widths:
        effect = effects.of_period(name)
        numbers = (f"{effect.size:.3g}", f"{effect.error:.2g}", shares[name])
        limits[name] = dict(zip(_OF_AN_INPUT, numbers, strict=True))
    own = effects.own
    first_order = {"period_s": _range(own.period_s, effects.period_range())}
    precession = effects.precession_range()
    if precession is not None and own.precession_deg_per_h is not None:
        first_order["precession_deg_per_h"] = _range(own.precession_deg_per_h, precession)
    return {"estimated_over_s": own.over_s, "limits": limits, "first_order": first_order}


def _range(value: float, effect: Effect) -> list[str]:
    """Return the ends of the range of a number as text; its error widens it."""
    low = value + effect.low - effect.error
    high = value + effect.high + effect.error
    return list(ends(Fraction(low), Fraction(high)))


def _period(swing_: EstimatedSwing) -> _Number:
    return _Number(swing_.period_s, swing_.period_error_s)


def _precession(swing_: EstimatedSwing) -> _Number | None:
    if swing_.precession_deg_per_h is None:
        return None
    return _Number(swing_.precession_deg_per_h, swing_.precession_error_deg_per_h)


def _effect(own: _Number, at_ends: list[_Number]) -> Effect:
    """Return how far a number moves from its own value."""
    moves = [number.value - own.value for number in at_ends]
    error = own.error + max(number.error for number in at_ends)
    return Effect(min(0.0, *moves), max(0.0, *moves), error)


def _together(effects: list[Effect], error: float) -> Effect:
    """Return the sum of effects, of a number with an error of its own."""
    return Effect(
        sum(effect.low for effect in effects), sum(effect.high for effect in effects), error
    )
