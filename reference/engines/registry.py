"""The engines by name, which of them a run takes, and the run itself."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib import import_module
from time import process_time

from ..errors import InputError
from ..system.imports import switched_off
from . import AUTO, batch_names, engine_names
from .batch_interface import Batch
from .plan import Engine, Pace, Plan, Report, Run

SERIES_BITS = 20  # beyond a run's precision, to which the series of its steps are taken
MANY_STEPS = 10**6  # of a run in which starting an engine costs nothing beside its steps


@cache
def engines() -> dict[str, Engine]:
    """Return every engine by its name, which is that of its folder."""
    return {name: import_module(f".{name}.engine", __package__).ENGINE for name in engine_names()}


@cache
def batches() -> dict[str, Batch]:
    """Return every engine that solves many rows side by side, by its name, which is that of its folder."""
    return {name: import_module(f".{name}.batch", __package__).BATCH for name in batch_names()}


def checked(name: str | None) -> str:
    """Return the name of an installed engine, or "auto", also for None.

    Raises:
        InputError: no such engine, or it is not installed.
    """
    if name is None or name == AUTO:
        return AUTO
    if name not in engine_names():
        raise InputError("engine", name, f"one of {', '.join((AUTO, *engine_names()))}")
    engine = engines()[name]
    variable = switched_off(engine.requires)
    if variable is not None:
        raise InputError("--engine", name, f"{variable} unset", "Unset it, or take --engine heyoka.")
    if not engine.installed:
        advice = f"Install it with pip install 'foucault-reference[{engine.extra}]', or take --engine heyoka."
        raise InputError("--engine", name, f"the package {', '.join(engine.requires)}, which it needs", advice)
    return name


def fastest(prec: int, name: str = AUTO, steps: int = MANY_STEPS) -> Engine:
    """Return the engine to compute with at `prec` bits, in a run that would be `steps` steps in double.

    The engine called `name` is taken if it is installed and can compute at this precision. Otherwise, or if `name` is
    "auto", it is the one with the least expected cost among the installed engines that can.
    """
    serving = [engine for engine in engines().values() if engine.installed and prec in engine.bits]

    def cost(engine: Engine) -> tuple[bool, float]:
        return engine.name != name and name != AUTO, engine.start_s + engine.expected_s(steps, prec)

    return min(serving, key=cost)


def run(plan: Plan, report: Report | None = None, pace: Pace | None = None) -> Run:
    """Integrate a plan with its engine; for arguments and errors see `Engine.run`. Sections take a second pass."""
    engine = engines()[plan.engine]
    done = engine.run(plan, report, pace)
    if not plan.sections:
        return done
    from .passages import passages

    begun, steps = process_time(), engine.expanded(plan, plan.number.prec + SERIES_BITS)
    return replace(done, passages=passages(plan, steps), cpu_s=done.cpu_s + process_time() - begun)
