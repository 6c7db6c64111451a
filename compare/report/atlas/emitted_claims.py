"""JavaScript that is emitted from the diagnosis: the thresholds of a claim, and the sentences that the page says too.

The page tries few causes. What it says of them, and when, is decided in `compare.diagnosis` only.
"""

from __future__ import annotations

import json
import re
from functools import cache
from typing import get_args

from reference.scenes.inputs import GravityIs

from ...candidates.candidate import Deviation
from ...diagnosis import ADDED_TWICE, CLOCK, EFFECTIVE, THRESHOLDS, advice_on, hedged
from .form import LEGENDS

_PLACE = LEGENDS["site"]
# what is said of a program whose g has a meaning that the form does not say, and what to do about it
_SAID_OF_G = {"effective": EFFECTIVE, "ellipsoid": ADDED_TWICE}
_ADVICE_ON_G = {
    "effective": [advice_on("effective_gravity")],
    "ellipsoid": [
        advice_on("ellipsoid_gravity"),
        f"If your g is gravity alone, choose ellipsoid under {_PLACE}.",
    ],
}


@cache
def emitted_claims() -> str:
    """Return the thresholds and the sentences as constants in JavaScript."""
    sentences = {"CLOCK_SAID": CLOCK, "LIKE_ONE_THAT": _hedge(), "MEANINGS_OF_G": _meanings_of_g()}
    lines = [
        f"const {name} = {json.dumps(value, ensure_ascii=False)};"
        for name, value in (THRESHOLDS | sentences).items()
    ]
    return "\n".join(
        ["// Emitted from compare/diagnosis by emitted_claims.py.", '"use strict";\n', *lines, ""]
    )


def _hedge() -> str:
    """Return what stands before a cause that a motion is merely like."""
    return hedged(Deviation("", "", stage="gravity")).text


def _meanings_of_g() -> dict[str, dict[str, str]]:
    """Return for each meaning that a program's g may have the other one, what is said of it, and the advice."""
    meanings = {}
    for meaning in get_args(GravityIs):
        (other,) = {*get_args(GravityIs)} - {meaning}
        statement, _, _ = _SAID_OF_G[meaning].partition(" (--set")
        advice = " ".join(map(_on_the_page, _ADVICE_ON_G[meaning]))
        meanings[meaning] = {"other": other, "said": statement, "advice": advice}
    return meanings


def _on_the_page(sentence: str) -> str:
    """Return an advice with the choice of the form, and a number, in place of a command's option and answer."""
    chosen = re.sub(r"say `--set site\.gravity_is=(\w+)`", rf"choose \1 under {_PLACE}", sentence)
    return re.sub(r"q is (.*?) \(`foucault show` prints it\)", r"q = {axis} m is \1", chosen)
