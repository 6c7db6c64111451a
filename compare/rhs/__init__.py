"""The model as other integrators need it: traced from the one place where it stands, differentiated, compiled."""
