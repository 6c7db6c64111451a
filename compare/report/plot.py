"""`compare.plot`: a motion, or the errors of a score, as a picture that a notebook shows and that can be saved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from reference import Golden, Solution, load
from reference.dataset.place import golden_folder
from reference.scenes.scene import AnyScene, as_scene

from ..candidates.candidate import Candidate
from ..score.verdict import Score
from ..truth import golden_of
from .charts.drawing import check_target
from .charts.motion_pictures import motion_picture, panels
from .charts.score_chart import error_picture
from .folder import write_file
from .motion import Motion


@dataclass(frozen=True)
class Picture:
    """A picture: shown by a notebook, written by `save`.

    Attributes:
        title: what it shows.
        content: returns the content of a file, whose name says which form it has.
    """

    title: str
    content: Callable[[Path], bytes]

    def __repr__(self) -> str:
        return f"Picture({self.title})"

    def _repr_svg_(self) -> str:
        return self.content(Path("picture.svg")).decode()

    def save(self, path: str | Path) -> None:
        """Write it as .svg, .png or .pdf.

        Raises:
            InputError: another form, or no such folder.
        """
        check_target(Path(path), "path")
        write_file(Path(path), self.content(Path(path)), "path")


def plot(source: Score | Candidate | Golden | Solution | AnyScene) -> Picture:
    """Draw the errors of a score against time, or a motion: its path, swing plane and transits.

    Args:
        source: a score, a solution, a dataset, a candidate, or a scene, which is solved if no dataset has its motion.

    Raises:
        InputError: it is none of these, or matplotlib is not installed.
    """
    if isinstance(source, Score):
        return Picture(f"errors of {source.candidate.name}", lambda path: error_picture([source], path))
    motion = motion_of(source)
    return Picture(f"motion of {motion.name}", lambda path: motion_picture(motion, list(panels(motion)), path))


def motion_of(
    source: Candidate | Golden | Solution | AnyScene,
    announce: Callable[[str], None] | None = None,
    report: Callable[[float], None] | None = None,
) -> Motion:
    """Return the motion of a candidate, a solution or a dataset, or of a scene, which is solved if no dataset has it.

    Args:
        source: what moves.
        announce: called with a message when a scene has to be solved.
        report: called with the simulated time reached, in s.
    """
    if isinstance(source, Candidate):
        return Motion.of_candidate(source)
    if isinstance(source, str | Path) and golden_folder(source).is_dir():
        return Motion.of_golden(load(source))
    if isinstance(source, Golden | Solution):
        return Motion.of_golden(source)
    return Motion.of_golden(golden_of(as_scene(source), announce=announce, report=report))
