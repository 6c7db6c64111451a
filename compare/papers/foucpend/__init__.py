"""foucPend, the program of Mathar's appendix A, with the same switches: fixed steps, snapshots and transits as text.

>>> from compare.papers.foucpend import Options, lines
>>> options = Options.parse({"x": "0.3", "y": "0.4", "T": "20", "s": "100"})
>>> for line in lines(options):                                       # doctest: +SKIP
...     print(line)

The output, which `compare.candidates.read` and any other program can read:

- lines of text, each ended by one newline, decimal point, no thousands separators;
- a line that starts with `#` is a comment. The first comments name the settings and the columns;
- a **snapshot** is a line of ten numbers separated by single blanks:

      t  x  y  z  X  Y  Z  φ  λ  speed

  time in s; position in the local frame, east, north, up from the suspension, in m; position in the frame of (9),
  origin at the Earth's centre, which does not turn, in m; angle of the cord from straight down and azimuth from east
  to north, both in degrees (-180 < λ <= 180, 0 where x = y = 0); speed in the local frame in m/s. The first snapshot
  is that of t = 0, then one follows after every s-th step of t seconds, up to T;
- a **transit** is a comment `# P k t f`: it is the k-th zero of xdot after t = 0, at t seconds, and f = k/(2 t) Hz is
  the frequency if two such transits occur in a period. It stands between the snapshots before and after it. The zero
  is that of the parabola through xdot at the two steps around the change of sign and at the step before them (after
  them, where there is none before): an error of order t³;
- numbers are printed with 17 significant digits, so that reading them gives exactly the doubles of the run;
- T need not be a multiple of t: the run ends with the last whole step.

With `--exact` the same lines come from the reference: positions and velocities are the doubles nearest to the
truth, and transits are those that the reference finds, not the zeros of a parabola.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from reference.system.imports import lazy

if TYPE_CHECKING:
    from .options import Options
    from .output import lines

__all__ = ["Options", "lines"]

__getattr__, __dir__ = lazy(__name__, {"Options": "options", "lines": "output"})  # `foucault --help` needs neither
