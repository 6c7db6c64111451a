"""The JSON Schema of a manifest, for those who read datasets without Python."""
