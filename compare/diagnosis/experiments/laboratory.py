"""Run a program again with other numbers in its placeholders, until one explanation of all its files remains."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from reference import FoucaultError, Scene

from ...candidates.candidate import Candidate, Deviation
from ...candidates.external import SETTING
from ..case import AS_IF, EITHER, UNCORRECTED, Explanation, largest
from ..claims import hedged, unnamed_step_error
from ..explain import RENAMED, KnownScene
from ..fitted import readers_of
from ..stepped import Steps, likely_steps
from ..thresholds import RIVAL
from .findings import Experiment, Experiments, Finding
from .joint import EQUAL, FACTOR, TYPED, JointCase, Trial

WAYS = TYPED, FACTOR  # how a step follows {setting}
SAME_MOTION = {"turn": "coriolis"}  # Ω upwards alone, and a plane turned by hand, may be one motion
LEAST_RUNS = 2  # by which a cause is measured
# no program solves such a scene, or fits its rows
UNSOLVED = (FoucaultError, ArithmeticError, np.linalg.LinAlgError)
Run = Callable[[Experiment, Scene], Candidate]


class Laboratory:
    """The runs of a program so far, and what they show."""

    def __init__(
        self,
        candidate: Candidate,
        scene: Scene,
        allowed_m: float,
        explanation: Explanation,
        run: Run,
    ) -> None:
        """Begin with the first run.

        Args:
            candidate: its output as it was given.
            scene: that it was given, in the reading that it was scored in.
            allowed_m: distance in m that counts as agreement.
            explanation: of its one file.
            run: runs it for an experiment in a scene; raises a FoucaultError.
        """
        self._problem = KnownScene.of(scene)
        self._allowed_m = allowed_m
        self._run = run
        self._explanation = explanation
        # axes as they were read
        renamed = any(convention.id in RENAMED for convention in explanation.conventions)
        self._without = frozenset() if renamed else RENAMED
        self._reach = 0.0
        self._findings: list[Finding] = []
        self._likely: list[tuple[Steps, str]] | None = None
        self._runs = [self._trial(self._problem, candidate, 1.0)]

    def measured(self, possible: Sequence[Experiment]) -> tuple[Experiments, Explanation]:
        """Make experiments until one explanation remains, and return what they found, and that explanation."""
        explanations: list[Explanation] = []
        with np.errstate(all="ignore"):
            for experiment in possible:
                if self._make(experiment) and len(self._runs) > LEAST_RUNS:
                    explanations = self._explanations()
                    # what does not make these files makes no more of them
                    if len(explanations) < 2:
                        break
            if 1 < len(self._runs) <= LEAST_RUNS:  # the program is fit for no more
                explanations = self._explanations()
            known = bool(explanations)
            explanations = explanations or self._of_integrator()
        ids = tuple(tuple(cause.id for cause in each.causes) for each in explanations)
        found = Experiments(tuple(self._findings), ids, self._conclusion(explanations, known))
        if len(self._runs) == 1:
            return found, self._explanation
        return found, self._measured_explanation(explanations)

    def _conclusion(self, explanations: Sequence[Explanation], known: bool) -> str:
        """Return what follows from all runs.

        Args:
            explanations: that make all files.
            known: whether they do, and not an integrator whose error is not known.
        """
        files = f"the {len(self._runs)} files"
        if not explanations:
            return f"Nothing that was tried explains {files}: what follows is about the first one alone."
        if len(explanations) == 1:
            cause = "one explanation makes" if known else "an integrator is at fault, say"
            return f"Measured: {cause} {files}."
        texts = []
        for explanation in explanations:
            texts.append("; it ".join(cause.text for cause in explanation.causes))
        return f"Cannot be told apart by these experiments: your program {', or '.join(texts)}."

    def _measured_explanation(self, explanations: Sequence[Explanation]) -> Explanation:
        """Return the explanation that remains, in the conventions of the first file.

        Several explanations that remain name no cause together. If no explanation remains, the
        certain causes of the first file become what the program moves like.
        """
        first = self._explanation
        ids: set[str] = set().union(*map(_ids, explanations))
        model = first.model if _ids(first) == ids else None
        if len(explanations) == 1:
            (best,) = explanations
        elif not explanations:
            certain = [cause for cause in first.causes if cause.stage not in (AS_IF, EITHER)]
            best = replace(first, causes=tuple(map(hedged, certain)), slip="")
        else:
            best = replace(first, causes=(), slip="", corrected_m=_error_m(self._runs[0]))
        return replace(best, conventions=first.conventions, model=model, next_step="")

    def _explanations(self) -> list[Explanation]:
        """Return what makes the files of all runs; where nothing does, with the steps of a method on the sphere."""
        try:
            case = JointCase.of(self._runs)
            explanations = _explanations_of(case)
            if self._likely is None and not explanations:
                likely = likely_steps(self._runs[0].case, None)
                self._likely = list(itertools.product(likely, WAYS))
            # what does not make these files makes no more of them
            while not explanations and self._likely:
                steps, way = self._likely[0]
                without_steps, _ = case.without_steps(steps, way)
                near = without_steps.readings(math.inf)
                if near:
                    explanations = _explanations_of(*case.without_steps(steps, way, near[0]))
                self._likely = self._likely[not explanations :]
            return explanations
        except UNSOLVED:
            return []

    def _of_integrator(self) -> list[Explanation]:
        """Return that an integrator is too loose, where another step shows it, or every file's drift does.

        With half the step the error of any order changes by half of itself or more. If the whole
        error is far more than that, it is not the integrator's.
        """
        first = self._runs[0]
        error_m = _error_m(first)
        for run in self._runs:
            if run.setting != 1 and len(run.case.rows.times) == len(first.case.rows.times):
                changed_m = largest(run.case.rows.positions - first.case.rows.positions)
                if changed_m > first.case.enough:
                    mostly = error_m <= RIVAL * changed_m
                    return [_of_loose_integrator(first, error_m)] if mostly else []
        try:
            drift = [_drifts(run) for run in self._runs]
        except UNSOLVED:
            return []
        if not all(drift) or len(drift) <= LEAST_RUNS:
            return []
        return [_of_loose_integrator(first, error_m)]

    def _make(self, experiment: Experiment) -> bool:
        """Make a run; return whether its file is read as the first was."""
        scene = self._problem.scene
        problem = KnownScene.of(experiment.changed(scene))
        changes = experiment.values(scene)
        if experiment.finer > 1:
            changes[SETTING] = f"1/{experiment.finer} of the first"
        trial: Trial | None = None
        conclusion = "its file is read in another way than the first; nothing follows from it"
        try:
            candidate = self._run(experiment, problem.scene)
            if candidate.positions:
                trial = self._trial(problem, candidate, 1 / experiment.finer)
        except UNSOLVED as error:
            conclusion = f"{str(error).rstrip('.')}; nothing follows from it"
        error_m = None
        if trial is not None and _conventions(trial) == _conventions(self._runs[0]):
            self._runs.append(trial)
            error_m = _error_m(trial)
            conclusion = _conclusion_of(experiment, error_m <= trial.case.enough)
        finding = Finding(experiment.id, experiment.title, changes, error_m, conclusion)
        self._findings.append(finding)
        return error_m is not None

    def _trial(self, problem: KnownScene, candidate: Candidate, setting: float) -> Trial:
        """Return a trial of x and y; its largest residual may be as large a part of the swing as that of the first."""
        rows = problem.rows(candidate.t, candidate.columns, self._without)
        rows = replace(rows, positions=np.ascontiguousarray(rows.plane), cord=None)
        case = problem.case(rows, self._allowed_m)
        reach = largest(case.truth)
        self._reach = self._reach or reach
        allowed_m = self._allowed_m * reach / self._reach
        return Trial(problem, replace(case, allowed_m=allowed_m), setting)


def _explanations_of(case: JointCase, *step: Deviation) -> list[Explanation]:
    """Return the explanations of a case, beside a step, the likeliest first; of those of the same groups one."""
    explanations: list[Explanation] = []
    explained: list[set[str]] = []
    for reading in case.readings():
        explanation = case.explanation_of(reading, *step)
        groups = {SAME_MOTION.get(cause.group, cause.group) for cause in reading.causes}
        ids = _ids(explanation)
        contains_another = any(_ids(likelier) <= ids for likelier in explanations)
        same = groups in explained or contains_another
        least = explanations[0].score if explanations else explanation.score
        if ids and not same and explanation.score <= least + EQUAL:
            explanations.append(explanation)
            explained.append(groups)
    return [each for each in explanations if not _has_fewer(explanations, each)]


def _has_fewer(explanations: Sequence[Explanation], explanation: Explanation) -> bool:
    """Return whether one of some explanations has a part of the causes of another, and no other causes."""
    ids = _ids(explanation)
    return any(_ids(fewer) < ids for fewer in explanations)


def _of_loose_integrator(trial: Trial, size_m: float) -> Explanation:
    """Return the explanation that an integrator's error moves the bob by a size in m: nothing of it is put right."""
    case = trial.case
    return case.explanation((unnamed_step_error(size_m),), case.rows.positions - case.truth, 0)


def _drifts(trial: Trial) -> bool:
    """Return whether phase and amplitude drift in a run, beside a right program on the sphere."""
    case = trial.case
    readers = readers_of(case, list(trial.fits.values()))
    spheres = [reader for reader in readers if reader.right.kind == "sphere"]
    return any(reader.drifts(case, reader.right) for reader in spheres)


def _conclusion_of(experiment: Experiment, gone: bool) -> str:
    """Return what follows from an experiment by itself, with which the error is gone or not."""
    if not experiment.where:
        return ""
    return f"what is wrong is {experiment.where}" if gone else f"it is not {experiment.where} alone"


def _ids(explanation: Explanation) -> set[str]:
    return {cause.id for cause in explanation.causes}


def _error_m(trial: Trial) -> float:
    return largest(trial.case.rows.positions - trial.case.truth)


def _conventions(trial: Trial) -> list[str]:
    ids = [convention.id for convention in trial.case.rows.conventions]
    return [convention_id for convention_id in ids if convention_id not in UNCORRECTED]
