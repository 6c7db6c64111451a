"""The only door to heyoka, the Taylor integrator that compiles the equations of a scene."""
