"""From a scene to numbers with bounds: how many bits it needs, runs that agree or a proof, rounding, sensitivity.

- `solve`: the entry: from a scene to a `Solution`, at every level.
- `solution`: the result: tables with bounds, and the runs they came from; decimals of every printed column, and
  whether a proof decides each digit.
- `choice`: the run that is published: its bits, engine and form.
- `pilot`: pilot runs, which measure how rounding errors grow, and the limits of a run; `uncertain`: how far the
  inputs' widths move each column.
- `agreement`: how far two runs of a scene are apart, and the errors that follow, those of transits too.
- `enclosed`: the level enclosed: a proof, with its audit and its confirmation beside it; `proving`: the proof itself,
  and the runs that may refuse it; `proof_steps`: the run whose Taylor polynomials it takes.
- `sensitivity`: response of a trajectory to each input, and how many digits that costs.
"""
