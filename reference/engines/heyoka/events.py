"""Transits by heyoka: guards around its event detection; ../passages.py counts zeros that lie close together.

So no zero of xdot is lost and none counted twice.

heyoka finds the zeros on the polynomial of each step, but it can lose one within about 2**-prec of
the left edge of the step, which it tells its log alone. If, for example, xdot is +0.3 mm/s at the
start of a step and -0.2 mm/s at its end, there is a crossing in between, and if heyoka reports
none, it has lost one.

Signs alone do not show everything. If xdot is +0.3 mm/s and falling at the start, and +0.2 mm/s and
rising at the end, it has a minimum in between. That may be +0.1 mm/s, with no transit, or -0.1
mm/s, with two close together, as happens when the swing plane passes through north-south. Two may
be lost beside a crossing that was found, too. So the zeros of the step's polynomial are counted, as
those of any section are (`passages`).

So a step is taken again, with its left edge moved, unless

- the crossings in it alternate, and lead from the sign of xdot at its start to the sign at its end,
- they are as many as its polynomial has zeros.

Many steps are checked in one go, which costs less.

If xdot is zero at the release, that zero at t = 0 is no transit: a first step leaves it out, so
short that it holds no other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.polynomial.polynomial import polyval

from ...errors import IntegrationError
from ..passages import SPARE_BITS, Places, forms, signs_of
from ..plan import AT_REST

if TYPE_CHECKING:
    from .conversions import Numbers
    from .stepper import Stepper, Zero

_MAX_RETRIES = 6  # how often steps are taken again before the run is given up
# a step taken again is cut by this factor: no simple ratio, so that no edge returns
_SHORTER = Fraction(79, 128)
_AT_ONCE = 100  # steps that are checked together


class _Step(NamedTuple):
    """A step that was taken.

    Attributes:
        mark: its start.
        states, zeros: how many there were before it.
        end: its end in s.
        series: Taylor coefficients of x over l.
        length: in s.
        directions: of the zeros in it.
    """

    mark: tuple[Any, Any]
    states: int
    zeros: int
    end: Any
    series: Any
    length: Any
    directions: list[int]


def _quiet_start(stepper: Stepper, multiplicity: int) -> Fraction:
    """Return a time δ in s such that xdot has no zero in (0, δ], for a run whose first variable is x over l.

    Let xdot = t^m (b_m + b_{m+1} t + …) with m = `multiplicity`. If |b_m| > Σ |b_k| δ^(k-m), summed
    over k > m, no other root lies up to δ. The sum is taken over the polynomial, and doubled to
    cover the terms beyond its order.

    Raises:
        IntegrationError: there is no such δ down to the working precision.
    """
    coefficients, h = stepper.coefficients()
    scaled: list[Any] = [abs((k + 1) * a * h**k) for k, a in enumerate(coefficients[0][1:])]
    # NaN where h is infinite, as at rest: then the comparison below is false
    leading = scaled[multiplicity]
    higher = scaled[multiplicity + 1 :]
    for halvings in range(stepper.number.prec):
        weight = stepper.numbers.power_of_two(-halvings)
        terms = (b * weight ** (j + 1) for j, b in enumerate(higher))
        if leading > 2 * sum(terms, start=0 * leading):
            return Fraction(float(h)) / Fraction(2) ** halvings
    raise IntegrationError("within the working precision, xdot stays zero after t = 0.", AT_REST)


def march(
    stepper: Stepper,
    times: Sequence[Any],
    multiplicity: int = 0,
    report: Callable[[float], None] | None = None,
) -> tuple[Any, list[Zero]]:
    """Step to the last of `times`.

    Return the states, shape (times, variables), and the zeros of xdot.

    Args:
        stepper: at t = 0, with events.
        times: increasing, from 0, numbers of the run's type.
        multiplicity: of the zero of xdot at t = 0: a first step is so short that it holds no other.
        report: called with the simulated time after each step.

    Raises:
        IntegrationError: the zeros of some step stay contradictory however its edges are moved.
    """
    end = times[-1]
    states: list[Any] = [stepper.state]
    zeros: list[Zero] = []
    if multiplicity:
        stepper.advance(min(stepper.numbers.of(_quiet_start(stepper, multiplicity)), end))
        stepper.sample(times, states)
    steps: list[_Step] = []  # the last one that was checked, and those after it
    retries = 0
    limit = end - stepper.time
    while stepper.time < end:
        mark = stepper.mark()
        stepper.advance(limit)
        step_zeros = sorted(stepper.zeros, key=lambda zero: zero.t)
        directions = [zero.direction for zero in step_zeros]
        last_of_x = stepper.last_of_x()
        steps.append(_Step(mark, len(states), len(zeros), stepper.time, *last_of_x, directions))
        zeros += step_zeros
        stepper.sample(times, states)
        if len(steps) > _AT_ONCE or retries or stepper.time >= end:
            failed = _first_contradiction(steps, stepper.numbers)
            if failed is not None:
                i, contradiction = failed
                retries += 1
                if retries > _MAX_RETRIES:
                    raise IntegrationError(
                        f"zeros of xdot near t = {float(steps[i].end)} s: {contradiction}.", AT_REST
                    )
                limit = (steps[i].end - steps[i].mark[0]) * stepper.numbers.of(_SHORTER**retries)
                _take_back(stepper, steps, max(i - 1, 0), states, zeros)
                continue
            if limit >= end - mark[0]:
                retries = 0
            del steps[:-1]
        limit = end - stepper.time
        if report is not None:
            report(float(stepper.time))
    return np.array(states, dtype=stepper.numbers.dtype), zeros


def _take_back(
    stepper: Stepper, steps: list[_Step], first: int, states: list[Any], zeros: list[Zero]
) -> None:
    """Return to the start of the step `first`, and delete what was recorded since."""
    step = steps[first]
    stepper.back(step.mark)
    del states[step.states :]
    del zeros[step.zeros :]
    del steps[first:]


def _first_contradiction(steps: Sequence[_Step], numbers: Numbers) -> tuple[int, str] | None:
    """Return the first of consecutive steps whose zeros fail a guard, as its index, and how.

    None if none does.
    """
    x = np.array([step.series[1:] for step in steps])
    x *= np.cumprod(np.broadcast_to([[step.length] for step in steps], x.shape), axis=1)
    k = np.arange(1, x.shape[1] + 1)
    series = x.astype(float) * k
    ends = np.sign([*series[:, 0], float(polyval(1, x[-1] * k))])
    changes = np.count_nonzero(
        np.diff(signs_of(forms(series, abs(series)), ends[:-1], ends[1:])), axis=1
    )
    crossings = np.array([len(step.directions) for step in steps])
    first = np.array([step.directions[0] if step.directions else 0 for step in steps])
    for i in map(
        int,
        np.flatnonzero(
            (changes != crossings) | (crossings > 1) | (first + ends[:-1] * crossings != 0)
        ),
    ):
        signs = [ends[i], *steps[i].directions, ends[i + 1]]
        if ends[i] == 0 or any(b != -a for a, b in pairwise(signs[:-1])):
            return i, "two crossings in a row have the same direction"
        if signs[-1] != signs[-2]:
            return i, "the sign of xdot at the step's ends does not fit the crossings between"
        if (count := _counted(x[i] * k, numbers, *ends[i : i + 2])) != crossings[i]:
            times = "too closely to be counted" if count is None else f"{count} times"
            return i, f"xdot comes to zero {times}, and {crossings[i]} crossings were found"
    return None


def _counted(xdot: Any, numbers: Numbers, left: float, right: float) -> int | None:
    """Return how many zeros a polynomial has between 0 and 1, given its signs there.

    None if they are too close.
    """
    bits = numbers.number.prec + SPARE_BITS
    places = Places(numbers.fixed(xdot / max(map(abs, xdot)), bits), 0, bits, "xdot")
    try:
        return sum(1 for _ in places.isolated(int(left), int(right)))
    except IntegrationError:
        return None
