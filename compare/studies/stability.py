"""Stiff and extreme scenes: which methods keep their digits, which fail, and which are silently wrong.

Every method is asked for the same number of digits on every scene, and its result is compared with
the truth. A run is silently wrong if it reports success with an error above a thousand times the
requested one. It is ill-conditioned, and not the method's fault, if the motion itself magnifies the
requested error, made at the release, by more than that.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import partial
from pathlib import Path

import numpy as np

from reference import Scene, UnreachableError, load, load_scene, scene_ids
from reference.model.constants import constants_in_double
from reference.numbers.columns import STATE
from reference.status import Status

from ..candidates.external import STEPS
from ..methods import METHODS
from ..truth import Progress, golden_of
from . import users_program
from .campaign import UNREPORTED, Measurement, Reports, campaign
from .character import Character, character, reason_of
from .measure import Bench
from .row import GridTruth, Row
from .study_plan import declared, on_doubles

LIMIT_S = 3.0  # CPU seconds of a cell
_PATIENCE = 5  # wall-clock limit of a cell, in multiples of the CPU limit
SWINGS = 64  # longer scenes are cut to this many small swings; `long_runs` covers long spans
WRONG = 1000  # an error above this multiple of the requested one is a failure
_LOST_BITS = 20  # a method of fixed precision may lose this many bits to rounding
_TRUTH_DIGITS = 34  # six more than are asked of the finest method
_EXACT = 40.0  # digits of a run without any error

# method or program, formulation and setting as the method declares them, and the scene
_Item = tuple[str, str | None, float, str]


@dataclass(frozen=True)
class SolvedScene:
    """A scene of the study with its truth.

    Attributes:
        scene: as it is run.
        golden_path: folder of its golden dataset.
        character: what makes it hard.
    """

    scene: Scene
    golden_path: Path
    character: Character


@dataclass(frozen=True)
class Cell:
    """A method on a scene.

    Attributes:
        scene, method, precision: the run; `precision` is the number type, with the formulation.
        status: OK, or how it failed.
        digits: correct digits, relative to the amplitude; None without a result.
        asked: digits that it was asked for.
        cpu_s: CPU seconds; None without a result.
        reason: why it is not OK, in a sentence.
        steps: number of steps, None if the method does not report it.
        wrong_from_s: time in s from which on a program's error is above what makes it wrong; None
            if it never is.
        setting: step in s, relative tolerance or bits, as `kind` says ("step", "tolerance" or
            "precision").
        load: as in `Row`.
    """

    scene: str
    method: str
    precision: str
    status: Status
    digits: float | None
    asked: float
    cpu_s: float | None
    reason: str
    steps: int | None = None
    wrong_from_s: float | None = None
    setting: float | None = None
    kind: str = ""
    load: float | None = None


def default_scenes() -> list[str]:
    """Return the ids of all scenes with flags, which say why they are hard, and Paris for comparison."""
    return ["paris", *(name for name in scene_ids() if load_scene(name).flags)]


def cut(scene: Scene) -> Scene:
    """Return the scene with inputs read as binary64, no longer than `SWINGS` small swings, without transits."""
    k = constants_in_double(scene.exact)
    strength = math.hypot(float(k.pull[1]), float(k.pull[2]))
    swing = 2 * math.pi / math.sqrt(strength) if strength else math.inf
    scene = on_doubles(scene.with_values(["inputs=binary64", "run.transits=false"]))
    step = scene.exact.grid_step
    all_rows = int(scene.exact.t_end / step)
    if not strength:
        return scene
    rows = max(2, min(all_rows, int(SWINGS * swing / float(step))))
    if rows >= all_rows:
        return scene
    return scene.with_values([f"run.t_end={Decimal(scene.run.grid_step) * rows}"])


def stability(
    scenes: Sequence[str] | None = None,
    methods: Sequence[str] | None = None,
    *,
    programs: Mapping[str, str] | None = None,
    limit_s: float = LIMIT_S,
    journal_path: Path | None = None,
    reports: Reports = UNREPORTED,
) -> list[Cell]:
    """Make the runs that methods declare for this study on every scene.

    Args:
        scenes: ids, or paths of TOML files; `default_scenes` if None.
        methods: ids; all that declare such runs if None.
        programs: commands of programs of the user's own, by their names; each runs on every scene
            as well.
        limit_s: CPU seconds of a cell.
        journal_path: a file to which cells are appended, and whose cells are not run again.
        reports: of the scenes whose truth is known, and of the cells.

    Raises:
        InputError: an unknown scene or method, or one that declares no such runs.
    """
    commands = dict(programs or {})
    runs = [*declared(methods, "stability"), *((name, None, 1 / STEPS) for name in commands)]
    names = default_scenes() if scenes is None else scenes
    cuts = {name: cut(load_scene(name)) for name in names}
    solved_scenes, unsolved = _solved(cuts, reports.solving)

    items: list[_Item] = [(*run, name) for run in runs for name in cuts]
    solved = [item for item in items if item[-1] in solved_scenes]

    orders = {name: method.order for name, method in METHODS.items() if method.setting == "step"}
    recipe = [limit_s, SWINGS, orders]  # orders decide the digits asked for
    cells = _Cells(recipe, _PATIENCE * limit_s, commands, solved_scenes, limit_s)
    measured = campaign(cells, solved, journal_path=journal_path, report=reports.measuring)
    finished = dict(zip(solved, measured, strict=True))
    return [
        finished.get(item) or cells.failed(item, Status.UNREACHABLE, unsolved[item[-1]])
        for item in items
    ]


def _solved(
    scenes: Mapping[str, Scene], solving: Callable[[float, int], None] | None
) -> tuple[dict[str, SolvedScene], dict[str, str]]:
    """Return the scenes that the reference can solve, and why it cannot solve others."""
    solved: dict[str, SolvedScene] = {}
    unsolved: dict[str, str] = {}
    for count, (name, scene) in enumerate(scenes.items()):
        report = solving and partial(_report_time, solving, count, len(scenes), scene)
        try:
            golden = golden_of(scene, _TRUTH_DIGITS, Progress(report=report), grid=True)
            times = GridTruth(golden, float(scene.exact.t_end)).times
            states = np.column_stack([getattr(golden, column) for column in STATE])[: len(times)]
            traits = character(scene, times, states)
            solved[name] = SolvedScene(scene, golden.path, traits)
        except UnreachableError as error:
            unsolved[name] = f"The reference cannot solve it: {error}"
        if solving is not None:
            solving(count + 1, len(scenes))
    return solved, unsolved


def _report_time(
    solving: Callable[[float, int], None], solved: int, scenes: int, scene: Scene, t: float
) -> None:
    """Report how many scenes are solved, the one at work as the fraction that it has reached at t in s."""
    solving(solved + t / float(scene.exact.t_end), scenes)


@dataclass(frozen=True)
class _Cells(Measurement[_Item, Cell]):
    """Methods and programs on scenes."""

    scenes: Mapping[str, SolvedScene]
    limit_s: float

    kind = Cell

    def measure(self, item: _Item) -> Cell:
        name, formulation, setting, scene_id = item
        solved = self.scenes[scene_id]
        scene = solved.scene
        traits = solved.character
        golden = load(solved.golden_path)
        length = float(scene.exact.length)
        amplitude_m = traits.amplitude * length or length
        step_s = setting * 2 * math.pi / traits.fastest if traits.fastest else setting
        if name not in self.commands:
            method = METHODS[name]
            truth = GridTruth(golden, float(scene.exact.t_end))
            bench = Bench(scene, truth, self.limit_s, repeats=1, transits=False)
            used = step_s if method.setting == "step" else setting
            row = bench.row(method, formulation, used)
            return self._judged(item, row, traits, amplitude_m)

        wrong_m = WRONG * 10**-users_program.DIGITS * amplitude_m
        program = users_program.ProgramRun(name, self.commands[name], step_s, self.limit_s)
        row, wrong_from_s = users_program.measured(program, scene, golden, wrong_m)
        cell = self._judged(item, row, traits, amplitude_m)
        if cell.status != Status.SILENTLY_WRONG or wrong_from_s is None:
            return cell
        reason = f"From t = {wrong_from_s:g} s on it is wrong. {cell.reason}"
        return replace(cell, reason=reason, wrong_from_s=wrong_from_s)

    def failed(self, item: _Item, status: Status, reason: str) -> Cell:
        method, formulation, setting, scene = item
        if method in METHODS:
            kind = METHODS[method].setting
            number = METHODS[method].number
        else:
            kind = "step"
            number = users_program.NUMBER
        precision = f"{number}, {formulation}" if formulation else number
        used = None if kind == "step" else setting  # a step depends on the scene's rates
        requested = digits_requested(method, setting)
        return Cell(
            scene, method, precision, status, None, requested, None, reason, setting=used, kind=kind
        )

    def _judged(self, item: _Item, row: Row, traits: Character, amplitude_m: float) -> Cell:
        """Return the cell of a run; its digits are those of the error relative to the amplitude."""
        requested = digits_requested(item[0], item[2])
        digits = _digits_kept(row.error_m, amplitude_m)
        status = row.status
        if status == Status.EXTRAPOLATED:
            status = Status.OUT_OF_TIME
            digits = None
        if status == Status.OK and digits is not None:
            status = _status_of(digits, requested, traits.digits_lost)
        reason = reason_of(row, status, traits, digits, requested, self.limit_s)
        cell = self.failed(item, status, reason)
        return replace(
            cell,
            digits=digits,
            cpu_s=row.cpu_s,
            steps=row.steps,
            setting=row.setting,
            load=row.load,
        )


def _digits_kept(error_m: float | None, amplitude_m: float) -> float | None:
    """Return the digits of an error relative to the amplitude; None if there is no error."""
    if error_m is None:
        return None
    if error_m == 0:
        return _EXACT
    return -math.log10(error_m / amplitude_m)


def _status_of(digits: float, requested: float, lost: float) -> Status:
    """Return whether a finished run is right, silently wrong, or magnified by the motion.

    Args:
        digits: that the run kept.
        requested: that were asked for.
        lost: that the motion itself may lose of those at the release.
    """
    if digits >= requested - math.log10(WRONG):
        return Status.OK
    if digits >= requested - lost:
        return Status.ILL_CONDITIONED
    return Status.SILENTLY_WRONG


def digits_requested(method: str, setting: float) -> float:
    """Return the digits that a setting requests of a method; for a fixed step, those that its order gives."""
    if method not in METHODS:
        return users_program.DIGITS
    kind = METHODS[method].setting
    order = METHODS[method].order
    if kind == "precision":
        return (setting - _LOST_BITS) * math.log10(2)
    if kind == "tolerance" or order is None:
        return -math.log10(setting)
    return -order * math.log10(2 * math.pi * setting)
