"""A proof of the run: balls that contain the true state and every transit (THEOREM.md); needs python-flint.

Trusted, and in no need of anything else: `balls`, `bound`, `columns`, `transits`. Untrusted: `candidate`, `recurrence`
and `frames`, which propose, `plan`, which chooses precision, `run` and `helpers`, which hand steps on. Ends of
intervals are fractions: no flint leaves here.
"""

from .candidate import Expansion, pair, turned
from .run import Cost, Enclosure, enclose
from .shapes import EnclosedTransit, Interval, Step

__all__ = ["Cost", "EnclosedTransit", "Enclosure", "Expansion", "Interval", "Step", "enclose", "pair", "turned"]
