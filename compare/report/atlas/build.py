"""Make the atlas of a folder of datasets: an overview, and a page of each scene."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ..charts.drawing import check_matplotlib
from ..charts.motion_pictures import motion_svgs
from ..folder import PAGE, check_folder, write_files
from ..motion import Motion
from .entry import entries
from .pages import index_page, scene_page
from .studied import StudyResults, kept_studies


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
    scenes, kept = entries(data), kept_studies(studies)
    check_folder(out, [f"{one.id}.html" for one in scenes])
    pages, svgs = {}, []
    for count, one in enumerate(scenes):
        report(count, len(scenes), one.id)
        own = motion_svgs(Motion.of_golden(one.golden))
        svgs.append(own)
        pages[f"{one.id}.html"] = scene_page(one, own, kept.get(one.id, StudyResults()), base)
    pages[PAGE] = index_page(scenes, svgs, kept, base)
    write_files(out, pages)
    report(len(scenes), len(scenes), PAGE)
    return {name: len(content.encode()) for name, content in pages.items()}
