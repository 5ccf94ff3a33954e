"""Buckling."""
