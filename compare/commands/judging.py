"""How `foucault score` judges: files, transits, a program, an approximation, or a suite of files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from reference import FoucaultError, InputError, Scene, load_scene
from reference.commands.progress import progress
from reference.commands.terminal import stoppable
from reference.errors import Described, Stopped
from reference.numbers.precision import Array
from reference.plain_text import plain

from ..approximations import APPROXIMATIONS, Motion
from ..candidates.arrays import candidate_of
from ..candidates.candidate import COLUMNS, Candidate
from ..candidates.external import Timing, timed
from ..candidates.names import Naming
from ..candidates.read import named, read, read_stream, read_transits
from ..report import suite
from ..score.baseline import FILE, document_of, rows_of
from ..score.document import of_outcome
from ..score.judge import JudgeOptions, judge_with
from ..score.verdict import Outcome, Score
from ..truth import Progress
from .experimenting import GIVEN, Runnable
from .options import announce
from .suite_files import SuiteFiles, suite_files

_DOCUMENT = ".json"  # of a baseline that is no trajectory

# an earlier version: a score, a trajectory, or a document of `foucault score --json`
Earlier = Score | Candidate | dict[str, Any] | None


@dataclass(frozen=True)
class Judging:
    """Judge every candidate of a command with the same options.

    Attributes:
        naming: what the user says of the columns of files.
        options: what counts as agreement.
        baseline: a file, a document (.json), a command for that of --run, or a folder for a suite;
            None if there is no earlier version.
    """

    naming: Naming
    options: JudgeOptions
    baseline: str | None = None

    def file(self, scene: Scene, name: str, times: Array | None) -> Outcome:
        """Judge a file."""
        return _outcome_of(
            name,
            scene.id,
            lambda: self._score(scene, self._rows(name), times, self._baseline_of_file()),
        )

    def transits(self, scene: Scene, name: str) -> Outcome:
        """Judge transits alone."""
        return _outcome_of(name, scene.id, lambda: self._score(scene, None, self.times(name)))

    def program(
        self, program: Runnable, name: str, transits: str | None, repeats: int, experiments: bool
    ) -> Outcome:
        """Run a program and judge its output.

        With experiments, run it again if its positions are off.
        """
        outcome = _outcome_of(
            name,
            program.scene.id,
            lambda: self._score_of_program(program, name, transits, repeats),
        )
        score = outcome.score
        if not experiments or score is None or score.explanation is None:
            return outcome
        explanation = score.explanation
        if not explanation.causes and explanation.corrected_m <= explanation.allowed_m:
            return outcome
        return replace(outcome, score=program.experimented(score, self.naming))

    def approximation(self, scene: Scene, word: str, transits: str | None) -> Outcome:
        """Judge the motion of an approximation at the scene's grid times.

        Raises:
            InputError: it gives no motion.
        """
        motion = APPROXIMATIONS[word]
        if not isinstance(motion, Motion):
            expected = "an approximation that gives a motion"
            advice = "This one gives a single number. `foucault methods` lists the others."
            raise InputError("--approximation", word, expected, advice)
        return _outcome_of(
            word, scene.id, lambda: self._score_of_motion(motion, scene, word, transits)
        )

    def suite(self, folder: Path, out: Path | None, option: str = "--suite") -> list[Outcome]:
        """Judge the files of a folder by the scenes that they are named after, and write the page."""
        if out is not None:
            suite.check(out)
        earlier = self._baseline_of_suite()
        without_earlier: Earlier = None if self.baseline is None else {"rows": []}

        outcomes = []
        for files in suite_files(folder, option):
            before = earlier.pop(files.name, without_earlier)
            outcomes.append(self._outcome_of_files(files, before))
        for name in earlier:
            got = Described(f"no file for {name}")
            error = InputError("--suite", got, f"one, since {self.baseline} has a score of {name}")
            outcomes.append(Outcome(name, name, error=error))

        if out is not None:
            suite.write(outcomes, out)
        return outcomes

    def times(self, name: str | Path | None) -> Array | None:
        """Read the times of transits from a file, if there is one."""
        return None if name is None else read_transits(name, self.naming.units)

    def _rows(self, name: str | Path | None) -> Candidate | None:
        """Read a trajectory from a file, if there is one."""
        if name is None:
            return None
        return read(name, columns=self.naming.columns, units=self.naming.units)

    def _score(
        self,
        scene: Scene,
        candidate: Candidate | None,
        times: Array | None,
        baseline: Earlier = None,
    ) -> Score:
        """Judge a candidate, with its transits or transits alone, beside a baseline if there is one."""
        with stoppable("nothing was written"), progress() as show, named("--baseline"):
            report = show(f"the truth of {scene.id}", float(scene.exact.t_end))
            return judge_with(
                self.options,
                candidate,
                scene,
                transits=times,
                baseline=baseline,
                progress=Progress(announce, report),
            )

    def _baseline_of_file(self) -> Earlier:
        """Read the baseline, a trajectory or a document, if there is one."""
        if self.baseline is None:
            return None
        with named("--baseline"):
            if self.baseline.endswith(_DOCUMENT):
                return document_of(Path(self.baseline))
            return self._rows(self.baseline)

    def _score_of_program(
        self, program: Runnable, name: str, transits: str | None, repeats: int
    ) -> Score:
        """Run a program, and its earlier version if the baseline is a command; judge its output."""
        times = self.times(transits)
        candidate, timing = self._run(program, program.command, name, repeats)
        if self.baseline is None or Path(self.baseline).is_file():
            earlier = self._baseline_of_file()
        else:
            with named("--baseline"):
                earlier, _ = self._run(program, self.baseline, self.baseline, repeats=0)
        return replace(self._score(program.scene, candidate, times, earlier), timing=timing)

    def _run(
        self, program: Runnable, command: str, name: str, repeats: int
    ) -> tuple[Candidate, Timing]:
        """Return what a program, or another version of it, prints, and its run time."""
        with stoppable("the program was ended"):
            words = program.words(program.scene, command)
            output, timing = timed(words, program.timeout, repeats)
        with output:
            if command == program.command:
                program.keep(output, GIVEN)
            return read_stream(output, plain(name), naming=self.naming), timing

    def _score_of_motion(
        self, motion: Motion, scene: Scene, word: str, transits: str | None
    ) -> Score:
        """Judge an approximation of the motion."""
        times = [float(t) for t in scene.exact.grid]
        states = motion.trajectory(scene, times)
        columns = dict(zip(COLUMNS, states.T, strict=True))
        candidate = candidate_of(word, {"t": np.array(times), **columns})
        return self._score(scene, candidate, self.times(transits))

    def _outcome_of_files(self, files: SuiteFiles, earlier: Earlier) -> Outcome:
        """Judge the files of one scene of a suite."""

        def trial() -> Score:
            scene = load_scene(files.scene)
            return self._score(scene, self._rows(files.rows), self.times(files.transits), earlier)

        return _outcome_of(str(files.rows or files.transits), files.name, trial)

    def _baseline_of_suite(self) -> dict[str, Earlier]:
        """Return the baseline of a suite by scene: the scores of a folder, or rows of a document."""
        if self.baseline is None:
            return {}
        path = Path(self.baseline)
        by_scene: dict[str, Earlier] = {}
        if path.suffix == _DOCUMENT:
            with named("--baseline"):
                for row in rows_of(document_of(path)):
                    by_scene[str(row["scene"])] = {"rows": [row], FILE: str(path)}
            return by_scene

        for outcome in replace(self, baseline=None).suite(path, None, "--baseline"):
            by_scene[outcome.scene] = outcome.score or of_outcome(outcome)
        return by_scene


def _outcome_of(name: str, scene_id: str, trial: Callable[[], Score]) -> Outcome:
    """Return the outcome of a trial: its score, or its error, which does not stop others.

    Raises:
        Stopped: the user interrupted it.
    """
    try:
        score = trial()
    except Stopped:
        raise
    except FoucaultError as error:
        return Outcome(plain(name), plain(scene_id), error=error)
    return Outcome(score.candidate.name, score.scene.id, score)
