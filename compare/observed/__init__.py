"""Quantities that an observer reads off a motion: rest position, swing plane, apsides, frequency, precession."""
