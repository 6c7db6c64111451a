"""Error against run time: every method over its ladder of settings on one scene.

>>> from compare.studies.study import study
>>> study("paris", ["rk4"], t_end=60)
Study(paris, 60 s: 7 of 7 rows measured)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from reference import Golden, Scene, load, load_scene, parse_scene
from reference.status import Status

from ..candidates.candidate import Candidate
from ..methods import METHODS, external, suited
from ..truth import Report, golden_of
from .campaign import Counted, Measurement, campaign, check_usable
from .grid import on_doubles
from .machine import machine
from .measure import Bench
from .method_errors import GridTruth
from .observed_order import orders
from .row import Row
from .users_program import file_row

LIMIT_S = 8.0  # CPU seconds of one run; a longer one is extrapolated from a part of the span
PATIENCE = 12  # wall-clock limit of one run, in multiples of the CPU limit
FORMULATIONS = ("momentum", "space", "spin", "plane", "angles", "lagrangian")
FORMULATIONS_OF = "heyoka_double"  # the method in which they are compared

Item = tuple[str, str, float]  # method, formulation, setting
Files = Mapping[str, tuple[Candidate, float | None]]  # by name: what a file holds, and the CPU seconds that are stated


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
        candidates: names of the rows that are files.
    """

    scene: Scene
    t_end: float
    limit_s: float
    golden: Golden
    rows: list[Row]
    machine: dict[str, str]
    programs: Mapping[str, str] = field(default_factory=dict)
    candidates: Sequence[str] = ()

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
            "candidates": list(self.candidates),
            "orders": [asdict(one) for one in orders(self.rows, float(self.golden.manifest.bounds.position_m))],
            "rows": [asdict(row) for row in self.rows],
        }


def plan(scene: Scene, methods: Sequence[str] | None = None, formulations: bool = True) -> list[Item]:
    """List the runs: each method over its settings in the formulation that suits it, and one method in all of them.

    Args:
        scene: steps are scaled to its swing, and a formulation must be able to describe its motion; read as doubles.
        methods: ids; all if None.
        formulations: whether to compare the formulations in one method as well.

    Raises:
        InputError: an unknown method, none that can run here, or a number that no double holds.
    """
    check_usable(methods)
    scene = scene.with_values(["inputs=binary64"])
    items: list[Item] = []
    for name in methods or METHODS:
        method = METHODS[name]
        items += [(name, suited(scene, method.formulations), setting) for setting in method.settings(scene)]
    if formulations and (methods is None or FORMULATIONS_OF in methods):
        one = METHODS[FORMULATIONS_OF]
        words = [word for word in FORMULATIONS if word in one.formulations]
        items += [(FORMULATIONS_OF, word, setting) for word in words for setting in one.settings(scene)]
    return list(dict.fromkeys(items))


@dataclass(frozen=True)
class _Runs(Measurement[Item, Row]):
    """Runs of methods and of programs on a scene, with their costs and errors."""

    document: dict[str, Any]
    golden: Path
    limit_s: float
    commands: Mapping[str, str]

    kind = Row

    @cached_property
    def _bench(self) -> Bench:
        scene = parse_scene(self.document)
        return Bench(scene, GridTruth(load(self.golden), float(scene.exact.t_end)), self.limit_s)

    def recipe_of(self, item: Item) -> tuple[Any, ...]:
        return (self.commands.get(item[0]),)

    def measure(self, item: Item) -> Row:
        name, formulation, setting = item
        method = external(self.commands[name], name=name) if name in self.commands else METHODS[name]
        return self._bench.row(method, formulation, setting)

    def failed(self, item: Item, status: Status, reason: str) -> Row:
        kind = "step" if item[0] in self.commands else METHODS[item[0]].setting
        return Row(*item, kind, self.document["inputs"], status, reason)


def study(
    scene: Scene | str,
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
        scene: an id, the path of a TOML file, or a scene; its inputs are read as binary64, because that is the problem
            which methods in double solve.
        methods: ids, each run over its settings; all if None.
        t_end: end of the span in s; the scene's own if None.
        formulations: whether to compare the formulations of the equations in one method as well.
        items: the runs, if others are wanted than `plan` lists from `methods` and `formulations`.
        programs: commands of programs of your own, by the names that `items` call them by.
        candidates: files of somebody's output, by the names of their rows.
        limit_s: CPU seconds for one run; a longer one is extrapolated from a part of the span.
        digits: of the truth if it has to be solved for; the scene's own if None.
        journal_path: a file to which rows are appended, and whose rows are not measured again.
        report: called with the number of finished rows, of all rows, and the method that runs now.
        solving: called with the simulated time reached, in s, while the truth is solved for.
        announce: called with a message if the truth has to be solved for.

    Raises:
        InputError: an unknown scene or method.
        UnreachableError: the truth cannot be solved for.
    """
    asked = load_scene(scene) if isinstance(scene, str) else scene
    span = [] if t_end is None else [f"run.t_end={t_end}"]
    problem = on_doubles(asked.with_values(["inputs=binary64", *span]))
    golden = golden_of(problem, digits or problem.run.digits, announce, solving, grid=True)
    commands = programs or {}
    runs = _Runs(
        [problem.model_dump(mode="json", exclude={"title", "source", "flags"}), limit_s],
        PATIENCE * limit_s,
        problem.model_dump(exclude_none=True),
        golden.path,
        limit_s,
        commands,
    )
    rows = campaign(runs, list(items or plan(asked, methods, formulations)), journal_path=journal_path, report=report)
    files = [file_row(name, *file, problem, golden) for name, file in (candidates or {}).items()]
    names = tuple(candidates or ())
    return Study(problem, float(problem.exact.t_end), limit_s, golden, [*rows, *files], machine(), commands, names)
