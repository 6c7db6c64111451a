"""The mutations of a source file: every way to change one place of its syntax tree that an operator below knows.

A mutation is known by its file, the function that it is in, its operator and what it changes, with a number where this
is there more than once. So it stays the same when lines are unfolded, moved or commented.
"""

from __future__ import annotations

import ast
import hashlib
import signal
import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import Any

import pytest
from places import ROOT

EQUIVALENTS = ROOT / "tests/equivalent_mutants.toml"

# what is changed, in words of the source, and what takes the place of the node
Replacement = tuple[str, ast.AST]
Operator = Callable[[ast.AST, ast.AST | None], Iterator[Replacement]]  # of a node and its parent


# ------------------------------------------------------------------------------------------------ operators

SUMS = {"add"}  # of vectors, in reference/enclosure/trusted/balls.py
PRODUCTS = {"times"}  # of a number and a vector, there as well
# of two arguments; `demand` of the other one is no demand
COMMUTATIVE = {"add", "dot", "min", "max", "demand"}
LATTICE = {"min", "max", "union", "intersection"}  # which choose among what they are given
SAME_KIND = {"low": "high", "begin": "end", "lower": "upper", "start": "end", "sin": "cos"}
SAME_KIND |= {after: before for before, after in SAME_KIND.items() if after not in SAME_KIND}
BOUNDARY = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
OPPOSITE = {
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}
OPPOSITE |= {ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In}
CONVERSIONS = {
    "list",
    "tuple",
    "set",
    "dict",
    "iter",
    "str",
    "repr",
    "float",
    "int",
    "bool",
    "ball",
    "arb",
}


def drop_term(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Leave out one term of a sum."""
    match node:
        case ast.BinOp(left, ast.Add() | ast.Sub(), right):
            yield _text(right), left
            if not _is_sum(left):  # whose terms are left out one by one
                yield (
                    _text(left),
                    right if isinstance(node.op, ast.Add) else ast.UnaryOp(ast.USub(), right),
                )
        case ast.Call(ast.Name(name), args) if name in SUMS and len(args) > 1:
            for i, term in enumerate(args):
                yield _text(term), _with(node, args=_without(args, i))


def drop_factor(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Leave out one factor of a product, a divisor or an exponent."""
    match node:
        case ast.BinOp(left, ast.Mult() | ast.Div() | ast.FloorDiv() | ast.Pow(), right):
            yield _text(right), left
            if isinstance(node.op, ast.Mult) and not _is_product(left):
                yield _text(left), right
            elif isinstance(node.op, ast.Div) and not _is_product(left):
                yield (
                    _text(left),
                    right if _text(left) == "1" else _with(node, left=ast.Constant(1)),
                )
        case ast.Call(ast.Name(name), [factor, vector]) if name in PRODUCTS:
            yield _text(factor), vector


def flip_sign(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Change the sign of one term, or of a 1 that is passed to a function."""
    match node:
        case ast.BinOp(op=ast.Add() | ast.Sub()):
            yield (
                _text(node.right),
                _with(node, op=ast.Sub() if isinstance(node.op, ast.Add) else ast.Add()),
            )
        case ast.UnaryOp(ast.USub(), operand) if not (
            isinstance(parent, ast.Call) and _is_product(parent)
        ):
            yield _text(node), operand
        case ast.Constant(1) if isinstance(parent, ast.Call) and node.value is not True:
            yield _text(parent), ast.UnaryOp(ast.USub(), node)


def drop_call(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Put what a function or a method is applied to in place of its result."""
    match node:
        case ast.Call(ast.Name(name), [argument], []) if (
            name not in CONVERSIONS and not name[0].isupper()
        ):
            if not isinstance(argument, ast.Starred | ast.GeneratorExp):
                yield _text(node), argument
        case ast.Call(ast.Attribute(value), [], []) if not isinstance(parent, ast.Expr):
            yield _text(node), value


def drop_alternative(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Leave out one of those among which a minimum, a maximum, a union or an intersection chooses."""
    match node:
        case ast.Call(ast.Name("min" | "max"), args) if len(args) > 1:
            for i, one in enumerate(args):
                kept = _without(args, i)
                yield _text(one), kept[0] if len(kept) == 1 else _with(node, args=kept)
        case ast.Call(ast.Attribute(value, name), [argument], []) if name in LATTICE:
            yield _text(argument), value
            yield _text(value), argument
        case ast.Call(ast.Name("reduce"), [_, every]):
            yield (
                f"all but the first of {_text(every)}",
                ast.Subscript(every, ast.Constant(0), ast.Load()),
            )
        case ast.Call(ast.Attribute(_, "get"), [_, default]):
            yield _text(node), default


def drop_element(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Leave out one element of a list that is put together of several."""
    match node:
        case ast.List(elements, ast.Load()) if any(isinstance(x, ast.Starred) for x in elements):
            for i, element in enumerate(elements):
                yield _text(element), _with(node, elts=_without(elements, i))


def swap_neighbours(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Exchange two neighbouring arguments or elements."""
    match node:
        case ast.Call(ast.Name(name), [_, _]) if name in COMMUTATIVE:
            return
        case ast.Call(_, [_, _] as every):
            field = "args"
        case ast.Tuple(every, ast.Load()) | ast.List(every, ast.Load()) if len(every) < 12:
            field = "elts"
        case _:
            return
    for i in range(len(every) - 1):
        one, other = every[i : i + 2]
        if _text(one) != _text(other):
            swapped = [*every[:i], other, one, *every[i + 2 :]]
            yield f"{_text(one)}, {_text(other)}", _with(node, **{field: swapped})


def exchange_name(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Put the counterpart of a name or of an attribute in its place: `high` for `low`."""
    match node:
        case ast.Name(name, ast.Load()) if name in SAME_KIND:
            yield f"{_text(parent)}: {name}", ast.Name(SAME_KIND[name], ast.Load())
        case ast.Attribute(_, name, ast.Load()) if name in SAME_KIND:
            yield _text(node), _with(node, attr=SAME_KIND[name])


def next_index(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Take the element before, or after the first; begin or end a slice there."""
    match node:
        case ast.Constant(int(number)) if isinstance(parent, ast.Subscript | ast.Slice):
            yield _text(parent), ast.Constant(number - 1 if number else 1)


def opposite(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Say the opposite of a comparison, or of what follows a `not`."""
    match node:
        case ast.Compare(ops=ops):
            for i, op in enumerate(ops):
                changed = _with(node, ops=[*ops[:i], OPPOSITE[type(op)](), *ops[i + 1 :]])
                yield _text(changed), changed
        case ast.UnaryOp(ast.Not(), operand):
            yield _text(operand), operand


def boundary(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Count what is just equal to the other side."""
    match node:
        case ast.Compare(ops=ops):
            for i, op in enumerate(ops):
                if type(op) in BOUNDARY:
                    changed = _with(node, ops=[*ops[:i], BOUNDARY[type(op)](), *ops[i + 1 :]])
                    yield _text(changed), changed


def drop_condition(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Leave out one of several conditions."""
    match node:
        case ast.BoolOp(_, values):
            for i, value in enumerate(values):
                kept = _without(values, i)
                yield _text(value), kept[0] if len(kept) == 1 else _with(node, values=kept)


def always_or_never(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Take one branch whatever the condition is."""
    match node:
        case ast.If(test) | ast.IfExp(test):
            yield f"{_text(test)} is True", _with(node, test=ast.Constant(True))
            yield f"{_text(test)} is False", _with(node, test=ast.Constant(False))
        case ast.comprehension(ifs=[test]):
            yield f"{_text(test)} is True", _with(node, ifs=[])
            yield f"{_text(test)} is False", _with(node, ifs=[ast.Constant(False)])


def change_number(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Multiply a number by 2 or by 100; turn round what is true or false."""
    match node:
        case ast.Constant(bool(value)):
            yield f"{_text(parent)}: not {value}", ast.Constant(not value)
        case ast.Constant(int(value) | float(value)):
            for other in (2 * value or 2, 100 * value or 100):
                yield f"{_text(parent)}: {value} is {other}", ast.Constant(other)


def drop_statement(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Do nothing in place of a call, of a return, or of taking a number into what is there."""
    match node:
        case (
            ast.Expr(ast.Call() | ast.Yield() | ast.YieldFrom())
            | ast.Return(ast.AST())
            | ast.AugAssign()
        ):
            yield _text(node), ast.Pass()
        case ast.Assign([ast.Attribute() | ast.Subscript()]):
            yield _text(node), ast.Pass()


EXCHANGED = {  # by hand: something of the same kind is taken of another object
    "ball(wide['rotation_rate'])": "self.own.omega[2] * self.pace",
    "twin.length": "covered.piece.balls.length",
    "twin.turned": "covered.piece.balls.turned",
}


def exchange_object(node: ast.AST, parent: ast.AST | None) -> Iterator[Replacement]:
    """Take what belongs to the scene, or to the box, in place of what belongs to a pendulum of the box."""
    if isinstance(node, ast.Call | ast.Attribute) and (other := EXCHANGED.get(_text(node))):
        yield f"{_text(node)} is {other}", ast.parse(other, mode="eval").body


OPERATORS: dict[str, Operator] = {
    operator.__name__.replace("_", " "): operator
    for operator in (
        drop_term, drop_factor, flip_sign, drop_call, drop_alternative, drop_element, swap_neighbours, exchange_name,
        exchange_object, next_index, opposite, boundary, drop_condition, always_or_never, change_number, drop_statement,
    )
}  # fmt: skip


def _text(node: ast.AST | None) -> str:
    """Return a node as it would be written; of a statement with others in it, the first line."""
    return ast.unparse(node).partition("\n")[0] if node else ""


def _with(node: Any, **fields: Any) -> Any:
    changed = copy(node)
    vars(changed).update(fields)
    return changed


def _without(elements: list[Any], i: int) -> list[Any]:
    return elements[:i] + elements[i + 1 :]


def _is_sum(node: ast.AST) -> bool:
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)


def _is_product(node: ast.AST | None) -> bool:
    match node:
        case ast.BinOp(op=ast.Mult() | ast.Div()):
            return True
        case ast.Call(ast.Name(name)):
            return name in PRODUCTS
    return False


# ------------------------------------------------------------------------------------------------ mutations


@dataclass(frozen=True, order=True)
class Mutation:
    """A change of one place of a file."""

    file: str  # from the project's folder
    function: str  # with the names of the classes and functions around it; "" is the module
    operator: str
    change: str  # what is left out, or how it reads afterwards
    number: int  # from 1 on, among those that are the same in all of these

    def __str__(self) -> str:
        again = f" ({self.number})" if self.number > 1 else ""
        return f"{self.file} {self.function or 'module'}, {self.operator}: {self.change}{again}"

    def tree(self) -> ast.Module:
        """Return the file's syntax tree with the change."""
        tree = _parsed(self.file)
        for mutation, change in _places(self.file, tree):
            if mutation == self:
                change()
                return ast.fix_missing_locations(tree)
        raise LookupError(f"no place of today's source is {self}")

    def source(self) -> str:
        """Return the file with the change."""
        return ast.unparse(self.tree())


def mutations_of(file: str) -> list[Mutation]:
    """Return every mutation of a file, in the order of the places that they change."""
    return [mutation for mutation, _ in _places(file, _parsed(file))]


def named(text: str) -> Mutation:
    """Return the mutation that is printed so."""
    return next(
        mutation for mutation in mutations_of(text.partition(" ")[0]) if str(mutation) == text
    )


def _parsed(file: str) -> ast.Module:
    return ast.parse((ROOT / file).read_text(encoding="utf-8"))


def _places(file: str, tree: ast.Module) -> Iterator[tuple[Mutation, Callable[[], None]]]:
    """Yield mutations, each with what makes its change in the tree."""
    seen: Counter[tuple[str, str, str]] = Counter()
    for node, parent, function, put in _nodes(tree, None, ""):
        for operator, replacements in OPERATORS.items():
            for change, new in replacements(node, parent):
                key = function, operator, change
                seen[key] += 1
                yield Mutation(file, *key, seen[key]), lambda put=put, new=new: put(new)


SMALL = (
    ast.arguments
    | ast.keyword
    | ast.comprehension
    | ast.withitem
    | ast.ExceptHandler
    | ast.match_case
)
# a node, its parent, the function, what puts another in its place
Node = tuple[Any, Any, str, Callable[[Any], None]]


def _nodes(parent: Any, above: Any, function: str) -> Iterator[Node]:
    """Yield the nodes below one; not those of annotations, of texts for people, or of what is for types alone."""
    if isinstance(parent, ast.FunctionDef | ast.ClassDef):
        function = f"{function}.{parent.name}".lstrip(".")
    for field, value in ast.iter_fields(parent):
        if field in ("annotation", "returns", "type_params"):
            continue
        children = value if isinstance(value, list) else [value]
        for i, child in enumerate(children):
            if isinstance(child, ast.stmt | ast.expr | SMALL) and not _is_spared(child):
                yield (
                    child,
                    parent,
                    function,
                    _putting(parent, field, i if isinstance(value, list) else None),
                )
                yield from _nodes(child, parent, function)


def _putting(parent: Any, field: str, i: int | None) -> Callable[[Any], None]:
    def put(new: Any) -> None:
        if i is None:
            setattr(parent, field, new)
        else:
            getattr(parent, field)[i] = new

    return put


def _is_spared(node: Any) -> bool:
    match node:
        case ast.JoinedStr():
            return True
        case ast.FunctionDef(name):
            return name in ("__repr__", "__str__")
        case ast.If(test):
            return "TYPE_CHECKING" in ast.unparse(test)
    return False


# ------------------------------------------------------------------------------------------------ choosing, loading


def _entries(*kinds: str) -> Iterator[tuple[str, str]]:
    table = tomllib.loads(EQUIVALENTS.read_text(encoding="utf-8"))
    for kind in kinds:
        for entry in table[kind]:
            for mutation in entry["mutations"]:
                yield mutation, entry["why"]


@cache
def equivalents() -> dict[str, str]:
    """Return the mutations that no test could tell from the source, each with a reason."""
    return dict(_entries("equivalent"))


@cache
def unnoticed() -> dict[str, str]:
    """Return the mutations of trusted code that its own checks do not notice, and what they lack."""
    return dict(_entries("unnoticed"))


def stale(entries: Iterable[tuple[str, str]] | None = None) -> list[str]:
    """Return what is wrong with the tables: each entry has a reason, and is a mutation of today's source."""
    named = list(_entries("equivalent", "unnoticed") if entries is None else entries)
    files = {mutation.partition(" ")[0] for mutation, _ in named}
    today = {
        str(mutation)
        for file in files
        if (ROOT / file).is_file()
        for mutation in mutations_of(file)
    }
    often = Counter(mutation for mutation, _ in named)
    problems = [
        f"no mutation of today's source is {mutation}"
        for mutation, _ in named
        if mutation not in today
    ]
    problems += [f"no reason for {mutation}" for mutation, why in named if not why.strip()]
    problems += [
        f"named more than once: {mutation}" for mutation, times in often.items() if times > 1
    ]
    return [f"{EQUIVALENTS.name}: {problem}" for problem in problems]


def drawn(mutations: Iterable[Mutation], seed: int) -> list[Mutation]:
    """Return mutations in an order that the seed decides; what becomes of other places does not change it."""
    return sorted(
        mutations, key=lambda mutation: hashlib.sha256(f"{seed} {mutation}".encode()).digest()
    )


class CpuLimitError(Exception):
    """What a mutation runs into that does not end."""


@contextmanager
def limited(cpu_s: float) -> Iterator[None]:
    """Raise CpuLimitError after some seconds of this process."""

    def stop(*_: object) -> None:
        raise CpuLimitError(f"not done after {cpu_s} CPU seconds")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, cpu_s)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def noticed(
    mutation: Mutation, check: Callable[[Any], None], cpu_s: float = 60
) -> BaseException | None:
    """Return how a check of the mutated module ends that does not pass; None if it passes."""
    try:
        with limited(cpu_s):
            check(loaded(mutation))
    except (Exception, pytest.fail.Exception) as found:
        return found
    return None


def loaded(mutation: Mutation) -> Any:
    """Return a module with the mutation; no other module sees it."""
    return _executed(mutation.file, mutation.tree())


def with_names(file: str, **others: Any) -> Any:
    """Return a module in which some names stand for something else, as an untrusted part that lies; nobody sees it."""
    module = _executed(file, _parsed(file))
    vars(module).update(others)
    return module


def _executed(file: str, tree: ast.Module) -> Any:
    name = file.removesuffix(".py").replace("/", ".")
    module = ModuleType(name)
    module.__package__ = name.rpartition(".")[0]
    exec(compile(tree, file, "exec"), vars(module))
    return module
