"""Studies: error against run time, stability on extreme scenes, long runs, and how good the approximations are."""
