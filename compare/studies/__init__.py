"""Measurements: a method at a setting, a scene's character, thirty days; each method in a process of its own."""
