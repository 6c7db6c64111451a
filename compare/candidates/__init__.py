"""Candidates as they come: a program's output in one of its formats, or the program itself."""
