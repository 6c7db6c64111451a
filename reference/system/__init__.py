"""Needs of the machine and its libraries: work in other processes, files and locks, compiled code, late imports."""
