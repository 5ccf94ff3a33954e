"""Meshes of a coil as a 3D body."""
