"""Whole springs."""
