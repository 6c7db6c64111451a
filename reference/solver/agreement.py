"""How far a published run and its witness are apart: the bits that they lack to agree, and the errors that follow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from ..engines.plan import Run
from ..errors import IntegrationError
from ..model.start import Start
from ..numbers.columns import GRID, POSITION, TRANSITS, VELOCITY
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS, to_fraction
from ..numbers.table import Table, bits_in, decimals_of, resolved
from .pilot import MARGIN_BITS

AGREEMENT = Fraction(1, 4)  # largest disagreement of two runs, in units of the last printed digit


@dataclass(frozen=True)
class Agreement:
    """How far two runs are apart.

    Attributes:
        missing_bits: that they lack to agree to a quarter of the last digit; 0 if they do agree.
        grid: largest difference in each column of the grid.
        transits: differences of each transit; None where they are not to be compared.
        errors: of each column of the grid: twice the difference, or the witness's resolution if there is none.
    """

    missing_bits: int
    grid: dict[str, Fraction]
    transits: Table | None
    errors: dict[str, Fraction]

    @classmethod
    def between(cls, published: Run, witness: Run, digits: int) -> Agreement:
        """Compare a run with its witness; the decimals are those that the published one gets.

        Raises:
            IntegrationError: the two runs are the same run.
        """
        states = published.grid.only(GRID)
        gaps = states.distance(witness.grid).largest()
        _check_independent(states, gaps)
        finest = _resolution(published, witness)
        errors = {name: 2 * gap or finest[name] for name, gap in gaps.items()}
        decimals = decimals_of(resolved(states.largest(), gaps), digits)
        missing = bits_lacking(gaps, decimals)
        if published.transits is None or witness.transits is None:
            return cls(missing, gaps, None, errors)
        if published.directions != witness.directions:
            return cls(witness.plan.number.prec // 2, gaps, None, errors)
        transits = published.transits.only(TRANSITS)
        apart = transits.distance(witness.transits)
        decimals = decimals_of(transits.largest(), digits) | {
            name: places for name, places in decimals.items() if name in TRANSITS
        }
        return cls(max(missing, bits_lacking(apart.largest(), decimals)), gaps, apart, errors)


def _check_independent(states: Table, gaps: Mapping[str, Fraction]) -> None:
    """Raise unless two runs differ in a column that changes with time.

    A column that does not change, such as y on the equator or everything at rest, may be exact in both. In one that
    does change, a difference of exactly zero comes about by chance, once in 2**16 numbers; in all of them it does not.
    """
    changing = [
        name
        for name, column in zip(states.columns, zip(*states.values, strict=True), strict=True)
        if len(set(column)) > 1
    ]
    if changing and not any(gaps[name] for name in changing):
        raise IntegrationError("The two runs are the same run: they differ nowhere, so their agreement proves nothing.")


def _resolution(published: Run, witness: Run) -> dict[str, Fraction]:
    """Return the last bit of the witness in each column, for columns in which both runs happen to be equal."""
    start = Start.of(published.plan.inputs, DOUBLE_BITS + GUARD_BITS)
    length, largest = published.plan.inputs.length, published.grid.largest()
    speed = max(largest[name] for name in VELOCITY) or length * to_fraction(
        start.ctx.sqrt(start.ctx.norm(start.k.pull))
    )
    sizes = dict.fromkeys(POSITION, length) | dict.fromkeys(VELOCITY, speed)
    return {name: size / 2**witness.plan.number.prec for name, size in sizes.items()}


def bits_lacking(gaps: Mapping[str, Fraction], decimals: Mapping[str, int]) -> int:
    """Return the bits by which a gap exceeds one unit of its last digit, and a margin; 0 if all keep to `AGREEMENT`."""
    lacking = 0
    for name, gap in gaps.items():
        ratio = gap * 10 ** decimals[name]
        if ratio > AGREEMENT:
            lacking = max(lacking, bits_in(ratio) + MARGIN_BITS)
    return lacking
