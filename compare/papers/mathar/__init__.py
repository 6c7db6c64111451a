"""R. J. Mathar, The Foucault Pendulum: Trajectories of the Full Lagrangian."""
