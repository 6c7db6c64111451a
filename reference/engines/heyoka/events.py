"""Transits by heyoka: guards around its event detection, so that no zero of xdot is lost and none counted twice.

heyoka finds the zeros on the polynomial of each step, but it can lose one within about 2**-prec of the left edge of the
step, which it tells its log alone. If, for example, xdot is +0.3 mm/s at the start of a step and -0.2 mm/s at its end,
there is a crossing in between, and if heyoka reports none, it has lost one.

Signs alone do not show everything. If xdot is +0.3 mm/s and falling at the start, and +0.2 mm/s and rising at the end,
it has a minimum in between. That may be +0.1 mm/s, with no transit, or -0.1 mm/s, with two close together, as happens
when the swing plane passes through north-south. To tell them apart, xdot is evaluated at the minimum.

So a step is taken again, with its left edge moved, unless

- the crossings in it alternate, and lead from the sign of xdot at its start to the sign at its end,
- xdot keeps its sign at a minimum of |xdot| inside it, if it has no crossing.

If xdot is zero at the release, that zero at t = 0 is no transit: a first step leaves it out, so short that it holds no
other.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import IntegrationError
from ..plan import AT_REST

if TYPE_CHECKING:
    from .stepper import Stepper, Zero

MAX_RETRIES = 6  # how often steps are taken again before the run is given up
SHORTER = Fraction(79, 128)  # a step taken again is cut by this factor: no simple ratio, so that no edge returns
MINIMUM_BISECTIONS = 60  # the minimum of |xdot| is found to this many bits of a step


class _Contradiction(Exception):
    """The zeros of a step contradict each other."""


def quiet_start(stepper: Stepper, multiplicity: int) -> Fraction:
    """Return a time δ in s such that xdot has no zero in (0, δ], for a run whose first variable is x over l.

    Let xdot = t^m (b_m + b_{m+1} t + …) with m = `multiplicity`. If |b_m| > Σ |b_k| δ^(k-m), summed over k > m, no
    other root lies up to δ. The sum is taken over the polynomial, and doubled to cover the terms beyond its order.

    Raises:
        IntegrationError: there is no such δ down to the working precision.
    """
    coefficients, h = stepper.coefficients()
    scaled: list[Any] = [abs((k + 1) * a * h**k) for k, a in enumerate(coefficients[0][1:])]
    step, head, tail = Fraction(float(h)), scaled[multiplicity], scaled[multiplicity + 1 :]
    for halvings in range(stepper.number.prec):
        weight = stepper.numbers.power_of_two(-halvings)
        if head > 2 * sum((b * weight ** (j + 1) for j, b in enumerate(tail)), start=0 * head):
            return step / Fraction(2) ** halvings
    raise IntegrationError(
        "xdot does not leave zero at t = 0 in the working precision.",
        AT_REST,
    )


def march(
    stepper: Stepper,
    times: Sequence[Any],
    quiet: Fraction | None = None,
    report: Callable[[float], None] | None = None,
) -> tuple[Any, list[Zero]]:
    """Step to the last of `times`; return the states, shape (times, variables), and the zeros of xdot.

    Args:
        stepper: at t = 0, with events.
        times: increasing, from 0, numbers of the run's type.
        quiet: length in s of a first step that holds no zero but the one at t = 0.
        report: called with the simulated time after each step.

    Raises:
        IntegrationError: the zeros of some step stay contradictory however its edges are moved.
    """
    end = times[-1]
    states: list[Any] = [stepper.state]
    zeros: list[Zero] = []

    def collect() -> None:
        while len(states) < len(times) and times[len(states)] <= stepper.time:
            states.append(stepper.sample(times[len(states)]))

    if quiet is not None:
        stepper.advance(min(stepper.numbers.of(quiet), end))
        collect()
    last_starts: deque[tuple[Any, int, int]] = deque(maxlen=2)  # of the last two steps
    retries, at_start = 0, stepper.xdot_and_xddot(stepper.state)
    limit = end - stepper.time
    while stepper.time < end:
        last_starts.append((stepper.mark(), len(states), len(zeros)))
        stepper.advance(limit)
        try:
            zeros_of_step, at_start = _checked_zeros(stepper, last_starts[-1][0][0], at_start)
        except _Contradiction as contradiction:
            retries += 1
            if retries > MAX_RETRIES:
                raise IntegrationError(
                    f"zeros of xdot near t = {float(stepper.time)} s: {contradiction}.",
                    AT_REST,
                ) from None
            limit = (stepper.time - last_starts[-1][0][0]) * stepper.numbers.of(SHORTER**retries)
            mark, state_count, zero_count = last_starts[0]
            stepper.back(mark)
            del states[state_count:], zeros[zero_count:]
            last_starts.clear()
            at_start = stepper.xdot_and_xddot(stepper.state)
            continue
        zeros += zeros_of_step
        retries = retries if limit < end - last_starts[-1][0][0] else 0
        collect()
        limit = end - stepper.time
        if report is not None:
            report(float(stepper.time))
    return np.array(states, dtype=stepper.numbers.dtype), zeros


def _checked_zeros(
    stepper: Stepper, t_start: Any, at_start: tuple[float, float]
) -> tuple[list[Zero], tuple[float, float]]:
    """Return the zeros of the last step, checked, and xdot and xddot at its end.

    Args:
        stepper: after the step.
        t_start: where the step began.
        at_start: xdot and xddot there.

    Raises:
        _Contradiction: a guard fails.
    """
    zeros = sorted(stepper.zeros, key=lambda zero: zero.t)
    at_end = stepper.xdot_and_xddot(stepper.state)
    sign = np.sign(at_start[0])
    for zero in zeros:
        if zero.direction != -sign:
            raise _Contradiction("two crossings in a row have the same direction")
        sign = -sign
    if sign == 0 or sign != np.sign(at_end[0]):
        raise _Contradiction("the sign of xdot at the step's ends does not fit the crossings between")
    has_minimum = at_start[0] * at_start[1] < 0 < at_end[0] * at_end[1]
    if not zeros and has_minimum and _xdot_at_minimum(stepper, t_start) * sign <= 0:
        raise _Contradiction("xdot crosses zero twice and neither was found")
    return zeros, at_end


def _xdot_at_minimum(stepper: Stepper, t_start: Any) -> float:
    """Return xdot where |xdot| has its minimum inside the last step, by bisection for xddot = 0."""
    low, high = t_start, stepper.time
    rising = stepper.xdot_and_xddot(stepper.sample(high))[1] > 0
    for _ in range(MINIMUM_BISECTIONS):
        middle = (low + high) / 2
        if (stepper.xdot_and_xddot(stepper.sample(middle))[1] > 0) == rising:
            high = middle
        else:
            low = middle
    return stepper.xdot_and_xddot(stepper.sample(high))[0]
