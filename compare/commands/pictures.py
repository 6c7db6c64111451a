"""`foucault plot` and `foucault atlas`: pictures of a motion, and pages over all golden datasets."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reference import InputError, load_scene, scene_ids
from reference.commands.progress import progress
from reference.commands.terminal import (
    AsJson,
    Assignments,
    EndTime,
    chosen,
    completion,
    emit,
    option,
    refuse,
    replacements,
    stoppable,
)
from reference.errors import counted, in_words
from reference.scenes.shipped import golden_root, seals

from .options import announce, completion_of_lists, listed

if TYPE_CHECKING:
    from ..report.motion import PicturedMotion

PICTURES = ("path", "sphere", "plane", "transits")
SOURCE = typer.Argument(
    metavar="SCENE|DATASET|FILE",
    help="A scene, a dataset, or the file of a program's output; - is stdin.",
    autocompletion=completion(lambda: {*scene_ids(), *seals()}),
)
OUT = option(
    "--out", "The picture: .svg, .png or .pdf (default: the source's name with .svg).", "FILE"
)
WHAT = option(
    "--what",
    f"Which of {', '.join(PICTURES)} to draw, side by side (default: all available).",
    "A,B,…",
    names=completion_of_lists(lambda: PICTURES),
)
PAGES = option("--out", "Write the pages into this folder (extra plot).", "DIR")
DATA = option("--data", "The folder of the datasets (default: the shipped ones).", "DIR")
STUDIES = option(
    "--studies",
    "Results of `foucault study` and `stability`, as JSON (default: docs/studies in a checkout).",
    "DIR",
)
FILES = option("--files", "Link files to URL/DATASET/FILE (default: no links).", "URL")


def plot(
    source: Annotated[str, SOURCE],
    out: Annotated[Path | None, OUT] = None,
    what: Annotated[str | None, WHAT] = None,
    t_end: EndTime = None,
    set_: Assignments = None,
) -> None:
    """Draw a motion: path, swing plane, transits.

    A scene without a dataset is solved first. For a file, path and swing plane are drawn.
    """
    from ..report.drawing import check_target
    from ..report.folder import write_file
    from ..report.motion_pictures import motion_picture, panels

    requested = listed(what, "--what")
    for word in requested or ():
        chosen("--what", word, PICTURES)
    target = out or Path(f"{'stdin' if source == '-' else Path(source).stem}.svg")
    check_target(target, "--out")
    motion = _motion(source, t_end, set_)
    available = list(panels(motion))
    missing = next((word for word in requested or () if word not in available), None)
    if missing is not None:
        raise InputError("--what", missing, f"a picture of {source}: {in_words(available)}")
    write_file(target, motion_picture(motion, requested or available, target), "--out")
    typer.echo(f"{target}: the picture")


def _motion(source: str, t_end: str | None, assignments: list[str] | None) -> PicturedMotion:
    """Return the motion of a dataset if the word means one, of a file, or else of a scene."""
    from reference.dataset.place import golden_folder

    from ..candidates.read import read
    from ..report.plot import motion_of

    changed = {"--t-end": t_end, "--set": assignments or None}
    path = Path(source)
    if source == "-" or (path.is_file() and path.suffix.lower() != ".toml"):
        refuse(changed, "for a file")
        return motion_of(read(source))
    if source not in scene_ids() and golden_folder(source).is_dir():
        refuse(changed, "for a dataset")
    if not any(changed.values()) and golden_folder(source).is_dir():
        return motion_of(source)
    scene = load_scene(source, replacements(assignments, {"--t-end": ("run.t_end", t_end)}))
    with stoppable("nothing was written"), progress() as show:
        return motion_of(
            scene, announce, show(f"the motion of {scene.id}", float(scene.exact.t_end))
        )


def atlas(
    out: Annotated[Path, PAGES] = Path("atlas"),
    data: Annotated[Path | None, DATA] = None,
    studies: Annotated[Path | None, STUDIES] = None,
    files: Annotated[str, FILES] = "",
    as_json: AsJson = False,
) -> None:
    """Make web pages: for any pendulum, and of all golden datasets.

    The first page computes the motion of a pendulum that is typed, and judges a program's output dropped on it. The
    page of a scene has pictures, bounds and files, judges by the golden data, and plays the motion.
    """
    from ..report.atlas.entry import studies_folder
    from ..report.atlas.pages import build
    from ..report.folder import PAGE

    with stoppable("nothing half was written"), progress() as show:
        drawing = show("atlas", unit="scenes")
        sizes = build(data or golden_root(), out, studies or studies_folder(), files, drawing)
    if as_json:
        emit(
            {
                "out": str(out),
                "pages": [{"page": name, "bytes": size} for name, size in sizes.items()],
            }
        )
        return
    scenes = counted(sum(name.endswith(".html") for name in sizes) - 2, "scene")
    typer.echo(f"{out / PAGE}: {scenes}, {sum(sizes.values()) / 1e6:.1f} MB in {len(sizes)} files")
