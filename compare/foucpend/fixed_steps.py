"""Fixed steps of Mathar (43) for foucPend, in blocks, so that a long run needs little memory; transits by parabolas."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from reference import InputError, IntegrationError
from reference.numbers.precision import Array

from ..approximations.mathar import VARIABLES, derivatives, truncated
from ..methods import METHODS, FirstOrderSystem, Problem, available
from .options import Options


def parabola_zero(t: Array, v: Array) -> float:
    """Return the zero of the parabola through three values, between the two neighbours that differ in sign.

    Args:
        t: times, shape (3,), equally spaced.
        v: values, shape (3,).
    """
    middle, h = t[1], t[1] - t[0]
    c, b, a = v[1], (v[2] - v[0]) / 2, (v[2] - 2 * v[1] + v[0]) / 2
    spread = np.sqrt(max(b * b - 4 * a * c, 0.0))
    twice = -(b + np.copysign(spread, b))
    roots = [twice / (2 * a)] if a else []
    roots += [2 * c / twice] if twice else []
    low, high = (0.0, 1.0) if np.sign(v[1]) != np.sign(v[2]) else (-1.0, 0.0)
    inside = min(roots, key=lambda root: max(low - root, root - high))
    return float(middle + h * inside)


class Transits:
    """Zeros of xdot, found block by block; a release at rest does not count."""

    def __init__(self) -> None:
        self._sign = 0.0  # of the last value that was not zero
        self._before: tuple[float, float] | None = None  # the row before the block

    def of(self, times: Array, v: Array) -> list[float]:
        """Return the times of the zeros after the block's first row, up to its last.

        Args:
            times: shape (rows,), the first row being the last one of the block before.
            v: xdot there.
        """
        signs = np.sign(v)
        zeros = []
        if self._sign == 0:
            self._sign = float(signs[0])
        # rows worth a look: the sign differs from that of the row before, or xdot is exactly zero
        changes = np.nonzero((signs[1:] != signs[:-1]) | (signs[1:] == 0))[0] + 1
        for i in changes:
            sign = float(signs[i])
            if sign == 0 or sign == self._sign:
                continue
            if self._sign != 0:
                zeros.append(self._zero(times, v, int(i)))
            self._sign = sign
        self._before = (float(times[-2]), float(v[-2]))
        return zeros

    def _zero(self, times: Array, v: Array, i: int) -> float:
        """Return the zero between rows i - 1 and i; v at i is the first value of the new sign."""
        if v[i - 1] == 0:
            return float(times[i - 1])
        if i >= 2:
            return parabola_zero(times[i - 2 : i + 1], v[i - 2 : i + 1])
        if self._before is not None:
            t, value = self._before
            return parabola_zero(np.array([t, *times[:2]]), np.array([value, *v[:2]]))
        if len(v) > 2:
            return parabola_zero(times[:3], v[:3])
        return float(times[0] + (times[1] - times[0]) * v[0] / (v[0] - v[1]))


BLOCK = 100_000  # steps whose states are in memory at a time
# the items of section VI that the two lowest bits of -a leave out
ITEMS = (frozenset[Any](), frozenset({2}), frozenset({1}), frozenset({1, 2}))


def blocks(options: Options) -> Iterator[tuple[Array, Array]]:
    """Yield blocks of times in s and states x, y, z, vx, vy, vz, shape (rows, 6).

    The first row of a block is the last one of the block before it.

    Raises:
        InputError: numba is not installed.
        IntegrationError: the bob reaches the height of the suspension, or the run fails otherwise.
    """
    method = METHODS[options.method]
    missing = available(method)
    if missing is not None:
        raise InputError("-R", options.method, "a method that is installed", f"It is {missing}.")
    step = float(options.step)
    problem = _problem(options, step)
    first = 0
    while first < options.steps:
        count = min(BLOCK, options.steps - first)
        times: Array = np.arange(count + 1, dtype=np.float64) * step
        problem = replace(problem, times=times)
        outcome = method.prepare(problem, step)()
        states = outcome.states
        if len(states) <= count:
            raise IntegrationError(
                f"{method.title} at {step:g} s fails after t = {first * step + outcome.reached_t:g} s.",
                "The equations in x and y hold below the suspension; a shorter step (-t) may help.",
            )
        yield np.asarray((first + np.arange(count + 1)) * step, dtype=np.float64), states
        problem = replace(problem, start=states[-1, [0, 1, 3, 4]] / problem.constants.length)
        first += count


def _problem(options: Options, step: float) -> Problem:
    problem = Problem.of(options.scene, "plane", [0.0, step])
    items = ITEMS[options.bits % len(ITEMS)]
    if not items:
        return problem
    k = truncated(problem.constants, items)
    return replace(problem, system=FirstOrderSystem.of(VARIABLES, partial(derivatives, items=items), k))
