"""Quantities that an observer measures: rest position, swing plane, apsides, frequency, precession."""
