"""G. Gastebois, Le pendule de Foucault."""
