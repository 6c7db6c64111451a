"""Judges of others: score a program's output, study error against run time, look for what breaks."""
