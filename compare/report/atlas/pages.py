"""The atlas of a folder: a page over all scenes, with a filter, and one for each, which judges a dropped file."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path

from reference.scenes.fields import LEVELS

from ..charts.drawing import check_matplotlib
from ..charts.motion_pictures import motion_svgs
from ..folder import PAGE, check_folder, write_files
from ..motion import Motion
from ..page import Html, facts, page, paragraph, section, text
from . import parts
from .entry import Entry, entries

SHOWN = ("level", "behind it", "bounds", "transits")  # on the page over all scenes


def index_page(scenes: Sequence[Entry], svgs: Sequence[Sequence[str]], base: str) -> str:
    """Return the page over all scenes.

    Args:
        scenes: sorted by id.
        svgs: the pictures of each.
        base: where the datasets' folders stand, as a URL or a path; empty for no links to files.
    """
    cards = [_card(entry, pictures, base) for entry, pictures in zip(scenes, svgs, strict=True)]
    datasets = sum(len(entry.datasets) for entry in scenes)
    return page(
        "Atlas of the Foucault pendulum",
        [section("Scenes", _jumps(scenes), _filters(scenes), Html("\n".join(cards)))],
        lead=paragraph(
            f"{scenes_of(len(scenes))} and {datasets} golden datasets: what each catches, how the bob moves, the state "
            "at the end with a bound on every number, and what stands behind it. The page of a scene judges the output "
            "of your program in the browser."
        ),
        script=_script("filtering.js"),
        styles=_text("atlas.css"),
    )


def scene_page(entry: Entry, svgs: Sequence[str], base: str) -> str:
    """Return the page of a scene, which holds its golden rows and judges a file by them."""
    first, *others = entry.datasets
    fared = parts.methods(entry.studied)
    readings = [Html(f"<h3>{text(golden.manifest.id)}</h3>\n{parts.dataset(golden, base)}") for golden in others]
    return page(
        entry.id,
        [
            section("The motion", parts.pictures(svgs)),
            section("Judge your program", _drop(entry)),
            section("The state at the end", parts.state(entry.golden)),
            section("The dataset", parts.dataset(first, base), *readings),
            *([section("How methods fare", *fared)] if fared else []),
            section("Inputs", paragraph("SI units, angles in degrees."), parts.inputs(entry.golden)),
        ],
        lead=Html(
            f"{paragraph(_sentence(entry))}\n{parts.flags(entry)}\n"
            f'<p><a href="index.html">All scenes</a> · {text(entry.golden.manifest.source)}</p>'
        ),
        script=_truth(entry) + _script("reading.js", "judging.js", "drawing.js", "dropping.js"),
        styles=_text("atlas.css"),
    )


def scenes_of(count: int) -> str:
    """Return how many scenes there are, in words."""
    return f"{count} scene{'' if count == 1 else 's'}"


def _sentence(entry: Entry) -> str:
    return f"{entry.golden.manifest.title.rstrip('.')}."


def _card(entry: Entry, svgs: Sequence[str], base: str) -> Html:
    manifest, trust = entry.golden.manifest, parts.trust(entry.golden)
    shown = {name: trust[name] for name in SHOWN}
    of_files = [
        " ".join(parts.linked(golden, name, base) for name in golden.manifest.files) for golden in entry.datasets
    ]
    shown |= {
        f"files of {golden.manifest.id}": Html(names) for golden, names in zip(entry.datasets, of_files, strict=True)
    }
    shown["to score"] = Html(
        f"<code>{text(entry.score_command())}</code>, or drop a file on {_link(entry, 'its page')}"
    )
    if entry.studied.sentence():
        shown["methods"] = entry.studied.sentence()
    levels = " ".join(golden.manifest.level for golden in entry.datasets)
    return Html(
        f'<article class="card" id="{text(entry.id)}" data-flags="{text(" ".join(entry.flags))}" '
        f'data-levels="{levels}">\n<div class="head">\n'
        f'<h3>{_link(entry, entry.id)} <span class="level">{manifest.level}</span></h3>\n'
        f"{paragraph(_sentence(entry))}\n{parts.flags(entry)}\n{parts.pictures(svgs)}\n</div>\n"
        f'<div class="told">\n{parts.state(entry.golden)}\n{facts(shown)}\n</div>\n</article>'
    )


def _link(entry: Entry, words: str) -> Html:
    return Html(f'<a href="{text(entry.id)}.html">{text(words)}</a>')


def _jumps(scenes: Sequence[Entry]) -> Html:
    links = "\n".join(f'<a href="#{text(entry.id)}">{text(entry.id)}</a>' for entry in scenes)
    return Html(f'<p class="jumps">\n{links}\n</p>')


def _filters(scenes: Sequence[Entry]) -> Html:
    flags = sorted({flag for entry in scenes for flag in entry.flags})
    levels = [
        level
        for level in LEVELS
        if any(level == golden.manifest.level for entry in scenes for golden in entry.datasets)
    ]
    return Html(
        f'<form class="filters" hidden>\n{_choice("flag", flags)}\n{_choice("level", levels)}\n'
        '<output id="count"></output>\n</form>'
    )


def _choice(name: str, words: Iterable[str]) -> str:
    options = "".join(f'<option value="{text(word)}">{text(word.replace("_", " "))}</option>' for word in words)
    return f'<label>{name} <select id="{name}"><option value="">any</option>{options}</select></label>'


def _drop(entry: Entry) -> Html:
    golden, command = entry.judged, text(entry.score_command())
    times = ", ".join(golden.decimals("t")[:3])
    transits = (
        " A second file with the times of xdot = 0 in a column t has your transits judged as well."
        if golden.manifest.counts.transits
        else ""
    )
    return Html(
        '<div id="drop">\n<p><label>Drop the output of your program here, or choose it: '
        '<input type="file" id="files" multiple></label></p>\n'
        '<p><label>Tolerance in m <input id="tolerance" size="9" inputmode="decimal"></label></p>\n</div>\n'
        '<div id="verdict" aria-live="polite"><noscript>Without JavaScript: use the command below.</noscript></div>\n'
        f"<p>Wanted is text with a header <code>t,x,y</code>, and any of <code>z,vx,vy,vz</code>, and a row for the "
        f"golden times {text(times)} … s, or for some of them. Axes x east, y north, z up from the suspension, in SI "
        f"units; other units and names are understood.{text(transits)} The file stays on this computer: the page has "
        "the golden rows in it. On the command line, at any times and with the likely mistake: "
        f"<code>{command}</code></p>"
    )


def _truth(entry: Entry) -> Html:
    document = parts.embedded(entry.judged)
    content = json.dumps(document, separators=(",", ":"), ensure_ascii=False, default=parts.plain).replace(
        "<", "\\u003c"
    )
    return Html(f'<script type="application/json" id="truth">{content}</script>\n')


def _script(*names: str) -> Html:
    return Html("".join(f"<script>\n{_text(name)}</script>\n" for name in names))


@cache
def _text(name: str) -> str:
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
        InputError: there are no datasets, the folder belongs to somebody else, or matplotlib is missing.
        DatasetError: a dataset is damaged.
    """
    check_matplotlib("foucault atlas")
    check_folder(out, [PAGE])
    scenes = entries(data, studies)
    check_folder(out, [f"{entry.id}.html" for entry in scenes])
    pages, svgs = {}, []
    for count, entry in enumerate(scenes):
        report(count, len(scenes), entry.id)
        svgs.append(motion_svgs(Motion.of_golden(entry.golden)))
        pages[f"{entry.id}.html"] = scene_page(entry, svgs[-1], base)
    pages[PAGE] = index_page(scenes, svgs, base)
    write_files(out, pages)
    report(len(scenes), len(scenes), PAGE)
    return {name: len(content.encode()) for name, content in pages.items()}
