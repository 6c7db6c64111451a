"""The atlas of a folder: a page over all scenes, with a filter, and one for each, which judges a dropped file."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

from reference.errors import counted
from reference.scenes.fields import LEVELS
from reference.scenes.shipped import data_root, in_checkout

from ..drawing import check_matplotlib
from ..folder import PAGE, check_folder, write_files
from ..motion import PicturedMotion
from ..motion_pictures import motion_svgs, thumbnail
from ..page import Html, page, paragraph, section, text
from . import parts
from .entry import Entry, entries

_EVALUATOR = "function.mjs"
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


def index_page(scenes: Sequence[Entry], thumbs: Sequence[str]) -> str:
    """Return the page over all scenes, sorted by id: a thumbnail of each, in groups."""
    cards: dict[str, list[str]] = {name: [] for name in (_PLAIN, *_GROUPS)}
    for entry, thumb in zip(scenes, thumbs, strict=True):
        cards[_group(entry)].append(_card(entry, thumb))
    datasets = sum(len(entry.datasets) for entry in scenes)
    sections = [
        section(name, Html(f'<div class="thumbs">\n{chr(10).join(of)}\n</div>'))
        for name, of in cards.items()
        if of
    ]
    return page(
        "Atlas of the Foucault pendulum",
        [_filters(scenes), *sections],
        lead=paragraph(
            f"{counted(len(scenes), 'scene')} and {datasets} golden datasets. The page of a scene "
            "says what it catches and the evidence for its numbers, judges your program's output in the browser, and "
            "plays the motion where the scene has a golden function."
        ),
        script=_script("filtering.js"),
        styles=source("atlas.css"),
    )


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
    motion = [parts.pictures(svgs)]
    if function:
        motion.insert(0, Html(source("player.html")))
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

    page_data = parts.page_data(entry.judged, None if beside else function, beside)
    judging = _script("function.mjs", "reading.js", "judging.js", "answering.js", kind="judging")
    drawing = _script("drawing.js", "dropping.js", "playing.js")
    return page(
        entry.id,
        sections,
        lead=_lead(entry),
        script=Html(_data(page_data) + judging + drawing),
        styles=source("atlas.css"),
    )


def _lead(entry: Entry) -> Html:
    """Return what is said of a scene below its name."""
    manifest = entry.golden.manifest
    title = paragraph(f"{manifest.title.rstrip('.')}.")
    links = f'<p><a href="index.html">All scenes</a> · {text(manifest.source)}</p>'
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
        known += f"; its {size} are in {beside} beside this page, read with the first file or at the first play"
    words = {"rows": rows, "transits": transits, "known": known, "command": entry.score_command()}
    return Html(
        Template(source("drop.html").rstrip()).substitute(
            {name: text(word) for name, word in words.items()}
        )
    )


def _data(document: dict[str, Any]) -> Html:
    content = json.dumps(document, separators=(",", ":"), ensure_ascii=False, default=parts.plain)
    content = content.replace("<", "\\u003c")
    return Html(f'<script type="application/json" id="truth">{content}</script>\n')


def _script(*names: str, kind: str = "page") -> Html:
    return Html("".join(f'<script class="{kind}">\n{source(name)}</script>\n' for name in names))


@cache
def source(name: str) -> str:
    """Return a style, a script or a part of a page.

    Of the program in docs/readers it is the function that evaluates.
    """
    if name == _EVALUATOR:
        folder = data_root().parent / "docs" / "readers" if in_checkout() else files(__package__)
        program = folder.joinpath(name).read_text(encoding="utf-8")
        return str(
            re.findall(
                r"^// Return what.*?^export (function.*?^}\n)", program, re.MULTILINE | re.DOTALL
            )[0]
        )
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def build(
    data: Path, out: Path, studies: Path | None, base: str, report: Callable[[int, int, str], None]
) -> dict[str, int]:
    """Write a page over all datasets of a folder, and one for each scene.

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
    check_folder(out, [f"{entry.id}.html" for entry in scenes])
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
    pages[PAGE] = index_page(scenes, thumbs)
    write_files(out, pages)
    report(len(scenes), len(scenes), PAGE)
    return {name: len(content.encode()) for name, content in pages.items()}
