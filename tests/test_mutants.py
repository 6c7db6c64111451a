"""The mutations of a file, and the table of those that are equivalent to the source."""

from __future__ import annotations

import ast
import importlib.util

import mutations
import pytest
from mutations import equivalents, mutations_of, noticed, stale
from places import ROOT

spec = importlib.util.spec_from_file_location("mutants", ROOT / "tests/mutants.py")
mutants = importlib.util.module_from_spec(spec)
spec.loader.exec_module(mutants)


@pytest.fixture
def written(tmp_path):
    """Write a file; return its mutations as texts without the file's name."""
    path = tmp_path / "a_file.py"

    def write(text):
        path.write_text(text)
        return {
            str(mutation).removeprefix(f"{path} "): mutation for mutation in mutations_of(str(path))
        }

    return write


@pytest.mark.parametrize(("source", "change", "result"), [
    ("y = a + b - c", "drop term: a", "y = b - c"),
    ("y = a + b - c", "drop term: b", "y = a - c"),
    ("y = a - c", "drop term: a", "y = -c"),
    ("y = add(a, b, c)", "drop term: b", "y = add(a, c)"),
    ("y = a * b / c", "drop factor: c", "y = a * b"),
    ("y = a * b / c", "drop factor: a", "y = b / c"),
    ("y = times(a, v)", "drop factor: a", "y = v"),
    ("y = a ** 2", "drop factor: 2", "y = a"),
    ("y = a + b", "flip sign: b", "y = a - b"),
    ("y = f(-x)", "flip sign: -x", "y = f(x)"),
    ("y = turned(v, 1)", "flip sign: turned(v, 1)", "y = turned(v, -1)"),
    ("y = upper(x)", "drop call: upper(x)", "y = x"),
    ("y = x.sqrt()", "drop call: x.sqrt()", "y = x"),
    ("y = max(a, b)", "drop alternative: a", "y = b"),
    ("y = a.union(b)", "drop alternative: b", "y = a"),
    ("y = [*a, b]", "drop element: *a", "y = [b]"),
    ("y = cross(a, b)", "swap neighbours: a, b", "y = cross(b, a)"),
    ("y = x.low", "exchange name: x.low", "y = x.high"),
    ("y = x[1:]", "next index: 1:", "y = x[0:]"),
    ("y = a < b", "opposite: a >= b", "y = a >= b"),
    ("y = a < b", "boundary: a <= b", "y = a <= b"),
    ("y = a and b", "drop condition: a", "y = b"),
    ("y = a if b else c", "always or never: b is True", "y = a if True else c"),
    ("y = f(3)", "change number: f(3): 3 is 6", "y = f(6)"),
    ("y = f(True)", "change number: f(True): not True", "y = f(False)"),
    ("demand(a, b)", "drop statement: demand(a, b)", "pass"),
    ("a.b = c", "drop statement: a.b = c", "pass"),
])  # fmt: skip
def test_an_operator_makes_one_change(source, change, result, written):
    assert written(source)[f"module, {change}"].source() == result


def test_a_mutation_stays_the_same_when_lines_are_unfolded(written):
    folded = "def f(a, b):\n    c, d = a * a + b, g(a + b)\n    return c + d, g(a + b)"
    unfolded = """
# a comment
def f(a, b):
    c = (
        a * a
        + b
    )

    # (1.2)
    d = g(a + b)
    return c + d, g(a + b)
"""
    before = written(folded)
    after = written(unfolded)
    lost = set(before) - set(after)
    assert lost == {"f, swap neighbours: a * a + b, g(a + b)"}, (
        "two values that were assigned at once"
    )
    assert before["f, drop factor: a"] in after.values()
    assert after["f, drop term: b (3)"].source().splitlines()[-1] == "    return (c + d, g(a))"


def test_what_is_for_people_or_for_types_is_left_alone(written):
    source = """
if TYPE_CHECKING:
    y = 1 + 2
def f(x: g(3)) -> g(4):
    raise ValueError(f"{x + 1}")
class C:
    def __repr__(self):
        return 1 + 2
"""
    assert {mutation.change for mutation in written(source).values()} == set()


def test_the_source_of_a_mutation_is_the_file_with_its_change_and_no_other():
    for file in mutants.tested_files():
        every = mutations_of(file)
        assert len(set(every)) == len(every)
        whole = ast.unparse(ast.parse((ROOT / file).read_text())).splitlines()
        changed = mutations.drawn(every, seed=1)[0].source().splitlines()
        assert whole != changed
        if len(whole) == len(changed):
            assert sum(before != after for before, after in zip(whole, changed, strict=True)) == 1


def test_a_mutated_module_is_noticed_if_its_check_fails_or_does_not_end(written):
    every = written(
        "def f(n):\n    while n > 0:\n        n = n - 1\n    return n + 1\ndef g():\n    return 1"
    )

    def check(module):
        assert module.f(3) == 1

    assert isinstance(noticed(every["f, drop term: 1"], check, cpu_s=0.1), mutations.CpuLimitError)
    assert isinstance(noticed(every["f, drop term: 1 (2)"], check), AssertionError)
    assert noticed(every["g, drop statement: return 1"], check) is None


def test_every_equivalent_has_a_reason_and_is_one_mutation_of_todays_source():
    assert stale() == []


def test_an_entry_that_is_no_mutation_or_without_a_reason_or_twice_is_found():
    entry, why = next(iter(equivalents().items()))
    for wrong, said in (
        ([("gone.py f, drop term: a", why)], "no mutation of today's source is gone.py"),
        ([(entry + " (9)", why)], "no mutation of today's source is"),
        ([(entry, " ")], "no reason for"),
        ([(entry, why), (entry, why)], "named more than once"),
    ):
        (problem,) = stale(wrong)
        assert said in problem


def test_no_equivalent_is_drawn_and_how_many_are_left_out_is_counted():
    file = next(iter(equivalents())).partition(" ")[0]
    chosen, left_out = mutants.chosen_mutants(10**4, 1, file)
    assert left_out == sum(mutation.startswith(f"{file} ") for mutation in equivalents())
    assert len(chosen) == len(mutations_of(file)) - left_out
    assert not {str(mutant.mutation) for mutant in chosen} & set(equivalents())


def test_a_draw_depends_on_its_seed_and_not_on_other_places():
    every = mutations_of("reference/numbers/precision.py")
    first = mutations.drawn(every, 1)
    assert first != mutations.drawn(every, 2)
    assert mutations.drawn(every[::2], 1) == [
        mutation for mutation in first if mutation in every[::2]
    ]
