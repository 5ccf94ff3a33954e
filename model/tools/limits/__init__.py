"""Limits of results, and what follows from the standards for a case and its run."""
