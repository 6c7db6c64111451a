"""heyoka, the Taylor integrator that compiles the equations of a scene; all that uses it is here.

heyoka's traps are dealt with here: constants enter in the run's own precision and never as Python
floats; a root that it loses, which it tells its log alone, shows in signs; outcome codes are
checked; arrays of `real` leak without the custom memory handler; the disk cache never hits beyond
128 bits and is switched off for `real`.

- `engine`: its declaration; `run`: a plan integrated, and the polynomials of each step for a proof.
- `batch`, `loop`: many scenes, one after the other.
- `system`: a formulation as its expressions and as text; its cache on disk.
- `model`: its number types, with exact conversions; any system without events, in one call; a
  formulation with a scene's constants in a number type.
- `stepper`: one scene, step by step, with events, dense output and Taylor coefficients.
- `events`: guards around its event detection.
"""
