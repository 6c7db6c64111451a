"""Why a file is off, behind three doors: `diagnose` a file, `explain_change` of versions, `experiment` with a program.

What runs programs needs heyoka, and is imported when one of these is called. Sentences, advice and thresholds are here
for the pages that say some of it by themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from reference import Scene

from ..candidates.candidate import Candidate
from . import thresholds
from .advice import advice_on
from .case import AS_IF, Explanation
from .causes import ADDED_TWICE, CLOCK, EFFECTIVE
from .claims import hedged
from .conventions import AXES_SAID, LENGTHS_SAID, TIMES_SAID
from .document import explanation_document
from .experiments.findings import MOST_RUNS, Experiment, Experiments, possible
from .since import NOT_SOUGHT, ROUNDING, Since, Version, explain_change, unexplained

__all__ = [
    "ADDED_TWICE",
    "AS_IF",
    "AXES_SAID",
    "CLOCK",
    "EFFECTIVE",
    "LENGTHS_SAID",
    "MOST_RUNS",
    "NOT_SOUGHT",
    "ROUNDING",
    "THRESHOLDS",
    "TIMES_SAID",
    "Experiment",
    "Experiments",
    "Explanation",
    "Since",
    "Version",
    "advice_on",
    "diagnose",
    "experiment",
    "explain_change",
    "explanation_document",
    "hedged",
    "possible",
    "unexplained",
]

THRESHOLDS = {name: value for name, value in vars(thresholds).items() if name.isupper()}


def diagnose(rows: Candidate, scene: Scene, allowed_m: float) -> Explanation:
    """Return what is known of the reasons for an error; empty where nothing is.

    Args:
        rows: a file as it was read.
        scene: in the reading that the file was scored in.
        allowed_m: distance in m that counts as agreement.
    """
    from .explain import explain

    return explain(rows.t, rows.columns, scene, allowed_m)


def experiment(
    run: Callable[[Experiment, Scene], Candidate],
    diagnosis: Explanation,
    rows: Candidate,
    scene: Scene,
    allowed_m: float,
    chosen: Sequence[Experiment],
) -> tuple[Experiments, Explanation] | None:
    """Run a program again with other numbers, and return what that measured, and the explanation of all its files.

    Args:
        run: runs the program for an experiment in a scene; raises a FoucaultError.
        diagnosis: of the file that is there.
        rows: that file.
        scene: in the reading that the file was scored in.
        allowed_m: distance in m that counts as agreement.
        chosen: the experiments to make, until one explanation remains.

    Returns:
        None where no program solves the scene, or none fits the file.
    """
    from .experiments.laboratory import UNSOLVED, Laboratory

    try:
        laboratory = Laboratory(rows, scene, allowed_m, diagnosis, run)
    except UNSOLVED:
        return None
    return laboratory.measured(chosen)
