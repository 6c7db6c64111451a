"""Mutations of trusted code, one at a time in a copy of its module: what has to hold does not hold of any."""

from importlib import import_module
from itertools import groupby

import box_truths
import derivative_truths
import pytest
import section_truths
from mutations import drawn, equivalents, mutations_of, noticed, unnoticed

# not tried: no proof rests on two balls that just touch, and a larger number mostly makes a bound wider, and true
WIDER = {"boundary", "change number"}
TRUTHS = {"sections": section_truths, "box": box_truths, "derivatives": derivative_truths}
IN_EVERY_RUN = {"sections": 12, "box": 8, "derivatives": 12}  # mutations


def telling(name):
    """Return the mutations of a module that its checks should notice."""
    left_out = {*equivalents(), *unnoticed()}
    every = mutations_of(f"reference/enclosure/trusted/{name}.py")
    return [
        mutation
        for mutation in every
        if mutation.operator not in WIDER and str(mutation) not in left_out
    ]


def sample():
    for name, count in IN_EVERY_RUN.items():
        for mutation in drawn(telling(name), seed=1)[:count]:
            yield pytest.param(name, mutation, id=str(mutation))


def functions():
    for name in TRUTHS:
        every = sorted(telling(name), key=lambda mutation: mutation.function)
        for function, mutations in groupby(every, key=lambda mutation: mutation.function):
            yield pytest.param(name, list(mutations), id=f"{name} {function or 'module'}")


def is_noticed(name, mutation):
    return noticed(mutation, lambda module: TRUTHS[name].all_hold(module, long=False))


@pytest.mark.parametrize("name", TRUTHS)
def test_the_module_as_it_is_passes_every_check(name, size):
    TRUTHS[name].all_hold(import_module(f"reference.enclosure.trusted.{name}"), size(False, True))


@pytest.mark.parametrize("name, mutation", list(sample()))
def test_a_mutation_of_a_sample_is_noticed(name, mutation):
    assert is_noticed(name, mutation)


@pytest.mark.long
@pytest.mark.parametrize("name, mutations", list(functions()))
def test_every_mutation_of_a_function_is_noticed(name, mutations):
    assert [str(mutation) for mutation in mutations if not is_noticed(name, mutation)] == []
