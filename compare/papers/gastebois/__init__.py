"""G. Gastebois, Le pendule de Foucault: its sections in the order of print."""

SECTIONS = ("rotation", "small", "swings", "lagrangian")
