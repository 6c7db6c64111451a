"""G. Gastebois on the Foucault pendulum, judged section by section."""
