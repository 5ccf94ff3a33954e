"""Limits of results, and what the standards say of a case and its run."""
