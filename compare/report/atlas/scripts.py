"""The scripts of the atlas's pages: which there are, which of them workers are made of, and the data beside them."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from reference.scenes.shipped import data_root, in_checkout

from ..page import Html
from . import parts
from .emitted import emitted
from .emitted_claims import emitted_claims

EMITTED = "emitted.js"
CLAIMS = "claims.js"
_EMITTED = {EMITTED: emitted, CLAIMS: emitted_claims}
_EVALUATOR = "function.mjs"
# what the two workers are made of: of a scene's golden data, and of the motion that a page computes
_BOTH = ("reading.js", "judging.js", CLAIMS, "observing.js", "gravity.js", "answering.js")
_JUDGING = ("function.mjs", *_BOTH)
_SOLVING = (
    *_BOTH,
    EMITTED,
    "integrating.js",
    "leaving.js",
    "swinging.js",
    "solving.js",
    "describing.js",
)
WORKERS = {
    "judging": (*_JUDGING, "scene_worker.js"),
    "solving": (*_SOLVING, "pendulum_worker.js"),
}


def data(name: str, document: Mapping[str, Any]) -> Html:
    """Return an element with data for the scripts."""
    content = json.dumps(document, separators=(",", ":"), ensure_ascii=False, default=parts.plain)
    content = content.replace("<", "\\u003c")
    return Html(f'<script type="application/json" id="{name}">{content}</script>\n')


def scripts(workers: Sequence[str], names: Sequence[str]) -> Html:
    """Return the elements of scripts: those of workers, each with the workers' names as its classes, and others."""
    of_workers = dict.fromkeys(name for worker in workers for name in WORKERS[worker])
    elements = []
    for name in of_workers:
        classes = " ".join(worker for worker in workers if name in WORKERS[worker])
        elements.append(_element(name, classes))
    elements += [_element(name, "page") for name in names]
    return Html("".join(elements))


def _element(name: str, classes: str) -> str:
    return f'<script class="{classes}">\n{source(name)}</script>\n'


@cache
def source(name: str) -> str:
    """Return a style, a script or a part of a page.

    Of the program in docs/readers it is the function that evaluates.
    """
    if name in _EMITTED:
        return _EMITTED[name]()
    if name == _EVALUATOR:
        folder = data_root().parent / "docs" / "readers" if in_checkout() else files(__package__)
        program = folder.joinpath(name).read_text(encoding="utf-8")
        return str(
            re.findall(
                r"^// Return what.*?^export (function.*?^}\n)", program, re.MULTILINE | re.DOTALL
            )[0]
        )
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
