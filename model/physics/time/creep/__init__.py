"""Creep, and yield that depends on the rate."""
