"""The integrators, heyoka and limbs, and one run of a scene with its transits.

- `plan`: the input of an engine, `Plan`, and its output, `Run`.
- `registry`: which engine and number type a run takes.
- `run`, `side_by_side`: one run, and two at the same time.
- `transits`: guards around heyoka's event detection.
- `equations`: the compiled equations of a scene, as text.
- `trajectory`, `variants`: single unconfirmed runs as binary64, of any system and with changed constants.
- `heyoka/`: everything that uses heyoka, in any number type.
- `limbs/`: an integrator in machine code for many digits; needs numba.
"""
