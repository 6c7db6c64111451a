"""Needs of the machine: other processes, signals, files and locks, compiled code, late imports."""
