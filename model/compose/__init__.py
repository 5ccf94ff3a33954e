"""A run of a case: its parts, its load program and records; then its numbers, warnings and files."""
