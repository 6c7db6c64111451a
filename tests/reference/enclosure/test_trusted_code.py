"""The code that has to be read to believe a proof: it says so, imports little, and nothing in it rounds on its own."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest
from places import ROOT

import reference.enclosure

HOME = Path(reference.enclosure.__file__).parent
TRUSTED = ("balls", "bound", "course", "digits", "enclosed_transits", "printed", "six_columns")
ARRAYS = {"digits": {"numpy"}, "bound": {"numpy"}}  # integers only
PROPOSALS = {"guess"}  # untrusted: what it returns is only where an interval Newton step begins
OF_FUNCTIONS = "function"  # what a proof without a golden function does not import
OF_BOXES = ("box", "printed_box", "derivatives")  # what a proof of a point does not import
OF_SECTIONS = "sections"  # what a proof of xdot = 0 alone does not import
APART = (OF_FUNCTIONS, *OF_BOXES, OF_SECTIONS)


def source(name):
    return (HOME / f"{name}.py").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", [*TRUSTED, *APART])
def test_trusted_code_says_so_and_holds_no_floating_point(name):
    tree = ast.parse(source(name))
    assert ast.get_docstring(tree).startswith("TRUSTED.")
    for node in ast.walk(tree):
        assert not (isinstance(node, ast.Constant) and isinstance(node.value, float | complex)), node.lineno
        # `printed` reads inputs as the doubles nearest to decimals, where a scene asks for that
        assert not (isinstance(node, ast.Name) and node.id == "float" and name != "printed"), node.lineno
        modules = [a.name for a in node.names] if isinstance(node, ast.Import) else []
        modules += [node.module] if isinstance(node, ast.ImportFrom) else []
        banned = {"math", "cmath", "numpy", "numba", "mpmath", "scipy", "decimal", "heyoka"} - ARRAYS.get(name, set())
        assert not banned & set(modules), node.lineno


@pytest.mark.parametrize("name", [*TRUSTED, *APART])
def test_trusted_code_imports_nothing_untrusted(name):
    declarations = {"shapes", "numbers.taylor_step", "scenes.inputs", "system.machine_code"}
    library = {"collections.abc", "fractions", "functools", "itertools", "json", "typing", "weakref", "flint"}
    library |= {OF_FUNCTIONS: {"array"}}.get(name, {"bisect", "copy", "dataclasses"} if name in OF_BOXES else set())
    allowed = (
        library
        | declarations
        | PROPOSALS
        | ARRAYS.get(name, set())
        | {*TRUSTED}
        | ({*OF_BOXES, OF_SECTIONS} if name in OF_BOXES else set())
    )
    for node in ast.walk(ast.parse(source(name))):
        if isinstance(node, ast.ImportFrom):
            assert node.module in allowed, node.module
        assert not isinstance(node, ast.Import) or node.names[0].name == "numpy"


def test_a_lower_level_imports_nothing_of_a_proof_and_a_proof_of_a_point_only_what_it_is_asked_for():
    """In a process of its own, as others import it here."""
    program = """
import sys
from fractions import Fraction
import reference
scene = reference.load_scene("paris", ["run.t_end=10", "run.grid_step=5"])
reference.solve(scene, digits=12, level="confirmed")
print(*(m for m in sys.modules if m == "flint" or "enclosure" in m or m == "reference.solver.enclosed"))
from reference.enclosure import enclose
from reference.solver.proof_steps import Feed
for function in (False, True):
    feed = Feed(scene.exact, tuple(scene.exact.grid), "limbs")
    enclose(scene.exact, scene.exact.grid, radius=Fraction(1, 10**20), approximant=feed, function=function)
    names = "function", "fit", "box", "prove_box", "derivatives", "sections"
    print(*(f"reference.enclosure.{name}" in sys.modules for name in names))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.splitlines()[0] == ""
    assert done.stdout.split() == 6 * ["False"] + 2 * ["True"] + 4 * ["False"]
