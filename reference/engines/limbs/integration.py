"""What the rest of the project sees: plans run in digits, and states as double-double arrays."""

from __future__ import annotations

import time
from bisect import bisect_right
from collections.abc import Callable, Generator, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from ...errors import InputError, IntegrationError
from ...model.force import tension
from ...model.vanishing import xdot_vanishes, zero_at_release
from ...precision import NumberType
from ...scene import Inputs
from ..plan import Plan, Run
from ..transits import AT_REST
from .lanes import LANES
from .limb import DIGIT_BITS, Array, aligned, fraction_bits, joined
from .march import COLUMNS, DOUBTFUL, GOOD, STEPS, STUCK, TIME, ZEROS, Carried, Outputs, carried, march
from .output_times import digits_of_doubles, digits_of_fractions
from .problem import Problem, most_bits, problem
from .taylor_step import Expansion
from .zeros import FOUND

STEPS_PER_CALL = 1024
SCALE_BITS = 32  # of SI numbers, below the last digit: lengths need not be short binary fractions
POLYNOMIALS_PER_CALL = 64
FOR_EVER = 1 << 62  # in grains
STATES_BITS = 93  # for `states`: what five digits hold of a swing of half a metre below 67 m
PRODUCTS, PRODUCTS_WITH_DRAG = 9, 25  # per coefficient: three or four convolutions, the rest constants

Report = Callable[[float], None]


def limbs(prec: int) -> NumberType:
    """Digits that keep `prec` bits of a number as large as the swing, as a number type."""
    return NumberType("limbs", prec)


class March:
    """A problem on its way from release through output times.

    Args:
        made: the problem.
        whole, rest: output times in grains and digits of what is beyond.
        seek: whether zeros of xdot are wanted.
        polynomials: of how many steps a call the polynomials are kept.
    """

    def __init__(
        self, made: Problem, whole: npt.NDArray[np.int64], rest: Array, seek: bool, polynomials: int = 0
    ) -> None:
        self.problem, self.seek = made, seek
        limbs, model = made.model.limbs, made.model
        multiplicity = zero_at_release(made.n, made.v) if seek else 0
        self.at: Carried = carried(made.start, made.first, multiplicity, model.order, limbs)
        room = STEPS_PER_CALL + FOUND if seek else 0
        self.out = Outputs(
            whole,
            rest,
            aligned(len(whole) * limbs * LANES),
            np.zeros(3 * room, dtype=np.int64),
            np.zeros(room * limbs),
            aligned(room * limbs * LANES),
            np.zeros(2 * polynomials, dtype=np.int64),
            aligned(polynomials * (model.order + 1) * limbs * LANES),
        )
        self.until = int(whole[-1]) + 1
        begun = time.process_time()
        march(self.at, model, self.out, self.until, 0, seek)
        self.compile_s = time.process_time() - begun
        self._found: list[tuple[Any, Any, Any]] = []

    def finish(self, report: Report | None) -> None:
        """Go to the last output time.

        Raises:
            IntegrationError: zeros of xdot stay in doubt, or no step is short enough.
        """
        while not self.go(STEPS_PER_CALL):
            if report is not None:
                report(self.time)

    @property
    def time(self) -> float:
        """Time reached, in s."""
        return float(int(self.at.counts[TIME]) * self.problem.grain)

    def go(self, steps: int) -> bool:
        """Take some steps; True when the last output time is passed."""
        said = march(self.at, self.problem.model, self.out, self.until, steps, self.seek)
        self._keep_zeros()
        if said == STUCK:
            raise IntegrationError(f"no step is short enough at t = {self.time} s.")
        if said == DOUBTFUL:
            raise IntegrationError(
                f"zeros of xdot near t = {self.time} s: xdot touches zero within the precision.", AT_REST
            )
        return bool(said == GOOD)

    def _keep_zeros(self) -> None:
        n, limbs = int(self.at.counts[ZEROS]), self.problem.model.limbs
        if n:
            moments = self.out.moments[: 3 * n].reshape(n, 3).copy()
            places = joined(self.out.places[: n * limbs].reshape(n, limbs))
            self._found.append((moments, places, self.table(self.out.met, n)))
            self.at.counts[ZEROS] = 0

    def table(self, rows: Array, count: int) -> Any:
        """Rows of digits as integers, shape (count, COLUMNS)."""
        limbs = self.problem.model.limbs
        digits = np.moveaxis(rows[: count * limbs * LANES].reshape(count, limbs, LANES), 1, 2)
        return joined(digits[:, :COLUMNS])

    def zeros(self) -> tuple[Any, Any, list[int]]:
        """Times in grains over 2**fraction_bits, rows, signs of the crossings."""
        bits = fraction_bits(self.problem.model.limbs)
        times, tables, signs = [np.zeros(0, dtype=object)], [np.zeros((0, COLUMNS), dtype=object)], []
        for moments, places, rows in self._found:
            starts, lengths = moments[:, 0].astype(object), moments[:, 1].astype(object)
            times.append((starts << bits) + lengths * places)
            tables.append(rows)
            signs += moments[:, 2].tolist()
        return np.concatenate(times), np.concatenate(tables), signs


def run(plan: Plan, report: Report | None = None) -> Run:
    """Integrate a plan in digits: `plan.number` is `limbs(prec)`; the formulation is that of `series`.

    Args:
        plan: what to run; times increasing from 0 on.
        report: called with the simulated time in s.

    Raises:
        InputError: more bits than there can be.
        IntegrationError: zeros of xdot stay in doubt, or no step is short enough. No numbers then.
    """
    going = _started(plan, 0)
    begun = time.process_time()
    going.finish(report)
    return _result(going, plan, begun)


def expand(plan: Plan, order: int | None = None) -> Generator[Expansion, None, Run]:
    """The Taylor polynomials of a run in order from t = 0, up to one step beyond the last time; returns its `Run`.

    Args:
        plan: as for `run`.
        order: of the series; None for what is cheapest to make.
    """
    going, ahead = _started(plan, POLYNOMIALS_PER_CALL, order), False
    going.until = FOR_EVER
    spent = 0.0
    grain, model, last = going.problem.grain, going.problem.model, plan.times[-1]
    while not ahead:
        begun = time.process_time()
        going.go(POLYNOMIALS_PER_CALL)
        spent += time.process_time() - begun
        series = going.out.series.reshape(POLYNOMIALS_PER_CALL, -1).copy()
        for (start, length), of_step in zip(going.out.steps.reshape(-1, 2).tolist(), series, strict=True):
            t = start * grain
            yield Expansion(t, length * grain, model.limbs, of_step)
            if t > last:
                ahead = True
                break
    return _result(going, plan, time.process_time() - spent)


def _started(plan: Plan, polynomials: int, order: int | None = None) -> March:
    if plan.number.prec > most_bits():
        raise InputError(
            "precision", plan.number.prec, f"at most {most_bits()} bits", "Use the engine heyoka for more digits."
        )
    made = problem(plan.inputs, plan.number.prec, order)
    whole, rest = digits_of_fractions(plan.times, made.grain, made.model.limbs)
    seek = plan.transits and not xdot_vanishes(made.n, made.v, made.k)
    return March(made, whole, rest, seek, polynomials)


def _result(going: March, plan: Plan, begun: float) -> Run:
    """What a march computed, in SI units."""
    made, bits = going.problem, fraction_bits(going.problem.model.limbs)
    scale = bits + SCALE_BITS
    table = going.table(going.out.states, len(plan.times))
    grid = list(zip(*_si(table, plan.inputs.length, made.unit, bits, scale), strict=True))
    zeros, signs = _transits(going, plan, bits, scale) if going.seek else (None, [])
    return Run(
        plan=plan,
        bits=scale,
        grid=grid,
        zeros=zeros,
        directions=signs,
        order=made.model.order,
        steps=int(going.at.counts[STEPS]),
        terms=PRODUCTS_WITH_DRAG if made.model.drag else PRODUCTS,
        tension=_least_tension(made, grid, scale),
        compile_s=going.compile_s,
        cpu_s=time.process_time() - begun,
    )


def _si(table: Any, length: Fraction, unit: Fraction, bits: int, scale: int) -> list[Any]:
    """The columns of integers over 2**bits in l and the unit of time as integers over 2**scale in SI units."""
    return [_whole(table[:, i], length / unit ** (i // 3) * 2 ** (scale - bits)) for i in range(COLUMNS)]


def _whole(column: Any, factor: Fraction) -> Any:
    """Integers times a factor, rounded down."""
    made = column * factor.numerator
    return made if factor.denominator == 1 else made // factor.denominator


def _transits(going: March, plan: Plan, bits: int, scale: int) -> tuple[list[tuple[int, ...]], list[int]]:
    """Zeros up to the last output time, t first, and the signs of the crossings."""
    made = going.problem
    times, table, signs = going.zeros()
    count = bisect_right(times, int(plan.times[-1] / made.grain * 2**bits))
    moments = _whole(times[:count], made.grain * 2 ** (scale - bits))
    columns = _si(table[:count], plan.inputs.length, made.unit, bits, scale)
    return list(zip(moments, *columns, strict=True)), signs[:count]


def _least_tension(made: Problem, grid: Sequence[tuple[int, ...]], scale: int) -> float:
    """The least pull of the cord over l on the grid, in 1/s², in binary64."""
    k = made.k.converted(float)
    unit = float(made.k.length) * 2.0**scale
    x, y, z, vx, vy, vz = (np.array([row[i] / unit for row in grid]) for i in range(6))
    return float(np.min(tension((x, y, z), (vx, vy, vz), k)))


def states(inputs: Inputs, times: npt.ArrayLike) -> tuple[Array, Array]:
    """Positions and velocities at many times, as unevaluated sums of two doubles.

    Args:
        inputs: exact numbers of a scene (`Scene.exact`).
        times: in s, not negative, increasing, shape (rows,); each double is taken exactly.

    Returns:
        High and low parts, each of shape (rows, 6): x, y, z in m, vx, vy, vz in m/s. For a day of the Paris scene
        they are off by less than 1e-28 m; an estimate, not a bound.

    Raises:
        InputError: times are negative, not finite or not increasing.
        IntegrationError: no step is short enough.
    """
    moments = np.ascontiguousarray(times, dtype=np.float64)
    if moments.ndim != 1 or not len(moments) or not np.isfinite(moments).all():
        raise InputError("times", moments.shape, "a list of finite numbers, at least one")
    if moments[0] < 0 or (np.diff(moments) <= 0).any():
        raise InputError("times", "a list that decreases or is negative", "increasing numbers from 0 on")
    made = problem(inputs, STATES_BITS)
    limbs = made.model.limbs
    whole, rest = digits_of_doubles(moments, float(made.grain), limbs)
    going = March(made, whole, rest, seek=False)
    going.finish(None)
    rows = going.out.states.reshape(len(whole), limbs, LANES)[:, :, :6]
    high, low = _two_doubles(rows, limbs)
    length = inputs.length
    factors = [length / made.unit**power for power in (0, 1)]
    parts = [(float(f), float(f - Fraction(float(f)))) for f in factors]
    top = np.array([parts[i // 3][0] for i in range(6)])
    bottom = np.array([parts[i // 3][1] for i in range(6)])
    return _times(high, low, top, bottom)


def _two_doubles(rows: Array, limbs: int) -> tuple[Array, Array]:
    """Digits of shape (rows, limbs, columns) as double-doubles."""
    weight = 2.0 ** (1 - DIGIT_BITS * np.arange(1, limbs + 1))
    high, low = np.zeros_like(rows[:, 0]), np.zeros_like(rows[:, 0])
    for q in range(0, limbs, 2):  # two digits are one exact double
        pair = rows[:, q] * weight[q] + (rows[:, q + 1] * weight[q + 1] if q + 1 < limbs else 0.0)
        high, rest = _sum(high, pair)
        low = low + rest
    return _sum(high, low)


def _sum(a: Array, b: Array) -> tuple[Array, Array]:
    total = a + b
    other = total - a
    return total, (a - (total - other)) + (b - other)


def _times(high: Array, low: Array, top: Array, bottom: Array) -> tuple[Array, Array]:
    """Product of double-doubles, by Dekker's splitting."""
    product = high * top
    a, b = _halves(high), _halves(top)
    error = ((a[0] * b[0] - product) + a[0] * b[1] + a[1] * b[0]) + a[1] * b[1]
    return _sum(product, error + (high * bottom + low * top))


def _halves(a: Array) -> tuple[Array, Array]:
    large = a * 134217729.0
    high = large - (large - a)
    return high, a - high
