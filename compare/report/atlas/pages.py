"""The atlas of a folder: pages for any pendulum, over all scenes, and for each scene; they judge a dropped file."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from string import Template
from typing import Any

from reference.errors import counted
from reference.scenes.fields import LEVELS

from ..drawing import check_matplotlib
from ..folder import PAGE, check_folder, write_files
from ..motion import PicturedMotion
from ..motion_pictures import motion_svgs, thumbnail
from ..page import Html, page, paragraph, section, text
from . import parts
from .entry import Entry, entries
from .form import fields, form_words, texts_of
from .pendulum_page import pendulum_page
from .scripts import data, scripts, source

SCENES = "scenes.html"
_MOST_EMBEDDED = 500_000  # characters of coefficients in a page; more are in a script beside it
_PLAIN = "Begin here: pendulums as they hang"  # scenes without flags, but for a long run
# and the others: each stands in the first group that has one of its flags, or in the last
_GROUPS = {
    "Wide swings, and over the top": {"large_angle"},
    "Drag": {"damped", "stiff"},
    "Fast rotation, no gravity": {"fast_rotation", "weightless"},
    "Very small and very large": {"scale", "tiny_amplitude", "at_rest"},
    "Special places and releases": set[str](),
}


def scenes_page(scenes: Sequence[Entry], thumbs: Sequence[str]) -> str:
    """Return the page over all scenes, sorted by id: a thumbnail of each, in groups."""
    cards: dict[str, list[str]] = {name: [] for name in (_PLAIN, *_GROUPS)}
    for entry, thumb in zip(scenes, thumbs, strict=True):
        cards[_group(entry)].append(_card(entry, thumb))
    sections = [
        section(name, Html(f'<div class="thumbs">\n{chr(10).join(of)}\n</div>'))
        for name, of in cards.items()
        if of
    ]
    return page(
        "Atlas of the Foucault pendulum",
        [_filters(scenes), *sections],
        lead=_lead_of_scenes(scenes),
        script=scripts([], ["filtering.js"]),
        styles=source("atlas.css"),
    )


def _lead_of_scenes(scenes: Sequence[Entry]) -> Html:
    """Return the introduction of the page over all scenes."""
    datasets = sum(len(entry.datasets) for entry in scenes)
    about = paragraph(
        f"{counted(len(scenes), 'scene')} and {counted(datasets, 'golden dataset')}. The page of a scene "
        "says what it catches and the evidence for its numbers, judges your program's output in the browser, and "
        "plays the motion."
    )
    return Html(f'{about}\n<p><a href="{PAGE}">Any pendulum: type your own</a></p>')


def _group(entry: Entry) -> str:
    flags = {*entry.flags} - {"long"}
    return (
        next((name for name, group in _GROUPS.items() if flags & group), [*_GROUPS][-1])
        if flags
        else _PLAIN
    )


def scene_page(
    entry: Entry,
    svgs: Sequence[str],
    base: str,
    function: dict[str, Any] | None,
    beside: str | None,
) -> str:
    """Return the page of a scene, which holds its golden rows and judges a file by them.

    Args:
        entry: the scene.
        svgs: its pictures.
        base: where the datasets' folders stand, as a URL or a path; empty for no links to files.
        function: the golden function, None if it has none.
        beside: the file beside the page that holds the function; None if the page itself does.
    """
    motion = [Html(source("player.html")), parts.pictures(svgs)]
    first, *further = entry.datasets
    datasets = [parts.dataset(first, base)]
    for golden in further:
        heading = f"<h3>{text(golden.manifest.id)}</h3>"
        datasets.append(Html(f"{heading}\n{parts.dataset(golden, base)}"))
    sections = [
        section("The motion", *motion),
        section("Judge your program", _drop(entry, function, beside)),
        section("The state at the end", parts.state(entry.golden)),
        section("The dataset", *datasets),
    ]
    tables = parts.methods(entry.studied)
    if tables:
        sentence = paragraph(entry.studied.sentence())
        sections.append(section("How methods fare", sentence, *tables))
    units = paragraph("SI units, angles in degrees.")
    sections.append(section("Inputs", units, parts.inputs(entry.golden)))

    embedded = None if beside else function
    page_data = parts.page_data(entry.judged, embedded, beside)
    workers = ["judging"]
    if embedded is None:
        # the page computes what it plays
        page_data["pendulum"] = {
            "texts": texts_of(entry.judged.scene),
            "fields": fields(),
            "words": form_words(),
        }
        workers.append("solving")
    of_page = ("drawing.js", "showing.js", "starting.js", "playing.js", "dropping.js")
    return page(
        entry.id,
        sections,
        lead=_lead(entry),
        script=Html(data("truth", page_data) + scripts(workers, of_page)),
        styles=source("atlas.css"),
    )


def _lead(entry: Entry) -> Html:
    """Return what is said of a scene below its name."""
    manifest = entry.golden.manifest
    title = paragraph(f"{manifest.title.rstrip('.')}.")
    links = f'<p><a href="{SCENES}">All scenes</a> · <a href="{PAGE}">Any pendulum</a> · {text(manifest.source)}</p>'
    return Html(f"{title}\n{parts.flags(entry)}\n{links}")


def _card(entry: Entry, thumb: str) -> str:
    levels = " ".join(golden.manifest.level for golden in entry.datasets)
    about = entry.golden.manifest.title.partition(":")[0]
    return (
        f'<a class="card" id="{text(entry.id)}" href="{text(entry.id)}.html" '
        f'data-flags="{text(" ".join(entry.flags))}" data-levels="{levels}">'
        f"{thumb}<strong>{text(entry.id)}</strong> {text(about)}</a>"
    )


def _filters(scenes: Sequence[Entry]) -> Html:
    flags = sorted({flag for entry in scenes for flag in entry.flags})
    present = {golden.manifest.level for entry in scenes for golden in entry.datasets}
    levels = [level for level in LEVELS if level in present]
    return Html(
        f'<form class="filters" hidden>\n{_choice("flag", flags)}\n{_choice("level", levels)}\n'
        '<output id="count"></output>\n</form>'
    )


def _choice(name: str, words: Iterable[str]) -> str:
    options = "".join(
        f'<option value="{text(word)}">{text(word.replace("_", " "))}</option>' for word in words
    )
    return (
        f'<label>{name} <select id="{name}"><option value="">any</option>{options}</select></label>'
    )


def _drop(entry: Entry, function: dict[str, Any] | None, beside: str | None) -> Html:
    golden = entry.judged
    times = ", ".join(f"{t:.15g}" for t in golden.t[:3])
    transits = ""
    if golden.manifest.counts.transits:
        transits = " A second file with the times of xdot = 0 in a column t has your transits judged as well."
    rows = f"a row for {times} … s, or for some of them"
    known = "the golden rows alone: the dataset has no golden function"
    if function:
        rows = f"rows at any times up to {golden.t[-1]:.15g} s"
        bounds = ", ".join(
            f"{name} within {function['record']['bounds'][name]} m" for name in ("x", "y", "z")
        )
        known = f"the golden function, which has {bounds} of the truth at every time (proven)"
    if function and beside:
        size = f"{len(function['coefficients']) / 1e6:.1f} MB"
        known += f"; its {size} are in {beside} beside this page, read with the first file"
    words = {"rows": rows, "transits": transits, "known": known, "command": entry.score_command()}
    return Html(
        Template(source("drop.html").rstrip()).substitute(
            {name: text(word) for name, word in words.items()}
        )
    )


def build(
    data: Path, out: Path, studies: Path | None, base: str, report: Callable[[int, int, str], None]
) -> dict[str, int]:
    """Write a page for any pendulum, one over all datasets of a folder, and one for each scene.

    Args:
        data: the folder of the datasets.
        out: the folder of the pages; created if it does not exist.
        studies: a folder of results of studies, or None.
        base: where the files of the datasets can be had, as a URL or a path; empty for no links.
        report: called with the number of scenes done, of all, and the one at work.

    Returns:
        The size of each page in bytes, by name.

    Raises:
        InputError: there are no datasets, the folder belongs to somebody else, or matplotlib is
            missing.
        DatasetError: a dataset is damaged.
    """
    check_matplotlib("foucault atlas")
    check_folder(out, [PAGE])
    scenes = entries(data, studies)
    check_folder(out, [SCENES, *(f"{entry.id}.html" for entry in scenes)])
    pages = {}
    thumbs = []
    for count, entry in enumerate(scenes):
        report(count, len(scenes), entry.id)
        motion = PicturedMotion.of_golden(entry.golden)
        function = parts.golden_function(entry.judged)
        beside = None
        if function and len(function["coefficients"]) > _MOST_EMBEDDED:
            beside = f"{entry.id}.function.js"
            numbers = json.dumps(function, separators=(",", ":"))
            pages[beside] = f"globalThis.goldenFunction = {numbers};\n"
        pages[f"{entry.id}.html"] = scene_page(entry, motion_svgs(motion), base, function, beside)
        thumbs.append(thumbnail(motion))
    pages[SCENES] = scenes_page(scenes, thumbs)
    pages[PAGE] = pendulum_page(SCENES)
    write_files(out, pages)
    report(len(scenes), len(scenes), PAGE)
    return {name: len(content.encode()) for name, content in pages.items()}
