"""Every dataset that ships, one a scene: which are missing or not sealed; one of them made, for others to write."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..engines import AUTO
from ..engines.plan import Report
from ..errors import FoucaultError, IntegrationError, UnreachableError
from ..numbers.columns import POSITION
from ..scenes.scene import Scene, load_scene
from ..scenes.shipped import index, scene_ids, seals
from ..solver.solution import Solution, grid_decimals
from ..solver.solve import solve
from ..status import Status
from ..system.workers import Pool
from .files import read_files
from .manifest import Content
from .place import dataset_id, default_folder, is_of_shipped_scene, ships
from .record import Making
from .render import check_proved, render
from .sheets import column_bounds, scene_inputs

Row = dict[str, Any]

BINARY64 = ".binary64"


@dataclass(frozen=True)
class Job:
    """A dataset to be made: its scene, its id and its folder."""

    scene: Scene
    name: str
    folder: Path

    def row(self, status: Status, reason: str | None = None) -> Row:
        """Return what `generate --all --json` says of the dataset, but for what was measured."""
        identity = {"dataset": self.name, "scene": self.scene.id, "out": str(self.folder)}
        return {**identity, "status": status.value, "reason": reason}


def jobs(replaced: Sequence[str], out: Path | None) -> list[Job]:
    """Return all datasets that ship, those of the longest spans first: of each scene, and of sealed other readings.

    Args:
        replaced: fields of every scene, each as section.key=value.
        out: the folder of all; by default each has that which `generate` writes it to.

    Raises:
        InputError: a replaced field is wrong.
    """
    readings = [name.removesuffix(BINARY64) for name in seals() if name.endswith(BINARY64)]
    scenes = [load_scene(name, replaced) for name in scene_ids()]
    scenes += [load_scene(name, ["inputs=binary64", *replaced]) for name in readings]
    every = []
    for scene in scenes:
        name = dataset_id(scene)
        folder = out / name if out is not None else default_folder(scene, name)
        every.append(Job(scene, name, folder))
    return sorted(every, key=lambda job: (-job.scene.exact.t_end, job.name))


def is_done(job: Job) -> bool:
    """Return whether the dataset is there, sealed, of the same inputs; where it ships, under the seal in the index."""
    try:
        files = read_files(job.folder)
    except FoucaultError:
        return False
    sealed = not ships(job.folder) or seals().get(job.name) == files.manifest.seal
    same = scene_inputs(files.scene) == scene_inputs(job.scene) and files.scene.inputs == job.scene.inputs
    return sealed and same and files.manifest.id == job.name


def made(job: Job) -> tuple[Row, dict[str, Content]]:
    """Solve a scene; return what became of it, and the files of its dataset as text, none if it could not be made."""
    try:
        making = making_of(job.scene, job.name, job.folder)
        solution = solved(job.scene, making)
        texts = render(solution, job.name, tables=making.tables)
        check_proved(texts, solution)  # here, where the proof was made; what is written has these hashes
        return job.row(Status.OK) | summary(solution, job.folder), texts
    except UnreachableError as error:
        status = Status.GAVE_UP if isinstance(error, IntegrationError) else Status.UNREACHABLE
        return job.row(status, str(error)), {}
    except FoucaultError as error:
        return job.row(Status.INVALID, str(error)), {}


def making_of(scene: Scene, name: str, folder: Path) -> Making:
    """Return how a dataset is made if nothing else is asked for: what ships as the index says, wherever it is written.

    A new one that is to ship is made with limbs, so that it and heyoka's confirmation are of two codes.
    """
    if ships(folder) or is_of_shipped_scene(scene, name):
        entry = index().get(name)
        return Making.of(entry["options"]) if entry else Making()
    return Making(AUTO, confirm="sampled", function=True)


def solved(scene: Scene, making: Making, report: Report | None = None) -> Solution:
    """Solve a scene in the way in which its dataset is to be made.

    Raises:
        InputError: the engine is not installed; no other one takes its place.
        UnreachableError: the level or the digits cannot be reached.
    """
    proving = scene.run.level == "enclosed"
    asked: dict[str, Any] = {"audit": making.audit, "confirm": making.confirm, "function": making.function}
    return solve(scene, engine=making.engine, **(asked if proving else {}), report=report, uncertain=None)


def isolated(job: Job) -> tuple[Row, dict[str, Content]]:
    """Make a dataset in a process that is started for it: the solver is not made for several threads."""
    with Pool(1) as pool:
        result: tuple[Row, dict[str, Content]] = pool.submit(made, job).result()
    return result


def summary(solution: Solution, folder: Path) -> Row:
    """Return what `generate --json` says of a dataset, also what was measured on the way and stands in no file."""
    bounds = column_bounds(solution.grid, grid_decimals(solution))
    proof_s = sum((solution.proof.cpu_s if solution.proof else {}).values())
    checks_s = sum(check.cpu_s for check in solution.checks) + proof_s
    guard = None
    if solution.guard is not None:  # its distances are fractions
        guard = {
            name: float(value) if isinstance(value, Fraction) else value for name, value in vars(solution.guard).items()
        }
    return {
        "scene": solution.scene.id,
        "out": str(folder),
        "level": solution.level,
        "digits": solution.scene.run.digits,
        "engine": solution.run.engine,
        "confirmed": solution.proof.confirmed if solution.proof else None,
        "transits": len(solution.directions),
        "bound_m": max(float(bounds[column]) for column in POSITION),
        "cpu_s": solution.pilot_s + solution.run.cpu_s + checks_s,
        "run_cpu_s": solution.run.cpu_s,
        "check_cpu_s": checks_s,
        "pilot_cpu_s": solution.pilot_s,
        "compile_s": solution.run.compile_s,
        "number": solution.run.number,
        "steps": solution.run.steps,
        "guard": guard,
    }
