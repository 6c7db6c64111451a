"""How far uncertain inputs move period, precession and other numbers: estimates, from runs in double precision.

Each input alone is put at both ends of its width, the others as they are. Those of passages:
`estimated_passages`. Proofs: `proved`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import ROUND_FLOOR, Decimal
from fractions import Fraction
from typing import Any, NamedTuple

from ..dataset.ranges import ends
from ..errors import FoucaultError
from ..scenes.scene import Scene
from ..solver.uncertain import decimal
from ..sweeps.scene_swing import EstimatedSwing, first_swings, swing

_MOST_PLACES = 15  # after the point, of a range
# what is estimated of each input
_OF_AN_INPUT = ("moves_period_s", "moves_period_error_s", "share")


class Estimate(NamedTuple):
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

    @classmethod
    def of(cls, own: Estimate, at_ends: Iterable[Estimate]) -> Effect:
        """Return how far a number moves from its own value to those with an input at its ends."""
        at_ends = list(at_ends)
        moves = [number.value - own.value for number in at_ends]
        error = own.error + max(number.error for number in at_ends)
        return cls(min(0.0, *moves), max(0.0, *moves), error)

    @property
    def half_width(self) -> float:
        """Half of the way from the lower to the upper end."""
        return (self.high - self.low) / 2


@dataclass(frozen=True)
class Effects:
    """A number of a scene, and how far each uncertain input alone moves it.

    Attributes:
        own: the number for the scene's own inputs.
        by_input: the effects, by the name of the input.
    """

    own: Estimate
    by_input: Mapping[str, Effect]

    @property
    def together(self) -> Effect:
        """How far all inputs together move the number: their effects added, which is the worst case."""
        low = sum(effect.low for effect in self.by_input.values())
        high = sum(effect.high for effect in self.by_input.values())
        return Effect(low, high, self.own.error)

    @property
    def half_width(self) -> float:
        """Half of the width of the range in which all inputs together leave the number."""
        return self.together.half_width + self.own.error

    @property
    def shares(self) -> dict[str, float]:
        """How much of what moves the number is due to each input; they add up to 1."""
        whole = sum(effect.half_width for effect in self.by_input.values())
        return {
            name: effect.half_width / whole if whole else 0.0
            for name, effect in self.by_input.items()
        }

    @property
    def ends(self) -> list[str]:
        """The ends of this range as text, rounded outward, with the digits of `plus_minus`."""
        low, high = self.range
        return list(ends(Fraction(low), Fraction(high), _places((high - low) / 2)))

    @property
    def plus_minus(self) -> list[str]:
        """The middle and half of the width of this range as text, of two digits."""
        low, high = self.range
        return plus_minus(low, high)

    @property
    def range(self) -> tuple[float, float]:
        """The range in which all inputs together leave the number; its error widens it."""
        moved = self.together
        return self.own.value + moved.low - moved.error, self.own.value + moved.high + moved.error


def plus_minus(low: float, high: float) -> list[str]:
    """Return the middle of a range, and half of its width to two digits, or to the unit if that is less, as text."""
    middle = (low + high) / 2
    half_width = (high - low) / 2
    places = _places(half_width)
    return [f"{middle:.{places}f}", f"{half_width:.{places}f}"]


def _places(half_width: float) -> int:
    """Return the digits after the point with which half of a width has two digits, at most 15."""
    if not half_width > 0:
        return _MOST_PLACES
    # of what is printed: 0.0998 is 0.10
    printed = float(f"{half_width:.1e}")
    return min(max(0, 1 - math.floor(math.log10(printed))), _MOST_PLACES)


def rounded_down(number: float, digits: int) -> str:
    """Return a positive number as a decimal of some digits, rounded down."""
    exact = Decimal(number)
    last_place = exact.adjusted() - digits + 1
    floor = exact.quantize(Decimal(1).scaleb(last_place), ROUND_FLOOR)
    return f"{floor.normalize():f}"


class SwingEffects(NamedTuple):
    """The swing of a scene, and how far each uncertain input alone moves its period and precession.

    Attributes:
        own: the swing of the scene's own inputs.
        period: in s.
        precession: in degrees an hour; None where one of the swings has none.
    """

    own: EstimatedSwing
    period: Effects
    precession: Effects | None


def at_ends(scene: Scene, widths: Mapping[str, str]) -> dict[str, tuple[Scene, Scene]]:
    """Return the scene with each input alone at either end of its width, by the name of the input."""
    scenes = {}
    for name, width in widths.items():
        value = scene.exact.by_name[name]
        half = Fraction(width)
        low = scene.with_values({name: decimal(value - half)})
        high = scene.with_values({name: decimal(value + half)})
        scenes[name] = (low, high)
    return scenes


def swing_effects(scene: Scene, widths: Mapping[str, str]) -> SwingEffects:
    """Return how far uncertain inputs move period and precession, over the run or its first swings.

    Args:
        scene: the scene.
        widths: half of the width of each uncertain input, as decimals.

    Raises:
        UnreachableError: one of the pendulums does not swing to and fro, or double precision does
            not decide it.
    """
    base = first_swings(scene)
    own = swing(base)
    swings = {}
    for name, (low, high) in at_ends(base, widths).items():
        swings[name] = (swing(low), swing(high))

    periods = {name: Effect.of(_period(own), map(_period, pair)) for name, pair in swings.items()}
    period = Effects(_period(own), periods)
    if any(one.precession_deg_per_h is None for pair in [(own,), *swings.values()] for one in pair):
        return SwingEffects(own, period, None)
    turns = {
        name: Effect.of(_precession(own), map(_precession, pair)) for name, pair in swings.items()
    }
    return SwingEffects(own, period, Effects(_precession(own), turns))


def effects_document(scene: Scene, widths: Mapping[str, str]) -> dict[str, Any]:
    """Return the estimates in the form of --json, or why there are none.

    `limits`: how far each input alone moves the period, and its share. `first_order`: the ranges of
    period and precession, the effects of the inputs added; `first_order_plus_minus`: the middle and
    half of the width of each, and of the full turn.
    """
    try:
        effects = swing_effects(scene, widths)
    except (FoucaultError, ArithmeticError) as error:
        limits = {name: dict.fromkeys(_OF_AN_INPUT) for name in widths}
        return {
            "limits": limits,
            "first_order": {},
            "first_order_plus_minus": {},
            "no_estimate": str(error),
        }

    numbers = {"period_s": effects.period}
    if effects.precession is not None:
        numbers["precession_deg_per_h"] = effects.precession
    middles = {name: number.plus_minus for name, number in numbers.items()}
    if effects.precession is not None and effects.own.full_turn_h is not None:
        turn = _full_turn(effects.precession)
        if turn:
            middles["full_turn_h"] = turn
    return {
        "estimated_over_s": effects.own.over_s,
        "limits": limits_document(effects.period, _OF_AN_INPUT),
        "first_order": {name: number.ends for name, number in numbers.items()},
        "first_order_plus_minus": middles,
    }


def limits_document(effects: Effects, keys: tuple[str, str, str]) -> dict[str, dict[str, Any]]:
    """Return how far each input alone moves a number, the error of that and its share, by these keys."""
    shares = effects.shares
    limits = {}
    for name, effect in effects.by_input.items():
        numbers = (f"{effect.half_width:.3g}", f"{effect.error:.2g}", shares[name])
        limits[name] = dict(zip(keys, numbers, strict=True))
    return limits


def _full_turn(precession: Effects) -> list[str] | None:
    """Return the middle and half of the width of the range of the full turn in hours.

    None if the plane may stand still.
    """
    low, high = precession.range
    if low <= 0 <= high:
        return None
    return plus_minus(*sorted(360 / abs(rate) for rate in (low, high)))


def _period(swing_: EstimatedSwing) -> Estimate:
    return Estimate(swing_.period_s, swing_.period_error_s)


def _precession(swing_: EstimatedSwing) -> Estimate:
    assert swing_.precession_deg_per_h is not None
    return Estimate(swing_.precession_deg_per_h, swing_.precession_error_deg_per_h)
