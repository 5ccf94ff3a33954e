"""Figures as PNG files, and the spring in 3D."""
