"""Scenes: the inputs of a run, read and checked field by field, kept exact; and the data that come with the project."""
