"""The integrators: one run of a scene in heyoka or in limbs, with its transits."""
