"""Comparisons with tables, closed solutions, finer meshes and the 3D model, each with its source and tolerance."""
