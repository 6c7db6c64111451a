"""TRUSTED. The code that a proof rests on, and nothing else: a file for each section of THEOREM.md."""
