"""The runs that a study makes, by methods or by precisions, and the scene that it makes them on."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, TypeVar

from reference import InputError, Scene
from reference.errors import Described
from reference.numbers.precision import DOUBLE_BITS

from ..methods import METHODS
from ..methods.method import Method, available
from ..methods.rhs.problem import suited

_FORMULATIONS = ("momentum", "space", "spin", "plane", "angles", "lagrangian")
_FORMULATIONS_OF = "heyoka_double"  # the method in which they are compared
# longer scenes are cut to this, unless an end is given; over less, what a run costs at all hides
# digits
SPAN_S = 14_400
_MOST_BITS = 4096
_SPARE_DIGITS = 8  # digits of the truth beyond those of the finest run
_STEP_BITS = 12  # bits of a step's mantissa: its first 2**41 multiples are doubles

T = TypeVar("T")
Item = tuple[str, str, float]  # method, formulation, setting


def plan(
    scene: Scene, methods: Sequence[str] | None = None, formulations: bool = True
) -> list[Item]:
    """List the runs: each method over its settings in the formulation that suits it, and one method in all of them.

    Args:
        scene: steps are scaled to its swing, and a formulation must be able to describe its motion;
            read as doubles.
        methods: ids; all if None.
        formulations: whether to compare the formulations in one method as well.

    Raises:
        InputError: an unknown method, none that can run here, or a number that no double holds.
    """
    _check_usable(methods)
    scene = scene.with_values(["inputs=binary64"])
    items: list[Item] = []
    for name in methods or METHODS:
        method = METHODS[name]
        items += [
            (name, suited(scene, method.formulations), setting)
            for setting in method.settings(scene)
        ]
    if formulations and (methods is None or _FORMULATIONS_OF in methods):
        method = METHODS[_FORMULATIONS_OF]
        words = [word for word in _FORMULATIONS if word in method.formulations]
        items += [
            (_FORMULATIONS_OF, word, setting)
            for word in words
            for setting in method.settings(scene)
        ]
    return list(dict.fromkeys(items))


def declared(methods: Sequence[str] | None, field: str) -> list[tuple[str, Any, float]]:
    """List the runs that methods declare for a study, as id, formulation and setting.

    Args:
        methods: ids; all if None.
        field: of `Method` that holds the runs: "stability" or "long_runs".

    Raises:
        InputError: a method is unknown, or declares no such runs; or none can run here.
    """
    expected = f"methods that declare runs in `{field}`", "These do"
    runs = _runs(methods, lambda method: getattr(method, field), "methods", *expected)
    return [(name, *run) for name, runs_of_method in runs.items() for run in runs_of_method]


def precision_items(bits: Sequence[int], methods: Sequence[str] | None = None) -> list[Item]:
    """List the runs that methods declare for these precisions, those of the processor's number types first.

    Args:
        bits: the precisions, increasing.
        methods: ids; all if None.

    Raises:
        InputError: a method is unknown, or declares no run for these precisions; or none can run
            here.
    """
    expected = "methods with these --precisions", "These have"
    runs = _runs(methods, lambda method: method.precision_runs(bits), "--methods", *expected)
    in_turn = sorted(runs, key=lambda name: METHODS[name].setting == "precision")
    return [(name, *run) for name in in_turn for run in runs[name]]


def _runs(
    methods: Sequence[str] | None,
    runs_of: Callable[[Method], Sequence[Any]],
    field: str,
    expected: str,
    these: str,
) -> dict[str, Sequence[Any]]:
    """Return what each method declares.

    Refuse one that declares nothing, and name those that do.
    """
    _check_usable(methods)
    runs = {name: runs_of(METHODS[name]) for name in methods or METHODS}
    without = [name for name in methods or () if not runs[name]]
    if without:
        declaring = ", ".join(name for name, method in METHODS.items() if runs_of(method))
        raise InputError(field, ", ".join(without), expected, f"{these}: {declaring}.")
    return runs


def _check_usable(methods: Sequence[str] | None) -> None:
    """Refuse methods none of which can run here; None is all.

    Raises:
        InputError: a method is unknown, or a package is missing for each.
    """
    reasons = {name: available(METHODS[name]) for name in (METHODS if methods is None else methods)}
    if all(reasons.values()):
        why = (
            "; ".join(f"{name}: {reason}" for name, reason in reasons.items())
            or "None means all methods"
        )
        got = ", ".join(reasons) if reasons else Described("no id")
        raise InputError("methods", got, "a method that can run here", f"{why}.")


def bits_of(text: str) -> list[int]:
    """Read a comma-separated list of precisions in bits.

    Raises:
        InputError: they are not whole numbers from 53 to 4096.
    """
    precisions = sorted({*parsed(text.split(","), int)})
    if not precisions or precisions[0] < DOUBLE_BITS or precisions[-1] > _MOST_BITS:
        expected = f"numbers of bits from {DOUBLE_BITS} to {_MOST_BITS}, such as 53,64,113,256,512"
        raise InputError("--precisions", text, expected, "Separate them by commas.")
    return precisions


def parsed(words: Iterable[str], kind: Callable[[str], T]) -> list[T]:
    """Return words as numbers; an empty list if one of them is not a number."""
    try:
        return [kind(word) for word in words]
    except ValueError:
        return []


def precision_scene(scene: Scene, bits: Sequence[int], whole: bool) -> tuple[Scene, int]:
    """Return the scene to measure on, and the digits that its truth needs.

    Args:
        scene: as requested.
        bits: the precisions, increasing.
        whole: whether to keep the scene's whole span.
    """
    digits = math.ceil(bits[-1] * math.log10(2)) + _SPARE_DIGITS
    if whole or scene.exact.t_end <= SPAN_S:
        return scene, digits
    return scene.with_values([f"run.t_end={SPAN_S}"]), digits


def on_doubles(scene: Scene) -> Scene:
    """Return the scene; if a grid time is not a double, with a grid step of few bits and the same end.

    A method and the truth are then compared at the same times. 0.1 s is not a double, nor are most
    of its multiples; between such a time and the nearest double the bob moves by some 1e-16 of its
    path, which would hide the error of a method with many digits.

    Args:
        scene: its inputs read as binary64, so that its end is a double.
    """
    inputs = scene.exact
    if all(Fraction(float(t)) == t for t in inputs.grid):
        return scene
    mantissa, exponent = math.frexp(float(inputs.grid_step))
    step = Fraction(round(mantissa * 2**_STEP_BITS)) * Fraction(2) ** (exponent - _STEP_BITS)
    exact = (f"{Decimal(float(value)):f}" for value in (step, inputs.t_end))
    return scene.with_values(dict(zip(("run.grid_step", "run.t_end"), exact, strict=True)))
