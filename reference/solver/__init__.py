"""From a scene to numbers with bounds: the bits it needs, runs that agree or a proof, sensitivity.

- `solve`: from a scene to a `Solution`, at every level; `request`: the scene with what a caller
  asks for.
- `uncertain`: `prove_ranges`, from a scene and the widths of its inputs to `Ranges` (`ranges`).
- `solution`: tables with bounds, and the runs they came from; the decimals of every printed column.
- `choice`: the run that is published: its bits, engine and form.
- `pilot`: pilot runs, which measure how rounding errors grow, and the limits of a run.
- `agreement`: how far two runs of a scene are apart, and the errors that follow, those of zeros
  too.
- `enclosed`: the level enclosed: a proof, with its confirmation beside it. `proving`:
  the proof itself; `proof_steps`: the run whose Taylor polynomials it takes; `guard`: a run that
  must find the same zeros.
- `swing`: frequency and precession as intervals, from the highest points.
- `sensitivity`: response of a trajectory to each input, and how many digits that costs.
- `doubles`: how far a program in double precision can follow a scene, at best.
"""
