"""Error against run time: every method over its settings on one scene, and the observed order of its runs.

>>> from compare.studies.study import study
>>> study("paris", ["rk4"], t_end=60)
Study(paris, 60 s: 7 of 7 rows measured)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from reference import Golden, Scene
from reference.scenes.scene import AnyScene, as_scene
from reference.status import Status

from ..candidates.candidate import Candidate
from ..methods import METHODS
from ..methods.external import external
from ..observed.least_squares import LEAST_POINTS, PowerLaw, power_law
from ..truth import Progress, Report, golden_of
from .campaign import Counted, campaign, machine
from .measure import Bench, OnScene
from .row import Row, grouped
from .study_plan import Item, on_doubles, plan
from .users_program import FILE, file_row

LIMIT_S = 8.0  # CPU seconds of one run; a longer one is extrapolated from a part of the span
_PATIENCE = 12  # wall-clock limit of one run, in multiples of the CPU limit
# standard error up to which an order is told from its neighbours: twice that is half an order
_DISTINGUISHED = 0.25
# errors within this factor of a method's least are taken for rounding, or for the reference's bound
_ABOVE_LEAST = 10.0
# by name: what a file holds, and the CPU seconds that are stated
Files = Mapping[str, tuple[Candidate, float | None]]


@dataclass(frozen=True)
class Study:
    """A finished study.

    Attributes:
        scene: as the methods were given it, with inputs read as binary64.
        t_end: end of the span in s.
        limit_s: CPU seconds that one run may take.
        golden: the golden dataset that errors are measured against.
        rows: every method at every setting, failed ones included.
        programs: commands of the user's programs, by the names that the rows call them by.
        machine: processor, system and versions of libraries.
    """

    scene: Scene
    t_end: float
    limit_s: float
    golden: Golden
    rows: list[Row]
    machine: dict[str, str]
    programs: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        """Return the scene, the span, and how many rows have a cost and an error."""
        measured = sum(row.measured and row.cpu_s is not None for row in self.rows)
        return f"Study({self.scene.id}, {self.t_end:g} s: {measured} of {len(self.rows)} rows measured)"

    def document(self) -> dict[str, Any]:
        """Return the JSON document, whose keys are documented."""
        return {
            "scene": self.scene.id,
            "title": self.scene.title,
            "t_end": self.t_end,
            "limit_s": self.limit_s,
            "reference": {
                "level": self.golden.manifest.level,
                "bound_m": float(self.golden.manifest.bounds.position_m),
                "transits": int((self.golden.transits["t"] < self.t_end).sum()),
            },
            "machine": self.machine,
            "programs": dict(self.programs),
            "candidates": [row.method for row in self.rows if row.kind == FILE],
            "orders": [
                asdict(order)
                for order in orders(self.rows, float(self.golden.manifest.bounds.position_m))
            ],
            "rows": [asdict(row) for row in self.rows],
        }


@dataclass(frozen=True)
class _MethodRuns(OnScene[Item, Row]):
    """Runs of methods and of programs on a scene, with their costs and errors."""

    limit_s: float

    kind = Row

    def measure(self, item: Item) -> Row:
        name, formulation, setting = item
        bench = Bench(self.scene, self.truth, self.limit_s)
        if name in self.commands:
            row = bench.row(external(self.commands[name], name=name), None, setting)
            return replace(row, formulation=formulation)
        return bench.row(METHODS[name], formulation, setting)

    def failed(self, item: Item, status: Status, reason: str) -> Row:
        kind = "step" if item[0] in self.commands else METHODS[item[0]].setting
        return Row(*item, kind, self.scene.inputs, status, reason)


def study(
    scene: AnyScene,
    methods: Sequence[str] | None = None,
    *,
    t_end: float | None = None,
    formulations: bool = True,
    items: Sequence[Item] | None = None,
    programs: Mapping[str, str] | None = None,
    candidates: Files | None = None,
    limit_s: float = LIMIT_S,
    digits: int | None = None,
    journal_path: Path | None = None,
    report: Counted | None = None,
    solving: Report | None = None,
    announce: Callable[[str], None] | None = None,
) -> Study:
    """Measure error against run time of methods on a scene: `study("paris", ["rk4"], t_end=600).rows`.

    Args:
        scene: a scene, its id, the path of a TOML file, or nested mappings; its inputs are read as
            binary64, because that is the problem which methods in double solve.
        methods: ids, each run over its settings; all if None.
        t_end: end of the span in s; the scene's own if None.
        formulations: whether to compare the formulations of the equations in one method as well.
        items: the runs, if they differ from those that `plan` lists from `methods` and `formulations`.
        programs: commands of programs of your own, by the names that `items` call them by.
        candidates: files of somebody's output, by the names of their rows.
        limit_s: CPU seconds for one run; a longer one is extrapolated from a part of the span.
        digits: digits of the truth if the scene must be solved; the scene's own if None.
        journal_path: a file to which rows are appended; rows in it are not measured again.
        report: called with the number of finished rows, of all rows, and the method that runs now.
        solving: called with the simulated time reached, in s, while the scene is solved.
        announce: called with a message if the scene must be solved.

    Raises:
        InputError: an unknown scene or method.
        UnreachableError: the scene cannot be solved.
    """
    requested = as_scene(scene)
    if isinstance(methods, str):
        methods = methods.split(",")
    span = [] if t_end is None else [f"run.t_end={t_end}"]
    problem = on_doubles(requested.with_values(["inputs=binary64", *span]))
    progress = Progress(announce, solving)
    golden = golden_of(problem, digits or problem.run.digits, progress, grid=True)
    commands = programs or {}
    recipe = [problem.model_dump(mode="json", exclude={"title", "source", "flags"}), limit_s]
    runs = _MethodRuns(recipe, _PATIENCE * limit_s, commands, problem, golden.path, limit_s)
    chosen = plan(requested, methods, formulations) if items is None else items
    rows = campaign(runs, chosen, journal_path=journal_path, report=report)
    rows += [file_row(name, *file, problem, golden) for name, file in (candidates or {}).items()]
    return Study(problem, float(problem.exact.t_end), limit_s, golden, rows, machine(), commands)


@dataclass(frozen=True)
class ObservedOrder:
    """Declared and observed order of a method in a formulation.

    Attributes:
        method: its id.
        formulation: of the equations of motion.
        declared: by the method; None of a user's program.
        observed: exponent of the error against the steps, or the evaluations where steps are not
            told, or the inverse of the step where neither is; None where the runs do not tell it
            from its neighbours.
        standard_error: of the fit.
        settings: number of settings that were fitted.
    """

    method: str
    formulation: str
    declared: int | None
    observed: float | None = None
    standard_error: float | None = None
    settings: int = 0


def orders(rows: Sequence[Row], bound_m: float) -> list[ObservedOrder]:
    """Return the orders of all methods that declare one, each in each of its formulations, and of users' programs.

    Args:
        rows: of a study.
        bound_m: of the reference, in m.
    """
    groups = grouped(filter(_has_order, rows), lambda row: (row.method, row.formulation))
    return [_order(*key, group, bound_m) for key, group in groups.items()]


def _order(method: str, formulation: str, rows: Sequence[Row], bound_m: float) -> ObservedOrder:
    laws = [law for law in _laws(rows, bound_m) if law.standard_error <= _DISTINGUISHED]
    law = max(laws, key=lambda law: (law.points, -law.standard_error), default=None)
    observed = () if law is None else (-law.exponent, law.standard_error, law.points)
    return ObservedOrder(method, formulation, _declared(method), *observed)


def _has_order(row: Row) -> bool:
    """Return whether a method declares an order, or is a user's program whose setting is its step; 0 is none."""
    of_program = row.method not in METHODS and row.kind == "step" and row.setting > 0
    return of_program or _declared(row.method) is not None


def _declared(method: str) -> int | None:
    return METHODS[method].order if method in METHODS else None


def _count(row: Row) -> float | None:
    """Return the steps of a run, or what is in proportion to them."""
    by_step = 1 / row.setting if row.kind == "step" else None
    return row.steps or row.rhs_evaluations or by_step


def _laws(rows: Sequence[Row], bound_m: float) -> Iterator[PowerLaw]:
    """Yield the fit to each run of neighbouring settings whose error falls and is above rounding."""
    points = []
    for row in rows:
        count = _count(row)
        if row.status is Status.OK and row.error_m and count:
            points.append((count, row.error_m))
    points.sort()
    least = max(bound_m, min((error for _, error in points), default=0.0))
    above = [point for point in points if point[1] > _ABOVE_LEAST * least]
    for first in range(len(above)):
        for end in range(first + LEAST_POINTS, len(above) + 1):
            counts, errors = zip(*above[first:end], strict=True)
            if len(set(counts)) == len(counts) and list(errors) == sorted(errors, reverse=True):
                yield power_law(counts, errors)
