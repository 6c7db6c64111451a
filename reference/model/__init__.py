"""The equations of motion, written once: constants of a scene, force, formulations, what vanishes."""
