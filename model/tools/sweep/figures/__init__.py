"""Figures of a sweep, and what they state."""
