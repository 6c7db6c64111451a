"""The code that has to be read to believe a proof: it says so, imports little, and nothing in it rounds on its own."""

import ast
import re
import subprocess
import sys

import pytest
from places import ROOT

TRUSTED = ROOT / "reference/enclosure/trusted"  # all that a proof rests on, and nothing else
FILES = sorted(path.stem for path in TRUSTED.glob("*.py") if path.stem != "__init__")
THEOREM = (ROOT / "reference/enclosure/THEOREM.md").read_text(encoding="utf-8")
TEXT, _, TABLE = THEOREM.partition("## 14. From the text to the code")
LIBRARY = {
    "array",
    "bisect",
    "collections.abc",
    "copy",
    "dataclasses",
    "flint",
    "fractions",
    "functools",
    "itertools",
}
LIBRARY |= {"json", "typing", "weakref"}
# declarations; the compiler of the sums of digits, which an audit checks; proposals of where a zero may be
OUTSIDE = {"numbers.taylor_step", "scenes.inputs", "system.machine_code", "guess"}
# they hold integers in arrays of NumPy, and nothing else in them
ARRAYS = {"audit", "digits", "defect"}
FLOATS = {"printed"}  # reads inputs as the doubles nearest to decimals, where a scene asks for that


def tree_of(name):
    return ast.parse((TRUSTED / f"{name}.py").read_text(encoding="utf-8"))


def imports_of(name):
    """Yield what a trusted file imports: the module, and whether it is one of this project."""
    for node in ast.walk(tree_of(name)):
        if isinstance(node, ast.Import):
            yield from ((alias.name, False) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module, node.level > 0


@pytest.mark.parametrize("name", FILES)
def test_a_trusted_file_says_so(name):
    assert ast.get_docstring(tree_of(name)).startswith("TRUSTED.")


@pytest.mark.parametrize("name", FILES)
def test_a_trusted_file_holds_no_floating_point(name):
    for node in ast.walk(tree_of(name)):
        assert not (isinstance(node, ast.Constant) and isinstance(node.value, float | complex)), (
            node.lineno
        )
        assert not (isinstance(node, ast.Name) and node.id == "float" and name not in FLOATS), (
            node.lineno
        )


@pytest.mark.parametrize("name", FILES)
def test_a_trusted_file_imports_trusted_files_and_little_else(name):
    allowed = LIBRARY | {"__future__"} | ({"numpy"} if name in ARRAYS else set())
    if name == "audit":
        allowed |= {"secrets"}  # draws what no fault can know
    for module, ours in imports_of(name):
        assert module in ({*FILES, *OUTSIDE} if ours else allowed), module


def defined_in(name):
    """Yield the functions of a trusted file, those of a class with its name."""
    for node in tree_of(name).body:
        if isinstance(node, ast.FunctionDef):
            yield node.name
        elif isinstance(node, ast.ClassDef):
            yield from (
                f"{node.name}.{x.name}" for x in node.body if isinstance(x, ast.FunctionDef)
            )


def test_every_function_of_the_theorems_table_exists():
    named = re.findall(r"`(\w+)\.([\w.]+)`", TABLE)
    assert len(named) > 30
    for file, function in named:
        assert function in {*defined_in(file)}, f"{file}.{function}"


def test_every_lemma_and_theorem_is_in_the_table():
    stated = re.findall(r"^(?:\*\*|## \d+\. )((?:Lemma|Theorem) [\dA-Z.]*[\dA-Z])", TEXT, re.M)
    in_table = re.findall(r"^\| ((?:Lemma|Theorem) [\dA-Z.]+) \|", TABLE, re.M)
    assert {"Theorem C", "Lemma 0", "Lemma 11.4", "Lemma 12.2"} <= set(stated)
    assert {*in_table} == {*stated}


def numbers_in(text):
    """Return the numbers of equations in brackets: (4.2), (11.2a), and both of (12.4a, b)."""
    numbers = set()
    for number, letter, more in re.findall(r"\((\d+\.\d+)([a-z]?)((?:, [a-z])*)[);]", text):
        numbers.add(number + letter)
        numbers |= {number + other for other in more.split(", ")[1:]}
    return numbers


def test_an_equation_that_the_code_names_is_one_of_the_text():
    for name in FILES:
        code = (TRUSTED / f"{name}.py").read_text(encoding="utf-8")
        comments = "\n".join(re.findall("#.*", code))
        assert numbers_in(comments) <= numbers_in(TEXT), name


# what evaluates a golden function makes (10.3a, b); (12.1a) to (12.1c) are for proofs alone
NOT_IN_TRUSTED_CODE = {"10.3a", "10.3b", "12.1a", "12.1b", "12.1c"}


def test_an_equation_of_the_text_that_has_a_number_is_one_that_the_code_names():
    named = set()
    for name in FILES:
        code = (TRUSTED / f"{name}.py").read_text(encoding="utf-8")
        named |= numbers_in("\n".join(re.findall("#.*", code)))
    assert numbers_in(TEXT) - named == NOT_IN_TRUSTED_CODE


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
    names = "trusted.function", "fit", "trusted.box", "prove_box", "trusted.derivatives", "trusted.sections"
    print(*(f"reference.enclosure.{name}" in sys.modules for name in names))
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert done.stdout.splitlines()[0] == ""
    assert done.stdout.split() == 6 * ["False"] + 2 * ["True"] + 4 * ["False"]
