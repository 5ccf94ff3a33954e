"""Geometry of springs."""
