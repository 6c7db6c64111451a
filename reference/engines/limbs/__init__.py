"""Many digits fast: an adaptive Taylor integrator in exact digits of radix 2**22, compiled; needs numba.

17 to 100 digits of a day for a hundredth of the time that a general integrator takes in a multiprecision type; the
same bits on every machine. `run` fills a plan as `reference.engines.run.run` does; `states` gives double-double arrays.
"""

from .integration import expand, limbs, run, states
from .problem import most_bits
from .taylor_step import Expansion

__all__ = ["Expansion", "expand", "limbs", "most_bits", "run", "states"]
