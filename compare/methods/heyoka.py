"""Taylor series, order set by the tolerance, adaptive step: heyoka in double, long double, quadruple and MPFR.

In a fixed number type `space` is more accurate than `momentum`: while the cord is under tension,
`space` corrects the rounding errors of |n|, whereas `momentum` keeps them, which changes the period
(1e-12 against 8e-12 m after a day of Paris in double, 4e-16 against 5e-15 m in long double). Where
more bits are available, `momentum` is faster.

`heyoka_real128` computes in MPFR of 113 bits: the same format as quadruple, as fast, and part of
every wheel.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial

from reference import IntegrationError
from reference.model.carried import carried
from reference.model.formulations import FORMULATIONS
from reference.model.start import Start
from reference.numbers.columns import STATE
from reference.numbers.precision import (
    DOUBLE,
    DOUBLE_BITS,
    GUARD_BITS,
    LONG_DOUBLE,
    LONG_DOUBLE_BITS,
    Array,
    NumberType,
    real,
)
from reference.numbers.table import Table
from reference.status import Status

from .method import Family, Method, RunOutcome, Work, failed
from .rhs.problem import Problem

QUADRUPLE_BITS = 113
SPARE_BITS = 64  # exact states are written with this many bits below the number type's epsilon


def prepare_in(problem: Problem, number: NumberType, tolerance: float | None) -> Work:
    """Build heyoka's integrator for a problem.

    The returned function takes the steps and evaluates the dense output.

    Args:
        problem: its scene's exact inputs are used, rounded once to the number type.
        number: type to compute in.
        tolerance: relative error of a step; the type's epsilon if None.
    """
    from reference.engines.heyoka.conversions import Numbers
    from reference.engines.heyoka.model import RoundedModel

    start = Start.of(problem.scene.exact, number.prec + GUARD_BITS)
    formulation = carried(FORMULATIONS[problem.formulation], start, Numbers(number).of)
    model = RoundedModel(formulation, start.k, number)
    propagator, release = model.propagator(tolerance), model.release(start)
    times = [model.numbers.of(Fraction(t)) for t in problem.times.tolist()]

    def work() -> RunOutcome:
        before = propagator.steps
        try:
            states = propagator.from_zero(release, times)
        except IntegrationError as error:
            return failed(problem, error.reason)

        def rows() -> Array | Table:
            if number == DOUBLE:
                return model.doubles(states)
            return model.table(states, number.prec + SPARE_BITS).only(STATE)

        return RunOutcome(
            Status.OK, float(problem.times[-1]), rows, steps=propagator.steps - before
        )

    return work


_heyoka = partial(
    Method,
    setting="tolerance",
    requires=("heyoka",),
    source="F. Biscani and D. Izzo, MNRAS 504 (2021) 2614; Jorba and Zou, Experimental Mathematics 14 (2005) 99",
    licence="MPL-2.0",
    formulations=("space", *(word for word in FORMULATIONS if word != "space")),
    family=Family.HEYOKA,
)
_many_digits = partial(
    _heyoka,
    formulations=("momentum", *(word for word in FORMULATIONS if word != "momentum")),
    family=Family.MANY_DIGITS,
)

METHODS = (
    _heyoka(
        id="heyoka_double",
        title="Taylor series, adaptive step, heyoka in double",
        ladder=(1e-6, 1e-7, 1e-8, 1e-10, 1e-12, 1e-14, 2.0**-52),
        prepare=lambda problem, setting: prepare_in(problem, DOUBLE, setting),
        stability=tuple(
            (word, 1e-12) for word in ("momentum", "space", "spin", "plane", "angles", "lagrangian")
        ),
        long_runs=(("momentum", 2.0**-52), ("space", 2.0**-52)),
        precision_runs=lambda bits: [("momentum", 2.0**-52)] if DOUBLE_BITS in bits else [],
    ),
    _heyoka(
        id="heyoka_long_double",
        title="Taylor series, adaptive step, heyoka in 80-bit long double",
        ladder=(1e-12, 1e-14, 1e-16, 1e-18, 2.0**-63),
        prepare=lambda problem, setting: prepare_in(problem, LONG_DOUBLE, setting),
        number="long double",
        stability=(("momentum", 1e-16),),
        long_runs=(("momentum", 2.0**-63), ("space", 2.0**-63)),
        precision_runs=lambda bits: [("momentum", 2.0**-63)] if LONG_DOUBLE_BITS in bits else [],
    ),
    _many_digits(
        id="heyoka_real128",
        title="Taylor series, adaptive step, heyoka in quadruple (113 bits)",
        ladder=(1e-20, 1e-24, 1e-28, 2.0**-112),
        prepare=lambda problem, setting: prepare_in(problem, real(QUADRUPLE_BITS), setting),
        number=f"{QUADRUPLE_BITS} bits",
        stability=(("momentum", 1e-28),),
        long_runs=(("momentum", 2.0**-112),),
    ),
    _many_digits(
        id="heyoka_real",
        title="Taylor series, adaptive step, heyoka in MPFR",
        setting="precision",
        ladder=(64, 113, 160, 256, 512),
        prepare=lambda problem, setting: prepare_in(problem, real(int(setting)), None),
        number="MPFR",
        stability=(("momentum", 100),),
        precision_runs=lambda bits: [
            ("momentum", float(prec)) for prec in bits if prec > LONG_DOUBLE_BITS
        ],
    ),
)
