"""The commands that judge: each reads its options, calls what does the work, and prints."""
