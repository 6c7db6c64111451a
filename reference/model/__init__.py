"""The model of the Foucault pendulum: its equations of motion, written once for every number type.

- `constants`: the constants of the equations, from a scene's exact inputs.
- `start`: these, the release, and where xdot is exactly zero.
- `algebra`: sums and products that leave out exact zeros.
- `force`: force, tension of the cord, acceleration, the invariant h and the rest position.
- `formulations`: seven ways to write the motion as a first-order system.
- `carried`: a formulation without the variables that are constant on a scene.
"""
