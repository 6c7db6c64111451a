"""Score a candidate: errors, swing plane and phase, transits, the likely mistake; as text, JSON and a picture."""
