"""Sections that warp freely."""
