"""A user's program on one scene: its output, at whatever times it prints, against the truth there.

Unlike `methods.external`, which has a study time a program at the golden grid times, this asks only where it breaks.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from reference import Golden, InputError, Scene
from reference.precision import Array
from reference.status import Status

from ..candidates.candidate import Candidate, NotFiniteError
from ..candidates.external import FailedError, OutOfTimeError, arguments, run_program
from ..candidates.read import read_stream
from ..methods.external import SETTING
from ..position_error import difference, distance
from ..truth import truth_at
from .machine import load_per_core
from .row import Row

STEPS = 200  # in a period of the fastest rate of the scene, that {setting} asks a program for
DIGITS = 6.0  # that a program is asked for: the millionth of the amplitude that `foucault score` allows
PATIENCE = 3  # wall-clock seconds for each CPU second that is allowed
NUMBER = "program"  # what stands for a program's number type


@dataclass(frozen=True)
class Measured:
    """A program's run on a scene.

    Attributes:
        row: status, errors and cost.
        t: its times in s.
        errors: position errors in m at these times.
    """

    row: Row
    t: Array
    errors: Array

    def breaks_at(self, above_m: float) -> float | None:
        """Return the first time in s at which the error is above so many metres; None if it never is."""
        beyond = self.errors > above_m
        return float(self.t[np.argmax(beyond)]) if beyond.any() else None


def measured(name: str, command: str, setting: float, scene: Scene, golden: Golden, limit_s: float) -> Measured:
    """Run a program on a scene and measure its error; a failure of any kind becomes the row's status and reason.

    Args:
        name: its name in the row.
        command: with placeholders, and {setting} for the step.
        setting: value of {setting}, in s.
        scene: as the program is given it.
        golden: its truth.
        limit_s: CPU seconds that it may take.
    """
    base = Row(name, NUMBER, setting, "step", scene.inputs, Status.OK, load=load_per_core())

    def failed(status: Status, reason: object) -> Measured:
        return Measured(replace(base, status=status, reason=str(reason)), np.empty(0), np.empty(0))

    try:
        words = arguments(command.replace(SETTING, repr(setting)), scene)
        output, cpu_s, _ = run_program(words, PATIENCE * limit_s)
        with output:
            candidate = read_stream(output, "its output")
        return _against(base, candidate, cpu_s, scene, golden)
    except OutOfTimeError as error:
        return failed(Status.OUT_OF_TIME, error)
    except NotFiniteError as error:
        return failed(Status.NOT_FINITE, f"{error.field}: {error.got}")
    except FailedError as error:
        return failed(Status.CRASHED if error.by_signal else Status.GAVE_UP, error)
    except InputError as error:
        return failed(Status.GAVE_UP, error)


def _against(base: Row, candidate: Candidate, cpu_s: float, scene: Scene, golden: Golden) -> Measured:
    end, step = float(scene.exact.t_end), float(scene.exact.grid_step)
    kept = candidate.t <= end + step / 2
    t = candidate.t[kept]
    if not len(t) or not t[-1] > 0:
        raise InputError("its output", "no row after t = 0", f"rows to t = {end:g} s")
    truth = truth_at(golden, t)
    places = [i for i, name in enumerate("xyz") if name in candidate.columns]
    errors = distance(difference(candidate.columns["xyz"[i]][kept], truth.states[:, i]) for i in places)
    short = t[-1] < end - step
    row = replace(
        base,
        status=Status.GAVE_UP if short else Status.OK,
        reason=f"its output ends at t = {t[-1]:g} s of {end:g} s" if short else "",
        error_m=float(errors.max()),
        end_error_m=float(errors[-1]),
        cpu_s=cpu_s,
        reached_t=float(t[-1]),
    )
    return Measured(row, t, errors)
