"""The shape of the house: floors, no circles, and one door for each heavy or dangerous library."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import structure
from places import ROOT

from reference import load_scene
from reference.engines import engine_names

SOURCES = structure.sources(ROOT)

# top first; a room imports from lower floors only
FLOORS = {
    "": [["foucault"], ["compare"], ["reference"]],
    "reference": [
        ["commands"],
        ["dataset", "sweeps"],
        ["solver"],
        ["engines", "enclosure"],
        ["model"],
        ["scenes", "status"],
        ["system"],
        ["numbers"],
        ["errors"],
        ["plain_text"],
    ],
    "reference/engines": [
        ["registry", "trajectory"],
        [*engine_names(), "octet"],
        ["row_zeros", "passages", "simd"],
        ["plan", "batch_interface"],
    ],
    "compare": [
        ["commands", "fixture"],
        ["testing", "papers"],
        ["report"],
        ["studies", "score"],
        ["methods", "diagnosis"],
        ["approximations", "truth"],
        ["candidates", "observed"],
    ],
}


def test_imports_lead_downwards():
    upwards = []
    for place, floors in FLOORS.items():
        rooms, arrows = structure.arrows(ROOT, place)
        assert sorted(room for floor in floors for room in floor) == sorted(rooms), place
        upwards += [(place, *arrow) for arrow in structure.upwards(arrows, floors)]
    assert upwards == []


def test_no_circle_among_files_nor_among_the_rooms_of_a_folder():
    assert structure.circles(*structure.modules(ROOT)) == []
    folders = {path.parent.relative_to(ROOT).as_posix() for path in SOURCES[1:]}
    assert {
        place: circles
        for place in folders
        if (circles := structure.circles(*structure.arrows(ROOT, place)))
    } == {}


def test_the_measure_of_the_structure_sees_a_circle_and_an_arrow_upwards(tmp_path):
    (tmp_path / "foucault.py").write_text("import reference.a\n")
    for name, text in (
        ("a", "from . import b\n"),
        ("b", "def late():\n    from .a import something\n"),
        ("c", ""),
    ):
        (tmp_path / "reference").mkdir(exist_ok=True)
        (tmp_path / f"reference/{name}.py").write_text(text)
    (tmp_path / "reference/__init__.py").write_text("")
    rooms, arrows = structure.arrows(tmp_path, "reference")
    assert (rooms, arrows) == ({"a", "b", "c"}, {("a", "b"), ("b", "a")})
    assert structure.circles(rooms, arrows) == [{"a", "b"}]
    assert structure.upwards(arrows, [["a"], ["b"], ["c"]]) == {("b", "a")}
    assert structure.floors({"a", "b", "c"}, {("a", "b"), ("b", "c")}) == [{"a"}, {"b"}, {"c"}]


def imported(path: Path) -> set[str]:
    """Top-level packages that a file imports anywhere; relative imports count as their own package."""
    names = set()
    for node in structure.imports(path):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names


DOORS = {
    "heyoka": "reference/engines/heyoka/",
    "flint": "reference/enclosure/",
    "pyarrow": "reference/sweeps/parquet.py",
    "distributed": "reference/sweeps/cluster.py",
}


def test_what_is_behind_the_doors_of_the_diagnosis_is_imported_by_nobody_else():
    inside = ROOT / "compare/diagnosis"
    outside = [path for path in SOURCES if inside not in path.parents]
    assert [
        path
        for path in outside
        for target in structure.imported(path, ROOT)
        if inside in target.parents
    ] == []


def test_a_library_has_one_door():
    used = [
        (library, path.relative_to(ROOT).as_posix())
        for path in SOURCES
        for library in imported(path) & {*DOORS}
    ]
    assert {library for library, _ in used} == {*DOORS}
    assert [(library, path) for library, path in used if not path.startswith(DOORS[library])] == []


# the names of reference that compare uses: what changes here, changes for others too
PUBLIC = {
    "reference": "DatasetError FoucaultError Golden InputError IntegrationError Ranges Scene Solution "
    "Swept UnreachableError load load_ranges load_scene parse_scene prove_ranges scene_ids "
    "solve trajectory write",
    "reference.commands.cautions": "warn",
    "reference.commands.layout": "TextColumn echo facts paragraph table",
    "reference.commands.options": "Conflict as_command refuse_conflicts",
    "reference.commands.progress": "progress",
    "reference.commands.terminal": "AsJson Assignments BESIDE_RANGES Cluster EndTime SceneWord Sections "
    "Uncertain Workers check_workers chosen completion emit option refuse "
    "replacements scene_argument stoppable widths_by_name",
    "reference.dataset.golden": "Dense WITHIN dense",
    "reference.dataset.manifest": "FUNCTION MANIFEST",
    "reference.dataset.place": "RANGES changes changes_in golden_folder",
    "reference.dataset.render": "MEANING",
    "reference.dataset.sheets": "by_field",
    "reference.engines.heyoka.conversions": "Numbers",
    "reference.engines.heyoka.model": "RoundedModel",
    "reference.engines.heyoka.propagator": "AutonomousSystem Propagator compiled",
    "reference.engines.registry": "batches engines",
    "reference.engines.trajectory": "MAX_STEPS Variants",
    "reference.errors": "BeyondDoublesError Described NOTHING NoEffectError Stopped checked_path counted did_you_mean "
    "in_words usable",
    "reference.model.algebra": "Functions State add cross dot minus plus product scale subtract",
    "reference.model.carried": "carried",
    "reference.model.constants": "Constants Vector axis_distance centrifugal_products constants constants_in_double "
    "is_zero turn_and_pull",
    "reference.model.force": "acceleration energy force invariant rates tension",
    "reference.model.formulations": "FORMULATIONS",
    "reference.model.sections": "form_of",
    "reference.model.start": "Angle Start at_angles scaled",
    "reference.numbers.columns": "POSITION STATE VELOCITY",
    "reference.numbers.precision": "Array DOUBLE DOUBLE_BITS GUARD_BITS LONG_DOUBLE LONG_DOUBLE_BITS "
    "NumberType bits_of context digits_that_hold fixed_decimal real "
    "to_fraction to_mpf",
    "reference.numbers.table": "Table",
    "reference.numbers.zeros": "XDOT",
    "reference.plain_text": "finite plain plain_json plain_lines shortened",
    "reference.scenes.fields": "LEVELS RunTable",
    "reference.scenes.inputs": "GRAVITY_MEANINGS GravityIs Inputs",
    "reference.scenes.scene": "AnyScene MAX_ROWS as_scene field_names unit_of",
    "reference.scenes.shipped": "DATA_VERSION WITHOUT_FUNCTION data_root golden_root in_checkout seals",
    "reference.solver.choice": "need_heyoka",
    "reference.solver.doubles": "TOLERANCE double_reach",
    "reference.solver.ranges": "Intervals",
    "reference.solver.sensitivity": "Sensitivity digits_lost",
    "reference.solver.solve": "roughly",
    "reference.solver.swing": "FAST LEAN NO_SWING ONE_SIDE SMALL UNDECIDED left_out",
    "reference.solver.uncertain": "exact_texts widths_of",
    "reference.status": "Status",
    "reference.sweeps.axes": "WORD_FIELDS",
    "reference.sweeps.background": "compile_for_the_next",
    "reference.sweeps.request": "Request Settings",
    "reference.sweeps.store": "Store",
    "reference.sweeps.sweep": "checked_request run",
    "reference.system": "cache",
    "reference.system.cache": "arrays kept",
    "reference.system.channel": "ACTIVITY",
    "reference.system.checksums": "SUMS is_sound sealed_line sums_text",
    "reference.system.documents": "json_document json_lines open_at_once texts_of",
    "reference.system.imports": "Registry install_command lazy missing needed switched_off",
    "reference.system.interruption": "terminable",
    "reference.system.workers": "Emit Worker usable_cores",
    "reference.system.workspace": "replace_file workspace",
}


def test_compare_uses_the_public_names_of_reference_alone():
    used: dict[str, set[str]] = {}
    for path in SOURCES:
        if path.is_relative_to(ROOT / "compare"):
            for node in structure.imports(path):
                if isinstance(node, ast.Import):
                    assert not [
                        one.name for one in node.names if one.name.startswith("reference")
                    ], path
                elif node.level == 0 and (node.module or "").startswith("reference"):
                    used.setdefault(str(node.module), set()).update(one.name for one in node.names)
    assert {module: " ".join(sorted(names)) for module, names in used.items()} == {
        module: " ".join(sorted(names.split())) for module, names in PUBLIC.items()
    }


HEAVY = ("heyoka", "flint", "scipy", "matplotlib", "numba", "pyarrow", "distributed")


STARTS = (
    "import compare, reference",
    "import compare.studies.approximation_limits, compare.report.approximations",
    "import foucault; foucault.commands()(['--help'], standalone_mode=False)",
)


def test_starting_loads_nothing_heavy():
    told = "print('loaded', [name for name in HEAVY if name in sys.modules])"
    code = "\n".join([f"import sys\nHEAVY = {HEAVY}", *(f"{script}\n{told}" for script in STARTS)])
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    loaded = [line for line in done.stdout.splitlines() if line.startswith("loaded ")]
    assert dict(zip(STARTS, loaded, strict=True)) == dict.fromkeys(STARTS, "loaded []")


def test_an_engine_at_work_in_a_process_of_its_own_reads_no_scene():
    """Without what checks scenes such a process takes 0.6 to 0.8 of the CPU time to start."""
    code = "import sys, reference.engines.heyoka.run, reference.enclosure.prove; print('pydantic' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert done.stdout == "False\n"


def test_every_file_begins_with_a_line_that_says_what_it_holds():
    docstrings = {path: ast.get_docstring(structure.tree(path)) or "\n" for path in SOURCES}
    firsts = {
        path.relative_to(ROOT).as_posix(): text.splitlines()[0] for path, text in docstrings.items()
    }
    good = re.compile(r"(?!What ).{,117}[.?]")
    assert {name: first for name, first in firsts.items() if not good.fullmatch(first)} == {}


def test_a_class_name_names_one_class():
    places = {}
    for path in SOURCES:
        for node in ast.walk(structure.tree(path)):
            if isinstance(node, ast.ClassDef):
                places.setdefault(node.name, []).append(path.relative_to(ROOT).as_posix())
    assert {name: files for name, files in places.items() if len(files) > 1} == {}


def test_every_scene_has_its_own_file_named_by_its_id():
    paths = sorted((ROOT / "data/scenes").glob("*.toml"))
    assert paths
    assert [load_scene(path).id for path in paths] == [path.stem for path in paths]
