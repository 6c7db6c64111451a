"""A proof of a run: intervals that contain the true state and every transit (THEOREM.md).

It needs python-flint. A proof rests on `trusted/` alone: `Course` takes a run's steps, and `printed`
compares the written files with what it returned. The other files make proposals, and the bound
measures whatever they get wrong:

- `approximant`, `frames`, `fit` and `tangents` propose polynomials;
- `guess` proposes zeros;
- `prove` and `prove_box` choose the precision and pass steps on.

THEOREM.md, section 9, says what else has to be believed. Endpoints of intervals are Fractions; no
flint object leaves this package.
"""

from .approximant import pair, turned
from .prove import Enclosure, check_gates, enclose
from .trusted.shapes import EnclosedZero, Interval

__all__ = ["EnclosedZero", "Enclosure", "Interval", "check_gates", "enclose", "pair", "turned"]
