"""Entries of input files: the strict YAML reader, and error messages in the user's terms."""
