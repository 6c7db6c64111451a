"""How `foucault score` judges: files, a program, an approximation, a suite, passages; uncertain inputs too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from reference import FoucaultError, InputError, Scene, load_scene
from reference.commands.progress import progress
from reference.commands.terminal import stoppable
from reference.errors import Stopped
from reference.numbers.precision import Array
from reference.plain_text import plain

from .. import judge
from ..approximations import APPROXIMATIONS, Motion
from ..candidates.arrays import candidate_of
from ..candidates.candidate import COLUMNS, Candidate
from ..candidates.external import Timing, timed
from ..candidates.names import Naming
from ..candidates.read import named, read, read_stream, read_transits
from ..report import suite
from ..score.baseline import FILE, document_of, rows_of
from ..score.document import of_outcome
from ..score.verdict import Outcome, Score
from .experimenting import GIVEN, Runnable
from .options import announce

SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".out", ".npy", ".npz")  # of a suite's files
TRANSITS = ".transits"
DOCUMENT = ".json"  # of a baseline that is no trajectory


def suite_files(
    folder: Path, option: str = "--suite"
) -> dict[str, tuple[Path | None, Path | None]]:
    """Return the candidates of a folder by their scenes, sorted, such as paris.csv, with paris.transits.csv beside it.

    Returns:
        The candidate's file and that of its transits, one of which may be None; by the id of a scene that ships, or by
        the path of a TOML file of the same name beside them.

    Raises:
        InputError: it is no folder, holds no candidates, or two for one scene.
    """
    if not folder.is_dir():
        raise InputError(
            option,
            str(folder),
            "a folder",
            "Its files are named by their scenes: paris.csv, hard.npz.",
        )
    by_scene: dict[str, dict[bool, Path]] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix.lower() not in SUFFIXES or not path.is_file():
            continue
        of_transits = path.stem.endswith(TRANSITS)
        files = by_scene.setdefault(path.stem.removesuffix(TRANSITS), {})
        if of_transits in files:
            raise InputError(
                option, f"{files[of_transits].name} and {path.name}", "one file for a scene"
            )
        files[of_transits] = path
    if not by_scene:
        expected = f"files named by their scenes, with one of {', '.join(SUFFIXES)}"
        raise InputError(
            option,
            str(folder),
            expected,
            "For paris: paris.csv, and paris.transits.csv if you like.",
        )
    suite = {}
    for scene, paths in sorted(by_scene.items()):
        described = folder / f"{scene}.toml"
        suite[str(described) if described.is_file() else scene] = paths.get(False), paths.get(True)
    return suite


@dataclass(frozen=True)
class Judging:
    """Judge every candidate of a command with the same options.

    Attributes:
        naming: what the user says of the columns of files.
        options: further arguments of `judge`.
        baseline: a file, a document (.json), a command for that of --run, a folder for a suite; None for none.
    """

    naming: Naming
    options: dict[str, Any]
    baseline: str | None = None

    def outcome(self, name: str, scene_id: str, trial: Callable[[], Score]) -> Outcome:
        """Make a score; an error in it becomes the outcome and does not stop others, an interruption ends all."""
        try:
            score = trial()
        except Stopped:
            raise
        except FoucaultError as error:
            return Outcome(plain(name), plain(scene_id), error=error)
        return Outcome(score.candidate.name, score.scene.id, score)

    def score(
        self, scene: Scene, candidate: Candidate | None, times: Array | None, baseline: Any = None
    ) -> Score:
        """Judge a candidate, with its transits or transits alone, beside a baseline if there is one."""
        with stoppable("nothing was written"), progress() as show, named("--baseline"):
            options = self.options | {"baseline": baseline, "announce": announce}
            report = show(f"the truth of {scene.id}", float(scene.exact.t_end))
            return judge(candidate, scene, transits=times, report=report, **options)

    def file(self, scene: Scene, name: str, times: Array | None) -> Outcome:
        """Judge a file."""
        return self.outcome(
            name, scene.id, lambda: self.score(scene, self._read(name), times, self._earlier())
        )

    def _earlier(self) -> Candidate | dict[str, Any] | None:
        """Read the baseline, a trajectory or a document, if there is one."""
        with named("--baseline"):
            document = str(self.baseline).endswith(DOCUMENT)
            return document_of(Path(str(self.baseline))) if document else self._read(self.baseline)

    def transits(self, scene: Scene, name: str) -> Outcome:
        """Judge transits alone."""
        return self.outcome(name, scene.id, lambda: self.score(scene, None, self.times(name)))

    def program(
        self, program: Runnable, name: str, transits: str | None, repeats: int, experiments: bool
    ) -> Outcome:
        """Run a program, and judge what it prints; with experiments, run it again where its positions are off."""
        scene = program.scene

        def trial() -> Score:
            times = self.times(transits)
            candidate, timing = printed(program.command, name, repeats)
            command = self.baseline is not None and not Path(self.baseline).is_file()
            with named("--baseline"):
                earlier = (
                    printed(str(self.baseline), str(self.baseline), 0)[0]
                    if command
                    else self._earlier()
                )
            return replace(self.score(scene, candidate, times, earlier), timing=timing)

        def printed(command: str, name: str, repeats: int) -> tuple[Candidate, Timing]:
            with stoppable("the program was ended"):
                output, timing = timed(program.words(scene, command), program.timeout, repeats)
            with output:
                if command == program.command:
                    program.keep(output, GIVEN)
                return read_stream(output, plain(name), naming=self.naming), timing

        outcome = self.outcome(name, scene.id, trial)
        score = outcome.score
        if not experiments or score is None or score.explanation is None:
            return outcome
        explanation = score.explanation
        off = explanation.causes or explanation.corrected_m > explanation.allowed_m
        return replace(outcome, score=program.experimented(score, self.naming)) if off else outcome

    def approximation(self, scene: Scene, word: str, transits: str | None) -> Outcome:
        """Judge the motion of an approximation at the scene's grid times."""
        motion = APPROXIMATIONS[word]
        if not isinstance(motion, Motion):
            expected = "an approximation of the motion"
            raise InputError(
                "--approximation", word, expected, "This one gives a number, not a motion."
            )

        def trial() -> Score:
            times = [float(t) for t in scene.exact.grid]
            columns = dict(zip(COLUMNS, motion.trajectory(scene, times).T, strict=True))
            return self.score(
                scene, candidate_of(word, {"t": np.array(times), **columns}), self.times(transits)
            )

        return self.outcome(word, scene.id, trial)

    def suite(self, folder: Path, out: Path | None, option: str = "--suite") -> list[Outcome]:
        """Judge the files of a folder by the scenes that they are named after, and write the page."""
        if out is not None:
            suite.check(out)
        outcomes, earlier = [], self._earlier_suite()
        for scene, files in suite_files(folder, option).items():
            name = Path(scene).stem
            before: object = earlier.pop(name, None if self.baseline is None else {"rows": []})
            outcomes.append(
                self.outcome(
                    str(files[0] or files[1]), name, partial(self._trial, scene, *files, before)
                )
            )
        for name in earlier:
            error = InputError("--suite", f"no file for {name}", f"one, as {self.baseline} has it")
            outcomes.append(Outcome(name, name, error=error))
        if out is not None:
            suite.write(outcomes, out)
        return outcomes

    def _earlier_suite(self) -> dict[str, Score | dict[str, Any]]:
        """Return the baseline of a suite by scene: the scores of a folder, or rows of a document."""
        if self.baseline is None:
            return {}
        path = Path(self.baseline)
        if path.suffix == DOCUMENT:
            with named("--baseline"):
                return {
                    str(row["scene"]): {"rows": [row], FILE: str(path)}
                    for row in rows_of(document_of(path))
                }
        outcomes = replace(self, baseline=None).suite(path, None, "--baseline")
        return {outcome.scene: outcome.score or of_outcome(outcome) for outcome in outcomes}

    def _trial(
        self, word: str, candidate: Path | None, transits: Path | None, earlier: object
    ) -> Score:
        return self.score(load_scene(word), self._read(candidate), self.times(transits), earlier)

    def times(self, name: str | Path | None) -> Array | None:
        """Read the times of transits from a file, if there is one."""
        return None if name is None else read_transits(name, self.naming.units)

    def _read(self, name: str | Path | None) -> Candidate | None:
        return (
            None
            if name is None
            else read(name, columns=self.naming.columns, units=self.naming.units)
        )
