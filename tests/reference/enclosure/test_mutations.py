"""Mutations of trusted code, one at a time in a copy of its module: what has to hold does not hold of any."""

from importlib import import_module

import box_truths
import derivative_truths
import pytest
import section_truths
from mutations import drawn, equivalents, mutations_of, noticed, unnoticed
from sampled import first

WIDER = {"boundary", "change number"}  # they leave balls as they are, or bounds that are wider and true
MODULES = {"sections": section_truths, "box": box_truths, "derivatives": derivative_truths}
IN_EVERY_RUN = {"sections": 12, "box": 8, "derivatives": 12}  # mutations


def sample(name):
    """Return a module's mutations that its checks should notice, in an order of chance."""
    left_out = {*equivalents(), *unnoticed()}
    every = [m for m in mutations_of(f"reference/enclosure/{name}.py") if m.operator not in WIDER]
    return first(IN_EVERY_RUN[name], drawn([m for m in every if str(m) not in left_out], seed=1))


@pytest.mark.parametrize("name", MODULES)
def test_the_module_as_it_is_passes_every_check(name, size):
    MODULES[name].all_hold(import_module(f"reference.enclosure.{name}"), size(False, True))


@pytest.mark.parametrize("mutation", [case for name in MODULES for case in sample(name)], ids=str)
def test_each_mutation_is_noticed(mutation, size):
    name = mutation.file.rpartition("/")[2].removesuffix(".py")
    assert noticed(mutation, lambda module: MODULES[name].all_hold(module, size(False, True)))
