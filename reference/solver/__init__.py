"""From a scene to numbers with bounds: pilot runs, the choice of precision, confirmation, proof, sensitivity."""
