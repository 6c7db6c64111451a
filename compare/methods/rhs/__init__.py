"""Right-hand sides for other integrators: the one model traced to straight-line code, differentiated and compiled."""
