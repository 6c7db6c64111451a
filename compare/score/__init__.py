"""What a verdict is made of: swing plane and phase, transits, the likely mistake, words, JSON and a picture."""
