"""The level `enclosed`: balls that contain the truth, turned into digits; heyoka's run is held against them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from .errors import InputError, IntegrationError, UnreachableError
from .growth import Growth, bits_in, largest_of, measure_growth
from .precision import cheapest_type
from .render import UndecidedRounding, grid_sheet, transits_sheet
from .runs import Plan, Report, Run, run
from .scene import Scene
from .solution import (
    GRID_COLUMNS,
    TRANSIT_COLUMNS,
    CrossCheck,
    Proof,
    Solution,
    Source,
    Table,
    grid_decimals,
)

ROUNDING_BITS = 26  # balls are this much smaller than the last digit: a tie among 1e5 numbers is then unlikely
ROUNDING_TRIES = 3
EXTRA_SCALE = 64  # bits of the table's integers below the smallest ball
ROW = 7  # columns of a run's row; a zero has its time before them


def solve_enclosed(scene: Scene, times: tuple[Fraction, ...], report: Report | None) -> Solution:
    """Enclose a scene's states and transits so tightly that every digit asked for is decided.

    Raises:
        InputError: python-flint is not installed.
        UnreachableError: balls small enough cannot be had; says what was reached.
        IntegrationError: heyoka's run lies outside the enclosure.
    """
    try:
        from . import enclosure
    except ModuleNotFoundError as error:
        advice = "Install it with pip install 'foucault-reference[enclose]'."
        raise InputError("--level", "enclosed", f"the package {error.name}, which the proof is made with", advice) from None

    growth = measure_growth(scene.exact, times)
    prec = growth.bits_for(scene.run.digits, scene.exact.t_end, checked=True)
    witness = run(
        Plan(scene.exact, "momentum", cheapest_type(prec), times, scene.run.transits), report and (lambda t: report(t / 2))
    )
    end = float(times[-1])
    unit_bits = max(grid_decimals(growth.largest, growth.errors, scene.run.digits))
    radius = Fraction(1, 10**unit_bits << ROUNDING_BITS)
    for _ in range(ROUNDING_TRIES):
        proved = enclosure.enclose(
            scene.exact,
            times,
            radius=radius,
            transits=scene.run.transits,
            progress=report and (lambda part: report(end * (1 + part) / 2)),
        )
        solution = _solution(scene, times, proved, witness, growth)
        try:
            grid_sheet(solution), transits_sheet(solution)
        except UndecidedRounding:
            radius /= 2**16
            continue
        return solution
    raise UnreachableError(
        f"Balls of {float(radius):.1e} m do not decide the last of {scene.run.digits} digits.",
        "A number may lie exactly between two decimals: ask for one digit more.",
    )
