"""A material's functions, read from its file."""
