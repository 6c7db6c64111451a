"""The engine limbs: an adaptive Taylor integrator in compiled multiprecision, fast at 17 to 100 digits; needs numba.

A number is held in limbs of radix 2**22 (GMP's word), each an integer in a double. A day with many
digits takes a fiftieth of the time of heyoka in MPFR (docs/architecture.md), and the bits are the
same on every machine.

- `engine`: its declaration; `size`: limbs for a precision.
- `run`: a plan integrated, and the polynomials of each step for a proof.
- `problem`: a scene in limbs.
- `march`, `step`: the loop of steps with what is carried from one to the next, and one of them.
- `recurrence`, `series`: the Taylor coefficients of a step; their arrays.
- `dense_output`: the state inside it; `zeros`: the zeros of xdot on it.
- `limb`: numbers of limbs, eight side by side; `simd/lanes.py` says how functions of them are
  compiled.
"""
