"""How `foucault score` judges: files, a program, an approximation, transits alone, a suite; each ends in an outcome."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from reference import InputError, Scene, load_scene
from reference.commands.progress import progress
from reference.commands.terminal import stoppable
from reference.numbers.precision import Array

from .. import Score, judge
from ..approximations import APPROXIMATIONS, Motion
from ..candidates.candidate import COLUMNS, Candidate, candidate_of
from ..candidates.external import arguments, timed
from ..candidates.layout import Naming
from ..candidates.read import read, read_stream, read_transits
from ..report.suite import outcome_forms
from ..report.suite.outcome import Outcome, SuiteFiles, outcome, suite_files
from .options import announce


@dataclass(frozen=True)
class Judging:
    """Judge every candidate of a command with the same options.

    Attributes:
        naming: what the user says of the columns of files.
        tolerance: in m; None for the default.
        covers: share of the span that is demanded.
        inputs: reading of the scene's numbers.
        explain: whether to look for the reasons of an error.
        as_model: whether agreement as a named model is enough.
    """

    naming: Naming
    tolerance: float | None
    covers: float
    inputs: str
    explain: bool
    as_model: bool

    def files(self, scene: Scene, names: Sequence[str], transits: str | None, t_end: float | None) -> list[Outcome]:
        """Judge files, each by itself."""
        times = self._times(transits) if names else None
        return [outcome(name, scene.id, partial(self._file, name, scene, times, t_end)) for name in names]

    def transits(self, scene: Scene, name: str, t_end: float | None) -> Outcome:
        """Judge transits alone."""
        return outcome(name, scene.id, lambda: self._score(None, scene, self._times(name), t_end))

    def program(
        self,
        scene: Scene,
        words: str,
        name: str,
        transits: str | None,
        t_end: float | None,
        timeout: float,
        repeats: int,
    ) -> Outcome:
        """Run a program, and judge what it prints."""

        def judged() -> Score:
            times = self._times(transits)
            output, timing = timed(arguments(words, scene), timeout, repeats)
            with output:
                candidate = read_stream(output, name, naming=self.naming)
            return replace(self._score(candidate, scene, times, t_end), timing=timing)

        return outcome(name, scene.id, judged)

    def approximation(self, scene: Scene, word: str, transits: str | None, t_end: float | None) -> Outcome:
        """Judge the motion of an approximation at the scene's grid times."""
        motion = APPROXIMATIONS[word]
        if not isinstance(motion, Motion):
            expected = "an approximation of the motion"
            raise InputError("--approximation", word, expected, "This one gives a number, not a motion.")

        def judged() -> Score:
            times = [float(t) for t in scene.exact.grid]
            columns = dict(zip(COLUMNS, motion.trajectory(scene, times).T, strict=True))
            candidate = candidate_of(word, {"t": np.array(times), **columns})
            return self._score(candidate, scene, self._times(transits), t_end)

        return outcome(word, scene.id, judged)

    def suite(self, folder: Path, out: Path | None) -> list[Outcome]:
        """Judge the files of a folder by the scenes that they are named after, and write the page."""
        if out is not None:
            outcome_forms.check(out)
        outcomes = [
            outcome(entry.name, Path(entry.scene).stem, partial(self._entry, entry)) for entry in suite_files(folder)
        ]
        if out is not None:
            outcome_forms.write(outcomes, out)
        return outcomes

    def _entry(self, entry: SuiteFiles) -> Score:
        scene, times = load_scene(entry.scene), None if entry.transits is None else self._times(str(entry.transits))
        return self._score(None if entry.candidate is None else self._read(entry.candidate), scene, times, None)

    def _file(self, name: str, scene: Scene, times: Array | None, t_end: float | None) -> Score:
        return self._score(self._read(name), scene, times, t_end)

    def _read(self, name: str | Path) -> Candidate:
        return read(name, columns=self.naming.columns, units=self.naming.units)

    def _times(self, name: str | None) -> Array | None:
        return None if name is None else read_transits(name, self.naming.units)

    def _score(self, candidate: Candidate | None, scene: Scene, times: Array | None, t_end: float | None) -> Score:
        with stoppable("nothing was written"), progress() as show:
            return judge(
                candidate,
                scene,
                transits=times,
                tolerance=self.tolerance,
                inputs=self.inputs,
                t_end=t_end,
                covers=self.covers,
                as_model=self.as_model,
                explain=self.explain,
                announce=announce,
                report=show(f"the truth of {scene.id}", float(scene.exact.t_end)),
            )
