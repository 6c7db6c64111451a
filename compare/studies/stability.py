"""Stiff and extreme scenes: which methods keep their digits, which fail, and which are silently wrong.

Every method is asked for the same number of digits on every scene, and its result is compared with the truth.
`silently_wrong` is a run that reports success with an error above a thousand times the requested one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np

from reference import FoucaultError, Scene, UnreachableError, load, load_scene, parse_scene, scene_ids
from reference.process import Emit

from ..methods import METHODS
from ..rhs.constants import constants_in_double
from ..rhs.swing import suited
from ..truth import golden_of
from .character import Character, character
from .grid import on_doubles
from .isolated import isolated
from .journal import Journal
from .measure import Bench
from .method_errors import GridTruth
from .reasons import reason_of
from .row import EXTRAPOLATED, OK, Row

LIMIT_S = 3.0  # CPU seconds of a cell
PATIENCE = 5  # wall-clock limit of a cell, in multiples of the CPU limit
SWINGS = 64  # longer scenes are cut to this many small swings; `long_runs` covers long spans
WRONG = 1000  # an error above this multiple of the requested one is a failure
LOST_BITS = 20  # a method of fixed precision may lose this many bits to rounding
TRUTH_DIGITS = 34  # six more than are asked of the finest method

TOLERANCE = 1e-9
CELLS: tuple[tuple[str, str | None, float], ...] = (
    *(("heyoka_double", word, 1e-12) for word in ("momentum", "space", "spin", "plane", "angles", "lagrangian")),
    ("heyoka_long_double", "momentum", 1e-16),
    ("heyoka_real128", "momentum", 1e-28),
    ("limbs", None, 100),
    *((name, None, TOLERANCE) for name in ("scipy_rk45", "scipy_dop853", "scipy_lsoda", "scipy_bdf", "scipy_radau")),
    *((name, None, TOLERANCE) for name in ("numbalsoda_dop853", "numbalsoda_lsoda", "cvode_adams", "cvode_bdf")),
    *((name, None, TOLERANCE) for name in ("rebound_bs", "rebound_ias15")),
    ("rk4", "plane", 1 / 200),
    *((name, None, 1 / 200) for name in ("rk4", "rkng67", "rkmk4")),
    ("gauss_legendre", None, 1 / 20),
)  # method; formulation (None: the first of its own that can describe the motion); setting (a fixed step is given as a
# part of 2π over the fastest rate of the scene)


Case = tuple[str, dict[str, Any], Path]  # id, document and golden folder of a scene


@dataclass(frozen=True)
class Cell:
    """A method on a scene.

    Attributes:
        scene, method, precision: the run; `precision` is the number type, with the formulation.
        status: ok, silently_wrong, gave_up, not_finite, out_of_time, refused, not_installed.
        digits: correct digits, relative to the amplitude; None without a result.
        asked: digits that it was asked for.
        cpu_s: CPU seconds; None without a result.
        reason: why it is not ok, in a sentence.
        steps: number of steps, None if the method does not report it.
    """

    scene: str
    method: str
    precision: str
    status: str
    digits: float | None
    asked: float
    cpu_s: float | None
    reason: str
    steps: int | None = None

    @property
    def key(self) -> tuple[str, str, str]:
        """The identity of a cell."""
        return self.scene, self.method, self.precision


def default_scenes() -> list[str]:
    """Return the ids of all scenes with flags, which say why they are hard, and Paris for comparison."""
    return ["paris", *(name for name in scene_ids() if load_scene(name).flags)]


def cut(scene: Scene) -> Scene:
    """Return the scene with inputs read as binary64, no longer than `SWINGS` small swings, without transits."""
    k = constants_in_double(scene.exact)
    strength = math.hypot(float(k.pull[1]), float(k.pull[2]))
    swing = 2 * math.pi / math.sqrt(strength) if strength else math.inf
    scene = on_doubles(scene.with_values(["inputs=binary64", "run.transits=false"]))
    step, whole = scene.exact.grid_step, int(scene.exact.t_end / scene.exact.grid_step)
    rows = max(2, min(whole, int(SWINGS * swing / float(step)))) if strength else whole
    return scene.with_values([f"run.t_end={Decimal(scene.run.grid_step) * rows}"]) if rows < whole else scene


def stability(
    scenes: Sequence[str],
    methods: Sequence[str] | None = None,
    *,
    limit_s: float = LIMIT_S,
    journal_path: Path | None = None,
    report: Callable[[int, int, str], None] | None = None,
) -> list[Cell]:
    """Run the methods of `CELLS` on every scene.

    Args:
        scenes: ids.
        methods: ids; all if None.
        limit_s: CPU seconds of a cell.
        journal_path: a file to which cells are appended, and whose cells are not run again.
        report: called with the number of finished cells, of all cells, and what runs now.
    """
    cells = [cell for cell in CELLS if methods is None or cell[0] in methods]
    journal = Journal(journal_path, repr((limit_s, SWINGS, _ORDERS)))  # orders decide the digits asked for
    finished = {cell.key: cell for cell in (Cell(**result) for result in journal)}
    total, ordered = len(cells) * len(scenes), []
    folders: dict[str, tuple[dict[str, Any], Path]] = {}
    unsolved: dict[str, str] = {}
    for name in scenes:
        if report is not None:
            report(len(finished), total, f"truth of {name}")
        scene = cut(load_scene(name))
        try:
            folders[name] = (scene.model_dump(exclude_none=True), golden_of(scene, TRUTH_DIGITS).path)
        except UnreachableError as error:
            unsolved[name] = f"The reference cannot solve it: {error}"
    for method, formulation, setting in cells:
        label = _label(method, formulation)
        requested = _digits_asked(method, setting)
        for name, reason in unsolved.items():
            finished[name, method, label] = Cell(name, method, label, "refused", None, requested, None, reason)
        remaining = [name for name in scenes if (name, method, label) not in finished]
        for cell in _cells(
            method, formulation, label, setting, [(name, *folders[name]) for name in remaining], limit_s
        ):
            if report is not None:
                report(len(finished), total, method)
            finished[cell.key] = cell
            journal.add(asdict(cell))
        ordered += [finished[(name, method, label)] for name in scenes]
    return ordered


def _label(method: str, formulation: str | None) -> str:
    number = {"heyoka_long_double": "long double", "heyoka_real128": "113 bits", "limbs": "100 bits"}
    return number.get(method, "double") + (f", {formulation}" if formulation else "")


def _cells(
    method: str, formulation: str | None, label: str, setting: float, cases: list[Case], limit_s: float
) -> Iterator[Cell]:
    """Run the cells of one method in child processes."""

    def failed(case: Case, timed_out: bool, reason: str) -> Cell:
        status = "out_of_time" if timed_out else "gave_up"
        return Cell(case[0], method, label, status, None, _digits_asked(method, setting), None, reason)

    arguments = (method, formulation, label, setting, limit_s)
    return isolated(cells_of, arguments, cases, PATIENCE * limit_s, failed)


def cells_of(
    emit: Emit, method: str, formulation: str | None, label: str, setting: float, limit_s: float, cases: list[Case]
) -> None:
    """Run a method on one scene after the other, in a child process, and send each cell."""
    for name, document, folder in cases:
        scene, golden = parse_scene(document), load(folder)
        truth = GridTruth(golden, float(scene.exact.t_end))
        states = np.column_stack([getattr(golden, column) for column in ("x", "y", "z", "vx", "vy", "vz")])
        traits = character(scene, truth.times, states[: len(truth.times)])
        used = (
            setting * 2 * math.pi / traits.fastest if METHODS[method].setting == "step" and traits.fastest else setting
        )
        bench = Bench(scene, truth, limit_s, repeats=1, transits=False)
        try:
            word = formulation or suited(scene, METHODS[method].formulations)
            row = bench.row(METHODS[method], word, used)
        except FoucaultError as error:
            row = Row(method, formulation or "", used, METHODS[method].setting, scene.inputs, "refused", str(error))
        emit(_judged(name, label, row, traits, float(scene.exact.length), limit_s))


def _judged(name: str, label: str, row: Row, traits: Character, length: float, limit_s: float) -> Cell:
    amplitude = traits.amplitude * length or length
    requested = _digits_asked(
        row.method, row.setting if row.kind != "step" else row.setting * traits.fastest / (2 * math.pi)
    )
    digits = None if row.error_m is None else (-math.log10(row.error_m / amplitude) if row.error_m else 40.0)
    status = row.status
    if status == EXTRAPOLATED:
        status, digits = "out_of_time", None
    elif status == OK and digits is not None and digits < requested - math.log10(WRONG):
        status = "silently_wrong"
    reason = reason_of(row, status, traits, digits, requested, limit_s)
    return Cell(name, row.method, label, status, digits, requested, row.cpu_s, reason, row.steps)


def _digits_asked(method: str, setting: float) -> float:
    kind = METHODS[method].setting
    if kind == "precision":
        return (setting - LOST_BITS) * math.log10(2)
    if kind == "tolerance":
        return -math.log10(setting)
    return -_ORDERS.get(method, 4) * math.log10(2 * math.pi * setting)


# proved by the tableaux: a pair p(p+1) of Fehlberg's advances with order p; order p + 1 only estimates the error
_ORDERS = {"rk4": 4, "rkng56": 5, "rkng67": 6, "rkmk4": 4, "gauss_legendre": 16}
