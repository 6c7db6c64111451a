"""Transits: every zero of xdot with t > 0, in order, none lost, none doubled.

heyoka's event detection finds them on each step's polynomial. Here stand the guards, because it can
lose a root within about 2**-prec of a step's left edge and says so only in its log:

- a step whose log shows a line is taken again with its left edge moved;
- each step's crossings must alternate and lead from the sign of xdot at its start to that at its end;
- where |xdot| dips without a crossing (the close pair near the north-south passage), the bottom of
  the dip is looked at;
- the zero at t = 0 of a release at rest is left out with a first step that holds no other zero.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import IntegrationError

if TYPE_CHECKING:
    from .heyoka.log import Watch
    from .heyoka.stepper import Stepper, Zero

MAX_LOOKS = 6  # steps are retaken this often before a run is given up
SHORTER = Fraction(79, 128)  # retaken steps are cut by this: no simple ratio, so that no edge returns
DIP_BISECTIONS = 60
AT_REST = "Where xdot is nothing but rounding, as at rest, there are no transits: run.transits = false."


class _Doubt(Exception):
    """The zeros of a step contradict each other."""


def quiet_start(stepper: Stepper, multiplicity: int) -> Fraction:
    """A time δ in s with no zero of xdot in (0, δ], for a run whose first variable is x over l.

    With xdot = t^m (b_m + b_{m+1} t + …), |b_m| > 2 Σ |b_k| δ^(k-m) leaves no root; the factor 2
    covers what the polynomial leaves out.
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
    watch: Watch,
    quiet: Fraction | None = None,
    report: Callable[[float], None] | None = None,
) -> tuple[Any, list[Zero]]:
    """Step to the last of `times`; returns states of shape (times, variables) and the zeros of xdot.

    Args:
        stepper: at t = 0, with events.
        times: increasing, from 0, numbers of the run's type.
        watch: heyoka's log.
        quiet: first step, known to hold no zero but the one at t = 0.
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
        watch.fresh()
    before: deque[tuple[Any, int, int]] = deque(maxlen=2)
    looks, look = 0, stepper.look(stepper.state)
    limit = end - stepper.time
    while stepper.time < end:
        before.append((stepper.mark(), len(states), len(zeros)))
        stepper.advance(limit)
        try:
            found, look = _examined(stepper, before[-1][0][0], look, watch)
        except _Doubt as doubt:
            looks += 1
            if looks > MAX_LOOKS:
                raise IntegrationError(
                    f"zeros of xdot near t = {float(stepper.time)} s: {doubt}.",
                    AT_REST,
                ) from None
            limit = (stepper.time - before[-1][0][0]) * stepper.numbers.of(SHORTER**looks)
            mark, kept_states, kept_zeros = before[0]
            stepper.back(mark)
            del states[kept_states:], zeros[kept_zeros:]
            before.clear()
            look = stepper.look(stepper.state)
            continue
        zeros += found
        looks = looks if limit < end - before[-1][0][0] else 0
        collect()
        limit = end - stepper.time
        if report is not None:
            report(float(stepper.time))
    return np.array(states, dtype=stepper.numbers.dtype), zeros


def _examined(
    stepper: Stepper, began: Any, look: tuple[float, float], watch: Watch
) -> tuple[list[Zero], tuple[float, float]]:
    """The step's zeros and the look at its end, if they agree with one another."""
    if watch.fresh():
        raise _Doubt("heyoka's root finder gave up")
    found = sorted(stepper.found, key=lambda zero: zero.t)
    later = stepper.look(stepper.state)
    sign = np.sign(look[0])
    for zero in found:
        if zero.direction != -sign:
            raise _Doubt("two crossings in a row have the same direction")
        sign = -sign
    if sign == 0 or sign != np.sign(later[0]):
        raise _Doubt("the sign of xdot at the step's ends does not fit the crossings between")
    dips = look[0] * look[1] < 0 < later[0] * later[1]
    if not found and dips and _bottom(stepper, began) * sign <= 0:
        raise _Doubt("xdot crosses zero twice and neither was found")
    return found, later


def _bottom(stepper: Stepper, began: Any) -> float:
    """The value of xdot where |xdot| is least inside the last step, by bisection of its slope."""
    low, high = began, stepper.time
    rising = stepper.look(stepper.sample(high))[1] > 0
    for _ in range(DIP_BISECTIONS):
        middle = (low + high) / 2
        if (stepper.look(stepper.sample(middle))[1] > 0) == rising:
            high = middle
        else:
            low = middle
    return stepper.look(stepper.sample(high))[0]
