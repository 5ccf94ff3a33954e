"""Drawings of springs, views and STEP files."""
