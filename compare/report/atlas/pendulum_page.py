"""The page for any pendulum: its form, its motion, the judge of a dropped file, and what can be kept."""

from __future__ import annotations

from string import Template

from ..page import Html, page, paragraph, section
from . import parts
from .form import fields, form, form_words, options, presets
from .paste import printing
from .scripts import data, scripts, source

_LEAD = (
    "Type your pendulum, see how it must move, drop what your program printed, and send the link. "
    "Nothing is uploaded: the page computes everything itself."
)
_SCRIPTS = ("drawing.js", "showing.js", "starting.js", "playing.js", "asking.js")


def pendulum_page(scenes: str) -> str:
    """Return the page for any pendulum; `scenes` is the name of the page over all scenes."""
    known = presets()
    asked = Template(source("pendulum.html")).substitute(
        options=options(known), player=source("player.html").rstrip(), form=form()
    )
    judge = Template(source("judge.html").rstrip()).substitute(printing=printing())
    sections = [
        section("Your pendulum", Html(asked)),
        section("Judge your program", Html(judge)),
        section("Keep it", Html(source("keep.html").rstrip())),
    ]
    document = {
        "fields": fields(),
        "presets": known,
        "words": parts.vocabulary() | form_words(),
    }
    lead = f'{paragraph(_LEAD)}\n<p><a href="{scenes}">All scenes with golden data</a></p>'
    return page(
        "Any Foucault pendulum",
        sections,
        lead=Html(lead),
        script=Html(data("known", document) + scripts(["solving"], _SCRIPTS)),
        styles=source("atlas.css") + source("pendulum.css"),
    )
