"""A double-precision kernel for many undamped rows: eight of them side by side in machine code, with all transits.

- `rows`: the kernel's input and results, as flat arrays: constants and releases in the axes of the
  plumb line.
- `series`: the Taylor coefficients of a step, and the state at its end.
- `lane_zeros`: the zeros of xdot on a step, on all lanes at once, or of one lane by subdivision;
  those of u', the highest points.
- `march`: the compiled loop of steps; a lane whose row is done takes the next one.
- `batch`: the kernel as an engine of many rows.
"""
