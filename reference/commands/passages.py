"""Passages of sections for `foucault show`: which were requested, and their times.

Where inputs are uncertain see `proved`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from ..errors import FoucaultError, InputError
from ..numbers.precision import digits_that_hold
from ..numbers.zeros import XDOT
from ..scenes.scene import Scene, checked_value
from ..scenes.texts import without_sign
from ..solver.ranges import Ranges
from ..solver.swing import Ends
from .layout import Fact

LOWEST = "lowest"
_FIRST = 3  # passages that are printed if no numbers are asked for
_DIGITS = 12
MORE_SWINGS = 4  # after the one that a passage is expected in


@dataclass(frozen=True)
class Asked:
    """A requested passage: its number, and the half-width in s that its interval should have.

    The width is None if none was asked for.
    """

    number: int
    width_s: Fraction | None = None


def asked_passages(words: Sequence[str] | None) -> list[Asked]:
    """Return the passages that `--passage` asks for; without it the first three.

    Raises:
        InputError: a word is neither a number from 1 on nor NUMBER=±WIDTH.
    """
    if not words:
        return [Asked(number) for number in range(1, _FIRST + 1)]
    return [_asked(word) for word in words]


def _asked(word: str) -> Asked:
    expected = "the number of a passage, such as 50, or with half the wanted width in s, 50=±0.1"
    number, sign, width = word.partition("=")
    if not number.strip().isdecimal() or int(number) < 1:
        raise InputError("--passage", word, expected)
    if not sign:
        return Asked(int(number))
    try:
        # any field that takes a decimal checks its form
        wanted = Fraction(checked_value("site.altitude", without_sign(width), "decimal"))
    except InputError:
        raise InputError("--passage", word, expected) from None
    if wanted <= 0:
        raise InputError("--passage", word, expected, "Give a width above 0.")
    return Asked(int(number), wanted)


def section_words(scene: Scene) -> tuple[str, ...]:
    """Return the sections whose passages are printed: the scene's, or else its transits."""
    return scene.run.sections or (XDOT,)


def passage_interval(ranges: Ranges, word: str, number: int) -> Ends | str:
    """Return the interval of the time of a passage, or why there is none."""
    zeros = ranges.zeros.get(word)
    if zeros is None:
        return "the bob stays in the section"
    times = zeros.table.exact("t")
    if any(low < time[0] for low, _, _ in zeros.possible for time in times[number - 1 : number]):
        return "an earlier one is not decided, so that its number is open"
    if number > len(times):
        reach = f"{float(ranges.scene.run.t_end):.4g} s"
        decided = f"only the first {len(times)} are" if times else "no passage is"
        if zeros.possible:
            return f"{decided} decided, though the motion is proved up to {reach}"
        return f"{decided} sure to come in the {reach} that are proved"
    return Ends(*times[number - 1])


def passage_name(word: str, number: int) -> str:
    """Return the name of a passage."""
    if word == XDOT:
        return f"transit {number} (turning point in x)"
    return f"passage {number} of {word}"


def computed_passages(
    scene: Scene, asked: Sequence[Asked], period_s: float | None, digits: int = _DIGITS
) -> list[dict[str, Any]]:
    """Return passages of a scene with exact inputs, each with its time and an estimate of its error.

    Args:
        scene: the scene.
        asked: the passages of each of its sections.
        period_s: of a swing; None if there is none, and the whole run is solved.
        digits: of the run.
    """
    from ..solver.solve import solve

    t_end = scene.run.t_end
    if period_s is not None:
        # a section is passed once in a swing, or twice
        last = max(one.number for one in asked)
        until_s = (last + MORE_SWINGS) * period_s
        if until_s < float(t_end):
            t_end = f"{until_s:.6g}"
    settings = {"run.transits": "true", "run.t_end": t_end, "run.grid_step": t_end}
    try:
        solution = solve(scene.with_values(settings), level="self_consistent", digits=digits)
    except FoucaultError as error:
        return [{"section": word, "reason": str(error)} for word in section_words(scene)]
    return [
        _computed(solution.zeros.get(word), word, one.number)
        for word in section_words(scene)
        for one in asked
    ]


def _computed(zeros: Any, word: str, number: int) -> dict[str, Any]:
    """Return a passage in the form of --json."""
    passage: dict[str, Any] = {"section": word, "number": number}
    if zeros is None:
        return passage | {"reason": "the bob stays in the section"}
    count = len(zeros.table)
    if number > count:
        return passage | {"reason": f"the run has {count}"}
    t_s = float(zeros.table.exact("t")[number - 1])
    error_s = float(zeros.table.bound("t")[number - 1])
    return passage | {"t_s": t_s, "t_error_s": error_s + math.ulp(t_s)}


def passage_facts(passages: Sequence[dict[str, Any]]) -> Iterator[Fact]:
    """Yield passages, to the digits that their errors justify."""
    for passage in passages:
        word = passage["section"]
        if "number" not in passage:
            yield word, f"not computed: {passage['reason']}"
        elif "reason" in passage:
            yield passage_name(word, passage["number"]), f"none: {passage['reason']}"
        else:
            digits = digits_that_hold(passage["t_s"], passage["t_error_s"])
            yield passage_name(word, passage["number"]), f"{digits} s"
