"""Entries of files that users write: the strict YAML reader, and errors in their words."""
