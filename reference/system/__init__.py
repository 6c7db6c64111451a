"""The operating system: other processes, signals, files and locks, compiled code, late imports."""
