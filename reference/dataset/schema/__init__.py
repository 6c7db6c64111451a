"""The JSON Schema of `manifest.json`, for those who read datasets without Python."""
