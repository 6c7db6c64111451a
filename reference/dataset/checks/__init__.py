"""The checks of `verify`, one idea a file; each yields a sentence for every problem.

- `scene_check`: what follows from the scene is made again: frame, equations, command, bounds, page,
  vectors, …; and of the tables grid times, the first row, doubles, the digits of each column, order
  and directions of the transits.
- `physics`: each row by itself: sphere, velocity along it, invariant, the acceleration at a
  transit.
- `function`: the golden function against the grid and, at times between, against the same motion.
- `motion`: the rows together: the scene is integrated again from its release.
"""
