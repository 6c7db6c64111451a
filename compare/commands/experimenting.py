"""Run somebody's program for `foucault score`: its step, its output kept, and experiments with their progress."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

from reference import InputError, Scene
from reference.commands.progress import progress
from reference.commands.terminal import stoppable
from reference.errors import usable
from reference.model.start import Start
from reference.numbers.precision import DOUBLE

from ..candidates.candidate import Candidate
from ..candidates.external import SETTING, STEPS, arguments, run_program
from ..candidates.names import Naming
from ..candidates.read import read_stream
from ..diagnosis import MOST_RUNS, Experiment, experiment, possible
from ..report.folder import json_text, write_file
from ..score.verdict import Score

GIVEN = "as_given"  # the file, in the folder, of what the program prints for the scene itself
_DOCUMENT = "experiments.json"


@dataclass(frozen=True)
class Runnable:
    """Somebody's program, to be run more than once.

    Attributes:
        scene: that it is given first.
        command: with its placeholders.
        setting: value of {setting} in the first run; None for the usual step.
        timeout: seconds that a run may take.
        out: folder for what the program prints, or None.
    """

    scene: Scene
    command: str
    setting: float | None
    timeout: float
    out: Path | None = None

    def check(self) -> None:
        """Refuse, before a run, a command that no experiment can change, and a folder with other files.

        Raises:
            InputError: it is one of these.
        """
        possible(self.scene, self.command)
        if self.out is None:
            return
        with usable("--out", self.out):
            self.out.mkdir(parents=True, exist_ok=True)
            if any(self.out.iterdir()) and not (self.out / f"{GIVEN}.txt").exists():
                expected = "a new folder, or one of earlier experiments"
                advice = "It has other files: choose another name."
                raise InputError("--out", str(self.out), expected, advice)

    @property
    def step(self) -> float:
        """The value of {setting}; by default a step in s that divides a grid step, at least 200 steps a period."""
        if self.setting is not None:
            return self.setting
        grid_step_s = float(self.scene.exact.grid_step)
        rate = Start.of(self.scene.exact, DOUBLE.prec).fastest_rate
        steps = math.ceil(grid_step_s * rate * STEPS / (2 * math.pi))
        return grid_step_s / steps

    def words(self, scene: Scene, command: str = "", finer: int = 1) -> list[str]:
        """Return the words of a run on a scene, with {setting} divided by a number; optionally of another command."""
        return arguments((command or self.command).replace(SETTING, repr(self.step / finer)), scene)

    def keep(self, output: BinaryIO, word: str) -> None:
        """Write the output of a run into the folder, and rewind it."""
        if self.out is not None:
            write_file(self.out / f"{word}.txt", output.read(), "--out")
            output.seek(0)

    def experimented(self, score: Score, naming: Naming) -> Score:
        """Make the experiments that the command allows, and return the score with what they measured."""
        assert score.explanation is not None
        count = 0
        kept = "what the program has printed is kept" if self.out else "nothing was written"
        with stoppable(kept), progress() as show:
            move = show("experiments", MOST_RUNS, "runs")

            def run(chosen: Experiment, scene: Scene) -> Candidate:
                nonlocal count
                move(count, item=chosen.title)
                count += 1
                output, *_ = run_program(self.words(scene, finer=chosen.finer), self.timeout)
                with output:
                    self.keep(output, chosen.id)
                    return read_stream(output, chosen.title, naming=naming)

            planned = possible(score.scene, self.command)
            measured = experiment(
                run, score.explanation, score.candidate, score.scene, score.allowed_m, planned
            )
            if measured is None:
                return score
            experiments, explanation = measured
            move(MOST_RUNS)
        if self.out is not None:
            write_file(self.out / _DOCUMENT, json_text(experiments.document()), "--out")
        return replace(score, experiments=experiments, explanation=explanation)
