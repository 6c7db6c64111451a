"""The engine limbs: an adaptive Taylor integrator in compiled multiprecision, fast at 17 to 100 digits; needs numba.

A number is held in limbs of radix 2**22 (GMP's word), each an integer in a double. A day with many digits takes a
fiftieth of the time of heyoka in MPFR (docs/architecture.md), and the bits are the same on every machine.
`run` fills a plan as `reference.engines.run.run` does; `taylor_steps` gives a proof the polynomials of each step.
"""

from .problem import most_bits
from .run import run
from .taylor_step import LimbsTaylorStep, taylor_steps

__all__ = ["LimbsTaylorStep", "most_bits", "run", "taylor_steps"]
