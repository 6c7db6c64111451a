"""A proof of a run: intervals that contain the true state and every transit (THEOREM.md); needs python-flint.

Trusted: `balls`, `bound`, `digits`, `six_columns`, `enclosed_transits`, `course`, which drives them, and `printed`,
which holds inputs and numbers of the written files against what `course` returned; for a golden function also
`function`, for a box of inputs `box`, `printed_box` and `derivatives`, for sections `sections`. THEOREM.md, section 9,
says what else has to be believed. Untrusted, because the bound measures whatever they get wrong: `approximant`,
`frames`, `fit` and `tangents`, which propose polynomials, `guess`, which proposes zeros, and `prove` and `prove_box`,
which choose the precision and pass steps on. `sums_checked` compares the sums of `digits` with FLINT's
integers, and an audited proof takes these: it does not rest on `digits`. `shapes` only declares. Endpoints of
intervals are Fractions; no flint object leaves this package.
"""

from .approximant import pair, turned
from .prove import Enclosure, check_gates, enclose
from .shapes import EnclosedTransit, Interval

__all__ = ["EnclosedTransit", "Enclosure", "Interval", "check_gates", "enclose", "pair", "turned"]
