"""Compare results with the reference: score a program's output, study error against run time, test stability.

>>> import compare
>>> score = compare.assert_agrees("paris", [0.0, 60.0], [[0.3, 0.4], [-0.176326733, -0.415867688]], tolerance=1e-8)
>>> score.verdict
'agrees'

A trajectory from a file, an array or a program is a `Candidate`, and its judgement a `Score`:

>>> candidate = compare.read("mine.csv")                              # doctest: +SKIP
>>> compare.judge(candidate, "paris")                                 # doctest: +SKIP
Score(disagrees with paris: 0.0012 m)

`METHODS` and `APPROXIMATIONS` hold the integrators and the analytic approximations that are
compared, by id; `study` measures their error against run time.

>>> "rk4" in compare.METHODS
True
>>> compare.jugde                                                     # doctest: +ELLIPSIS
Traceback (most recent call last):
AttributeError: module 'compare' has no attribute 'jugde'; it has judge, ...
"""

from __future__ import annotations

from reference.system.imports import lazy

__getattr__, __dir__, __all__ = lazy(__name__)
