"""Explain a disagreement in stages: conventions, gravity, model, inputs and release, integrator, slips in a formula."""
