"""R. J. Mathar, The Foucault Pendulum: Trajectories of the Full Lagrangian: its sections in the order of print."""

SECTIONS = ("kinematics", "lagrangian", "cartesian", "rest", "slow", "paris", "appendix_a")
