"""Which engine and number type a run takes: heyoka in any type, or limbs, many times faster beyond long double."""

from __future__ import annotations

from importlib.util import find_spec

from ..errors import InputError
from ..precision import LONG_DOUBLE, NumberType, cheapest_type, limbs

HEYOKA, LIMBS, AUTO = "heyoka", "limbs", "auto"


def engine_named(engine: str | None) -> str:
    """Return "heyoka" or "limbs"; for None or "auto" the faster one that is installed (limbs needs numba).

    Raises:
        InputError: no such engine, or numba is not installed.
    """
    installed = find_spec("numba") is not None
    if engine is None or engine == AUTO:
        return LIMBS if installed else HEYOKA
    if engine not in (HEYOKA, LIMBS):
        raise InputError("engine", engine, f"one of {AUTO}, {HEYOKA}, {LIMBS}")
    if engine == LIMBS and not installed:
        advice = "Install it with pip install 'foucault-reference[methods]', or take --engine heyoka."
        raise InputError("--engine", engine, "the package numba, which it needs", advice)
    return engine


def fastest(prec: int, engine: str) -> tuple[str, NumberType]:
    """Return formulation and number type of the cheapest run that has `prec` bits."""
    if engine == LIMBS and prec > LONG_DOUBLE.prec:
        from .limbs import most_bits

        if prec <= most_bits():
            return "inertial", limbs(prec)
    return "momentum", cheapest_type(prec)


def engine_of(number: str) -> str:
    """Return the engine of a run whose number type was written as `number`."""
    return LIMBS if number.startswith(LIMBS) else HEYOKA
